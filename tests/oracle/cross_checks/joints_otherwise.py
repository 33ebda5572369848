"""Joints of mechanisms in other words: `models(seed, folder)` gives random mechanisms, and what else they may be written as.

| way | |
|---|---|
| order | the locks of a joint, and what ties joints, in another order |
| gear back | a gear from the second joint to the first, of the inverse ratio |
| apart | some stops of a strut or of a prismatic joint on a strut of their own |
| stops | elastic stops of joints that hold from below as `[[stop]]`s on these joints |
| velocities | what rates of joints make of the velocities of all parts, given instead |
| joint's own | a bushing on the place of a joint is what the joint's own spring and damper are |
| springs | a bushing between the ground and a centre of mass is springs and dampers between coordinates |
| one wheel | two wheels, or a rack, of one gear are one of the reduced inertia |
"""

import copy
import math
import tomllib

import numpy as np

from mechanism import Mechanism, Refused
from mechanism.march import March
from mechanism.parts import unit
from random_mechanism.draws import rotation_matrix
from random_mechanism.with_mounts import WithMounts
from random_structure.toml import write_toml
from study import Study

APART = ("reaction_lock", "reaction_gear", "events")
ACCOUNTS = ("law_force", "law_moment", "strain", "dissipated", "stop")      # of which stops have their own


def models(seed, folder):
    generator = WithMounts(seed + 1_000_000, folder)
    generator.write()
    tables = tomllib.loads((folder / "study.toml").read_text())
    for part in tables["analysis"]:
        if part["type"] == "transient" and isinstance(part["step"], dict):
            part["output"] = {"interval": generator.duration * generator.T / 30}
    rng = generator.rng
    ways = {"order": in_order, "gear back": gear_back, "apart": lambda plain: locks_apart(plain, rng),
            "velocities": lambda plain: velocities(plain, folder)}
    out = [(tables, ways, APART), (tables, {"stops": stops}, (*APART, *ACCOUNTS))]
    for mounted, way, rewrite in ((on_a_joint(tables, generator), "joint's own", own_spring), (at_a_centre(tables, generator), "springs", springs)):
        if mounted is not None:
            out.append((mounted, {way: rewrite}, (*APART, "mounted.")))
    one, other = wheels(generator)
    return out + [(one, {"one wheel": lambda plain: {**other, "analysis": plain["analysis"]}}, (*APART, "one.", "reaction"))]


# ---- locks, gears and rates -----------------------------------------------------------------------------------------
def in_order(tables):
    tables, several = copy.deepcopy(tables), False
    for joint in tables.get("joint", []):
        if isinstance(joint.get("lock"), list) and len(joint["lock"]) > 1:
            joint["lock"].reverse()
            several = True
    return tables if several else None


def gear_back(tables):
    if "gear" not in tables:
        return None
    tables = copy.deepcopy(tables)
    for gear in tables["gear"]:
        gear["joints"].reverse()
        gear["ratio"] = f"1/({gear['ratio']})" if isinstance(gear["ratio"], str) else 1 / gear["ratio"]
    return tables


def locks_apart(tables, rng):
    """Every second stop on a strut of its own along the same line; latches and what rubs stay, as they end laws and friction."""
    tables, taken = copy.deepcopy(tables), []
    for k, joint in enumerate(tables.get("joint", [])):
        given = joint.get("lock", [])
        if "friction" in joint or joint["type"] not in ("strut", "prismatic") or not isinstance(given, list) or len(given) < 2:
            continue
        stops = [lock for lock in given if lock["kind"] == "stop"][::2]
        if not stops or len(stops) == len(given):
            continue
        twin = {"name": f"beside {k}", "type": "strut", "between": joint["between"], "force": 0}
        shift = 0.0
        if joint["type"] == "strut":
            twin.update({key: joint[key] for key in ("at", "to") if key in joint})
        else:
            along = unit([float(x) for x in joint["axis"]])
            here = joint.get("displacement", 0.0)
            if isinstance(here, str) or "at" not in joint:
                continue
            far = 10 * max(abs(lock["at"] - here) for lock in given) + np.linalg.norm(joint["at"])
            twin["at"], twin["to"] = [float(x) for x in joint["at"] - far * along], joint["at"]
            shift = far - here
        joint["lock"] = [lock for lock in given if lock not in stops]
        twin["lock"] = [{**lock, "at": lock["at"] + shift} for lock in stops]
        taken.append(twin)
    tables.get("joint", []).extend(taken)
    return tables if taken else None


def stops(tables):
    """Of locks with a stiffness whose free values are said to be below, or that lie above where their joint starts."""
    tables, taken = copy.deepcopy(tables), []
    for joint in tables.get("joint", []):
        given = joint.get("lock", [])
        given = given if isinstance(given, list) else [given]
        here = joint.get("angle", joint.get("displacement", None if joint["type"] == "strut" else 0.0))

        def holds_from_below(lock):
            at = lock["at"]
            return lock["kind"] == "stop" and "stiffness" in lock and (
                lock.get("side") == "below" or not isinstance(at, str) and isinstance(here, float) and at > here + 1e-6)

        out = [lock for lock in given if holds_from_below(lock)]
        if not out:
            continue
        left = [lock for lock in given if lock not in out]
        joint.pop("lock")
        if left:
            joint["lock"] = left
        for lock in out:
            taken.append({"name": f"stop {len(taken)}", "joint": joint["name"], "gap": lock["at"],
                          **{key: lock[key] for key in ("stiffness", "damping") if key in lock}})
    tables["stop"] = taken
    return tables if taken else None


def velocities(tables, folder):
    """By the oracle's reading of rates at the start."""
    if not any("rate" in j for j in tables.get("joint", [])):
        return None
    path = folder / "rates.toml"
    path.write_text(write_toml({k: v for k, v in tables.items() if k != "title"}))
    model = Mechanism(Study(path))
    march = March(model)
    try:
        state = march.take_rates(march.begin(), 0.0)
    except Refused:
        return None
    if any(l.met for l in march.locks):
        return None      # which take velocities
    tables = copy.deepcopy(tables)
    tables["analysis"] = [a for a in tables["analysis"] if a.get("initial") != "static"]      # there rates mean other velocities
    for joint in tables["joint"]:
        joint.pop("rate", None)
    u = model.all_velocities(state.u)
    for table in tables.get("body", []) + tables.get("node", []):
        part = model.names.index(str(table["name"]))
        for key, numbers in (("velocity", u[part, :3] if model.space else u[part, :2]), ("angular_velocity", u[part, 3:])):
            if key == "velocity" or model.turns_freely[part]:
                table[key] = [float(x) for x in numbers] if model.space or key == "velocity" else float(numbers[2])
    held = {s["node"] for s in tables.get("support", [])}
    return None if any(n["name"] in held for n in tables.get("node", [])) else tables


# ---- bushings -------------------------------------------------------------------------------------------------------
def on_a_joint(tables, generator):
    """With a bushing on the place of a joint between bodies that has no spring of its own."""
    tables, g = copy.deepcopy(tables), generator
    free = [j for j in tables.get("joint", []) if j["type"] in ("revolute", "prismatic") and "at" in j
            and not {"stiffness", "damping", "drive"} & set(j)
            and all(n == "ground" or any(b["name"] == n for b in tables.get("body", [])) for n in j["between"])]
    if not free:
        return None
    joint = free[int(g.rng.integers(len(free)))]
    unit_of = g.F * g.L if joint["type"] == "revolute" else g.F / g.L
    k, c = g.log(0.5, 20) * unit_of, g.log(0.05, 1) * unit_of * g.T
    other, axis = [float(g.log(0.5, 20)) * u for u in (g.F / g.L, g.F * g.L)], [float(x) for x in joint.get("axis", [])]
    bushing = {"name": "mounted", "between": joint["between"], "at": joint["at"]}
    if g.space:
        stiffness = [other[0]] * 3 + [other[1]] * 3
        damping = [x * g.T for x in stiffness]
        place = 5 if joint["type"] == "revolute" else 2
        bushing["rotation"] = [float(x) for x in _turn_of_z(unit(axis), g)]
    else:
        stiffness, place = [other[0]] * 2 + [other[1]], 2 if joint["type"] == "revolute" else 0
        damping = [x * g.T for x in stiffness]
        if joint["type"] == "prismatic":
            bushing["axis"] = axis
    stiffness[place], damping[place] = k, c
    tables.setdefault("bushing", []).append({**bushing, "stiffness": stiffness, "damping": damping})
    return {**tables, "inside": [{"joint": tables["joint"].index(joint), "stiffness": k, "damping": c}]}


def own_spring(tables):
    tables = copy.deepcopy(tables)
    (given,) = tables["inside"]
    joint = tables["joint"][given["joint"]]
    joint.update(stiffness=given["stiffness"], damping=given["damping"])
    joint["rest"] = joint.get("angle", joint.get("displacement", 0.0))
    return _without(tables)


def at_a_centre(tables, generator):
    """With a bushing between the ground and the centre of a body, along axes of the world in any order; in space it does not hold turns."""
    tables, g = copy.deepcopy(tables), generator
    if not tables.get("body"):
        return None
    body = tables["body"][int(g.rng.integers(len(tables["body"])))]
    k = [g.log(0.5, 20) * g.F / g.L for _ in range(3)]
    c = [g.log(0.05, 1) * g.F / g.L * g.T for _ in range(3)]
    bushing = {"name": "mounted", "between": ["ground", body["name"]], "at": body["position"]}
    turned = g.chance(0.5)
    if g.space:
        bushing.update(stiffness=k + [0.0] * 3, damping=c + [0.0] * 3)
        if turned:      # x to y, y to z, z to x
            bushing["rotation"] = [2 * math.pi / 3 / math.sqrt(3)] * 3
        order = ["y", "z", "x"] if turned else ["x", "y", "z"]
    else:
        k[2], c[2] = k[2] * g.L**2, c[2] * g.L**2
        bushing.update(stiffness=k, damping=c)
        if turned:
            bushing["axis"] = [0.0, -2.0]
        order = ["y", "x", "rz"] if turned else ["x", "y", "rz"]
    tables.setdefault("bushing", []).append(bushing)
    return {**tables, "inside": [{"coordinate": f"{body['name']}.{letter}", "stiffness": a, "damping": b} for letter, a, b in zip(order, k, c)]}


def springs(tables):
    tables = copy.deepcopy(tables)
    for given in tables["inside"]:
        between = ["ground", given["coordinate"]]
        tables.setdefault("spring", []).append({"between": between, "stiffness": given["stiffness"]})
        tables.setdefault("damper", []).append({"between": between, "damping": given["damping"]})
    return _without(tables)


def _without(tables):
    tables["bushing"] = [b for b in tables["bushing"] if b.get("name") != "mounted"]
    if not tables["bushing"]:
        del tables["bushing"]
    return tables


def _turn_of_z(axis, g):
    """A rotation vector that turns z into the axis, with any turn about it before."""
    about = np.cross([0, 0, 1.0], axis)
    angle = math.atan2(np.linalg.norm(about), axis[2])
    turn = about / np.linalg.norm(about) * angle if np.linalg.norm(about) > 1e-12 else np.array([angle, 0, 0])
    R = rotation_matrix(turn) @ rotation_matrix(np.array([0, 0, g.uniform(-1, 1)]))
    angle = math.acos(max(-1.0, min(1.0, (np.trace(R) - 1) / 2)))
    w = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    return w / np.linalg.norm(w) * angle if np.linalg.norm(w) > 1e-9 else turn


# ---- gears ----------------------------------------------------------------------------------------------------------
def wheels(g):
    """Two wheels, or a rack and a wheel, tied by a gear; and the second alone with what the first adds to it."""
    rack, space, n = g.chance(0.3), g.chance(0.5), 3
    place = lambda p: [float(x) for x in p[: n if space else 2]]
    axis = lambda: [float(x) for x in g.rng.normal(size=3)]
    J = [g.log(0.3, 3) * g.Mass * (1.0 if rack and i == 0 else g.L**2) for i in range(2)]
    measure = [g.L if rack else 1.0, 1.0]
    units = [g.F * (1.0 if rack else g.L), g.F * g.L]
    r = g.log(0.3, 3) * g.pick(1, -1) * measure[0]
    k = [g.log(0.5, 20) * units[i] / measure[i] for i in range(2)]
    c = [g.log(0.05, 1) * units[i] / measure[i] * g.T for i in range(2)]
    loads = [g.uniform(0.3, 2) * u for u in units]
    w = [g.uniform(1, 6) / g.T for _ in range(2)]
    speed = g.rng.normal() / g.T

    def body(name, inertia):
        turns = [inertia] * 3 if space else inertia
        return {"name": name, "mass": g.Mass, "inertia": turns, "position": place(g.L * g.rng.normal(size=3))}

    bodies = [body("one", J[0]), body("two", J[1])]
    if rack:
        bodies[0].update(mass=J[0], inertia=[g.Mass * g.L**2] * 3 if space else g.Mass * g.L**2)
    joints = []
    for i, part in enumerate(bodies):
        kind = "prismatic" if rack and i == 0 else "revolute"
        joint = {"name": f"{part['name']}.hinge".replace(".", " "), "type": kind, "between": ["ground", part["name"]], "at": part["position"],
                 "stiffness": k[i], "damping": c[i], "moment" if kind == "revolute" else "force": f"({loads[i]!r})*sin(({w[i]!r})*t + 1)"}
        if space or kind == "prismatic":
            joint["axis"] = place(axis())
        joints.append(joint)
    joints[1]["rate"] = speed
    lock = {"at": 0.4, "kind": "stop"}
    if g.chance(0.5):
        joints[1]["lock"] = [lock, {"at": -0.3, "kind": "stop", "stiffness": 100 * units[1]}]
    tables = {"body": bodies, "joint": joints, "gear": [{"joints": ["one hinge", "two hinge"], "ratio": r}]}
    other = copy.deepcopy({"body": [bodies[1]], "joint": [joints[1]]})
    sum_of = J[1] + r * r * J[0]
    other["body"][0]["inertia"] = [sum_of] * 3 if space else sum_of
    (joint,) = other["joint"]
    joint["stiffness"], joint["damping"] = k[1] + r * r * k[0], c[1] + r * r * c[0]
    joint["moment"] += f" + ({r!r})*({loads[0]!r})*sin(({w[0]!r})*t + 1)"
    duration = 2 * g.T
    analyses = [{"name": "auto", "type": "transient", "duration": duration, "step": {"tolerance": 1e-6}, "output": {"interval": duration / 20}},
                {"name": "equal", "type": "transient", "duration": duration, "step": duration / 300, "output": {"every": 10}},
                {"name": "rest", "type": "static"}, {"name": "swing", "type": "modes"}]
    return {**tables, "analysis": analyses}, {**other, "analysis": analyses}
