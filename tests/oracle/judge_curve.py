"""Judges damper curves: objectives, amplitudes and friction work at the peaks; that no response in the range of frequencies is higher;
and of the optimum that no value beside it is better.

The oracle marches each response until it repeats, so that amplitudes are judged to 1e-4, and works, which are of second order in
them and come from slips that the march takes from one place only, to 1e-3 of the largest.
"""

import numpy

import steady
from judge_response import excitation_of, observed_of
from structure.model import read_model
from verdicts import Table, worst

AMPLITUDE, WORK = 1e-4, 1e-3


class Responses:
    """Of a study at a value of the curve's parameter and at a frequency."""

    def __init__(self, study, analysis):
        self.study, self.analysis, self.over = study, analysis, analysis["parameter"]
        self.excitation = analysis.get("excitation") or excitation_of(study)
        self.hertz = 2 * numpy.pi if "frequency" in analysis else 1.0
        self.of_work = analysis.get("objective", "amplitude") != "amplitude"
        self.sign = -1 if self.of_work else 1
        self.allowed = WORK if self.of_work else AMPLITUDE
        bounds = analysis.get("frequency") or analysis["angular_frequency"]
        self.low, self.high = (study.number(bounds[k]) * self.hertz for k in ("from", "to"))

    def at(self, settings, value, w):
        """{coordinate: amplitude}, [friction work of each slider], names of sliders."""
        now = read_model(self.study.with_parameters({**settings, self.over: value, self.excitation: w / self.hertz}))
        rows = {o: now.row(o) for o in observed_of(self.analysis, now)}
        names = [slider.name for slider in now.sliders]
        if not now.sliders or steady.sticks(now):
            fundamental, answers, _ = steady.linear(now, now.stuck_stiffness())
            return {o: steady.extremes(steady.wave(fundamental, answers, row)) for o, row in rows.items()}, [0.0] * len(names), names
        motion, _, _ = steady.march(now, samples=120)
        return {o: steady.extremes(motion["q"] @ row) for o, row in rows.items()}, list(motion["slid"]), names

    def objective(self, settings, value, w):
        amplitudes, works, _ = self.at(settings, value, w)
        return sum(works) if self.of_work else max(amplitudes.values())

    def highest(self, settings, value, near, enough):
        """The highest objective over frequency that is found from some frequencies by climbing, until it is enough."""
        best = 0.0
        for w in near:
            here, reach = self.objective(settings, value, w), 0.01 * w
            best = max(best, here)
            while best < enough and reach > 1e-4 * w:
                sides = [(self.objective(settings, value, x), x) for x in (w - reach, w + reach) if self.low <= x <= self.high]
                top = max(sides, default=(here, w))
                if top[0] > here:
                    here, w = top
                else:
                    reach /= 3
                best = max(best, here)
            if best >= enough:
                break
        return best


def damper_curve(study, model, analysis, table, pairs):
    name = analysis["name"]
    responses = Responses(study, analysis)
    rows = [i for i in sorted({0, len(table.rows) - 1}) if table.text("status")[i] == "converged"]
    checks = []
    for i in rows:
        checks += _row(study, responses, table, i, f"row {i}")
        objective = _objective(table)[i]
        for w in numpy.linspace(responses.low, responses.high, 9):
            here = responses.objective(_settings(study, table, i), table.column(responses.over)[i], w)
            checks.append((f"row {i} a higher response at {w:.6g}", max(here / objective - 1, 0) if objective else here, responses.allowed))
    path = table.path.with_suffix(".optimum.csv")
    if path.exists() and len(Table(path).rows):
        checks += _optimum(study, responses, table, Table(path))
    elif analysis.get("optimum", True) and len(table.rows) > 1 and any(s == "converged" for s in table.text("status")):
        checks.append(("no optimum", 1.0, 0.5))
    return worst(name, "damper_curve", checks)


def _objective(table):
    return table.column(next(h for h in table.head if h.startswith("objective")))


def _settings(study, table, i):
    return {p: table.column(p)[i] for p in study.parameters if table.has(p)}


def _row(study, responses, table, i, title):
    """The numbers of a row at the frequency and the value that it tells."""
    value, w = table.column(responses.over)[i], table.column("angular_frequency [rad/s]")[i]
    amplitudes, works, names = responses.at(_settings(study, table, i), value, w)
    size, whole = max(amplitudes.values()), max(sum(works), 1e-300)
    for coordinate, amplitude in amplitudes.items():
        for unit in ("amplitude [m]", "angle_amplitude [rad]"):
            if table.has(f"{coordinate}.{unit}"):
                yield f"{title} {coordinate}.{unit}", abs(table.column(f"{coordinate}.{unit}")[i] - amplitude) / max(size, 1e-300), AMPLITUDE
    for slider, work in zip(names, works):
        if table.has(f"{slider}.dissipated [J]"):
            told = table.column(f"{slider}.dissipated [J]")[i]
            yield f"{title} {slider}.dissipated", abs(told - work) / max(whole, abs(told), 1e-300) if told or work else 0.0, WORK
        share = table.column(f"{slider}.slip_share")[i] if table.has(f"{slider}.slip_share") else numpy.nan
        if not numpy.isnan(share):
            yield f"{title} {slider}.slip_share", float((share > 1e-6) != (work > 1e-9 * whole) and whole > 1e-290), 0.5
    told, here = _objective(table)[i], whole if responses.of_work else size
    yield f"{title} objective", abs(here - told) / max(here, abs(told), 1e-300) if told else 0.0, responses.allowed


def _optimum(study, responses, table, best):
    for i in range(len(best.rows)):
        if best.text("status")[i] != "converged":
            continue
        settings, value, least = _settings(study, best, i), best.column(responses.over)[i], _objective(best)[i]
        yield from _row(study, responses, best, i, f"optimum {i}")
        same = [k for k in range(len(table.rows)) if table.text("status")[k] == "converged" and all(
            table.column(p)[k] == v for p, v in settings.items() if p != responses.over)]
        curve = _objective(table)[same]
        values = table.column(responses.over)[same]
        if not least:
            continue
        better = numpy.max(responses.sign * (1 - curve / least), initial=0.0)
        yield f"optimum {i}: a better value of the curve", better, 1e-6
        at = [best.column("angular_frequency [rad/s]")[i]]
        if best.text("kind")[i] == "kink":
            other = best.column("other_angular_frequency [rad/s]")[i]
            at.append(other)
            here = responses.objective(settings, value, other)
            yield f"optimum {i}: the other peak of the kink", abs(here / least - 1), responses.allowed
        ends = numpy.min(values), numpy.max(values)
        if best.text("kind")[i] == "bound":
            yield f"optimum {i}: a bound within the range", min(abs(value - e) for e in ends) / abs(value), 1e-9
        for beside in (0.97 * value, 1.03 * value):
            if not min(ends) <= beside <= max(ends):
                continue
            if responses.of_work:  # the highest work over frequency there is above what is found, never below
                higher = responses.highest(settings, beside, at, (1 + 2 * WORK) * least) / least - 1
                yield f"optimum {i}: more work at {beside:.6g}", max(higher, 0.0), WORK
            else:
                there = responses.highest(settings, beside, at, (1 - AMPLITUDE) * least)
                yield f"optimum {i}: a lower value at {beside:.6g}", max(1 - there / least, 0.0), 1.01 * AMPLITUDE
