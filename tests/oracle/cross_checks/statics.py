"""A static state against the end of a transient whose loads grow slowly and whose motion is damped strongly.

The static state begins with sliders unloaded, and each moves once: where every slider of the transient has slipped one way only, and
has not let go of what it slipped by, its end is that state. (Motions that die away at different rates may drag a slider beyond its end.) At rest the steps err by nothing; what may
differ is what has not died away, which the last speed tells, and of sliders how far the motion went beyond its end.
"""

import math

import numpy

from cross_checks.command import NoAnswer, coordinates, motions, run, table
from cross_checks.structures import Structure, rates

GROWS = 6      # time constants of the slowest motion in which the loads grow
SETTLES = 24   # and in which they stand


def study(seed, folder):
    made = Structure(seed, folder)
    made.tables["damping"] = {"rayleigh": {"mass": made.omega * made.log(1, 4), "stiffness": made.log(0.3, 3) / made.omega}}
    made.tables.get("matrices", {}).pop("damping", None)
    made.tables["parameters"]["grown"] = 1.0

    def law(size):
        return {"expression": f"{size * made.sign():.8g}*grown"}
    for _ in range(made.random.choice([1, 1, 2, 3])):
        made.force(law, made.log(0.05, 2))
    if made.frames and made.chance(0.4):
        made.tables["gravity"] = {"acceleration": [0.0, f"{-0.5 * made.x * made.omega**2:.8g}*grown", 0.0][:len(made.tables["node"][-1]["position"])]}
    else:
        made.tables.pop("gravity", None)
    if made.chance(0.15) and len(made.names) > 1 and not {"slider", "stop"} & set(made.tables):
        made.tables["displacement"] = [{"on": made.names[-1], "expression": f"{made.x * made.sign():.8g}*grown"}]
    return made


def check(command, seed, folder):
    made = study(seed, folder)
    try:
        model = made.model()
        slowest = float(numpy.min(-rates(model).real))
    except numpy.linalg.LinAlgError:
        raise NoAnswer("skipped", "no mass somewhere") from None
    still = run(command, made.write([{"name": "rest", "type": "static"}]), folder / "static")
    if not slowest > 1e-6 * made.omega:
        raise NoAnswer("skipped", "a motion that does not die away")
    grows = GROWS / slowest
    duration = grows + SETTLES / slowest
    # gravity takes no formula of t: it acts in full from the start, and so does all, where it acts
    ramp = "1" if "gravity" in made.tables else f"(t < {grows!r} ? (1 - cos(pi*t/{grows!r}))/2 : 1)"
    tables = {key: [_grown(part, ramp) for part in made.tables[key]] for key in ("force", "distributed_force", "displacement")
              if key in made.tables}
    if "base_motion" in made.tables:
        tables["base_motion"] = _grown(made.tables["base_motion"], ramp)
    part = {"name": "end", "type": "transient", "duration": duration, "energy": False,
            "step": {"tolerance": 1e-5, **({"events": "locate"} if "slider" in made.tables else {})},
            "output": {"interval": duration / 200}}
    moved = table(run(command, made.write([part], "grown.toml", **tables), folder / "end"), "end")
    rest = table(still, "rest")
    names = [n for n in coordinates(moved) if rest.has(n[0] + (".angle [rad]" if n[1] else ".position [m]"))]
    size = numpy.max(numpy.abs(motions(moved, names)[0]))
    for head in moved.head:
        if head.endswith((".slip [m]", ".slip_angle [rad]")):
            slip = moved.column(head)
            back = min(numpy.max(numpy.maximum.accumulate(s) - s) for s in (slip, -slip))
            if back > 1e-6 * max(numpy.max(numpy.abs(slip)), 1e-300):
                raise NoAnswer("skipped", "a slider slips to and fro")
            force = numpy.abs(moved.column(_force_of(head)))
            has_slipped = numpy.max(numpy.abs(slip)) > 1e-9 * size
            if has_slipped and force[-1] < (1 - 1e-6) * numpy.max(force):
                raise NoAnswer("skipped", "a slider has slipped beyond its end")
    return list(_differences(model, names, moved, rest, slowest, bool(model.sliders or model.stops)))


def _force_of(head):
    return head.replace(".slip_angle [rad]", ".moment [N m]").replace(".slip [m]", ".force [N]")


def _grown(part, ramp):
    return {**part, "expression": part["expression"].replace("grown", ramp)} if "expression" in part else part


def _differences(model, names, moved, rest, slowest, contacts):
    for turns in (False, True):
        some = [n for n in names if n[1] == turns]
        if not some:
            continue
        x, v, still = motions(moved, some), motions(moved, some, 1), motions(rest, some)[0]
        size = max(numpy.max(numpy.abs(x)), numpy.max(numpy.abs(still)), 1e-300)
        # what is left of the slowest motion
        left = numpy.max(numpy.abs(v[-1])) / slowest / size
        if left > 1e-3:
            raise NoAnswer("skipped", f"the motion has not died away ({left:.1e})")
        allowed = (1e-5 if contacts else 1e-7) + 3 * left
        for k, (name, _) in enumerate(some):
            yield f"end of {name}", abs(x[-1, k] - still[k]) / size, allowed
    for slider in model.sliders:
        for head, limit in ((f"{slider.name}.force [N]", slider.limit), (f"{slider.name}.moment [N m]", slider.limit)):
            if rest.has(head) and moved.has(head):
                scale = max(limit, slider.stiffness * numpy.max(numpy.abs(motions(moved, [n for n in names])[-1])))
                yield head, abs(rest.column(head)[0] - moved.column(head)[-1]) / scale, 1e-5
    for stop in model.stops:
        for head in (f"{stop.name}.force [N]", f"{stop.name}.moment [N m]"):
            if rest.has(head) and moved.has(head):
                scale = stop.stiffness * (abs(stop.gap) + numpy.max(numpy.abs(motions(moved, names)[-1])))
                yield head, abs(rest.column(head)[0] - moved.column(head)[-1]) / scale, 1e-5
