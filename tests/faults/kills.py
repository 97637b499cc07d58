"""kill -9 at random moments, again and again: the run goes on from its last checkpoint and ends in the same bits."""

import time
import unittest

import faults
import program


class Kills(program.Case):
    def test_killed_at_random_moments(self):
        expected, seconds, _ = faults.undisturbed()
        config = faults.write_config(self.folder)
        print(f"\nseed {faults.SEED}")
        kills = before_checkpoint = runs = 0
        while kills < 10 * faults.TIMES:
            out = self.folder / f"run{runs}"
            runs += 1
            while True:
                running = faults.start(config, out)
                time.sleep(faults.RANDOM.uniform(0, seconds / 3))
                running.kill()
                code, text = faults.finish(running)
                if code == faults.DONE:
                    break
                self.assertEqual(code, -9, text)
                kills += 1
                before_checkpoint += not (out / "checkpoint.h5").exists()
            self.assertEqual(faults.results(out), expected)
            self.assertEqual([], list(out.glob("*.partial")))
            self.assertEqual([], list(out.glob("diagnostic*")))
        print(f"{kills} kills in {runs} runs, {before_checkpoint} before there was a checkpoint: nothing lost")

    def test_stopped_at_random_moments(self):
        expected, seconds, _ = faults.undisturbed()
        config = faults.write_config(self.folder)
        stops = 0
        for run in range(faults.TIMES):
            code = faults.RESUMABLE
            while code == faults.RESUMABLE:
                limit = faults.RANDOM.uniform(0.2, 0.5) * seconds
                running = faults.start(config, self.folder / f"run{run}", "--max-walltime", f"{limit:.3f}")
                code, text = faults.finish(running)
                stops += code == faults.RESUMABLE
            self.assertEqual(code, faults.DONE, text)
            self.assertEqual(faults.results(self.folder / f"run{run}"), expected)
        self.assertGreater(stops, 0)
        print(f"\n{stops} stops at a wall-time limit: nothing lost")


if __name__ == "__main__":
    unittest.main()
