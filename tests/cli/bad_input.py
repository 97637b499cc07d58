"""Bad input: one clear message, exit code 2, nothing touched."""

import os
import subprocess
import time
import unittest

import h5py

import program


class Configuration(program.Case):
    def refused_by(self, *settings, saying):
        arguments = [part for setting in settings for part in ("--set", setting)]
        out = self.folder / "out"
        with self.untouched(self.folder):
            message = self.refused("run", self.tiny, "-o", out, *arguments, saying=saying)
        self.assertFalse(out.exists(), message)

    def refused_text(self, text, saying):
        self.tiny.write_text(text)
        out = self.folder / "out"
        self.refused("run", self.tiny, "-o", out, saying=["tiny.toml", *saying])
        self.assertFalse(out.exists())

    def test_misspelt_keys(self):
        self.refused_by("system.packing_fracton=0.3", saying=["packing_fracton", "system.packing_fraction"])
        self.refused_text("[collision]\nrestituion = 0.9\n", saying=["restituion", "collision.restitution", ":2"])
        self.refused_text("[sytem]\nparticles = 200\n", saying=["sytem", "system"])

    def test_wrong_types(self):
        self.refused_by("system.particles=many", saying=["system.particles", "integer"])
        self.refused_by("collision.restitution=true", saying=["collision.restitution", "number"])
        self.refused_by("drive.kind=3", saying=["drive.kind", "pair"])
        self.refused_by("drive.kind=pairs", saying=["drive.kind", "pair"])
        self.refused_text("[system]\nparticles = \"200\"\n", saying=["system.particles", ":2"])
        self.refused_text("[system\nparticles = 200\n", saying=["TOML"])

    def test_packing_fractions(self):
        for value in ("0", "-0.1", "0.95", "nan", "inf"):
            self.refused_by(f"system.packing_fraction={value}", saying=["packing_fraction"])
        # In range, but not to be reached by random insertion; the message names a method that does.
        self.refused_by("system.packing_fraction=0.6", saying=["insert", "0.45", "quench"])

    def test_restitutions(self):
        for value in ("0", "-0.5", "1.01", "nan"):
            self.refused_by(f"collision.restitution={value}", saying=["collision.restitution"])

    def test_numbers_of_disks(self):
        self.refused_by("system.particles=201", saying=["system.particles"])
        for value in ("0", "1", "-2"):
            self.refused_by(f"system.particles={value}", saying=["particles"])
        # Two disks at this density would need a box that is too small for an exact run.
        self.refused_by("system.particles=2", saying=["box"])

    def test_reach_beyond_half_the_box(self):
        self.refused_by("drive.partner=within", "drive.reach=100", saying=["drive.reach", "at most"])

    def test_lengths(self):
        self.refused_by("run.collisions=10", "run.intervals=6", saying=["run.intervals", "at most 5"])
        self.refused_by("collision.restitution=0.9999", saying=["collision.restitution", "0.999"])

    def test_other_values(self):
        self.refused_by("run.intervals=0", saying=["run.intervals"])
        self.refused_by("run.collisions=0", saying=["run.collisions"])
        self.refused_by("run.seed", saying=["run.seed"])

    def test_missing_configuration(self):
        with self.untouched(self.folder):
            self.refused("run", self.folder / "nowhere.toml", "-o", self.folder / "out", saying=["nowhere.toml"])
        self.assertFalse((self.folder / "out").exists())


class CommandLine(program.Case):
    def test_unknown_command_or_option(self):
        self.refused("rum", saying=["rum", "run"])
        self.refused("run", self.tiny, "--ouput", "x", saying=["--ouput"])
        self.refused("run", saying=["run"])
        self.refused("run", self.tiny, "-o", saying=["-o"])


class OutputFolder(program.Case):
    def setUp(self):
        super().setUp()
        self.out = self.folder / "out"

    def test_folder_that_holds_another_run(self):
        self.copy_of_tiny_run(self.out)
        with self.untouched(self.out):
            self.refused("run", self.tiny, "-o", self.out, saying=["--force"])
            self.refused("run", self.tiny, "-o", self.out, "--set", "run.seed=2", saying=["--force"])
            # --resume continues the same run only.
            self.refused("run", self.tiny, "-o", self.out, "--resume", "--set", "run.seed=2", saying=["run.seed"])
            # Bad input is found before --force takes anything away.
            self.refused("run", self.tiny, "-o", self.out, "--force", "--set", "run.sed=2", saying=["run.seed"])

    def test_folder_locked_by_another_process(self):
        running = subprocess.Popen(
            [program.SANDGLASS, "run", self.tiny, "-o", self.out, "--set", "run.collisions=1000000"],
            stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            deadline = time.monotonic() + 60
            while not (self.out / "config.toml").exists() and time.monotonic() < deadline:
                time.sleep(0.05)
            self.refused("run", self.tiny, "-o", self.out, "--force", saying=["another"])
            self.assertIsNone(running.poll(), "the first run goes on")
        finally:
            running.kill()
            running.wait()

    def test_a_file_in_the_place_of_the_folder(self):
        self.out.write_text("mine")
        with self.untouched(self.folder):
            self.refused("run", self.tiny, "-o", self.out, saying=["out"])

    def test_unwritable_folder(self):
        # /proc lets not even root make a folder.
        self.refused("run", self.tiny, "-o", "/proc/sandglass/out", saying=["/proc/sandglass"])
        if os.geteuid() != 0:
            self.out.mkdir(mode=0o500)
            self.refused("run", self.tiny, "-o", self.out / "run", saying=[str(self.out)])


class StartFile(program.Case):
    def setUp(self):
        super().setUp()
        self.copy_of_tiny_run(self.folder / "source")
        self.start = self.folder / "source" / "trajectory.h5"

    def refused_start(self, start, *settings, saying):
        arguments = [part for setting in ("prepare.method=file", f"prepare.file={start}", *settings)
                     for part in ("--set", setting)]
        out = self.folder / "out"
        with self.untouched(self.folder):
            self.refused("run", self.tiny, "-o", out, *arguments, saying=saying)
        self.assertFalse(out.exists())

    def test_overlaps(self):
        with h5py.File(self.start, "r+") as file:
            position = file["particles/all/position/value"]
            position[-1, 5] = position[-1, 9] + [0.5, 0.0]
        self.refused_start(self.start, saying=["overlap"])

    def test_not_a_number(self):
        with h5py.File(self.start, "r+") as file:
            file["particles/all/position/value"][-1, 5] = float("nan")
        self.refused_start(self.start, saying=[])

    def test_another_size(self):
        self.refused_start(self.start, "system.particles=400", saying=["100", "200", "system.particles"])
        self.refused_start(self.start, "system.size_ratio=1.2", saying=["1.2"])

    def test_no_such_file(self):
        self.refused_start(self.folder / "nowhere.h5", saying=["nowhere.h5"])

    def test_not_a_state(self):
        junk = self.folder / "junk.h5"
        junk.write_bytes(b"not hdf5" * 1000)
        self.refused_start(junk, saying=["junk.h5"])

    def test_a_damaged_checkpoint(self):
        path = self.folder / "source" / "checkpoint.h5"
        damaged = bytearray(path.read_bytes())
        damaged[len(damaged) // 2] ^= 0x10
        path.write_bytes(damaged)
        for previous in path.parent.glob("checkpoint.previous.h5"):
            previous.unlink()
        self.refused_start(path, saying=["checkpoint.h5"])


if __name__ == "__main__":
    unittest.main()
