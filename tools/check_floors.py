"""Fail if a source file includes a floor above its own.

The floors, lowest first, are the RUBATO_FLOORS list of src/rubato/CMakeLists.txt.
"""
import pathlib
import re
import sys

root = pathlib.Path(sys.argv[1])
floors = re.search(r"set\(RUBATO_FLOORS ([^)]*)\)", (root / "CMakeLists.txt").read_text())[1].split()
height = {floor: i for i, floor in enumerate(floors)}

faults = []
for path in sorted(root.rglob("*.[hc]pp")):
    own = path.relative_to(root).parts[0]
    for number, line in enumerate(path.read_text().splitlines(), 1):
        used = re.match(r"\s*#include <rubato/(\w+)/", line)
        if used and height[used[1]] > height[own]:
            faults.append(f"{path.relative_to(root)}:{number}: {own} may not include {used[1]}")
print("\n".join(faults) or f"{len(floors)} floors, no upward include")
sys.exit(bool(faults))
