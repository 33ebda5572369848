"""How soon a run stops that is asked to, whatever it is at. Usage: stopping_command_test.py RUBATO."""
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

RUBATO = sys.argv[1]

# A mode at 2e5 rad/s beside loads at 1 rad/s: the exact flow over one period has some 600,000 pieces.
STIFF = """
[parameters]
N0 = 1.0
Omega = 1.0
[[coordinate]]
name = "mass"
mass = 1.0
[[coordinate]]
name = "fast"
mass = 1e-6
[[spring]]
between = ["mass", "ground"]
stiffness = 1.0
[[spring]]
between = ["mass", "fast"]
stiffness = 4e4
[[damper]]
between = ["mass", "ground"]
damping = 1e-3
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
name = "slow"
"""

LINEAR = STIFF[:STIFF.index("[[slider]]")] + STIFF[STIFF.index("[[force]]"):]

# Thirty contacts on a chain, and a tolerance that wants every harmonic there is.
CHAIN = "".join(f"""
[[coordinate]]
name = "m{i}"
mass = {1 + 0.1 * i}
[[spring]]
between = ["m{i}", "{f'm{i - 1}' if i else 'ground'}"]
stiffness = {100 + i}
[[slider]]
name = "s{i}"
between = ["m{i}", "ground"]
stiffness = {200 + 7 * i}
friction_coefficient = 0.5
normal_load = {0.3 + 0.05 * i}
""" for i in range(30)) + """
[parameters]
Omega = 1.0
[damping]
modal_ratio = 0.005
[[force]]
on = "m29"
amplitude = 3.0
angular_frequency = "Omega"
[[analysis]]
name = "slow"
"""

STUDIES = {
    "periodic": STIFF + 'type = "frequency_response"\nangular_frequency = { from = 0.8, to = 2, points = 100 }\n',
    "harmonic_balance": CHAIN + 'type = "frequency_response"\nsolver = "harmonic_balance"\ntolerance = 1e-12\n'
                                "angular_frequency = { from = 1, to = 3, points = 100 }\n",
    "time_marching": STIFF + 'type = "frequency_response"\nsolver = "time_marching"\nsteps_per_period = 3000000\n'
                             "angular_frequency = { from = 0.8, to = 2, points = 100 }\n",
    "damper_curve": STIFF + 'type = "damper_curve"\nparameter = "N0"\nsolver = "periodic"\n'
                            "range = { from = 0.8, to = 2, points = 20 }\n"
                            "angular_frequency = { from = 0.8, to = 2 }\n",
    "exact": STIFF + 'type = "transient"\nmethod = "exact"\nduration = 1e4\noutput = { times = [1e4] }\n',
    "automatic": CHAIN + 'type = "transient"\nstep = { tolerance = 1e-3 }\nduration = 1e4\noutput = { times = [1e4] }\n',
    "method_study": LINEAR + 'type = "method_study"\nstep = 1e-3\nduration = 900\n',
}


def portal(columns):
    """A frame of many storeys, whose modes take Lanczos some time."""
    nodes = ["name,x,y,z"] + [f"{i}.{j}.{k},{i},{j},{k}" for i in range(columns) for j in range(columns) for k in range(columns)]
    beams = ["first,second"]
    for i in range(columns):
        for j in range(columns):
            for k in range(columns):
                for a, b, c in ((1, 0, 0), (0, 1, 0), (0, 0, 1)):
                    if i + a < columns and j + b < columns and k + c < columns:
                        beams.append(f"{i}.{j}.{k},{i + a}.{j + b}.{k + c}")
    return "\n".join(nodes) + "\n", "\n".join(beams) + "\n"


class Stopping(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="rubato-stopping-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def start(self, text, *options, keeps=False):
        (self.folder / "study.toml").write_text(text)
        if not keeps:
            shutil.rmtree(self.folder / "out", ignore_errors=True)
        process = subprocess.Popen([RUBATO, "run", "study.toml", "-o", "out", *options], cwd=self.folder,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.kill)
        end = time.monotonic() + 60
        while not (self.folder / "out/.rubato-lock").exists():
            self.assertLess(time.monotonic(), end)
            self.assertIsNone(process.poll(), process.stderr.read() if process.poll() is not None else "")
            time.sleep(0.02)
        return process

    def stops(self, text, sent, wait=1.5):
        process = self.start(text, "--jobs", "2")
        time.sleep(wait)
        if process.poll() is not None:
            self.fail(f"it was done before it could be stopped: {process.returncode} {process.communicate()[1]}")
        process.send_signal(sent)
        before = time.monotonic()
        out, err = process.communicate(timeout=60)
        took = time.monotonic() - before
        self.assertEqual((process.returncode, out), (130, "out/report.html\n"), err)
        self.assertRegex(err, r'analysis "slow" stopped: interrupted')
        self.assertLess(took, 5.0)
        self.assertTrue((self.folder / "out/results.nc").exists())
        return took

    def test_every_analysis_stops_in_the_midst_of_a_point(self):
        for name, text in STUDIES.items():
            with self.subTest(name):
                self.stops(text, signal.SIGTERM)

    def test_the_three_signals_are_alike(self):
        for sent in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            with self.subTest(sent.name):
                self.stops(STUDIES["periodic"], sent)

    def test_modes_of_a_large_structure_stop_within_an_iteration(self):
        nodes, beams = portal(12)
        (self.folder / "nodes.csv").write_text(nodes)
        (self.folder / "beams.csv").write_text(beams)
        self.stops("""
[nodes]
file = "nodes.csv"
[beams]
file = "beams.csv"
section = "tube"
material = "steel"
orientation = [1.0, 2.0, 3.0]
[[material]]
name = "steel"
young = 2.1e11
poisson = 0.3
density = 7850.0
[[section]]
name = "tube"
area = 1e-3
inertia = [1e-6, 2e-6]
torsion = 1e-6
shear_factor = 0.5
[[support]]
node = "0.0.0"
fix = ["x", "y", "z", "rx", "ry", "rz"]
[[analysis]]
name = "slow"
type = "modes"
count = 600
""", signal.SIGTERM)

    def test_all_modes_by_a_dense_solver_are_left_behind(self):
        masses = "".join(f"""
[[coordinate]]
name = "m{i}"
mass = {1 + 0.001 * i}
[[spring]]
between = ["m{i}", "{f'm{i - 1}' if i else 'ground'}"]
stiffness = {100 + i % 7}
""" for i in range(1500))
        self.stops(masses + '[[analysis]]\nname = "slow"\ntype = "modes"\ncount = 1500\nobserve = ["m0"]\n', signal.SIGTERM)

    def test_former_results_stay_where_nothing_was_reached(self):
        (self.folder / "study.toml").write_text(STUDIES["exact"].replace("1e4", "1e-4"))
        subprocess.run([RUBATO, "run", "study.toml", "-o", "out", "-q"], cwd=self.folder, check=True, timeout=60)
        before = {path.name: path.read_bytes() for path in (self.folder / "out").iterdir()}
        process = self.start(STUDIES["periodic"], keeps=True)
        time.sleep(1.0)
        process.send_signal(signal.SIGTERM)
        out, err = process.communicate(timeout=30)
        self.assertEqual((process.returncode, out), (130, ""), err)
        self.assertIn("out: nothing was written; the former results stay\n", err)
        after = {path.name: path.read_bytes() for path in (self.folder / "out").iterdir() if path.suffix != ".resume"}
        self.assertEqual(before, after)

    def test_a_second_signal_ends_the_process_at_once(self):
        process = self.start(STUDIES["periodic"])
        time.sleep(0.5)
        process.send_signal(signal.SIGSTOP)  # so that both are there before the first is heard
        process.send_signal(signal.SIGINT)
        process.send_signal(signal.SIGTERM)
        process.send_signal(signal.SIGCONT)
        process.communicate(timeout=30)
        self.assertIn(process.returncode, (-signal.SIGINT, -signal.SIGTERM))

    def test_a_hangup_beside_another_signal_is_no_second_request(self):
        process = self.start(STUDIES["exact"])
        time.sleep(0.5)
        process.send_signal(signal.SIGSTOP)
        process.send_signal(signal.SIGTERM)
        process.send_signal(signal.SIGHUP)
        process.send_signal(signal.SIGCONT)
        process.communicate(timeout=30)
        self.assertEqual(process.returncode, 130)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1)
