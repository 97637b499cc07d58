"""Files that rot: a damaged checkpoint is recognised, the one before it is used, and where none is left it is said."""

import json
import os
import pathlib
import resource
import shutil
import signal
import subprocess
import time
import unittest

import h5py

import faults
import program


def flip_bit(path, bit):
    data = bytearray(path.read_bytes())
    data[bit // 8] ^= 1 << bit % 8
    path.write_bytes(data)


class Damage(program.Case):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.expected, _, _ = faults.undisturbed()
        cls.scratch = program.tempfile.mkdtemp(prefix="sandglass-faults-")
        cls.addClassCleanup(shutil.rmtree, cls.scratch, ignore_errors=True)
        folder = pathlib.Path(cls.scratch)
        cls.config = faults.write_config(folder)
        # A run in the middle, with two checkpoints.
        cls.half = folder / "half"
        running = faults.held(lambda: faults.start(cls.config, cls.half), cls.half, "checkpoint.previous.h5",
                              "observables.h5")
        running.send_signal(signal.SIGTERM)
        running.send_signal(signal.SIGCONT)
        assert faults.finish(running)[0] == faults.RESUMABLE

    def damaged(self, name):
        out = self.folder / name
        shutil.copytree(self.half, out)
        return out

    def ends_right(self, out):
        code, text = faults.finish(faults.start(self.config, out))
        self.assertEqual(code, faults.DONE, text)
        self.assertEqual(faults.results(out), self.expected)

    def is_refused(self, out, *words):
        before = program.fingerprint(out)
        code, text = faults.finish(faults.start(self.config, out))
        self.assertEqual(code, faults.BAD_INPUT, text)
        for word in words:
            self.assertIn(word, text)
        after = program.fingerprint(out)
        self.assertEqual(before, after)

    def test_truncated(self):
        size = (self.half / "checkpoint.h5").stat().st_size
        for turn, length in enumerate([0, 1, 511, 512, 513, size - 1] +
                                      [faults.RANDOM.randrange(size) for _ in range(2 * faults.TIMES)]):
            out = self.damaged(f"truncated{turn}")
            with open(out / "checkpoint.h5", "r+b") as file:
                file.truncate(length)
            self.ends_right(out)

    def test_flipped_bits(self):
        size = (self.half / "checkpoint.h5").stat().st_size
        for turn in range(5 * faults.TIMES):
            out = self.damaged(f"flipped{turn}")
            flip_bit(out / "checkpoint.h5", faults.RANDOM.randrange(8 * size))
            self.ends_right(out)

    def test_both_checkpoints_damaged(self):
        out = self.damaged("both")
        for name in ("checkpoint.h5", "checkpoint.previous.h5"):
            flip_bit(out / name, 8 * 5000)
        self.is_refused(out, "no checkpoint can be used", "--force")

    def test_newest_gone(self):
        out = self.damaged("gone")
        (out / "checkpoint.h5").unlink()
        self.ends_right(out)

    def test_configuration_gone(self):
        out = self.damaged("without")
        (out / "config.toml").unlink()
        code, text = faults.finish(faults.start(self.config, out, "--set", "run.seed=5"))
        self.assertEqual(code, faults.BAD_INPUT, text)  # the checkpoint knows whose it is
        self.ends_right(out)
        self.assertTrue((out / "config.toml").exists())

    def test_start_damaged_or_gone(self):
        for name in ("damaged", "gone"):
            out = self.folder / name
            running = faults.held(lambda: faults.start(self.config, out), out, "checkpoint.h5")
            running.kill()
            faults.finish(running)
            if name == "damaged":
                flip_bit(out / "start.h5", 8 * 5000)
            else:
                (out / "start.h5").unlink()
            self.ends_right(out)

    def test_trajectory_gone_or_damaged(self):
        out = self.damaged("gone")
        (out / "trajectory.h5").unlink()
        code, text = faults.finish(faults.start(self.config, out))
        self.assertEqual(code, faults.DONE, text)
        self.assertEqual(json.loads((out / "summary.json").read_text())["state_hash"], self.expected["state_hash"])
        self.assertIn("trajectory.h5 was gone", (out / "run.log").read_text())
        # A part of it, something else, a pipe: left as it is, for whoever may still want its frames.
        for name, spoil in (("cut", lambda path: os.truncate(path, path.stat().st_size // 2)),
                            ("text", lambda path: path.write_text("my notes")),
                            ("pipe", lambda path: (path.unlink(), os.mkfifo(path)))):
            out = self.damaged(name)
            spoil(out / "trajectory.h5")
            code, text = faults.finish(faults.start(self.config, out))
            self.assertEqual(code, faults.BAD_INPUT, text)
            self.assertIn("Move trajectory.h5 away", text)

    def test_pipes_in_place_of_files_keep_nobody_waiting(self):
        out = self.damaged("pipes")
        for name in ("run.log", "checkpoint.h5", "observables.h5", "report.html"):
            (out / name).unlink(missing_ok=True)
            os.mkfifo(out / name)
        for name in ("config.toml", "checkpoint.h5", "observables.h5", "summary.json", "trajectory.h5", "report.html"):
            os.mkfifo(out / f"{name}.partial")
        self.ends_right(out)

    def test_the_previous_checkpoint_of_a_calibration(self):
        out = self.folder / "calibrating"
        running = faults.start(self.config, out, "--set", "output.checkpoint_seconds=0.01")
        while not (out / "checkpoint.previous.h5").exists():
            time.sleep(0.005)
        running.kill()
        faults.finish(running)
        if not (out / "start.h5").exists() or (out / "observables.h5").exists():
            self.skipTest("the calibration was over")
        (out / "checkpoint.h5").write_bytes(b"nothing")
        code, text = faults.finish(faults.start(self.config, out))
        self.assertEqual(code, faults.DONE, text)
        self.assertEqual(faults.results(out), self.expected)
        self.assertIn("calibration of the drive from the previous checkpoint", (out / "run.log").read_text())

    def test_checkpoint_of_another_run(self):
        out = self.folder / "other"
        other = self.folder / "other.toml"
        other.write_text(faults.CONFIG + "\n[drive]\ntemperature = 2.0\n")
        running = faults.start(other, out)
        while not (out / "observables.h5").exists():
            time.sleep(0.02)
        running.send_signal(signal.SIGTERM)
        faults.finish(running)
        self.is_refused(out, "drive.temperature")
        # The files of this run, the checkpoints of the other.
        mixed = self.damaged("mixed")
        for name in ("checkpoint.h5", "checkpoint.previous.h5"):
            shutil.copy(out / name, mixed / name)
        self.is_refused(mixed, "drive.temperature", "checkpoint")

    def test_too_little_memory(self):
        def limit():
            resource.setrlimit(resource.RLIMIT_AS, (300 << 20, 300 << 20))

        command = [program.SANDGLASS, "run", str(self.config), "-o", str(self.folder / "big")]
        for particles in ("2_000_000", "2_000_000_000"):
            refused = subprocess.run([*command, "--set", f"system.particles={particles}"], preexec_fn=limit, text=True,
                                     stderr=subprocess.PIPE, timeout=100)
            self.assertEqual(refused.returncode, faults.BAD_INPUT, refused.stderr)
            self.assertIn("GB of memory", refused.stderr)
            self.assertFalse((self.folder / "big").exists())

    def test_two_runs_in_one_folder(self):
        out = self.folder / "shared"
        first = faults.start(self.config, out)
        self.addCleanup(first.kill)
        first.stdout.readline()  # the preparation has begun: the folder is locked
        first.send_signal(signal.SIGSTOP)
        code, text = faults.finish(faults.start(self.config, out))
        self.assertEqual(code, faults.BAD_INPUT, text)
        self.assertIn("in use by another run", text)
        first.send_signal(signal.SIGCONT)
        self.assertEqual(faults.finish(first)[0], faults.DONE)
        self.assertEqual(faults.results(out), self.expected)


if __name__ == "__main__":
    unittest.main()
