"""A sweep against single runs with `--set`, and one job against two.

A line of a sweep is solved as it is alone, so that its rows are the same to the tolerance of its solver: round-off where the answer
is linear, 1e-9 of the amplitudes with `periodic`, else the tolerance itself. Two jobs change no byte.
"""

import filecmp

import numpy

from cross_checks.command import NoAnswer, run, table
from cross_checks import responses


def check(command, seed, folder):
    made = responses.study(seed, folder)
    made.tables["parameters"]["scale"] = 1.0
    swept = made.random.choice(["force", "spring", "damping"])
    for part in made.tables.get("force", [])[:1]:
        part["amplitude"] = f"{part['amplitude']!r}*scale" if swept == "force" else part["amplitude"]
    if swept == "spring" and "spring" in made.tables:
        part = made.tables["spring"][0]
        part["stiffness"] = f"({part['stiffness']})*scale"
    elif swept == "damping" and "modal_ratio" in made.tables.get("damping", {}):
        made.tables["damping"]["modal_ratio"] = f"{made.tables['damping']['modal_ratio']!r}*scale"
    else:
        (made.tables["force"] or made.tables["displacement"])[0]["phase"] = "0.3*scale"
    values = [1.0, 1.25, 0.8]
    analyses = [{**part, "angular_frequency": {"from": 0.4 * made.omega, "to": 2 * made.omega, "points": 9}}
                for part, _ in responses.solvers(made) if part["name"] != "time_marching"] or [
        {**responses.solvers(made)[0][0], "angular_frequency": [0.5 * made.omega, 1.1 * made.omega]}]
    whole = made.write([{**part, "sweep": {"scale": values}} for part in analyses] + [{"name": "rest", "type": "static"}])
    found = []
    for jobs in (1, 2):
        run(command, whole, folder / f"jobs{jobs}", jobs=jobs)
    for path in sorted((folder / "jobs1").glob("*.csv")):
        same = filecmp.cmp(path, folder / "jobs2" / path.name, shallow=False)
        found.append((f"{path.name} of one job and of two", 0.0 if same else 1.0, 0.0))
    single = made.write(analyses, "single.toml")
    for value in values:
        run(command, single, folder / f"set{value}", "--set", f"scale={value!r}")
        for part in analyses:
            found += _differences(table(folder / "jobs1", part["name"]), table(folder / f"set{value}", part["name"]), value,
                                  _limit(made, part))
    if not found:
        raise NoAnswer("skipped", "nothing to compare")
    return found


def _limit(made, part):
    if "slider" not in made.tables and "stop" not in made.tables and part["name"] != "time_marching":
        return 1e-12
    return {"linear": 1e-9, "periodic": 1e-9}.get(part["name"], part.get("tolerance", 1e-3))


def _differences(swept, alone, value, limit):
    rows = [i for i, v in enumerate(swept.column("scale")) if v == value]
    if len(rows) != len(alone.rows):
        yield f"scale = {value}: {len(rows)} rows, alone {len(alone.rows)}", 1.0, 0.0
        return
    different = sum(swept.text("status")[i] != alone.text("status")[k] for k, i in enumerate(rows))
    yield f"scale = {value}: status", float(different), 0.0
    good = [(i, k) for k, i in enumerate(rows) if swept.text("status")[i] == alone.text("status")[k] == "converged"]
    for head in alone.head:
        if "amplitude" in head and good:
            a, b = (t.column(head)[[p[n] for p in good]] for n, t in enumerate((swept, alone)))
            size = max(numpy.max(numpy.abs(b)), 1e-300)
            yield f"scale = {value}: {head}", numpy.max(numpy.abs(a - b)) / size, limit
