"""Transients: the flow from the start of the study, seen at the times of the rows of the command."""

import numpy

from flow import Flow
from nonlinear.march import March
from statics import equilibrium


def start_of(model, analysis):
    """q, v, and the slips of the sliders at t = 0."""
    if analysis.get("initial", "given") == "static":
        held = [str(name) for name in analysis["displacements"]] if "displacements" in analysis else None
        state = equilibrium(model, held)
        slips = [slider.b @ state.q - force / slider.stiffness
                 for slider, force in zip(model.sliders, state.slider_forces)]
        return state.q, model.v0.copy(), slips, state.memories
    return model.q0.copy(), model.v0.copy(), [slider.b @ model.q0 for slider in model.sliders], None


def begin(model, analysis, end, **options):
    q, v, slips, memories = start_of(model, analysis)
    if model.laws:
        return March(model, 0.0, end, q, v, slips, memories, **options)
    return Flow(model, 0.0, end, q, v, slips, **options)


def march(model, analysis, times, **options):
    """Arrays [times x ...]: q, v, a, slider forces, slips, stop forces, friction work, what laws tell; and the flow at its end."""
    flow = begin(model, analysis, times[-1], **options)
    rows = {key: [] for key in ("q", "v", "a", "slider_force", "slip", "stop_force", "slid", "law_displacement",
                                  "law_force", "law_stored", "law_dissipated")}
    for t in times:
        flow.advance(t)
        q, v = flow.full()
        rows["q"].append(q)
        rows["v"].append(v)
        rows["a"].append(flow.acceleration())
        rows["slider_force"].append([flow.slider_force(i) for i in range(len(model.sliders))])
        rows["slip"].append([flow.slip(i) for i in range(len(model.sliders))])
        rows["slid"].append(sum(flow.slid))
        rows["stop_force"].append([flow.stop_force(i) for i in range(len(model.stops))])
        for key, value in zip(("law_displacement", "law_force", "law_stored", "law_dissipated"), flow.law_row() if model.laws else ()):
            rows[key].append(value)
    return {key: numpy.array(value) for key, value in rows.items()}, flow
