"""Judges what is told of Bouc-Wen elements and nonlinear springs: displacements, forces, dissipated work, and their share of the ledger."""

import numpy

FORCES, DISPLACEMENTS = ("force [N]", "moment [N m]"), ("displacement [m]", "relative_angle [rad]", "angle [rad]", "displacement [rad]")


def header_of(table, law, quantities):
    """The column of a law under one of these names."""
    return next((f"{law.name}.{q}" for q in quantities if table.has(f"{law.name}.{q}")), None)


def _column(table, law, quantities, checks):
    header = header_of(table, law, quantities)
    if header is None:
        checks.append((f"{law.name}: no column {quantities[0]}", 1.0, 0.5))
        return None, None
    return header, table.column(header)


def static(model, state, table, allowed):
    checks = []
    size = max(numpy.max(numpy.abs(state.q)), 1e-300)
    for law, u, f in zip(model.laws, state.law_displacements, state.law_forces):
        header, told = _column(table, law, DISPLACEMENTS, checks)
        if header:
            checks.append((header, abs(told[0] - u) / (numpy.abs(law.b) @ numpy.abs(state.q) + 1e-12 * size), 10 * allowed))
        header, told = _column(table, law, FORCES, checks)
        if header:
            stiff = abs(law.tangents(0.0)[0]) + (abs(f / u) if u else 0.0)
            whole = max(abs(f), stiff * size, 1e-300)
            checks.append((header, abs(told[0] - f) / whole, 10 * allowed))
    return checks


def transient(model, table, rows, got, pick, times, allowed, observed_all, ends, step=0.0):
    """`got`: q, v as told; `allowed`: of positions, over the largest; `ends`: whether rows stand at the ends of steps; `step`: where they
    are equal: what u goes on and back within a step in which it turns is not seen by an element that remembers."""
    checks = []
    exact = 1e-9 if ends else 2 * allowed + 1e-9
    nothing = 1e-9 * numpy.max(numpy.abs(rows["q"])), 1e-9 * max(numpy.max(numpy.abs(rows["law_force"])), numpy.max(
        numpy.abs(rows["q"] @ model.K)))
    if allowed >= 1:
        return checks
    for i, law in enumerate(model.laws):
        u = rows["law_displacement"][:, i]
        size_u = max(numpy.max(numpy.abs(u)), 1e-3 * numpy.max(numpy.abs(rows["q"]) @ numpy.abs(law.b)), nothing[0], 1e-300)
        header, told_u = _column(table, law, DISPLACEMENTS, checks)
        if header is None:
            continue
        told_u = told_u[pick]
        share = numpy.max(numpy.abs(rows["q"]) @ numpy.abs(law.b)) / size_u  # a small difference of large motions errs more
        checks.append((header, numpy.max(numpy.abs(told_u - u)) / size_u, 2 * allowed * max(1.0, share)))
        if observed_all:
            own = got["q"] @ law.b
            checks.append((f"{header} at the row told", numpy.max(numpy.abs(told_u - own)) / size_u, exact * max(1.0, share)))
        header, told_f = _column(table, law, FORCES, checks)
        if header is None:
            continue
        told_f = told_f[pick]
        f = rows["law_force"][:, i]
        size_f = max(numpy.max(numpy.abs(f)), nothing[1], 1e-300)
        if law.remembers:
            unseen = law.k * law.A * step**2 / 4 * numpy.max(numpy.abs(rows["a"] @ law.b))
            size_f = max(size_f, law.k * min(size_u, law.z_max))
            checks.append((header, numpy.max(numpy.abs(told_f - f)) / size_f, 5 * allowed * max(1.0, share) + unseen / size_f))
        elif observed_all:
            rate = got["v"] @ law.b
            own = numpy.array([_nearest_force(law, *now) for now in zip(told_u, rate, times, told_f)])
            checks.append((f"{header} at the row told", numpy.max(numpy.abs(told_f - own)) / size_f, 10 * exact * max(1.0, share)))
        header, told = _column(table, law, ("dissipated [J]",), checks)
        if header:
            lost, stored = rows["law_dissipated"][:, i], rows["law_stored"][:, i]
            whole = max(numpy.max(numpy.abs(lost)), numpy.ptp(stored), 1e-12 * size_u * size_f, 1e-300)
            checks.append((header, numpy.max(numpy.abs(told[pick] - lost)) / whole, max(10 * allowed, 1e-2 if step else 1e-6) * max(1.0, share)))
    return checks


def _nearest_force(law, u, rate, t, told):
    """At a switch in time the force before or after."""
    forces = [law.force(u, rate, t + d * max(abs(t), 1e-6), 0.0) for d in (0.0, -1e-13, 1e-13)]
    return min(forces, key=lambda f: abs(f - told))


def ledger(table, ledger_table, rows, pick, whole, allowed):
    """`law_stored` and `law_dissipated`."""
    checks = []
    stored, lost = rows["law_stored"].sum(axis=1), rows["law_dissipated"].sum(axis=1)
    whole = max(whole, numpy.max(numpy.abs(stored)), numpy.max(numpy.abs(lost)))
    for key, own in (("law_stored [J]", stored), ("law_dissipated [J]", lost)):
        if not ledger_table.has(key):
            checks.append((f"energy: no column {key}", 1.0, 0.5))
        else:
            checks.append((f"energy {key}", numpy.max(numpy.abs(ledger_table.column(key)[pick] - own)) / whole, allowed))
    return checks


def response(model, table, i, orbit, allowed):
    """Dissipated work over a period."""
    checks = []
    whole = max(numpy.max(numpy.abs(orbit["lost"])), numpy.sum(numpy.abs(orbit["slid"])), 1e-300)
    for law, lost in zip(model.laws, orbit["lost"]):
        header, told = _column(table, law, ("dissipated [J]",), checks)
        if header and (law.remembers or law.used & {"rate", "t"}):
            checks.append((f"row {i} {header}", abs(told[i] - lost) / whole, allowed))
    return checks
