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
    def check(self, files, listed=(), *options):
        """Runs the keeper on a tree with these files; returns how it ended and the list that it left."""
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            names = root / "list.txt"
            names.write_text("# those that still do\n" + "".join(name + "\n" for name in listed))
            for name, text in files.items():
                (root / name).parent.mkdir(parents=True, exist_ok=True)
                (root / name).write_text(text)
            ran = subprocess.run([sys.executable, keeper, folder, str(names), *options], capture_output=True, text=True)
            return ran, names.read_text()

    def test_files_that_take_any_system_pass_and_so_do_words_in_comments(self):
        ran, _ = self.check({"src/rubato/analysis/modes.cpp": "#include <rubato/system/system.hpp>\n"
                                                              "// as LocallyNonlinear has it\nvoid f(const system::System&);\n"})
        self.assertEqual(ran.returncode, 0, ran.stdout + ran.stderr)

    def test_a_file_that_names_one_is_refused_with_its_line(self):
        for line in ("void f(const system::LocallyNonlinear&);", "#include <rubato/system/mechanism.hpp>",
                     '#include "rubato/system/mechanism_equations.hpp"', "system::Mechanism m;",
                     "namespace rubato::system {\nclass Mechanism;\n}", "integrate::StructureKind kind(system);",
                     "#include <rubato/integrate/kinds/mechanism_kind.hpp>"):
            for folder in ("src/rubato/analysis/steady", "src/rubato/io", "src/rubato/report", "apps/rubato"):
                ran, _ = self.check({folder + "/new.cpp": "\n" + line + "\n"})
                self.assertNotEqual(ran.returncode, 0, line)
                self.assertIn(folder + "/new.cpp:2: names a concrete system", ran.stdout)

    def test_the_floors_of_the_equations_may_name_them(self):
        ran, _ = self.check({"src/rubato/integrate/driver.cpp": "system::LocallyNonlinear s;\n"})
        self.assertEqual(ran.returncode, 0, ran.stdout)

    def test_the_list_excuses_a_file_and_may_only_become_shorter(self):
        old = {"src/rubato/analysis/old.cpp": "system::Mechanism m;\n"}
        ran, _ = self.check(old, ["src/rubato/analysis/old.cpp"])
        self.assertEqual(ran.returncode, 0, ran.stdout)
        mended = {"src/rubato/analysis/old.cpp": "\n"}
        for files in (mended, {}):
            ran, left = self.check(files, ["src/rubato/analysis/old.cpp"], "--write")
            self.assertNotEqual(ran.returncode, 0)
            self.assertIn("take it off the list", ran.stdout)
            self.assertEqual(left, "# those that still do\n")
        _, left = self.check(old, [], "--write")
        self.assertEqual(left, "# those that still do\n")


if __name__ == "__main__":
    unittest.main()
