"""Runs the command on a study, reads its tables, and holds them against the oracle."""

import csv
import pathlib
import re
import resource
import signal
import subprocess
import tempfile

import numpy

import modes
import statics
import steady
import transient
from structure.model import read_model
from study import Study, Unreadable

ORACLE_SECONDS = 20
COMMAND_SECONDS = 20


class Verdict:
    """`kind` of analysis, `outcome` one of agrees, differs, refused, skipped, failed; and what was measured."""

    def __init__(self, analysis, kind, outcome, what="", error=0.0, allowed=0.0):
        self.analysis, self.kind, self.outcome, self.what = analysis, kind, outcome, what
        self.error, self.allowed = float(error), float(allowed)

    def __str__(self):
        numbers = f" error {self.error:.3g}, allowed {self.allowed:.3g}" if self.outcome == "differs" else ""
        return f"{self.analysis} ({self.kind}): {self.outcome} {self.what}{numbers}"


class _OutOfTime(Exception):
    pass


def _alarm(*_):
    raise _OutOfTime


class Table:
    """A CSV file of results: `column("x.position [m]")` [rows]; cells that are no numbers stay text."""

    def __init__(self, path):
        with open(path, newline="") as file:
            rows = list(csv.reader(file))
        self.path, self.head, self.rows = pathlib.Path(path), rows[0], rows[1:]

    def has(self, name):
        return name in self.head

    def text(self, name):
        i = self.head.index(name)
        return [row[i] for row in self.rows]

    def column(self, name):
        return numpy.array([float(cell) if cell else numpy.nan for cell in self.text(name)])


def run_command(command, path, folder):
    """With a limit on its processor time; -9 or -24 beyond."""
    def limit():
        resource.setrlimit(resource.RLIMIT_CPU, (COMMAND_SECONDS, COMMAND_SECONDS + 1))
    return subprocess.run([str(command), "run", str(path), "-o", str(folder), "--jobs", "1"], capture_output=True,
                          text=True, preexec_fn=limit)


def judge(path, command, folder=None):
    """Verdicts of all analyses of a study. Those that the command refuses are taken out, and the others judged."""
    refused = []
    while True:
        verdicts = _judge(path, command, folder)
        named = [v for v in verdicts if v.outcome == "refused"]
        line = re.search(r"toml:(\d+):", named[0].what) if named else None
        if not line or not _without(path, int(line.group(1))):
            return refused + verdicts
        refused.append(Verdict("?", "refused", "refused", named[0].what))


def _without(path, line):
    """Takes the analysis at a line out of the study; whether any is left."""
    lines = pathlib.Path(path).read_text().splitlines(keepends=True)
    begins = [i for i, text in enumerate(lines) if text.startswith("[[analysis]]")]
    at = [i for i in begins if i < line]
    if not at or len(begins) < 2:
        return False
    end = next((i for i in begins if i > at[-1]), len(lines))
    pathlib.Path(path).write_text("".join(lines[:at[-1]] + lines[end:]))
    return True


def _judge(path, command, folder):
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(folder or scratch)
        done = run_command(command, path, folder)
        if done.returncode in (-signal.SIGXCPU, -signal.SIGKILL):
            return [Verdict("all", "all", "failed", f"the command takes more than {COMMAND_SECONDS} s")]
        message = " ".join(line for line in done.stderr.splitlines() if "error" in line or done.returncode == 2)[-600:]
        study = Study(path)
        if done.returncode == 2:
            return [Verdict("all", "all", "refused", message)]
        if done.returncode < 0:
            return [Verdict("all", "all", "differs", f"the command died of signal {-done.returncode}")]
        try:
            model = read_model(study)
        except Unreadable as why:
            return [Verdict("all", "all", "skipped", str(why))]
        verdicts = []
        pairs = {}
        for analysis in study.raw["analysis"]:
            name, kind = analysis["name"], analysis["type"]
            table = folder / f"{name}.csv"
            signal.signal(signal.SIGPROF, _alarm)
            signal.setitimer(signal.ITIMER_PROF, ORACLE_SECONDS)
            try:
                if not table.exists() or len(table.read_text().splitlines()) < 2:
                    verdicts.append(_without_rows(model, analysis, message))
                    continue
                verdicts.append(_JUDGES[kind](study, model, analysis, Table(table), pairs))
            except Unreadable as why:
                verdicts.append(Verdict(name, kind, "skipped", str(why)))
            except (numpy.linalg.LinAlgError, ArithmeticError, ValueError) as why:
                verdicts.append(Verdict(name, kind, "skipped", f"the oracle fails: {type(why).__name__} {why}"))
            except _OutOfTime:
                verdicts.append(Verdict(name, kind, "skipped", "out of time"))
            finally:
                signal.setitimer(signal.ITIMER_PROF, 0)
        return [v for v in verdicts if v]


def _without_rows(model, analysis, message):
    """The command gave no answer; is there one?"""
    name, kind = analysis["name"], analysis["type"]
    if kind == "static":
        try:
            statics.equilibrium(model)
        except Unreadable:
            return Verdict(name, kind, "agrees", "neither finds an equilibrium")
        return Verdict(name, kind, "failed", "an equilibrium exists: " + message)
    return Verdict(name, kind, "failed", message)


def _worst(name, kind, checks):
    """`checks`: (what, error, allowed); the one that fails most decides."""
    worst = max(checks, key=lambda c: (c[1] / c[2] if numpy.isfinite(c[1]) else numpy.inf), default=None)
    if worst is None:
        return Verdict(name, kind, "skipped", "nothing to compare")
    if not worst[1] <= worst[2]:
        return Verdict(name, kind, "differs", worst[0], worst[1], worst[2])
    return Verdict(name, kind, "agrees", worst[0], worst[1], worst[2])


def _columns_of(model, name):
    """The headers of position, velocity and acceleration of a coordinate."""
    if model.rotation[model.index(name)]:
        return [f"{name}.angle [rad]", f"{name}.angular_velocity [rad/s]", f"{name}.angular_acceleration [rad/s2]"]
    return [f"{name}.position [m]", f"{name}.velocity [m/s]", f"{name}.acceleration [m/s2]"]


# ---- static states

def _static(study, model, analysis, table, pairs):
    name = analysis["name"]
    held = [str(n) for n in analysis["displacements"]] if "displacements" in analysis else None
    state = statics.equilibrium(model, held)
    energy = 0.5 * abs(state.q @ model.K @ state.q)
    condition = _condition(model.stuck_stiffness())
    allowed = 1e-9 + 1e-14 * min(condition, 1e12)
    checks = []
    weights = numpy.sqrt(numpy.abs(numpy.diag(model.stuck_stiffness())))
    size = max(numpy.max(numpy.abs(state.q) * weights), 1e-20)
    for i, coordinate in enumerate(model.names):
        header = _columns_of(model, coordinate)[0]
        if table.has(header):
            checks.append((header, abs(table.column(header)[0] - state.q[i]) * weights[i] / size, allowed))
    for i, slider in enumerate(model.sliders):
        for header in (f"{slider.name}.force [N]", f"{slider.name}.moment [N m]"):
            if table.has(header):
                checks.append((header, abs(table.column(header)[0] - state.slider_forces[i]) / slider.limit,
                               allowed * (1 + slider.stiffness * numpy.max(numpy.abs(state.q)) / slider.limit)))
    for i, stop in enumerate(model.stops):
        for header in (f"{stop.name}.force [N]", f"{stop.name}.moment [N m]"):
            if table.has(header):
                whole = stop.stiffness * (abs(stop.gap) + numpy.max(numpy.abs(state.q)))
                checks.append((header, abs(table.column(header)[0] - state.stop_forces[i]) / whole, allowed))
    forces = numpy.abs(model.K) @ numpy.abs(state.q) + numpy.abs(model.load(0.0, -1))
    for i, reaction in state.reactions.items():
        for header in (f"{model.names[i]}.reaction [N]", f"{model.names[i]}.reaction_moment [N m]"):
            if table.has(header):
                checks.append((header, abs(table.column(header)[0] - reaction) / max(forces[i], 1e-300), allowed))
    del energy
    return _worst(name, "static", checks)


def _condition(matrix):
    scale = 1 / numpy.sqrt(numpy.maximum(numpy.abs(numpy.diag(matrix)), 1e-300))
    return numpy.linalg.cond(matrix * scale[:, None] * scale[None, :])


# ---- transients

def _transient(study, model, analysis, table, pairs):
    name = analysis["name"]
    times = table.column("time [s]")
    duration = study.number(analysis["duration"])
    checks = []
    output = analysis.get("output", {})
    if not abs(times[-1] - duration) <= 1e-9 * duration and not set(output) & {"interval", "times"}:
        return Verdict(name, "transient", "failed", f"ends at {times[-1]} of {duration}")
    pick = numpy.unique(numpy.linspace(0, len(times) - 1, 60).astype(int))
    rows, flow = transient.march(model, analysis, list(times[pick]))
    observed = [i for i, c in enumerate(model.names) if table.has(_columns_of(model, c)[0])]
    for text in analysis.get("observe", []) if isinstance(analysis.get("observe"), list) else []:
        header = f"{text}.position [m]"
        if " - " in str(text) and table.has(header):
            row = model.row(text)
            size = max(numpy.max(numpy.abs(rows["q"]) @ numpy.abs(row)), 1e-300)
            checks.append((header, numpy.max(numpy.abs(table.column(header)[pick] - rows["q"] @ row)) / size,
                           _loosely(study, analysis, model)))
    if not observed:
        return _worst(name, "transient", checks)
    free = [i for i in observed if i not in [j for j, _ in model.moving]]
    weights = numpy.sqrt(numpy.diag(model.M))
    got = {key: numpy.zeros((len(pick), len(model.names))) for key in ("q", "v", "a")}
    for i in observed:
        for key, header in zip(("q", "v", "a"), _columns_of(model, model.names[i])):
            got[key][:, i] = table.column(header)[pick]

    def error(key):
        whole = numpy.max(numpy.linalg.norm(rows[key][:, observed] * weights[observed], axis=1))
        return (numpy.max(numpy.linalg.norm((got[key] - rows[key])[:, free] * weights[free], axis=1))
                / max(whole, 1e-300)) if free else 0.0
    moving = [i for i, _ in model.moving]
    for i in moving:
        if i in observed:
            for key, header in zip(("q", "v", "a"), _columns_of(model, model.names[i])):
                size = max(numpy.max(numpy.abs(rows[key][:, i])), 1e-300)
                checks.append((f"{header} (moved)", numpy.max(numpy.abs(got[key][:, i] - rows[key][:, i])) / size, 1e-9))
    contacts = bool(model.sliders or model.stops)
    method = analysis.get("method", "generalized_alpha")
    method = method["name"] if isinstance(method, dict) else method
    step = analysis.get("step")
    e = error("q")
    if method == "exact":
        checks.append(("position", e, 1e-7 if contacts else 1e-8))
        checks.append(("velocity", error("v"), 1e-6 if contacts else 1e-8))
        if free == moving_free(model):
            checks += _energies(model, table, rows, pick, flow, 1e-5 if contacts else 1e-7)
    elif isinstance(step, dict):
        tolerance = study.number(step["tolerance"])
        pair = method in ("dormand_prince", "bogacki_shampine")
        located = step.get("events") == "locate" or step.get("events") != "pass" and (pair or not model.sliders)
        factor = 10 if not contacts else 50 if located else 300
        allowed = factor * tolerance + 1e-9
        if step.get("controller", "pi") != "pi" or step.get("estimator") == "inertia_jump":
            allowed = 2.0  # its tolerance is not that of the error, or it only watches
        elif set(output) & {"interval", "times"}:
            allowed = 2 * allowed + 1e-3
        checks.append(("position", e, allowed))
        ledger = max(2 * allowed + 1e-9, 5e-3 if contacts else 0.0)  # works are sums over steps
        checks += _energies(model, table, rows, pick, flow, ledger) if free == moving_free(model) and allowed < 1 else []
    else:
        pair = pairs.setdefault(name.split("@")[0], [])
        pair.append((study.number(step), e, name))
        if len(pair) == 2:
            (h1, e1, _), (h2, e2, _) = sorted(pair, reverse=True)
            order, aligned = _order(method, analysis), True
            for law in [law for _, law in model.loads] + [law for _, law in model.moving]:
                for t in law.switches(0.0, duration):
                    if abs(t / h1 - round(t / h1)) < 1e-6:
                        continue
                    jump = abs(law.value(t, 1) - law.value(t, -1)) > 1e-6 * abs(law.value(t, 1))
                    order, aligned = min(order, 0 if jump else 2), False
            if e1 > 0.3 or not numpy.isfinite(e1):
                return Verdict(name, "transient", "skipped", f"step {h1:g} is too long (error {e1:.2g})")
            if h1**2 * flow.fastest**3 * duration > 10 and flow.fastest * h2 > 1e-3 * order:
                order = 0  # the fastest mode is out of phase, by how much is chance
            limit = 0.9 * e1 if contacts and order else (1.6 if aligned else 2.5) * e1 * (h2 / h1)**order
            checks.append((f"error at half the step (order {order})", e2, max(limit, 2e-7 if not contacts else 3e-3)))
        else:
            return None
    return _worst(name, "transient", checks)


def moving_free(model):
    moved = [i for i, _ in model.moving]
    return [i for i in range(len(model.names)) if i not in moved]


def _loosely(study, analysis, model):
    step = analysis.get("step")
    return 0.5 if not isinstance(step, dict) or model.sliders or model.stops else max(0.05, 100 * study.number(step["tolerance"]))


def _energies(model, table, rows, pick, flow, allowed):
    """The ledger against energies of the oracle's motion."""
    path = table.path.with_suffix(".energy.csv")
    if not path.exists():
        return []
    ledger = Table(path)
    if len(ledger.rows) != len(table.rows):
        return []
    kinetic = 0.5 * numpy.einsum("ti,ij,tj->t", rows["v"], model.M, rows["v"])
    strain = 0.5 * numpy.einsum("ti,ij,tj->t", rows["q"], model.K, rows["q"])
    stored = sum((0.5 * rows["slider_force"][:, i]**2 / s.stiffness for i, s in enumerate(model.sliders)),
                 numpy.zeros(len(pick)))
    pushed = sum((0.5 * s.stiffness * numpy.maximum(rows["q"] @ s.b - s.gap, 0)**2 * (rows["stop_force"][:, i] > 0)
                  for i, s in enumerate(model.stops)), numpy.zeros(len(pick)))
    whole = max(numpy.max(kinetic + strain + stored), numpy.max(rows["slid"]), 1e-300)
    checks = []
    for header, value in (("kinetic", kinetic), ("strain", strain), ("slider_stored", stored),
                          ("slider_dissipated", rows["slid"]), ("stop_stored", pushed)):
        if ledger.has(f"{header} [J]"):
            error = numpy.max(numpy.abs(ledger.column(f"{header} [J]")[pick] - value)) / whole
            checks.append((f"energy {header}", error, allowed))
    return checks


_ORDERS = {"explicit_euler": 1, "damped_newmark": 1, "galerkin": 1, "backward_difference": 1, "newmark": 1, "rk3": 3,
           "bogacki_shampine": 3, "rk4": 4, "dormand_prince": 5}


def _order(method, analysis):
    return _ORDERS.get(method, 2)


# ---- modes

def _modes(study, model, analysis, table, pairs):
    name = analysis["name"]
    checks = []
    limits = table.text("limit")
    omegas, ratios = table.column("angular_frequency [rad/s]"), table.column("damping_ratio")
    real, imaginary = table.column("eigenvalue_real [1/s]"), table.column("eigenvalue_imaginary [rad/s]")
    for limit in ("free", "stuck"):
        rows = [i for i, word in enumerate(limits) if word == limit]
        if not rows:
            continue
        omega, s = modes.eigenvalues(model, limit)
        largest = max(numpy.max(omega), 1e-300)
        mass, damping, stiffness, f = modes.matrices(model, limit)
        undamped = not numpy.any(model.C)
        wanted = sorted(numpy.abs(s[(s.imag >= -1e-9 * numpy.abs(s))]))
        for place, i in enumerate(rows):
            # each eigenvalue given is one of the pencil
            given = complex(real[i], imaginary[i])
            round_off = 1e-15 * largest**2 / max(abs(given), 1e-7 * largest) * 30
            near = numpy.min(numpy.abs(s - given))
            defective = 1e-6 if abs(abs(given.real) - abs(given)) < 1e-4 * abs(given) else 0.0
            checks.append((f"{limit} mode {place + 1} eigenvalue", near,
                           1e-7 * abs(given) + round_off + defective * abs(given) + 1e-7 * largest * 1e-4))
            if undamped and place < len(omega):
                checks.append((f"{limit} mode {place + 1} frequency", abs(omegas[i] - omega[place]),
                               1e-7 * omega[place] + 30e-15 * largest**2 / max(omega[place], 1e-7 * largest)))
            checks.append((f"{limit} mode {place + 1} ratio",
                           abs(ratios[i] + real[i] / max(abs(given), 1e-300)) if abs(given) > 1e-6 * largest else 0,
                           1e-6 if ratios[i] < 1 else numpy.inf))
            shape = numpy.zeros(len(model.names), dtype=complex)
            whole = True
            for j, coordinate in enumerate(model.names):
                header = (f"{coordinate}.angle_shape [rad/(m sqrt(kg))]" if model.rotation[j]
                          else f"{coordinate}.shape [1/sqrt(kg)]")
                if not table.has(header):
                    whole = whole and j not in f
                    continue
                shape[j] = table.column(header)[i]
                second = (header.replace(".angle_shape [", ".angle_shape_imaginary [")
                          .replace(".shape [", ".shape_imaginary ["))
                if table.has(second):
                    value = table.column(second)[i]
                    shape[j] += 1j * (0.0 if numpy.isnan(value) else value)
            if whole:
                norm = abs(numpy.conj(shape) @ model.M @ shape)
                checks.append((f"{limit} mode {place + 1} mass of shape", abs(norm - 1), 1e-6))
                if given == 0:  # told as a rigid motion: far below the lowest that is not
                    others = [o for o in omegas[rows] if o > 0]
                    checks.append((f"{limit} mode {place + 1} at rest", omega[min(place, len(omega) - 1)],
                                   1e-4 * min(others, default=largest)))
                elif ratios[i] <= 1:
                    checks.append((f"{limit} mode {place + 1} residual", modes.residual(model, limit, given, shape),
                                   10.0))
        count = int(study.number(analysis["count"])) if "count" in analysis else 20
        del wanted
        if undamped and len(rows) != min(count, len(omega)):
            checks.append((f"{limit} count", abs(len(rows) - min(count, len(omega))), 0.1))
    return _worst(name, "modes", checks)


# ---- frequency responses

def _frequency_response(study, model, analysis, table, pairs):
    name = analysis["name"]
    values = table.column("angular_frequency [rad/s]")
    status = table.text("status")
    parameter = analysis.get("excitation") or _excitation(study)
    swept = [p for p in study.parameters if table.has(p)]
    in_hertz = "frequency" in analysis
    checks = []
    rows = range(len(values))
    solver = analysis.get("solver", "periodic")
    asked = study.number(analysis.get("tolerance", 1e-12 if solver == "periodic" else 1e-3))
    picked = list(rows)
    if model.sliders or model.stops:
        picked = picked[::max(1, len(picked) // 2)]
    told = []
    for i in picked:
        settings = {parameter: values[i] / (2 * numpy.pi) if in_hertz else values[i]}
        settings.update({p: table.column(p)[i] for p in swept})
        now = read_model(study.with_parameters(settings))
        if status[i] != "converged":
            told.append(status[i])
            if status[i] == "unbounded":
                _, _, condition = steady.linear(now)
                checks.append((f"row {i} unbounded, but the matrix is not singular", 1e12 / condition, 1.0))
            continue
        if now.sliders or now.stops:
            if analysis.get("start", "unloaded") != "unloaded" and steady.sticks(now):
                continue
            waves, offsets = None, False
            allowed = {"periodic": 2e-5}.get(solver, 4 * asked)
            if not now.stops and steady.sticks(now):
                fundamental, answers, _ = steady.linear(now, now.stuck_stiffness())
            else:
                motion, fundamental, flow = steady.march(now)
                waves = [(motion["q"], motion["v"])]
                offsets = numpy.any(numpy.ptp(motion["slip"], axis=0) == 0) if now.sliders else False
        else:
            fundamental, answers, condition = steady.linear(now)
            waves, offsets = None, False
            allowed = (1e-8 if solver != "time_marching" else 4 * asked) + 1e-14 * condition
        amplitudes, roots = {}, {}
        for coordinate in _observed(analysis, now):
            row = now.row(coordinate)
            if waves:
                x, v = motion["q"] @ row, motion["v"] @ row
            else:
                x, v = (steady.wave(fundamental, answers, row, d) for d in (0, 1))
            roots[coordinate] = numpy.sqrt(numpy.mean(x * x))
            rotation = any(now.rotation[j] for j in numpy.nonzero(row)[0])
            words = ("angle_amplitude [rad]", "angular_velocity_amplitude [rad/s]", "angle_mean [rad]") if rotation else (
                "amplitude [m]", "velocity_amplitude [m/s]", "mean [m]")
            amplitudes[coordinate] = (steady.extremes(x), steady.extremes(v), numpy.mean(x), words, rotation,
                                      numpy.mean(x * numpy.exp(-2j * numpy.pi * numpy.arange(1, len(x) + 1) / len(x)
                                                               if waves else
                                                               -2j * numpy.pi * numpy.arange(len(x)) / len(x))) * 2)
        for rotation in (False, True):
            several = [a for a in amplitudes.values() if a[4] == rotation]
            if not several:
                continue
            size = max(max(a[0], abs(a[2])) for a in several)
            speed = max(a[1] for a in several)
            for coordinate, (amplitude, velocity, mean, words, turns, first) in amplitudes.items():
                if turns != rotation:
                    continue
                for word, value, whole in zip(words, (amplitude, velocity, mean), (size, speed, size)):
                    header = f"{coordinate}.{word}"
                    if "mean" in word and offsets:
                        continue  # what a slider that never slips remembers
                    if "mean" in word and _condition(now.stuck_stiffness()) > 1e12:
                        continue  # of what nothing holds there is no mean
                    if table.has(header):
                        error = abs(table.column(header)[i] - value) / max(whole, 1e-300)
                        if size == 0 and table.column(header)[i] == 0:
                            error = 0.0
                        checks.append((f"row {i} {header}", error, allowed * (5 if "velocity" in word else 1)))
                header = f"{coordinate}.{'angle_rms [rad]' if turns else 'rms [m]'}"
                if table.has(header) and not offsets and _condition(now.stuck_stiffness()) < 1e12:
                    checks.append((f"row {i} {header}", abs(table.column(header)[i] - roots[coordinate]) / max(size, 1e-300),
                                   allowed))
                header = f"{coordinate}.phase [rad]"
                if table.has(header) and abs(first) > 1e-6 * size:
                    turned = numpy.exp(1j * table.column(header)[i]) - first / abs(first)
                    checks.append((f"row {i} {header}", abs(turned) * abs(first) / size, 5 * allowed))
    checks += _linear_limits(study, model, analysis, table, parameter, in_hertz)
    if not checks:
        return Verdict(name, "frequency_response", "failed" if told else "skipped", f"no row to compare {told[:1]}")
    return _worst(name, f"frequency_response {solver}" if model.sliders or solver == "time_marching"
                  else "frequency_response linear", checks)


def _linear_limits(study, model, analysis, table, parameter, in_hertz):
    path = table.path.with_suffix(".linear.csv")
    if not path.exists() or not model.sliders:
        return []
    limits, checks = Table(path), []
    values = limits.column("angular_frequency [rad/s]")
    swept = [p for p in study.parameters if limits.has(p)]
    for i in sorted({0, len(values) // 2, len(values) - 1}):
        settings = {p: limits.column(p)[i] for p in swept}
        settings[parameter] = values[i] / (2 * numpy.pi) if in_hertz else values[i]
        now = read_model(study.with_parameters(settings))
        for limit, stiffness in (("free", now.K), ("stuck", now.stuck_stiffness())):
            fundamental, answers, condition = steady.linear(now, stiffness)
            expected = {o: steady.extremes(steady.wave(fundamental, answers, now.row(o)))
                        for o in _observed(analysis, now)}
            for coordinate, amplitude in expected.items():
                for unit, turns in (("amplitude [m]", False), ("angle_amplitude [rad]", True)):
                    header = f"{coordinate}.{limit}_{unit}"
                    whole = max((a for o, a in expected.items()
                                 if any(now.rotation[j] for j in numpy.nonzero(now.row(o))[0]) == turns), default=0)
                    if limits.has(header) and whole > 0 and condition < 1e11:
                        checks.append((f"{header} of row {i}", abs(limits.column(header)[i] - amplitude) / whole,
                                       1e-7 + 1e-13 * condition))
    return checks


def _damper_curve(study, model, analysis, table, pairs):
    """At each value the amplitude where the command sees the highest peak, and that it is the highest of a scan."""
    name = analysis["name"]
    parameter = analysis.get("excitation") or _excitation(study)
    values, objective = table.column("angular_frequency [rad/s]"), table.column(next(
        h for h in table.head if h.startswith("objective")))
    over, status = analysis["parameter"], table.text("status")
    in_hertz = "frequency" in analysis
    limits = [
        study.number((analysis.get("frequency") or analysis["angular_frequency"])[k]) * (2 * numpy.pi if in_hertz else 1)
        for k in ("from", "to")]
    if analysis.get("objective", "amplitude") != "amplitude":
        return Verdict(name, "damper_curve", "skipped", "friction work")
    swept = [p for p in study.parameters if table.has(p)]
    checks = []
    for i in [0, len(values) - 1]:
        if status[i] != "converged":
            continue

        def largest(w):
            settings = {p: table.column(p)[i] for p in swept}
            settings.update({over: table.column(over)[i], parameter: w / (2 * numpy.pi) if in_hertz else w})
            now = read_model(study.with_parameters(settings))
            rows = [now.row(o) for o in _observed(analysis, now)]
            if not now.sliders or steady.sticks(now):
                fundamental, answers, _ = steady.linear(now, now.stuck_stiffness())
                return max(steady.extremes(steady.wave(fundamental, answers, row)) for row in rows)
            motion, _, _ = steady.march(now, samples=120)
            return max(steady.extremes(motion["q"] @ row) for row in rows)
        there = largest(values[i])
        checks.append((f"row {i} objective", abs(there - objective[i]) / there, 1e-4))
        for w in numpy.linspace(limits[0], limits[1], 9):
            checks.append((f"row {i} a higher response at {w:.6g}", max(largest(w) / objective[i] - 1, 0), 1e-4))
    return _worst(name, "damper_curve", checks)


def _observed(analysis, model):
    observed = analysis.get("observe")
    if observed is None:
        return model.names
    return [str(o) for o in (observed if isinstance(observed, list) else [observed])]


def _excitation(study):
    """The only parameter that stands in the frequencies of the loads."""
    found = set()
    parts = study.raw.get("force", []) + study.raw.get("distributed_force", [])
    if "base_motion" in study.raw:
        parts = parts + [study.raw["base_motion"]]
    for part in parts:
        for key in ("angular_frequency", "frequency"):
            if isinstance(part.get(key), str):
                found |= study.formula(part[key]).parsed.used & set(study.parameters)
    if len(found) != 1:
        raise Unreadable(f"which parameter is the frequency? {found}")
    return found.pop()


def _unjudged(study, model, analysis, table, pairs):
    return Verdict(analysis["name"], analysis["type"], "agrees", "it runs; not judged")


_JUDGES = {"static": _static, "transient": _transient, "modes": _modes, "frequency_response": _frequency_response,
           "method_study": _unjudged, "damper_curve": _damper_curve}
