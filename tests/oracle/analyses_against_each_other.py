"""The command against itself: `analyses_against_each_other.py COMMAND 1-20 [m1-m10 ...] [--only KIND ...] [--keep FOLDER] [--verbose]`.

Random models are answered by two ways that share little: a steady response and a long transient, a static state and the end
of a damped motion, modes and a free vibration, a damper curve and responses, a sweep and single runs. Seeds are of structures,
those with an `m` of mechanisms. Exit status 1 where two ways differ by more than their tolerances allow.
"""

import argparse
import collections
import os
import pathlib
import re
import sys
import tempfile

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import numpy as np  # noqa: E402

from cross_checks import curves, free_vibration, mechanisms, responses, statics, sweeps  # noqa: E402
from cross_checks.command import NoAnswer, Wrong  # noqa: E402
from study import Unreadable  # noqa: E402

STRUCTURES = {"response": responses.check, "static": statics.check, "modes": free_vibration.check, "curve": curves.check,
              "sweep": sweeps.check}
MECHANISMS = {"mechanism stays": mechanisms.rest_holds, "mechanism falls": mechanisms.rest_is_reached,
              "mechanism swings": mechanisms.small_swing, "mechanism jobs": mechanisms.jobs}
OUTCOMES = ["agrees", "differs", "refused", "failed", "skipped"]


def judged(check, command, seed, folder):
    """(outcome, what)"""
    try:
        found = check(command, seed, folder)
    except NoAnswer as why:
        return why.outcome, str(why)
    except Wrong as what:
        return "differs", str(what)
    except Unreadable as why:
        return "skipped", str(why)
    bad = [f for f in found if not f[1] <= f[2]]
    if bad:
        bad.sort(key=lambda f: -f[1])
        return "differs", f"{len(bad)} of {len(found)}: " + "; ".join(f"{what} {error:.3g}, allowed {allowed:.2g}" for what, error, allowed in bad[:3])
    worst = max(found, key=lambda f: f[1] / max(f[2], 1e-300))
    return "agrees", f"{worst[0]} {worst[1]:.2g} of {worst[2]:.2g}"


def wanted(words):
    """(checks, seed) of `1-20` and `m3`."""
    for word in words:
        letter, first, last = re.fullmatch(r"(m?)(\d+)(?:-m?(\d+))?", word).groups()
        for seed in range(int(first), int(last or first) + 1):
            yield (MECHANISMS if letter else STRUCTURES), letter, seed


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("command", type=pathlib.Path)
    parser.add_argument("seeds", nargs="+")
    parser.add_argument("--only", nargs="+", help="of: " + ", ".join([*STRUCTURES, *MECHANISMS]))
    parser.add_argument("--keep", help="a folder for the studies")
    parser.add_argument("--verbose", action="store_true")
    options = parser.parse_args()
    np.seterr(all="ignore")
    counts, differing = collections.defaultdict(collections.Counter), []
    for checks, letter, seed in wanted(options.seeds):
        for kind, check in checks.items():
            if options.only and kind not in options.only:
                continue
            with tempfile.TemporaryDirectory() as scratch:
                folder = pathlib.Path(options.keep or scratch) / f"{letter}{seed}" / kind.replace(" ", "_")
                folder.mkdir(parents=True)
                outcome, what = judged(check, options.command.resolve(), seed, folder)
            counts[kind][outcome] += 1
            if outcome == "differs":
                differing.append(f"{letter}{seed}")
            if outcome == "differs" or options.verbose:
                print(f"seed {letter}{seed} {kind}: {outcome}: {what}", flush=True)
    print(f"\n{'kind':<18}" + "".join(f"{o:>10}" for o in OUTCOMES))
    for kind in counts:
        print(f"{kind:<18}" + "".join(f"{counts[kind][o]:>10}" for o in OUTCOMES))
    print(f"seeds that differ: {' '.join(dict.fromkeys(differing))}")
    return 1 if differing else 0


if __name__ == "__main__":
    sys.exit(main())
