"""Fail if a C++ source is not formatted as .clang-format says; with --fix, format it.

Usage: check_format.py ROOT [--fix]. Exit status 77 (skipped) where there is no clang-format 14: other versions break
lines elsewhere.
"""
import pathlib
import shutil
import subprocess
import sys

root = pathlib.Path(sys.argv[1])
program = next(filter(None, map(shutil.which, ("clang-format-14", "clang-format"))), None)
if not program or " 14." not in subprocess.run([program, "--version"], capture_output=True, text=True).stdout:
    print("clang-format 14 is not installed")
    sys.exit(77)
sources = [str(path) for folder in ("apps", "benchmarks", "python", "src", "tests", "examples")
           for path in sorted((root / folder).rglob("*.[hc]pp"))]
if not sources:
    sys.exit(f"no sources under {root}")
arguments = ["-i"] if "--fix" in sys.argv[2:] else ["--dry-run", "-Werror", "--ferror-limit=1"]
result = subprocess.run([program, "--style=file", *arguments, *sources])
print(f"{len(sources)} files")
sys.exit(result.returncode)
