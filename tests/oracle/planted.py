"""Whether oracle and matrix find faults planted in the sources of a scratch clone of the repository, and mends undone there.

Every fault of `planted_faults.toml` and `planted_faults_mechanisms.toml` and every mend of `undone_mends.toml` is written into the sources at once, behind a
switch that the environment sets, so that one build serves all: `prepare` writes them (build the clone then). `judge` runs
the studies once for each fault until one differs, and prints the fault with the study that found it. `undone` does so
for the mends; those that no study of a structure finds it gives to the fixed combinations of the matrix, and to the
sample of mechanisms. `mechanisms` runs `mechanism_run.py`. NUMBERS (3,8,12) choose a few.

    planted.py prepare CLONE
    cmake --build CLONE/build/audit --target rubato_command
    planted.py judge CLONE/build/audit/apps/rubato/rubato @sample.txt @sample_of_seeds.txt [--only NUMBERS]
    planted.py undone CLONE/build/audit/apps/rubato/rubato @sample.txt @sample_of_seeds.txt [--only NUMBERS]
    planted.py mechanisms CLONE/build/audit/apps/rubato/rubato 0 60 [--only NUMBERS]
"""

import argparse
import os
import pathlib
import subprocess
import sys
import tomllib

HERE = pathlib.Path(__file__).resolve().parent
LISTS = {"judge": ("planted_faults.toml", 0), "undone": ("undone_mends.toml", 100),
         "mechanisms": ("planted_faults_mechanisms.toml", 200)}  # and what their switches begin at
SWITCH = """#include <cstdlib>
{includes}namespace {{
[[maybe_unused]] bool is_planted(int fault) {{
  static const char* const chosen = std::getenv("RUBATO_PLANTED_FAULT");
  return chosen != nullptr && std::atoi(chosen) == fault;
}}
}}  // namespace
"""


def faults(kind):
    file, first = LISTS[kind]
    return list(enumerate(tomllib.loads((HERE / file).read_text())["fault"], first + 1))


def switched(number, place):
    """What stands at the place, behind the switch of the fault."""
    if "before" in place:
        return f"if (is_planted({number})) {place['before']}\n{place['at']}"
    right, wrong = place["right"], place["wrong"]
    if "text" in place:  # a factor of a product
        end = right.split("*")[-1].strip()
        both = f"(is_planted({number}) ? {wrong[:-len(end)].rstrip(' *')} : {right[:-len(end)].rstrip(' *')}) * {end}"
    elif "type" in place:
        both = f"(is_planted({number}) ? {place['type']}({wrong}) : {place['type']}({right}))"
    else:
        both = f"(is_planted({number}) ? ({wrong}) : ({right}))"
    return place["at"].replace(right, both, 1)


def prepare(clone):
    sources = pathlib.Path(clone) / "src/rubato"
    texts, includes = {}, {}
    for kind in LISTS:
        for number, fault in faults(kind):
            for place in fault.get("place", [fault]):
                file = place["file"]
                text = texts.setdefault(file, (sources / file).read_text())
                if text.count(place["at"]) != 1:
                    raise SystemExit(f"{file}: {place['at']!r} stands there {text.count(place['at'])} times")
                texts[file] = text.replace(place["at"], switched(number, place))
                if "include" in place:
                    includes[file] = f"#include <{place['include']}>\n"
    for file, text in texts.items():
        (sources / file).write_text(SWITCH.format(includes=includes.get(file, "")) + text)


def found_by(command, number, words):
    """The line that tells of the difference, or none."""
    environment = {**os.environ, "RUBATO_PLANTED_FAULT": str(number)}

    def lines(script, *arguments):
        done = subprocess.run([sys.executable, str(HERE / script), *arguments], env=environment, capture_output=True, text=True)
        told = [line for line in done.stdout.splitlines() if ("differs" in line and ":" in line) or line.startswith("WRONG")]
        return (told or [done.stderr[-200:] or "?"]) if done.returncode == 1 else []
    if number > 200:
        told = lines("mechanism_run.py", command, *words, "--first")
        return told[0] if told else None
    told = lines("run.py", command, *words, "--first", "--seconds", "5")
    if not told and number > 100:
        told = lines("../matrix/run.py", command, "--sample", "1") or lines("mechanism_run.py", command, "--sample", "0")
    return told[0] if told else None


def judge(kind, command, words, only):
    found = count = 0
    for number, fault in faults(kind):
        if only and number not in only:
            continue
        told = found_by(command, number, words)
        found, count = found + (told is not None), count + 1
        print(f"{number:3} {'found' if told else 'MISSED':<7}{fault['name']}: {(told or '')[:140]}", flush=True)
    print(f"{found} of {count} found")
    return 0 if found >= (1.0 if kind == "undone" else 0.9) * count else 1


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("task", choices=["prepare", *LISTS])
    parser.add_argument("place", help="the clone, or the command")
    parser.add_argument("words", nargs="*", help="studies and seeds, as run.py takes them")
    parser.add_argument("--only", default="", help="numbers of faults")
    options = parser.parse_args()
    if options.task == "prepare":
        return prepare(options.place)
    only = {int(number) for number in options.only.split(",") if number}
    return judge(options.task, options.place, options.words, only)


if __name__ == "__main__":
    sys.exit(main())
