"""Many random studies: `run.py COMMAND 1-200 studies/x.toml @sample.txt [--keep FOLDER]`; a table of what was found, and exit status 1 if the
command and the oracle differ anywhere."""

import argparse
import collections
import pathlib
import resource
import shutil
import sys
import tempfile
import tomllib

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import compare  # noqa: E402
import generate  # noqa: E402
import generate_laws  # noqa: E402
import generate_more  # noqa: E402


def wanted(words):
    """Seeds and study files. Lines of a list are the same words, after `#` comments."""
    found = []
    for word in words:
        if word.startswith("@"):
            file = pathlib.Path(word[1:])
            lines = [line.split("#")[0].strip() for line in file.read_text().splitlines()]
            found += wanted([str(file.parent / line) if line.endswith(".toml") else line
                             for text in lines for line in text.split()])
        elif word.endswith(".toml"):
            found.append(word)
        else:
            first, _, last = word.partition("-")
            found += range(int(first), int(last or first) + 1)
    return found


def keys_of(path, analysis):
    """`force.amplitude`, ...: the keys of the model and of one analysis."""
    raw = tomllib.loads(pathlib.Path(path).read_text())
    found = set()

    def walk(value, place):
        if isinstance(value, list):
            for item in value:
                walk(item, place)
        elif isinstance(value, dict):
            for key, item in value.items():
                named = place in ("parameters", "base_motion.direction", "matrices.position", "matrices.velocity")
                name = place if named else f"{place}.{key}" if place else key
                found.add(name)
                walk(item, name)
    walk({k: v for k, v in raw.items() if k != "analysis"}, "")
    for part in raw["analysis"]:
        if part["name"] == analysis:
            walk(part, part["type"])
    return found


def laid(path, folder):
    """A copy of a study and of the files beside it that bear its name."""
    path = pathlib.Path(path)
    folder.mkdir(parents=True, exist_ok=True)
    for file in path.parent.glob(path.stem + "*"):
        shutil.copy(file, folder / file.name)
    return folder / path.name


def record(file, study, model, verdict, path):
    """A line of tab-separated values, so that what was found outlives a run that is cut off."""
    cells = [study, model, verdict.analysis, verdict.kind, verdict.outcome, " ".join(verdict.what.split()), f"{verdict.error:.3g}",
             f"{verdict.allowed:.3g}", " ".join(sorted(keys_of(path, verdict.analysis)))]
    with open(file, "a") as out:
        out.write("\t".join(map(str, cells)) + "\n")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("command")
    parser.add_argument("studies", nargs="+", help="seeds, ranges of them (1-200), study files, or a list of these: @FILE")
    parser.add_argument("--keep", help="a folder for the studies and results where the two differ or the command fails")
    parser.add_argument("--verbose", action="store_true")
    parser.add_argument("--first", action="store_true", help="end at the first study that differs")
    parser.add_argument("--keys", action="store_true", help="count the outcomes by the keys of the study as well")
    parser.add_argument("--record", help="a file to which every verdict adds a line")
    parser.add_argument("--seconds", type=float, default=20, help="of processor time for an analysis by the oracle")
    options = parser.parse_args()
    compare.ORACLE_SECONDS = options.seconds
    counts = collections.defaultdict(collections.Counter)
    by_key = collections.defaultdict(collections.Counter)
    differing = []
    for seed in wanted(options.studies):
        if options.first and differing:
            break
        with tempfile.TemporaryDirectory() as scratch:
            name = seed if isinstance(seed, int) else pathlib.Path(seed).stem
            folder = pathlib.Path(options.keep) / str(name) if options.keep else pathlib.Path(scratch)
            if isinstance(seed, int):
                source = next(g for first, g in ((generate_laws.FIRST, generate_laws), (generate_more.FIRST, generate_more), (0, generate))
                              if seed >= first)
                path, kind = source.generate(seed, folder)
            else:
                path, kind = laid(seed, folder), "file"
            told = []
            for verdict in compare.judge(path, options.command, folder / "results" if options.keep else None):
                if kind == "file" and verdict.outcome in ("refused", "failed"):  # studies laid down are answered
                    verdict.outcome = "differs"
                counts[verdict.kind][verdict.outcome] += 1
                for key in keys_of(path, verdict.analysis) if options.keys else []:
                    by_key[key][verdict.outcome] += 1
                if options.record:
                    record(options.record, name, kind, verdict, path)
                if options.verbose:
                    print(f"  {resource.getrusage(resource.RUSAGE_SELF).ru_utime:.1f} {resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime:.1f}")
                if verdict.outcome in ("differs", "failed") or options.verbose:
                    print(f"{name} ({kind}): {verdict}", flush=True)
                told += [verdict] if verdict.outcome in ("differs", "failed") else []
                if verdict.outcome == "differs":
                    differing.append(str(name))
            if options.keep and not told:
                shutil.rmtree(folder)
    print(f"\n{'kind':<40}" + "".join(f"{o:>10}" for o in OUTCOMES))
    for kind in sorted(counts):
        print(f"{kind:<40}" + "".join(f"{counts[kind][o]:>10}" for o in OUTCOMES))
    for key in sorted(by_key):
        print(f"{key:<40}" + "".join(f"{by_key[key][o]:>10}" for o in OUTCOMES))
    print(f"those that differ: {' '.join(dict.fromkeys(differing))}")
    for name, who in (("oracle", resource.RUSAGE_SELF), ("command", resource.RUSAGE_CHILDREN)):
        print(f"{name}: {resource.getrusage(who).ru_utime:.1f} s of processor time")
    return 1 if differing else 0


OUTCOMES = ["agrees", "differs", "refused", "skipped", "failed"]

if __name__ == "__main__":
    sys.exit(main())
