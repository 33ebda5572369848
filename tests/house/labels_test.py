"""Each test has one label of those that tests/README.md lists, and perhaps `slow` besides.

Usage: labels_test.py ROOT BUILD CTEST
"""
import json
import pathlib
import re
import subprocess
import sys

root, build, ctest = pathlib.Path(sys.argv[1]), sys.argv[2], sys.argv[3]
table = (root / "tests" / "README.md").read_text().split("| label |")[1].split("\n\n")[0]
known = {label for row in table.split("\n")[2:] for label in re.findall(r"`(\w+)`", row.split("|")[1])}
told = subprocess.run([ctest, "--test-dir", build, "--show-only=json-v1"], check=True, capture_output=True, text=True)
faults, counted = [], 0
for test in json.loads(told.stdout)["tests"]:
    if test["name"].endswith("_NOT_BUILT"):
        continue
    counted += 1
    labels = next((list(entry["value"]) for entry in test.get("properties", []) if entry["name"] == "LABELS"), [])
    floors = [label for label in labels if label != "slow"]
    if len(floors) != 1 or not set(labels) <= known:
        faults.append(f"{test['name']}: {labels}")
print("\n".join(faults) or f"{counted} tests, each with its label")
if counted == 0 or len(known) < 10:
    sys.exit("no tests or no labels were found")
sys.exit(bool(faults))
