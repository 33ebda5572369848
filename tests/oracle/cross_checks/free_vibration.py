"""Modes against free vibrations that begin in one, or in all of them.

`q(t) = Re sum of c_k phi_k exp(s_k t)` with the shapes and eigenvalues that `modes` gives; the c_k fit the start, the transient is
`exact`, or marched. What may differ: of an eigenvalue round-off of the largest, and 1e-9, for each radian; and the error of the steps.
"""

import math

import numpy

from cross_checks.command import NoAnswer, coordinates, motions, run, table
from cross_checks.structures import Structure


def study(seed, folder):
    """A structure without loads; its sliders begin without force and stick, its stops stay open."""
    made = Structure(seed, folder, kinds=("lumped", "lumped", "matrices", "matrices", "plane", "space"))
    for key in ("gravity", "base_motion"):
        made.tables.pop(key, None)
    # springs and loads of contacts far beyond what a motion of 1e-6 x asks of them
    for part in made.tables.get("stop", []):
        part["gap"] = made.x
    way = made.random.choice(["undamped", "undamped", "damped", "damped", "as it is"])
    if way == "undamped":
        made.undamped()
    elif way == "damped":
        made.damped(1e-3, 0.5)
    if made.frames:
        made.tables.pop("nodes", None)
    return made


def shapes(rows, names):
    """The shapes [modes x names] of the rows of a table of modes, complex."""
    found = []
    for name, turns in names:
        word = ".angle_shape" if turns else ".shape"
        unit = " [rad/(m sqrt(kg))]" if turns else " [1/sqrt(kg)]"
        real = rows.column(name + word + unit)
        imaginary = rows.column(name + word + "_imaginary" + unit) if rows.has(name + word + "_imaginary" + unit) else 0 * real
        found.append(real + 1j * numpy.nan_to_num(imaginary))
    return numpy.array(found).T


def check(command, seed, folder):
    made = study(seed, folder)
    modes = table(run(command, made.write([{"name": "modes", "type": "modes"}]), folder / "modes"), "modes")
    limit = "stuck" if "slider" in made.tables else "free"
    mine = [i for i, word in enumerate(modes.text("limit")) if word == limit]
    heads = [(h[: -len(w)], turns) for h in modes.head
             for w, turns in ((".shape [1/sqrt(kg)]", False), (".angle_shape [rad/(m sqrt(kg))]", True)) if h.endswith(w)]
    phi = shapes(modes, heads)[mine]
    s = (modes.column("eigenvalue_real [1/s]") + 1j * modes.column("eigenvalue_imaginary [rad/s]"))[mine]
    if made.kind == "lumped" or made.kind == "matrices":
        return _in_all_modes(command, made, folder, heads, phi, s, limit)
    return _in_one_mode(command, made, folder, heads, phi, s)


def _start(made, heads, q, v):
    """The tables with a start written into them."""
    at = {name: (float(a), float(b)) for (name, _), a, b in zip(heads, q, v)}
    if made.kind == "matrices":
        return {"matrices": {**made.tables["matrices"], "position": {n: a for n, (a, _) in at.items()},
                             "velocity": {n: b for n, (_, b) in at.items()}}}
    return {"coordinate": [{**part, "position": at[part["name"]][0], "velocity": at[part["name"]][1]} for part in made.tables["coordinate"]]}


def _in_all_modes(command, made, folder, heads, phi, s, limit):
    n = len(heads)
    if len(s) < n or numpy.any(s.imag <= 0):
        raise NoAnswer("skipped", "not all modes swing")
    random = numpy.random.default_rng(made.random.randrange(10**9))
    size = 1e-6 * made.x
    one = made.chance(0.4)
    if one:
        k = random.integers(n)
        c = numpy.zeros(n, dtype=complex)
        c[k] = size / numpy.max(numpy.abs(phi[k]))
        if limit == "stuck":
            c = c * 1j * numpy.exp(-1j * numpy.angle(phi[k, numpy.argmax(numpy.abs(phi[k]))]))
        q, v = (phi.T @ c).real, (phi.T @ (s * c)).real
        if limit == "stuck" and numpy.max(numpy.abs(q)) > 1e-9 * size:
            one = False
    if not one:
        q = numpy.zeros(n) if limit == "stuck" else random.uniform(-1, 1, n) * size
        v = random.uniform(-1, 1, n) * size * made.omega
        # Re sum c_k phi_k = q, Re sum c_k s_k phi_k = v: real unknowns (Re c, Im c)
        a, b = phi.T, (phi * s[:, None]).T
        system = numpy.block([[a.real, -a.imag], [b.real, -b.imag]])
        scale = numpy.concatenate([numpy.ones(n), numpy.full(n, 1 / made.omega)])
        weights = numpy.maximum(numpy.linalg.norm(system * scale[:, None], axis=0), 1e-300)
        solved = numpy.linalg.lstsq(system * scale[:, None] / weights, numpy.concatenate([q, v]) * scale, rcond=1e-13)[0] / weights
        c = solved[:n] + 1j * solved[n:]
    duration = 2 * math.pi / made.omega * made.uniform(2, 6)
    return _compare(command, made, folder, heads, phi, s, c, _start(made, heads, q, v), duration, one)


def _in_one_mode(command, made, folder, heads, phi, s):
    """Nodes take speeds only: a mode with a real shape passes through rest in them."""
    real = [k for k in range(len(s)) if s[k].imag > 0 and numpy.max(numpy.abs(phi[k].imag)) < 1e-9 * numpy.max(numpy.abs(phi[k]))]
    if any(":" in name for name, _ in heads) or not real:
        raise NoAnswer("skipped", "a start of nodes within beams, or no real shape")
    k = real[made.random.randrange(min(3, len(real)))]
    c = numpy.zeros(len(s), dtype=complex)
    c[k] = -1j * 1e-6 * made.x / numpy.max(numpy.abs(phi[k]))
    v = dict(zip((name for name, _ in heads), (phi.T @ (s * c)).real))
    space = len(made.tables["node"][-1]["position"]) == 3
    nodes = []
    for node in made.tables["node"]:
        node = dict(node)
        node["velocity"] = [float(v.get(f"{node['name']}.{axis}", 0.0)) for axis in ("xyz" if space else "xy")]
        turn = [float(v.get(f"{node['name']}.r{axis}", 0.0)) for axis in ("xyz" if space else "z")]
        if any(turn):
            node["angular_velocity"] = turn if space else turn[0]
        nodes.append(node)
    duration = 2 * math.pi / abs(s[k]) * made.uniform(2, 6)
    return _compare(command, made, folder, heads, phi, s, c, {"node": nodes}, duration, True)


def _compare(command, made, folder, heads, phi, s, c, start, duration, one):
    tolerance = None if made.chance(0.5) and "stop" not in made.tables else 1e-6
    part = {"name": "swing", "type": "transient", "duration": duration, "energy": False, "output": {"interval": duration / 60}}
    part.update({"method": "exact"} if tolerance is None else {"step": {"tolerance": tolerance}})
    rows = table(run(command, made.write([part], "swing.toml", **start), folder / "swing"), "swing")
    for head in rows.head:
        if head.endswith((".slip [m]", ".slip_angle [rad]")) and numpy.any(numpy.abs(rows.column(head)) > 1e-9 * 1e-6 * made.x):
            raise NoAnswer("skipped", "a slider slips")
    t = rows.column("time [s]")
    names = [n for n in heads if n in coordinates(rows)]
    pick = [heads.index(n) for n in names]
    powers = numpy.exp(numpy.outer(t, s))
    motion = ((powers * c) @ phi[:, pick]).real
    spread = (numpy.max(numpy.abs(s)) / numpy.min(numpy.abs(s[c != 0])))**2
    turned = numpy.max(numpy.abs(s[numpy.abs(c) > 1e-6 * numpy.max(numpy.abs(c))])) * duration
    allowed = (1e-9 + 1e-15 * spread) * (1 + turned) + (1e-8 if tolerance is None else 10 * tolerance)
    found = []
    for turns in (False, True):
        some = [k for k, (_, t_) in enumerate(names) if t_ == turns]
        if some:
            x = motions(rows, [names[k] for k in some])
            # what stands still in a mode moves by the error of the largest entry of its shape, which is 1e-6 x
            size = max(numpy.max(numpy.abs(motion[:, some])), 1e-6 * 1e-6 * made.x)
            found += [(f"{'one mode' if one else 'all modes'}: {names[k][0]}", numpy.max(numpy.abs(x[:, j] - motion[:, k])) / size, allowed)
                      for j, k in enumerate(some)]
    return found
