"""Many random studies: `run.py COMMAND FIRST LAST [--keep FOLDER]`; a table of what was found, and exit status 1 if the
command and the oracle differ anywhere."""

import argparse
import collections
import pathlib
import resource
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

from compare import judge  # noqa: E402
from generate import generate  # noqa: E402


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("command")
    parser.add_argument("first", type=int)
    parser.add_argument("last", type=int)
    parser.add_argument("--keep", help="a folder for the studies on which the two differ")
    parser.add_argument("--verbose", action="store_true")
    options = parser.parse_args()
    counts = collections.defaultdict(collections.Counter)
    differing = []
    for seed in range(options.first, options.last + 1):
        with tempfile.TemporaryDirectory() as scratch:
            folder = pathlib.Path(options.keep) / str(seed) if options.keep else pathlib.Path(scratch)
            path, kind = generate(seed, folder)
            for verdict in judge(path, options.command, folder / "results" if options.keep else None):
                counts[verdict.kind][verdict.outcome] += 1
                if options.verbose:
                    print(f"  {resource.getrusage(resource.RUSAGE_SELF).ru_utime:.1f} {resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime:.1f}")
                if verdict.outcome in ("differs", "failed") or options.verbose:
                    print(f"seed {seed} ({kind}): {verdict}", flush=True)
                if verdict.outcome == "differs":
                    differing.append(seed)
    print(f"\n{'kind':<40}" + "".join(f"{o:>10}" for o in OUTCOMES))
    for kind in sorted(counts):
        print(f"{kind:<40}" + "".join(f"{counts[kind][o]:>10}" for o in OUTCOMES))
    print(f"seeds that differ: {sorted(set(differing))}")
    for name, who in (("oracle", resource.RUSAGE_SELF), ("command", resource.RUSAGE_CHILDREN)):
        print(f"{name}: {resource.getrusage(who).ru_utime:.1f} s of processor time")
    return 1 if differing else 0


OUTCOMES = ["agrees", "differs", "refused", "skipped", "failed"]

if __name__ == "__main__":
    sys.exit(main())
