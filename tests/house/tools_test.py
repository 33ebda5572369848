"""The tools that judge a change: tools/record_answers and tools/compare_benchmarks. Usage: tools_test.py ROOT RUBATO."""
import pathlib
import shutil
import subprocess
import sys
import tempfile
import tomllib
import unittest

ROOT, RUBATO = pathlib.Path(sys.argv[1]), sys.argv[2]


def run(*words, **options):
    return subprocess.run([sys.executable, *map(str, words)], capture_output=True, text=True, timeout=250, **options)


class Tools(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="rubato-tools-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def build(self, name, rounds):
        """A build folder whose programs do nothing, so many times."""
        for path in ("apps/rubato/rubato", "benchmarks/steps"):
            program = self.folder / name / path
            program.parent.mkdir(parents=True)
            program.write_text(f"#!/bin/sh\ni=0\nwhile [ $i -lt {rounds} ]; do i=$((i + 1)); done\n")
            program.chmod(0o755)
        return self.folder / name

    def test_answers_of_an_example_are_stored_and_compare_as_equal(self):
        for name in "ab":
            result = run(ROOT / "tools/record_answers", RUBATO, self.folder / name, "--studies", "0", "--only", "single-mass")
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertEqual(result.stdout, "examples/single-mass: exit 0\nruns: exit 0\n")
        self.assertTrue((self.folder / "a/examples/single-mass/results/response.csv").is_file())
        self.assertEqual((self.folder / "a/examples/single-mass/status.csv").read_text(), "analysis,exit,messages\nall,exit 0,\n")
        compared = subprocess.run([RUBATO, "compare", "a", "b", "--tolerance", "0"], cwd=self.folder, timeout=60)
        self.assertEqual(compared.returncode, 0)

    def test_a_refused_analysis_does_not_take_the_answers_of_others_away(self):
        # It takes one of the two analyses.
        program = self.folder / "rubato"
        program.write_text("""#!/bin/sh
while [ $# -gt 0 ]; do case $1 in -o) mkdir -p $2; folder=$2;; --only) only=$2;; esac; shift; done
case $only in
  response) echo "time [s]" > $folder/response.csv;;
  *) echo "refused" >&2; exit 2;;
esac
""")
        program.chmod(0o755)
        study = tomllib.loads((ROOT / "examples/single-mass/study.toml").read_text())
        names = [analysis["name"] for analysis in study["analysis"]]
        self.assertIn("response", names)
        result = run(ROOT / "tools/record_answers", program, self.folder / "a", "--studies", "0", "--only", "single-mass")
        self.assertEqual(result.returncode, 0, result.stderr)
        stored = self.folder / "a/examples/single-mass"
        self.assertEqual([path.name for path in (stored / "results").iterdir()], ["response.csv"])
        told = (stored / "status.csv").read_text().splitlines()[1:]
        self.assertEqual(told, [f"{name},exit 0," if name == "response" else f"{name},exit 2,refused" for name in names])

    def test_answers_do_not_mix(self):
        (self.folder / "old").write_text("")
        result = run(ROOT / "tools/record_answers", RUBATO, self.folder, "--studies", "0")
        self.assertEqual(result.returncode, 2)
        self.assertIn("the folder is not empty", result.stderr)

    def test_a_generated_study_is_stored_with_its_seed(self):
        try:
            import scipy  # noqa: F401
        except ImportError:
            self.skipTest("scipy is not installed")
        result = run(ROOT / "tools/record_answers", RUBATO, self.folder / "a", "--studies", "1", "--seed", "3", "--only",
                     "single-mass")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertTrue((self.folder / "a/generated/0003/study.toml").is_file())
        self.assertTrue((self.folder / "a/generated/0003/status.csv").is_file())

    def test_a_build_that_does_twice_the_work_takes_twice_the_time(self):
        base, new = self.build("base", 40000), self.build("new", 80000)
        result = run(ROOT / "tools/compare_benchmarks", base, new, "--run", "steps 1", "--examples", "single-mass", "--rounds",
                     "5", "--most", "1.2")
        self.assertEqual(result.returncode, 1, result.stdout + result.stderr)
        for line in result.stdout.splitlines()[1:]:
            words = line.replace("steps 1", "steps").split()
            self.assertTrue(1.4 < float(words[3]) < 2.8, line)
            self.assertTrue(float(words[4]) <= float(words[3]) <= float(words[6]), line)
        self.assertEqual(len(result.stdout.splitlines()), 3)

    def test_programs_that_are_not_there_are_wrong_use(self):
        base = self.build("base", 1)
        result = run(ROOT / "tools/compare_benchmarks", base, self.folder / "none", "--run", "steps")
        self.assertEqual(result.returncode, 2)
        self.assertIn("none/benchmarks/steps is no program", result.stderr)

    def test_help_says_what_they_are_for(self):
        for tool in ("record_answers", "compare_benchmarks"):
            self.assertEqual(run(ROOT / "tools" / tool, "--help").returncode, 0)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
