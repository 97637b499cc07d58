"""The commands that README.md shows work as they stand there.

Fenced blocks marked ```sh that call build/release/sandglass are run in order, from the root of a copy of what they
need, with this program in its place. The two commands of the README install and build; they are proved elsewhere
(tests/bare)."""

import pathlib
import re
import shlex
import subprocess
import unittest

import program


class Readme(program.Case):
    def test_commands(self):
        blocks = re.findall(r"```sh\n(.*?)```", (program.ROOT / "README.md").read_text(), re.DOTALL)
        commands = [line for block in blocks for line in block.replace("\\\n", " ").splitlines()
                    if line.startswith("build/release/sandglass ")]
        self.assertTrue(commands, "README.md shows no command of the program")
        (self.folder / "examples").symlink_to(program.ROOT / "examples")
        (self.folder / "build" / "release").mkdir(parents=True)
        (self.folder / "build" / "release" / "sandglass").symlink_to(pathlib.Path(program.SANDGLASS).resolve())
        for command in commands:
            with self.subTest(command):
                words = shlex.split(command, comments=True)
                done = subprocess.run(words, cwd=self.folder, timeout=200, text=True, stdin=subprocess.DEVNULL,
                                      stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
                self.assertEqual(done.returncode, 0, done.stdout)


class Reference(program.Case):
    def test_configuration_keys(self):
        """docs/configuration.md ends with the table that the program itself reads by."""
        page = (program.ROOT / "docs" / "configuration.md").read_text()
        table = self.run_ok("info", "--keys").stdout
        self.assertTrue(page.endswith(table), "renew the table in docs/configuration.md: sandglass info --keys")


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
