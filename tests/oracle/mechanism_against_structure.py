"""The same model as a structure and as a mechanism: `mechanism_against_structure.py COMMAND [FIRST LAST]`.

Masses, springs, dampers and loads on a line are coordinates once, and nodes that supports keep on the line once. A frame of
many exact beams in small motion is a frame of linear ones, but for the bending that linear elements lose, a share of 1/n^2.
Nothing but the command is asked here; the two ways share no element and no step.
"""

import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import numpy as np  # noqa: E402

from random_mechanism import text_of  # noqa: E402
from mechanism.judge import read_csv  # noqa: E402


def lines(tables):
    out = []
    for key, table in tables:
        out += ["", f"[[{key}]]" if key != "gravity" else "[gravity]"] + [f"{k} = {text_of(v)}" for k, v in table.items()]
    return "\n".join(out) + "\n"


def analyses(duration, method):
    """Equal steps: the size to which a tolerance is relative is another in a mechanism. Newmark's own methods: those with two
    weights start their auxiliary acceleration differently, which is of the size of their error."""
    return [("analysis", {"name": "march", "type": "transient", "method": method, "duration": duration, "step": duration / 1000,
                          "output": {"every": 20}}),
            ("analysis", {"name": "rest", "type": "static"}), ("analysis", {"name": "swing", "type": "modes"})]


def lumped(seed):
    """(structure, mechanism, names) of masses on a line."""
    r = np.random.default_rng([seed, 16])
    M, L, T = 10 ** r.uniform(-3, 3, 3)
    n = int(r.integers(1, 6))
    one, two = [], []
    places = np.arange(1, n + 1) * 0.3 * L
    for i in range(n):
        mass, v = r.uniform(0.3, 3) * M, r.normal() * L / T
        one.append(("coordinate", {"name": f"n{i}.x", "mass": mass, "velocity": v}))
        two += [("node", {"name": f"n{i}", "position": [places[i], 0.0], "velocity": [v, 0.0]}), ("mass", {"node": f"n{i}", "mass": mass}),
                ("support", {"node": f"n{i}", "fix": ["y"]})]
    both = []
    ends = ["ground"] + [f"n{i}.x" for i in range(n)]
    for i in range(n):
        both.append(("spring", {"between": [ends[i], ends[i + 1]], "stiffness": 10 ** r.uniform(0, 3) * M / T**2}))
    for _ in range(int(r.integers(0, 4))):
        a, b = r.choice(n + 1, 2, replace=False)
        both.append(("spring", {"between": [ends[a], ends[b]], "stiffness": 10 ** r.uniform(-1, 2) * M / T**2}))
    for _ in range(int(r.integers(0, 4))):
        a, b = r.choice(n + 1, 2, replace=False)
        both.append(("damper", {"between": [ends[a], ends[b]], "damping": 10 ** r.uniform(-2, 0.5) * M / T}))
    for _ in range(int(r.integers(1, 4))):
        size, w = r.normal() * M * L / T**2, r.uniform(1, 10) / T
        law = [{"amplitude": size, "angular_frequency": w, "phase": r.uniform(-3, 3)}, {"expression": f"{size!r}*sin({w!r}*t)"},
               {"expression": f"{size!r}*exp(-t/{T!r})"}][int(r.integers(3))]
        both.append(("force", {"on": ends[int(r.integers(1, n + 1))], **law}))
    both += analyses(3 * T, ["damped_newmark", {"name": "newmark", "beta": 0.36, "gamma": 0.7}][int(r.integers(2))])
    extra = [("joint", {"name": "measure", "type": "strut", "between": ["ground", "n0"], "at": [-20 * L, 0.0], "force": 0})]
    return lines(one + both), lines(two + extra + both), [(f"n{i}.x", places[i]) for i in range(n)], 1e-7


def frame(seed):
    """A bent cantilever or a portal of beams; exact ones bend by 1/(4 n^2) too little where they are n parts."""
    r = np.random.default_rng([seed, 17])
    parts = 24
    places = [np.zeros(2)]
    for _ in range(int(r.integers(1, 3))):
        places.append(places[-1] + r.uniform(0.5, 1.5) * np.array([np.cos(a := r.uniform(-3, 3)), np.sin(a)]))
    base = [("material", {"name": "m", "young": 2e11, "density": 7800.0, "poisson": 0.3}),
            ("section", {"name": "s", "area": 1e-3, "inertia": 1e-7, "shear_factor": 0.83})]
    base += [("node", {"name": f"n{i}", "position": [float(x) for x in p]}) for i, p in enumerate(places)]
    base.append(("support", {"node": "n0", "fix": ["x", "y", "rz"]}))
    last = f"n{len(places) - 1}"
    base.append(("force", {"on": f"{last}.{'xy'[int(r.integers(2))]}", "expression": 1e-2}))
    base.append(("mass", {"node": last, "mass": r.uniform(1, 10)}))
    tail = [("analysis", {"name": "rest", "type": "static", "observe": [f"{last}.x", f"{last}.y", f"{last}.rz"]}),
            ("analysis", {"name": "swing", "type": "modes", "count": 2})]
    beams = lambda how: [("beam", {"nodes": [f"n{i}", f"n{i + 1}"], "section": "s", "material": "m", "elements": parts, **how})
                         for i in range(len(places) - 1)]
    names = [(f"{last}.x", places[-1][0]), (f"{last}.y", places[-1][1])]
    return lines(base + beams({}) + tail), lines(base + beams({"formulation": "geometrically_exact"}) + tail), names, 4 / parts**2


def run(command, text, folder):
    folder.mkdir(parents=True)
    (folder / "study.toml").write_text(text)
    done = subprocess.run([command, "run", str(folder / "study.toml"), "-o", str(folder / "results")], capture_output=True, text=True)
    return done.returncode, done.stderr


def differences(one, two, names, allowed):
    """[(what, error, allowed)] of the tables of both."""
    out = []
    for table in ("march", "rest"):
        a, b = ((folder / "results" / f"{table}.csv") for folder in (one, two))
        if not a.exists() or not b.exists():
            continue
        a, b = read_csv(a), read_csv(b)
        for word in ("position [m]", "velocity [m/s]", "acceleration [m/s2]"):
            columns = [(f"{n}.{word}", x if word.startswith("position") else 0.0) for n, x in names if f"{n}.{word}" in a]
            if not columns:
                continue
            size = max(np.max(np.abs(a[c])) for c, _ in columns)
            # differences of places lose what the places have in front
            floor = 1e-13 * max(abs(x) for _, x in columns)
            jumps = 30 if word.startswith("acceleration") else 1
            for c, x in columns:
                out.append((f"{table} {c}", np.max(np.abs(a[c] - (b[c] - x)) / (size + floor)), jumps * allowed + floor / max(size, 1e-300)))
    a, b = (read_csv(folder / "results" / "swing.csv") for folder in (one, two))
    for key in ("eigenvalue_real [1/s]", "eigenvalue_imaginary [rad/s]"):
        size = np.abs(a["angular_frequency [rad/s]"])
        n = min(len(a[key]), len(b[key]))
        out.append((f"swing {key}", np.max(np.abs(a[key][:n] - b[key][:n]) / (size[:n] + 1e-6 * size.max())), max(1e-7, allowed)
                    if allowed > 1e-4 else 1e-7))
    return out


def main():
    command = sys.argv[1]
    first, last = (int(sys.argv[2]), int(sys.argv[3])) if len(sys.argv) > 3 else (0, 9)
    differing = 0
    for seed in range(first, last + 1):
        for kind in (lumped, frame):
            with tempfile.TemporaryDirectory() as scratch:
                structure, mechanism, names, allowed = kind(seed)
                one, two = pathlib.Path(scratch) / "structure", pathlib.Path(scratch) / "mechanism"
                for text, folder in ((structure, one), (mechanism, two)):
                    code, message = run(command, text, folder)
                    if code:
                        print(f"seed {seed} {kind.__name__}: {folder.name} ended with {code}: {message[-400:]}")
                        differing += 1
                        break
                else:
                    for what, error, limit in differences(one, two, names, allowed):
                        if not error <= limit:
                            print(f"seed {seed} {kind.__name__}: {what}: error {error:.3g}, allowed {limit:.3g}")
                            differing += 1
    print(f"{differing} differences in {2 * (last - first + 1)} models")
    return 1 if differing else 0


if __name__ == "__main__":
    sys.exit(main())
