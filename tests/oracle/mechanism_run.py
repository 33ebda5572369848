"""Random mechanisms held against the oracle: `mechanism_run.py COMMAND FIRST LAST [--keep FOLDER] [--verbose]`.

`--sample 0` and `--sample 1` run the seeds of the suite instead: those that take little time. Exit status 1 where the command and the
oracle differ, or where the oracle skips more than a twentieth.
"""

import argparse
import collections
import os
import pathlib
import re
import resource
import signal
import subprocess
import sys
import tempfile

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import numpy as np  # noqa: E402

from random_mechanism import generate, with_laws, with_mounts  # noqa: E402
from run import keys_of  # noqa: E402
from mechanism import Mechanism  # noqa: E402
from mechanism.judge import LOOSER, judge, unit_of  # noqa: E402
from mechanism.march import March  # noqa: E402
from mechanism.rest import equilibrium  # noqa: E402
from study import Study, Unreadable  # noqa: E402

ORACLE_SECONDS = 20
COMMAND_SECONDS = 20
# Those that take the oracle less than two seconds of its processor time each.
SAMPLE = [0, 1, 3, 4, 5, 6, 8, 9, 10, 12, 13, 14, 16, 20, 21, 24, 25, 27, 29, 33, 34, 35, 36, 37, 39, 40, 41, 42, 45, 48, 49,
          50, 51, 53, 54, 55, 56, 57]
# Those by which something was found.
SAMPLE += [1004, 1131, 1190, 1222, 1348, 1352, 1358, 1367]
# With Bouc-Wen elements and nonlinear springs, between coordinates and on joints.
SAMPLE += [35002, 35005, 35013, 35020, 35029, 35035, 35037, 35040]
# With bushings, several locks, starts on locks, rates and gears.
SAMPLE += [40007, 40045, 40056, 40058, 40074, 40083, 40090, 40094, 40102, 45004, 45006, 45009]
FIRST_ORDER = ("galerkin", "backward_difference", "damped_newmark")      # which fast parts lead far from their order
OUTCOMES = ["agrees", "differs", "refused", "failed", "skipped"]


class OutOfTime(Exception):
    pass


def alarm(*_):
    raise OutOfTime


def of_seed(seed):
    """The generator of these seeds."""
    return next((kind.generate for kind in (with_laws, with_mounts) if kind.FIRST <= seed <= kind.LAST), generate)


def run_command(command, path, folder):
    def limit():
        resource.setrlimit(resource.RLIMIT_CPU, (COMMAND_SECONDS, COMMAND_SECONDS + 1))
    return subprocess.run([str(command), "run", str(path), "-o", str(folder), "--jobs", "1"], capture_output=True, text=True,
                          preexec_fn=limit)


def verdicts(command, path, folder):
    """(name, type, outcome, what) of each analysis of a study."""
    done = run_command(command, path, folder)
    text = done.stdout + done.stderr
    study = Study(path)
    if done.returncode < 0 or done.returncode > 3:
        died = done.returncode in (-signal.SIGXCPU, -signal.SIGKILL)
        return [("all", "all", "failed" if died else "differs", f"the command ended with {done.returncode}")]
    if done.returncode == 2:
        return [("all", "all", "refused", " ".join(l for l in text.splitlines() if "error" in l)[-300:])]
    out, of_pairs = [], {}
    for analysis in study.raw["analysis"]:
        name, kind = analysis["name"], analysis["type"]
        told = re.search(rf'analysis "{re.escape(name)}" failed: ([^\n]*)', text)
        table = folder / f"{name}.csv"
        if told and (kind != "modes" or not table.exists() or "more than a few digits" in told.group(1)):
            out.append((name, kind, "failed", told.group(1)[:300] + _answer(study, kind)))
            continue
        if not table.exists():
            out.append((name, kind, "differs", "no table, and no word about it"))
            continue
        signal.signal(signal.SIGPROF, alarm)
        signal.setitimer(signal.ITIMER_PROF, ORACLE_SECONDS)
        try:
            found, errors, _ = judge(study, analysis, folder)
            if name in ("coarse", "half") and f'analysis "{name}": Newton\'s method failed in' in text:
                raise Unreadable("equal steps were divided, which is told: nothing says how fast their errors fall")
            if name in ("coarse", "half"):
                found = convergence(name, errors, of_pairs, analysis["method"] in FIRST_ORDER)
        except Unreadable as why:
            out.append((name, kind, "skipped", str(why)))
            continue
        except OutOfTime:
            out.append((name, kind, "skipped", "out of time"))
            continue
        finally:
            signal.setitimer(signal.ITIMER_PROF, 0)
        if found:
            out.append((name, kind, "differs", "; ".join(str(f) for f in found[:3])))
        else:
            worst = max(errors.items(), key=lambda e: e[1]) if errors else ("", 0.0)
            out.append((name, kind, "agrees", f"{worst[0]} {worst[1]:.2g}"))
    return out


def convergence(name, errors, of_pairs, first_order):
    """Of equal steps: half of the step has at most 0.7 of the error, however large that is, in what is judged strictest; below
    1e-4 steps across the kinks of laws, which nothing locates, err more or less by chance."""
    size = max((e / LOOSER.get(unit_of(column), 1) for column, e in errors.items() if np.isfinite(e)), default=0.0)
    size = np.inf if any(not np.isfinite(e) for e in errors.values()) else size
    of_pairs[name] = size
    before = of_pairs.get("coarse")
    if name == "coarse" or before is None or size <= max(0.7 * before, 1e-4) or first_order and 5e-3 < size <= before:
        return []
    return [f"error {size:.3g} with half of the step, {before:.3g} with the whole"]


def _answer(study, kind):
    """Of a static state that the command does not find: whether the oracle does."""
    if kind != "static":
        return ""
    signal.signal(signal.SIGPROF, alarm)
    signal.setitimer(signal.ITIMER_PROF, ORACLE_SECONDS)
    try:
        equilibrium(March(Mechanism(study)))
        return " (the oracle finds one)"
    except (Unreadable, OutOfTime, np.linalg.LinAlgError):
        return " (nor does the oracle)"
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("command")
    parser.add_argument("first", type=int, nargs="?", default=0)
    parser.add_argument("last", type=int, nargs="?", default=-1)
    parser.add_argument("--sample", type=int, choices=(0, 1), help="half of the seeds of the suite")
    parser.add_argument("--keep", help="a folder for the studies")
    parser.add_argument("--verbose", action="store_true")
    parser.add_argument("--first", dest="until_first", action="store_true", help="end at the first study that differs")
    parser.add_argument("--keys", action="store_true", help="count the outcomes by the keys of the study as well")
    options = parser.parse_args()
    np.seterr(all="ignore")
    counts = collections.defaultdict(collections.Counter)
    by_key = collections.defaultdict(collections.Counter)
    differing = []
    for seed in SAMPLE[options.sample :: 2] if options.sample is not None else range(options.first, options.last + 1):
        if options.until_first and differing:
            break
        began = resource.getrusage(resource.RUSAGE_SELF).ru_utime
        with tempfile.TemporaryDirectory() as scratch:
            folder = pathlib.Path(options.keep or scratch) / str(seed)
            path = of_seed(seed)(seed, folder)
            for name, kind, outcome, what in verdicts(options.command, path, folder / "results"):
                counts[kind][outcome] += 1
                for key in keys_of(path, name) if options.keys else []:
                    by_key[key][outcome] += 1
                if outcome == "differs":
                    differing.append(seed)
                if outcome == "differs" or options.verbose:
                    print(f"seed {seed}: {name} ({kind}): {outcome}: {what}", flush=True)
        if options.verbose:
            print(f"seed {seed}: {resource.getrusage(resource.RUSAGE_SELF).ru_utime - began:.1f} s of the oracle", flush=True)
    print(f"\n{'kind':<32}" + "".join(f"{o:>10}" for o in OUTCOMES))
    for name, outcomes in sorted(counts.items()) + sorted(by_key.items()):
        print(f"{name:<32}" + "".join(f"{outcomes[o]:>10}" for o in OUTCOMES))
    total = sum(sum(c.values()) for c in counts.values())
    skipped = sum(c["skipped"] for c in counts.values())
    print(f"seeds that differ: {sorted(set(differing))}; skipped {skipped} of {total}")
    for name, who in (("oracle", resource.RUSAGE_SELF), ("command", resource.RUSAGE_CHILDREN)):
        print(f"{name}: {resource.getrusage(who).ru_utime:.1f} s of processor time")
    return 1 if differing or skipped > 0.05 * max(total, 20) else 0


if __name__ == "__main__":
    sys.exit(main())
