"""Memory that fails: one bit of the engine's records is flipped while the program runs.

Each record is a cache line: x, y, vx, vy, time, next_time, radius (doubles), then partner, next, species and the number
of neighbours. Its table is found in the process by the radii. Sampled self-checks must find every flip that moves
energy or momentum by more than rounding; a disk that merely stands a little elsewhere is a valid fluid, and only the
witness of --paranoid can know."""

import collections
import re
import signal
import struct
import subprocess
import sys
import time
import unittest

import faults
import program

FIELDS = ("x", "y", "vx", "vy", "time", "next_time", "radius", "rest")
DISKS = 400


def find_records(pid):
    """Address of the table of records, or None."""
    with open(f"/proc/{pid}/maps") as maps, open(f"/proc/{pid}/mem", "rb") as memory:
        for line in maps:
            match = re.match(r"([0-9a-f]+)-([0-9a-f]+) rw-p 00000000 00:00 0\s*$", line)
            if not match:
                continue
            first, last = (int(text, 16) for text in match.groups())
            memory.seek(first)
            try:
                block = memory.read(min(last - first, 1 << 24))
            except OSError:
                continue
            radii = [struct.unpack_from("<d", block, at + 48)[0] for at in range(0, len(block) - 63, 64)]
            run = 0
            for index, radius in enumerate(radii):
                run = run + 1 if radius in (1.0, 1.43) else 0
                if run == DISKS:
                    return first + 64 * (index - DISKS + 1)
    return None


class MemoryBits(program.Case):
    def flip(self, running, bit_of_record):
        """Stops the process, flips the bit in one record, lets it go on; False if it was at no table just then."""
        running.send_signal(signal.SIGSTOP)
        try:
            table = find_records(running.pid)
            if table is None:
                return False
            with open(f"/proc/{running.pid}/mem", "r+b", buffering=0) as memory:
                place = table + 64 * faults.RANDOM.randrange(DISKS) + bit_of_record // 8
                memory.seek(place)
                byte = memory.read(1)[0]
                memory.seek(place)
                memory.write(bytes([byte ^ 1 << bit_of_record % 8]))
            return True
        finally:
            running.send_signal(signal.SIGCONT)

    def one_flip(self, turn, bit, *options):
        """How a run ended in which this bit was flipped: "found", "crashed" or "hung" (it must then resume to the right
        bits), "unharmed" or "different"."""
        expected, seconds, _ = faults.undisturbed()
        out = self.folder / f"run{turn}-{bit}{len(options)}"
        running = faults.start(self.config, out, *options)
        try:
            time.sleep(faults.RANDOM.uniform(0.5, 0.8) * seconds)
            while running.poll() is None and not self.flip(running, bit):
                time.sleep(0.01)
            code, text = faults.finish(running, timeout=60 + 20 * seconds)
        except subprocess.TimeoutExpired:
            running.kill()
            running.communicate()
            code, text = "hung", ""
        if code == faults.DONE:
            return "unharmed" if faults.results(out) == expected else "different"
        if code == faults.FAILURE:
            self.assertTrue("self-check" in text or "run has gone wrong" in text or "collapse" in text, text)
            self.assertTrue((out / "run.log").exists())
        elif code != "hung":
            self.assertLess(code, 0, text)  # died of a signal
        again, text = faults.finish(faults.start(self.config, out))
        self.assertEqual(again, faults.DONE, text)
        self.assertEqual(faults.results(out), expected)
        return {faults.FAILURE: "found", "hung": "hung"}.get(code, "crashed")

    def setUp(self):
        super().setUp()
        self.config = faults.write_config(self.folder)
        probe = faults.start(self.config, self.folder / "probe")
        try:
            open(f"/proc/{probe.pid}/mem", "r+b", buffering=0).close()
        except OSError as error:
            self.skipTest(f"the memory of another process cannot be written here: {error}")
        finally:
            probe.kill()
            probe.communicate()

    def campaign(self, turns, choose, *options):
        outcomes = collections.defaultdict(collections.Counter)
        for turn in range(turns):
            bit = choose()
            outcomes[FIELDS[bit // 64]][self.one_flip(turn, bit, *options)] += 1
        print(f"\nseed {faults.SEED}", *options)
        for field, counts in outcomes.items():
            print(f"  {field:10}", dict(counts))
        return sum(outcomes.values(), collections.Counter())

    def test_velocities(self):
        # The upper bits of vx and vy: sign, exponent, and the mantissa down to 2^-20 of the velocity.
        chosen = self.campaign(4 * faults.TIMES,
                               lambda: 64 * faults.RANDOM.choice((2, 3)) + faults.RANDOM.randrange(32, 64))
        self.assertEqual(chosen["different"], 0)

    def test_any_bit_under_a_witness(self):
        chosen = self.campaign(3 * faults.TIMES, lambda: faults.RANDOM.randrange(512), "--paranoid")
        self.assertEqual(chosen["different"], 0)

    @unittest.skipIf(faults.TIMES == 1, "only counted, in long campaigns")
    def test_any_bit(self):
        self.campaign(5 * faults.TIMES, lambda: faults.RANDOM.randrange(512))


if __name__ == "__main__":
    unittest.main()
