"""Bad input: one clear message, exit code 2, nothing touched."""

import json
import os
import random
import shutil
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

    def refused_start(self, start, *settings, saying, **options):
        arguments = [part for setting in ("prepare.method=file", f"prepare.file={start}", *settings)
                     for part in ("--set", setting)]
        out = self.folder / "out"
        with self.untouched(self.folder):
            self.refused("run", self.tiny, "-o", out, *arguments, saying=saying, **options)
        self.assertFalse(out.exists())

    def test_overlaps(self):
        with h5py.File(self.start, "r+") as file:
            position = file["particles/all/position/value"]
            position[-1, 5] = position[-1, 9] + [0.5, 0.0]
        self.refused_start(self.start, saying=["frame 2", "checksum", "/parameters/frame_checksum"])
        with h5py.File(self.start, "r+") as file:  # the change was meant
            del file["parameters/frame_checksum"]
        self.refused_start(self.start, saying=["overlap"])

    def test_not_a_number(self):
        with h5py.File(self.start, "r+") as file:
            file["particles/all/position/value"][-1, 5] = float("nan")
            del file["parameters/frame_checksum"]
        self.refused_start(self.start, saying=["centre"])

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

    def test_other_programs_files(self):
        """What h5py can make of a trajectory: refused within seconds and 2 GB, and no other file is opened."""
        other = self.folder / "other.h5"
        shutil.copy(self.start, other)
        others = h5py.File(other, "r")
        species = others["particles/all/species"][:]
        layout = h5py.VirtualLayout(shape=species.shape, dtype=species.dtype)
        layout[:] = h5py.VirtualSource(other, "particles/all/species", shape=species.shape)
        others.close()
        good = self.start.read_bytes()
        spoils = {
            "a link to another file": lambda all: all.__setitem__(
                "species", h5py.ExternalLink(str(other), "/particles/all/species")),
            "data in another file": lambda all: all.create_dataset(
                "species", (200,), "u1", external=[(str(other), 0, h5py.h5f.UNLIMITED)]),
            "a virtual dataset": lambda all: all.create_virtual_dataset("species", layout),
            "more disks than can be": lambda all: all.create_dataset("species", (2**40,), "u1", chunks=(2**20,)),
            "disks without data": lambda all: all.create_dataset("species", (2**31,), "u1", chunks=(2**20,)),
            "disks that are compressed": lambda all: all.create_dataset(
                "species", (2**31,), "u1", chunks=(2**28,), compression="gzip", fillvalue=1),
            "another compression": lambda all: all.create_dataset("species", data=species, compression="lzf"),
            "texts": lambda all: all.create_dataset("species", data=[b"small"] * 200),
            "records": lambda all: all.create_dataset("species", (200,), "u1,f8"),
            "none": lambda all: None,
        }
        for name, spoil in spoils.items():
            with self.subTest(name):
                self.start.write_bytes(good)
                with h5py.File(self.start, "r+") as file:
                    del file["particles/all/species"]
                    spoil(file["particles/all"])
                self.refused_start(self.start, saying=["trajectory.h5"], timeout=100, memory=2 << 30)

    def test_impossible_disks(self):
        good = self.start.read_bytes()
        for name, values in {"radius": -1.0, "mass": 0.0, "box/edges": 1e300, "position/value": 1e9,
                             "velocity/value": float("inf"), "position/step": -1}.items():
            with self.subTest(name):
                self.start.write_bytes(good)
                with h5py.File(self.start, "r+") as file:
                    file["particles/all"][name][...] = values
                self.refused_start(self.start, saying=[], timeout=100, memory=2 << 30)

    def test_damage_anywhere(self):
        """Read, or refused with the name of the file; never a crash, a hang, or much memory."""
        good = self.start.read_bytes()
        random_bytes = random.Random(1)
        for _ in range(40):
            damaged = bytearray(good)
            for _ in range(random_bytes.choice([1, 4, 16])):
                damaged[random_bytes.randrange(8192)] = random_bytes.choice([0, 1, 0x7f, 0xff])
            self.start.write_bytes(damaged)
            result = program.sandglass("prepare", self.tiny, "-o", self.folder / "state.h5", "--set",
                                       "prepare.method=file", "--set", f"prepare.file={self.start}",
                                       timeout=100, memory=4 << 30)
            (self.folder / "state.h5").unlink(missing_ok=True)
            self.assertIn(result.returncode, (program.DONE, program.BAD_INPUT), result.stderr)

    def test_not_a_file(self):
        pipe = self.folder / "pipe.h5"
        os.mkfifo(pipe)
        for path in (pipe, self.folder, "/dev/zero", "/dev/stdin"):
            self.refused_start(path, saying=["not a file"], timeout=100)


class NotAFile(program.Case):
    """Pipes, devices and folders in the places of files: refused at once."""

    def test_configuration(self):
        pipe = self.folder / "pipe.toml"
        os.mkfifo(pipe)
        for path in (pipe, self.folder, "/dev/zero"):
            self.refused("run", path, "-o", self.folder / "out", saying=["give a file"], timeout=100)
        large = self.folder / "large.toml"
        with open(large, "wb") as file:
            file.truncate(100_000_000)
        self.refused("run", large, "-o", self.folder / "out", saying=["longer"], timeout=100, memory=1 << 30)

    def test_in_a_run(self):
        for name in ("config.toml", "summary.json", "checkpoint.h5"):
            with self.subTest(name):
                out = self.folder / name.replace(".", "_")
                self.copy_of_tiny_run(out)
                if name == "checkpoint.h5":
                    (out / "summary.json").unlink()
                    (out / "checkpoint.previous.h5").unlink(missing_ok=True)
                (out / name).unlink()
                os.mkfifo(out / name)
                self.refused("run", self.tiny, "-o", out, "--resume", saying=[name], timeout=100)


class HostileTexts(program.Case):
    def resumed(self, name, text, code):
        out = self.folder / "out"
        shutil.rmtree(out, ignore_errors=True)
        self.copy_of_tiny_run(out)
        (out / "report.html").unlink()
        (out / name).write_text(text)
        result = program.sandglass("run", self.tiny, "-o", out, "--resume", timeout=100, memory=2 << 30)
        self.assertEqual(result.returncode, code, result.stdout + result.stderr)
        return result, out

    def test_summaries_of_a_finished_run(self):
        for text in ("[" * 10**6, '{"a":' * 10**6, "", "null", "[]", "1e400", '{"seed": "x"}', '{"seed": -1}',
                     '{"momentum": []}', '{"errors": [1]}', '{"stationary": 3}', "\x00", '{"collisions": 1e300}'):
            with self.subTest(text[:20]):
                result, _ = self.resumed("summary.json", text, program.BAD_INPUT)
                self.assertIn("summary.json", result.stderr)

    def test_configurations_of_a_run(self):
        for text in ("a." * 10**5 + "a = 1", "[" + "a." * 10**5 + "a]", "x = " + "[" * 10**5, "x = " + "{a = " * 10**5,
                     'x = "' + "\\u0000" * 10**5, "\x00"):
            with self.subTest(text[:20]):
                result, _ = self.resumed("config.toml", text, program.BAD_INPUT)
                self.assertIn("config.toml", result.stderr)

    def test_texts_of_a_summary_stay_texts_in_the_report(self):
        evil = "</script><script>alert(1)</script><img src=x onerror=alert(2)>"
        summary = json.loads((program.tiny_run() / "summary.json").read_text())
        summary["warnings"] = summary["decisions"] = [evil]
        summary["version"] = summary["state_hash"] = evil
        summary["errors"] = {evil: 1.0}
        _, out = self.resumed("summary.json", json.dumps(summary), program.DONE)
        page = (out / "report.html").read_text()
        for part in ("</script><script>alert", "<img src=x"):
            self.assertNotIn(part, page)


class HostileNames(program.Case):
    def test_folders(self):
        names = ["a'b\"c", "<script>alert(1)<_script>", "new\nline\rtab\t", "$(touch pwned);`touch pwned`|&*?", "%s%n{}{0}",
                 "\x1b[31m", "--force", os.fsdecode(b"\xff\xfe\x80")]
        for name in names:
            with self.subTest(name):
                result = program.sandglass("run", self.tiny, "-o", f"./{name}", cwd=self.folder)
                self.assertEqual(result.returncode, program.DONE, result.stderr)
                out = self.folder / name
                json.loads((out / "summary.json").read_text())
                self.assertNotIn("<script>alert", (out / "report.html").read_text())
                again = program.sandglass("run", self.tiny, "-o", f"./{name}", "--resume", cwd=self.folder)
                self.assertEqual(again.returncode, program.DONE, again.stderr)
        self.assertFalse((self.folder / "pwned").exists())
        self.assertEqual(len(list(self.folder.iterdir())), len(names) + 1)

    def test_start_file(self):
        """The path stands in config.toml and in the report."""
        source = self.folder / "a\n\"b\"<"
        source.mkdir()
        start = source / "script><script>alert(1)<!--'\\.h5"
        shutil.copy(program.tiny_run() / "checkpoint.h5", start)
        out = self.folder / "out"
        self.run_ok("run", self.tiny, "-o", out, "--set", "prepare.method=file", "--set", f"prepare.file={start}")
        self.assertNotIn("<script>alert", (out / "report.html").read_text())
        self.run_ok("run", out / "config.toml", "-o", self.folder / "again")


if __name__ == "__main__":
    unittest.main()
