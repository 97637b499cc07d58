"""What the tests of faults share: a run with something of everything, and when it has come out right."""

import atexit
import functools
import hashlib
import json
import os
import pathlib
import random
import shutil
import subprocess
import tempfile
import time

import program

# How much more often than in a short run everything is tried.
TIMES = int(os.environ.get("SANDGLASS_FAULTS", "1"))
# Another sequence of random moments and places each day; to repeat one, set the seed that the test has printed.
SEED = int(os.environ.get("SANDGLASS_SEED", random.SystemRandom().randrange(10**6)))
RANDOM = random.Random(SEED)

DONE, FAILURE, BAD_INPUT, RESUMABLE = 0, 1, 2, 75

# About two seconds: preparation, calibration, equilibration and measurement all take a part of it.
CONFIG = """
[system]
particles = 400
packing_fraction = 0.6
[collision]
restitution = 0.6
[prepare]
jammed_fraction = 0.8
[run]
equilibrate = 300
collisions = 3000
intervals = 4
[output]
trajectory_frames = 6
checkpoint_seconds = 0.05
"""


def write_config(folder):
    path = pathlib.Path(folder) / "faulty.toml"
    path.write_text(CONFIG)
    return path


def start(config, out, *options, environment=None):
    return subprocess.Popen([program.SANDGLASS, "run", str(config), "-o", str(out), "--resume", *map(str, options)],
                            env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def finish(running, timeout=400):
    """Waits for the end: exit code and all that was printed."""
    text = running.communicate(timeout=timeout)[0]
    return running.returncode, text


def held(begin, out, *names):
    """A run that `begin()` has started in `out`, held (SIGSTOP) when it has written the files `names`, before its end."""
    while True:
        running = begin()
        while running.poll() is None and not all((out / name).exists() for name in names):
            time.sleep(0.005)
        if program.hold(running, out):
            return running
        code, text = finish(running)  # it was over before it could be held
        assert code == DONE, text
        shutil.rmtree(out)


def results(out):
    """All that must be the same bits however often a run was interrupted."""
    out = pathlib.Path(out)
    digest = {name: hashlib.sha256((out / name).read_bytes()).hexdigest() for name in ("observables.h5", "trajectory.h5")}
    digest["state_hash"] = json.loads((out / "summary.json").read_text())["state_hash"]
    return digest


@functools.cache
def undisturbed():
    """Results and duration of a run that nothing disturbs; its folder, for copies."""
    folder = pathlib.Path(tempfile.mkdtemp(prefix="sandglass-faults-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    code, text = finish(start(write_config(folder), folder / "out"))
    assert code == DONE, text
    seconds = json.loads((folder / "out" / "summary.json").read_text())["wall_seconds"]
    return results(folder / "out"), seconds, folder / "out"
