"""Judges frequency responses."""

import numpy

import judge_laws
import judge_waveforms
import steady
from nonlinear import steady as shooting
from structure.model import read_model
from study import Unreadable
from verdicts import Table, Verdict, worst


def frequency_response(study, model, analysis, table, pairs):
    name = analysis["name"]
    values = table.column("angular_frequency [rad/s]")
    status = table.text("status")
    parameter = analysis.get("excitation") or excitation_of(study)
    swept = [p for p in study.parameters if table.has(p)]
    in_hertz = "frequency" in analysis
    checks = []
    rows = range(len(values))
    solver = analysis.get("solver", "periodic")
    asked = study.number(analysis.get("tolerance", 1e-12 if solver == "periodic" else 1e-3))
    picked = list(rows)
    if model.sliders or model.stops or model.laws:
        picked = picked[::max(1, len(picked) // 2)]
    told = []
    for i in picked:
        if "steps_per_period" in analysis:  # no tolerance is sought; the row tells its error
            asked = max(asked, table.column("error")[i])
        settings = {parameter: values[i] / (2 * numpy.pi) if in_hertz else values[i]}
        settings.update({p: table.column(p)[i] for p in swept})
        now = read_model(study.with_parameters(settings))
        if status[i] != "converged":
            told.append(status[i])
            if status[i] == "unbounded":
                _, _, condition = steady.linear(now)
                checks.append((f"row {i} unbounded, but the matrix is not singular", 1e12 / condition, 1.0))
            continue
        if now.laws:
            motion, fundamental, allowed, offsets = _with_laws(analysis, now, table, i, solver, asked)
            checks += judge_laws.response(now, table, i, motion, 10 * allowed)
            waves = [(motion["q"], motion["v"])]
        elif now.sliders or now.stops:
            if analysis.get("start", "unloaded") != "unloaded" and steady.sticks(now):
                continue
            waves, offsets = None, False
            allowed = {"periodic": 2e-5}.get(solver, 4 * asked)
            if not now.stops and steady.sticks(now):
                fundamental, answers, _ = steady.linear(now, now.stuck_stiffness())
            else:
                # Extremes between 240 samples of the velocities of fast modes err by 1e-3.
                motion, fundamental, flow = steady.march(now, samples=1920 if solver == "periodic" else 240)
                size = numpy.max(numpy.ptp(motion["q"], axis=0))
                if now.stops:
                    # It is a matter of the start where the motion goes: one of those that repeat must be the row's.
                    motions = [motion, *steady.other_motions(now)]
                    start = _start_of_row(analysis, now, table, i, fundamental)
                    if start is None and any(_apart(motion, other) > allowed * size for other in motions):
                        continue
                    row_size = _size_of_row(analysis, now, table, i)
                    if start is not None and all(abs(_size(analysis, now, m) / row_size - 1) > allowed for m in motions):
                        motions.append(steady.march(now, start=start)[0])
                    motion = min(motions, key=lambda m: abs(_size(analysis, now, m) - row_size))
                waves = [(motion["q"], motion["v"])]
                offsets = any(numpy.ptp(motion["slip"][:, k]) < 1e-9 * slider.limit / slider.stiffness
                              for k, slider in enumerate(now.sliders))
        else:
            fundamental, answers, condition = steady.linear(now)
            waves, offsets = None, False
            allowed = (1e-8 if solver != "time_marching" else 4 * asked) + 1e-14 * condition
        amplitudes, roots = {}, {}
        for coordinate in observed_of(analysis, now):
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
                    if "mean" in word and _floats(now, coordinate):
                        continue  # of what nothing holds there is no mean
                    if table.has(header):
                        error = abs(table.column(header)[i] - value) / max(whole, 1e-300)
                        if size == 0 and table.column(header)[i] == 0:
                            error = 0.0
                        checks.append((f"row {i} {header}", error, allowed * (5 if "velocity" in word else 1)))
                header = f"{coordinate}.{'angle_rms [rad]' if turns else 'rms [m]'}"
                if table.has(header) and not offsets and not _floats(now, coordinate):
                    checks.append((f"row {i} {header}", abs(table.column(header)[i] - roots[coordinate]) / max(size, 1e-300),
                                   allowed))
                header = f"{coordinate}.phase [rad]"
                if table.has(header) and abs(first) > 1e-6 * size:
                    turned = numpy.exp(1j * table.column(header)[i]) - first / abs(first)
                    checks.append((f"row {i} {header}", abs(turned) * abs(first) / size, 5 * allowed))
    checks += judge_waveforms.checks(study, analysis, table, parameter, max(1e-7, 4 * asked if solver != "periodic" else 0.0))
    checks += _linear_limits(study, model, analysis, table, parameter, in_hertz)
    if not checks:
        return Verdict(name, "frequency_response", "failed" if told else "skipped", f"no row to compare {told[:1]}")
    return worst(name, f"frequency_response {solver}" if model.sliders or model.laws or solver == "time_marching"
                  else "frequency_response linear", checks)


def _with_laws(analysis, now, table, i, solver, asked):
    """The motion that repeats and is the row's, what a march from rest leads to, or else the one next to the row; the fundamental; what
    the row may differ by; and whether elements that hardly yield, or sliders that stick, hold a mean that hardly fades."""
    allowed = 4 * asked
    row_size = _size_of_row(analysis, now, table, i)
    found, why = [], None
    for start in (None, _start_of_row):
        if start:
            fundamental, _ = steady.orders_of(now)
            start = start(analysis, now, table, i, fundamental)
            if start is None:
                continue
        try:
            orbit, shot = shooting.periodic(now, start=start)
        except Unreadable as problem:
            why = problem
            continue
        found.append((orbit, shot))
        if abs(_size(analysis, now, orbit) / row_size - 1) <= allowed:
            break
    if not found:
        raise why
    orbit, shot = min(found, key=lambda o: abs(_size(analysis, now, o[0]) - row_size))
    return orbit, shot.fundamental, allowed, numpy.max(numpy.abs(numpy.linalg.eigvals(shot.derivative))) > 0.98


def _apart(motion, other):
    return numpy.max(numpy.abs(numpy.ptp(other["q"], axis=0) - numpy.ptp(motion["q"], axis=0)))


def _words(now, row):
    return ("angle_amplitude [rad]", "angle_mean [rad]") if any(now.rotation[j] for j in numpy.nonzero(row)[0]) else (
        "amplitude [m]", "mean [m]")


def _size(analysis, now, motion):
    return max(steady.extremes(motion["q"] @ now.row(c)) for c in observed_of(analysis, now))


def _size_of_row(analysis, now, table, i):
    return max(table.column(f"{c}.{_words(now, now.row(c))[0]}")[i] for c in observed_of(analysis, now))


def _start_of_row(analysis, now, table, i, fundamental):
    """q and v at t = 0 of the first harmonic that a row tells, or None where it does not tell all coordinates."""
    rows = numpy.array([now.row(c) for c in observed_of(analysis, now)])
    if numpy.linalg.matrix_rank(rows) < rows.shape[1]:
        return None
    q, v = [], []
    for c, row in zip(observed_of(analysis, now), rows):
        amplitude, mean = (table.column(f"{c}.{word}")[i] for word in _words(now, row))
        turned = amplitude * numpy.exp(1j * table.column(f"{c}.phase [rad]")[i])
        q.append(mean + turned.real)
        v.append(-fundamental * turned.imag)
    return tuple(numpy.linalg.lstsq(rows, numpy.array(x), rcond=None)[0] for x in (q, v))


def _floats(model, coordinate):
    """Whether no spring resists some motion of it: sliders that slip leave its mean to chance."""
    scale = 1 / numpy.sqrt(numpy.diag(model.stuck_stiffness() + 1e-300))
    values, vectors = numpy.linalg.eigh(model.K * scale[:, None] * scale[None, :])
    rigid = vectors[:, values < 1e-12] * scale[:, None]
    row = model.row(coordinate)
    return bool(numpy.any(numpy.abs(row @ rigid) > 1e-9 * numpy.abs(row) @ numpy.abs(rigid)))


def _linear_limits(study, model, analysis, table, parameter, in_hertz):
    path = table.path.with_suffix(".linear.csv")
    if not path.exists() or not model.sliders or model.laws:
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
                        for o in observed_of(analysis, now)}
            for coordinate, amplitude in expected.items():
                for unit, turns in (("amplitude [m]", False), ("angle_amplitude [rad]", True)):
                    header = f"{coordinate}.{limit}_{unit}"
                    whole = max((a for o, a in expected.items()
                                 if any(now.rotation[j] for j in numpy.nonzero(now.row(o))[0]) == turns), default=0)
                    if limits.has(header) and whole > 0 and condition < 1e11:
                        checks.append((f"{header} of row {i}", abs(limits.column(header)[i] - amplitude) / whole,
                                       1e-7 + 1e-13 * condition))
    return checks


def observed_of(analysis, model):
    observed = analysis.get("observe")
    if observed is None:
        return model.names
    return [str(o) for o in (observed if isinstance(observed, list) else [observed])]


def excitation_of(study):
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
