"""Judges transients: the exact flow, automatic steps by their tolerance, equal steps by their order; and energies."""

import re

import numpy

import judge_laws
import transient as marches
from verdicts import Table, Verdict, columns_of, worst


def transient(study, model, analysis, table, pairs):
    name = analysis["name"]
    times = table.column("time [s]")
    duration = study.number(analysis["duration"])
    checks = []
    output = analysis.get("output", {})
    if not abs(times[-1] - duration) <= 1e-9 * duration and not set(output) & {"interval", "times"}:
        return Verdict(name, "transient", "failed", f"ends at {times[-1]} of {duration}")
    pick = numpy.unique(numpy.linspace(0, len(times) - 1, 60).astype(int))
    rows, flow = marches.march(model, analysis, list(times[pick]))
    observed = [i for i, c in enumerate(model.names) if table.has(columns_of(model, c)[0])]
    for text in analysis.get("observe", []) if isinstance(analysis.get("observe"), list) else []:
        header = f"{text}.position [m]"
        if " - " in str(text) and table.has(header):
            row = model.row(text)
            size = max(numpy.max(numpy.abs(rows["q"]) @ numpy.abs(row)), 1e-300)
            checks.append((header, numpy.max(numpy.abs(table.column(header)[pick] - rows["q"] @ row)) / size,
                           _loosely(study, analysis, model)))
    if not observed:
        return worst(name, "transient", checks)
    free = [i for i in observed if i not in [j for j, _ in model.moving]]
    weights = numpy.sqrt(numpy.diag(model.M))
    got = {key: rows[key].copy() for key in ("q", "v", "a")}
    for i in observed:
        for key, header in zip(("q", "v", "a"), columns_of(model, model.names[i])):
            got[key][:, i] = table.column(header)[pick]

    def error(key):
        whole = numpy.max(numpy.linalg.norm(rows[key][:, observed] * weights[observed], axis=1))
        if key == "v":  # at rest there is round-off alone
            whole = max(whole, 1e-7 * flow.fastest * numpy.max(numpy.linalg.norm(rows["q"] * weights, axis=1)))
        return (numpy.max(numpy.linalg.norm((got[key] - rows[key])[:, free] * weights[free], axis=1))
                / max(whole, 1e-300)) if free else 0.0
    moving = [i for i, _ in model.moving]
    for i in moving:
        if i in observed:
            for key, header in zip(("q", "v", "a"), columns_of(model, model.names[i])):
                size = max(numpy.max(numpy.abs(rows[key][:, i])), 1e-300)
                checks.append((f"{header} (moved)", numpy.max(numpy.abs(got[key][:, i] - rows[key][:, i])) / size, 1e-9))
    kinks = any(law.remembers or law.decisions(0.0, 0.0, 0.0) for law in model.laws)
    contacts = bool(model.sliders or model.stops or kinks)
    whole = len(observed) == len(model.names)
    method = analysis.get("method", "generalized_alpha")
    method = method["name"] if isinstance(method, dict) else method
    step = analysis.get("step")
    e = error("q")
    if method == "exact":
        checks.append(("position", e, 1e-7 if contacts else 1e-8))
        checks.append(("velocity", error("v"), 1e-6 if contacts else 1e-8))
        if free == moving_free(model):
            checks += _energies(model, table, got, pick, rows, 1e-5 if contacts else 1e-7)
    elif isinstance(step, dict):
        tolerance = study.number(step["tolerance"])
        pair = method in ("dormand_prince", "bogacki_shampine")
        located = step.get("events") == "locate" or step.get("events") != "pass" and (pair or not model.sliders)
        factor = 10 if not contacts else 50 if located else 300
        allowed = factor * tolerance + 1e-9
        if step.get("controller", "pi") != "pi" or step.get("estimator") == "inertia_jump":
            if step.get("controller") == "fixed" and step.get("estimator") != "inertia_jump" and not re.search(
                    rf'analysis "{re.escape(name)}": the tolerance .* is not met', study.told):
                checks.append(("position, and no word that the tolerance is not met", e, allowed))
            allowed = 2.0  # its tolerance is not that of the error, or it only watches
        elif set(output) & {"interval", "times"}:
            allowed = 2 * allowed + 1e-3
        checks.append(("position", e, allowed))
        if not contacts and not analysis.get("allow_unstable"):  # what is out of phase errs by twice its amplitude, and not by more
            checks.append(("velocity", error("v"), 2.5))
        ledger = max(2 * allowed + 1e-9, 5e-3 if contacts else 0.0)  # works are sums over steps
        checks += _energies(model, table, got, pick, rows, ledger) if free == moving_free(model) and allowed < 1 else []
        checks += judge_laws.transient(model, table, rows, got, pick, times[pick], allowed, whole,
                                       not set(output) & {"interval", "times"})
    else:
        pair = pairs.setdefault(name.split("@")[0], [])
        pair.append((study.number(step), e, analysis.get("method")))
        if len(pair) == 2:
            (h1, e1, method1), (h2, e2, method2) = sorted(pair, key=lambda run: -run[0])
            order, aligned = _order(method, analysis), True
            for law in [law for _, law in model.loads] + [law for _, law in model.moving]:
                for t in law.switches(0.0, duration):
                    if abs(t / h1 - round(t / h1)) < 1e-6:
                        continue
                    jump = abs(law.value(t, 1) - law.value(t, -1)) > 1e-6 * abs(law.value(t, 1))
                    order, aligned = min(order, 0 if jump else 2), False
            if e1 > 0.3 or not numpy.isfinite(e1):
                return Verdict(name, "transient", "skipped", f"step {h1:g} is too long (error {e1:.2g})")
            fastest = max(flow.fastest, numpy.sqrt(max(flow.squares[-1], 0.0)))
            if h1**2 * fastest**3 * duration > 10 and fastest * h2 > 1e-3 * order:
                order = 0  # the fastest mode is out of phase, by how much is chance
            factor = 8 if method1 != method2 else 1.6 if aligned else 2.5  # of two parameters the constants differ
            limit = 0.9 * e1 if contacts and order else factor * e1 * (h2 / h1)**order
            if order == 0 and not contacts:  # where a jump lies in its step, and what phase a fast mode has, is chance
                limit = 0.3
            checks.append((f"error at half the step (order {order})", e2, max(limit, 3e-3 if model.sliders or model.stops else 1e-5 if kinks else 2e-7)))
            checks += judge_laws.transient(model, table, rows, got, pick, times[pick], 3 * limit + 1e-6, whole, True, h2)
        else:
            return None
    return worst(name, "transient", checks)


def moving_free(model):
    moved = [i for i, _ in model.moving]
    return [i for i in range(len(model.names)) if i not in moved]


def _loosely(study, analysis, model):
    step = analysis.get("step")
    return 0.5 if not isinstance(step, dict) or model.sliders or model.stops else max(0.05, 100 * study.number(step["tolerance"]))


def _energies(model, table, got, pick, rows, allowed):
    """The ledger: what is stored, by the rows themselves; what friction took, by the oracle's motion."""
    path = table.path.with_suffix(".energy.csv")
    if not path.exists():
        return []
    ledger = Table(path)
    if len(ledger.rows) != len(table.rows):
        return []

    def own(part, quantity, units):
        header = next((h for h in (f"{part.name}.{quantity} [{unit}]" for unit in units) if table.has(h)), None)
        return table.column(header)[pick] if header else numpy.zeros(len(pick))
    slid = rows["slid"]
    kinetic = 0.5 * numpy.einsum("ti,ij,tj->t", got["v"], model.M, got["v"])
    strain = 0.5 * numpy.einsum("ti,ij,tj->t", got["q"], model.K, got["q"])
    terms = 0.5 * numpy.einsum("ti,ij,tj->t", numpy.abs(got["q"]), numpy.abs(model.K), numpy.abs(got["q"]))
    stored = sum((0.5 * own(s, "force", ("N", "N m"))**2 / s.stiffness for s in model.sliders),
                 numpy.zeros(len(pick)))
    pushed = sum((0.5 * s.stiffness * own(s, "penetration", ("m", "rad"))**2 * (own(s, "force", ("N", "N m")) > 0)
                  for s in model.stops), numpy.zeros(len(pick)))
    whole = max(numpy.max(kinetic + strain + stored), numpy.max(slid), 1e-300)
    checks = []
    for header, value, limit in (("kinetic", kinetic, 1e-9), ("strain", strain, 1e-9 + 1e-13 * numpy.max(terms) / whole),
                                 ("slider_stored", stored, 1e-9), ("slider_dissipated", slid, allowed),
                                 ("stop_stored", pushed, 1e-9)):
        if ledger.has(f"{header} [J]"):
            error = numpy.max(numpy.abs(ledger.column(f"{header} [J]")[pick] - value)) / whole
            checks.append((f"energy {header}", error, limit))
    if model.laws:
        checks += judge_laws.ledger(table, ledger, rows, pick, whole, allowed)
    return checks


_ORDERS = {"explicit_euler": 1, "damped_newmark": 1, "galerkin": 1, "backward_difference": 1, "newmark": 1, "rk3": 3,
           "bogacki_shampine": 3, "rk4": 4, "dormand_prince": 5}


def _order(method, analysis):
    return _ORDERS.get(method, 2)
