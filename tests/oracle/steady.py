"""Steady responses: complex solves where nothing slides, else a march by the flow until it repeats."""

import math

import numpy

from flow import Flow
from study import HarmonicLaw, Unreadable
from structure.model import ConstantLaw


def orders_of(model):
    """The fundamental [rad/s] and the complex loads by order: f(t) = f_0 + sum of Re(f_k exp(i k w t))."""
    parts = []
    for vector, law in model.loads:
        if not numpy.any(vector):
            continue
        if isinstance(law, HarmonicLaw):
            w, f = law.angular_frequency, law.amplitude * numpy.exp(1j * law.phase)
            if w < 0:
                w, f = -w, numpy.conj(f)
            parts.append((w, vector * f if w else vector * f.real))
        elif isinstance(law, ConstantLaw):
            parts.append((0.0, vector * (1 + 0j)))
        elif not law.formula.parsed.used & {"t"}:
            parts.append((0.0, vector * complex(law.value(0.0))))
        else:
            raise Unreadable("a load that is not harmonic")
    frequencies = sorted({w for w, _ in parts if w > 0})
    if not frequencies:
        raise Unreadable("no harmonic load")
    fundamental = next((frequencies[0] / d for d in range(1, 65)
                        if all(abs(w * d / frequencies[0] - round(w * d / frequencies[0])) < 1e-9
                               for w in frequencies)), None)
    if fundamental is None:
        raise Unreadable("no common period")
    loads = {}
    for w, f in parts:
        order = round(w / fundamental)
        loads[order] = loads.get(order, 0) + f
    return fundamental, loads


def linear(model, stiffness=None):
    """The fundamental and the displacements by order, without sliders (or with those in `stiffness`)."""
    fundamental, loads = orders_of(model)
    stiffness = model.K if stiffness is None else stiffness
    answers, condition = {}, 1.0
    for order, f in loads.items():
        w = order * fundamental
        s = stiffness - w * w * model.M + 1j * w * model.C
        size = numpy.abs(stiffness) + w * w * numpy.abs(model.M) + w * numpy.abs(model.C)
        scale = 1 / numpy.sqrt(numpy.diag(size))
        scaled = s * scale[:, None] * scale[None, :]
        condition = max(condition, numpy.linalg.cond(scaled))
        right = f * scale
        x = numpy.linalg.solve(scaled, right)
        x += numpy.linalg.solve(scaled, right - scaled @ x)
        answers[order] = x * scale
    return fundamental, answers, condition


def wave(fundamental, answers, row, derivative=0, points=4096):
    """Samples over a period of row . x(t), or of a derivative of it."""
    tau = 2 * math.pi * numpy.arange(points) / points
    x = numpy.zeros(points)
    for order, vector in answers.items():
        z = (row @ vector) * (1j * order * fundamental)**derivative if order or not derivative else 0.0
        x += numpy.real(z * numpy.exp(1j * order * tau))
    return x


def extremes(x):
    """Half peak to peak of samples over a period; each extreme lies on the parabola through three samples."""
    def top(y):
        i = int(numpy.argmax(y))
        a, b, c = y[i - 1], y[i], y[(i + 1) % len(y)]
        bend = a - 2 * b + c
        return b - (c - a)**2 / (8 * bend) if bend < 0 else b
    return 0.5 * (top(x) + top(-x))


def sticks(model):
    """Whether no slider ever slips when all begin without force: then the stuck structure is the answer."""
    fundamental, answers, _ = linear(model, model.stuck_stiffness())
    return all(numpy.max(numpy.abs(slider.stiffness * wave(fundamental, answers, slider.b))) < 0.999 * slider.limit
               for slider in model.sliders)


def _extrapolated(starts, changes):
    """Anderson's mixing: where the changes of the last periods, taken as linear, vanish."""
    x, f = starts[-1], changes[-1]
    if len(starts) < 2:
        return x + f
    dx = numpy.diff(numpy.array(starts), axis=0).T
    df = numpy.diff(numpy.array(changes), axis=0).T
    gamma = numpy.linalg.lstsq(df, f, rcond=1e-10)[0]
    return x + f - (dx + df) @ gamma


def other_motions(model):
    """Between stops several motions may repeat, and sliders that stick between them hold any of a continuum: those to which
    the linear responses lead, without and with the sliders' springs."""
    for start in _linear_starts(model):
        yield march(model, start=start)[0]


def _linear_starts(model):
    """q and v of the linear responses."""
    for stiffness in (model.K, model.stuck_stiffness()) if model.sliders else (model.K,):
        fundamental, answers, condition = linear(model, stiffness)
        if condition < 1e12:
            yield (sum(numpy.real(x) for x in answers.values()),
                   sum(numpy.real(1j * order * fundamental * x) for order, x in answers.items()))


def march(model, samples=240, most_periods=400, settled=1e-9, start=None):
    """The periodic motion from rest, or from q and v: arrays [samples x n] of q and v, [samples x m] of forces, the
    friction work of each slider over a period, and the fundamental.

    Structures without stops have one (but for what sliders that never slip remember), so that the march may be cut short
    by extrapolation: what it ends with repeats all the same. Between stops there may be several (`other_motions`).
    """
    fundamental, _ = orders_of(model)
    period = 2 * math.pi / fundamental
    q, v = start or (model.q0 * 0, model.v0 * 0)
    flow = Flow(model, 0.0, most_periods * period, q, v, [0.0] * len(model.sliders), most_strides=1e9)
    stiffness = numpy.array([slider.stiffness for slider in model.sliders])

    def state():
        forces = [flow.slider_force(i) for i in range(len(stiffness))]
        return numpy.concatenate([flow.eta * flow.scale, flow.rate, forces / numpy.sqrt(stiffness)])

    def put(x):
        n = flow.n
        eta = x[:n] / flow.scale
        strains = [b @ eta for b in flow.b_sliders]
        flow.restart(0.0, eta, x[n:2 * n], strains - x[2 * n:] / numpy.sqrt(stiffness))
    x, starts, changes, plain, best = state(), [], [], 3, math.inf
    for k in range(most_periods):
        if not model.stops:
            put(x)
        begin = flow.t
        flow.advance(begin + period)
        after = state()
        change = after - x
        size = numpy.linalg.norm(change) / max(numpy.linalg.norm(after), 1e-300)
        if size < settled:
            break
        starts.append(x)
        changes.append(change)
        plain -= 1
        if size > 4 * best:
            starts, changes, plain = [], [], 4
        best = min(best, size)
        x = after if plain > 0 or model.stops else _extrapolated(starts[-12:], changes[-12:])
    else:
        raise Unreadable("the march does not settle")
    if not model.stops:
        put(after)
    begin, slid = flow.t, list(flow.slid)
    rows = {"q": [], "v": [], "force": [], "slip": []}
    for j in range(samples):
        flow.advance(begin + period * (j + 1) / samples)
        q, v = flow.full()
        rows["q"].append(q)
        rows["v"].append(v)
        rows["force"].append([flow.slider_force(i) for i in range(len(model.sliders))])
        rows["slip"].append([flow.slip(i) for i in range(len(model.sliders))])
    rows["slid"] = [after - before for after, before in zip(flow.slid, slid)]
    return {key: numpy.array(value) for key, value in rows.items()}, fundamental, flow
