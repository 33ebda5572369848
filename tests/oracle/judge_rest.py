"""Judges static states and natural modes."""

import numpy

import judge_laws
import modes
import statics
from verdicts import columns_of, condition_of, worst


def static(study, model, analysis, table, pairs):
    name = analysis["name"]
    held = [str(n) for n in analysis["displacements"]] if "displacements" in analysis else None
    state = statics.equilibrium(model, held)
    energy = 0.5 * abs(state.q @ model.K @ state.q)
    condition = condition_of(model.stuck_stiffness())
    allowed = 1e-9 + 1e-14 * min(condition, 1e12)
    checks = []
    weights = numpy.sqrt(numpy.abs(numpy.diag(model.stuck_stiffness())))
    size = max(numpy.max(numpy.abs(state.q) * weights), 1e-20)
    for i, coordinate in enumerate(model.names):
        header = columns_of(model, coordinate)[0]
        if table.has(header):
            checks.append((header, abs(table.column(header)[0] - state.q[i]) * weights[i] / size, allowed))
    for text in analysis.get("observe", []) if isinstance(analysis.get("observe"), list) else []:
        if " - " in str(text) and table.has(f"{text}.position [m]"):
            whole = max(numpy.max(numpy.abs(state.q)), 1e-300)
            checks.append((text, abs(table.column(f"{text}.position [m]")[0] - model.row(text) @ state.q) / whole, 10 * allowed))
    if "observe" in analysis:
        named = {str(o) for o in (analysis["observe"] if isinstance(analysis["observe"], list) else [analysis["observe"]])}
        told = {n for n in model.names if table.has(columns_of(model, n)[0])}
        checks.append((f"columns of {told}, not of {named}", float(told != named & set(model.names)), 0.5))
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
    if model.laws:
        allowed = max(allowed, 10 * model.turns_back)
        checks = [(what, error, max(limit, allowed)) for what, error, limit in checks]
        checks += judge_laws.static(model, state, table, allowed)
    forces = numpy.abs(model.K) @ numpy.abs(state.q) + numpy.abs(model.load(0.0, -1))
    for i, reaction in state.reactions.items():
        for header in (f"{model.names[i]}.reaction [N]", f"{model.names[i]}.reaction_moment [N m]"):
            if table.has(header):
                checks.append((header, abs(table.column(header)[0] - reaction) / max(forces[i], 1e-300), allowed))
    del energy
    return worst(name, "static", checks)


def natural_modes(study, model, analysis, table, pairs):
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
        undamped = not numpy.any(damping)
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
    return worst(name, "modes", checks)
