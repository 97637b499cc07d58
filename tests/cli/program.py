"""Running the program from tests: one call, one result."""

import atexit
import contextlib
import functools
import hashlib
import os
import pathlib
import resource
import shutil
import signal
import subprocess
import tempfile
import unittest

SANDGLASS = os.environ["SANDGLASS"]
ROOT = pathlib.Path(__file__).resolve().parents[2]

# A whole run in about a second: everything that a large one does, at 200 disks. (Calibrating takes most of it, and the
# less the more the collisions dissipate.)
TINY = """
[system]
particles = 200
packing_fraction = 0.3
[collision]
restitution = 0.5
[prepare]
method = "insert"
[run]
equilibrate = 20
collisions = 40
intervals = 2
[output]
trajectory_frames = 3
"""

DONE, FAILURE, BAD_INPUT = 0, 1, 2


def sandglass(*arguments, cwd=None, timeout=400, memory=None):
    """Runs the program to its end, with at most `memory` bytes; the result has returncode, stdout, stderr. `timeout` is for
    what hangs: on a slow machine, and on a disk that takes long to flush files, a second becomes a minute."""
    limit = memory and (lambda: resource.setrlimit(resource.RLIMIT_AS, (memory, memory)))
    return subprocess.run([SANDGLASS, *map(str, arguments)], cwd=cwd, timeout=timeout, text=True,
                          errors="surrogateescape", preexec_fn=limit,
                          stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE)


def hold(running, out):
    """Stops a run (SIGSTOP), so that whatever is done to it meets it in the middle, on a fast and on a busy machine. False,
    and it goes on, if it had written all its results by then."""
    running.send_signal(signal.SIGSTOP)
    state = os.waitid(os.P_PID, running.pid, os.WSTOPPED | os.WEXITED | os.WNOWAIT)
    if state.si_code == os.CLD_STOPPED and not (out / "summary.json").exists():
        return True
    running.send_signal(signal.SIGCONT)
    return False


def fingerprint(folder):
    """Every file of a folder with its bytes and its time of change: what "nothing touched" means."""
    return {str(path.relative_to(folder)): (path.stat().st_mtime_ns, hashlib.sha256(path.read_bytes()).hexdigest())
            for path in sorted(pathlib.Path(folder).rglob("*")) if path.is_file()}


@functools.cache
def tiny_run():
    """A finished run of TINY, made once."""
    folder = pathlib.Path(tempfile.mkdtemp(prefix="sandglass-cli-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    (folder / "tiny.toml").write_text(TINY)
    result = sandglass("run", folder / "tiny.toml", "-o", folder / "out")
    assert result.returncode == DONE, result.stderr
    return folder / "out"


class Case(unittest.TestCase):
    """A test in a folder of its own, `self.folder`, with the tiny configuration in it as `tiny.toml`."""

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="sandglass-cli-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        self.tiny = self.folder / "tiny.toml"
        self.tiny.write_text(TINY)

    def copy_of_tiny_run(self, out):
        shutil.copytree(tiny_run(), out)

    def run_ok(self, *arguments, **options):
        result = sandglass(*arguments, **options)
        self.assertEqual(result.returncode, DONE, result.stdout + result.stderr)
        return result

    def refused(self, *arguments, saying=(), **options):
        """The command ends with exit code 2 and a message on standard error that has every one of the words `saying`."""
        result = sandglass(*arguments, **options)
        message = result.stderr
        self.assertEqual(result.returncode, BAD_INPUT, result.stdout + message)
        for word in saying:
            self.assertIn(word.lower(), message.lower())
        return message

    @contextlib.contextmanager
    def untouched(self, folder):
        before = fingerprint(folder)
        yield
        self.assertEqual(fingerprint(folder), before)
