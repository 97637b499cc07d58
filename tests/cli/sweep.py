"""Campaigns: made from a study, run here or point by point, killed and gone on with, looked at."""

import contextlib
import itertools
import json
import os
import resource
import signal
import subprocess
import time
import unittest

import program

# Three quick points and, with the longest first, one of some seconds.
STUDY = program.TINY + """
[sweep]
[[sweep.product]]
system.packing_fraction = [0.20, 0.30]
run.collisions = [40, 60]
"""

# Points of a few seconds each, elastic and without drive, so that nothing is calibrated.
LONGER = """
[system]
particles = 200
[collision]
restitution = 1
[drive]
kind = "none"
[prepare]
method = "insert"
[run]
equilibrate = 20
collisions = 40_000
intervals = 2
[output]
trajectory_frames = 0
checkpoint_seconds = 0.5
[sweep]
replicas = 2
[[sweep.product]]
system.packing_fraction = [0.20, 0.30]
"""


class Campaign(program.Case):
    def init(self, text=STUDY, folder="campaign", *options):
        (self.folder / "study.toml").write_text(text)
        # Each point has a file that is flushed to the disk: thousands of them take long where that is slow.
        self.run_ok("sweep", "init", self.folder / "study.toml", "-o", self.folder / folder, "--no-estimate", *options,
                    timeout=600)
        return self.folder / folder

    def rows(self, campaign):
        lines = [line.split("\t") for line in (campaign / "manifest.tsv").read_text().splitlines()]
        return [dict(zip(lines[0], line)) for line in lines[1:]]

    def status(self, campaign):
        return json.loads(self.run_ok("sweep", "status", campaign, "--json").stdout)

    def states(self, campaign):
        return [point["state"] for point in self.status(campaign)["points"]]

    def hashes(self, campaign):
        return {path.parent.name: json.loads(path.read_text())["state_hash"]
                for path in (campaign / "runs").glob("*/summary.json")}

    def start(self, *arguments):
        running = subprocess.Popen([program.SANDGLASS, *map(str, arguments)], text=True, stdin=subprocess.DEVNULL,
                                   stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        self.addCleanup(running.stdout.close)
        self.addCleanup(running.wait)
        self.addCleanup(running.kill)
        return running

    def wait_until(self, condition, seconds=300):
        end = time.monotonic() + seconds
        while not condition():
            self.assertLess(time.monotonic(), end, "this takes too long")
            time.sleep(0.05)

    def measuring(self, campaign):
        return any(point["stage"] == "measuring" and not (campaign / point["path"] / "summary.json").exists()
                   for point in self.status(campaign)["points"] if point["state"] == "running")

    def held(self, running, campaign):
        """Holds (SIGSTOP) what `running` runs while a point measures, so that what is done to it meets it in the middle, on a
        fast and on a busy machine. The processes held; none if all points were done before."""
        while running.poll() is None:
            if self.measuring(campaign):
                processes = self.children(running.pid) or [running.pid]
                self.send(signal.SIGSTOP, processes)
                self.addCleanup(self.send, signal.SIGCONT, processes)
                if self.measuring(campaign):
                    return processes
                self.send(signal.SIGCONT, processes)
            time.sleep(0.05)
        self.assertEqual(running.returncode, program.DONE, running.stdout.read())
        return []

    def send(self, number, processes):
        for process in processes:
            with contextlib.suppress(ProcessLookupError):
                os.kill(process, number)

    def children(self, parent):
        found = []
        for entry in os.listdir("/proc"):
            if entry.isdigit():
                try:
                    with open(f"/proc/{entry}/stat") as stat:
                        if int(stat.read().rsplit(")", 1)[1].split()[1]) == parent:
                            found.append(int(entry))
                except OSError:
                    pass
        return found


class Init(Campaign):
    def test_init_again_adds_points_and_touches_nothing(self):
        campaign = self.init()
        self.assertEqual([row["index"] for row in self.rows(campaign)], ["1", "2", "3", "4"])
        self.run_ok("run", "--manifest", campaign / "manifest.tsv", "--index", 2)
        with self.untouched(campaign / "runs"):
            self.init()
        self.init(STUDY.replace("0.30]", "0.25, 0.30]"))
        rows = self.rows(campaign)
        self.assertEqual(len(rows), 6)
        self.assertEqual((rows[1]["path"], rows[1]["run.collisions"]), ("runs/eta=0.20_collisions=60_seed=1", "60"))
        self.assertEqual(rows[4]["path"], "runs/eta=0.25_collisions=40_seed=1")
        self.assertEqual(self.states(campaign), ["not started", "done", *4 * ["not started"]])

    def test_bad_studies_write_nothing(self):
        study = self.folder / "study.toml"
        for text, saying in ((program.TINY, ["[sweep]", "sandglass run"]),
                             (STUDY.replace("0.30]", "0.60]"), ["study.toml:", "insert", "0.6"]),
                             (STUDY.replace("packing_fraction = [", "paking_fraction = ["), ["did you mean"]),
                             ("[sweep", ["not TOML"])):
            study.write_text(text)
            with self.untouched(self.folder):
                self.refused("sweep", "init", study, "-o", self.folder / "campaign", saying=saying)
            self.assertFalse((self.folder / "campaign").exists())
        study.write_text(STUDY)
        self.refused("run", study, "-o", self.folder / "run", saying=["sweep init"])
        for option in (["--scale", "0"], ["--scale", "nan"], ["--set", "run.sed=1"]):
            self.refused("sweep", "init", study, "-o", self.folder / "campaign", *option)
        self.assertFalse((self.folder / "campaign").exists())

    def test_changed_physics_is_refused(self):
        campaign = self.init()
        with self.untouched(campaign):
            self.refused("sweep", "init", self.folder / "study.toml", "-o", campaign, "--set", "run.equilibrate=30",
                         saying=["run.equilibrate was 20 and would be 30"])
        dropped = self.init(STUDY.replace("[0.20, 0.30]", "[0.30]"))
        self.assertEqual(len(self.rows(dropped)), 4)

    def test_estimate_and_scale(self):
        (self.folder / "study.toml").write_text(STUDY)
        said = self.run_ok("sweep", "init", self.folder / "study.toml", "-o", self.folder / "campaign", "--scale", "2.5")
        self.assertIn("core-hours", said.stdout)
        self.assertEqual([row["run.collisions"] for row in self.rows(self.folder / "campaign")], 2 * ["100", "150"])

    def test_ten_thousand_points(self):
        # Ten times the points take ten times the work, and thirty times where the machine slows down threefold meanwhile;
        # if each were compared with all others, it would be a hundred times.
        self.assertLess(self.processor_seconds(10_000), 33 * self.processor_seconds(1000))

    def processor_seconds(self, points):
        """What it takes to make a campaign of so many points, to find it there, and to look at it."""
        densities = ", ".join(f"0.{digits}" for digits in range(1000, 1100))
        text = program.TINY + (f"[sweep]\nreplicas = {points // 100}\n[[sweep.product]]\n"
                               f"system.packing_fraction = [{densities}]\n")
        used = lambda: sum(resource.getrusage(resource.RUSAGE_CHILDREN)[:2])
        before = used()
        campaign = self.init(text, f"campaign{points}")
        self.init(text, f"campaign{points}")
        self.assertEqual(len(self.status(campaign)["points"]), points)
        return used() - before


class Run(Campaign):
    def test_everything_is_run_and_the_same_bits_come_point_by_point(self):
        campaign = self.init()
        said = self.run_ok("sweep", "run", campaign, "--jobs", 2)
        self.assertIn("4 of 4 points done", said.stdout)
        self.assertNotIn("\r", said.stderr)
        self.assertEqual(self.states(campaign), 4 * ["done"])
        for row in self.rows(campaign):
            self.assertTrue((campaign / row["path"] / "report.html").exists())
            self.assertFalse((campaign / row["path"] / "progress.json").exists())
        with self.untouched(campaign):
            self.run_ok("sweep", "run", campaign)

        points = self.init(STUDY, "points")
        manifest = points / "manifest.tsv"
        self.run_ok("run", "--manifest", manifest, "--index", 1)
        self.run_ok("run", "--manifest", manifest, "--index", 2, "--count", 9)
        self.run_ok("run", "--manifest", manifest, "--index", 1, "--count", 4)  # all done: nothing to do
        self.assertEqual(self.hashes(points), self.hashes(campaign))
        self.assertEqual(len(self.hashes(points)), 4)

    def test_a_failed_point_does_not_stop_the_others(self):
        campaign = self.init()
        bad, good = (campaign / self.rows(campaign)[i]["path"] for i in (1, 2))
        (bad / "checkpoint.h5").write_bytes(b"junk")  # neither this nor an older one can be gone on with
        done = program.sandglass("sweep", "run", campaign, "--jobs", 2)
        self.assertEqual(done.returncode, program.FAILURE, done.stdout + done.stderr)
        for word in ("3 of 4 points done", "1 failed", bad.name, "checkpoint.h5"):
            self.assertIn(word, done.stdout)
        self.assertIn("output.log", done.stderr)
        self.assertIn("checkpoint.h5", (bad / "output.log").read_text())
        self.assertTrue((good / "summary.json").exists())
        failed = self.status(campaign)["points"][1]
        self.assertEqual(failed["state"], "failed")
        self.assertIn("checkpoint.h5", failed["remark"])
        (bad / "checkpoint.h5").unlink()
        self.run_ok("sweep", "run", campaign)
        self.assertEqual(self.states(campaign), 4 * ["done"])

    def test_killed_and_stopped_campaigns_go_on_to_the_same_bits(self):
        collisions = 40_000
        while not self.interrupted(collisions):
            collisions *= 4  # all was done before it could be interrupted

    def interrupted(self, collisions):
        text = LONGER.replace("40_000", str(collisions))
        campaign = self.init(text, f"campaign{collisions}")

        running = self.start("sweep", "run", campaign, "--jobs", 2)
        if not (held := self.held(running, campaign)):
            return False
        self.assertIn("running", self.run_ok("sweep", "status", campaign).stdout)
        running.kill()  # kill -9: the runs are told by the system, and stop at a checkpoint
        running.wait()
        self.send(signal.SIGCONT, held)
        self.wait_until(lambda: "running" not in self.states(campaign))
        self.assertIn("stopped", self.states(campaign))

        running = self.start("sweep", "run", campaign, "--jobs", 2)
        if not (held := self.held(running, campaign)):
            return False
        self.send(signal.SIGKILL, held)  # the runs themselves: they are started again
        if not (held := self.held(running, campaign)):
            return False
        running.send_signal(signal.SIGTERM)
        self.send(signal.SIGCONT, held)
        self.assertEqual(running.wait(300), 75)
        self.assertIn("Go on with: sandglass sweep run", running.stdout.read())
        self.assertNotIn("running", self.states(campaign))

        self.run_ok("sweep", "run", campaign, "--jobs", 2, timeout=600)
        whole = self.init(text, f"whole{collisions}")
        self.run_ok("sweep", "run", whole, timeout=600)
        self.assertEqual(self.hashes(campaign), self.hashes(whole))
        return True

    def test_two_campaigns_in_one_folder_share_the_work(self):
        campaign = self.init()
        both = [self.start("sweep", "run", campaign, "--jobs", 1) for _ in range(2)]
        for running in both:
            self.assertEqual(running.wait(300), 0, running.stdout.read())
        self.assertEqual(self.states(campaign), 4 * ["done"])
        for row in self.rows(campaign):
            log = (campaign / row["path"] / "run.log").read_text()
            self.assertEqual(log.count("finished"), 1, log)


class Point(Campaign):
    def test_stopped_points_ask_to_be_requeued(self):
        campaign, running = self.point_held("--count", 3)
        manifest = campaign / "manifest.tsv"
        running.send_signal(signal.SIGUSR1)
        running.send_signal(signal.SIGCONT)
        self.assertEqual(running.wait(300), 75)
        said = running.stdout.read()
        self.assertIn("Stopped. Go on with: sandglass run --manifest", said)
        point = self.status(campaign)["points"][0]
        self.assertEqual(point["state"], "stopped")
        self.assertGreater(point["fraction"], 0)
        self.assertEqual(self.states(campaign)[1:], 3 * ["not started"])  # the time was over for them as well
        self.run_ok("run", "--manifest", manifest, "--index", 1)
        self.assertIn("resumed", (campaign / self.rows(campaign)[0]["path"] / "run.log").read_text())

    def point_held(self, *options):
        """A campaign whose first point is run by itself, and held while it measures."""
        for turn in itertools.count():
            campaign = self.init(LONGER, f"campaign{turn}")
            running = self.start("run", "--manifest", campaign / "manifest.tsv", "--index", 1, *options)
            if self.held(running, campaign) and self.states(campaign)[0] == "running":
                return campaign, running
            running.kill()  # the first was done before it could be held

    def test_points_share_the_wall_time(self):
        turns, seconds = 0, 2.0
        while turns < 2:
            turns = self.turns(seconds)
            seconds /= 4  # the machine does all points in one turn
        print(f"\n{turns} turns")

    def turns(self, seconds):
        """In how many turns of so many seconds all points are done."""
        campaign = self.init(LONGER.replace("checkpoint_seconds = 0.5", "checkpoint_seconds = 100"), f"turns{seconds}")
        fractions = [0]
        while (done := program.sandglass("run", "--manifest", campaign / "manifest.tsv", "--index", 1, "--count", 4,
                                         "--max-walltime", seconds)).returncode != program.DONE:
            self.assertEqual(done.returncode, 75, done.stdout + done.stderr)
            fractions.append(self.status(campaign)["totals"]["fraction"])
            self.assertGreater(fractions[-1], fractions[-2], "a turn got no further")
        self.assertEqual(self.states(campaign), 4 * ["done"])
        return len(fractions)

    def test_points_and_manifests_that_are_not(self):
        campaign = self.init()
        manifest = campaign / "manifest.tsv"
        good = manifest.read_text()
        self.refused("run", "--manifest", manifest, "--index", 5, saying=["from 1 to 4"])
        self.refused("run", "--manifest", manifest, "--index", 0, saying=["from 1 to 4"])
        self.refused("run", "--manifest", manifest, saying=["--index"])
        self.refused("run", "--manifest", manifest, "--index", "x")
        self.refused("run", "--manifest", manifest, "--index", 1, "--count", 0)
        self.refused("run", self.tiny, "--manifest", manifest, "--index", 1, saying=["exclude"])
        self.refused("run", "--manifest", self.folder / "nowhere.tsv", "--index", 1, saying=["nowhere.tsv"])
        self.refused("sweep", "run", self.folder, saying=["manifest.tsv", "sweep init"])
        self.refused("sweep", "status", self.folder, saying=["manifest.tsv"])
        self.refused("run", "--manifest", manifest, "--index", 1, "--set", "run.threads=many", saying=["run.threads"])

        path = self.rows(campaign)[0]["path"]
        for text, saying in ((good.replace(path, "../../etc"), ["below"]), (good.replace(path, "/etc"), ["below"]),
                             (good.replace(path, "runs/nowhere"), ["runs/nowhere"]),
                             (good.replace("1\truns", "2\truns", 1), ["given twice"]),
                             (good.replace("\t1\t0.2\t40", "\t7\t0.2\t40"), ["run.seed"]),
                             (good.replace("\t1\t0.2\t40", "\t1\t0.9\t40"), ["system.packing_fraction"]),
                             (good.replace("\t1\t0.2\t40", "\t1"), ["columns"]),
                             (good.replace("index\t", "number\t"), ["no manifest"]), ("\0" * 100, ["no manifest"]),
                             ("", ["no manifest"])):
            manifest.write_text(text)
            self.refused("run", "--manifest", manifest, "--index", 1, saying=saying)
        manifest.write_text(good)

    def test_a_point_that_somebody_runs_is_refused(self):
        campaign, _ = self.point_held()
        self.refused("run", "--manifest", campaign / "manifest.tsv", "--index", 1, saying=["in use"])
        self.assertEqual(self.status(campaign)["points"][0]["state"], "running")


class Status(Campaign):
    def test_status_is_a_pure_read(self):
        campaign = self.init()
        self.run_ok("run", "--manifest", campaign / "manifest.tsv", "--index", 1)
        (campaign / self.rows(campaign)[1]["path"] / ".lock").touch()  # left over by a killed run
        with self.untouched(campaign):
            for path in sorted(campaign.rglob("*")):
                path.chmod(0o555 if path.is_dir() else 0o444)
            campaign.chmod(0o555)
            table = self.run_ok("sweep", "status", campaign).stdout
            status = self.status(campaign)
        campaign.chmod(0o755)
        for path in campaign.rglob("*"):
            path.chmod(0o755)
        self.assertEqual(status["totals"]["states"],
                         {"done": 1, "running": 0, "stopped": 0, "failed": 0, "not started": 3})
        self.assertGreater(status["totals"]["fraction"], 0)
        self.assertGreater(status["points"][0]["collisions_per_second"], 0)
        self.assertIn("4 points, 1 done, 3 not started", table)
        self.assertIn("core-hours left", table)


if __name__ == "__main__":
    unittest.main()
