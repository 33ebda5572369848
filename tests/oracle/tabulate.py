"""Tables in Markdown of what runs with `--record FILE` found: `tabulate.py FILE...`; what stands later on a study replaces what stood
before."""

import collections
import pathlib
import sys

OUTCOMES = ["agrees", "differs", "refused", "skipped", "failed"]


def main(files):
    of_study = {}
    for file in files:
        studies = collections.defaultdict(list)
        for line in pathlib.Path(file).read_text().splitlines():
            cells = line.split("\t")
            studies[cells[0]].append(cells)
        of_study.update(studies)
    kinds, keys = collections.defaultdict(collections.Counter), collections.defaultdict(collections.Counter)
    for cells in (cells for study in of_study.values() for cells in study):
        kinds[cells[3]][cells[4]] += 1
        kinds["all kinds"][cells[4]] += 1
        for key in cells[8].split():
            keys[key][cells[4]] += 1
    print(f"{len(of_study)} studies.")
    for name, table in (("kind of analysis", kinds), ("key", keys)):
        print(f"\n| {name} | {' | '.join(OUTCOMES)} |\n|---|{'---:|' * len(OUTCOMES)}")
        for row in sorted(table):
            print(f"| `{row}` | {' | '.join(str(table[row][o]) for o in OUTCOMES)} |")


if __name__ == "__main__":
    main(sys.argv[1:])
