"""Run the commands that README.md and the tutorial show, so that they stay true.

Usage: check_commands.py ROOT RUBATO [PAGE...]

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

root, rubato = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
pages = [root / page for page in sys.argv[3:]] or [root / "README.md", *sorted((root / "docs" / "tutorial").glob("*.md"))]
presets = {preset["name"] for preset in json.loads((root / "CMakePresets.json").read_text())["configurePresets"]}
faults = []
ran = 0


def fail(page, line, text):
    faults.append(f"{page.relative_to(root)}:{line}: {text}")


def run_line(page, number, line, scratch):
    """One line of a block."""
    global ran
    words = shlex.split(line, comments=True)
    if not words:
        return
    if words[0] == "rubato":
        result = subprocess.run([str(rubato), *words[1:]], cwd=scratch, capture_output=True, text=True, timeout=600)
        ran += 1
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


def check_links(page, text):
    for target in re.findall(r"\]\(([^)#]+)[^)]*\)", text) + re.findall(r'src="([^"]+)"', text):
        if "://" not in target and not (page.parent / target).exists():
            fail(page, text[: text.index(target)].count("\n") + 1, f"{target} does not exist")


for page in pages:
    text = page.read_text()
    with tempfile.TemporaryDirectory() as scratch:
        shutil.copytree(root / "examples", pathlib.Path(scratch) / "examples", ignore=shutil.ignore_patterns("results"))
        for block in re.finditer(r"^```(\w+)(?: (\S+))?\n(.*?)^```$", text, re.M | re.S):
            language, name, body = block.groups()
            first = text[: block.start(3)].count("\n") + 1
            if language == "toml" and name:
                (pathlib.Path(scratch) / name).write_text(body)
            if language == "sh":
                for number, line in enumerate(body.splitlines(), first):
                    run_line(page, number, line, scratch)

for page in [*root.glob("*.md"), *sorted((root / "docs").rglob("*.md"))]:
    check_links(page, page.read_text())

print("\n".join(faults) or f"{len(pages)} pages, {ran} commands run")
sys.exit(bool(faults))
