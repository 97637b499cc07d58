"""Disks that fill up or become read-only at any moment: one clear error, and once there is room the run goes on to the
same bits. Needs to mount a small file system in memory, which only root may; skipped, and said so, where that fails."""

import shutil
import subprocess
import time
import unittest

import faults
import program


class FullDisk(program.Case):
    def setUp(self):
        super().setUp()
        self.disk = self.folder / "disk"
        self.disk.mkdir()
        self.config = faults.write_config(self.folder)
        self.mount("size=64m")
        self.addCleanup(subprocess.run, ["umount", "-l", self.disk], stderr=subprocess.DEVNULL)

    def mount(self, options):
        command = ["mount", "-t", "tmpfs", "-o", options, "none", str(self.disk)]
        mounted = subprocess.run(command, text=True, stderr=subprocess.PIPE)
        if mounted.returncode != 0:
            self.skipTest(f"cannot mount a small disk here: {mounted.stderr.strip()}")

    def remount(self, options):
        subprocess.run(["mount", "-o", f"remount,{options}", str(self.disk)], check=True)

    def empty(self):
        for path in self.disk.iterdir():
            shutil.rmtree(path) if path.is_dir() else path.unlink()

    def ends_right(self, expected):
        code, text = faults.finish(faults.start(self.config, self.disk / "out"))
        self.assertEqual(code, faults.DONE, text)
        self.assertEqual(faults.results(self.disk / "out"), expected)

    def test_small_disks(self):
        expected, _, out = faults.undisturbed()
        needed = sum(path.stat().st_size for path in out.iterdir())
        full = 0
        # From a disk where not even the first file fits to one where all but the last does.
        for size in [faults.RANDOM.randrange(4096, 3 * needed // 2) for _ in range(6 * faults.TIMES)]:
            self.empty()
            self.remount(f"size={size}")
            code, text = faults.finish(faults.start(self.config, self.disk / "out"))
            if code == faults.DONE:
                self.assertEqual(faults.results(self.disk / "out"), expected)
                continue
            full += 1
            self.assertEqual(code, faults.FAILURE, text)
            self.assertIn("No space left on device", text)
            self.remount("size=64m")
            self.ends_right(expected)
        print(f"\nseed {faults.SEED}: {full} full disks")

    def test_filling_up_while_it_runs(self):
        expected, _, _ = faults.undisturbed()
        began = time.monotonic()
        self.ends_right(expected)
        seconds = time.monotonic() - began  # this disk is faster than others
        full = 0
        for _ in range(4 * faults.TIMES):
            self.empty()
            running = faults.start(self.config, self.disk / "out")
            time.sleep(faults.RANDOM.uniform(0, seconds))
            filler = subprocess.run(["dd", "if=/dev/zero", f"of={self.disk}/filler", "bs=4k"], stderr=subprocess.DEVNULL)
            self.assertNotEqual(filler.returncode, 0)  # it ran until there was no room
            code, text = faults.finish(running)
            (self.disk / "filler").unlink()
            if code != faults.DONE:
                full += 1
                self.assertEqual(code, faults.FAILURE, text)
                self.assertIn("No space left on device", text)
            self.ends_right(expected)
        print(f"\nseed {faults.SEED}: filled up {full} times while it ran")

    def test_read_only(self):
        expected, seconds, _ = faults.undisturbed()
        for _ in range(faults.TIMES):
            self.empty()
            running = faults.start(self.config, self.disk / "out")
            time.sleep(faults.RANDOM.uniform(0.3, seconds / 2))
            # A file that is just open for writing holds the disk writable.
            while subprocess.run(["mount", "-o", "remount,ro", str(self.disk)], stderr=subprocess.DEVNULL).returncode != 0:
                time.sleep(0.001)
            code, text = faults.finish(running)
            if code != faults.DONE:
                self.assertIn(code, (faults.FAILURE, faults.BAD_INPUT), text)
                self.assertIn("Read-only file system", text)
            again, text = faults.finish(faults.start(self.config, self.disk / "out"))
            self.assertEqual(again, faults.BAD_INPUT, text)
            self.assertIn("Read-only file system", text)
            self.remount("rw")
            self.ends_right(expected)


if __name__ == "__main__":
    unittest.main()
