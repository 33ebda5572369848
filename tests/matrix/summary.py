"""Counts what the matrix found, by kind of model and by method, as a page.

Usage: summary.py TABLE... > found.md      (tables of run.py --table)
"""
import collections
import re
import sys

VERDICTS = ("right", "refused", "ended", "wrong")


def name_parts(name):
    """The model and the method of a combination's name, `MODEL METHOD STEPPING OUTPUT`."""
    model, rest = name.split(" ", 1)
    return model, re.match(r'("[^"]*"|\{[^}]*\})', rest).group(1).strip('"')


def table(title, counts):
    lines = [f"| {title} | {' | '.join(VERDICTS)} |", "|---|" + "---:|" * len(VERDICTS)]
    lines += [f"| {key} | {' | '.join(str(row[verdict]) for verdict in VERDICTS)} |" for key, row in counts.items()]
    total = sum(counts.values(), collections.Counter())
    return lines + [f"| all | {' | '.join(str(total[verdict]) for verdict in VERDICTS)} |"]


def main():
    by_model, by_method = collections.defaultdict(collections.Counter), collections.defaultdict(collections.Counter)
    for path in sys.argv[1:]:
        with open(path) as file:
            for line in file:
                verdict, name, _ = line.split("\t", 2)
                model, method = name_parts(name)
                by_model[model][verdict] += 1
                by_method[method][verdict] += 1
    print("\n".join(table("model", dict(sorted(by_model.items()))) + [""] + table("method", dict(sorted(by_method.items())))))


if __name__ == "__main__":
    main()
