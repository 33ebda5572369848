"""Random mechanisms over the whole language, from a seed: `generate(seed, folder)` writes study.toml and its tables.

Everything is drawn in units in which lengths, masses and times are about 1, and written in units of `length`, `mass` and
`time` that lie anywhere between 1e-3 and 1e3 (now and then 1e-9 and 1e9), so that what the command does may not depend on them.
"""

import math
import pathlib
import sys

import numpy as np


def text_of(value):
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, np.integer)):
        return str(int(value))
    if isinstance(value, (float, np.floating)):
        return repr(float(f"{value:.13g}"))
    if isinstance(value, str):
        return '"' + value + '"'
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{k} = {text_of(v)}" for k, v in value.items()) + " }"
    return "[" + ", ".join(text_of(v) for v in value) + "]"


def number(value):
    """A number as a formula takes it."""
    return f"({float(value):.13g})"


def rotation_matrix(v):
    angle = np.linalg.norm(v)
    if angle == 0:
        return np.eye(3)
    x, y, z = v / angle
    s = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + math.sin(angle) * s + (1 - math.cos(angle)) * s @ s


class Generator:
    def __init__(self, seed, folder):
        self.rng = np.random.default_rng([seed, 15])
        self.seed, self.folder = seed, pathlib.Path(folder)
        r = self.rng
        wide = 9 if r.random() < 0.06 else 3
        self.L, self.Mass, self.T = (10 ** r.uniform(-wide, wide) if r.random() < 0.6 else 1.0 for _ in range(3))
        if wide == 9 and self.L**2 * self.Mass > 1e14:
            self.L = 1.0
        self.F = self.Mass * self.L / self.T**2
        self.space = bool(r.random() < 0.5)
        self.tables = {"parameters": {}, "body": [], "node": [], "joint": [], "mass": [], "support": [], "material": [],
                       "section": [], "beam": [], "force": [], "spring": [], "damper": [], "analysis": []}
        self.parts = []        # (name, place, is_body)
        self.count = 0
        self.dry = 0
        self.duration = r.uniform(1.0, 2.5)
        self.jumps = False
        self.reaction = False
        self.friction_wanted = r.random() < 0.35
        self.lock_wanted = r.random() < 0.3
        self.drive_wanted = r.random() < 0.3
        self.has_beams = False

    # ---- small draws ------------------------------------------------------------------------------------------------
    def chance(self, p):
        return bool(self.rng.random() < p)

    def pick(self, *options):
        return options[int(self.rng.integers(len(options)))]

    def uniform(self, a, b):
        return float(self.rng.uniform(a, b))

    def log(self, a, b):
        return float(10 ** self.rng.uniform(math.log10(a), math.log10(b)))

    def point(self):
        p = self.rng.uniform(-1, 1, 3)
        if not self.space:
            p[2] = 0
        return p

    def vector(self, p, scale=1.0):
        return [float(x) * scale for x in (p if self.space else p[:2])]

    def axis(self):
        """A direction, as a vector of any length."""
        if self.space and self.chance(0.4):
            e = np.zeros(3)
            e[int(self.rng.integers(3))] = self.pick(1.0, -1.0)
            return e
        v = self.rng.normal(size=3)
        if not self.space:
            v[2] = 0
        return v / np.linalg.norm(v) * self.pick(1.0, 1.0, 2.5)

    def value(self, x):
        """A number, now and then as an expression of a parameter."""
        if self.chance(0.1):
            name = f"p{len(self.tables['parameters']) + 1}"
            self.tables["parameters"][name] = float(x) / 2
            return f"2*{name}"
        return float(x)

    # ---- laws of time -----------------------------------------------------------------------------------------------
    def time_formula(self, size):
        """A formula of t of about this size."""
        a, w = number(size), number(self.uniform(1, 6) / self.T)
        t0 = number(self.uniform(0.2, 0.8) * self.duration * self.T)
        t1 = number(self.uniform(0.05, 0.2) * self.duration * self.T)
        kind = int(self.rng.integers(9))
        if kind >= 5:
            self.jumps = True
        return [f"{a}*sin({w}*t)", f"{a}*exp(-t/{t1})", f"{a}*(1 - cos({w}*t))^2/4", f"{a}*tanh(sin({w}*t))", f"{a}",
                f"t < {t0} ? {a} : -0.5*{a}", f"t > {t0} && t < {t0} + {t1} ? {a} : 0", f"{a}*abs(t - {t0})/{t0}",
                f"{a}*min(1, t/{t0})"][kind]

    def table_file(self, header, rows):
        self.count += 1
        name = f"table{self.count}.csv"
        (self.folder / name).write_text(header + "\n" + "".join(f"{a:.13g},{b:.13g}\n" for a, b in rows))
        return name

    def load(self, size, unit):
        kind = int(self.rng.integers(4))
        if kind == 0:
            law = {"amplitude": self.value(size), "phase": self.uniform(-3, 3)}
            w = self.uniform(1, 8) / self.T
            if self.chance(0.5):
                law["angular_frequency"] = self.value(w)
            else:
                law["frequency"] = self.value(w / (2 * math.pi))
            return law
        if kind == 1:
            n = int(self.rng.integers(2, 6))
            times = np.sort(self.rng.uniform(0, self.duration, n)) * self.T
            times[0] = 0 if self.chance(0.7) else times[0]
            last = self.duration * self.T * (1.01 if self.chance(0.5) else 0.7)
            rows = [(t, self.uniform(-1, 1) * size) for t in times] + [(max(last, times[-1] + 0.01 * self.T), 0.3 * size)]
            beyond = self.pick("zero", "hold")
            if self.chance(0.2):
                rows.insert(1, (rows[1][0], -rows[1][1]))
                self.jumps = True
            self.jumps = True
            return {"table": self.table_file(f"time [s],force [{unit}]", rows), "beyond": beyond}
        return {"expression": self.time_formula(size)}

    # ---- parts ------------------------------------------------------------------------------------------------------
    def body(self, place=None):
        name = f"b{len(self.parts) + 1}" if self.chance(0.8) else f"body {len(self.parts) + 1}"
        place = self.point() if place is None else place
        mass = self.log(0.3, 3)
        L, M, T = self.L, self.Mass, self.T
        table = {"name": name, "position": self.vector(place, L)}
        shape = self.pick("none", "none", "box", "cylinder", "sphere")
        if shape == "none":
            table["mass"] = self.value(mass * M)
            if self.space:
                a, b, c = self.rng.uniform(0.2, 0.8, 3)
                j = mass / 6 * np.array([b * b + c * c, a * a + c * c, a * a + b * b])
                if self.chance(0.4):
                    R = rotation_matrix(self.rng.normal(size=3))
                    J = R @ np.diag(j) @ R.T
                    j = [J[0, 0], J[1, 1], J[2, 2], J[0, 1], J[0, 2], J[1, 2]]
                table["inertia"] = [float(x) * M * L * L for x in j]
            else:
                table["inertia"] = self.value(mass * self.uniform(0.05, 0.3) * M * L * L)
        else:
            if shape == "box":
                size = self.rng.uniform(0.4, 1.2, 3)
                volume = float(np.prod(size))
                s = {"kind": "box", "size": [float(x) * L for x in size]}
            elif shape == "cylinder":
                radius, length = self.uniform(0.2, 0.6), self.uniform(0.4, 1.2)
                volume = math.pi * radius**2 * length
                s = {"kind": "cylinder", "radius": radius * L, "length": length * L}
            else:
                radius = self.uniform(0.3, 0.7)
                volume = 4 / 3 * math.pi * radius**3
                s = {"kind": "sphere", "radius": radius * L}
            if self.chance(0.5):
                s["density"] = mass / volume * M / L**3
            else:
                table["mass"] = mass * M
            table["shape"] = s
        if self.chance(0.4):
            if self.space:
                table["rotation"] = [float(x) for x in self.rng.normal(size=3)]
            else:
                table["angle"] = self.value(self.uniform(-2, 2))
        if self.chance(0.5):
            table["velocity"] = self.vector(self.rng.normal(size=3), L / T)
        if self.chance(0.5):
            w = self.rng.normal(size=3) / T
            table["angular_velocity"] = [float(x) for x in w] if self.space else float(w[2])
        self.tables["body"].append(table)
        self.parts.append((name, place, True))
        return name

    def node(self, place=None, mass=True, inertia=False):
        name = f"n{len(self.parts) + 1}"
        place = self.point() if place is None else place
        table = {"name": name, "position": self.vector(place, self.L)}
        if self.chance(0.4) and mass:
            table["velocity"] = self.vector(self.rng.normal(size=3), self.L / self.T)
        if inertia and self.chance(0.4):
            w = self.rng.normal(size=3) / self.T
            table["angular_velocity"] = [float(x) for x in w] if self.space else float(w[2])
        self.tables["node"].append(table)
        if mass:
            entry = {"node": name, "mass": self.value(self.log(0.3, 3) * self.Mass)}
            if inertia:
                j = self.rng.uniform(0.1, 0.17, 3) * self.Mass * self.L**2
                entry["inertia"] = [float(x) for x in j] if self.space else float(j[0])
            self.tables["mass"].append(entry)
        self.parts.append((name, place, False))
        return name

    def place_of(self, name):
        return next((p for n, p, _ in self.parts if n == name), np.zeros(3))

    # ---- joints -----------------------------------------------------------------------------------------------------
    def joint(self, kind, first, second, at=None, to=None, plain=False, axis=None):
        L, M, T, F = self.L, self.Mass, self.T, self.F
        number_here = len(self.tables["joint"]) + 1
        name = f"j{number_here}" if self.chance(0.8) else f"joint {number_here}"
        table = {"name": name, "type": kind, "between": [first, second]}
        if self.chance(0.1):
            name = f"joint{number_here}"     # what it is called without a name
            del table["name"]
        if at is not None:
            table["at"] = self.vector(at, L)
        if to is not None:
            table["to"] = self.vector(to, L)
        if axis is None:
            axis = self.axis()
        if kind in ("prismatic",) or (self.space and kind in ("revolute", "cylindrical", "screw", "planar", "universal")):
            table["axis"] = self.vector(axis)
        if kind == "universal":
            other = np.cross(axis, self.rng.normal(size=3))
            other /= np.linalg.norm(other)
            table["second_axis"] = self.vector(other)
        if kind == "screw":
            table["lead"] = self.pick(-1.0, 1.0) * self.uniform(0.3, 3.0) * L
        if kind == "distance" and self.chance(0.3):
            table["length"] = float(np.linalg.norm((to if to is not None else self.place_of(second))
                                                   - (at if at is not None else self.place_of(first)))) * L
        turning = kind in ("revolute", "screw")
        unit = F * L if turning else F
        here = 0.0
        if turning and self.chance(0.3):
            here = self.uniform(-2, 2)
            table["angle"] = self.value(here)
        if kind == "prismatic" and self.chance(0.3):
            here = self.uniform(-1, 1)
            table["displacement"] = self.value(here * L)
        if kind == "strut":
            here = float(np.linalg.norm((to if to is not None else self.place_of(second)) - (at if at is not None else self.place_of(first))))
        measure = 1.0 if turning else L
        if kind in ("revolute", "prismatic", "screw", "strut") and not plain:
            self.decorate(table, kind, here, measure, unit, turning)
        if kind in ("revolute", "prismatic", "screw", "strut", "cylindrical", "universal", "planar") and "drive" not in table:
            self.rub(table, kind)
        if kind == "strut" and not set(table) & {"stiffness", "damping", "force", "drive", "lock", "friction"}:
            table["force"] = 0
        self.tables["joint"].append(table)
        return name

    def decorate(self, table, kind, here, measure, unit, turning):
        T = self.T
        way = "angle" if turning else "length" if kind == "strut" else "displacement"
        if self.drive_wanted and self.chance(0.35):
            self.drive_wanted = False
            table["drive"] = self.drive(here, measure)
            if self.chance(0.3):
                table["damping"] = self.uniform(0.1, 1) * unit * T / measure
            return
        if self.chance(0.5):
            table["stiffness"] = self.value(self.log(0.5, 30) * unit / measure)
            if self.chance(0.5):
                table["rest"] = self.value((here + self.uniform(-0.5, 0.5) * (1 if kind != "strut" else here)) * measure)
        if self.chance(0.4):
            table["damping"] = self.value(self.log(0.05, 2) * unit * T / measure)
        what = self.rng.random()
        key = "moment" if turning else "force"
        if what < 0.3:
            a = number(self.uniform(0.3, 2) * unit)
            x = f"(({way} - {number(here * measure)})/{number(measure)})"
            v = f"(rate*{number(T / measure)})"
            t = f"(t/{number(T)})"
            formulas = [f"-{a}*{x}^3", f"-{a}*tanh(3*{v})", f"{a}*sin(3*{t}) - {a}*{v}", f"-{a}*{v}*abs({v})",
                        f"t < {number(0.5 * self.duration * T)} ? {a} : -{a}*{x}", f"{a}*cos(2*{x})", f"{a}*(1 - 0.5*{v})",
                        f"-{a}*max(0, {x} - 0.03)", f"{a}*exp(-{x}^2)*{t}"]
            if kind == "strut":
                formulas += [f"{a}/(0.3 + ({way}/{number(measure)})^2)"]
            table[key] = self.pick(*formulas)
            self.jumps = True
        elif what < 0.45:
            n = int(self.rng.integers(2, 6))
            if kind == "strut":
                x = np.linspace(0.1 * here, 3 * here, n)
            else:
                x = here + 0.137 + np.linspace(-1, 1, n) * self.uniform(0.5, 4)   # no row at the start: a kink has two slopes
            rows = [(a * measure, self.uniform(-1, 1) * unit) for a in x]
            head = "angle [rad],moment [N m]" if turning else "length [m],force [N]"
            table[key] = {"table": self.table_file(head, rows), "beyond": self.pick("zero", "hold")}
        if self.lock_wanted and self.chance(0.5) and (self.chance(0.4) or not {"force", "moment"} & set(table)):
            self.lock_wanted = False
            side = self.pick(-1.0, 1.0)
            at = here + side * self.uniform(0.05, 0.4) * (here if kind == "strut" else 1.0)
            lock = {"at": at * measure, "kind": self.pick("stop", "latch")}
            if self.chance(0.6):
                lock["stiffness"] = self.log(30, 300) * unit / measure
                if self.chance(0.6):
                    lock["damping"] = self.uniform(0.2, 3) * unit * T / measure
            table["lock"] = lock

    def rub(self, table, kind):
        if not self.friction_wanted or self.dry >= 2 or self.reaction or not self.chance(0.5):
            return
        turning = kind in ("revolute", "screw", "cylindrical", "universal")
        f = {"coefficient": self.value(self.uniform(0.05, 0.4))}
        if kind != "strut" and self.dry == 0 and self.chance(0.5):
            f["normal_load"] = "reaction"
            self.reaction = True
        else:
            f["preload"] = self.value(self.uniform(0.5, 5) * self.F)
        if turning:
            f["radius"] = self.uniform(0.05, 0.3) * self.L
        table["friction"] = f
        self.dry += 2 if kind in ("cylindrical", "planar", "universal") else 1

    def drive(self, here, measure):
        T = self.T
        a, w = number(self.uniform(0.2, 0.8) * measure * self.pick(1, -1)), number(self.uniform(1, 4) / T)
        h, tau = number(here * measure), number(self.uniform(0.1, 0.4) * T)
        if self.chance(0.2):
            times = np.concatenate([[0], np.sort(self.rng.uniform(0.1, 0.9, 2))]) * self.duration * T
            values = here * measure + np.concatenate([[0], self.rng.uniform(-0.4, 0.4, 2) * measure])
            self.jumps = True
            return {"table": self.table_file("time [s],value", list(zip(times, values))), "beyond": "hold"}
        return self.pick(f"{h} + {a}*(1 - cos({w}*t))", f"{h} + {a}*sin({w}*t)", f"{h} + {a}*{w}*(t - {tau}*(1 - exp(-t/{tau})))",
                         f"{h} + {a}*({w}*t)^3/(1 + ({w}*t)^2)", f"{h} + {a}*tanh({w}*t)^2")

    # ---- families ---------------------------------------------------------------------------------------------------
    def tree_joint(self):
        kinds = ["revolute"] * 4 + ["prismatic"] * 2 + ["rigid"]
        if self.space:
            kinds += ["cylindrical", "spherical", "universal", "planar", "screw"] * 1
        return self.pick(*kinds)

    def chain(self):
        n = int(self.rng.integers(1, 4 if self.space else 5))
        names = ["ground"]
        for k in range(n):
            before = names[-1] if self.chance(0.7) else self.pick(*names)
            place = (self.place_of(before) if before != "ground" else np.zeros(3)) + 0.8 * self.point()
            body = self.body(place)
            at = 0.5 * (self.place_of(before) + place) + 0.3 * self.point()
            kind = self.tree_joint()
            ends = (before, body) if self.chance(0.7) else (body, before)
            self.joint(kind, *ends, at=at)
            names.append(body)
        return names

    def close_loops(self, names):
        for _ in range(int(self.rng.integers(0, 3))):
            a, b = self.rng.choice(len(names), 2, replace=len(names) < 2)
            if a == b:
                continue
            kind = self.pick("strut", "strut", "distance")
            at = self.place_of(names[a]) + 0.5 * self.point()
            to = self.place_of(names[b]) + 0.5 * self.point()
            self.joint(kind, names[a], names[b], at=at, to=to)

    def four_bar(self):
        self.space = False
        self.dry = 1           # one freedom: one dry joint, whose share is determined
        A, B = np.zeros(3), np.array([self.uniform(-0.3, 0.3), self.uniform(0.4, 0.7), 0])
        C, D = np.array([self.uniform(0.8, 1.3), self.uniform(0.8, 1.2), 0]), np.array([self.uniform(0.9, 1.4), self.uniform(-0.3, 0.1), 0])
        crank, rod, rocker = self.body((A + B) / 2), self.body((B + C) / 2), self.body((C + D) / 2)
        self.joint("revolute", "ground", crank, at=A)
        self.joint("revolute", crank, rod, at=B)
        self.joint("revolute", rod, rocker, at=C)
        self.joint("revolute", rocker, "ground", at=D)
        return ["ground", crank, rod, rocker]

    def slider_crank(self):
        self.space = False
        self.dry = 1           # one freedom: one dry joint, whose share is determined
        A, B = np.zeros(3), np.array([self.uniform(-0.2, 0.3), self.uniform(0.3, 0.5), 0])
        C = np.array([self.uniform(0.9, 1.4), self.uniform(-0.2, 0.2), 0])
        crank, rod, piston = self.body((A + B) / 2), self.body((B + C) / 2), self.body(C)
        self.joint("revolute", "ground", crank, at=A)
        self.joint("revolute", crank, rod, at=B)
        self.joint("revolute", rod, piston, at=C)
        self.joint("prismatic", "ground", piston, at=C, axis=np.array([1.0, self.uniform(-0.2, 0.2), 0]))
        return ["ground", crank, rod, piston]

    def net(self):
        n = int(self.rng.integers(1, 4))
        names = ["ground"]
        for k in range(n):
            names.append(self.node(inertia=self.chance(0.3)))
            if self.chance(0.15):
                self.tables["support"].append({"node": names[-1], "fix": [self.pick("x", "y")]})
        for k in range(1, n + 1):
            for _ in range(int(self.rng.integers(1, 3))):
                other = names[int(self.rng.integers(0, k))]
                at = 1.5 * self.point() if other == "ground" else None
                self.joint(self.pick("distance", "strut", "strut"), other, names[k], at=at)
        return names

    def flexible(self):
        """A soft beam, clamped, hinged or between bodies."""
        self.has_beams = True
        A, M, T = self.L, self.Mass, self.T
        n = int(self.rng.integers(2, 4))
        a, b = self.point(), None
        while b is None or not 0.6 < np.linalg.norm(b - a) < 1.5:
            b = self.point()
        length = np.linalg.norm(b - a)
        first, second = self.node(a, mass=self.chance(0.3)), self.node(b, mass=self.chance(0.4))
        bend, thick = self.uniform(0.5, 3), self.uniform(0.15, 0.4)    # E I, and its radius of inertia
        young = 1.0
        inertia = bend
        area = bend / thick**2
        rho = self.uniform(0.3, 1) / (area * length)
        # E carries force/length^2, so that area and inertia are lengths^2 and ^4 of the drawn size
        scale = self.F / self.L**2
        material = {"name": "soft", "young": young * scale, "density": rho * M / self.L**3}
        if self.chance(0.6):
            material["poisson"] = self.uniform(0, 0.45)
        else:
            material["shear_modulus"] = 0.4 * young * scale
        if self.chance(0.5):
            material["retardation_time"] = self.uniform(0.001, 0.05) * T
        L2, L4 = self.L**2, self.L**4
        section = {"name": "s", "area": area * L2, "shear_factor": self.uniform(0.5, 1)}
        if self.space:
            section["inertia"] = [inertia * L4 * self.uniform(0.5, 1), inertia * L4]
            section["torsion"] = inertia * L4 * self.uniform(0.5, 1.2)
            if self.chance(0.5):
                section["shear_factor"] = [self.uniform(0.5, 1), self.uniform(0.5, 1)]
        else:
            section["inertia"] = inertia * L4
        self.tables["material"].append(material)
        self.tables["section"].append(section)
        beam = {"nodes": [first, second], "section": "s", "material": "soft", "formulation": "geometrically_exact", "elements": n}
        if self.chance(0.5):
            beam["name"] = "rod"
        if self.chance(0.4):
            beam["mass"] = self.pick("lumped", "consistent")
        if self.space:
            beam["orientation"] = [float(x) for x in self.rng.normal(size=3)]
        self.tables["beam"].append(beam)
        names = ["ground", first, second]
        how = self.pick("clamped", "hinged", "free", "body")
        if how == "clamped":
            self.tables["support"].append({"node": first, "fix": ["x", "y", "z", "rx", "ry", "rz"] if self.space else ["x", "y", "rz"]})
            names.remove(first)
        elif how == "hinged" and self.chance(0.5):
            self.tables["support"].append({"node": first, "fix": ["x", "y", "z"] if self.space else ["x", "y"]})
            names.remove(first)
        elif how == "hinged":
            self.joint(self.pick("revolute", "spherical" if self.space else "revolute"), "ground", first)
        elif how == "body":
            body = self.body(a + 0.3 * self.point())
            self.joint("revolute", "ground", body, at=self.place_of(body) + 0.3 * self.point())
            self.joint(self.pick("rigid", "revolute"), body, first)
            names.append(body)
        if self.chance(0.5):
            tip = self.body(b + 0.2 * self.point())
            self.joint(self.pick("rigid", "revolute"), second, tip)
            names.append(tip)
        return names

    # ---- loads and links --------------------------------------------------------------------------------------------
    def push(self, names):
        for _ in range(int(self.rng.integers(0, 3))):
            name, place, is_body = self.parts[int(self.rng.integers(len(self.parts)))]
            turns = is_body or any("inertia" in m for m in self.tables["mass"] if m["node"] == name) or (
                self.has_beams and any(name in b["nodes"] for b in self.tables["beam"]))
            letters = ["x", "y"] + (["z"] if self.space else [])
            if turns:
                letters += ["rx", "ry", "rz"] if self.space else ["rz"]
            letter = self.pick(*letters)
            if any(s["node"] == name and (letter in s["fix"] or len(s["fix"]) > 3) for s in self.tables["support"]):
                continue
            moment = letter.startswith("r")
            table = {"on": f"{name}.{letter}", **self.load(self.uniform(0.3, 3) * self.F * (self.L if moment else 1), "N m" if moment else "N")}
            if moment and self.space and self.chance(0.5):
                table["following"] = self.chance(0.5)
            elif not moment and turns and self.chance(0.5):
                table["following"] = True
                if self.chance(0.6):
                    table["at"] = self.vector(place + 0.4 * self.point(), self.L)
            self.tables["force"].append(table)
        if self.chance(0.7) or not self.tables["force"]:
            self.tables["gravity"] = {"acceleration": self.vector(self.rng.normal(size=3) * 3, self.L / self.T**2)}
        letters = ["x", "y"] + (["z"] if self.space else ["rz"])
        for sort, key, unit in (("spring", "stiffness", 1.0), ("damper", "damping", self.T)):
            if not self.chance(0.25):
                continue
            name, _, is_body = self.parts[int(self.rng.integers(len(self.parts)))]
            if any(s["node"] == name for s in self.tables["support"]):
                continue
            letter = self.pick(*letters)
            if letter == "rz" and not is_body:
                letter = "x"
            other = "ground"
            free = [p for p in self.parts if p[0] != name and not any(s["node"] == p[0] for s in self.tables["support"])
                    and (letter != "rz" or p[2])]
            if free and self.chance(0.4):
                other = free[int(self.rng.integers(len(free)))][0] + "." + letter
            size = self.log(0.3, 20) * self.F / self.L * unit * (self.L**2 if letter == "rz" else 1)
            ends = [f"{name}.{letter}", other] if self.chance(0.5) else [other, f"{name}.{letter}"]
            self.tables[sort].append({"between": ends, key: self.value(size)})

    # ---- analyses ---------------------------------------------------------------------------------------------------
    def analyses(self):
        duration = self.duration * self.T
        out = self.tables["analysis"]
        method = self.pick(None, "generalized_alpha", {"name": "generalized_alpha", "rho_inf": self.uniform(0.2, 0.95)},
                           {"name": "hht", "alpha": self.uniform(-0.3, -0.05)}, {"name": "wbz", "rho_inf": self.uniform(0.2, 0.9)})
        tolerance = self.log(1e-6, 1e-4)
        step = {"tolerance": tolerance}
        if self.chance(0.3):
            step["controller"] = self.pick("pi", "pi", "cardona_cassano")
        if self.chance(0.15) and step.get("controller") != "cardona_cassano":
            step["estimator"] = "local_error"
        if self.chance(0.2):
            step["first"] = 1e-4 * duration
        if self.chance(0.2):
            step["largest"] = 0.01 * duration
        auto = {"name": "auto", "type": "transient", "duration": self.value(duration), "step": step,
                "output": self.pick({"interval": duration / 30}, {"every": 1}, {"times": [float(x) * duration for x in (0.1, 0.35, 0.7, 0.999)]})}
        if method is not None:
            auto["method"] = method
        if self.chance(0.4):
            auto["project_velocities"] = True
        if self.has_beams:
            auto["section_forces"] = True
        if self.chance(0.15):
            auto["energy"] = False
        if self.chance(0.15):
            kept = [f"{n}.{'xy'[int(self.rng.integers(2))]}" for n, _, _ in self.parts]
            auto["observe"] = [k for k in kept if not any(s["node"] + "." in k for s in self.tables["support"])] or ["j1"]
            if auto["observe"] == ["j1"]:
                del auto["observe"]
        out.append(auto)
        if self.chance(0.1):
            out.append({"name": "watched", "type": "transient", "duration": duration, "output": {"interval": duration / 20},
                        "step": {"tolerance": 1e-4, "controller": "fixed", "first": duration / 1000}})
        if self.chance(0.2):
            out.append({"name": "reached", "type": "modes", "about": {"analysis": "auto"}})
            if self.chance(0.5):
                out[-1]["about"]["time"] = 0.6 * duration
        if self.chance(0.6):
            n = 400
            equal = self.pick("generalized_alpha", {"name": "hht", "alpha": self.uniform(-0.3, -0.05)}, {"name": "newmark", "beta": 0.3025, "gamma": 0.6},
                              "damped_newmark", {"name": "generalized_alpha", "rho_inf": self.uniform(0.1, 0.95)})
            project = self.chance(0.5)
            for name, count in (("coarse", n), ("half", 2 * n)):
                a = {"name": name, "type": "transient", "method": equal, "duration": duration, "step": duration / count,
                     "output": {"every": count // 40}}
                if project:
                    a["project_velocities"] = True
                out.append(a)
        if self.chance(0.5):
            out.append({"name": "rest", "type": "static"})
            if self.has_beams and self.chance(0.5):
                out[-1]["section_forces"] = ["rod" if "name" in self.tables["beam"][0] else "-".join(self.tables["beam"][0]["nodes"])]
            out.append({"name": "swing", "type": "modes", "about": "static"})
            if self.chance(0.3):
                out.append({"name": "from rest", "type": "transient", "initial": "static", "duration": duration, "step": {"tolerance": tolerance},
                            "output": {"interval": duration / 20}})
        if self.chance(0.4):
            out.append({"name": "given", "type": "modes"})
            if self.chance(0.5):
                out[-1]["about"] = "given"

    def write(self):
        self.folder.mkdir(parents=True, exist_ok=True)
        family = self.pick(self.chain, self.chain, self.chain, self.four_bar, self.slider_crank, self.net, self.flexible)
        names = family()
        if family in (self.chain, self.net):
            self.close_loops(names)
        if not self.tables["joint"] and not self.tables["body"] and not self.tables["beam"]:
            return self.write()
        self.push(names)
        self.analyses()
        lines = [f"title = \"mechanism {self.seed}: {family.__name__}\""]
        if self.tables["parameters"]:
            lines += ["", "[parameters]"] + [f"{k} = {text_of(v)}" for k, v in self.tables["parameters"].items()]
        if "gravity" in self.tables:
            lines += ["", "[gravity]", f"acceleration = {text_of(self.tables['gravity']['acceleration'])}"]
        for key, tables in self.tables.items():
            if key in ("parameters", "gravity"):
                continue
            for table in tables:
                lines += ["", f"[[{key}]]"] + [f"{k} = {text_of(v)}" for k, v in table.items()]
        path = self.folder / "study.toml"
        path.write_text("\n".join(lines) + "\n")
        return path


def generate(seed, folder):
    pathlib.Path(folder).mkdir(parents=True, exist_ok=True)
    return Generator(seed, folder).write()


if __name__ == "__main__":
    print(generate(int(sys.argv[1]), sys.argv[2]))
