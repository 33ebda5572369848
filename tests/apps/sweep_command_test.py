"""Sweeps as a user meets them: resume, threads, sizes, warnings. Usage: sweep_command_test.py RUBATO."""
import csv
import os
import pathlib
import random
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
N0 = 1.0
k = 1.0
Omega = 1.0
[[coordinate]]
name = "mass"
mass = 1.0
[[spring]]
between = ["mass", "ground"]
stiffness = "k"
[[damper]]
between = ["mass", "ground"]
damping = 0.05
[[slider]]
name = "contact"
between = ["mass", "ground"]
stiffness = 1.0
friction_coefficient = 0.5
normal_load = "N0"
[[force]]
on = "mass"
amplitude = 1.0
angular_frequency = "Omega"
[[analysis]]
name = "frf"
type = "frequency_response"
angular_frequency = { from = 0.5, to = 2.0, points = POINTS }
sweep = { k = { from = 1, to = 1.5, points = LINES }, N0 = [0.2, 0.5, 1, 2, 4] }
"""


class Sweep(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="rubato-sweep-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def write(self, points, lines, change=("", "")):
        text = STUDY.replace("POINTS", str(points)).replace("LINES", str(lines)).replace(*change)
        (self.folder / "study.toml").write_text(text)

    def run_command(self, *arguments):
        return subprocess.run([RUBATO, *map(str, arguments)], capture_output=True, text=True, cwd=self.folder, timeout=300)

    def rows(self, path):
        with open(self.folder / path, newline="") as file:
            return list(csv.reader(file))

    def bytes_of(self, folder):
        return {path.name: path.read_bytes() for path in (self.folder / folder).glob("*.csv")}

    def test_says_that_what_is_set_of_a_parameter_with_values_of_its_own_is_ignored(self):
        self.write(3, 2)
        with open(self.folder / "study.toml", "a") as study:
            study.write('[[analysis]]\nname = "curve"\ntype = "damper_curve"\nparameter = "N0"\nrange = [1, 2]\n'
                        'angular_frequency = { from = 0.5, to = 2 }\noptimum = false\n')
        warnings = "".join(
            f'study.toml: warning: analysis "{analysis}": --set {name}={value} does not change the model of this analysis: '
            f'{source} gives "{name}" its values; change them in the study\n' for analysis, name, value, source in [
                ("frf", "Omega", 3, "the list of frequencies"), ("frf", "k", 2, "the sweep"), ("frf", "N0", 0.5, "the sweep"),
                ("curve", "Omega", 3, "the range of frequencies"), ("curve", "N0", 0.5, "the range of the curve")])
        settings = ["--set", "N0=0.5", "--set", "k=2", "--set", "Omega=3"]
        self.assertEqual(self.run_command("check", "study.toml", *settings).stderr, warnings)
        result = self.run_command("run", "study.toml", "-o", "out", "--quiet", *settings)
        self.assertEqual((result.returncode, result.stderr), (0, warnings))
        self.assertEqual(self.run_command("check", "study.toml").stderr, "")

    def test_writes_the_columns_of_the_contract(self):
        self.write(11, 2)
        result = self.run_command("run", "study.toml", "-o", "out")
        self.assertEqual((result.returncode, result.stdout), (0, "out/report.html\n"), result.stderr)
        rows = self.rows("out/frf.csv")
        self.assertEqual(rows[0], ["k", "N0", "angular_frequency [rad/s]", "mass.amplitude [m]", "mass.velocity_amplitude [m/s]",
                                   "mass.acceleration_amplitude [m/s2]", "mass.phase [rad]", "mass.mean [m]", "mass.rms [m]",
                                   "contact.dissipated [J]", "contact.slip_share", "contact.offset [N]", "viscous_work [J]",
                                   "input_work [J]", "transitions", "iterations", "residual", "error", "status"])
        self.assertEqual(len(rows), 1 + 2 * 5 * 11)
        self.assertEqual({row[-1] for row in rows[1:]}, {"converged"})
        # What comes in goes out: the balance that every steady response keeps.
        for row in rows[1:]:
            friction, viscous, work = (float(row[i]) for i in (9, 12, 13))
            self.assertAlmostEqual(work, viscous + friction, delta=1e-9 * work)
        self.assertEqual(self.rows("out/frf.linear.csv")[0],
                         ["k", "angular_frequency [rad/s]", "mass.free_amplitude [m]", "mass.free_phase [rad]",
                          "mass.stuck_amplitude [m]", "mass.stuck_phase [rad]"])
        self.assertFalse((self.folder / "out/frf.resume").exists())

    def test_results_do_not_depend_on_the_number_of_threads(self):
        self.write(40, 5)
        for jobs in ("1", "2", "7"):
            self.assertEqual(self.run_command("run", "study.toml", "-o", jobs, "--jobs", jobs, "-q").returncode, 0)
        self.assertEqual(self.bytes_of("1"), self.bytes_of("2"))
        self.assertEqual(self.bytes_of("1"), self.bytes_of("7"))

    def test_an_interrupted_sweep_resumes_with_the_same_bits(self):
        self.write(200, 60)
        self.assertEqual(self.run_command("run", "study.toml", "-o", "whole", "-q").returncode, 0)
        for sent, status in ((signal.SIGINT, 130), (signal.SIGKILL, -9)):
            shutil.rmtree(self.folder / "out", ignore_errors=True)
            process = subprocess.Popen([RUBATO, "run", "study.toml", "-o", "out", "-q", "--jobs", "1"], cwd=self.folder,
                                       stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
            self.addCleanup(process.kill)
            journal, end = self.folder / "out/frf.resume", time.monotonic() + 60
            while not (journal.exists() and journal.stat().st_size > 100):
                self.assertLess(time.monotonic(), end)
                self.assertIsNone(process.poll(), "it was done before it could be interrupted")
                time.sleep(0.002)
            process.send_signal(sent)
            _, err = process.communicate(timeout=60)
            self.assertEqual(process.returncode, status, err)
            if sent == signal.SIGINT:
                self.assertRegex(err, r'analysis "frf" stopped: interrupted after \d+ of 60000 points')
            self.assertTrue(journal.exists())
            result = self.run_command("run", "study.toml", "-o", "out", "--resume", "-q")
            self.assertEqual((result.returncode, result.stderr), (0, ""))
            self.assertEqual(self.bytes_of("out"), self.bytes_of("whole"))
            self.assertFalse(journal.exists())

    def interrupted(self, folder):
        """Begins a run and interrupts it once some pieces are in its journal, which is returned."""
        process = subprocess.Popen([RUBATO, "run", "study.toml", "-o", folder, "-q", "--jobs", "1"], cwd=self.folder,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.kill)
        journal, end = self.folder / folder / "frf.resume", time.monotonic() + 60
        while not (journal.exists() and journal.stat().st_size > 100):
            self.assertLess(time.monotonic(), end)
            self.assertIsNone(process.poll(), "it was done before it could be interrupted")
            time.sleep(0.002)
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=60)
        return journal

    def test_a_damaged_journal_gives_right_rows_or_a_word(self):
        self.write(200, 60)
        self.assertEqual(self.run_command("run", "study.toml", "-o", "whole", "-q").returncode, 0)
        whole, sound = self.bytes_of("whole"), self.interrupted("out").read_bytes()
        head = sound.index(b"\n") + 1
        self.assertGreater(len(sound), head + 2000)
        chance = random.Random(15)
        cut = chance.randrange(head + 1, len(sound))
        third = slice(head + (len(sound) - head) // 3, head + 2 * (len(sound) - head) // 3)
        flipped = bytearray(sound)
        flipped[chance.randrange(head, len(sound))] ^= 16
        for damaged, told in ((sound[:cut], "cut short"), (sound + bytes(100_000), "is damaged"), (bytes(len(sound)), "--resume"),
                              (sound[:cut] + bytes(len(sound) - cut), "; the "), (sound + sound[head:], "is damaged"),
                              (sound[:third.start] + sound[third] + sound[third.start:], "; the "),
                              (sound[:third.start] + sound[third.stop:], "; the "), (bytes(flipped), "; the ")):
            (self.folder / "out/frf.resume").write_bytes(damaged)
            result = self.run_command("run", "study.toml", "-o", "out", "--resume")
            self.assertIn(told, result.stderr)
            if result.returncode == 2:
                self.assertRegex(result.stderr, "^error: --resume: out/frf.resume .*; run without --resume to begin afresh\n$")
                continue
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertRegex(result.stderr, r"(?m)^(warning: --resume: out/frf.resume: piece \d+ is damaged|"
                                            r"--resume: out/frf.resume: piece \d+ is cut short); the \d+ "
                                            r"before it are kept, and the rest \(\d+ bytes\) is computed again$")
            self.assertEqual(self.bytes_of("out"), whole)

    def test_refuses_to_resume_with_another_mesh(self):
        (self.folder / "nodes.csv").write_text("name,x,y\n" + "".join(f"{i},{i},0\n" for i in range(4)))
        (self.folder / "beams.csv").write_text("first,second\n0,1\n1,2\n2,3\n")
        self.write(200, 60, ("[[analysis]]", """
[nodes]
file = "nodes.csv"
[beams]
file = "beams.csv"
section = "tube"
material = "clay"
[[material]]
name = "clay"
young = 1.0
poisson = 0.3
density = 1.0
[[section]]
name = "tube"
area = 1.0
inertia = 1.0
shear_factor = 0.5
[[support]]
node = "0"
fix = ["x", "y", "rz"]
[[analysis]]
observe = "mass"
"""))
        self.interrupted("out")
        (self.folder / "nodes.csv").write_text("name,x,y\n" + "".join(f"{i},{1.1 * i},0\n" for i in range(4)))
        result = self.run_command("run", "study.toml", "-o", "out", "--resume", "-q")
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertIn("was left by another study, other files that it names", result.stderr)

    def test_resume_asks_for_the_room_of_what_is_still_to_come(self):
        # The whole takes 48 MB and a reserve of 8 MB; the disk has 60 MB, and half of the results are there.
        self.write(200, 60)
        (self.folder / "disk").mkdir()
        if subprocess.run(["unshare", "-rm", "mount", "-t", "tmpfs", "tmpfs", self.folder / "disk"],
                          capture_output=True).returncode != 0:
            self.skipTest("no disk of its own can be mounted here")
        script = f"""set -e
            mount -t tmpfs -o size=60m tmpfs disk
            {RUBATO} run study.toml -o disk/out -q --jobs 1 2> /dev/null & run=$!
            while [ "$(stat -c %s disk/out/frf.resume 2> /dev/null || echo 0)" -lt 4500000 ]; do kill -0 $run; sleep 0.002; done
            kill -TERM $run
            wait $run || true
            df --output=avail -k disk | tail -n 1
            {RUBATO} run study.toml -o disk/out -q --resume"""
        result = subprocess.run(["unshare", "-rm", "sh", "-c", script], cwd=self.folder, timeout=120, capture_output=True, text=True)
        self.assertEqual((result.returncode, result.stderr), (0, ""), result.stdout)
        self.assertLess(int(result.stdout), 49_000, "there was room for the whole")

    def test_refuses_to_resume_another_study(self):
        self.write(200, 2)
        (self.folder / "out").mkdir()
        (self.folder / "out/frf.resume").write_text("rubato journal 2 0123456789abcdef\n")
        result = self.run_command("run", "study.toml", "-o", "out", "--resume")
        self.assertEqual((result.returncode, result.stderr),
                         (2, "error: --resume: out/frf.resume was left by another study, other files that it names, other "
                             "values of --set or another version; run without --resume to begin afresh\n"))
        self.assertFalse((self.folder / "out/results.nc").exists())

    def test_more_than_a_million_points_want_a_yes(self):
        self.write(1001, 200)
        result = self.run_command("run", "study.toml", "-o", "out")
        self.assertEqual((result.returncode, result.stderr),
                         (2, 'study.toml:25:1: error: analysis "frf": the sweep has 1.001e+06 points, more than a million; '
                             "say --yes if that is meant\n"))
        self.assertEqual(self.run_command("check", "study.toml").returncode, 0)

    def test_a_sweep_that_memory_cannot_hold_is_refused(self):
        self.write(100000, 2, ("sweep = { k = { from = 1, to = 1.5, points = 2 }, N0 = [0.2, 0.5, 1, 2, 4] }",
                               'sweep = { samples = 10000000, parameters = { k = { distribution = "uniform", from = 1, '
                               "to = 2 } } }"))
        result = self.run_command("run", "study.toml", "-o", "out", "--yes")
        self.assertEqual(result.returncode, 2)
        self.assertRegex(result.stderr, r'^study.toml:25:1: error: analysis "frf": a sweep of 1e\+12 points keeps 8e\+03 GB, and '
                                        r"this machine has \S+ GB; observe fewer coordinates, or take fewer points\n$")

    def test_a_parameter_called_as_a_table_is_refused_by_check(self):
        for name in ("linear", "waveforms", "bands", "sample", "coordinate", "slider"):
            self.write(5, 2, ("points = 5 }\n", "points = 5 }\nwaveforms = { at = [1.0] }\n"))
            text = (self.folder / "study.toml").read_text()
            text = text.replace("\nk = 1.0", f"\n{name} = 1.0").replace('stiffness = "k"', f'stiffness = "{name}"').replace(
                "{ k = { from", "{ " + name + " = { from")
            (self.folder / "study.toml").write_text(text)
            result = self.run_command("check", "study.toml")
            self.assertEqual(result.returncode, 2, name)
            self.assertIn(f'the swept parameter "{name}" would head a column of results that has another meaning', result.stderr)

    def test_negative_preloads_are_told(self):
        self.write(5, 2, ("N0 = [0.2, 0.5, 1, 2, 4]", "N0 = [-1, 1]"))
        result = self.run_command("run", "study.toml", "-o", "out", "-q")
        self.assertEqual(result.returncode, 0)
        self.assertIn('study.toml: warning: analysis "frf": at k = 1, N0 = -1, angular_frequency = 0.5 rad/s the normal load of '
                      'slider "contact" is -1 N: it cannot be pulled, and counts as 0 (10 points with negative loads)\n',
                      result.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1)
