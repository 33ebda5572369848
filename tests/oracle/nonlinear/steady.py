"""Periodic motions of structures with nonlinear laws, by shooting: the state after a period less the state before vanishes.

The state is that of all coordinates, of Bouc-Wen elements and of sliders; derivatives by differences.
"""

import math

import numpy

import steady
from nonlinear.march import March
from study import Unreadable


class Shooting:
    def __init__(self, model, tolerance=1e-10, start=None):
        self.model = model
        self.fundamental, _ = steady.orders_of(model)
        self.period = 2 * math.pi / self.fundamental
        self.tolerance = tolerance
        q, v = start or (model.q0 * 0, model.v0 * 0)
        # the march measures its sizes at the start: a period long, so that they are those of the motion
        self.flow = March(model, 0.0, 1e9 * self.period, q, v, tolerance=tolerance, most_steps=10**9)
        self.remembering = [i for i, law in enumerate(model.laws) if law.remembers]
        flow = self.flow
        self.scales = numpy.concatenate([flow.size / flow.w, numpy.full(flow.n, flow.size), flow.size_z[self.remembering],
                                         [s.limit for s in model.sliders]])

        counts = (flow.n, flow.n, len(self.remembering), len(model.sliders))
        self.group = numpy.repeat(range(4), counts)

    def state(self):
        flow = self.flow
        forces = [flow.slider_force(i) for i in range(len(self.model.sliders))]
        return numpy.concatenate([flow.eta, flow.rate, flow.z[self.remembering], forces]) / self.scales

    def put(self, x):
        flow, n, r = self.flow, self.flow.n, len(self.remembering)
        x = x * self.scales
        flow.eta, flow.rate = x[:n].copy(), x[n:2 * n].copy()
        flow.z[self.remembering] = x[2 * n:2 * n + r]
        flow.slips = [flow.B[i] @ flow.eta - numpy.clip(f, -s.limit, s.limit) / s.stiffness
                      for i, (s, f) in enumerate(zip(self.model.sliders, x[2 * n + r:]))]
        flow.t = flow.origin = 0.0
        flow.slid[:], flow.lost[:] = 0.0, 0.0
        flow.piece_begin, flow.piece_end = 0.0, flow.end
        flow._settle()

    def after(self, x, periods=1):
        self.put(x)
        self.flow.advance(periods * self.period)
        return self.state()

    def march(self, x, periods):
        for _ in range(periods):
            x = self.after(x)
        return x

    def solve(self, x, tries=14, settled=1e-9):
        """Newton's method from x; what repeats, and the derivative of a period there."""
        after = self.after(x)
        for _ in range(tries):
            gap = after - x
            size = max(numpy.linalg.norm(after), 1e-300)
            derivative = numpy.empty((len(x), len(x)))
            for i in range(len(x)):
                eps = 1e-6 * max(numpy.max(numpy.abs(numpy.concatenate([x, after])[numpy.tile(self.group == self.group[i], 2)])), 1e-9)
                moved = x.copy()
                moved[i] += -eps if i >= 2 * self.flow.n and x[i] > 0 else eps
                derivative[:, i] = (self.after(moved) - after) / (moved[i] - x[i])
            step = numpy.linalg.lstsq(derivative - numpy.eye(len(x)), -gap, rcond=1e-9)[0]
            share = 1.0
            for _ in range(6):
                new = x + share * step
                new_after = self.after(new)
                if numpy.linalg.norm(new_after - new) < numpy.linalg.norm(gap) or numpy.linalg.norm(gap) < 1e-8 * size:
                    break
                share /= 3
            x, after = new, new_after
            if numpy.linalg.norm(after - x) <= settled * numpy.linalg.norm(after):
                self.derivative = derivative
                return x
        raise Unreadable("shooting does not close")

    def waves(self, x, samples):
        """[samples x n] q and v at the ends of equal parts of the period, dissipated work of sliders and laws."""
        self.put(x)
        flow, q, v = self.flow, [], []

        def watch(t, y):
            q.append(flow.phi @ y[:flow.n])
            v.append(flow.phi @ y[flow.n:2 * flow.n])
        begin = flow.t
        flow.advance(begin + self.period, [begin + self.period * (j + 1) / samples for j in range(samples - 1)], watch)
        watch(flow.t, flow._pack())
        return {"q": numpy.array(q), "v": numpy.array(v), "slid": flow.slid.copy(), "lost": flow.lost.copy(), "x": x}


def periodic(model, samples=960, periods=25, start=None, tolerance=1e-10):
    """The periodic motion that a march from rest leads to, or next to q and v at the start of a period."""
    shooting = Shooting(model, tolerance, start)
    x = shooting.state()
    if start is not None:
        x = _with_memories(shooting, start)
    else:
        x = shooting.march(x, periods)
    return shooting.waves(shooting.solve(x), samples), shooting


def _with_memories(shooting, start):
    """From q and v of a harmonic motion: what elements remember after some periods of it."""
    model, w = shooting.model, shooting.fundamental
    q, v = start
    x = shooting.state()
    n, angle = shooting.flow.n, 2 * math.pi * numpy.arange(1, 5 * 64 + 1) / 64
    memories = [0.0] * len(model.laws)
    forces = [0.0] * len(model.sliders)
    way = [q * math.cos(a) + v / w * math.sin(a) for a in numpy.concatenate([[0.0], angle])]
    for before, now in zip(way[:-1], way[1:]):
        for i in shooting.remembering:
            memories[i] = model.laws[i].after(memories[i], model.laws[i].b @ (now - before))[0]
        for i, s in enumerate(model.sliders):
            forces[i] = float(numpy.clip(forces[i] + s.stiffness * (s.b @ (now - before)), -s.limit, s.limit))
    x[2 * n:] = numpy.array([memories[i] for i in shooting.remembering] + forces) / shooting.scales[2 * n:]
    return x
