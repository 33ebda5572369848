"""Writes the matrices of examples/matrices: a cantilever of Euler-Bernoulli beams, condensed to nothing, as Matrix Market.

    python3 tools/make_beam_matrices.py examples/matrices

A steel blade 0.4 m long, 20 x 4 mm, ten elements: coordinates w1, r1, ..., w10, r10 (deflection [m], rotation [rad]) from
root to tip. Consistent mass, Rayleigh damping C = 3.0 M + 2e-6 K.
"""
import pathlib
import sys

folder = pathlib.Path(sys.argv[1])
elements, length = 10, 0.4
young, density, width, height = 210e9, 7850.0, 0.020, 0.004
area, inertia, h = width * height, width * height**3 / 12, length / elements
n = 2 * elements

# Przemieniecki, Theory of Matrix Structural Analysis (1968): bending element of length h.
bending = young * inertia / h**3
stiffness_e = [[12, 6 * h, -12, 6 * h], [6 * h, 4 * h * h, -6 * h, 2 * h * h],
               [-12, -6 * h, 12, -6 * h], [6 * h, 2 * h * h, -6 * h, 4 * h * h]]
inertial = density * area * h / 420
mass_e = [[156, 22 * h, 54, -13 * h], [22 * h, 4 * h * h, 13 * h, -3 * h * h],
          [54, 13 * h, 156, -22 * h], [-13 * h, -3 * h * h, -22 * h, 4 * h * h]]

mass, stiffness = {}, {}
for e in range(elements):
    for i in range(4):
        for j in range(4):
            row, column = 2 * e + i - 2, 2 * e + j - 2  # the root is clamped
            if row < 0 or column < 0 or column > row:
                continue
            mass[row, column] = mass.get((row, column), 0.0) + inertial * mass_e[i][j]
            stiffness[row, column] = stiffness.get((row, column), 0.0) + bending * stiffness_e[i][j]
damping = {key: 3.0 * mass[key] + 2e-6 * stiffness[key] for key in mass}

for name, matrix in [("mass", mass), ("damping", damping), ("stiffness", stiffness)]:
    entries = {key: value for key, value in sorted(matrix.items()) if value != 0.0}
    lines = ["%%MatrixMarket matrix coordinate real symmetric", f"{n} {n} {len(entries)}"]
    lines += [f"{row + 1} {column + 1} {value!r}" for (row, column), value in entries.items()]
    (folder / f"{name}.mtx").write_text("\n".join(lines) + "\n")
