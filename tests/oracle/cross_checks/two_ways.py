"""Models written in two ways that mean the same: runs of the command, and what their tables may differ by.

Every analysis that answers both ways gives the same tables, to what its method says.
"""

import argparse
import collections
import pathlib
import re
import resource
import shutil
import signal
import subprocess
import tempfile

import numpy as np

from cross_checks.same_tables import differences
from random_structure.toml import write_toml
from study import Study

SECONDS = 6  # of processor time for a run of the command
OUTCOMES = ["agrees", "differs", "refused", "failed", "skipped"]


def run(command, tables, folder, name):
    """(exit status, what it told); results lie in `folder/name`."""
    tables = {k: v for k, v in tables.items() if k != "inside"}
    title = f"title = \"{tables.pop('title')}\"\n" if "title" in tables else ""
    parameters = {"parameters": tables.pop("parameters")} if "parameters" in tables else {}
    shutil.rmtree(folder / name, ignore_errors=True)
    (folder / f"{name}.toml").write_text(title + write_toml({**parameters, **tables}))

    def limit():
        resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS + 1))
    done = subprocess.run([str(command), "run", str(folder / f"{name}.toml"), "-o", str(folder / name), "--jobs", "1", "--yes", "--quiet"],
                          capture_output=True, text=True, preexec_fn=limit)
    return done.returncode, done.stderr


def answered(command, tables, folder, name):
    """As `run`, without the analyses that are refused."""
    tables = dict(tables)
    while True:
        code, told = run(command, tables, folder, name)
        line = re.search(r"toml:(\d+):", told) if code == 2 else None
        kept = [a for a in tables["analysis"] if a["name"] != _analysis_at(folder / f"{name}.toml", int(line.group(1)))] if line else []
        if len(kept) in (0, len(tables["analysis"])):
            return tables, code, told
        tables["analysis"] = kept


def _analysis_at(path, line):
    named = [text[8:-1] for text in "\n".join(path.read_text().splitlines()[:line + 1]).partition("[[analysis]]")[2].splitlines()
             if text.startswith("name = ")]
    return named[-1] if named else None


def is_mechanism(tables):
    return any(key in tables for key in ("body", "joint")) or any("formulation" in b and "exact" in b["formulation"] for b in tables.get("beam", []))


def allowed_of(tables, part):
    """What two ways to the same equations may differ by, of the largest of a quantity."""
    contacts = "slider" in tables or "stop" in tables or any({"friction", "lock"} & set(j) for j in tables.get("joint", []))
    if part["type"] == "transient" and isinstance(part["step"], dict):
        tolerance = 1e-2 if "cardona_cassano" in part["step"].values() else part["step"]["tolerance"]
        return float(tolerance) * (300 if contacts else 100 if is_mechanism(tables) else 20)
    if part["type"] == "frequency_response":
        return 1e-2 if contacts or part.get("solver") == "time_marching" else 1e-7
    if part["type"] == "transient" and is_mechanism(tables):
        return 1e-5  # what Newton's method leaves, whose last correction is spared in smooth mechanisms without laws
    if part.get("method") == "exponential":
        return 1e-3  # exact in what is linear, of second order in laws
    return 1e-7 if contacts or is_mechanism(tables) else 1e-9


def judged(command, tables, ways, folder, apart=(), first="parts"):
    """(way, analysis, kind, outcome, what) of tables against what each of `ways` makes of them; None where that is nothing.

    @param apart  words of columns that the ways tell otherwise
    @param first  where the results of the tables as they are lie in the folder
    """
    plain, code, told = answered(command, tables, folder, first)
    if code in (-signal.SIGXCPU, -signal.SIGKILL):
        return [("all", "all", "all", "skipped", f"more than {SECONDS} s")]
    out = []
    if code == 2:
        return [("all", "all", "all", "refused", told.strip()[-300:])]
    study = Study(folder / f"{first}.toml")
    stiffness = max((study.number(s["stiffness"]) for s in tables.get("slider", [])), default=0.0)
    for way, rewrite in ways.items():
        other = rewrite(plain)
        if other is None:
            continue
        code, said = run(command, other, folder, way.replace(" ", "_"))
        if code in (-signal.SIGXCPU, -signal.SIGKILL):
            out.append((way, "all", "all", "skipped", f"more than {SECONDS} s"))
            continue
        if code == 2 and "moves as its [[displacement]] says" in said:
            out.append((way, "all", "all", "refused", said.strip()[-300:]))
            continue
        if code not in (0, 3):
            out.append((way, "all", "all", "differs", f"exit status {code}: {said.strip()[-300:]}"))
            continue
        for part in other["analysis"]:
            name, kind = part["name"], part["type"]
            failures = [re.search(rf'analysis "{re.escape(name)}" failed: ([^\n]*)', text) for text in (told, said)]
            if any(failures):
                same = all(failures)
                out.append((way, name, kind, "failed" if same else "differs", " | ".join(f.group(1)[:200] if f else "answers" for f in failures)))
                continue
            found = differences(folder / first, folder / way.replace(" ", "_"), name, kind, allowed_of(tables, part), stiffness,
                                ("not_converged", "quasi_periodic", "subharmonic") if part.get("solver") == "time_marching" else ())
            found = [f for f in found if not any(word in f[0] for word in apart)]
            rows = next((f for f in found if " rows and " in f[0] or f[0].endswith("time [s]") and f[1] > f[2]), None)
            if rows and kind == "transient" and "joint" in tables and not isinstance(part["step"], dict):
                out.append((way, name, kind, "skipped", f"equal steps are divided otherwise: {rows[0]}"))
                continue
            worst = max(found, key=lambda f: f[1] / max(f[2], 1e-300), default=("no table", 0.0, 1.0))
            bad = [f for f in found if not f[1] <= f[2]]
            what = f"{len(bad)} of {len(found)}: " if bad else ""
            out.append((way, name, kind, "differs" if bad else "agrees", f"{what}{worst[0]} {worst[1]:.2g} of {worst[2]:.2g}"))
    return out


def _seconds():
    return sum(resource.getrusage(who).ru_utime for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))


def wanted(words):
    """Lines of a list, `@FILE`, are the same words, after `#` comments."""
    for word in words:
        yield from wanted([w for line in pathlib.Path(word[1:]).read_text().splitlines() for w in line.split("#")[0].split()]) \
            if word.startswith("@") else [word]


def main(models):
    """`models`: by the letter before a seed a function (seed, folder) -> [(tables, ways, apart)]."""
    parser = argparse.ArgumentParser()
    parser.add_argument("command", type=pathlib.Path)
    parser.add_argument("seeds", nargs="+")
    parser.add_argument("--keep", help="a folder for the studies")
    parser.add_argument("--verbose", action="store_true")
    options = parser.parse_args()
    np.seterr(all="ignore")
    counts, differing = collections.defaultdict(collections.Counter), []
    for word in wanted(options.seeds):
        letter, first, last = re.fullmatch(r"([a-z]?)(\d+)(?:-[a-z]?(\d+))?", word).groups()
        for seed in range(int(first), int(last or first) + 1):
            began = _seconds()
            with tempfile.TemporaryDirectory() as scratch:
                folder = pathlib.Path(options.keep or scratch) / f"{letter}{seed}"
                folder.mkdir(parents=True)
                found = [f for k, (tables, ways, apart) in enumerate(models[letter](seed, folder))
                         for f in judged(options.command.resolve(), tables, ways, folder, apart, f"parts {k}")]
            for way, name, kind, outcome, what in found:
                counts[f"{way}, {kind}"][outcome] += 1
                if outcome == "differs":
                    differing.append(f"{letter}{seed}")
                if outcome == "differs" or options.verbose:
                    print(f"seed {letter}{seed} {way}: {name} ({kind}): {outcome}: {what}", flush=True)
            if options.verbose:
                print(f"seed {letter}{seed} took {_seconds() - began:.2f} s of processor time", flush=True)
    print(f"\n{'way and kind':<34}" + "".join(f"{o:>10}" for o in OUTCOMES))
    for kind in sorted(counts):
        print(f"{kind:<34}" + "".join(f"{counts[kind][o]:>10}" for o in OUTCOMES))
    print(f"seeds that differ: {' '.join(dict.fromkeys(differing))}")
    return 1 if differing else 0
