"""Judges studies of methods: every column of their tables against marches of the oracle's own.

What may differ is round-off, which a march adds up: 1e-11 of the largest displacement, times the condition of the mass
and the steps of the stiffest motion; and the size, which is sampled here to 1e-6, or as finely as 10 million samples are.
"""

import math

import numpy

import methods
from verdicts import Table, worst

MOST_SAMPLES = 1e7
BORDER = 1e-6  # a spectral radius this near to 1 says nothing of stability: rigid motions have a double root there


def method_study(study, model, analysis, table, pairs):
    name = analysis["name"]
    problem = methods.Problem.of_model(model)
    observed = str(analysis.get("observe", model.names[0]))
    row = model.row(observed)
    step, duration = study.number(analysis["step"]), study.number(analysis["duration"])
    count = round(duration / step)
    listed = _listed(study, analysis)
    labels = table.text("method")
    checks = []
    marches = {}
    if listed is None:
        for method in methods.ALL:
            radius = problem.grows((method, {}), step)
            if method not in labels and radius < 1 + 1e-9 or method in labels and radius > 1 + BORDER:
                checks.append((f"{method} is {'in' if method in labels else 'left out'}, spectral radius - 1 = {radius - 1:.2g}", 1.0, 0.5))
            if method in labels:
                marches[method] = (method, {})
    else:
        marches = listed
        checks.append((f"methods {labels}", float(labels != list(listed)), 0.5))
    exact = problem.exact(0.25 * step, 4 * count, row)
    size, of_size = _largest(problem, 0.25 * step, 4 * count, row)
    if not size > 0:
        return worst(name, "method_study", checks + [("nothing moves", 0.0, 1.0)])
    round_off = 1e-11 * _condition(problem, step)
    for i, (label, method) in enumerate(marches.items()):
        if label not in labels:
            continue
        here = labels.index(label)
        checks.append((f"{label} order", abs(table.column("order")[here] - methods.order_of(method)), 0.5))
        checks += _errors(table, here, label, method, problem, row, step, count, exact, size, of_size, round_off)
    checks += _responses(table.path.with_suffix(".response.csv"), marches, observed, problem, row, step, exact[::4], size, round_off)
    checks += _ladder(study, analysis, table.path.with_suffix(".ladder.csv"), marches, problem, row, step, duration, size, of_size, round_off)
    checks += _stability(table.path.with_suffix(".stability.csv"), marches)
    checks += _unstable(table.path.with_suffix(".unstable.csv"), problem, row, size, round_off)
    return worst(name, "method_study", checks)


def _listed(study, analysis):
    """{label: (name, parameters)}; None where no methods are listed."""
    if "methods" not in analysis:
        return None
    found = {}
    parts = [m if isinstance(m, dict) else {"name": m} for m in analysis["methods"]]
    for part in parts:
        values = {k: study.number(v) for k, v in part.items() if k != "name"}
        label = part["name"]
        if sum(p["name"] == part["name"] for p in parts) > 1 and values:
            label += "(" + ";".join(f"{k}={v:.6g}" for k, v in sorted(values.items())) + ")"
        found[label] = (part["name"], values)
    return found


def _largest(problem, h, count, row):
    """|x| over the run, by samples and a parabola over the largest of them; and what is uncertain of it, relatively: all of
    what the samples miss where the fastest motion has more than a radian between them."""
    parts = int(min(max(math.ceil(h * _fastest(problem) / 0.05), 8), max(MOST_SAMPLES / count, 1)))
    y = numpy.abs(problem.exact_between(h, count, row, parts))
    k = int(numpy.argmax(y))
    largest = y[k]
    if 0 < k < len(y) - 1:
        bend = y[k - 1] - 2 * y[k] + y[k + 1]
        largest -= (y[k + 1] - y[k - 1])**2 / (8 * bend) if bend < 0 else 0.0
    turn = h / parts * _fastest(problem)
    missed = turn**4 / 100 if turn < 1 else 3 * (1 - numpy.max(y[::2]) / largest) if largest > 0 else 0.0
    return largest, 1e-6 + missed


def _fastest(problem):
    return math.sqrt(max(numpy.max(numpy.abs(numpy.linalg.eigvals(numpy.linalg.solve(problem.M, problem.K)))), 0.0))


def _condition(problem, step):
    """Of the round-off of a step."""
    scale = 1 / numpy.sqrt(numpy.diag(problem.M))
    return numpy.linalg.cond(problem.M * scale[:, None] * scale[None, :]) * max(1.0, _fastest(problem) * step)


def _errors(table, here, label, method, problem, row, step, count, exact, size, of_size, round_off):
    largest = []
    for level in (0, 1, 2):
        part = 1 << level
        x = problem.march(method, step / part, count * part, row)
        difference = numpy.abs(x - exact[::4 >> level])[1:]
        largest.append(numpy.max(difference) / size)
        if level == 0:
            mean, first = numpy.mean(difference) / size, difference[0]
    small = round_off + of_size * largest[0]
    yield f"{label} max_error", abs(table.column("max_error")[here] - largest[0]), small
    yield f"{label} mean_error", abs(table.column("mean_error")[here] - mean), small
    told = table.column("first_step_error")[here]
    if exact[4] != 0:
        yield f"{label} first_step_error", abs(told - first / abs(exact[4])), 1e-8 * first / abs(exact[4]) + round_off * size / abs(exact[4])
    observed = table.column("observed_order")[here]
    if largest[2] > 1e3 * round_off:
        yield f"{label} observed_order", abs(observed - math.log2(largest[1] / largest[2])), 1e-6 + 4 * round_off / largest[2]


def _responses(path, marches, observed, problem, row, step, exact, size, round_off):
    table = Table(path)
    times = table.column("time [s]")
    yield "times of the responses", numpy.max(numpy.abs(times - step * numpy.arange(len(times)))), 1e-9 * times[-1]
    yield "rows of the responses", abs(len(times) - 1 - min(len(exact) - 1, 3000)), 0.5
    head = next(h for h in table.head if h.startswith("exact."))
    there = exact[:len(times)]
    yield "the exact response", numpy.max(numpy.abs(table.column(head) - there)) / size, round_off
    for label, method in marches.items():
        for header in table.head:
            if header.startswith(label + "."):
                x = problem.march(method, step, len(times) - 1, row)
                wanted = x - there if ".difference" in header else x
                yield header, numpy.max(numpy.abs(table.column(header) - wanted)) / size, round_off + 1e-12 * numpy.max(numpy.abs(x)) / size


def _ladder(study, analysis, path, marches, problem, row, step, duration, size, of_size, round_off):
    table = Table(path)
    steps = table.column("step [s]")
    if "ladder" in analysis:
        wanted = sorted((study.number(h) for h in analysis["ladder"]), reverse=True)
    else:
        wanted = [h for h in (step * 2.0**k for k in range(5, -9, -1)) if duration / h >= 8 and duration / h <= 1e6]
    yield f"steps of the ladder {steps}", float(len(steps) != len(wanted)), 0.5
    for i, h in enumerate(wanted):
        count = math.floor(duration / h * (1 + 1e-9))
        thinned = max(1, count // 2000)
        exact = problem.exact(h * thinned, count // thinned, row)
        for label, method in marches.items():
            header = next(c for c in table.head if c.startswith(f"{label}.max_error"))
            told, radius = table.column(header)[i], problem.grows(method, h)
            if radius > 1 + BORDER:
                yield f"ladder, {label} at {h:.6g} s grows by {radius:.6g}", float(not numpy.isnan(told)), 0.5
            elif radius < 1 + 1e-9:
                x = problem.march(method, h, count // thinned, row, thinned)
                error = numpy.max(numpy.abs(x - exact)) / size
                if not (numpy.isnan(told) and error < round_off):
                    yield f"ladder, {label} at {h:.6g} s", abs(told - error), of_size * error + 10 * round_off


def _stability(path, marches):
    table = Table(path)
    turns = table.column("omega_h")
    yield "turns of the table of stability", numpy.max(numpy.abs(turns - 0.05 * numpy.arange(1, 201))), 1e-12
    for label, method in marches.items():
        radius = numpy.array([_radius(method, x) for x in turns])
        shown = {quantity: table.column(next(c for c in table.head if c.startswith(f"{label}.{quantity}")))
                 for quantity in ("spectral_radius", "period_elongation", "numerical_damping")}
        # beside a double root eigenvalues err by the root of round-off
        yield f"{label} spectral radius", numpy.max(numpy.abs(shown["spectral_radius"] / radius[:, 0] - 1)), 1e-6
        for k, quantity in enumerate(("period_elongation", "numerical_damping")):
            both = ~numpy.isnan(radius[:, k + 1]) & ~numpy.isnan(shown[quantity])
            yield f"{label} {quantity}", numpy.max(numpy.abs(shown[quantity] - radius[:, k + 1])[both], initial=0.0), 1e-6
            one = numpy.isnan(radius[:, k + 1]) != numpy.isnan(shown[quantity])
            yield f"{label} {quantity}: rows of one only", numpy.sum(one), 1.5


def _radius(method, x):
    problem = methods.Problem.of_mode(x * x)
    n = 2 if method[0] in methods.TABLEAUS or method[0] == "exponential" else 3
    values = numpy.linalg.eigvals(problem.step(method, 1.0)[:n, :n])
    above = [s for s in values if s.imag > 1e-7]
    if not above:
        return numpy.max(numpy.abs(values)), math.nan, math.nan
    s = min(above, key=lambda s: abs(s - numpy.exp(1j * x)))
    decay, turn = -math.log(abs(s)), math.atan2(s.imag, s.real)
    return numpy.max(numpy.abs(values)), x / turn - 1, decay / math.hypot(decay, turn)


def _unstable(path, problem, row, size, round_off):
    """Explicit Euler a tenth beyond its limit, which is that of all eigenvalues of the first-order form."""
    if not path.exists():
        return
    table = Table(path)
    n = problem.n
    h = table.column("time [s]")[1]
    form = numpy.block([[numpy.zeros((n, n)), numpy.eye(n)],
                        [-numpy.linalg.solve(problem.M, problem.K), -numpy.linalg.solve(problem.M, problem.C)]])
    s = numpy.linalg.eigvals(form)
    s = s[numpy.abs(s) > 1e-7 * numpy.max(numpy.abs(s))]  # what nothing holds grows by no step
    limits = -2 * s.real / numpy.abs(s)**2
    limit, turn = numpy.min(limits), h / 1.1 * abs(s[numpy.argmin(limits)])
    # a growth of 1e-9 a step is not told from none
    yield f"limit of explicit Euler {h / 1.1:.6g}, eigenvalues say {limit:.6g}", abs(h / 1.1 / limit - 1), 1e-6 + 4e-9 / turn**2
    x = problem.march(("explicit_euler", {}), h, len(table.rows) - 1, row)
    exact = problem.exact(h, len(table.rows) - 1, row)
    header = next(c for c in table.head if c.startswith("explicit_euler.") and "difference" not in c)
    scale = max(numpy.max(numpy.abs(x)), size)
    yield "explicit Euler beyond its limit", numpy.max(numpy.abs(table.column(header) - x)) / scale, 1e-8 + round_off
    header = next(c for c in table.head if c.startswith("exact."))
    yield "the exact response beside it", numpy.max(numpy.abs(table.column(header) - exact)) / size, round_off
