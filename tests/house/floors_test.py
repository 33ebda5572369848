"""The keeper of the floors must refuse what it is there to refuse.

Usage: floors_test.py CHECK_FLOORS.py
"""
import pathlib
import subprocess
import sys
import tempfile
import unittest

keeper = sys.argv.pop(1)


class Floors(unittest.TestCase):
    def check(self, files):
        """Runs the keeper on a tree of three floors with these files."""
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            (root / "CMakeLists.txt").write_text("set(RUBATO_FLOORS core model io)\n")
            for name, text in files.items():
                (root / name).parent.mkdir(parents=True, exist_ok=True)
                (root / name).write_text(text)
            return subprocess.run([sys.executable, keeper, folder], capture_output=True, text=True)

    def test_includes_down_and_sideways_pass(self):
        result = self.check({"core/error.hpp": "", "model/model.hpp": "#include <rubato/core/error.hpp>\n",
                             "io/read.cpp": "#include <rubato/model/model.hpp>\n#include <rubato/io/read.hpp>\n"})
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)

    def test_an_include_upwards_is_refused_and_named(self):
        result = self.check({"core/error.hpp": "#pragma once\n#include <rubato/model/model.hpp>\n"})
        self.assertNotEqual(result.returncode, 0)
        self.assertIn("core/error.hpp:2: core may not include model", result.stdout)

    def test_neither_quotes_nor_spaces_nor_depth_hide_it(self):
        for line in ('#include "rubato/io/read.hpp"', "#  include  <rubato/io/read.hpp>", '#include "../../io/read.hpp"'):
            result = self.check({"model/springs/spring.cpp": line + "\n", "io/read.hpp": ""})
            self.assertNotEqual(result.returncode, 0, line)

    def test_a_floor_that_is_not_in_the_list_is_refused(self):
        self.assertNotEqual(self.check({"attic/box.hpp": ""}).returncode, 0)
        self.assertNotEqual(self.check({"io/read.cpp": "#include <rubato/attic/box.hpp>\n"}).returncode, 0)


if __name__ == "__main__":
    unittest.main()
