"""Fail if a source file includes a floor above its own.

Usage: check_floors.py src/rubato. The floors, lowest first, are the RUBATO_FLOORS list of its CMakeLists.txt.
"""
import os
import pathlib
import re
import sys

root = pathlib.Path(sys.argv[1]).resolve()
floors = re.search(r"set\(RUBATO_FLOORS ([^)]*)\)", (root / "CMakeLists.txt").read_text())[1].split()
height = {floor: i for i, floor in enumerate(floors)}


def floor_of_include(line, path):
    """The floor that a line includes, or None."""
    included = re.match(r'\s*#\s*include\s*([<"])([^>"]+)[>"]', line)
    if not included:
        return None
    quote, target = included.groups()
    if target.startswith("rubato/"):
        return target.split("/")[1]
    beside = pathlib.Path(os.path.normpath(path.parent / target))
    return beside.relative_to(root).parts[0] if quote == '"' and beside.is_relative_to(root) else None


faults = []
for path in sorted(root.rglob("*.[hc]pp")):
    name = path.relative_to(root)
    own = name.parts[0]
    if own not in height:
        faults.append(f"{name}: {own} is no floor")
        continue
    for number, line in enumerate(path.read_text().splitlines(), 1):
        used = floor_of_include(line, path)
        if used is None:
            continue
        if used not in height:
            faults.append(f"{name}:{number}: {used} is no floor")
        elif height[used] > height[own]:
            faults.append(f"{name}:{number}: {own} may not include {used}")
print("\n".join(faults) or f"{len(floors)} floors, no upward include")
sys.exit(bool(faults))
