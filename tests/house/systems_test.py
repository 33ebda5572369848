"""The keeper of the systems must refuse what it is there to refuse.

Usage: systems_test.py CHECK_SYSTEMS.py
"""
import pathlib
import subprocess
import sys
import tempfile
import unittest

keeper = sys.argv.pop(1)


class Systems(unittest.TestCase):
    def check(self, files):
        """Runs the keeper on a tree with these files; returns how it ended."""
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            for name, text in files.items():
                (root / name).parent.mkdir(parents=True, exist_ok=True)
                (root / name).write_text(text)
            return subprocess.run([sys.executable, keeper, folder], capture_output=True, text=True)

    def test_files_that_take_any_system_pass_and_so_do_words_in_comments(self):
        ran = self.check({"src/rubato/analysis/modes.cpp": "#include <rubato/system/system.hpp>\n"
                                                              "// as LocallyNonlinear has it\nvoid f(const system::System&);\n"})
        self.assertEqual(ran.returncode, 0, ran.stdout + ran.stderr)

    def test_a_file_that_names_one_is_refused_with_its_line(self):
        for line in ("void f(const system::LocallyNonlinear&);", "#include <rubato/system/mechanism.hpp>",
                     '#include "rubato/system/mechanism_equations.hpp"', "system::Mechanism m;",
                     "namespace rubato::system {\nclass Mechanism;\n}", "integrate::StructureKind kind(system);",
                     "#include <rubato/integrate/kinds/mechanism_kind.hpp>"):
            for folder in ("src/rubato/analysis/steady", "src/rubato/io", "src/rubato/report", "apps/rubato"):
                ran = self.check({folder + "/new.cpp": "\n" + line + "\n"})
                self.assertNotEqual(ran.returncode, 0, line)
                self.assertIn(folder + "/new.cpp:2: names a concrete system", ran.stdout)

    def test_the_floors_of_the_equations_may_name_them(self):
        ran = self.check({"src/rubato/integrate/driver.cpp": "system::LocallyNonlinear s;\n"})
        self.assertEqual(ran.returncode, 0, ran.stdout)


if __name__ == "__main__":
    unittest.main()
