"""Random mechanisms held against the oracle: `mechanism_run.py COMMAND FIRST LAST [--keep FOLDER] [--verbose]`.

`--sample` runs the seeds of the suite instead: the first sixty, and what ever failed. Exit status 1 where the command and the
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

from generate_mechanism import generate  # noqa: E402
from mechanism import Mechanism  # noqa: E402
from mechanism_judge import judge  # noqa: E402
from mechanism_march import March  # noqa: E402
from mechanism_rest import equilibrium  # noqa: E402
from study import Study, Unreadable  # noqa: E402

ORACLE_SECONDS = 20
COMMAND_SECONDS = 20
SAMPLE = list(range(60))
OUTCOMES = ["agrees", "differs", "refused", "failed", "skipped"]


class OutOfTime(Exception):
    pass


def alarm(*_):
    raise OutOfTime


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
    out = []
    for analysis in study.raw["analysis"]:
        name, kind = analysis["name"], analysis["type"]
        told = re.search(rf'analysis "{re.escape(name)}" failed: ([^\n]*)', text)
        table = folder / f"{name}.csv"
        if told and (kind != "modes" or not table.exists()):
            out.append((name, kind, "failed", told.group(1)[:300] + _answer(study, kind)))
            continue
        if not table.exists():
            out.append((name, kind, "differs", "no table, and no word about it"))
            continue
        signal.signal(signal.SIGPROF, alarm)
        signal.setitimer(signal.ITIMER_PROF, ORACLE_SECONDS)
        try:
            found, errors, _ = judge(study, analysis, folder)
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
    parser.add_argument("--sample", action="store_true", help="the seeds of the suite")
    parser.add_argument("--keep", help="a folder for the studies")
    parser.add_argument("--verbose", action="store_true")
    options = parser.parse_args()
    np.seterr(all="ignore")
    counts = collections.defaultdict(collections.Counter)
    differing = []
    for seed in SAMPLE if options.sample else range(options.first, options.last + 1):
        with tempfile.TemporaryDirectory() as scratch:
            folder = pathlib.Path(options.keep or scratch) / str(seed)
            path = generate(seed, folder)
            for name, kind, outcome, what in verdicts(options.command, path, folder / "results"):
                counts[kind][outcome] += 1
                if outcome == "differs":
                    differing.append(seed)
                if outcome == "differs" or options.verbose:
                    print(f"seed {seed}: {name} ({kind}): {outcome}: {what}", flush=True)
    print(f"\n{'kind':<12}" + "".join(f"{o:>10}" for o in OUTCOMES))
    for kind in sorted(counts):
        print(f"{kind:<12}" + "".join(f"{counts[kind][o]:>10}" for o in OUTCOMES))
    total = sum(sum(c.values()) for c in counts.values())
    skipped = sum(c["skipped"] for c in counts.values())
    print(f"seeds that differ: {sorted(set(differing))}; skipped {skipped} of {total}")
    for name, who in (("oracle", resource.RUSAGE_SELF), ("command", resource.RUSAGE_CHILDREN)):
        print(f"{name}: {resource.getrusage(who).ru_utime:.1f} s of processor time")
    return 1 if differing or skipped > 0.05 * max(total, 20) else 0


if __name__ == "__main__":
    sys.exit(main())
