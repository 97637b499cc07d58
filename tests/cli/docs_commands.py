"""The commands that README.md and docs/campaigns.md show work as they stand there.

Fenced blocks marked ```sh that call build/release/sandglass or parallel are run in order, from the root of a copy of
what they need, with this program in its place. The two commands of the README install and build; they are proved
elsewhere (tests/bare), the Slurm script in tests/slurm."""

import pathlib
import re
import shlex
import shutil
import subprocess
import unittest

import program


class Pages(program.Case):
    def run_commands_of(self, page):
        blocks = re.findall(r"```sh\n(.*?)```", (program.ROOT / page).read_text(), re.DOTALL)
        commands = [line for block in blocks for line in block.replace("\\\n", " ").splitlines()
                    if line.startswith(("build/release/sandglass ", "parallel "))]
        self.assertTrue(commands, f"{page} shows no command of the program")
        for folder in ("examples", "studies"):
            (self.folder / folder).symlink_to(program.ROOT / folder)
        (self.folder / "build" / "release").mkdir(parents=True)
        (self.folder / "build" / "release" / "sandglass").symlink_to(pathlib.Path(program.SANDGLASS).resolve())
        for command in commands:
            with self.subTest(command):
                words = shlex.split(command, comments=True)
                if shutil.which(words[0]) is None and "/" not in words[0]:
                    self.skipTest(f"{words[0]} is not installed")
                done = subprocess.run(words, cwd=self.folder, timeout=900, text=True, stdin=subprocess.DEVNULL,
                                      stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
                self.assertEqual(done.returncode, 0, done.stdout)

    def test_readme(self):
        self.run_commands_of("README.md")

    def test_campaigns(self):
        self.run_commands_of("docs/campaigns.md")


class Reference(program.Case):
    def test_configuration_keys(self):
        """docs/configuration.md ends with the table that the program itself reads by."""
        page = (program.ROOT / "docs" / "configuration.md").read_text()
        table = self.run_ok("info", "--keys").stdout
        self.assertTrue(page.endswith(table), "renew the table in docs/configuration.md: sandglass info --keys")


class Studies(program.Case):
    def test_every_study_can_be_made(self):
        for study in sorted((program.ROOT / "studies").glob("*.toml")):
            with self.subTest(study.name):
                self.run_ok("sweep", "init", study, "-o", self.folder / study.stem, "--no-estimate")

    def test_the_paper_is_whole(self):
        """Ten restitutions x seventeen packing fractions, three starts each, and the large systems."""
        out = self.folder / "paper"
        self.run_ok("sweep", "init", program.ROOT / "studies" / "gholami2011.toml", "-o", out, "--no-estimate")
        rows = [line.split("\t") for line in (out / "manifest.tsv").read_text().splitlines()]
        points = [dict(zip(rows[0], row)) for row in rows[1:]]
        grid = [(p["system.packing_fraction"], p["collision.restitution"], p["seed"]) for p in points
                if p["system.particles"] == "10000"]
        self.assertEqual(len(grid), 10 * 17 * 3)
        self.assertEqual(len(set(grid)), len(grid))
        self.assertEqual(len(points) - len(grid), 14 * 3)


class Examples(program.Case):
    def test_every_example_is_a_valid_configuration(self):
        for example in sorted((program.ROOT / "examples").glob("*.toml")):
            with self.subTest(example.name):
                # The smallest run that the configuration describes, at the example's own physics.
                small = ["system.particles=200", "run.equilibrate=5", "run.collisions=20", "run.intervals=1",
                         "output.trajectory_frames=0"]
                self.run_ok("run", example, "-o", self.folder / example.stem,
                            *[part for setting in small for part in ("--set", setting)])


if __name__ == "__main__":
    unittest.main()
