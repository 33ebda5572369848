"""Holds what the command wrote for a mechanism against the oracle."""

import csv
import pathlib
import re

import numpy as np

from mechanism import Mechanism, Refused, moved
from mechanism.columns import transient_row
from mechanism.march import March
from mechanism.rest import begin_at_rest, eigenvalues, equilibrium, equilibrium_at, let_go, march_scale, modes_about, state_of_row, stiffness

# Errors of velocities and energies over those of positions. Accelerations and forces are held to the state that is told; only
# where a study leaves out coordinates, so that there is none, are they held to ours.
LOOSER = {"m": 1, "rad": 5, "m/s": 20, "rad/s": 20, "m/s2": 200, "rad/s2": 200, "N": 200, "N m": 200, "J": 20}
FORCES = ("m/s2", "rad/s2", "N", "N m")
MOST = 50      # tolerances; most runs keep ten


def read_csv(path):
    """Columns by name; text stays text."""
    with open(path, newline="") as file:
        rows = list(csv.reader(file))
    out = {}
    for name, cells in zip(rows[0], zip(*rows[1:]) if len(rows) > 1 else [[]] * len(rows[0])):
        try:
            out[name] = np.array([float(c) if c else np.nan for c in cells])
        except ValueError:
            out[name] = list(cells)
    return out


def unit_of(column):
    found = re.search(r"\[([^]]*)\]$", column)
    return found.group(1) if found else ""


class Finding:
    def __init__(self, analysis, column, error, limit, note=""):
        self.analysis, self.column, self.error, self.limit, self.note = analysis, column, error, limit, note

    def __str__(self):
        return f"{self.analysis}: {self.column}: error {self.error:.3g}, limit {self.limit:.3g} {self.note}"


def differences(ours, theirs, keep, floor):
    """{column: largest difference over the largest of its unit}, and the columns that only one side has."""
    scale = {}
    for name, values in theirs.items():
        if name.startswith("time") or isinstance(values, list):
            continue
        u = unit_of(name)
        ours_too = ours.get(name)
        big = np.nanmax(np.abs(values)) if len(values) else 0.0
        if ours_too is not None and len(ours_too):
            big = max(big, np.nanmax(np.abs(ours_too), initial=0.0))
        scale[u] = max(scale.get(u, 0.0), big)
    out = {}
    for name, values in theirs.items():
        if name.startswith("time") or name not in ours or isinstance(values, list):
            continue
        u = unit_of(name)
        size = max(scale[u], floor.get(u, 0.0))
        if size == 0:
            continue
        asked = keep & ~np.isnan(ours[name])
        d = np.abs(np.asarray(ours[name]) - values)[asked]
        if np.any(np.isnan(d)):
            out[name] = np.inf
        elif len(d):
            out[name] = float(np.max(d)) / size
    missing = [n for n in theirs if n not in ours and not isinstance(theirs[n], list) and not n.startswith("residue") and n != "state"]
    return out, missing


def floors(march, duration):
    """What is nothing in each unit: round-off of a model of this size that does not move."""
    m, T = march.box, duration
    mass = float(np.max(np.diag(march.model.M)[march.model.free % 6 < 3], initial=0.0))
    if mass == 0:
        mass = float(np.max(np.diag(march.model.M))) / m**2
    unit = {"m": m, "rad": 1.0, "m/s": m / T, "rad/s": 1 / T, "m/s2": m / T**2, "rad/s2": 1 / T**2,
            "N": mass * m / T**2, "N m": mass * m * m / T**2, "J": mass * m * m / T**2}
    return {k: 1e-3 * v for k, v in unit.items()}


def transient(study, analysis, folder, start=None):
    """[(column, error over tolerance-free scale)], events of both, for one transient."""
    model = Mechanism(study)
    march = March(model)
    theirs = read_csv(pathlib.Path(folder) / f"{analysis['name']}.csv")
    duration = study.number(analysis["duration"])
    few = thin(theirs["time [s]"])
    theirs = {k: v[few] if isinstance(v, np.ndarray) else v for k, v in theirs.items()}
    times = theirs["time [s]"]
    if start is None and analysis.get("initial") == "static":
        start = told_equilibrium(study, march, folder, velocities=True)
    told = iter(range(len(times)))

    def both(march, state, t, works):
        """Our row, and that of the state that is told, with our knowledge of what sticks and holds."""
        k = next(told)
        row, energy = transient_row(march, state, t, works)
        there = state_of_row(march, {name: v[k] for name, v in theirs.items()})
        if there is not None:
            there.memories = told_memories(march, {name: v[k] for name, v in theirs.items()}, state)
        return row, energy, None if there is None else transient_row(march, there, t, works)[0]
    pairs = march.run(duration, times, start=start, columns=both)
    ours = {k: np.array([p[0].get(k, np.nan) for p in pairs]) for k in pairs[0][0]}
    if model.space:
        turn_alike(ours, theirs)
    there = None
    if all(p[2] is not None for p in pairs):
        there = {k: np.array([p[2].get(k, np.nan) for p in pairs]) for k in pairs[0][2]}
    return march, model, ours, theirs, pairs, there


def turn_alike(ours, theirs):
    """Of the two rotation vectors of a half turn, which is the shortest turn to round-off only, ours is the one next to theirs."""
    for name in [c[: -len(".rx.angle [rad]")] for c in ours if c.endswith(".rx.angle [rad]")]:
        columns = [f"{name}.{letter}.angle [rad]" for letter in ("rx", "ry", "rz")]
        if not all(c in ours and c in theirs for c in columns):
            continue
        mine, told = (np.array([of[c] for c in columns]) for of in (ours, theirs))
        size = np.maximum(np.linalg.norm(mine, axis=0), 1e-300)
        other = mine * (1 - 2 * np.pi / size)
        nearer = (size > 2) & (np.linalg.norm(other - told, axis=0) < np.linalg.norm(mine - told, axis=0))
        for c, line in zip(columns, np.where(nearer, other, mine)):
            ours[c] = line


def told_memories(march, row, state):
    """What the elements of a row remember, by their forces."""
    out = np.array(state.memories if state.memories is not None else np.zeros(len(march.model.local_laws)))
    for k, law in enumerate(march.model.local_laws):
        f = next((row[n] for n in (f"{law.name}.force [N]", f"{law.name}.moment [N m]") if n in row), None)
        u = next((row[n] for n in (f"{law.name}.displacement [m]", f"{law.name}.angle [rad]", f"{law.name}.relative_angle [rad]")
                  if n in row), None)
        if law.remembers and law.alpha < 1 and f is not None and u is not None:
            out[k] = (f - law.alpha * law.k * u) / ((1 - law.alpha) * law.k)
    return out


def near(times, events, reach):
    keep = np.ones(len(times), bool)
    for e in events:
        keep &= np.abs(times - e) > reach
    return keep


def judge_transient(study, analysis, folder, tolerance):
    march, model, ours, theirs, pairs, there = transient(study, analysis, folder)
    duration = study.number(analysis["duration"])
    times = theirs["time [s]"]
    floor = floors(march, duration)
    events = [e[0] for e in march.events] + march.breaks(duration)
    keep = near(times, events, max(1e-9, 10 * tolerance) * duration)
    found = []
    errors, missing = differences(ours, theirs, keep, floor)
    # What is told of forces belongs to the state that is told, however far that is from ours: exactly at the ends of steps,
    # to the error of the interpolation between them, which laws with kinks feel.
    belongs = {} if there is None else differences({c: v for c, v in there.items() if unit_of(c) != "J"}, theirs, keep, floor)[0]
    ends = "every" in analysis.get("output", {"every": 1})
    exact = 1e-6 if ends else max(1e-6, MOST * tolerance)
    found += [Finding(analysis["name"], column, error, exact, "at the state told") for column, error in belongs.items()
              if not error <= exact]
    energy_file = pathlib.Path(folder) / f"{analysis['name']}.energy.csv"
    if energy_file.exists():
        energy = {k: v[thin(v)] for k, v in read_csv(energy_file).items()}
        begin = pairs[0][1]["strain [J]"]
        mine = {k: np.array([p[1][k] for p in pairs]) for k in pairs[0][1]}
        mine["strain [J]"] = mine["strain [J]"] - begin
        energy["strain [J]"] = energy["strain [J]"] - energy["strain [J]"][0]
        if march.ended_laws:
            for e in (mine, energy):
                e["strain [J]"] = e["strain [J]"] + e.pop("lock_dissipated [J]")
        if len(energy["time [s]"]) == len(times):
            more, lacking = differences(mine, energy, keep, floor)
            errors.update(more)
            missing += lacking
    if belongs:      # the forces are judged where they belong
        of_laws = tuple(law.name + "." for law in model.local_laws)
        errors = {c: e for c, e in errors.items() if unit_of(c) not in FORCES or c.startswith(of_laws)}
    beyond = {c: e for c, e in errors.items() if not e <= MOST * tolerance * LOOSER.get(unit_of(c), 1)}
    grown = {}
    if beyond and tolerance < 1e-3:
        grown = sensitivity(march, study, analysis, folder, times, ours, keep, floor)
    for column, error in beyond.items():
        u = unit_of(column)
        limit = MOST * tolerance * max(LOOSER.get(u, 1), grown.get(u, 1.0))
        if not error <= limit:
            found.append(Finding(analysis["name"], column, error, limit, f"where a small change of the start grows by {grown.get(u, 1.0):.2g}"))
    for column in missing:
        found.append(Finding(analysis["name"], column, np.inf, 0.0, "unknown to the oracle"))
    if not keep.any():
        found.append(Finding(analysis["name"], "-", np.inf, 0.0, "no rows left to compare"))
    return found, errors, march


def sensitivity(march, study, analysis, folder, times, ours, keep, floor, share=1e-6):
    """{unit: by how much the motion multiplies a small change of its start}: what errors of its first steps grow by; of velocities
    with the frequencies of the motion, as errors of places have them too."""
    again = March(march.model)
    start = None
    if analysis.get("initial") == "static":
        start = told_equilibrium(study, again, folder, velocities=True)
    state = again.begin(start)
    random = np.random.default_rng(15).uniform(-share, share, (2, march.model.nf))
    w = march.model.free % 6
    near_it = moved(march.model, state, random[0] * np.where(w < 3, march.box, 1.0))
    near_it.u = state.u + random[1] * np.where(w < 3, np.max(np.abs(state.u[w < 3]), initial=0.0),
                                               np.max(np.abs(state.u[w >= 3]), initial=0.0))
    rows = again.run(study.number(analysis["duration"]), times, start=near_it, columns=lambda *a: transient_row(*a)[0])
    changed = {k: np.array([r.get(k, np.nan) for r in rows]) for k in ours}
    grown = {}
    for column, error in differences(ours, changed, keep, floor)[0].items():
        if np.isfinite(error):
            grown[unit_of(column)] = max(grown.get(unit_of(column), 1.0), error / share)
    return grown


def thin(times, most=40):
    """At most so many rows, first and last among them."""
    n = len(times)
    return np.arange(n) if n <= most else np.unique(np.round(np.linspace(0, n - 1, most)).astype(int))


def told_equilibrium(study, march, folder, velocities=False):
    """The equilibrium that the study's static analysis tells, held to be one; where none is told, or it is none, our own."""
    for analysis in study.raw["analysis"]:
        table = pathlib.Path(folder) / f"{analysis['name']}.csv"
        if analysis["type"] != "static" or not table.exists():
            continue
        told = state_of_row(march, {k: v[0] for k, v in read_csv(table).items()})
        if told is not None:
            try:
                return let_go(march, equilibrium_at(march, told), velocities)
            except (Refused, np.linalg.LinAlgError):
                march.__init__(march.model, march.rtol)
    return equilibrium(march, velocities)


def judge_static(study, analysis, folder):
    """What is told must be in balance: of several equilibria any will do, and of those that a motion does not leave."""
    march = March(Mechanism(study))
    state = told_equilibrium(study, march, folder)
    ours = transient_row(march, state, 0.0, np.zeros(march.works))[0]
    theirs = read_csv(pathlib.Path(folder) / f"{analysis['name']}.csv")
    one = {k: np.array([v]) for k, v in ours.items()}
    force = max(np.max(np.abs(march.applied(state, 0.0)[march.model.free % 6 < 3]), initial=0.0),
                np.max(np.abs([v for k, v in ours.items() if unit_of(k) == "N"]), initial=0.0))
    # round-off of what is held by stiff parts, where nothing acts
    scale = np.where(march.model.free % 6 < 3, march.box, 1.0)
    held = np.max(np.abs(stiffness(march, state, np.zeros(len(march.rows(state, 0.0, march.model.scalars(state))[0]))) * scale
                         * scale[:, None]), initial=0.0) / march.box
    force = max(force, 1e-5 * held)
    floor = {"m": 1e-3 * march.box, "rad": 1e-3, "N": 1e-3 * force, "N m": 1e-3 * force * march.box}
    errors, missing = differences(one, theirs, np.ones(1, bool), floor)
    found = [Finding(analysis["name"], c, e, 1e-6) for c, e in errors.items() if not e <= 1e-6]
    found += [Finding(analysis["name"], c, np.inf, 0.0, "unknown to the oracle") for c in missing]
    return found, errors, march


def judge_modes(study, analysis, folder):
    model = Mechanism(study)
    march = March(model)
    about, at, coarse = analysis.get("about", "given"), 0.0, 1.0
    if about == "static":
        state = told_equilibrium(study, march, folder)
    elif about == "given":
        state = begin_at_rest(march)
    else:
        if about.get("static"):
            raise Refused("modes about the equilibrium next to where a transient leads")
        transient_of = next(a for a in study.raw["analysis"] if a["name"] == about["analysis"])
        duration = study.number(transient_of["duration"])
        at = study.number(about.get("time", duration))
        start = told_equilibrium(study, march, folder, velocities=True) if transient_of.get("initial") == "static" else None
        state = march.run(at, [at], start=start)[0][1]      # no farther: locks are as they are then
        march.window = (at, np.inf)      # loads of that instant, not of the last stretch of the march
        coarse = 1e6 * 100 * study.number(transient_of["step"]["tolerance"])
    if march.has_memories(state):
        raise Refused("modes about a state that a Bouc-Wen element remembers: loading and unloading have tangents of their own")
    C, K, G, Z, out = modes_about(march, state, at)
    ours = eigenvalues(C, K, Z)
    theirs = read_csv(pathlib.Path(folder) / f"{analysis['name']}.csv")
    found, errors = [], {}
    name = analysis["name"]
    s = theirs["eigenvalue_real [1/s]"] + 1j * theirs["eigenvalue_imaginary [rad/s]"]
    if len(ours) == 0:
        return ([Finding(name, "eigenvalue", np.inf, 0.0, "no motion is left")] if len(s) else []), errors, march
    # what round-off leaves of an eigenvalue: a share of the stiffest motion, or of what the forces would make
    Q = march.applied(state, at)
    mu = march.instant(state, at)[1]
    forces = np.linalg.norm(march.Linv @ Q) + np.linalg.norm(march.Linv @ (G.T @ mu))
    natural = np.sqrt(forces / march_scale(march))
    fast = max(np.max(np.abs(ours)), natural)
    used = np.zeros(len(ours), bool)
    worst = 0.0
    for k, x in enumerate(s):
        free = np.where(used, np.inf, np.abs(ours - x))
        i = int(np.argmin(free))
        used[i] = True
        reach = 1e-6 * abs(x) + min(1e-9 * fast**2 / max(abs(x), 1e-300), 3e-5 * fast)
        worst = max(worst, free[i] / reach)
    errors["eigenvalue"] = worst
    if not worst <= 50 * coarse:
        found.append(Finding(name, "eigenvalue", worst, 50 * coarse))
    # none of the lowest may be missing: those above, one of each pair, by size
    lowest = np.sort(np.abs(ours))[::2]
    count = len(s)
    if count and np.max(np.abs(ours.real)) < 1e-7 * fast:
        gap = np.max(np.abs(np.sort(np.abs(s)) - lowest[:count]) / np.maximum(lowest[:count], 1e-1 * fast)) if count <= len(lowest) else np.inf
        errors["lowest"] = gap
        if not gap <= 1e-5 * coarse:
            found.append(Finding(name, "lowest modes", gap, 1e-5 * coarse, "a mode is missing, or one too many"))
    # the shapes solve the equations
    letters = ["x", "y", "z", "rx", "ry", "rz"]
    X = np.zeros((model.nf, count), complex)
    for k, c in enumerate(model.free):
        p, i = divmod(int(c), 6)
        base = f"{model.names[p]}.{letters[i]}"
        real = f"{base}.shape [1/sqrt(kg)]" if i < 3 else f"{base}.angle_shape [rad/(m sqrt(kg))]"
        imaginary = f"{base}.shape_imaginary [1/sqrt(kg)]" if i < 3 else f"{base}.angle_shape_imaginary [rad/(m sqrt(kg))]"
        if real not in theirs:
            return found, errors, march
        X[k] = theirs[real] + 1j * (np.nan_to_num(theirs[imaginary]) if imaginary in theirs else 0.0)
    T = Z.T @ model.M @ X
    k2, c2 = Z.T @ K @ Z, Z.T @ C @ Z
    worst, norm, gap = 0.0, 0.0, 0.0
    for x, y, t in zip(s, X.T, T.T):
        terms = abs(x) ** 2 * np.linalg.norm(t) + abs(x) * np.linalg.norm(c2 @ t) + (np.linalg.norm(k2, 2) + natural**2) * np.linalg.norm(t) * 1e-3
        if terms > 0:
            worst = max(worst, np.linalg.norm(x * x * t + x * (c2 @ t) + k2 @ t) / terms)
        norm = max(norm, abs(np.vdot(y, model.M @ y).real - 1))
        gap = max(gap, np.linalg.norm(Z @ t - y) / max(np.linalg.norm(y), 1e-300))
    errors.update({"shape residual": worst, "shape norm": norm, "shape off the constraints": gap})
    for what, e in (("shape residual", worst), ("shape norm", norm), ("shape off the constraints", gap)):
        if not e <= min(1e-4 * coarse, 0.1):
            found.append(Finding(name, what, e, 1e-4 * coarse))
    return found, errors, march


def judge(study, analysis, folder):
    """Findings, errors and the march, of any analysis of a mechanism."""
    if analysis["type"] == "static":
        return judge_static(study, analysis, folder)
    if analysis["type"] == "modes":
        return judge_modes(study, analysis, folder)
    step = analysis["step"]
    tolerance = study.number(step["tolerance"]) if isinstance(step, dict) else 1e-3
    if isinstance(step, dict) and step.get("controller") == "cardona_cassano":
        tolerance *= 30     # it measures accelerations by the step, and its errors fall with tolerance^(2/3)
    return judge_transient(study, analysis, folder, tolerance)
