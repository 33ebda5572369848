"""Transients, statics and modes over samples, as a user meets them: resume, threads, check. Usage: sample_sweep_command_test.py
RUBATO."""
import csv
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

RUBATO = sys.argv[1]

STUDY = """
[parameters]
k = 1.0
c = 0.05
[[coordinate]]
name = "mass"
mass = 1.0
position = 1.0
[[spring]]
between = ["mass", "ground"]
stiffness = "k"
[[damper]]
between = ["mass", "ground"]
damping = "c"
[[slider]]
name = "contact"
between = ["mass", "ground"]
stiffness = 1.0
friction_coefficient = 0.5
normal_load = 0.1
[[analysis]]
name = "swing"
type = "transient"
step = 0.01
duration = 40.0
KEYS
"""
SAMPLES = 'sweep = { samples = 600, parameters = { k = { distribution = "uniform", from = 1, to = 4 } } }'


class SampleSweep(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="rubato-samples-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def write(self, keys):
        (self.folder / "study.toml").write_text(STUDY.replace("KEYS", keys))

    def run_command(self, *arguments):
        return subprocess.run([RUBATO, *map(str, arguments)], capture_output=True, text=True, cwd=self.folder, timeout=300)

    def rows(self, path):
        with open(self.folder / path, newline="") as file:
            return list(csv.reader(file))

    def bytes_of(self, folder):
        return {path.name: path.read_bytes() for path in (self.folder / folder).glob("*.csv")}

    def test_check_tells_the_number_of_samples(self):
        self.write("sweep = { k = [1, 2, 3], c = { from = 0, to = 0.2, points = 5 } }")
        result = self.run_command("check", "study.toml")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("  swing: 15 samples over k, c: transient, generalized_alpha, 4000 steps of 0.01 s to t = 40 s\n", result.stdout)

    def test_results_do_not_depend_on_the_number_of_threads(self):
        self.write(SAMPLES.replace("600", "40") + "\nhistories = true\noutput = { interval = 1.0 }")
        for jobs in ("1", "2", "7"):
            result = self.run_command("run", "study.toml", "-o", jobs, "--jobs", jobs, "-q")
            self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertEqual(set(self.bytes_of("1")), {"swing.csv", "swing.histories.csv", "swing.statistics.csv"})
        self.assertEqual(self.bytes_of("1"), self.bytes_of("2"))
        self.assertEqual(self.bytes_of("1"), self.bytes_of("7"))
        rows = self.rows("1/swing.csv")
        self.assertEqual(rows[0][:7], ["sample", "k", "mass.position_min [m]", "mass.position_min_time [s]", "mass.position_max [m]",
                                       "mass.position_max_time [s]", "mass.position_end [m]"])
        self.assertEqual(rows[0][-3:], ["steps", "warnings", "status"])
        self.assertEqual({row[-1] for row in rows[1:]}, {"done"})
        for row in rows[1:]:  # it starts at its largest
            self.assertEqual((float(row[4]), float(row[5])), (1.0, 0.0))
        self.assertEqual(len(self.rows("1/swing.histories.csv")), 1 + 40 * 41)

    def test_an_interrupted_sweep_resumes_with_the_same_bits(self):
        self.write(SAMPLES)
        self.assertEqual(self.run_command("run", "study.toml", "-o", "whole", "-q").returncode, 0)
        for sent, status in ((signal.SIGINT, 130), (signal.SIGKILL, -9)):
            shutil.rmtree(self.folder / "out", ignore_errors=True)
            process = subprocess.Popen([RUBATO, "run", "study.toml", "-o", "out", "-q", "--jobs", "1"], cwd=self.folder,
                                       stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
            self.addCleanup(process.kill)
            journal, end = self.folder / "out/swing.resume", time.monotonic() + 60
            while not (journal.exists() and journal.stat().st_size > 100):
                self.assertLess(time.monotonic(), end)
                self.assertIsNone(process.poll(), "it was done before it could be interrupted")
                time.sleep(0.002)
            process.send_signal(sent)
            _, err = process.communicate(timeout=60)
            self.assertEqual(process.returncode, status, err)
            if sent == signal.SIGINT:
                self.assertRegex(err, r'analysis "swing" stopped: interrupted after \d+ of 600 samples; the same command with --resume')
            result = self.run_command("run", "study.toml", "-o", "out", "--resume", "-q")
            self.assertEqual((result.returncode, result.stderr), (0, ""))
            self.assertEqual(self.bytes_of("out"), self.bytes_of("whole"))
            self.assertFalse(journal.exists())

    def test_a_sample_that_no_model_can_have_is_told(self):
        self.write("sweep = { c = [0.1, -1] }")
        result = self.run_command("run", "study.toml", "-o", "out", "-q")
        self.assertEqual(result.returncode, 0)
        self.assertIn("warning: analysis \"swing\": 1 of 2 samples have no result; the first, at c = -1: ", result.stderr)
        self.assertEqual([row[-1] for row in self.rows("out/swing.csv")[1:]], ["done", "impossible"])
        failures = self.rows("out/swing.failures.csv")
        self.assertEqual(failures[1][:3], ["2", "-1", "impossible"])
        self.assertIn("damping must not be negative, got -1", failures[1][3])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1)
