"""sandglass bench and the scripts of bench/: what they print, what they refuse."""

import json
import shlex
import subprocess
import sys
import unittest

import program

KEYS = """collisions_per_second state_hash rates spread ns_per_collision cpu_seconds events bytes_per_disk particles
packing_fraction restitution drive temperature collisions_per_disk aged_collisions_per_disk repeats threads
instruction_set version check""".split()
SMALL = ("--particles", "200", "--age", "10", "--collisions", "100")


def script(name, *arguments, cwd):
    return subprocess.run([sys.executable, program.ROOT / "bench" / name, *map(str, arguments)], cwd=cwd, timeout=400,
                          text=True, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE)


def prints(**result):
    """A command that prints this JSON object."""
    return shlex.join([sys.executable, "-c", f"print({json.dumps(result)!r})"])


class Bench(program.Case):
    def test_json(self):
        result = json.loads(self.run_ok("bench", "--json", *SMALL).stdout)  # and nothing else
        self.assertEqual([key for key in KEYS if key not in result], [])
        self.assertRegex(result["state_hash"], r"^[0-9a-f]{16}$")
        self.assertEqual(len(result["rates"]), 5)
        self.assertEqual(result["collisions_per_second"], sorted(result["rates"])[2])
        self.assertTrue(result["check"]["passed"])
        for figure in result["check"]["figures"]:
            self.assertLessEqual(abs(figure["measured"] - figure["expected"]), figure["tolerance"])
        again = json.loads(self.run_ok("bench", "--json", "--threads", "2", *SMALL).stdout)
        self.assertEqual(again["state_hash"], result["state_hash"])
        self.assertEqual(again["threads"], 1)

    def test_text(self):
        text = self.run_ok("bench", "--packing-fraction", "0.3", *SMALL).stdout
        for word in ("million collisions/s", "equation of state", "bytes per disk", "predictions"):
            self.assertIn(word, text)

    def test_refused(self):
        self.refused("bench", "--restitution", "0.9", saying=["--drive pair", "cool"])
        self.refused("bench", "--drive", "pair", saying=["steady"])
        self.refused("bench", "--drive", "single", saying=["--drive"])
        self.refused("bench", "--packing-fraction", "0.9", saying=["packing_fraction"])
        self.refused("bench", "--particles", "201", saying=["particles"])
        self.refused("bench", "--collisions", "-1", saying=["--collisions"])
        self.refused("bench", "--age", "1", saying=["age"])
        self.refused("bench", "--repeats", "0", saying=["repeat"])


class Compare(program.Case):
    def test_medians_and_ratios(self):
        commands = [prints(collisions_per_second=rate, state_hash="a") for rate in (2e6, 3e6)]
        done = script("compare", "--json", "--rounds", 2, *commands, cwd=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        first, second = json.loads(done.stdout)
        self.assertEqual((first["median"], second["median"]), (2e6, 3e6))
        self.assertEqual(second["ratio_of_medians"], 1.5)
        self.assertEqual(second["ratios"], {"median": 1.5, "least": 1.5, "most": 1.5})

    def test_rounds_alternate(self):
        log = self.folder / "log"
        def logs(name):
            return shlex.join(["sh", "-c", f"echo {name} >>{log}; echo '{{\"collisions_per_second\": 1}}'"])
        script("compare", "--rounds", 3, logs("a"), logs("b"), cwd=self.folder)
        self.assertEqual(log.read_text().split(), list("abbaab"))

    def test_different_work_is_refused(self):
        commands = [prints(collisions_per_second=1e6, state_hash=state) for state in "ab"]
        done = script("compare", "--rounds", 1, *commands, cwd=self.folder)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("different states", done.stderr)
        self.assertEqual(script("compare", "--rounds", 1, "--different-bits", *commands, cwd=self.folder).returncode, 0)
        # A program without a hash, such as another engine, may stand beside one with it.
        done = script("compare", "--rounds", 1, commands[0], prints(collisions_per_second=1), cwd=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_failing_commands(self):
        good = prints(collisions_per_second=1)
        for bad, word in (("false", "exit code 1"), ("echo hello", "JSON"), ("/absent/program", "cannot be started")):
            done = script("compare", good, bad, cwd=self.folder)
            self.assertNotEqual(done.returncode, 0)
            self.assertIn(word, done.stderr)


class Table(program.Case):
    def test_rows_and_lines(self):
        done = script("table", "--program", program.SANDGLASS, "--particles", "200", "--packing-fractions", "0.3,0.7",
                      "--restitutions", "0.5", "--driven-particles", "200", "--driven-packing-fraction", "0.6", "--",
                      "--age=10", "--collisions=50", cwd=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(len(done.stdout.splitlines()), 2 + 4)
        lines = [json.loads(line) for line in (self.folder / "table.jsonl").read_text().splitlines()]
        self.assertEqual([line["packing_fraction"] for line in lines], [0.3, 0.7, 0.6, 0.6])
        self.assertEqual([line["drive"] for line in lines], ["none", "none", "none", "pair"])


class Throughput(program.Case):
    def test_shares_of_the_speed_alone(self):
        steady = self.folder / "steady"
        steady.write_text("#!/bin/sh\necho '{\"collisions_per_second\": 2e6}'\n")
        steady.chmod(0o755)
        done = script("throughput", steady, "--jobs", 3, "--rounds", 2, cwd=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("each reaches 1.000 of its speed alone (median; 1.000 to 1.000), a loss of 0.0 %", done.stdout)
        self.assertEqual(script("throughput", steady, "--most-loss", "-0.01", cwd=self.folder).returncode, 1)
        self.assertNotEqual(script("throughput", "/bin/false", cwd=self.folder).returncode, 0)

    def test_with_the_program(self):
        done = script("throughput", program.SANDGLASS, "--jobs", 2, "--rounds", 1, "--particles", 200,
                      "--packing-fraction", 0.3, "--collisions", 50, "--pin", cwd=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("2 runs at a time, pinned", done.stdout)


if __name__ == "__main__":
    unittest.main()
