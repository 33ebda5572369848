"""`rubato compare` on tables written by hand. Usage: compare_command_test.py RUBATO."""
import fcntl
import math
import pathlib
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import unittest

RUBATO = sys.argv[1]

MASS = """
coordinate = [{ name = "mass", mass = 1.0, position = 1.0 }]
spring = [{ between = ["mass", "ground"], stiffness = 1.0 }]
analysis = [{ name = "swing", type = "transient", step = 0.01, duration = 5.0, output = { interval = INTERVAL } }]
"""


class Compare(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="rubato-compare-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def compare(self, *options):
        return subprocess.run([RUBATO, "compare", "a", "b", *options], capture_output=True, text=True, cwd=self.folder,
                              timeout=60)

    def write(self, path, *lines):
        file = self.folder / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text("\n".join(lines) + "\n")

    def assert_line(self, pattern, text):
        self.assertTrue(re.search(pattern, text, re.M), f"{pattern}\n{text}")

    def test_a_difference_is_relative_to_the_largest_of_its_column(self):
        self.write("a/frf.csv", "angular_frequency [rad/s],x.amplitude [m],status", "1,2,converged", "2,-4,converged")
        self.write("b/frf.csv", "angular_frequency [rad/s],x.amplitude [m],status", "1,2.02,converged", "2,-4,converged")
        result = self.compare("--tolerance", "0.01")
        self.assertEqual((result.returncode, result.stderr), (0, ""), result.stdout)
        self.assert_line(r"^  x\.amplitude \[m\] +5\.00e-03 +2\.00e-02  row 1$", result.stdout)
        self.assertEqual(self.compare("--tolerance", "0.004").returncode, 1)
        self.assertEqual(self.compare().returncode, 1)  # 1e-6

    def test_equal_folders_are_equal(self):
        for folder in "ab":
            self.write(f"{folder}/t.csv", "time [s],x [m],none [m]", "0,1,", "1,inf,")
            self.write(f"{folder}/former/old.csv", "x", folder)  # of a former run: not compared
        result = self.compare("--tolerance", "0")
        self.assertEqual(result.returncode, 0, result.stdout)
        self.assertEqual(result.stdout, "t.csv: equal\n\nwithin 0: 1 table; no column differs\n")

    def test_words_are_compared_as_words(self):
        self.write("a/frf.csv", "w,status", "1,converged", "2,converged", '3,"a, b"')
        self.write("b/frf.csv", "w,status", "1,converged", "2,unbounded", '3,"a, b"')
        result = self.compare("--tolerance", "10")
        self.assertEqual(result.returncode, 1)
        self.assert_line(r"^\* status +1 of 3 rows differ, the first: converged and unbounded$", result.stdout)

    def test_a_number_beside_nothing_differs(self):
        self.write("a/p.csv", "w,x", "1,2", "2,")
        self.write("b/p.csv", "w,x", "1,2", "2,3")
        result = self.compare("--tolerance", "10")
        self.assertEqual(result.returncode, 1)
        self.assert_line(r"1 of 2 rows differ, the first: nothing and 3$", result.stdout)

    def test_infinity_beside_a_number_differs(self):
        self.write("a/p.csv", "w,x", "1,2", "2,inf")
        self.write("b/p.csv", "w,x", "1,2", "2,3")
        self.assertEqual(self.compare("--tolerance", "10").returncode, 1)

    def test_tables_and_columns_that_one_lacks_are_told(self):
        self.write("a/p.csv", "w,x", "1,2")
        self.write("b/p.csv", "w,y", "1,2")
        self.write("a/deep/q.csv", "w", "1")
        result = self.compare("--tolerance", "10")
        self.assertEqual(result.returncode, 1)
        self.assert_line(r'^\* the second has no column "x"$', result.stdout)
        self.assert_line(r'^\* the first has no column "y"$', result.stdout)
        self.assert_line(r"^deep/q\.csv\n\* only the first has this table$", result.stdout)

    def test_phases_differ_by_the_shorter_way_round(self):
        self.write("a/frf.csv", "angular_frequency [rad/s],x.phase [rad]", f"1,{math.pi - 1e-9}")
        self.write("b/frf.csv", "angular_frequency [rad/s],x.phase [rad]", f"1,{-math.pi + 1e-9}")
        self.assertEqual(self.compare().returncode, 0)

    def test_a_column_of_round_off_is_zero(self):
        self.write("a/t.csv", "time [s],1.x.position [m],1.y.position [m]", "0,1,1e-18", "1,2,3e-18")
        self.write("b/t.csv", "time [s],1.x.position [m],1.y.position [m]", "0,1,-2e-18", "1,2,1e-19")
        self.assertEqual(self.compare("--tolerance", "1e-4").returncode, 0)

    def test_rows_of_other_frequencies_are_told_and_the_common_ones_compared(self):
        header = "N0,angular_frequency [rad/s],x.amplitude [m]"
        self.write("a/frf.csv", header, "1,1,5", "1,2,6", "2,1,7", "2,2,8")
        self.write("b/frf.csv", header, "1,1,5", "2,1,7", "2,2,9", "2,3,9", "2,4,9")
        result = self.compare()
        self.assertEqual(result.returncode, 1)
        self.assert_line(r'^\* 4 and 5 rows, of which 3 are of the same "angular_frequency \[rad/s\]"$', result.stdout)
        self.assert_line(r"^\* x\.amplitude \[m\] +1\.11e-01 +1\.00e\+00  row 4$", result.stdout)

    def test_modes_are_matched_by_their_numbers_and_curves_by_the_parameter(self):
        modes = "limit,mode,angular_frequency [rad/s]"
        self.write("a/modes.csv", modes, "free,1,2.0", "free,2,5.0")
        self.write("b/modes.csv", modes, "free,1,2.2", "free,2,5.0", "free,3,8.0")
        curve = "N0,angular_frequency [rad/s],objective [m]"
        self.write("a/curve.csv", curve, "1,7,0.5", "2,8,0.4")
        self.write("b/curve.csv", curve, "1,7.5,0.5", "1.5,7,0.3", "2,8,0.4")
        result = self.compare()
        self.assertEqual(result.returncode, 1)
        self.assert_line(r'^\* 2 and 3 rows, of which 2 are of the same "mode"$', result.stdout)
        self.assert_line(r'^\* 2 and 3 rows, of which 2 are of the same "N0"$', result.stdout)
        self.assert_line(r"^\* angular_frequency \[rad/s\] +2\.50e-02 +2\.00e-01  row 1$", result.stdout)
        self.assert_line(r"^\* angular_frequency \[rad/s\] +6\.25e-02 +5\.00e-01  row 1$", result.stdout)

    def test_keys_that_differ_by_round_off_are_the_same(self):
        header = "N0,angular_frequency [rad/s],x.amplitude [m]"
        self.write("a/frf.csv", header, "0.3,1,5", "0.3,2,6", "0.4,2,7")
        self.write("b/frf.csv", header, "0.30000000000000004,1,5", "0.4,2.0000000000000004,7", "0.30000000000000004,2,6", "0.5,2,6")
        result = self.compare()
        self.assert_line(r'^\* 3 and 4 rows, of which 3 are of the same', result.stdout)
        self.assert_line(r"^  x\.amplitude \[m\] +0\.00e\+00", self.compare("--all").stdout)

    # They were matched pair by pair: 100,000 rows took 10 s of processor time, and 1,000,000 a quarter of an hour.
    def test_large_sweeps_of_different_sizes_take_seconds(self):
        header = "N0,angular_frequency [rad/s],x.amplitude [m]"
        rows = [f"{i // 100},{i % 100},{i}" for i in range(100000)]
        self.write("a/frf.csv", header, *rows)
        self.write("b/frf.csv", header, *reversed(rows[1:]))
        result = subprocess.run([RUBATO, "compare", "a", "b"], capture_output=True, text=True, cwd=self.folder,
                                preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (3, 4)))
        self.assertEqual(result.returncode, 1)
        self.assertIn("100000 and 99999 rows, of which 99999 are of the same", result.stdout)

    def test_a_folder_in_which_a_run_writes_is_refused(self):
        self.write("a/t.csv", "w", "1")
        self.write("b/deep/t.csv", "w", "1")
        with open(self.folder / "b/deep/.rubato-lock", "w") as lock:
            lock.write("4711 \n")
            lock.flush()
            fcntl.flock(lock, fcntl.LOCK_EX)
            result = self.compare()
            self.assertEqual((result.returncode, result.stdout), (2, ""))
            self.assertIn("another run is writing here (process 4711); its tables are not whole yet", result.stderr)
        result = self.compare()  # nobody holds it any more
        self.assertEqual(result.returncode, 1)
        self.assertIn("only the first has this table", result.stdout)

    def test_what_a_killed_run_has_left_is_told(self):
        for folder in "ab":
            self.write(f"{folder}/t.csv", "w", "1")
        self.write("b/t.csv.partial", "w", "1")
        result = self.compare()
        self.assertEqual(result.returncode, 1)
        self.assertEqual(result.stdout.splitlines()[:3], [
            "t.csv: equal", "t.csv.partial", "* a run of the second ended before this table was whole"])

    def test_histories_of_other_times_are_interpolated(self):
        for folder, interval in (("a", 0.05), ("b", 0.01)):
            (self.folder / f"{folder}.toml").write_text(MASS.replace("INTERVAL", str(interval)))
            run = subprocess.run([RUBATO, "run", f"{folder}.toml", "-q", "-o", folder], cwd=self.folder, timeout=60)
            self.assertEqual(run.returncode, 0)
        result = self.compare("--tolerance", "1e-9")  # every fifth time is the same
        self.assertEqual(result.returncode, 0, result.stdout)
        self.assert_line(r"the times differ \(101 and 501 rows\): compared at those of the first", result.stdout)
        # Between rows straight lines miss a cosine by h^2/8 at most, and that is what is told of them.
        self.write("b/swing.csv", "time [s],mass.position [m]",
                   *(f"{(i + 0.5) * 0.01},{math.cos((i + 0.5) * 0.01)}" for i in range(-50, 600)))
        shutil.rmtree(self.folder / "a")
        self.write("a/swing.csv", "time [s],mass.position [m]",
                   *(f"{i * 0.1},{math.cos(i * 0.1)}" for i in range(0, 50)))
        result = self.compare()
        self.assert_line(r"\* the first goes from 0 s to 4\.9 s, the second from -0\.495 s", result.stdout)
        self.assert_line(r"mass\.position \[m\] +1\.25e-05 .*\(interpolation: about 1e-05\)$", result.stdout)

    # Two runs of other steps never agreed: their residues are errors, and have nothing in common but their size.
    def test_a_residue_is_relative_to_the_energy(self):
        header = "time [s],kinetic [J],residue [J]"
        self.write("a/t.energy.csv", header, "0,0,0", "1,5,1e-6")
        self.write("b/t.energy.csv", header, "0,0,0", "1,5,-1e-6")
        result = self.compare("--tolerance", "1e-5")
        self.assertEqual(result.returncode, 0, result.stdout)
        self.assert_line(r"^  residue \[J\] +4\.00e-07 +2\.00e-06  t = 1 s$", result.stdout)
        self.assertEqual(self.compare("--tolerance", "1e-7").returncode, 1)

    def test_the_choice_of_steps_is_told_and_does_not_count(self):
        header = "time [s],step [s],error,accepted,reason"
        for folder in "ab":
            self.write(f"{folder}/t.csv", "time [s],x [m]", "0,1", "1,2")
        self.write("a/t.steps.csv", header, "0,0.5,0.1,1,accepted", "0.5,0.5,0.1,1,accepted")
        self.write("b/t.steps.csv", header, "0,1,2,0,error_too_large", "0,0.5,0.1,1,accepted", "0.5,0.5,0.1,1,accepted")
        self.write("b/u.steps.csv", header, "0,1,0.5,1,accepted")
        result = self.compare()
        self.assertEqual(result.returncode, 0, result.stdout)
        self.assert_line(r"^t\.steps\.csv \(how the runs chose their steps; it does not count\)$", result.stdout)
        self.assert_line(r"^  reason +1 of 2 rows differ, the first: accepted and error_too_large$", result.stdout)
        self.assert_line(r"^within 1e-06: 3 tables; no column that counts differs$", result.stdout)
        self.assertNotIn("*", result.stdout)

    def test_words_that_differ_are_no_infinite_difference(self):
        self.write("a/frf.csv", "w,status", "1,converged")
        self.write("b/frf.csv", "w,status", "1,unbounded")
        self.assert_line(r'entries differ in "status" of frf\.csv$', self.compare().stdout)

    def test_wrong_use_has_status_2(self):
        self.write("a/t.csv", "w", "1")
        for options, complaint in (((), "b: there is no such folder of results"),
                                   (("--tolerance", "-1"), "--tolerance"),
                                   (("--tolerance", "much"), "--tolerance")):
            result = self.compare(*options)
            self.assertEqual((result.returncode, result.stdout), (2, ""))
            self.assertIn(complaint, result.stderr)
        (self.folder / "b").mkdir()
        self.assertIn("has no tables of results", self.compare().stderr)
        self.write("b/t.csv", "w,x", "1,2", "1")
        self.assertIn("t.csv:3: error: the row has 1 fields, the header 2", self.compare().stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
