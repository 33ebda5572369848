"""Fail if a file above the equations names a concrete system.

Usage: check_systems.py ROOT. What stands above the equations (src/rubato/analysis, io, report, and apps) takes a
system::System or an integrate::SystemKind, so that whatever is found, marched and shown exists once for all systems.
"""
import pathlib
import re
import sys

above = ["src/rubato/analysis", "src/rubato/io", "src/rubato/report", "apps"]
concrete = re.compile(
    r"\bLocallyNonlinear\b|\bsystem::Mechanism\b|\bMechanismEquations\b|\bStructureKind\b|\bMechanismKind\b"
    r"|\bnamespace\s+(rubato::)?system\s*\{\s*(class|struct)\s+(LocallyNonlinear|Mechanism)\b"
    r"|#\s*include\s*[<\"]rubato/(system/(locally_nonlinear|mechanism\w*)|integrate/kinds/(structure|mechanism)_\w+)\.hpp")

root = pathlib.Path(sys.argv[1]).resolve()


def without_comments(text):
    """The text, with comments as blanks, and lines where they were."""
    blank = lambda match: re.sub(r"[^\n]", " ", match[0])
    return re.sub(r"//[^\n]*|/\*.*?\*/", blank, text, flags=re.S)


faults, count = [], 0
for folder in above:
    for path in sorted((root / folder).rglob("*.[hc]pp")):
        count += 1
        found = concrete.search(text := without_comments(path.read_text()))
        if found:
            line, what = text.count("\n", 0, found.start()) + 1, found[0].replace("\n", " ")
            faults.append(f"{path.relative_to(root)}:{line}: names a concrete system ({what}); take a system::System or an "
                          "integrate::SystemKind, or move what needs the equations to the floor of the equations")
print("\n".join(faults) or f"none of {count} files above the equations names a concrete system")
sys.exit(bool(faults))
