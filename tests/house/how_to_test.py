"""Do what a how-to page says, in a copy of the tree.

Usage: how_to_test.py ROOT PAGE FOLDER [OPTION ...], with options for cmake; or how_to_test.py ROOT PAGE FOLDER --apply.
Blocks of the page in C++ that begin with `// PATH` are written there; blocks of diff are applied, and with --apply that is all.
Else the command is built; the block of TOML is run, and what the line `<!-- check: ... -->` says must hold:

    check: TABLE.csv COLUMN = COLUMN within BOUND       columns by the beginning of their names; of the largest value
    check: TABLE.csv COLUMN = NUMBER within BOUND       in every row
    check: TABLE.csv = TABLE.csv                        to the last digit
"""
import csv
import pathlib
import re
import shutil
import subprocess
import sys

root, page, folder = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
SOURCES = ["CMakeLists.txt", "CMakePresets.json", "cmake", "src", "apps", "examples", "node_modules", "docs"]


def blocks(text, language):
    return re.findall(rf"^```{language}\n(.*?)^```$", text, re.DOTALL | re.MULTILINE)


def apply(diff, tree):
    """Each part of a diff (between @@) stands once in the file, and is replaced."""
    lines = diff.rstrip("\n").split("\n")
    path = tree / re.fullmatch(r"--- a/(\S+)", lines[0]).group(1)
    text = path.read_text()
    for part in "\n".join(lines[1:]).split("\n@@\n"):
        part = part.split("\n")
        before = "\n".join(line[1:] for line in part if line[0] in " -")
        after = "\n".join(line[1:] for line in part if line[0] in " +")
        if text.count(before) != 1:
            sys.exit(f"{page.name}: {text.count(before)} places of {path.relative_to(tree)} read\n{before}")
        text = text.replace(before, after)
    path.write_text(text)


def rows(path):
    with open(path, newline="") as file:
        return list(csv.reader(file))


def column(table, name):
    found = [i for i, title in enumerate(table[0]) if title.startswith(name)]
    if len(found) != 1:
        sys.exit(f"{len(found)} columns begin with {name}: {table[0]}")
    return [float(row[found[0]]) for row in table[1:]]


def check(what, results):
    if tables := re.fullmatch(r"(\S+\.csv) = (\S+\.csv)", what):
        one, other = (rows(results / name) for name in tables.groups())
        if one != other:
            sys.exit(f"{page.name}: {what} does not hold")
        return
    table, first, second, bound = re.fullmatch(r"(\S+\.csv) (\S+) = (\S+) within (\S+)", what).groups()
    read = rows(results / table)
    one = column(read, first)
    other = [float(second)] * len(one) if re.fullmatch(r"-?[\d.]+(e-?\d+)?", second) else column(read, second)
    apart = max(abs(a - b) for a, b in zip(one, other)) / max(map(abs, one))
    print(f"{what}: {apart:.2g}")
    if not apart <= float(bound):
        sys.exit(f"{page.name}: {what} does not hold: {apart}")


text = page.read_text()
shutil.rmtree(folder, ignore_errors=True)
tree = folder / "tree"
tree.mkdir(parents=True)
only_applies = sys.argv[4:] == ["--apply"]
for name in ["src"] if only_applies else SOURCES:
    source = root / name
    if source.is_dir():
        shutil.copytree(source, tree / name, symlinks=False)
    elif source.exists():
        shutil.copy(source, tree / name)
for block in blocks(text, "cpp"):
    if found := re.match(r"// (\S+/\S+)\n", block):
        (tree / found.group(1)).write_text(block[found.end():])
for block in blocks(text, "diff"):
    apply(block, tree)
if only_applies:
    shutil.rmtree(folder)
    sys.exit()
build = tree / "build" / "audit"
subprocess.run(["cmake", "-S", tree, "-B", build, "-G", "Ninja", "-DRUBATO_BUILD_TESTS=OFF", *sys.argv[4:]],
               check=True, stdout=subprocess.DEVNULL)
subprocess.run(["cmake", "--build", build, "--target", "rubato_command"], check=True, stdout=subprocess.DEVNULL)
(study,) = blocks(text, "toml")
(folder / "study.toml").write_text(study)
subprocess.run([build / "apps" / "rubato" / "rubato", "run", folder / "study.toml", "-o", folder / "results", "--quiet"],
               check=True)
checks = re.findall(r"<!-- check: (.*?) -->", text)
if not checks:
    sys.exit(f"{page.name} checks nothing")
for what in checks:
    check(what, folder / "results")
shutil.rmtree(tree)
