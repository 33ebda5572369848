"""Equilibria of structures with nonlinear laws: loads grow from zero, at once and in many parts, and each Bouc-Wen element remembers the way.

Within a part u goes one way, so that z is exact; where no u turns back one part gives the same as many. Sliders and stops have the
force of where they are, as without laws.
"""

import numpy

from study import Unreadable


class PathEquilibrium:
    """q [n], forces of sliders and stops, reactions of what is held by index, memories, displacements and forces of laws."""

    def __init__(self, q, model, memories, load, fixed):
        self.q, self.memories = q, memories
        self.slider_forces = [float(numpy.clip(s.stiffness * (s.b @ q), -s.limit, s.limit)) for s in model.sliders]
        self.stop_forces = [float(max(0.0, s.stiffness * (s.b @ q - s.gap))) for s in model.stops]
        self.law_displacements = [float(law.b @ q) for law in model.laws]
        self.law_forces = [law.force(u, 0.0, 0.0, z) for law, u, z in zip(model.laws, self.law_displacements, memories)]
        residual = model.K @ q - load
        for force, part in zip(self.slider_forces + self.stop_forces + self.law_forces, model.sliders + model.stops + model.laws):
            residual = residual + force * part.b
        self.reactions = {i: residual[i] for i in fixed}


def equilibrium(model, fixed, load):
    """Where the loads [n] and the displacements `fixed` {index: value} lead that grow together from zero, each element loaded without a
    turn. Where elements turn on the way that is another state, which is not judged; stops that are compressed without loads have no
    way of their own."""
    at_once = _follow(model, fixed, load, [1.0])
    model.turns_back = 0.0
    if all(stop.gap >= 0 for stop in model.stops):
        on_the_way = _follow(model, fixed, load, [i / 200 for i in range(1, 201)])
        size = max(numpy.max(numpy.abs(at_once[0])), 1e-300)
        if numpy.max(numpy.abs(at_once[0] - on_the_way[0])) > 1e-7 * size:
            raise Unreadable("an element turns on the way of the loads")
        model.turns_back = numpy.max(numpy.abs(at_once[0] - on_the_way[0])) / size
    return PathEquilibrium(at_once[0], model, at_once[1], load, fixed)


def _follow(model, fixed, load, shares):
    n = len(model.names)
    free = [i for i in range(n) if i not in fixed]
    q, memories, ways = numpy.zeros(n), [0.0] * len(model.laws), [0.0] * len(model.laws)
    for grown in shares:
        start = q.copy()
        for i, value in fixed.items():
            q[i] = grown * value
        q = _newton(model, free, grown * load, start, q, memories, ways)
        for i, law in enumerate(model.laws):
            if law.remembers:
                du = law.b @ (q - start)
                memories[i] = law.after(memories[i], du)[0]
                ways[i] = du
    return q, memories


def _newton(model, free, load, start, q, memories, ways):
    """Newton's method, halved where what is out of balance grows."""
    pick = numpy.ix_(free, free)

    def balance(x):
        force, stiffness = load - model.K @ x, model.K.copy()
        terms = numpy.abs(load) + numpy.abs(model.K) @ numpy.abs(x)
        for part in model.sliders:
            f = part.stiffness * (part.b @ x)
            if abs(f) <= part.limit:
                stiffness += part.stiffness * numpy.outer(part.b, part.b)
            f = numpy.clip(f, -part.limit, part.limit)
            force, terms = force - f * part.b, terms + abs(f) * numpy.abs(part.b)
        for part in model.stops:
            depth = part.b @ x - part.gap
            if depth > 0:
                stiffness += part.stiffness * numpy.outer(part.b, part.b)
                f = part.stiffness * depth
                force, terms = force - f * part.b, terms + abs(f) * numpy.abs(part.b)
        for law, z, way in zip(model.laws, memories, ways):
            u = law.b @ x
            if law.remembers:
                now, slope = law.after(z, law.b @ (x - start))
                if slope is None:
                    slope = law.slope(z, 1.0 if way >= 0 else -1.0, 1.0 if z >= 0 else -1.0)
                f, k = law.force(u, 0.0, 0.0, now), law.alpha * law.k + (1 - law.alpha) * law.k * slope
            else:
                f, k = law.force(u, 0.0, 0.0, 0.0), law.tangents(u)[0]
            stiffness += k * numpy.outer(law.b, law.b)
            force, terms = force - f * law.b, terms + abs(f) * numpy.abs(law.b)
        return force[free], stiffness[pick], terms[free]
    if not free:
        return q
    out, stiffness, terms = balance(q)
    for _ in range(100):
        scale = 1 / numpy.sqrt(numpy.maximum(numpy.abs(numpy.diag(stiffness)), 1e-300))
        if numpy.max(numpy.abs(out) * scale) <= 2e-14 * max(numpy.max(terms * scale), 1e-300):
            return q
        try:
            step = numpy.linalg.solve(stiffness * scale[:, None] * scale[None, :], out * scale) * scale
        except numpy.linalg.LinAlgError:
            raise Unreadable("a singular state on the way to equilibrium") from None
        size, share = numpy.max(numpy.abs(out) * scale), 1.0
        for _ in range(12):
            new = q.copy()
            new[free] += share * step
            now = balance(new)
            if numpy.max(numpy.abs(now[0]) * scale) < size or share * numpy.max(numpy.abs(step)) < 1e-14 * numpy.max(numpy.abs(q)):
                break
            share /= 2
        q, (out, stiffness, terms) = new, now
        if numpy.max(numpy.abs(share * step)) <= 1e-15 * numpy.max(numpy.abs(q)):
            if numpy.max(numpy.abs(out) * scale) <= 1e-11 * numpy.max(terms * scale):
                return q
    if numpy.max(numpy.abs(out) * scale) <= 1e-11 * numpy.max(terms * scale):
        return q
    raise Unreadable("no equilibrium found on the way of the loads")
