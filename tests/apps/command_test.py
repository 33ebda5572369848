"""The command as a user meets it: exit status, streams, files. Usage: command_test.py RUBATO EXAMPLES."""
import math
import os
import pathlib
import re
import shutil
import sys
import unittest

from command_case import CommandCase, LONG, NCDUMP

EXAMPLES = pathlib.Path(sys.argv[2])


class Command(CommandCase):
    def test_run_writes_everything_and_names_the_report(self):
        result = self.run_command("run", EXAMPLES / "single-mass-slider" / "study.toml", "-o", "out")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(result.stdout, "out/report.html\n")
        names = {entry.name for entry in (self.folder / "out").iterdir()}
        self.assertEqual(names, {"results.nc", "report.html", "response.csv", "response.energy.csv",
                                 "response.events.csv", "response.extremes.csv", "exact.csv", "exact.energy.csv",
                                 "exact.events.csv", *(f"{name}.csv" for name in (
                                     "frf", "frf.linear", "frf.waveforms", "marched", "marched.linear", "damper",
                                     "damper.linear", "damper.peaks", "damper.optimum"))})
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
                  'error: --set N1: no such parameter; did you mean "N0"? (known: N0, Omega)\n'),
                 (["run", study, "-o", "out", "--only", "exat"],
                  'error: --only exat: no such analysis; did you mean "exact"? (known: response, exact, frf, marched, damper)\n'),
                 (["methods", "newmrk"], 'error: unknown method "newmrk"; did you mean "newmark"? `rubato methods` lists them\n'),
                 (["example", "single-mas"], None)]
        for arguments, message in cases:
            result = self.run_command(*arguments)
            self.assertEqual((result.returncode, result.stdout), (2, ""), arguments)
            if message:
                self.assertEqual(result.stderr, message)
            self.assertFalse((self.folder / "out").exists())
        options = 'known: --help, --only, --set, --output, --jobs, --resume, --yes, --vtk, ...'
        for arguments, message in [
                (["run", study, "--sett", "a=1"],
                 f'error: the argument "--sett" is unknown; did you mean "--set"? ({options})\n`rubato run --help` says more\n'),
                (["run", study, "--jobs", "0"],
                 "error: --jobs: Value 0 not in range 1 to 1024\n`rubato run --help` says more\n"),
                (["run", study, "--set", "N0"], "error: --set N0: write PARAM=VALUE, such as --set N0=25\n"),
                (["run", study, "--set", "N0=1+"], None),
                (["run", study, "--set", "N0=-1"], None),
                (["run"], "error: name the study file: rubato run STUDY.toml\n"),
                ([], "error: A subcommand is required\n`rubato --help` says more\n"),
                (["rnu", study], 'error: the subcommand or option "rnu" is unknown; did you mean "run"? '
                                 '(known: run, check, methods, laws, example, compare, schema, --help, ...)\n'
                                 '`rubato --help` says more\n')]:
            result = self.run_command(*arguments)
            self.assertEqual((result.returncode, result.stdout), (2, ""), arguments)
            self.assertIn("error: ", result.stderr)
            if message:
                self.assertEqual(result.stderr, message)

    def test_the_bodies_of_a_mechanism_in_space_are_drawn_joined(self):
        result = self.run_command("run", EXAMPLES / "bricard" / "study.toml", "-o", "out", "--vtk")
        self.assertEqual(result.returncode, 0, result.stderr)
        nodes = self.rows("out/motion.nodes.csv")
        column = nodes[0].index("x [m]")
        start = [tuple(map(float, row[column:column + 3])) for row in nodes[1:]]
        bodies = 5
        pairs = [(i, j) for j in range(bodies, len(start)) for i in range(bodies, j) if math.dist(start[i], start[j]) < 1e-9]
        self.assertEqual(len(pairs), 6)  # hinges, each with a point on both of its parts
        joints = self.rows("out/motion.joints.csv")
        self.assertEqual([row[:2] for row in joints[1:]], [[f"hinge {i}", "revolute"] for i in range(1, 7)])
        frames = sorted((self.folder / "out/vtk/motion").glob("*.vtp"))
        self.assertGreater(len(frames), 100)
        for frame in frames:
            numbers = re.search(r'Name="points"[^>]*>([^<]*)<', frame.read_text()).group(1).split()
            points = [tuple(map(float, numbers[3 * i:3 * i + 3])) for i in range(len(start))]
            for i, j in pairs:  # joined to the error of the interpolation between steps
                self.assertLess(math.dist(points[i], points[j]), 1e-5, frame.name)

    def test_the_study_may_follow_lists_of_names_and_settings(self):
        study = EXAMPLES / "single-mass-slider" / "study.toml"
        for options in (["--only", "response", "exact"], ["--set", "N0=0.5"], ["--only", "exact", "--set", "N0=.5"]):
            result = self.run_command("run", "-q", "-o", "out", *options, study)
            # Analyses that sweep N0 themselves warn that the setting does not reach them; nothing else is said.
            told = [line for line in result.stderr.splitlines() if "--set N0=0.5 does not change the model" not in line]
            self.assertEqual((result.returncode, told), (0, []), options)
            self.assertEqual(self.run_command("check", *options, study).returncode, 0)

    def test_results_do_not_depend_on_the_number_of_jobs(self):
        study = EXAMPLES / "single-mass-slider" / "study.toml"
        for jobs in ("1", "2"):
            self.assertEqual(self.run_command("run", study, "-o", jobs, "--jobs", jobs).returncode, 0)
        names = sorted(path.name for path in (self.folder / "1").glob("*.csv"))
        self.assertGreaterEqual(len(names), 4)
        for name in names:
            self.assertEqual((self.folder / "1" / name).read_bytes(), (self.folder / "2" / name).read_bytes())
        if NCDUMP:
            one, two = (self.dump(f"{jobs}/results.nc").replace(f"-o {jobs} --jobs {jobs}", "").splitlines()
                        for jobs in "12")
            differing = [line for line, other in zip(one, two, strict=True) if line != other]
            self.assertTrue(all(":history" in line for line in differing), differing)

    def test_tables_of_a_former_run_are_set_aside(self):
        study = EXAMPLES / "single-mass-slider" / "study.toml"
        self.assertNotIn("former", self.run_command("run", "-o", "twice", study, "--only", "response", "exact").stderr)
        (self.folder / "twice/notes.csv").write_text("of the user")
        response = (self.folder / "twice/response.csv").read_bytes()
        again = self.run_command("run", "-o", "twice", study, "--only", "exact")
        self.assertEqual(again.returncode, 0)
        self.assertIn("tables of a former run, which these results do not have, were moved to twice/former: response.csv, "
                      "response.energy.csv, response.events.csv, response.extremes.csv\n", again.stderr)
        self.assertEqual({entry.name for entry in (self.folder / "twice").iterdir()},
                         {"former", "notes.csv", "results.nc", "report.html", "exact.csv", "exact.energy.csv",
                          "exact.events.csv"})
        self.assertEqual((self.folder / "twice/former/response.csv").read_bytes(), response)
        self.assertNotIn("former", self.run_command("run", "-o", "twice", study, "--only", "exact").stderr)

    def test_resume_tells_what_begins_anew(self):
        study = self.write(LONG.replace("DURATION", "1.0"))
        result = self.run_command("run", study, "--resume")
        self.assertEqual(result.returncode, 0)
        self.assertIn('--resume: "long" begins anew: only sweeps go on where they stopped\n',
                      result.stderr)

    def test_an_analysis_without_a_static_start_leaves_the_others_alone(self):
        (self.folder / "falls.toml").write_text("""
[[body]]
name = "bob"
mass = 1.0
inertia = 1.0
position = [0.0, 0.0]
[[joint]]
name = "rail"
type = "prismatic"
between = ["ground", "bob"]
at = [0.0, 0.0]
axis = [0.0, 1.0]
[gravity]
acceleration = [0.0, -9.81]
[[analysis]]
name = "held"
type = "modes"
about = "static"
[[analysis]]
name = "falls"
type = "transient"
step = 0.01
duration = 0.1
""")
        result = self.run_command("run", "falls.toml", "-o", "out", "-q")
        self.assertEqual(result.returncode, 3, result.stderr)
        self.assertIn('analysis "held" failed: no equilibrium was found', result.stderr)
        self.assertEqual(len(self.rows("out/falls.csv")), 12)
        check = self.run_command("check", "falls.toml")
        self.assertEqual(check.returncode, 0)
        self.assertIn('falls.toml: warning: analysis "held": it will fail: no equilibrium was found', check.stderr)

    def test_a_structure_that_gives_way_under_its_loads_leaves_other_analyses_alone(self):
        (self.folder / "snaps.toml").write_text("""
[[coordinate]]
name = "x"
mass = 1.0
[[nonlinear_spring]]
between = ["x", "ground"]
force = "u*(1 - u)^2"
[[force]]
on = "x"
expression = "1.0"
[[analysis]]
name = "rest"
type = "static"
[[analysis]]
name = "from_rest"
type = "transient"
initial = "static"
step = 0.01
duration = 0.1
[[analysis]]
name = "goes"
type = "transient"
step = 0.01
duration = 0.1
output = { times = [0.05, 0.10000000000000002] }
""")
        result = self.run_command("run", "snaps.toml", "-o", "out", "-q")
        self.assertEqual(result.returncode, 3, result.stderr)
        self.assertIn('analysis "rest" failed: there is no equilibrium that loads grown from zero lead to', result.stderr)
        self.assertIn('analysis "from_rest" failed: it has no static start', result.stderr)
        self.assertEqual(len(self.rows("out/goes.csv")), 3)
        check = self.run_command("check", "snaps.toml")
        self.assertEqual(check.returncode, 0)
        self.assertIn('analysis "rest": it will fail: there is no equilibrium', check.stderr)

    def test_contacts_between_rotations_are_headed_by_moments_and_angles(self):
        (self.folder / "turns.toml").write_text("""
[[node]]
name = "hub"
position = [0.0, 0.0]
[[mass]]
node = "hub"
mass = 1.0
inertia = 1.0
[[spring]]
between = ["hub.x", "ground"]
stiffness = 1.0
[[spring]]
between = ["hub.y", "ground"]
stiffness = 1.0
[[spring]]
between = ["hub.rz", "ground"]
stiffness = 1.0
[[contact]]
name = "face"
tangential = { "hub.rz" = 1.0 }
normal = { "hub.x" = 1.0 }
tangential_stiffness = 2.0
normal_stiffness = 3.0
friction_coefficient = 0.5
normal_load = 1.0
[[force]]
on = "hub.rz"
expression = "0.1"
[[analysis]]
name = "rest"
type = "static"
""")
        result = self.run_command("run", "turns.toml", "-o", "out", "-q")
        self.assertEqual(result.returncode, 0, result.stderr)
        heads = self.rows("out/rest.csv")[0]
        for head in ("face.tangential_moment [N m]", "face.slip_angle [rad]", "face.normal_force [N]", "face.gap [m]"):
            self.assertIn(head, heads)

    def test_a_wrong_study_leaves_earlier_results_alone(self):
        study = EXAMPLES / "single-mass" / "study.toml"
        self.run_command("run", study, "-o", "out", "-q")
        before = {path.name: path.read_bytes() for path in (self.folder / "out").iterdir()}
        self.assertIn("results.nc", before)
        self.write((study).read_text().replace("mass = ", "mass = -"))
        self.assertEqual(self.run_command("run", "study.toml", "-o", "out").returncode, 2)
        self.assertEqual(before, {path.name: path.read_bytes() for path in (self.folder / "out").iterdir()})

    def test_help_names_every_option_and_the_version_is_a_line(self):
        self.assertRegex(self.run_command("--version").stdout, r"^rubato \d+\.\d+\.\d+\n$")
        text = self.run_command("--help")
        self.assertEqual((text.returncode, text.stderr), (0, ""))
        for word in ("run", "check", "methods", "laws", "example", "schema", "rubato run underplatform-damper/study.toml"):
            self.assertIn(word, text.stdout)
        text = self.run_command("run", "--help").stdout
        for word in ("--only NAME ...", "--set PARAM=VALUE ...", "-o,--output DIR", "--jobs N", "-q,--quiet"):
            self.assertIn(word, text)

    def test_check_says_what_would_run(self):
        result = self.run_command("check", EXAMPLES / "underplatform-damper" / "study.toml")
        self.assertEqual(result.returncode, 0)
        self.assertIn("5 coordinates, 2 sliders", result.stdout)
        self.assertIn("transient, generalized_alpha, 12000 steps of 0.005 s to t = 60 s", result.stdout)

    def test_values_that_no_material_has_are_told(self):
        slider = '[[slider]]\nname = "s"\nbetween = ["mass", "ground"]\nstiffness = 1.0\nfriction_coefficient = 50\nnormal_load = 1.0\n'
        study = self.write(LONG.replace("DURATION", "1") + slider)
        told = (f'{study}:22:24: warning: slider "s": friction_coefficient is 50, and dry materials have 0.05 to 1.5; '
                'is it in percent? (0.3 means 30 %)\n')
        self.assertEqual(self.run_command("check", study).stderr, told)
        self.assertIn(told, self.run_command("run", study).stderr)
        frame = (EXAMPLES / "frame" / "study.toml").read_text()
        soft = re.sub(r"young = [0-9.e]+", "young = 210.0", frame)
        self.assertNotEqual(soft, frame)
        self.assertRegex(self.run_command("check", self.write(soft)).stderr,
                         'warning: material ".*": young is 210 Pa, softer than gelatine; steel has 2.1e11 Pa: is it in '
                         'GPa or MPa[?]\n')
        self.assertEqual(self.run_command("check", self.write(frame)).stderr, "")

    def test_check_tells_the_freedoms_that_joints_and_drives_leave(self):
        # A slider-crank of three bodies has nine coordinates and eight rows; a second guide repeats two of them.
        text = "".join(f"""
[[body]]
name = "{name}"
mass = 1.0
inertia = 0.1
position = [{x}, 0.5]
""" for name, x in (("crank", 0.0), ("rod", 0.5), ("slider", 1.0)))
        joints = (("A", "revolute", "ground", "crank", 0.0, 0.0), ("B", "revolute", "crank", "rod", 0.0, 1.0),
                  ("C", "revolute", "rod", "slider", 1.0, 0.0), ("D", "prismatic", "ground", "slider", 1.0, 0.0),
                  ("E", "prismatic", "ground", "slider", 1.5, 0.0))

        def size_with(count, keys=""):
            parts = [f"""
[[joint]]
name = "{name}"
type = "{kind}"
between = ["{first}", "{second}"]
at = [{x}, {y}]
{"axis = [1.0, 0.0]" if kind == "prismatic" else ""}
{keys if name == "A" else ""}
""" for name, kind, first, second, x, y in joints[:count]]
            self.write(text + "".join(parts) + """
[[analysis]]
name = "run"
type = "transient"
step = 0.01
duration = 1.0
""")
            return self.run_command("check", "study.toml").stdout.splitlines()[1].strip()

        self.assertEqual(size_with(4), "9 coordinates, 8 constraints (0 of drives, 0 redundant), 1 degree of freedom left, "
                                       "0 locks")
        self.assertEqual(size_with(5), "9 coordinates, 10 constraints (0 of drives, 2 redundant), 1 degree of freedom left, "
                                       "0 locks")
        self.assertEqual(size_with(4, 'drive = "0.1*t"'), "9 coordinates, 9 constraints (1 of drives, 0 redundant), "
                                                          "0 degrees of freedom left, 0 locks")
        self.assertEqual(size_with(4, 'lock = { at = 1.0, kind = "latch" }'),
                         "9 coordinates, 8 constraints (0 of drives, 0 redundant), 1 degree of freedom left, 1 lock")

    def test_laws_names_every_law_and_what_to_take_where_one_is_refused(self):
        lines = self.run_command("laws").stdout.splitlines()
        table = {line.split("  ")[0]: line for line in lines[1:14]}
        for law in ("slider", "stop", "bouc_wen", "cable", "dahl", "iwan", "lugre", "nonlinear_spring", "smooth_friction", "contact", "joint friction", "joint lock"):
            self.assertIn(law, table)
        column = lines[0].index("harmonic_balance")
        self.assertTrue(table["bouc_wen"][column:].startswith("by samples"))
        self.assertTrue(table["contact"][column:].startswith("by samples"))
        self.assertTrue(table["joint friction"][column:].startswith("- "))
        self.assertIn('  laws under periodic: take solver = "harmonic_balance" or "time_marching"', lines)

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

    def test_a_name_that_files_or_netcdf_cannot_bear_is_refused_by_check(self):
        study = self.write(LONG.replace("DURATION", "1.0"))
        self.assertEqual(self.run_command("run", study, "-o", "out", "-q").returncode, 0)
        before = {path.name: path.read_bytes() for path in (self.folder / "out").iterdir()}
        for name in ("-o", "(a)", "{}", "a" * 257, "a/b", "..", "a "):
            self.write(LONG.replace("DURATION", "1.0").replace('"long"', f'"{name}"'))
            for command in (["check", study], ["run", study, "-o", "out"]):
                result = self.run_command(*command)
                self.assertEqual((result.returncode, result.stdout), (2, ""), name)
                self.assertIn("becomes the name of files and of a netCDF group: it begins with a letter", result.stderr)
        self.assertEqual(before, {path.name: path.read_bytes() for path in (self.folder / "out").iterdir()})

    def test_failed_mathematics_exits_with_3_and_keeps_the_rows(self):
        study = self.write(LONG.replace("DURATION", "5.0").replace("amplitude = 1.0\nangular_frequency = 2.0",
                                                                   'expression = "1/(t - 2)"').replace("every = 100", "every = 1"))
        result = self.run_command("run", study, "-o", "out")
        self.assertEqual(result.returncode, 3)
        self.assertIn('study.toml: analysis "long" failed: at t = 1.99 s', result.stderr)
        self.assertEqual(len(self.rows("out/long.csv")), 201)
        self.assertTrue((self.folder / "out/report.html").exists())


if __name__ == "__main__":
    os.environ.pop("RUBATO", None)
    unittest.main(argv=sys.argv[:1], verbosity=1)
