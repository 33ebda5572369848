"""The command as a user meets it: exit status, streams, files. Usage: command_test.py RUBATO EXAMPLES."""
import csv
import os
import pathlib
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

RUBATO, EXAMPLES = sys.argv[1], pathlib.Path(sys.argv[2])

LONG = """
[[coordinate]]
name = "mass"
mass = 1.0
[[spring]]
between = ["mass", "ground"]
stiffness = 1.0
[[force]]
on = "mass"
amplitude = 1.0
angular_frequency = 2.0
[[analysis]]
name = "long"
type = "transient"
step = 0.01
duration = DURATION
output = { every = 100 }
"""


class Command(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="rubato-command-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def run_command(self, *arguments, **options):
        return subprocess.run([RUBATO, *map(str, arguments)], capture_output=True, text=True, cwd=self.folder, timeout=120,
                              **options)

    def write(self, text, name="study.toml"):
        (self.folder / name).write_text(text)
        return name

    def rows(self, path):
        with open(self.folder / path, newline="") as file:
            return list(csv.reader(file))

    def test_run_writes_everything_and_names_the_report(self):
        result = self.run_command("run", EXAMPLES / "single-mass-slider" / "study.toml", "-o", "out")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(result.stdout, "out/report.html\n")
        names = {entry.name for entry in (self.folder / "out").iterdir()}
        self.assertEqual(names, {"results.nc", "report.html", "response.csv", "response.energy.csv", "exact.csv",
                                 "exact.energy.csv"})
        header = self.rows("out/response.csv")[0]
        self.assertEqual(header, ["time [s]", "mass.position [m]", "mass.velocity [m/s]", "mass.acceleration [m/s2]",
                                  "contact.force [N]", "contact.slip [m]"])

    def test_results_lie_beside_the_study_by_default(self):
        shutil.copytree(EXAMPLES / "single-mass", self.folder / "copy")
        result = self.run_command("run", "copy/study.toml", "--only", "exact", "--quiet")
        self.assertEqual((result.returncode, result.stdout, result.stderr), (0, "", ""))
        self.assertTrue((self.folder / "copy/results/exact.csv").exists())
        self.assertFalse((self.folder / "copy/results/response.csv").exists())

    def test_set_replaces_a_parameter(self):
        study = EXAMPLES / "single-mass-slider" / "study.toml"
        largest = []
        for value in ("0.3", "2*0.2"):
            self.assertEqual(self.run_command("run", study, "-o", "out", "--only", "exact", "--set", f"N0={value}").returncode, 0)
            largest.append(max(abs(float(row[4])) for row in self.rows("out/exact.csv")[1:]))
        self.assertEqual(largest, [0.15, 0.2])

    def test_wrong_studies_and_options_exit_with_2_and_write_nothing(self):
        study = EXAMPLES / "single-mass-slider" / "study.toml"
        cases = [(["run", "nowhere.toml"], 'error: the study "nowhere.toml" does not exist\n'),
                 (["run", study, "-o", "out", "--set", "N1=3"],
                  'error: --set N1: no such parameter; did you mean "N0"? (known: N0)\n'),
                 (["run", study, "-o", "out", "--only", "exat"],
                  'error: --only exat: no such analysis; did you mean "exact"? (known: response, exact)\n'),
                 (["methods", "newmrk"], 'error: unknown method "newmrk"; did you mean "newmark"? `rubato methods` lists them\n'),
                 (["example", "single-mas"], None)]
        for arguments, message in cases:
            result = self.run_command(*arguments)
            self.assertEqual((result.returncode, result.stdout), (2, ""), arguments)
            if message:
                self.assertEqual(result.stderr, message)
            self.assertFalse((self.folder / "out").exists())
        self.assertEqual(self.run_command("run", study, "--sett", "a=1").returncode, 2)
        self.assertEqual(self.run_command().returncode, 2)

    def test_check_says_what_would_run(self):
        result = self.run_command("check", EXAMPLES / "underplatform-damper" / "study.toml")
        self.assertEqual(result.returncode, 0)
        self.assertIn("5 coordinates, 2 sliders", result.stdout)
        self.assertIn("transient, generalized_alpha, 12000 steps of 0.005 s to t = 60 s", result.stdout)

    def test_methods_and_schema_and_examples_answer_on_stdout(self):
        self.assertIn("generalized_alpha", self.run_command("methods").stdout)
        curves = self.run_command("methods", "average_acceleration", "--csv").stdout.splitlines()
        self.assertEqual(curves[0], "omega_h,spectral_radius,period_elongation,numerical_damping")
        self.assertGreater(len(curves), 50)
        self.assertTrue(self.run_command("schema").stdout.startswith("{"))
        self.assertIn("underplatform-damper", self.run_command("example").stdout)
        self.assertEqual(self.run_command("example", "matrices", "mine").stdout, "mine/study.toml\n")
        self.assertEqual(self.run_command("check", "mine/study.toml").returncode, 0)
        self.assertEqual(self.run_command("example", "matrices", "mine").returncode, 2)  # never over what is there

    def test_ctrl_c_keeps_what_was_computed(self):
        study = self.write(LONG.replace("DURATION", "1e8"))
        for sent in (signal.SIGINT, signal.SIGTERM):
            process = subprocess.Popen([RUBATO, "run", study, "-o", "out"], cwd=self.folder, stdout=subprocess.PIPE,
                                       stderr=subprocess.PIPE, text=True)
            time.sleep(1.5)
            process.send_signal(sent)
            out, err = process.communicate(timeout=60)
            self.assertEqual(process.returncode, 130, err)
            self.assertRegex(err, r'analysis "long" stopped: interrupted at t = \S+ s of (1e\+08|100000000) s')
            rows = self.rows("out/long.csv")
            self.assertGreater(len(rows), 1000)
            self.assertTrue(all(len(row) == len(rows[0]) for row in rows))
            report = (self.folder / "out/report.html").read_text()
            self.assertIn("interrupted", report)

    def test_failed_mathematics_exits_with_3_and_keeps_the_rows(self):
        study = self.write(LONG.replace("DURATION", "5.0").replace("amplitude = 1.0\nangular_frequency = 2.0",
                                                                   'expression = "1/(t - 2)"').replace("every = 100", "every = 1"))
        result = self.run_command("run", study, "-o", "out")
        self.assertEqual(result.returncode, 3)
        self.assertIn('study.toml: analysis "long" failed: at t = 1.99 s', result.stderr)
        self.assertEqual(len(self.rows("out/long.csv")), 201)
        self.assertTrue((self.folder / "out/report.html").exists())

    def test_a_file_in_the_place_of_the_folder_is_found_out_at_once(self):
        (self.folder / "out").write_text("a file")
        result = self.run_command("run", EXAMPLES / "single-mass" / "study.toml", "-o", "out")
        self.assertEqual(result.returncode, 3)
        self.assertEqual(result.stderr, "error: out: exists and is no folder; choose another (-o DIR)\n")
        self.assertEqual((self.folder / "out").read_text(), "a file")

    def test_output_that_cannot_grow_is_reported_plainly(self):
        study = self.write(LONG.replace("DURATION", "1e6"))

        def limit():
            resource.setrlimit(resource.RLIMIT_FSIZE, (1 << 20, 1 << 20))

        result = self.run_command("run", study, "-o", "out", preexec_fn=limit)
        self.assertEqual(result.returncode, 3, result.stderr)
        self.assertRegex(result.stderr, r"error: out/\S+: ")
        rows = self.rows("out/long.csv")
        self.assertGreater(len(rows), 100)
        self.assertTrue(all(len(row) == len(rows[0]) for row in rows), "no row is cut")
        self.assertTrue((self.folder / "out/results.nc").read_bytes().startswith(b"\x89HDF"))

    def test_a_huge_output_is_refused_before_it_begins(self):
        study = self.write(LONG.replace("DURATION", "1e9").replace("every = 100", "every = 1"))
        result = self.run_command("run", study, "-o", "out")
        self.assertEqual(result.returncode, 3)
        self.assertRegex(result.stderr, r"the results will take about \S+ GB and \S+ GB are free")

    def test_a_closed_pipe_is_no_crash(self):
        shell = subprocess.run(f"{RUBATO} methods average_acceleration --csv | head -n 1", shell=True, capture_output=True,
                               text=True, timeout=60)
        self.assertEqual((shell.returncode, shell.stderr), (0, ""))


if __name__ == "__main__":
    os.environ.pop("RUBATO", None)
    unittest.main(argv=sys.argv[:1], verbosity=1)
