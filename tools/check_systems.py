"""Fail if a file above the equations names a concrete system and is not on the list of those that still do.

Usage: check_systems.py ROOT LIST [--write]. What stands above the equations (src/rubato/analysis, io, report, and apps) takes a
system::System or an integrate::SystemKind, so that whatever is found, marched and shown exists once for all systems.
LIST has a path a line, from ROOT; it may only become shorter: a file that is not on it fails, and so does one that is
on it and names no system any more. --write leaves out of the list what need not be on it; it adds nothing.
"""
import pathlib
import re
import sys

above = ["src/rubato/analysis", "src/rubato/io", "src/rubato/report", "apps"]
concrete = re.compile(
    r"\bLocallyNonlinear\b|\bsystem::Mechanism\b|\bMechanismEquations\b|\bStructureKind\b|\bMechanismKind\b"
    r"|\bnamespace\s+(rubato::)?system\s*\{\s*(class|struct)\s+(LocallyNonlinear|Mechanism)\b"
    r"|#\s*include\s*[<\"]rubato/(system/(locally_nonlinear|mechanism\w*)|integrate/kinds/(structure|mechanism)_\w+)\.hpp")

root, listed_in = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2])
listed = [line for line in listed_in.read_text().splitlines() if line and not line.startswith("#")]


def without_comments(text):
    """The text, with comments as blanks, and lines where they were."""
    blank = lambda match: re.sub(r"[^\n]", " ", match[0])
    return re.sub(r"//[^\n]*|/\*.*?\*/", blank, text, flags=re.S)


naming = {}
for folder in above:
    for path in sorted((root / folder).rglob("*.[hc]pp")):
        found = concrete.search(text := without_comments(path.read_text()))
        if found:
            naming[str(path.relative_to(root))] = (text.count("\n", 0, found.start()) + 1, found[0].replace("\n", " "))

faults = [f"{path}:{line}: names a concrete system ({what}); take a system::System or an integrate::SystemKind, or move "
          "what needs the equations to the floor of the equations"
          for path, (line, what) in naming.items() if path not in listed]
faults += [f"{path}: names no concrete system any more; take it off the list, {listed_in.name}"
           for path in listed if path not in naming]
faults += [f"{path}: is on the list twice" for path in sorted(set(listed)) if listed.count(path) > 1]
if "--write" in sys.argv[3:]:
    kept = [line for line in listed_in.read_text().splitlines() if not line or line.startswith("#") or line in naming]
    listed_in.write_text("\n".join(kept) + "\n")
print("\n".join(faults) or f"{len(naming)} files above the equations still name a concrete system, all of them listed")
sys.exit(bool(faults))
