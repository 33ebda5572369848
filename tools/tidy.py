"""Run clang-tidy, as .clang-tidy says, over the sources that a build compiles.

Usage: tidy.py BUILD [--jobs N] [--changed [COMMIT]] [PATH ...]

BUILD is a build folder with compile_commands.json. PATHs are files and folders; without one, all sources of src and
apps are checked. With --changed, only those that differ from COMMIT (else from main); a changed header is checked
through the source of its name or, without one, through the first source that includes it. Says after each file how
many there are, how long it took, and what was found. Exit status 77 (skipped) where there is no clang-tidy 14: other
versions find other things.
"""
import argparse
import concurrent.futures
import json
import pathlib
import re
import resource
import shutil
import subprocess
import sys
import time

root = pathlib.Path(__file__).resolve().parent.parent
options = argparse.ArgumentParser(usage=__doc__.split("\n")[2][len("Usage: "):])
options.add_argument("build", type=pathlib.Path)
options.add_argument("--jobs", type=int, default=1)
options.add_argument("--changed", nargs="?", const="main", metavar="COMMIT")
options.add_argument("paths", nargs="*", type=pathlib.Path)
options = options.parse_intermixed_args()

program = next(filter(None, map(shutil.which, ("clang-tidy-14", "clang-tidy"))), None)
if not program or " 14." not in subprocess.run([program, "--version"], capture_output=True, text=True).stdout:
    print("clang-tidy 14 is not installed (scripts/install-dependencies.sh --tidy)")
    sys.exit(77)


def sources_that_show(headers, sources):
    """One source for each header: that of its name, else the first that includes it."""
    shown = set()
    for header in headers:
        own = header.with_suffix(".cpp")
        names = re.compile(rf'#include ".*\b{re.escape(header.name)}"')
        shown.add(own if own in sources else next((s for s in sources if names.search(s.read_text())), None))
    return shown


compiled = {pathlib.Path(entry["file"]).resolve() for entry in
            json.loads((options.build / "compile_commands.json").read_text())}
chosen = [path.resolve() for path in options.paths] or [root / "src", root / "apps"]
sources = sorted(path for path in compiled if any(path.is_relative_to(folder) for folder in chosen))
if options.changed:
    differ = subprocess.run(["git", "-C", root, "diff", "--name-only", "--diff-filter=d", options.changed], check=True,
                            capture_output=True, text=True).stdout.split()
    differ = {root / name for name in differ}
    differ |= sources_that_show({path for path in differ if path.suffix == ".hpp"}, sources)
    sources = [path for path in sources if path in differ]


def check(path):
    start = time.monotonic()
    found = subprocess.run([program, "--quiet", "-p", options.build, path], capture_output=True, text=True)
    return path, found.returncode, found.stdout if found.stdout else found.stderr, time.monotonic() - start


start = time.monotonic()
faulty = 0
with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
    for number, (path, status, output, seconds) in enumerate(pool.map(check, sources), 1):
        print(f"[{number}/{len(sources)}] {path.relative_to(root)} {seconds:.0f} s", flush=True)
        if status:
            faulty += 1
            print(output, flush=True)
used = resource.getrusage(resource.RUSAGE_CHILDREN)
print(f"{len(sources)} sources in {(time.monotonic() - start) / 60:.1f} min, {(used.ru_utime + used.ru_stime) / 60:.1f} min "
      f"of a processor; {faulty} with findings")
sys.exit(faulty > 0)
