"""The Slurm script of examples/slurm against a real Slurm: a cluster of one node is set up on this machine, in a folder
of its own and beside whatever else runs. An array of points is started, pre-empted by other work, sent the signal that
comes before the time is over, requeued by Slurm and by itself, and finished; it ends in the same bits as the same
campaign run by sandglass sweep run.

Ends with 77 (skipped) and says why where Slurm is missing or cannot be started."""

import json
import os
import pathlib
import pwd
import re
import shutil
import socket
import subprocess
import sys
import tempfile
import time

import h5py

SANDGLASS = os.environ["SANDGLASS"]
ROOT = pathlib.Path(__file__).resolve().parents[2]
SKIPPED = 77
POINTS = 3

# Collisions per disk, so that each point takes some ten seconds and is cut off twice before it is done. Where the machine
# is too fast for that, the next are tried.
LENGTHS = (40_000, 160_000, 640_000)
STUDY = """
[system]
particles = 400
packing_fraction = 0.3
[collision]
restitution = 0.5
[prepare]
method = "insert"
[run]
equilibrate = 50
collisions = {length}
[output]
trajectory_frames = 0
[sweep]
[[sweep.product]]
system.packing_fraction = [0.20, 0.30, 0.40]
"""

CONFIGURATION = """
ClusterName=sandglass
SlurmctldHost={host}
SlurmUser={user}
SlurmdUser={user}
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
AuthType=auth/munge
CredType=cred/munge
AuthInfo=socket={folder}/munge.socket,cred_expire=5
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerType=sched/backfill
SchedulerParameters=bf_interval=1,sched_interval=1,sched_min_interval=0
SlurmdParameters=config_overrides
MpiDefault=none
ReturnToService=2
JobRequeue=1
PreemptType=preempt/partition_prio
PreemptMode=REQUEUE
KillWait=30
NodeName={host} NodeAddr=127.0.0.1 CPUs={points} RealMemory=8000 State=UNKNOWN
PartitionName=low Nodes=ALL Default=YES PriorityTier=1 GraceTime=0 State=UP
PartitionName=high Nodes=ALL PriorityTier=10 PreemptMode=OFF State=UP
"""


class Unusable(Exception):
    """Slurm cannot be had here."""


class TooQuick(Exception):
    """All points were done before they could be interrupted."""


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for each in sockets:
        each.bind(("127.0.0.1", 0))
    ports = [each.getsockname()[1] for each in sockets]
    for each in sockets:
        each.close()
    return ports


class Cluster:
    """munged, slurmctld and slurmd in a folder; ended with the object."""

    def __init__(self, folder):
        self.folder = folder
        self.daemons = []
        self.environment = {**os.environ, "SLURM_CONF": str(folder / "slurm.conf"), "SANDGLASS": SANDGLASS}

    def __enter__(self):
        try:
            self.start()
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        for daemon in reversed(self.daemons):
            daemon.terminate()
        for daemon in self.daemons:
            try:
                daemon.wait(10)
            except subprocess.TimeoutExpired:
                daemon.kill()
                daemon.wait()

    def start(self):
        folder = self.folder
        (folder / "munge.key").write_bytes(os.urandom(1024))
        (folder / "munge.key").chmod(0o600)
        for name in ("state", "spool"):
            (folder / name).mkdir()
        # The host's own name: slurmctld and slurmd ask the system for it.
        (folder / "slurm.conf").write_text(CONFIGURATION.format(
            host=socket.gethostname().split(".")[0], user=pwd.getpwuid(os.geteuid()).pw_name, ports=free_ports(2), folder=folder,
            points=POINTS))
        (folder / "cgroup.conf").write_text("CgroupPlugin=cgroup/v1\n")
        self.daemon("munged", "--foreground", "--force", f"--socket={folder}/munge.socket",
                    f"--key-file={folder}/munge.key", f"--pid-file={folder}/munge.pid",
                    f"--seed-file={folder}/munge.seed", f"--log-file={folder}/munge.log")
        self.wait_for(lambda: (folder / "munge.socket").exists(), "munged makes no socket")
        self.daemon("slurmctld", "-D", "-i")
        self.wait_for(lambda: "is UP" in self.command("scontrol", "ping", check=False), "slurmctld does not answer")
        self.daemon("slurmd", "-D")
        self.wait_for(lambda: self.command("sinfo", "-h", "-o", "%T", check=False).strip() == "idle",
                      "slurmd does not come up")

    def daemon(self, name, *arguments):
        path = shutil.which(name, path=os.environ["PATH"] + ":/usr/sbin:/sbin")
        if path is None:
            raise Unusable(f"{name} is not installed (Debian: slurmctld slurmd slurm-client munge)")
        with open(self.folder / f"{name}.out", "wb") as out:
            # setpriv: none of them outlives a test that is killed.
            self.daemons.append(subprocess.Popen(["setpriv", "--pdeathsig", "TERM", path, *arguments], stdout=out,
                                                 stderr=out, stdin=subprocess.DEVNULL, env=self.environment))

    def wait_for(self, ready, problem, seconds=60):
        end = time.monotonic() + seconds
        while not ready():
            if time.monotonic() > end or any(daemon.poll() is not None for daemon in self.daemons):
                said = "".join(path.read_text(errors="replace")[-600:] for path in sorted(self.folder.glob("*.out")))
                raise Unusable(f"{problem}; the daemons said:\n{said}")
            time.sleep(0.2)

    def command(self, *words, check=True):
        done = subprocess.run(words, env=self.environment, cwd=self.folder, text=True, stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=200)
        if check and done.returncode != 0:
            raise AssertionError(f"{' '.join(map(str, words))}\n{done.stdout}")
        return done.stdout

    def submit(self, *words):
        return int(re.search(r"Submitted batch job (\d+)", self.command("sbatch", *map(str, words)))[1])

    def preempted(self):
        return (self.folder / "slurmctld.log").read_text(errors="replace").count("preempted JobId")

    def ended_job(self, job):
        """What Slurm tells of a job that has ended well."""
        end = time.monotonic() + 200
        while "JobState=COMPLETED" not in (told := self.command("scontrol", "show", "job", job)):
            assert time.monotonic() < end, told
            time.sleep(0.3)
        return told


def program(*words):
    done = subprocess.run([SANDGLASS, *map(str, words)], text=True, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, timeout=600)
    assert done.returncode == 0, done.stdout
    return done.stdout


def points(campaign):
    return json.loads(program("sweep", "status", campaign, "--json"))["points"]


def states(campaign):
    return [point["state"] for point in points(campaign)]


def measuring(campaign):
    return any(point["state"] == "running" and point["stage"] == "measuring" for point in points(campaign))


def hashes(campaign):
    return {path.parent.name: json.loads(path.read_text())["state_hash"]
            for path in sorted((campaign / "runs").glob("*/summary.json"))}


def collected(campaign):
    """What sweep collect makes of a campaign, as bytes by name: the datasets of study.h5 and the tables."""
    program("sweep", "collect", campaign)
    assert (campaign / "report.html").stat().st_size > 0
    results = {path.name: path.read_bytes() for path in (campaign / "csv").glob("*.csv")}
    with h5py.File(campaign / "study.h5") as study:
        study.visititems(lambda name, item: results.update({name: item[()].tobytes()})
                         if isinstance(item, h5py.Dataset) else None)
    return results


def wait_until(condition, what, campaign, seconds=200):
    end = time.monotonic() + seconds
    while not condition():
        if set(states(campaign)) == {"done"} and not condition():
            raise TooQuick(f"all was done before {what}")
        assert time.monotonic() < end, f"{what}: not within {seconds} s"
        time.sleep(0.3)


def test(cluster, folder):
    for length in LENGTHS:
        try:
            (folder / str(length)).mkdir()
            return test_array(cluster, folder / str(length), length)
        except TooQuick as problem:
            print(f"{length} collisions per disk: {problem}")
    raise AssertionError(f"even at {length} collisions per disk the points could not be interrupted")


def test_array(cluster, folder, length):
    (folder / "study.toml").write_text(STUDY.format(length=length))
    for name in ("array", "here"):
        program("sweep", "init", folder / "study.toml", "-o", folder / name, "--no-estimate")
    campaign = folder / "array"
    preempted_before = cluster.preempted()
    preempted = lambda: cluster.preempted() - preempted_before

    array = cluster.submit(f"--array=1-{POINTS}", "--time=5", ROOT / "examples/slurm/array.sbatch", campaign)
    wait_until(lambda: measuring(campaign), "the points are measured", campaign)
    # Work of a higher priority takes the whole node: Slurm sends the tasks away, and they come back.
    cluster.submit("--partition=high", f"--ntasks={POINTS}", "--wrap=sleep 1", "--output=/dev/null")
    wait_until(preempted, "the tasks are pre-empted", campaign)
    wait_until(lambda: not measuring(campaign), "the points stop", campaign)
    wait_until(lambda: measuring(campaign), "the points go on", campaign)
    # What --signal=B:USR1@300 does five minutes before the end.
    cluster.command("scancel", "--signal=USR1", "--batch", str(array), check=False)  # if it has not ended by then
    wait_until(lambda: set(states(campaign)) == {"done"}, "all points are done", campaign, 600)

    jobs = [cluster.ended_job(f"{array}_{task}") for task in range(1, POINTS + 1)]
    restarts = sum(int(re.search(r"Restarts=(\d+)", job)[1]) for job in jobs)
    resumed = sum((path / "run.log").read_text().count("resumed at beat") for path in (campaign / "runs").iterdir())
    print(f"requeued {restarts} times, {preempted()} of them pre-empted; {resumed} times gone on at a checkpoint")
    if not restarts > preempted() > 0:
        raise TooQuick("tasks were requeued by Slurm, and then by themselves")
    assert resumed > 0, "no point went on at a checkpoint"

    # A finished array ends at once.
    again = cluster.submit(f"--array=1-{POINTS}:2", "--time=1", ROOT / "examples/slurm/array.sbatch", campaign)
    cluster.ended_job(f"{again}_3")

    program("sweep", "run", folder / "here", "--jobs", "2")
    assert hashes(campaign) == hashes(folder / "here"), "other bits than run here"
    assert len(hashes(campaign)) == POINTS
    here, there = collected(folder / "here"), collected(campaign)
    assert here.keys() == there.keys() and len(here) > 100
    differing = [name for name in here if here[name] != there[name]]
    assert not differing, f"collected, these differ from what was run here: {differing}"
    print(f"collected: {len(here)} tables and datasets, the same bytes")


def main():
    folder = pathlib.Path(tempfile.mkdtemp(prefix="sandglass-slurm-"))
    try:
        with Cluster(folder) as cluster:
            test(cluster, folder)
    except Unusable as problem:
        print(f"skipped: {problem}")
        return SKIPPED
    except AssertionError:
        for log in [*folder.glob("slurm-*.out"), folder / "slurmctld.log", folder / "slurmd.log"]:
            print(f"== {log.name}\n{log.read_text(errors='replace')[-3000:]}" if log.exists() else "")
        raise
    finally:
        if "KEEP" not in os.environ:
            shutil.rmtree(folder, ignore_errors=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
