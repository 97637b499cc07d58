"""sandglass figures, end to end, on a made-up study whose laws are known (tests/report/synthetic_study.py)."""

import csv
import json
import math
import os
import shutil
import subprocess
import sys
import unittest
import xml.dom.minidom

import program

sys.path.insert(0, str(program.ROOT / "tests" / "report"))
sys.path.insert(0, str(program.ROOT / "python"))
import synthetic_study


def rows_of(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


class Figures(program.Case):
    @classmethod
    def setUpClass(cls):
        import pathlib
        import tempfile
        cls.study = pathlib.Path(tempfile.mkdtemp(prefix="sandglass-figures-")) / "study"
        cls.addClassCleanup(shutil.rmtree, cls.study.parent, ignore_errors=True)
        synthetic_study.write_study(cls.study)
        cls.result = program.sandglass("figures", cls.study, "--format", "png,svg", timeout=900)

    def figure(self, number):
        return json.loads((self.study / "figures" / f"fig{number:02}.json").read_text())

    def test_every_figure_is_there(self):
        self.assertEqual(self.result.returncode, program.DONE, self.result.stderr)
        for number in range(1, 25):
            for form, start in (("csv", b"# "), ("json", b"{"), ("png", b"\x89PNG"), ("svg", b"<?xml")):
                path = self.study / "figures" / f"fig{number:02}.{form}"
                self.assertTrue(path.read_bytes().startswith(start), path)
        xml.dom.minidom.parse(str(self.study / "figures" / "fig05.svg"))
        self.assertEqual(list((self.study / "figures").glob("*.pdf")), [])
        self.assertEqual(list((self.study / "figures").glob("*.partial")), [])
        self.assertIn("runs/eta=0.82_eps=0.90_seed=1: not started", self.result.stdout)

    def test_verdicts_are_those_of_the_laws(self):
        # Laws that contradict each other: the integral of the made-up VACF is not the made-up D.
        expected = {number: "agrees" for number in range(1, 25)} | {10: "differs"}
        # The made-up tail is 1/s, so that Φ s is flat; N = 10^4 is too small for the late growth of D.
        expected |= {3: "differs", 8: "not enough data", 9: "not enough data"}
        expected |= {18: "", 22: "", 23: ""}  # shown, not judged
        self.assertEqual({n: self.figure(n)["verdict"] for n in range(1, 25)}, expected)

    def test_numbers_of_the_csv(self):
        rows = [row for row in rows_of(self.study / "figures" / "fig05.csv")
                if row["part"] == "fig05" and row["curve"] == "η = 0.8"]
        self.assertGreater(len(rows), 50)
        for row in rows:
            t, y, error = float(row["x"]), float(row["y"]), float(row["error"])
            law = synthetic_study.displacement(0.8, 0.9, t)
            # Two replicas with an error of 0.2 % each; their lags differ by 0.2 %, which interpolation takes out.
            # Error: the larger of 0.14 % and the scatter, of which two replicas give anything from none to 3 sigma.
            self.assertLess(abs(y / law - 1), 5 * 0.002 / 2**0.5)
            self.assertGreaterEqual(error, 0.0013 * law)
            self.assertLess(error, 5 * 0.002 * law)

    def test_time_to_move_by_one_radius(self):
        times = {(row["curve"], float(row["x"])): float(row["y"])
                 for row in rows_of(self.study / "figures" / "fig07.csv") if row["part"] == "fig07"}
        for eps in (0.5, 0.7, 0.9):
            t = times[f"ε = {eps}", 0.72]
            # Interpolated between lags 21 % apart, straight in logarithms: the curvature of the law leaves 1 % or less.
            self.assertAlmostEqual(synthetic_study.displacement(0.72, eps, t), 1, delta=0.02)

    def test_local_exponent_of_the_tail(self):
        rows = [row for row in rows_of(self.study / "figures" / "fig02.csv")
                if row["part"] == "fig02b" and row["curve"] == "η = 0.3" and 10 < float(row["x"]) < 100]
        self.assertGreater(len(rows), 8)
        for row in rows:  # the made-up tail is s^2 / (1 + s^2)^1.5: -1 + 3 / s^2
            self.assertLess(abs(float(row["y"]) + 1), 5 * float(row["error"]) + 0.03)

    def test_diffusion_by_both_methods_over_each_other(self):
        rows = rows_of(self.study / "figures" / "fig10.csv")
        of = lambda part, curve: {float(row["x"]): float(row["y"]) for row in rows
                                  if row["part"] == part and row["curve"] == curve}
        slope, area, ratio = of("fig10", "ε = 0.7"), of("fig10", "ε = 0.7, VACF"), of("fig10b", "ε = 0.7")
        self.assertGreater(len(ratio), 2)
        for eta, value in ratio.items():
            self.assertAlmostEqual(value, area[eta] / slope[eta], places=6)

    def test_ageing_keeps_the_intervals_apart(self):
        rows = [row for row in rows_of(self.study / "figures" / "fig22.csv") if row["part"] == "fig22b"]
        for eta, step in ((0.78, 0), (0.8, 0.1)):
            points = [row for row in rows if row["curve"] == f"η = {eta}"]
            self.assertEqual(len(points), 3)
            law = [1 / (1 + step * age) for age in (0.5, 1.5, 2.5)]
            for row, age, value in zip(points, (0.5, 1.5, 2.5), law):
                self.assertAlmostEqual(float(row["x"]), 100 * age * 1.003, places=6)  # the mean of two replicas
                self.assertAlmostEqual(float(row["y"]), value / (sum(law) / 3), places=6)

    def test_displacements_are_gaussian(self):
        rows = [row for row in rows_of(self.study / "figures" / "fig18.csv")
                if row["part"] == "fig18" and row["curve"] == "t = 10"]
        x, y = ([float(row[name]) for row in rows] for name in "xy")
        square = synthetic_study.displacement(0.8, 0.9, 10)
        for r, value in zip(x, y):
            law = 2 * r**2 / square * math.exp(-(r**2) / square)
            self.assertLess(abs(value / law - 1), 5 * synthetic_study.NOISE / 2**0.5)

    def test_report(self):
        html = (self.study / "report.html").read_text()
        self.assertIn("runs/eta%3D0.80_eps%3D0.90_seed%3D1/report.html", html)
        self.assertIn("eta=0.82_eps=0.90_seed=1", html)

    def test_only_and_format_and_output(self):
        out = self.folder / "out"
        self.run_ok("figures", self.study, "--only", "5,7", "--format", "pdf", "-o", out)
        self.assertEqual(sorted(path.name for path in out.iterdir()),
                         ["fig05.csv", "fig05.json", "fig05.pdf", "fig07.csv", "fig07.json", "fig07.pdf", "report.html"])
        self.run_ok("figures", self.study, "--only", "5", "--format", "none", "-o", out)
        self.assertFalse((out / "fig05.pdf").exists(), "a picture of older data was left")

    def test_a_single_run_keeps_its_report(self):
        run = self.folder / "run"
        self.copy_of_tiny_run(run)
        before = (run / "report.html").read_bytes()
        self.run_ok("figures", run, "--format", "png")
        self.assertEqual((run / "report.html").read_bytes(), before)
        self.assertTrue((run / "figures" / "fig01.png").exists())
        self.assertFalse((run / "figures" / "fig06.png").exists())

    def test_hostile_names_and_files(self):
        study = self.folder / "study"
        hostile = study / "runs" / "<img src=x onerror=alert(1)> 'a\"b,c $x_y$ \u2028"
        self.copy_of_tiny_run(hostile)
        self.copy_of_tiny_run(study / "runs" / "deep")
        (study / "runs" / "deep" / "observables.h5").write_bytes(b"\x89HDF\r\n\x1a\n" + bytes(100))
        broken = study / "runs" / "broken"
        self.copy_of_tiny_run(broken)
        (broken / "summary.json").write_text('{"collisions_per_particle": "many"}')
        (study / "runs" / "loop").symlink_to(study)
        done = self.run_ok("figures", study, "--format", "png", "--only", "1")
        self.assertIn("runs/broken", done.stdout)
        self.assertIn("runs/deep", done.stdout)
        html = (study / "report.html").read_text()
        self.assertNotIn("<img src", html)
        self.assertNotIn("\u2028", html)

    def test_bad_input(self):
        self.refused("figures", self.folder / "nowhere", saying=["nowhere"])
        (self.folder / "empty").mkdir()
        self.refused("figures", self.folder / "empty", saying=["no run"])
        self.refused("figures", self.study, "--only", "25", saying=["25"])
        self.refused("figures", self.study, "--only", "five")
        self.refused("figures", self.study, "--format", "gif", saying=["gif"])
        self.refused("figures")

    def test_without_matplotlib_the_data_are_written(self):
        out = self.folder / "out"
        for python, saying in (("/nonexistent/python3", "does not start"), (self.bare_python(), "no matplotlib")):
            environment = dict(os.environ, SANDGLASS_PYTHON=str(python))
            done = subprocess.run([program.SANDGLASS, "figures", self.study, "-o", out, "--only", "5"],
                                  env=environment, text=True, capture_output=True, timeout=400)
            self.assertEqual(done.returncode, program.FAILURE, done.stdout + done.stderr)
            self.assertIn(saying, done.stderr)
            self.assertTrue((out / "fig05.csv").exists() and (out / "report.html").exists())

    def bare_python(self):
        """The system's Python without site packages."""
        path = self.folder / "python"
        path.write_text('#!/bin/sh\nexec /usr/bin/python3 -S "$@"\n')
        path.chmod(0o755)
        return path

    def test_python_package_reads_a_run(self):
        import sandglass
        run = sandglass.load(program.tiny_run())
        self.assertEqual(run.summary["particles"], 200)
        self.assertEqual(run.config["system"]["particles"], 200)
        msd = run["dynamics/small/mean_square_displacement"]
        self.assertEqual(msd["time"].shape, msd["value"].shape)
        with self.assertRaises(FileNotFoundError):
            sandglass.load(self.folder)


if __name__ == "__main__":
    unittest.main()
