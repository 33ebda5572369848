"""Static states: K q + sliders + stops = f, by trying every combination of contacts; there is one solution."""

import itertools

import numpy

from nonlinear import rest
from study import Unreadable


class Equilibrium:
    """q [n], forces of sliders and stops, reactions of what is held: by index."""
    memories = None

    def __init__(self, q, slider_forces, stop_forces, reactions):
        self.q, self.slider_forces, self.stop_forces, self.reactions = q, slider_forces, stop_forces, reactions


def equilibrium(model, held=None):
    """`held`: the names of the displacements that are held; all unless given."""
    fixed = {i: value for i, value, name in model.held_displacements if held is None or name in held}
    fixed.update({i: law.motion(0.0, -1)[0] for i, law in model.moving})
    n = len(model.names)
    load = model.load(0.0, -1) + model.held
    if model.laws:
        return rest.equilibrium(model, fixed, load)
    free = [i for i in range(n) if i not in fixed]
    q = numpy.zeros(n)
    for i, value in fixed.items():
        q[i] = value
    m, s = len(model.sliders), len(model.stops)
    if 3**m * 2**s > 20000:
        raise Unreadable("too many contacts for a static state by trying all")
    best = None
    for combination in itertools.product(*([[0, 1, -1]] * m + [[0, 1]] * s)):
        stiffness, force = model.K.copy(), load.copy()
        for state, slider in zip(combination[:m], model.sliders):
            if state == 0:
                stiffness += slider.stiffness * numpy.outer(slider.b, slider.b)
            else:
                force -= state * slider.limit * slider.b
        for state, stop in zip(combination[m:], model.stops):
            if state:
                stiffness += stop.stiffness * numpy.outer(stop.b, stop.b)
                force += stop.stiffness * stop.gap * stop.b
        x = q.copy()
        inner = stiffness[numpy.ix_(free, free)]
        if free:
            scale = 1 / numpy.sqrt(numpy.maximum(numpy.abs(numpy.diag(inner)), 1e-300))
            scaled = inner * scale[:, None] * scale[None, :]
            if numpy.linalg.cond(scaled) > 1e14:
                continue
            right = (force - stiffness @ q)[free]
            solution = numpy.linalg.solve(scaled, right * scale)
            solution += numpy.linalg.solve(scaled, right * scale - scaled @ solution)
            x[free] = solution * scale
        violation = 0.0
        for state, slider in zip(combination[:m], model.sliders):
            trial = slider.stiffness * (slider.b @ x) / slider.limit
            violation = max(violation, abs(trial) - 1 if state == 0 else 1 - state * trial)
        for state, stop in zip(combination[m:], model.stops):
            depth = stop.b @ x - stop.gap
            size = abs(stop.gap) + numpy.abs(stop.b) @ numpy.abs(x) + 1e-300
            violation = max(violation, (-depth if state else depth) / size)
        if best is None or violation < best[0]:
            best = (violation, x)
        if violation <= 0:
            break
    if best is None or best[0] > 1e-9:
        raise Unreadable("no equilibrium found")
    x = best[1]
    slider_forces = [float(numpy.clip(slider.stiffness * (slider.b @ x), -slider.limit, slider.limit))
                     for slider in model.sliders]
    stop_forces = [float(max(0.0, stop.stiffness * (stop.b @ x - stop.gap))) for stop in model.stops]
    residual = model.K @ x - load
    for force, slider in zip(slider_forces, model.sliders):
        residual = residual + force * slider.b
    for force, stop in zip(stop_forces, model.stops):
        residual = residual + force * stop.b
    return Equilibrium(x, slider_forces, stop_forces, {i: residual[i] for i in fixed})
