"""Run the commands that README.md and the tutorial show, so that they stay true.

Usage: check_commands.py [--update] ROOT RUBATO [PAGE...]

Numbers that a page shows are compared with the results of its commands where a comment tells of which (shown_numbers.py);
--update writes those of the results into the pages. Events that a page quotes must be printed by its commands.

Each page has a scratch folder of its own with a copy of examples/. Its ```sh blocks are run there in order: lines that
begin with `rubato` run the command RUBATO and must succeed; scripts must exist and be executable, presets must exist.
A block ```toml NAME is written to the file NAME first. Links between pages must lead to a file (pictures too).
"""
import json
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile

import shown_numbers

is_update = sys.argv[1:2] == ["--update"]
words_given = sys.argv[2:] if is_update else sys.argv[1:]
if len(words_given) < 2 or words_given[0].startswith("-"):
    print(__doc__.strip())
    sys.exit(0 if words_given[:1] in (["--help"], ["-h"]) else 2)
root, rubato = (pathlib.Path(word).resolve() for word in words_given[:2])
pages = [root / page for page in words_given[2:]] or [root / "README.md", *sorted((root / "docs" / "tutorial").glob("*.md"))]
presets = {preset["name"] for preset in json.loads((root / "CMakePresets.json").read_text())["configurePresets"]}
faults = []
ran = 0


def fail(page, line, text):
    faults.append(f"{page.relative_to(root)}:{line}: {text}")


def run_line(page, number, line, scratch, printed):
    """One line of a block; what the command prints joins `printed`."""
    global ran
    words = shlex.split(line, comments=True)
    if not words:
        return
    if words[0] == "rubato":
        result = subprocess.run([str(rubato), *words[1:]], cwd=scratch, capture_output=True, text=True, timeout=600)
        ran += 1
        printed += (result.stdout + result.stderr).splitlines()
        if result.returncode != 0:
            fail(page, number, f"`{line}` exits with {result.returncode}: {result.stderr.strip()[-500:]}")
        return
    if words[0].startswith(("scripts/", "tools/")):
        script = root / words[0]
        if not script.is_file() or not script.stat().st_mode & 0o100:
            fail(page, number, f"{words[0]} is no executable file")
        return
    if "--preset" in words and words[words.index("--preset") + 1] not in presets:
        fail(page, number, f"`{line}`: no such preset")


def run_edited(scratch, study, pieces):
    """Runs a study with pieces of its text replaced; where its results lie."""
    source = pathlib.Path(scratch) / study
    text = source.read_text()
    for old, new in zip(pieces[::2], pieces[1::2]):
        if old not in text:
            raise ValueError(f'"{old}" is not in {study}')
        text = text.replace(old, new)
    edited = source.with_name(f"edited-{abs(hash(text))}.toml")
    folder = f"results/{edited.stem}"
    if not edited.exists():
        edited.write_text(text)
        subprocess.run([str(rubato), "run", str(edited), "-q", "-o", folder], cwd=scratch, check=True, capture_output=True,
                       timeout=600)
    return folder


def check_links(page, text):
    # A lambda of C++ in a block of code looks like a link.
    prose = re.sub(r"^```.*?^```", lambda block: "\n" * block[0].count("\n"), text, flags=re.DOTALL | re.MULTILINE)
    for target in re.findall(r"\]\(([^)#]+)[^)]*\)", prose) + re.findall(r'src="([^"]+)"', prose):
        if "://" not in target and not (page.parent / target).exists():
            fail(page, prose[: prose.index(target)].count("\n") + 1, f"{target} does not exist")


for page in pages:
    text = page.read_text()
    printed = []
    with tempfile.TemporaryDirectory() as scratch:
        shutil.copytree(root / "examples", pathlib.Path(scratch) / "examples", ignore=shutil.ignore_patterns("results"))
        for block in re.finditer(r"^```(\w+)(?: (\S+))?\n(.*?)^```$", text, re.M | re.S):
            language, name, body = block.groups()
            first = text[: block.start(3)].count("\n") + 1
            if language == "toml" and name:
                (pathlib.Path(scratch) / name).write_text(body)
            if language == "sh":
                for number, line in enumerate(body.splitlines(), first):
                    run_line(page, number, line, scratch, printed)
        results = shown_numbers.Results(pathlib.Path(scratch), lambda study, pieces: run_edited(scratch, study, pieces))
        shown_numbers.check_events(text, printed, lambda line, told: fail(page, line, told))
        updated = shown_numbers.check(text, results, lambda line, told: fail(page, line, told), is_update)
        if updated != text:
            page.write_text(updated)
            print(f"{page.relative_to(root)} is updated")

for page in [*root.glob("*.md"), *sorted((root / "docs").rglob("*.md"))]:
    check_links(page, page.read_text())

print("\n".join(faults) or f"{len(pages)} pages, {ran} commands run")
sys.exit(bool(faults))
