"""The checks of mechanisms: those of `random_mechanism`, without friction, drives and latches, under loads that stand.

`rest_holds`: a march that begins in the static state stays there. `rest_is_reached`: a march with dampers on everything ends in the
static state, unless it found another one. `small_swing`: a small motion about the static state is that of the modes.
"""

import filecmp
import math

import numpy

from cross_checks.command import NoAnswer, coordinates, motions, run, table
from cross_checks.free_vibration import shapes
from random_mechanism import Generator, text_of


class Still(Generator):
    """A mechanism under loads that stand. `self.names` are its parts."""

    def __init__(self, seed, folder):
        super().__init__(seed, folder)
        self.folder.mkdir(parents=True, exist_ok=True)
        while True:
            for key in self.tables:
                self.tables[key] = {} if key == "parameters" else []
            self.parts, self.friction_wanted, self.drive_wanted = [], False, False
            self.lock_wanted = self.chance(0.2)
            family = self.pick(self.chain, self.chain, self.four_bar, self.slider_crank, self.net, self.net, self.flexible)
            names = family()
            if family == self.chain:
                self.close_loops(names)
            if self.tables["joint"] or self.tables["body"] or self.tables["beam"]:
                break
        self.family = family.__name__
        self.push(names)
        self._stand()

    def _stand(self):
        """No speeds; laws of time and rates give way to what stands; joints get springs that hold them."""
        for part in self.tables["body"] + self.tables["node"]:
            part.pop("velocity", None), part.pop("angular_velocity", None)
        for force in self.tables["force"]:
            for key in ("amplitude", "phase", "angular_frequency", "frequency", "expression", "table", "beyond"):
                force.pop(key, None)
            force["expression"] = self.uniform(-1, 1) * self.F * (self.L if ".r" in force["on"] else 1)
        self.tables["damper"] = []
        for joint in self.tables["joint"]:
            for key in ("damping", "friction", "moment", "force"):
                if isinstance(joint.get(key), (str, dict, float)):
                    joint.pop(key)
            solid = all(end in ["ground", *(b["name"] for b in self.tables["body"])] for end in joint["between"])
            if joint["type"] == "strut" or joint["type"] in ("revolute", "prismatic", "screw") and solid:
                unit = self.F * self.L if joint["type"] in ("revolute", "screw") else self.F / self.L
                joint.pop("force", None), joint.pop("moment", None)
                joint["stiffness"] = self.log(3, 30) * unit
                if "lock" in joint:
                    joint["lock"]["kind"] = "stop"
                    joint["lock"].setdefault("stiffness", 100 * unit)

    def text(self, analyses, **replaced):
        lines = []
        for key, tables in {**self.tables, "analysis": analyses, **replaced}.items():
            if isinstance(tables, dict):
                if tables:
                    lines += ["", f"[{key}]"] + [f"{k} = {text_of(v)}" for k, v in tables.items()]
                continue
            for part in tables:
                lines += ["", f"[[{key}]]"] + [f"{k} = {text_of(v)}" for k, v in part.items()]
        return "\n".join(lines) + "\n"

    def study(self, analyses, name, **replaced):
        path = self.folder / name
        path.write_text(self.text(analyses, **replaced))
        return path

    def braked(self):
        """Struts that only damp, from three points of each part to places around: nothing swings."""
        far, out = 3.0, []
        for name, place, is_body in self.parts:
            if any(s["node"] == name for s in self.tables["support"]):
                continue
            axes = numpy.eye(3)[:3 if self.space else 2]
            for i, axis in enumerate(axes):
                arm = 0.4 * numpy.roll(axis, 1) if is_body else 0 * axis
                if not self.space:
                    arm = 0.4 * numpy.array([axis[1], axis[0], 0.0]) if is_body else numpy.zeros(3)
                for side in ((1, -1) if is_body else (1,)):
                    at = numpy.asarray(place) + side * arm
                    out.append({"name": f"brake {name} {i} {side}", "type": "strut", "between": ["ground", name],
                                "at": self.vector(at + far * axis, self.L), "to": self.vector(at, self.L),
                                "damping": 6 * self.F * self.T / self.L})
        return {"joint": self.tables["joint"] + out}


def _static(command, made):
    rest = table(run(command, made.study([{"name": "rest", "type": "static"}, {"name": "modes", "type": "modes", "about": "static"}],
                                         "rest.toml"), made.folder / "rest"), "rest")
    return rest


def _differences(made, end, rest, allowed, what):
    """Places to the size of the mechanism, angles to one radian."""
    for turns, size in ((False, made.L), (True, 1.0)):
        names = [n for n in coordinates(rest) if n[1] == turns and n in coordinates(end)]
        if turns and made.space:
            continue  # a rotation vector jumps at half a turn
        if names:
            a, b = motions(end, names), motions(rest, names)[0]
            for k, (name, _) in enumerate(names):
                yield f"{what}: {name}", numpy.max(numpy.abs(a[:, k] - b[k])) / size, allowed


def rest_holds(command, seed, folder):
    """Steps err by nothing where nothing moves: what is left of the equilibrium, 1e-9 of the forces, moves what is soft."""
    made = Still(seed, folder)
    rest = _static(command, made)
    part = {"name": "stays", "type": "transient", "initial": "static", "duration": 3 * made.T, "step": {"tolerance": 1e-4},
            "output": {"interval": 0.1 * made.T}}
    rows = table(run(command, made.study([part], "stays.toml"), folder / "stays"), "stays")
    return list(_differences(made, rows, rest, 1e-6, "stays"))


def rest_is_reached(command, seed, folder):
    made = Still(seed, folder)
    rest = _static(command, made)
    duration = 400 * made.T
    part = {"name": "falls", "type": "transient", "duration": duration, "step": {"tolerance": 1e-3},
            "output": {"times": [0.98 * duration, 0.99 * duration, duration]}}
    rows = table(run(command, made.study([part], "falls.toml", **made.braked()), folder / "falls"), "falls")
    names = [n for n in coordinates(rows) if not n[1]]
    left = numpy.max(numpy.abs(numpy.diff(motions(rows, names), axis=0))) / made.L if names else 0.0
    if left > 1e-4:
        raise NoAnswer("skipped", f"still moving ({left:.1e})")
    found = list(_differences(made, _Last(rows), rest, 1e-5 + 100 * left, "ends"))
    worst = max((error for _, error, _ in found), default=0.0)
    if worst > 1e-2:  # it may have come to rest elsewhere: then both are equilibria, and only that is known
        raise NoAnswer("skipped", f"another equilibrium, {worst:.2g} away")
    return found


class _Last:
    """The last row of a table."""

    def __init__(self, rows):
        self.head, self._rows = rows.head, rows

    def column(self, name):
        return self._rows.column(name)[-1:]


def small_swing(command, seed, folder):
    """q(t) - q(rest) = Re sum of c_k phi_k exp(s_k t) for small speeds; what bends is of second order in them."""
    made = Still(seed, folder)
    if made.chance(0.5):
        for joint in made.tables["joint"]:
            if joint["type"] in ("revolute", "prismatic", "strut") and made.chance(0.5):
                joint["damping"] = made.log(0.02, 0.3) * made.F * made.T * (made.L if joint["type"] == "revolute" else 1 / made.L)
    rest = _static(command, made)
    modes = table(made.folder / "rest", "modes")
    s = modes.column("eigenvalue_real [1/s]") + 1j * modes.column("eigenvalue_imaginary [rad/s]")
    heads = [(h[: -len(w)], t) for h in modes.head
             for w, t in ((".shape [1/sqrt(kg)]", False), (".angle_shape [rad/(m sqrt(kg))]", True)) if h.endswith(w)]
    if not len(s) or len(s) >= 20 or numpy.any(s.imag <= 0):
        raise NoAnswer("skipped", "not all modes swing" if len(s) < 20 else "more than twenty modes")
    small = 1e-5
    random = numpy.random.default_rng(seed)
    kicked = {key: [dict(part) for part in made.tables[key]] for key in ("body", "node")}
    for part in kicked["body"] + kicked["node"]:
        size = len(part["position"])
        held = next((h["fix"] for h in made.tables["support"] if h["node"] == part["name"]), [])
        part["velocity"] = [0.0 if "xyz"[i] in held else float(v) for i, v in enumerate(random.normal(size=size) * small * made.L / made.T)]
    duration = min(3 * math.pi / numpy.min(numpy.abs(s)), 12 * math.pi / numpy.max(numpy.abs(s)))
    # equal steps: a tolerance is relative to what the loads may move, not to a motion as small as this
    marches = []
    for steps in (1000, 2000):
        part = {"name": "swing", "type": "transient", "initial": "static", "duration": duration, "step": duration / steps,
                "output": {"every": steps // 50}, "project_velocities": True}
        marches.append(table(run(command, made.study([part], f"swing{steps}.toml", **kicked), folder / f"swing{steps}"), "swing"))
    coarse, rows = marches
    names = [n for n in heads if n in coordinates(rows)]
    phi = shapes(modes, names)
    v = motions(rows, names, 1)[0]
    scale = numpy.array([1.0 if t else 1 / made.L for _, t in names])
    a, b = (phi * scale).T, (phi * scale * s[:, None]).T
    system = numpy.block([[a.real, -a.imag], [b.real * made.T, -b.imag * made.T]])
    weights = numpy.maximum(numpy.linalg.norm(system, axis=0), 1e-300)
    right = numpy.concatenate([0 * v, v * scale * made.T])
    solved = numpy.linalg.lstsq(system / weights, right, rcond=1e-12)[0] / weights
    rest_of_start = numpy.max(numpy.abs(system @ solved - right)) / numpy.max(numpy.abs(right))
    if rest_of_start > 1e-3:
        return [("what no sum of the modes gives of the start", rest_of_start, 1e-3)]
    c = solved[:len(s)] + 1j * solved[len(s):]
    motion = ((numpy.exp(numpy.outer(rows.column("time [s]"), s)) * c) @ phi).real * scale
    still = motions(rest, names)[0]
    x, before = ((motions(table, names) - still) * scale for table in (rows, coarse))
    straight = [k for k, (_, t) in enumerate(names) if not t or not made.space]
    size = max(numpy.max(numpy.abs(motion[:, straight])), 1e-300)
    # steps are of second order, and what bends is of second order in the size
    return [(f"swing of {names[k][0]}", numpy.max(numpy.abs(x[:, k] + (x[:, k] - before[:, k]) / 3 - motion[:, k])) / size,
             2e-6 + 3 * size + 1e-9 / size + 0.05 * numpy.max(numpy.abs(x[:, k] - before[:, k])) / size) for k in straight]


def jobs(command, seed, folder):
    """One job against two: the same bytes."""
    made = Still(seed, folder)
    analyses = [{"name": "rest", "type": "static"}, {"name": "modes", "type": "modes", "about": "static"},
                {"name": "moves", "type": "transient", "duration": made.T, "step": {"tolerance": 1e-4}},
                {"name": "equal", "type": "transient", "duration": made.T, "step": made.T / 200}]
    path = made.study(analyses, "all.toml")
    for count in (1, 2):
        run(command, path, folder / f"jobs{count}", jobs=count)
    return [(f"{one.name} of one job and of two", 0.0 if filecmp.cmp(one, folder / "jobs2" / one.name, shallow=False) else 1.0, 0.0)
            for one in sorted((folder / "jobs1").glob("*.csv"))]
