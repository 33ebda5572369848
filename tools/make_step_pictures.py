"""Draws the pictures of the tutorial pages oscillator-tolerance and frame, what Cardona and Cassano (1991) show in their
figures 1, 4, 5 and 7 to 13, and that of lattice.

    cmake --preset release && cmake --build --preset release --target rubato_command
    python3 tools/make_step_pictures.py build/release/apps/rubato/rubato
"""
import csv
import math
import pathlib
import re
import subprocess
import sys
import tempfile

from svg_chart import Panel, write

root = pathlib.Path(__file__).resolve().parent.parent
pictures = root / "docs" / "pictures"
CUT_OFF = 0.6  # Omega_K
GREY = "#999"


def mean_error(omega, alpha):
    """eps(Omega) of the paper, with its misprinted share 1/2 - beta."""
    beta = (1 - alpha) ** 2 / 4
    share = (0.5 - beta) ** 2
    return ((1 + alpha) * omega**3 * math.sqrt(1 + share * omega**2)
            / (3 * math.pi * (1 + (1 + alpha) * beta * omega**2)))


def run(rubato, text, folder, settings=()):
    (folder / "study.toml").write_text(text)
    subprocess.run([rubato, "run", folder / "study.toml", "-o", folder / "results", "--quiet",
                    *[word for setting in settings for word in ("--set", setting)]], check=True)
    return folder / "results"


def rows(file):
    """The rows of a CSV file of the command, numbers where they are numbers, by the names without units."""
    def value(text):
        try:
            return float(text)
        except ValueError:
            return text
    with open(file, encoding="utf-8", newline="") as opened:
        table = csv.reader(opened)
        names = [re.sub(r" \[.*\]$", "", name) for name in next(table)]
        return [dict(zip(names, map(value, row))) for row in table]


def accepted(steps):
    return [row for row in steps if row["accepted"] == 1]


def stairs(steps):
    """(time, step) with a corner where the step changes; the last one, cut to the end, says nothing."""
    return [point for row in accepted(steps)[:-1] for point in ((row["time"], row["step"]), (row["time"] + row["step"], row["step"]))]


def solved(matrix, right):
    """x of matrix x = right by elimination with row exchanges; all in lists."""
    a = [[*row, b] for row, b in zip(matrix, right)]
    n = len(a)
    for k in range(n):
        pivot = max(range(k, n), key=lambda i: abs(a[i][k]))
        a[k], a[pivot] = a[pivot], a[k]
        for i in range(k + 1, n):
            factor = a[i][k] / a[k][k]
            a[i] = [x - factor * y for x, y in zip(a[i], a[k])]
    x = [0.0] * n
    for k in reversed(range(n)):
        x[k] = (a[k][n] - sum(a[k][j] * x[j] for j in range(k + 1, n))) / a[k][k]
    return x


def oscillator(rubato, folder):
    text = (root / "examples" / "oscillator-tolerance" / "study.toml").read_text()
    alpha = -0.3
    function = Panel("Figure 1: error and spectral radius, alpha = -0.3", "Omega = omega h", "", log_x=True)
    grid = [10 ** (-1 + 2.5 * i / 200) for i in range(201)]
    function.line("eps(Omega)", [(omega, mean_error(omega, alpha)) for omega in grid if mean_error(omega, alpha) < 1.25])
    lines = subprocess.run([rubato, "methods", "hht", "--set", f"alpha={alpha}", "--csv"], check=True,
                           capture_output=True, text=True).stdout.splitlines()
    radius = [(row["omega_h"], row["radius"]) for row in spectral_radius(lines)]
    function.line("spectral radius", [(omega, rho) for omega, rho in radius if 0.1 <= omega <= 10**1.5])
    function.line("Omega_K = 0.6", [(CUT_OFF, 0), (CUT_OFF, 1.25)], colour=GREY, dash="4 3")

    alpha = -0.05
    tolerances = Panel("Figure 4: tolerance and omega times the mean step", "omega h", "TOL", log_x=True, log_y=True)
    scale = mean_error(CUT_OFF, alpha)
    tolerances.line("eps/K", [(omega, mean_error(omega, alpha) / scale) for omega in
                                     [10 ** (-1.9 + 1.9 * i / 100) for i in range(101)]])
    for square in (1000, 100):
        points = []
        for power in (1, 0, -1, -2, -3, -4):
            results = run(rubato, text, folder, (f"omega={math.sqrt(square)!r}", f"TOL={10.0**power}"))
            steps = accepted(rows(results / "cardona_cassano.steps.csv"))
            points.append((40 * math.pi / len(steps), 10.0**power))
            if square == 100 and power == 0:
                tried = rows(results / "cardona_cassano.steps.csv")
        tolerances.line(f"omega^2 = {square}", points, marks=True)
    first = [row for row in tried if row["time"] < 2.0]
    step = Panel("Figure 5: step, TOL = 1, omega^2 = 100", "time [s]", "h [s]")
    step.line("accepted", stairs(tried))
    step.line("rejected", [(row["time"], row["step"]) for row in tried if row["accepted"] == 0], width=0, marks=True)
    error = Panel("Its error", "time [s]", "e", log_y=True)
    error.line("accepted", [(row["time"], row["error"]) for row in accepted(first)])
    error.line("TOL", [(0, 1), (2, 1)], colour=GREY, dash="4 3")
    write(pictures / "oscillator-tolerance.svg", [function, tolerances, step, error])


def spectral_radius(lines):
    names = [re.sub(r" \[.*\]$", "", name) for name in lines[0].split(",")]
    out = []
    for line in lines[1:]:
        row = dict(zip(names, line.split(",")))
        out.append({"omega_h": float(row["omega_h"]), "radius": float(row["spectral_radius"])})
    return out


def spectrum(shapes, start, mean_step):
    """|amplitude| of each mode over omega h, from the displacements of the start."""
    names = [name[: -len(".shape")] for name in shapes[0] if name.endswith(".shape")]
    angles = [name[: -len(".angle_shape")] for name in shapes[0] if name.endswith(".angle_shape")]
    matrix = [[mode[f"{name}.shape"] for mode in shapes] for name in names]
    matrix += [[mode[f"{name}.angle_shape"] for mode in shapes] for name in angles]
    right = [start[f"{name}.position"] for name in names] + [start[f"{name}.angle"] for name in angles]
    amplitude = solved(matrix, right)
    return [(mode["angular_frequency"] * mean_step, abs(y)) for mode, y in zip(shapes, amplitude)]


def frame(rubato, folder):
    text = (root / "examples" / "frame" / "study.toml").read_text()
    results = run(rubato, re.sub(r"^observe = .*\n", "", text, flags=re.M), folder)
    shapes = rows(results / "natural.csv")
    for pair, numbers, with_position in (("PMB", (7, 8, 9, 10), True), ("PMM", (None, 11, 12, 13), False)):
        position = Panel(f"Figure {numbers[0]}: node 1, vertical", "time [s]", "[m]")
        acceleration = Panel(f"Figure {numbers[1]}: node 1, vertical acceleration", "time [s]", "[m/s2]")
        step = Panel(f"Figure {numbers[2]}: step", "time [s]", "h [s]", log_y=True)
        modes = Panel(f"Figure {numbers[3]}: initial modal displacements", "omega times the mean step",
                      "|y0| [m sqrt(kg)]", log_x=True, log_y=True)
        for number, dash in ((1, ""), (2, "5 3")):
            name = f"{pair}{number}"
            motion = rows(results / f"{name.lower()}.csv")
            steps = rows(results / f"{name.lower()}.steps.csv")
            position.line(name, [(row["time"], row["1.y.position"]) for row in motion])
            acceleration.line(name, [(row["time"], row["1.y.acceleration"]) for row in motion], width=1.1)
            step.line(name, stairs(steps))
            mean_step = 0.12 / len(accepted(steps))
            points = [(x, y) for x, y in spectrum(shapes, motion[0], mean_step) if y > 1e-9]
            modes.line(name, points, dash=dash, width=1.0, marks=True)
        modes.line("Omega_K = 0.6", [(CUT_OFF, 1e-9), (CUT_OFF, 1e3)], colour=GREY, dash="4 3")
        modes.y_range = (1e-7, 1e-1)
        panels = [position, acceleration, step, modes] if with_position else [acceleration, step, modes]
        write(pictures / f"frame-{pair.lower()}.svg", panels, columns=2)


def lattice(rubato, folder):
    example = root / "examples" / "lattice"
    places = {row["name"]: (row["x"], row["y"]) for row in rows(example / "nodes.csv")}
    mesh = Panel("Mesh", "x [m]", "y [m]", x_range=(-4.5, 8.5), y_range=(-0.3, 12.3))
    for beam in rows(example / "beams.csv"):
        mesh.line("", [places[beam["first"]], places[beam["second"]]], colour="#1f5fa8", width=1.2)
    results = folder / "lattice"
    subprocess.run([rubato, "run", example / "study.toml", "-o", results, "--quiet"], check=True)
    motion = Panel("Let go at the top", "time [s]", "x [m]")
    release = rows(results / "release.csv")
    for name in ("n12-0.x", "n6-2.x"):
        motion.line(name, [(row["time"], row[f"{name}.position"]) for row in release])
    write(pictures / "lattice.svg", [mesh, motion])


def main():
    rubato = pathlib.Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory() as scratch:
        oscillator(rubato, pathlib.Path(scratch))
        frame(rubato, pathlib.Path(scratch))
        lattice(rubato, pathlib.Path(scratch))


if __name__ == "__main__":
    main()
