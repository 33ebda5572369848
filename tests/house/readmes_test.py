"""check_readmes.py accepts a tree, and refuses a full folder without a README and a README of what is not there.

Usage: readmes_test.py CHECK_READMES
"""
import pathlib
import subprocess
import sys
import tempfile

judge = sys.argv[1]


def verdict(count, readme):
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name) / "src"
        folder.mkdir()
        for i in range(count):
            (folder / f"part{i}.hpp").touch()
        if readme:
            (folder / "README.md").write_text(readme)
        return subprocess.run([sys.executable, judge, name], capture_output=True, text=True)


tells = "| files | what they do |\n|---|---|\n| `part1`, `part2.hpp`, `part...` | all |\n"
other = "\n| law | costs |\n|---|---|\n| `bouc_wen` | little |\n"
cases = [(12, "", ""), (13, tells + other, ""), (13, "", "src: 13 files and no README.md"),
         (13, tells.replace("part2", "part99"), "src/README.md names part99.hpp, which is not there")]
for count, readme, fault in cases:
    found = verdict(count, readme)
    if (found.returncode != 0) != bool(fault) or fault not in found.stdout:
        sys.exit(f"{count} files, README {readme!r}: {found.returncode}, {found.stdout}{found.stderr}")
