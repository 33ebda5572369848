"""Fail if a folder with more than a dozen files has no README.md, or if that tells of files that are not there.

Usage: check_readmes.py ROOT. What stands in backticks in the first column of a table of files or folders must be how the
name of one begins.
"""
import os
import pathlib
import re
import sys

most = 12
root = pathlib.Path(sys.argv[1]).resolve()
files = {}
for top in ("apps", "benchmarks", "cmake", "docs", "examples", "python", "scripts", "src", "tests", "tools"):
    for folder, folders, names in os.walk(root / top):
        folders[:] = [name for name in folders if name not in ("results", "__pycache__", "node_modules")]
        if names:
            files[pathlib.Path(folder)] = set(names)

faults = []
for folder, names in sorted(files.items()):
    count = len(names - {"README.md", "CMakeLists.txt"})
    if count > most and "README.md" not in names:
        faults.append(f"{folder.relative_to(root)}: {count} files and no README.md")
    if count > most and "README.md" in names:
        text = (folder / "README.md").read_text()
        rows = "".join(re.findall(r"^\| (?:files?|folder) \|.*\n((?:\|.*\n)*)", text, re.MULTILINE))
        for row in re.findall(r"^\| (`.*?) \|", rows, re.MULTILINE):
            for said in re.findall(r"`([\w./-]+)[*]?[^`]*`", row):
                if not said.startswith(("_", "...")) and not list(folder.glob(said.rstrip("/.") + "*")):
                    faults.append(f"{folder.relative_to(root)}/README.md names {said}, which is not there")
print("\n".join(faults) or f"{len(files)} folders, none of more than {most} files without a README.md")
sys.exit(bool(faults))
