"""What a user gets: the files of a run, the same bits again, resuming, starting from another run."""

import json
import shutil
import signal
import subprocess
import time
import unittest

import h5py
import numpy

import program

SUMMARY_KEYS = """version seed particles packing_fraction restitution box_length time collisions collisions_per_particle
temperature collision_rate compressibility_factor kick_amplitude kick_frequency elastic_collision_fraction momentum
stationary errors wall_seconds collisions_per_second state_hash""".split()


def summary(folder):
    return json.loads((folder / "summary.json").read_text())


class OneRun(program.Case):
    def test_files_of_a_run(self):
        out = self.folder / "runs" / "tiny"  # both folders are made
        result = self.run_ok("run", self.tiny, "-o", out)
        for name in "config.toml summary.json observables.h5 trajectory.h5 checkpoint.h5 report.html run.log".split():
            self.assertTrue((out / name).is_file(), name)
            self.assertGreater((out / name).stat().st_size, 0, name)
        self.assertEqual([path.name for path in out.rglob("*.partial")], [])
        self.assertIn("report.html", result.stdout + result.stderr)

        numbers = summary(out)
        self.assertEqual([key for key in SUMMARY_KEYS if key not in numbers], [])
        self.assertEqual(sorted({"all", "small", "big"} - set(numbers["temperature"])), [])
        self.assertEqual((numbers["particles"], numbers["restitution"]), (200, 0.5))
        self.assertAlmostEqual(numbers["packing_fraction"], 0.3, delta=1e-12)  # of the box and disks that are there
        self.assertEqual(len(numbers["momentum"]), 2)
        # Pair kicks and collisions conserve momentum: what is left is rounding, one of 2^-53 of a momentum of order 1
        # at each of some 10^4 changes of a velocity.
        self.assertLess(max(map(abs, numbers["momentum"])), 1e-9)
        self.assertRegex(numbers["state_hash"], r"^[0-9a-f]{16}$")
        self.assertGreaterEqual(numbers["collisions_per_particle"], 20)
        self.assertAlmostEqual(numbers["collisions_per_particle"], 2 * numbers["collisions"] / 200, places=6)

        self.check_observables(out)
        self.check_trajectory(out, numbers)

    def check_observables(self, out):
        with h5py.File(out / "observables.h5") as file:
            for species in ("all", "small", "big"):
                for name in ("mean_square_displacement", "velocity_autocorrelation", "self_intermediate_scattering"):
                    group = file[f"dynamics/{species}/{name}"]
                    lags = group["time"].shape[0]
                    self.assertGreater(lags, 5)
                    for leaf in ("time", "collisions", "value", "error", "count"):
                        self.assertEqual(group[leaf].shape[-1], lags, group[leaf].name)
                        self.assertIn("unit", group[leaf].attrs, group[leaf].name)
                    self.assertTrue((numpy.diff(group["time"][:]) > 0).all())
                scattering = file[f"dynamics/{species}/self_intermediate_scattering"]
                # The nearest that the box allows: steps of 2 pi / L = 0.11 here, sets of equal |k| much closer.
                numpy.testing.assert_allclose(scattering["wavenumber"][:], [0.5, 3.0], atol=0.05)
                self.assertEqual(scattering["value"].shape[0], 2)
                displacement = file[f"dynamics/{species}/mean_square_displacement"]
                seen = displacement["count"][:].reshape(-1) > 0
                self.assertTrue((displacement["value"][:].reshape(-1)[seen] >= 0).all())

    def check_trajectory(self, out, numbers):
        length = numbers["box_length"]
        with h5py.File(out / "trajectory.h5") as file:
            disks = file["particles/all"]
            numpy.testing.assert_array_equal(disks["box/edges"][:], [length, length])
            position = disks["position/value"][:]
            self.assertEqual(position.shape, (3, 200, 2))
            self.assertTrue(((position >= 0) & (position < length)).all())
            self.assertEqual(disks["velocity/value"].shape, (3, 200, 2))
            self.assertEqual(disks["image/value"].shape, (3, 200, 2))
            times = disks["position/time"][:]
            # Evenly spaced and both ends included; frames are placed to rounding.
            numpy.testing.assert_allclose(times[1] - times[0], times[2] - times[1], rtol=1e-9)
            species = disks["species"][:]
            radius = disks["radius"][:]
            self.assertEqual([(species == kind).sum() for kind in (0, 1)], [100, 100])
            numpy.testing.assert_array_equal(radius, numpy.where(species == 0, 1.0, 1.43))
            for frame in position:
                separation = frame[:, None, :] - frame[None, :, :]
                separation -= length * numpy.round(separation / length)
                distance = numpy.hypot(separation[..., 0], separation[..., 1]) + 1e9 * numpy.eye(200)
                # Contact times are rounded to 2^-53 of the time: overlaps stay far below 1e-9.
                self.assertGreater((distance - radius[:, None] - radius[None, :]).min(), -1e-9)

    def test_the_written_configuration_is_complete(self):
        self.run_ok("run", self.tiny, "-o", self.folder / "a", "--set", "run.seed=7", "--set", "collision.restitution=0.8")
        self.run_ok("run", self.folder / "a" / "config.toml", "-o", self.folder / "b")
        first, second = summary(self.folder / "a"), summary(self.folder / "b")
        self.assertEqual(first["seed"], 7)
        self.assertEqual(first["restitution"], 0.8)
        self.assertEqual(first["state_hash"], second["state_hash"])

    def test_seeds(self):
        hashes = []
        for name, seed in (("a", 1), ("b", 1), ("c", 2)):
            self.run_ok("run", self.tiny, "-o", self.folder / name, "--set", f"run.seed={seed}")
            hashes.append(summary(self.folder / name)["state_hash"])
        self.assertEqual(hashes[0], hashes[1])
        self.assertNotEqual(hashes[0], hashes[2])

    def test_no_trajectory_on_request(self):
        self.run_ok("run", self.tiny, "-o", self.folder / "out", "--set", "output.trajectory_frames=0")
        self.assertFalse((self.folder / "out" / "trajectory.h5").exists())

    def test_every_drive_runs(self):
        for kind in ("single", "none"):
            self.run_ok("run", self.tiny, "-o", self.folder / kind, "--set", f"drive.kind={kind}")
        self.run_ok("run", self.tiny, "-o", self.folder / "within", "--set", "drive.partner=within")
        elastic = ("--set", "drive.kind=none", "--set", "collision.restitution=1")
        self.run_ok("run", self.tiny, "-o", self.folder / "elastic", *elastic)
        # The start has T = 1 exactly and nothing changes the energy: 2^-53 at each of some 10^4 changes of a velocity.
        self.assertAlmostEqual(summary(self.folder / "elastic")["temperature"]["all"], 1, delta=1e-9)


class Again(program.Case):
    def setUp(self):
        super().setUp()
        self.out = self.folder / "out"
        self.copy_of_tiny_run(self.out)

    def test_resume_on_a_finished_run(self):
        before = program.fingerprint(self.out)
        self.run_ok("run", self.tiny, "-o", self.out, "--resume")
        after = program.fingerprint(self.out)
        for name in ("config.toml", "summary.json", "observables.h5", "trajectory.h5", "checkpoint.h5"):
            self.assertEqual(before[name], after[name], name)

    def test_resume_without_a_checkpoint_starts(self):
        self.run_ok("run", self.tiny, "-o", self.folder / "new", "--resume")
        self.assertEqual(summary(self.folder / "new")["state_hash"], summary(self.out)["state_hash"])

    def test_force_replaces_the_run_and_nothing_else(self):
        (self.out / "notes.txt").write_text("mine")
        self.run_ok("run", self.tiny, "-o", self.out, "--force", "--set", "run.seed=3")
        self.assertEqual(summary(self.out)["seed"], 3)
        self.assertEqual((self.out / "notes.txt").read_text(), "mine")

    def test_start_from_another_run(self):
        for source in ("checkpoint.h5", "trajectory.h5"):
            out = self.folder / f"from-{source}"
            self.run_ok("run", self.tiny, "-o", out, "--set", "prepare.method=file",
                        "--set", f"prepare.file={self.out / source}", "--set", "collision.restitution=0.7",
                        "--set", "system.packing_fraction=0.25")
            self.assertAlmostEqual(summary(out)["packing_fraction"], 0.25, delta=1e-12)

    def test_start_from_a_prepared_state(self):
        state = self.folder / "state.h5"
        self.run_ok("prepare", self.tiny, "-o", state)
        out = self.folder / "prepared"
        self.run_ok("run", self.tiny, "-o", out, "--set", "prepare.method=file", "--set", f"prepare.file={state}")
        # The same centres as `run` makes itself, the same seed: the same run.
        self.assertEqual(summary(out)["state_hash"], summary(self.out)["state_hash"])

    def test_a_moved_run_is_whole(self):
        moved = self.folder / "moved"
        shutil.move(self.out, moved)
        self.run_ok("run", self.tiny, "-o", moved, "--resume")


class Stopped(program.Case):
    """A run that is stopped while it measures goes on to the same bits."""

    def held(self, out, *settings):
        """A run that is held while it measures."""
        arguments = [part for setting in (*self.LONGER, *settings) for part in ("--set", setting)]
        while True:
            running = subprocess.Popen([program.SANDGLASS, "run", self.tiny, "-o", out, *arguments], text=True,
                                       stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
            self.addCleanup(running.stderr.close)
            self.addCleanup(running.kill)
            if not any(line.startswith("measuring") for line in running.stderr):
                self.fail(f"{out} never came to measuring")
            if program.hold(running, out):
                return running
            running.wait(300)  # it was over before it could be held
            shutil.rmtree(out)

    def go_on(self, out):
        arguments = [part for setting in self.LONGER for part in ("--set", setting)]
        self.run_ok("run", self.tiny, "-o", out, *arguments, "--resume")
        return summary(out)["state_hash"]

    def last_written(self, path):
        try:
            return path.stat().st_mtime_ns
        except FileNotFoundError:
            return None

    # A second or so of measuring. Elastic and without drive, so that nothing is calibrated and it starts at once.
    LONGER = ("run.collisions=30000", "drive.kind=none", "collision.restitution=1", "output.trajectory_frames=11")

    def datasets(self, out):
        with h5py.File(out / "observables.h5") as file:
            names = []
            file.visititems(lambda name, item: names.append(name) if isinstance(item, h5py.Dataset) else None)
            return {name: file[name][...].tobytes() for name in names}

    def test_stopped_and_resumed(self):
        whole = self.go_on(self.folder / "whole")  # --resume without anything to resume starts
        results = self.datasets(self.folder / "whole")

        asked = self.folder / "asked"
        running = self.held(asked)
        running.send_signal(signal.SIGTERM)
        running.send_signal(signal.SIGCONT)
        self.assertEqual(running.wait(300), 75)
        self.assertFalse((asked / "summary.json").exists())
        self.assertEqual(self.go_on(asked), whole)
        self.assertEqual(self.datasets(asked), results)

        killed = self.folder / "killed"
        running = self.held(killed, "output.checkpoint_seconds=0.05")
        before = self.last_written(killed / "checkpoint.h5")
        running.send_signal(signal.SIGCONT)
        while self.last_written(killed / "checkpoint.h5") in (None, before):  # until there is one of the measurement
            time.sleep(0.01)
        running.kill()
        running.wait(300)
        with h5py.File(killed / "trajectory.h5") as file:  # readable, its first frame written
            self.assertEqual(len(file["particles/all/position/step"]), 11)
            self.assertGreaterEqual(file["particles/all/position/step"][0], 0)
        self.assertEqual(self.go_on(killed), whole)
        self.assertEqual(self.datasets(killed), results)


class Speaking(program.Case):
    def test_help_and_version(self):
        for arguments in (["--help"], ["run", "--help"], ["info"]):
            self.assertTrue(self.run_ok(*arguments).stdout.strip(), arguments)
        self.assertIn("0.1.0", self.run_ok("--version").stdout)

    def test_plain_lines_when_not_on_a_terminal(self):
        result = self.run_ok("run", self.tiny, "-o", self.folder / "out")
        self.assertNotIn("\r", result.stdout + result.stderr)
        self.assertNotIn("\x1b", result.stdout + result.stderr)


if __name__ == "__main__":
    unittest.main()
