"""A damper curve against frequency responses with the same parameters, and its optimum against a fine sweep.

The curve is found on `periodic` orbits, and so are the responses: a point of the curve is the response there to 1e-6, no response in its
range of frequencies is higher, and no value of the curve or near the optimum is lower than it (a second valley between two values
of the range is not seen by it). What lies between the frequencies of a scan may be missed by both; the scan here is four
times as fine as that of the curve.
"""

import numpy

from cross_checks.command import NoAnswer, run, table
from cross_checks.structures import Structure

POINTS = 17


def study(seed, folder):
    made = Structure(seed, folder, contacts=("slider",), kinds=("lumped",))
    made.damped(0.01, 0.1)
    made.tables["parameters"].update({"Omega": made.omega, "N": 1.0})
    if "slider" not in made.tables:
        made.tables["slider"] = [{"name": "slider 0", "between": [made.names[-1], "ground"], "stiffness": made.stiffness,
                                  "friction_coefficient": 0.3, "normal_load": "N"}]
    made.load = made.stiffness * made.x
    made.tables["slider"] = made.tables["slider"][:2]
    for part in made.tables["slider"]:
        part["normal_load"] = f"{made.load:.8g}*N"
    made.pushed = made.random.choice(made.names)
    made.tables["force"] = [{"on": made.pushed, "amplitude": made.load, "angular_frequency": "Omega"}]
    if made.chance(0.3):
        made.tables["force"].append({"on": made.random.choice(made.names), "amplitude": 0.5 * made.load, "angular_frequency": "Omega",
                                     "phase": made.uniform(-3, 3)})
    return made


def check(command, seed, folder):
    made = study(seed, folder)
    low, high = 0.3 * made.omega, 2.5 * made.omega
    top = made.log(2, 10)
    curve = {"name": "curve", "type": "damper_curve", "solver": "periodic", "parameter": "N", "excitation": "Omega",
             "range": {"from": 0.05 * top, "to": top, "points": 6}, "angular_frequency": {"from": low, "to": high, "points": POINTS},
             "observe": [made.pushed] if made.chance(0.5) else made.names}
    observed = curve["observe"]
    results = run(command, made.write([curve]), folder / "curve")
    rows = table(results, "curve")
    values, peaks, objective = rows.column("N"), rows.column("angular_frequency [rad/s]"), rows.column(
        next(h for h in rows.head if h.startswith("objective")))
    found = []
    known = [i for i in range(len(values)) if rows.text("status")[i] == "converged"]
    if not known:
        raise NoAnswer("skipped", "no point converged")
    if not numpy.all(objective[known] > 0):
        raise NoAnswer("skipped", "what is observed does not move")
    for i in known[::2]:
        there, amplitudes = response(command, made, values[i], [peaks[i]], observed, folder / f"peak{i}")
        found.append((f"N = {values[i]:g}: objective", abs(numpy.max(there) / objective[i] - 1), 1e-6))
        found += [(f"N = {values[i]:g}: {head}", abs(rows.column(head)[i] - amplitudes[head][0]) / objective[i], 1e-6)
                  for head in amplitudes]
        scan, _ = response(command, made, values[i], numpy.linspace(low, high, 4 * POINTS), observed, folder / f"scan{i}")
        found.append((f"N = {values[i]:g}: a higher response", max(numpy.max(scan) / objective[i] - 1, 0), 1e-6))
    best = table(results, "curve.optimum")
    if best.rows and best.text("status")[0] == "converged":
        at, least = best.column("N")[0], best.column(next(h for h in best.head if h.startswith("objective")))[0]
        there, _ = response(command, made, at, [best.column("angular_frequency [rad/s]")[0]], observed, folder / "optimum")
        found.append(("optimum: objective", abs(numpy.max(there) / least - 1), 1e-6))
        found.append(("optimum: a lower point of the curve", max(1 - numpy.min(objective[known]) / least, 0), 1e-6))
        fine = [float(v) for v in numpy.unique(at * numpy.linspace(0.96, 1.04, 9)) if 0.05 * top <= v <= top]
        sweep = {**curve, "range": fine, "optimum": False}
        finer = table(run(command, made.write([sweep], "fine.toml"), folder / "fine"), "curve")
        ok = numpy.array([s == "converged" for s in finer.text("status")])
        lowest = finer.column(next(h for h in finer.head if h.startswith("objective")))[ok]
        found.append(("optimum: a lower point of a fine sweep", max(1 - numpy.min(lowest) / least, 0), 1e-6))
    return found


def response(command, made, load, frequencies, observed, folder):
    """The largest amplitude at each frequency, and all by their columns; not those that did not converge."""
    part = {"name": "response", "type": "frequency_response", "excitation": "Omega", "angular_frequency": [float(w) for w in frequencies],
            "observe": observed}
    rows = table(run(command, made.write([part], f"{folder.name}.toml"), folder, "--set", f"N={load!r}"), "response")
    ok = numpy.array([s == "converged" for s in rows.text("status")])
    if not numpy.any(ok):
        raise NoAnswer("skipped", "no response converged")
    amplitudes = {f"{name}.amplitude [m]": rows.column(f"{name}.amplitude [m]")[ok] for name in observed}
    return numpy.max(list(amplitudes.values()), axis=0), amplitudes
