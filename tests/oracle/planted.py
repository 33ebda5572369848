"""Whether the oracle finds faults planted in the sources of a scratch clone of the repository. Every fault of `planted_faults.toml` is written into the sources at once, behind a switch
that the environment sets, so that one build serves all: `prepare` writes them (build the clone then), `judge` runs the
studies once for each fault until one differs, and prints the fault with the study that found it.

    planted.py prepare CLONE
    cmake --build CLONE/build/audit --target rubato_command
    planted.py judge CLONE/build/audit/apps/rubato/rubato @sample.txt 1-60

`planted.py --mechanisms prepare CLONE` and `planted.py --mechanisms judge COMMAND 0 60` take the faults of
`planted_faults_mechanisms.toml` and the studies of `mechanism_run.py`.
"""

import os
import pathlib
import subprocess
import sys
import tomllib

HERE = pathlib.Path(__file__).resolve().parent
SWITCH = """#include <cstdlib>
namespace {
[[maybe_unused]] bool is_planted(int fault) {
  static const char* const chosen = std::getenv("RUBATO_PLANTED_FAULT");
  return chosen != nullptr && std::atoi(chosen) == fault;
}
}  // namespace
"""


FILE, RUN = "planted_faults.toml", ["run.py", "--seconds", "5"]


def faults():
    return tomllib.loads((HERE / FILE).read_text())["fault"]


def prepare(clone):
    sources = pathlib.Path(clone) / "src/rubato"
    for number, fault in enumerate(faults(), 1):
        path = sources / fault["file"]
        text = path.read_text()
        if text.count(fault["at"]) != 1:
            raise SystemExit(f"{fault['file']}: {fault['at']!r} stands there {text.count(fault['at'])} times")
        right, wrong = fault["right"], fault["wrong"]
        if "text" in fault:  # a factor of a product
            end = right.split("*")[-1].strip()
            switched = f"(is_planted({number}) ? {wrong[:-len(end)].rstrip(' *')} : {right[:-len(end)].rstrip(' *')}) * {end}"
        elif "type" in fault:
            switched = f"(is_planted({number}) ? {fault['type']}({wrong}) : {fault['type']}({right}))"
        else:
            switched = f"(is_planted({number}) ? ({wrong}) : ({right}))"
        at = fault["at"].replace(right, switched, 1)
        text = text.replace(fault["at"], at)
        path.write_text(text if SWITCH in text else SWITCH + text)


def judge(command, words):
    found = 0
    for number, fault in enumerate(faults(), 1):
        environment = {**os.environ, "RUBATO_PLANTED_FAULT": str(number)}
        run = subprocess.run([sys.executable, str(HERE / RUN[0]), command, *words, "--first", *RUN[1:]],
                             env=environment, capture_output=True, text=True)
        told = [line for line in run.stdout.splitlines() if "differs" in line and ":" in line]
        found += run.returncode == 1
        print(f"{number:2} {'found' if run.returncode == 1 else 'MISSED':<7}{fault['name']}: "
              f"{told[0][:110] if told else run.stderr[-200:]}", flush=True)
    print(f"{found} of {len(faults())} found")
    return 0 if found >= 0.9 * len(faults()) else 1


if __name__ == "__main__":
    if sys.argv[1] == "--mechanisms":
        sys.argv.pop(1)
        FILE, RUN = "planted_faults_mechanisms.toml", ["mechanism_run.py"]
    if sys.argv[1] == "prepare":
        prepare(sys.argv[2])
    else:
        sys.exit(judge(sys.argv[2], sys.argv[3:]))
