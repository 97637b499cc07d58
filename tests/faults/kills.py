"""kill -9 at random moments, again and again: the run goes on from its last checkpoint and ends in the same bits."""

import os
import pathlib
import signal
import subprocess
import time
import unittest

import faults
import program


class Kills(program.Case):
    def test_killed_at_random_moments(self):
        expected, seconds, _ = faults.undisturbed()
        config = faults.write_config(self.folder)
        longest = seconds / 3
        print(f"\nseed {faults.SEED}")
        kills = before_checkpoint = runs = 0
        while kills < 10 * faults.TIMES:
            out = self.folder / f"run{runs}"
            runs += 1
            while True:
                running = faults.start(config, out)
                time.sleep(faults.RANDOM.uniform(0, longest))
                running.kill()
                code, text = faults.finish(running)
                if code == faults.DONE:
                    break
                self.assertEqual(code, -9, text)
                kills += 1
                if not (out / "checkpoint.h5").exists():
                    before_checkpoint += 1
                    longest *= 1.2  # or else, on a machine that is busier now, it might never come to one
            self.assertEqual(faults.results(out), expected)
            self.assertEqual([], list(out.glob("*.partial")))
            self.assertEqual([], list(out.glob("diagnostic*")))
        print(f"{kills} kills in {runs} runs, {before_checkpoint} before there was a checkpoint: nothing lost")

    def test_stopped_at_random_moments(self):
        expected, longest, _ = faults.undisturbed()
        config = faults.write_config(self.folder)
        stops = run = 0
        while run < faults.TIMES or stops == 0:
            code = faults.RESUMABLE
            stops_before = stops
            while code == faults.RESUMABLE:
                limit = faults.RANDOM.uniform(0.2, 0.5) * longest
                running = faults.start(config, self.folder / f"run{run}", "--max-walltime", f"{limit:.3f}")
                code, text = faults.finish(running)
                stops += code == faults.RESUMABLE
                if code == faults.FAILURE and stops == stops_before:
                    self.assertIn("was over before the start was prepared", text)
                    code = faults.RESUMABLE
                longest *= 1.2  # or else, on a machine that is busier now, it might never come to its end
            self.assertEqual(code, faults.DONE, text)
            self.assertEqual(faults.results(self.folder / f"run{run}"), expected)
            if stops == stops_before:  # the undisturbed run was slow, the machine being busy then
                longest /= 2
            run += 1
        print(f"\n{stops} stops at a wall-time limit: nothing lost")

    def test_signals(self):
        expected, _, _ = faults.undisturbed()
        config = faults.write_config(self.folder)
        for name in ("SIGTERM", "SIGINT", "SIGUSR1"):
            out = self.folder / name
            running = faults.held(lambda: faults.start(config, out), out, "checkpoint.h5")
            running.send_signal(getattr(signal, name))
            running.send_signal(signal.SIGCONT)
            code, text = faults.finish(running)
            self.assertEqual(code, faults.RESUMABLE, text)
            code, text = faults.finish(faults.start(config, out))
            self.assertEqual(code, faults.DONE, text)
            self.assertEqual(faults.results(out), expected)

    def test_the_printed_command_goes_on(self):
        expected, _, _ = faults.undisturbed()
        config = faults.write_config(self.folder)
        out = self.folder / "it's a $(run) \n of \"mine\""

        def start():
            running = faults.start(config, out, "--set", "output.checkpoint_seconds=0.04")
            running.stdout.readline()  # the preparation has begun: there is nothing in the folder yet
            return running

        def go_on():
            return subprocess.Popen(["bash", "-c", f'exec "$SANDGLASS" {command}'], text=True,
                                    stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)

        for begin, names in ((start, ()), (go_on, ("checkpoint.h5",))):
            running = faults.held(begin, out, *names)
            running.send_signal(signal.SIGTERM)
            running.send_signal(signal.SIGCONT)
            code, text = faults.finish(running)
            self.assertEqual(code, faults.RESUMABLE, text)
            command = text.split("Go on with: sandglass ")[1].rstrip("\n")
        code, text = faults.finish(go_on())
        self.assertEqual(code, faults.DONE, text)
        self.assertEqual(faults.results(out), expected)

    def test_a_second_interrupt_stops_at_once(self):
        config = faults.write_config(self.folder)
        running = faults.start(config, self.folder / "out", "--set", "system.particles=40000")
        time.sleep(0.3)  # somewhere in the preparation
        os.kill(running.pid, signal.SIGSTOP)  # both come before it can look at the first
        os.kill(running.pid, signal.SIGINT)
        os.kill(running.pid, signal.SIGCONT)
        time.sleep(0.01)
        os.kill(running.pid, signal.SIGINT)
        code, text = faults.finish(running)
        self.assertIn(code, (-signal.SIGINT, faults.RESUMABLE), text)


FAKETIME = pathlib.Path("/usr/lib/x86_64-linux-gnu/faketime/libfaketime.so.1")


class Clock(program.Case):
    @unittest.skipUnless(FAKETIME.exists(), "needs the package faketime")
    def test_jumps(self):
        expected, seconds, _ = faults.undisturbed()
        config = faults.write_config(self.folder)
        clock = self.folder / "clock"
        clock.write_text("+0")
        environment = os.environ | {"LD_PRELOAD": str(FAKETIME), "FAKETIME_TIMESTAMP_FILE": str(clock),
                                    "FAKETIME_NO_CACHE": "1"}
        running = faults.start(config, self.folder / "out", environment=environment)
        while running.poll() is None:
            jump = self.folder / "jump"
            jump.write_text(faults.RANDOM.choice(("+0", "-10d", "+10d", "+3s", "-1000d", "+20y")))
            jump.replace(clock)  # never seen empty
            time.sleep(seconds / 20)
        code, text = faults.finish(running)
        self.assertEqual(code, faults.DONE, text)
        self.assertEqual(faults.results(self.folder / "out"), expected)


if __name__ == "__main__":
    unittest.main()
