"""Joints of mechanisms in other words: `joints_otherwise.py COMMAND 1-40 [--keep FOLDER] [--verbose]`.

Random mechanisms with bushings, gears, locks and rates of joints are written in two ways that mean the same
(`cross_checks/joints_otherwise.py` has a table of them). Exit status 1 where the command's tables differ.
"""

import os
import pathlib
import sys

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

from cross_checks import joints_otherwise, two_ways  # noqa: E402

if __name__ == "__main__":
    sys.exit(two_ways.main({"": joints_otherwise.models}))
