"""What the tests of the command share: a folder of their own, the command in it, and its tables."""
import csv
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

RUBATO = sys.argv[1]
NCDUMP = shutil.which("ncdump")  # of netcdf-bin; without it the files are judged by the report alone

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


class CommandCase(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="rubato-command-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def run_command(self, *arguments, **options):
        return subprocess.run([RUBATO, *map(str, arguments)], capture_output=True, text=True, cwd=self.folder, timeout=120,
                              **options)

    def write(self, text, name="study.toml"):
        (self.folder / name).write_text(text)
        return name

    def dump(self, path, *options):
        return subprocess.run([NCDUMP, *options, self.folder / path], capture_output=True, text=True, check=True,
                              timeout=60).stdout

    def rows(self, path):
        with open(self.folder / path, newline="") as file:
            return list(csv.reader(file))
