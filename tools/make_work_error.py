"""Runs the benchmark `work_error` and writes what it finds into docs/theory/automatic-steps.md: the tables between its
markers, and the pictures docs/pictures/work-error.svg and tolerance.svg.

    cmake --preset bench && cmake --build --preset bench --target work_error
    python3 tools/make_work_error.py [CSV]      # CSV: measured before; kept as build/bench/work_error.csv
"""
import csv
import io
import math
import pathlib
import subprocess
import sys

from svg_chart import Panel, write

root = pathlib.Path(__file__).resolve().parent.parent
page = root / "docs" / "theory" / "automatic-steps.md"
pictures = root / "docs" / "pictures"
ROUTES = {"fixed": "fixed", "cardona_cassano": "paper", "pi": "pi, local_error"}
KINDS = ["smooth", "friction", "rare event"]


def measured(arguments):
    if arguments:
        return pathlib.Path(arguments[0]).read_text()
    folder = root / "build" / "bench"
    text = subprocess.run([folder / "benchmarks" / "work_error", root / "examples"], check=True, capture_output=True,
                          text=True).stdout
    (folder / "work_error.csv").write_text(text)
    return text


def read(text):
    """{problem: (kind, is_linear, {route: [row, ...]})}, numbers as floats, work in solves."""
    problems = {}
    for row in csv.DictReader(io.StringIO(text)):
        kind, linear, routes = problems.setdefault(row["problem"], (int(row["kind"]), row["linear"] == "1", {}))
        numbers = {key: float(value) for key, value in row.items() if key not in ("problem", "route")}
        numbers["work"] = numbers["solves"] + numbers["factorisation_cost"] * numbers["factorisations"]
        routes.setdefault(row["route"], []).append(numbers)
    return problems


def for_good(rows, key):
    """(error, cost) with the error below that of every cheaper run left out: what a user pays to be sure of it."""
    points = sorted((row[key], row["error"]) for row in rows)
    worst, out = 0.0, []
    for cost, error in reversed(points):
        worst = max(worst, error)
        out.append((worst, cost))
    return out  # rising errors, falling costs


def cost_at(points, error):
    """Interpolated in logarithms; none beyond what was run."""
    below = [p for p in points if p[0] <= error]
    above = [p for p in points if p[0] > error]
    if not below or not above:
        return None
    (e0, c0), (e1, c1) = below[-1], above[0]
    share = (math.log(error) - math.log(e0)) / (math.log(e1) - math.log(e0))
    return math.exp(math.log(c0) + share * (math.log(c1) - math.log(c0)))


def shown(value, form="{:.2f}"):
    return "-" if value is None else form.format(value)


def comparison(problems):
    lines = ["| | error | fixed: steps | solves and factorisations, fixed / paper / pi | fixed over pi, work | CPU |",
             "|---|---:|---:|---:|---:|---:|"]
    for name, (_, _, routes) in problems.items():
        for error in (1e-2, 1e-3, 1e-4):
            work = [cost_at(for_good(routes[route], "work"), error) for route in ROUTES]
            cpu = [cost_at(for_good(routes[route], "cpu"), error) for route in ROUTES]
            steps = cost_at(for_good(routes["fixed"], "steps"), error)
            if work[0] is None and work[2] is None:
                continue
            ratio = work[0] / work[2] if work[0] and work[2] else None
            timed = cpu[0] / cpu[2] if cpu[0] and cpu[2] else None
            lines.append(f"| {name} | {error:g} | {shown(steps, '{:.0f}')} | "
                         + " / ".join(shown(w, "{:.0f}") for w in work) + f" | {shown(ratio)} | {shown(timed)} |")
    return lines


def slope(points):
    logs = [(math.log10(x), math.log10(y)) for x, y in points]
    mx, my = (sum(values) / len(logs) for values in zip(*logs))
    return sum((x - mx) * (y - my) for x, y in logs) / sum((x - mx) ** 2 for x, _ in logs)


def tolerances(problems):
    lines = ["| | slope | error over tolerance | steps at 1e-3 | rejected |", "|---|---:|---:|---:|---:|"]
    for name, (_, linear, routes) in problems.items():
        if not linear:
            continue
        rows = routes["pi"]
        ratios = [row["error"] / row["number"] for row in rows]
        at = min(rows, key=lambda row: abs(math.log(row["number"] / 1e-3)))
        lines.append(f"| {name} | {slope([(row['number'], row['error']) for row in rows]):.3f} | {min(ratios):.2f} to "
                     f"{max(ratios):.2f} | {at['steps']:.0f} | {at['rejected']:.0f} |")
    return lines


def draw(problems):
    panels = []
    for name, (kind, _, routes) in problems.items():
        panel = Panel(f"{name} ({KINDS[kind]})", "largest error", "solves and factorisations", log_x=True, log_y=True)
        for route, label in ROUTES.items():
            panel.line(label, [(row["error"], row["work"]) for row in routes[route] if 3e-6 < row["error"] < 1], marks=True)
        panels.append(panel)
    write(pictures / "work-error.svg", panels, columns=3)
    panel = Panel("Error over tolerance", "tolerance", "largest error", log_x=True, log_y=True)
    for name, (_, linear, routes) in problems.items():
        if linear:
            panel.line(name, [(row["number"], row["error"]) for row in routes["pi"]], marks=True)
    for factor in (0.1, 1, 10):
        panel.line("", [(1e-8, factor * 1e-8), (1e-2, factor * 1e-2)], colour="#999", dash="4 3", width=1)
    write(pictures / "tolerance.svg", [panel], columns=1)


def insert(text, marker, lines):
    begin, end = f"<!-- {marker} -->\n", f"<!-- end of {marker} -->"
    before, rest = text.split(begin)
    return before + begin + "\n" + "\n".join(lines) + "\n\n" + end + rest.split(end)[1]


def main():
    problems = read(measured(sys.argv[1:]))
    draw(problems)
    text = insert(page.read_text(), "tolerance", tolerances(problems))
    page.write_text(insert(text, "work against error", comparison(problems)))
    print(page)


if __name__ == "__main__":
    main()
