"""Random studies of structures over the whole language, from a seed: `generate.py SEED FOLDER`."""

import math
import pathlib
import random
import sys

import numpy
import scipy.io
import scipy.sparse

from formula import Formula


def toml_value(value):
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(toml_value(v) for v in value) + "]"
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{toml_key(k)} = {toml_value(v)}" for k, v in value.items()) + " }"
    return repr(value)


def toml_key(key):
    return key if key.replace("_", "").replace("-", "").isalnum() else toml_value(key)


def write_toml(tables):
    """`tables`: a dict of tables and of lists of tables."""
    lines = []
    for name, table in tables.items():
        for part in table if isinstance(table, list) else [table]:
            lines.append(f"[[{name}]]" if isinstance(table, list) else f"[{name}]")
            lines += [f"{toml_key(key)} = {toml_value(value)}" for key, value in part.items()]
            lines.append("")
    return "\n".join(lines)


class Generator:
    """One study; `tables` is its content, files besides are written into the folder."""

    def __init__(self, seed, folder):
        self.random = random.Random(seed)
        self.folder = pathlib.Path(folder)
        self.folder.mkdir(parents=True, exist_ok=True)
        self.tables = {"parameters": {}}
        self.files = 0

    # ---- small things

    def chance(self, p):
        return self.random.random() < p

    def log(self, low, high):
        return float(f"{10 ** self.random.uniform(math.log10(low), math.log10(high)):.6g}")

    def uniform(self, low, high):
        return float(f"{self.random.uniform(low, high):.6g}")

    def sign(self):
        return self.random.choice([-1, 1])

    def number(self, value):
        """Now and then an expression of a new parameter."""
        value = float(f"{value:.8g}")
        if value == 0 or not self.chance(0.12):
            return value
        name = f"p{len(self.tables['parameters'])}"
        way = self.random.randrange(4)
        if way == 0:
            self.tables["parameters"][name] = value
            return name
        if way == 1:
            self.tables["parameters"][name] = value / 2
            return f"2*{name}"
        if way == 2:
            self.tables["parameters"][name] = f"sqrt({value * value!r})*{self.random.choice(['1', '(2 > 1)', '2^0'])}"
            return name if value > 0 else f"-{name}"
        self.tables["parameters"][name] = value * 3
        return f"{name}/(2 < 1 ? 7 : 3)"

    def table_file(self, rows, header="time [s],value"):
        self.files += 1
        name = f"table{self.files}.csv"
        (self.folder / name).write_text(header + "\n" + "".join(f"{t!r},{v!r}\n" for t, v in rows))
        return name

    # ---- laws of time

    def harmonic(self, size, omega):
        law = {"amplitude": self.number(size * self.sign())}
        w = omega * self.log(0.1, 3)
        if self.chance(0.3):
            law["frequency"] = self.number(w / (2 * math.pi))
        else:
            law["angular_frequency"] = self.number(w)
        if self.chance(0.6):
            law["phase"] = self.number(self.uniform(-4, 4))
        return law

    def expression(self, size, omega, duration):
        a, w, t = f"{size:.6g}", f"{omega * self.log(0.2, 2):.6g}", duration
        t1 = self.moment(self.uniform(0.05, 0.6), t)
        t2 = t1 + self.moment(self.uniform(0.05, 0.3), t)
        k = self.random.randrange(14)
        return {"expression": [
            f"{a}*sin({w}*t)", f"t > {t1!r} && t < {t2!r} ? {a} : 0", f"{a}*min(t/{t1!r}, 1)",
            f"{a}*exp(-((t - {t1!r})/{t2 - t1!r})^2)", f"{a}*abs(sin({w}*t))",
            f"{a}*sin({w}*t)*exp(-t/{t2!r})", f"0.3 || 0 ? {a}*cos({w}*t) : 0",
            f"t < {t1!r} ? {a} : (t < {t2!r} ? -{a} : {a}/2)", f"{a}*sign(sin({w}*t))",
            f"-{a}*(t/{t!r})^2 + {a}*tanh(t/{t1!r})", f"max({a}*sin({w}*t), {a}*cos({w}*t), 0)",
            f"{a}", f"{a}*rint(3*t/{t!r})", f"{a}*sqrt(1 + t/{t1!r})*sin({w}*t + ln(1 + t/{t!r}))"][k]}

    def moment(self, share, duration):
        """Mostly where equal steps end."""
        return (max(round(share * 40), 1) / 40 if self.chance(0.6) else share) * duration

    def rows(self, size, duration, covers):
        n = self.random.randrange(3, 12)
        times = sorted({self.moment(self.uniform(0.02, 0.98), duration) for _ in range(n)})
        rows = [(0.0, self.uniform(-1, 1) * size)]
        for t in times:
            rows.append((t, self.uniform(-1, 1) * size))
            if self.chance(0.2):
                rows.append((t, self.uniform(-1, 1) * size))
        if covers:
            rows.append((duration * 1.01, self.uniform(-1, 1) * size))
        if self.chance(0.15):
            rows.insert(0, (-0.1 * duration, 0.0))
        if self.chance(0.15):
            at = next(i for i, row in enumerate(rows) if row[0] == 0.0)
            rows.insert(at, (0.0, self.uniform(-1, 1) * size))
        return rows

    def law(self, size, omega, duration, kinds=("harmonic", "expression", "table")):
        kind = self.random.choice(kinds)
        if kind == "harmonic":
            return self.harmonic(size, omega)
        if kind == "expression":
            return self.expression(size, omega, duration)
        beyond = self.random.choice([None, "zero", "hold"])
        rows = self.rows(size, duration, beyond is None)
        if beyond == "zero" and self.chance(0.8):
            rows.append((rows[-1][0], 0.0))
        law = {"table": self.table_file(rows)}
        if beyond:
            law["beyond"] = beyond
        return law

    # ---- models: each leaves names, a time scale and scales of displacement and force

    def lumped(self):
        n = self.random.choice([1, 1, 2, 2, 3, 4, 6])
        wide = self.chance(0.3)
        mass, self.omega = self.log(1e-9, 1e9) if wide else self.log(0.1, 10), self.log(1e-3, 1e4) if wide else self.log(1, 100)
        self.x = self.log(1e-9, 1e3) if wide else self.log(1e-3, 1)
        self.stiffness = mass * self.omega**2
        self.names = [self.random.choice(["m", "blade ", "c"]) + str(i) for i in range(n)]
        at_rest = self.chance(0.5)
        coordinates = []
        for name in self.names:
            part = {"name": name, "mass": self.number(mass * self.log(0.3, 3))}
            if not at_rest:
                if self.chance(0.6):
                    part["position"] = self.number(self.uniform(-1, 1) * self.x)
                if self.chance(0.6):
                    part["velocity"] = self.number(self.uniform(-1, 1) * self.x * self.omega)
            coordinates.append(part)
        self.tables["coordinate"] = coordinates
        springs = []
        stiff = self.chance(0.25)
        for i, name in enumerate(self.names):
            other = "ground" if i == 0 or self.chance(0.3) else self.names[self.random.randrange(i)]
            factor = self.log(1e2, 1e6) if stiff and i == n - 1 and n > 1 else self.log(0.3, 3)
            springs.append({"between": [name, other] if self.chance(0.5) else [other, name],
                            "stiffness": self.number(self.stiffness * factor)})
        if n > 1 and self.chance(0.1):
            springs.pop(0)  # a body that nothing holds, perhaps
        self.tables["spring"] = springs
        if self.chance(0.5):
            self.tables["damper"] = [{"between": [self.random.choice(self.names), "ground"],
                                      "damping": self.number(mass * self.omega * self.log(1e-3, 3))}]
        self.damping(n)

    def damping(self, n, lumped=True):
        way = self.random.randrange(6)
        if way == 1 and not lumped and self.chance(0.9):
            way = 0
        if way == 0:
            self.tables["damping"] = {"modal_ratio": self.number(self.log(1e-3, 0.3))}
            if self.chance(0.3):
                self.tables["damping"]["modes"] = self.random.randint(1, n)
        elif way == 1:
            count = 1 if self.chance(0.05) else n if lumped else 1
            self.tables["damping"] = {"modal_ratio": [self.number(self.log(1e-3, 0.5)) for _ in range(count)]}
        elif way == 2:
            part = {"mass": self.number(self.omega * self.log(1e-3, 0.3)),
                    "stiffness": self.number(self.log(1e-4, 0.3) / self.omega)}
            if self.chance(0.3):
                part.pop(self.random.choice(list(part)))
            self.tables["damping"] = {"rayleigh": part}

    def from_matrices(self):
        n = self.random.choice([2, 3, 5, 8])
        mass = self.log(0.01, 100)
        self.omega, self.x = self.log(1, 100), self.log(1e-3, 1)
        self.stiffness = mass * self.omega**2
        a = numpy.random.default_rng(self.random.randrange(10**6))
        m = a.normal(size=(n, n)) * 0.2
        m = mass * (m @ m.T + numpy.eye(n))
        k = a.normal(size=(n, n))
        k = self.stiffness * (k @ k.T + 0.2 * numpy.eye(n))
        part = {"mass": "m.mtx", "stiffness": "k.mtx"}
        scipy.io.mmwrite(self.folder / "m.mtx", scipy.sparse.coo_matrix(m), symmetry="symmetric", precision=17)
        scipy.io.mmwrite(self.folder / "k.mtx", scipy.sparse.coo_matrix(k), symmetry="symmetric", precision=17)
        if self.chance(0.5):
            scipy.io.mmwrite(self.folder / "c.mtx", scipy.sparse.coo_matrix(0.02 / self.omega * k + 0.01 * self.omega * m),
                             symmetry="symmetric", precision=17)
            part["damping"] = "c.mtx"
        else:
            self.damping(n)
        self.names = [f"q{i}" for i in range(n)] if self.chance(0.5) else list(range(1, n + 1))
        if self.names[0] == "q0":
            part["names"] = self.names
        if self.chance(0.6):
            part["position"] = {str(self.random.choice(self.names)): self.number(self.uniform(-1, 1) * self.x)}
        if self.chance(0.6):
            part["velocity"] = {str(self.random.choice(self.names)): self.number(self.x * self.omega)}
        self.tables["matrices"] = part

    def frame(self, space):
        """A chain or a portal of beams, clamped or pinned at its ends, with masses, trusses and releases."""
        length = self.log(0.1, 10)
        self.tables["material"] = [{"name": "m1", "young": self.number(self.log(1e9, 3e11)),
                                    "density": self.number(self.log(500, 2e4))}]
        if self.chance(0.6):
            self.tables["material"][0]["poisson"] = self.number(self.uniform(0, 0.45))
        else:
            self.tables["material"][0]["shear_modulus"] = self.number(self.log(5e8, 1e11))
        height = length * self.log(0.01, 0.3)
        area = height**2
        inertia = height**4 / 12
        section = {"name": "s1", "area": self.number(area)}
        if space:
            section["inertia"] = [self.number(inertia * self.log(0.3, 3)), self.number(inertia)]
            section["torsion"] = self.number(inertia * self.log(0.3, 2))
            section["shear_factor"] = self.number(5 / 6) if self.chance(0.5) else [0.8, 0.6]
        else:
            section["inertia"] = self.number(inertia)
            section["shear_factor"] = self.number(self.uniform(0.4, 1))
        self.tables["section"] = [section]
        if self.chance(0.3):
            self.tables["section"].append({"name": "rod", "area": self.number(area * 0.1)})
        count = self.random.choice([2, 3, 3, 4])
        nodes, beams = [], []
        place = numpy.zeros(3 if space else 2)
        for i in range(count):
            nodes.append({"name": f"n{i}", "position": [float(f"{p:.6g}") for p in place]})
            turn = self.uniform(-0.9, 0.9)
            step = length * self.uniform(0.6, 1.4)
            direction = [math.cos(turn), math.sin(turn)] if not space else [
                math.cos(turn), math.sin(turn) * 0.8, math.sin(turn) * 0.6 * self.sign()]
            place = place + step * numpy.array(direction)
        formulation = self.random.choice(["timoshenko", "euler_bernoulli", None])
        mass = self.random.choice(["consistent", "lumped", None, None])
        for i in range(count - 1):
            ends = [f"n{i}", f"n{i + 1}"]
            beam = {"nodes": ends if self.chance(0.7) else ends[::-1], "section": "s1", "material": "m1"}
            if self.chance(0.5):
                beam["name"] = f"beam {i}"
            if formulation:
                beam["formulation"] = formulation
            if mass:
                beam["mass"] = mass
            if self.chance(0.4):
                beam["elements"] = self.random.randint(1, 3)
            if space and self.chance(0.5):
                beam["orientation"] = [self.uniform(-0.3, 0.3), self.uniform(-1, 1), 1.0]
            if self.chance(0.25) and count > 2:
                kinds = [["rz"]] if not space else [["rz"], ["ry", "rz"], ["rx"], ["ry"]]
                beam["release"] = {self.random.choice(["first", "second"]): self.random.choice(kinds)}
            beams.append(beam)
        self.tables["node"], self.tables["beam"] = nodes, beams
        if self.chance(0.15) and not space:
            self.mesh_files()
        dofs = ["x", "y", "rz"] if not space else ["x", "y", "z", "rx", "ry", "rz"]
        supports = [{"node": "n0", "fix": dofs}]
        if self.chance(0.4) and count > 2:
            supports.append({"node": f"n{count - 1}", "fix": self.random.choice([["y"], ["x", "y"], dofs])})
        self.tables["support"] = supports
        held = {f"{s['node']}.{d}" for s in supports for d in s["fix"]}
        if len(self.tables["section"]) > 1 and count > 2:
            self.tables["truss"] = [{"nodes": ["n0", f"n{count - 1}"], "section": "rod", "material": "m1"}]
            if self.chance(0.5):
                self.tables["truss"][0]["name"] = "tie"
            if self.chance(0.5):
                self.tables["truss"][0]["mass"] = self.random.choice(["consistent", "lumped"])
        young = self.young()
        total = self.density() * area * length * (count - 1)
        if self.chance(0.5):
            part = {"node": f"n{self.random.randrange(1, count)}"}
            if self.chance(0.8):
                part["mass"] = self.number(total * self.log(0.1, 3))
            if self.chance(0.4) or "mass" not in part:
                inertia_mass = total * height**2
                part["inertia"] = ([self.number(inertia_mass * self.log(0.5, 5)) for _ in range(3)] if space
                                   else self.number(inertia_mass * self.log(0.5, 5)))
            self.tables["mass"] = [part]
        span = length * (count - 1)
        self.stiffness = 3 * young * inertia / span**3
        self.omega = math.sqrt(self.stiffness / (0.25 * total))
        self.x = span * self.log(1e-5, 1e-2)
        self.names = [f"n{i}.{d}" for i in range(1, count) for d in (["x", "y", "z"] if space else ["x", "y"])
                      if f"n{i}.{d}" not in held]
        self.rotations = [f"n{i}.rz" for i in range(1, count) if f"n{i}.rz" not in held]
        if self.chance(0.4):
            self.tables["material"][0]["retardation_time"] = self.number(self.log(1e-3, 0.2) / self.omega)
        if self.chance(0.4):
            node = nodes[-1]
            node["velocity"] = [self.number(self.uniform(-1, 1) * self.x * self.omega) for _ in range(3 if space else 2)]
            for d, axis in enumerate(["x", "y", "z"][:3 if space else 2]):
                if f"{node['name']}.{axis}" in held:
                    node["velocity"][d] = 0.0
            if self.chance(0.5) and f"{node['name']}.rz" not in held:
                w = self.x / span * self.omega
                node["angular_velocity"] = [w, -w, w / 2] if space else w
        if self.chance(0.3):
            self.tables["gravity"] = {"acceleration": [0.0, self.number(-0.3 * self.x * self.omega**2), 0.0][:3 if space else 2]}
        elements = [b["name"] for b in self.tables.get("beam", []) if "name" in b]
        if self.chance(0.3) and elements:
            self.tables["distributed_force"] = [{"on": self.random.choice(elements),
                                                 "direction": [self.uniform(-1, 1) for _ in range(3 if space else 2)],
                                                 "law": None}]
        self.damping(3, lumped=False)

    def mesh_files(self):
        nodes = self.tables.pop("node")
        (self.folder / "nodes.csv").write_text("name,x,y\n" + "".join(
            f"{n['name']},{n['position'][0]!r},{n['position'][1]!r}\n" for n in nodes[:-1]))
        self.tables["nodes"] = {"file": "nodes.csv"}
        self.tables["node"] = nodes[-1:]
        beams = self.tables["beam"]
        if all(set(b) <= {"nodes", "section", "material", "name", "formulation", "mass"} for b in beams) and len(beams) > 1:
            self.tables.pop("beam")
            common = {k: beams[0][k] for k in ("formulation", "mass") if k in beams[0]}
            (self.folder / "beams.csv").write_text("first,second,name,section\n" + "".join(
                f"{b['nodes'][0]},{b['nodes'][1]},{b.get('name', '')},s1\n" for b in beams))
            self.tables["beams"] = {"file": "beams.csv", "material": "m1", **common}

    def young(self):
        return self._evaluate(self.tables["material"][0]["young"])

    def density(self):
        return self._evaluate(self.tables["material"][0]["density"])

    def _evaluate(self, value):
        known = {}
        for name, number in self.tables["parameters"].items():
            known[name] = number if isinstance(number, float) else Formula(number, known)(**known)
        return value if isinstance(value, float) else Formula(value, known)(**known)

    # ---- contacts and loads

    def contacts(self):
        ends = list(self.names)

        def between():
            first = self.random.choice(ends)
            others = [e for e in ends if e != first] + ["ground"]
            second = self.random.choice(others)
            return [first, second] if self.chance(0.5) or second == "ground" else [second, first]
        if self.chance(0.35):
            self.tables["slider"] = []
            for i in range(self.random.choice([1, 1, 2, 3])):
                stiffness = self.stiffness * self.log(0.1, 10)
                part = {"between": between(), "stiffness": self.number(stiffness),
                        "friction_coefficient": self.number(self.uniform(0.1, 0.8)),
                        "normal_load": self.number(stiffness * self.x * self.log(0.03, 3))}
                if self.chance(0.5):
                    part["name"] = f"slider {i}"
                self.tables["slider"].append(part)
        if self.chance(0.2):
            self.tables["stop"] = []
            for i in range(self.random.choice([1, 1, 2])):
                stiffness = self.stiffness * self.log(0.3, 100)
                part = {"between": between(), "gap": self.number(self.x * self.uniform(-0.2, 1.0)),
                        "stiffness": self.number(stiffness)}
                if self.chance(0.4):
                    part["damping"] = self.number(stiffness / self.omega * self.log(1e-3, 0.1))
                if self.chance(0.5):
                    part["name"] = f"stop {i}"
                self.tables["stop"].append(part)

    def displacements(self):
        if self.chance(0.15):
            self.tables["displacement"] = [{"on": self.random.choice(self.names), "value": self.number(self.x * self.uniform(-1, 1))}]
        elif self.chance(0.12) and len(self.names) > 1 and "slider" not in self.tables and "stop" not in self.tables:
            law = self.harmonic(self.x, self.omega) if self.chance(0.5) else {
                "expression": self.random.choice([
                    f"{self.x:.6g}*(1 - cos({self.omega * 0.7:.6g}*t))", f"{self.x:.6g}*sin({self.omega * 0.4:.6g}*t)^2",
                    f"{self.x:.6g}*t^2*{(self.omega**2):.6g}*exp(-t*{self.omega * 0.6:.6g})"])}
            if self.chance(0.25):
                law = {"table": self.table_file([(i * self.duration / 7, self.x * self.uniform(-1, 1)) for i in range(9)])}
            self.tables["displacement"] = [{"on": self.names[-1], **law}]
            for part in self.tables.get("coordinate", [])[-1:]:
                part.pop("position", None), part.pop("velocity", None)
            for part in self.tables.get("node", [])[-1:]:
                part.pop("velocity", None), part.pop("angular_velocity", None)
            for key in ("position", "velocity"):
                self.tables.get("matrices", {}).get(key, {}).pop(str(self.names[-1]), None)

    def loads(self, kinds):
        forces = []
        self.steady = kinds == ("harmonic",)
        for _ in range(self.random.choice([0, 1, 1, 2, 3])):
            part = {"on": self.random.choice(self.names)}
            part.update(self.law(self.stiffness * self.x * self.log(0.05, 1), self.omega, self.duration, kinds))
            forces.append(part)
        if self.chance(0.12):
            forces.append({"on": self.random.choice(self.names), "held": self.number(self.stiffness * self.x * self.uniform(-1, 1))})
        if forces:
            self.tables["force"] = forces
        for part in self.tables.get("distributed_force", []):
            del part["law"]
            part.update(self.law(self.stiffness * self.x, self.omega, self.duration, kinds))
        if self.chance(0.2):
            part = self.law(self.x * self.omega**2, self.omega, self.duration, kinds)
            if "amplitude" in part and self.chance(0.5):
                part["of"] = self.random.choice(["acceleration", "velocity", "displacement"])
                part["amplitude"] = self.number(self.x * self.omega ** {"acceleration": 2, "velocity": 1}.get(part["of"], 0))
            if self.frames:
                part["direction"] = {"x": self.number(1.0), "y": self.uniform(-1, 1)}
            elif self.chance(0.4):
                part["direction"] = {str(n): self.uniform(-1, 2) for n in self.names if self.chance(0.7)}
            self.tables["base_motion"] = part

    # ---- analyses

    def analyses(self):
        list_ = []
        add = list_.append
        if self.chance(0.7):
            add({"name": "rest", "type": "static"})
            if "displacement" in self.tables and "value" in self.tables["displacement"][0] and self.chance(0.5):
                list_[-1]["displacements"] = []
        if self.chance(0.7):
            add({"name": "modes", "type": "modes"})
            if self.chance(0.2):
                list_[-1]["count"] = self.random.randint(1, 3)
            if self.chance(0.1):
                list_[-1]["observe"] = [str(self.names[0])]
        transient = {"type": "transient", "duration": self.number(self.duration)}
        if self.chance(0.3) and self.at_rest():
            transient["initial"] = "static"
        if self.chance(0.2):
            transient["energy"] = False
        tolerance = 10.0 ** -self.random.randint(2, 6)
        step = {"tolerance": tolerance}
        if "slider" in self.tables and self.chance(0.7):
            step["events"] = "locate"
        automatic = {"name": "automatic", **transient, "step": step}
        if self.chance(0.35):
            name = self.random.choice(["average_acceleration", "hht", "wbz", "linear_acceleration", "wilson_theta",
                                       "dormand_prince", "bogacki_shampine", "fox_goodwin", "generalized_alpha",
                                       "newmark", "central_difference"])
            automatic["method"] = self.method(name)
        self.automatic_keys(automatic)
        if self.chance(0.85):
            add(automatic)
        loads_exact = not any("expression" in p for key in ("force", "distributed_force") for p in self.tables.get(key, []))
        loads_exact = loads_exact and "expression" not in self.tables.get("base_motion", {})
        if self.chance(0.5) and loads_exact and "stop" not in self.tables and not self.moving():
            add({"name": "exact", **transient, "method": "exact"})
        if self.chance(0.5):
            name = self.random.choice(["average_acceleration", "hht", "wbz", "linear_acceleration", "wilson_theta", "rk4",
                                       "heun", "central_difference", "generalized_alpha", "damped_newmark", "galerkin",
                                       "backward_difference", "exponential", "newmark", "fox_goodwin", "midpoint", "ralston",
                                       "rk3", "bogacki_shampine", "dormand_prince", "explicit_euler"])
            steps = self.random.choice([400, 1000, 2000])
            duration = self._evaluate(transient["duration"])
            for k in (1, 2):
                add({"name": f"equal@{k}", **transient, "method": self.method(name), "step": duration / steps / k,
                     "output": {"every": 10 * k}})
        self.steady_analyses(add)
        self.random.shuffle(list_)
        list_.sort(key=lambda a: a["name"])
        self.tables["analysis"] = list_

    def automatic_keys(self, part):
        """The rarer keys of a transient whose steps choose themselves."""
        step, duration = part["step"], self.duration
        if self.chance(0.15):
            step["first"] = self.number(duration / self.random.choice([1000, 5000]))
        if self.chance(0.15):
            step["largest"] = self.number(duration / self.random.choice([60, 200, 500]))
        if self.chance(0.1):
            step["smallest"] = self.number(duration * 1e-11)
        if self.chance(0.1):
            step["rebuild"] = False
        method = part.get("method", "generalized_alpha")
        method = method["name"] if isinstance(method, dict) else method
        pairs = ("dormand_prince", "bogacki_shampine", "wilson_theta")
        way = self.random.random()
        if way < 0.06 and method not in pairs:
            step["estimator"] = "local_error"
        elif way < 0.1 and method in pairs:
            step["estimator"] = "embedded"
        elif way < 0.16 and method not in ("dormand_prince", "bogacki_shampine"):
            step.update({"controller": "cardona_cassano", "estimator": "inertia_jump", "tolerance": 1e-3})
            if self.chance(0.5):
                step["reference"] = self.random.choice(["initial", self.x])
            if self.chance(0.3):
                step["as_printed"] = True
            step["first"] = duration / 2000
        elif way < 0.2:
            step.update({"controller": "fixed", "first": duration / 2000})
        elif way < 0.25:
            step["controller"] = "pi"
        if self.chance(0.1) and "stop" in self.tables:
            step["events"] = "pass"
        if self.chance(0.15):
            part["output"] = self.random.choice([{"every": 2}, {"interval": self.duration / 50},
                                                 {"times": [0.1 * self.duration, 0.55 * self.duration, self.duration]}])
        if self.chance(0.12):
            part["observe"] = [str(n) for n in self.names[:2]]
            if len(self.names) > 1 and not self.frames:
                part["observe"].append(f"{self.names[0]} - {self.names[-1]}")
        if "initial" in part and "displacement" in self.tables and "value" in self.tables["displacement"][0] and self.chance(0.5):
            part["displacements"] = [str(self.tables["displacement"][0]["on"])]
        if self.chance(0.05):
            part["allow_unstable"] = True

    def at_rest(self):
        """Static starts find the positions, so none may be given."""
        return not any("position" in c for c in self.tables.get("coordinate", [])) and "position" not in self.tables.get(
            "matrices", {})

    def method(self, name):
        if name == "hht" and self.chance(0.7):
            return {"name": name, "alpha": -0.1}
        if name in ("wbz", "generalized_alpha") and self.chance(0.5):
            return {"name": name, "rho_inf": self.uniform(0.3, 1)}
        if name == "newmark":
            return {"name": name, "beta": 0.3, "gamma": 0.55}
        if name == "wilson_theta" and self.chance(0.5):
            return {"name": name, "theta": 1.42}
        return name

    def moving(self):
        return any("value" not in d for d in self.tables.get("displacement", []))

    def steady_analyses(self, add):
        if not self.sweeps or self.moving():
            return
        harmonics = [p for key in ("force", "distributed_force") for p in self.tables.get(key, []) if "amplitude" in p]
        if "base_motion" in self.tables:
            harmonics.append(self.tables["base_motion"])
        if not harmonics:
            return
        self.tables["parameters"]["Omega"] = self.omega * 0.9
        for i, part in enumerate(harmonics):
            part.pop("frequency", None)
            part["angular_frequency"] = "Omega" if i == 0 or self.chance(0.6) else "3*Omega"
        solver = self.random.choice([None, "periodic", "harmonic_balance", "time_marching"])
        if "stop" in self.tables:
            solver = "time_marching"
        part = {"name": "response", "type": "frequency_response",
                "angular_frequency": [float(f"{self.omega * f:.6g}") for f in sorted(self.log(0.2, 4) for _ in range(3))]}
        if self.chance(0.4):
            part["angular_frequency"] = {"from": self.omega * 0.3, "to": self.omega * 3, "points": 7, "spacing": self.random.choice(["log", "linear"])}
        if self.chance(0.3):
            part["excitation"] = "Omega"
        if solver:
            part["solver"] = solver
        if self.chance(0.2):
            part["observe"] = [str(self.names[0])] + ([f"{self.names[0]} - {self.names[-1]}"] if len(self.names) > 1 else [])
        if self.chance(0.3):
            part["harmonics"] = [3] if self.chance(0.5) else [2, 3]
        if solver == "time_marching":
            if self.chance(0.4):
                part["method"] = self.method(self.random.choice(["average_acceleration", "exponential", "hht"]))
            if self.chance(0.3):
                part["steps_per_period"] = 512
            if self.chance(0.3):
                part["max_periods"] = 600
        if solver and solver != "periodic" and self.chance(0.4):
            part["tolerance"] = self.number(self.random.choice([1e-2, 1e-3, 1e-4]))
        if self.chance(0.2):
            at = part["angular_frequency"]
            part["waveforms"] = {"at": [at[0] if isinstance(at, list) else at["from"]], "points": 32}
        if self.chance(0.15):
            part["start"] = self.random.choice(["unloaded", "previous", "rest"])
            if part["start"] == "previous" and self.chance(0.5):
                part["direction"] = self.random.choice(["up", "down", "both"])
        if self.chance(0.35):
            self.sweep(part)
        if self.chance(0.15) and "Hz" not in part:
            part["frequency"] = [w / (2 * math.pi) for w in self.frequencies(part.pop("angular_frequency"))]
            for load in harmonics:
                if load.get("angular_frequency") in ("Omega", "3*Omega"):
                    load["frequency"] = load.pop("angular_frequency")
            if "excitation" not in part:
                part["excitation"] = "Omega"
            self.tables["parameters"]["Omega"] = self.omega * 0.9 / (2 * math.pi)
        add(part)
        if self.chance(0.3) and len(self.names) <= 3 and not self.frames and "stop" not in self.tables and "frequency" not in part:
            name = next((k for k in self.tables["parameters"] if k[0] == "p" and isinstance(self.tables["parameters"][k], float)), None)
            if name:
                value = self.tables["parameters"][name]
                curve = {"name": "curve", "type": "damper_curve", "parameter": name,
                         "range": sorted([value * 0.8, value * 1.3, value]),
                         "angular_frequency": {"from": self.omega * 0.3, "to": self.omega * 3, "points": 33},
                         "excitation": "Omega", "optimum": self.chance(0.3)}
                if self.chance(0.2):
                    curve["objective"] = self.random.choice(["amplitude", "dissipated"])
                if self.chance(0.3):
                    curve["observe"] = str(self.names[0])
                add(curve)
        if self.chance(0.2) and not self.frames and "slider" not in self.tables and "stop" not in self.tables:
            period = 2 * math.pi / self.omega
            study = {"name": "methods", "type": "method_study", "step": period / 100, "duration": 3 * period}
            if self.chance(0.5):
                study["methods"] = ["average_acceleration", {"name": "hht", "alpha": -0.1}]
            if self.chance(0.3):
                study["ladder"] = [period / 100, period / 200]
            if self.chance(0.3):
                study["observe"] = str(self.names[0])
            add(study)

    @staticmethod
    def frequencies(values):
        if isinstance(values, list):
            return values
        return [values["from"], 0.5 * (values["from"] + values["to"]), values["to"]]

    def sweep(self, part):
        names = [k for k, v in self.tables["parameters"].items() if k[0] == "p" and isinstance(v, float)]
        if not names:
            return
        name = names[0]
        value = self.tables["parameters"][name]
        way = self.random.randrange(4)
        if way == 0:
            part["sweep"] = {name: [value, value * 1.2]}
        elif way == 1:
            low, high = sorted([value, value * 1.5])
            part["sweep"] = {name: {"from": low, "to": high, "points": 2}}
            if len(names) > 1:
                part["sweep"][names[1]] = [self.tables["parameters"][names[1]]]
        elif way == 2:
            (self.folder / "cases.csv").write_text(f"{name}\n{value!r}\n{value * 0.9!r}\n")
            part["sweep"] = {"file": "cases.csv"}
        else:
            part["sweep"] = {"samples": 2, "seed": self.random.randrange(100),
                             "sampling": self.random.choice(["latin_hypercube", "sobol", "random"]),
                             "parameters": {name: self.random.choice([
                                 {"distribution": "normal", "mean": value, "deviation": abs(value) * 0.02},
                                 {"distribution": "uniform", "from": min(value, value * 1.1), "to": max(value, value * 1.1)},
                                 {"distribution": "lognormal", "median": abs(value), "deviation": 0.05}])}}

    def build(self):
        kind = self.random.choices(["lumped", "plane", "space", "matrices"], [6, 3, 2, 1])[0]
        self.frames = kind in ("plane", "space")
        if kind == "lumped":
            self.lumped()
        elif kind == "matrices":
            self.from_matrices()
        else:
            self.frame(kind == "space")
        self.kind = kind
        self.duration = float(f"{2 * math.pi / self.omega * self.uniform(2, 8):.6g}")
        self.contacts()
        self.displacements()
        self.sweeps = self.chance(0.35)
        self.loads(("harmonic",) if self.sweeps else self.random.choice(
            [("harmonic",), ("harmonic", "table"), ("harmonic", "expression", "table")]))
        self.analyses()
        if not self.tables["parameters"]:
            del self.tables["parameters"]
        title = "" if self.chance(0.8) else 'title = "A random study"\n\n'
        order = ["parameters", "analysis"]
        tables = {k: v for k, v in self.tables.items() if k not in order}
        tables = {**({"parameters": self.tables["parameters"]} if "parameters" in self.tables else {}), **tables,
                  "analysis": self.tables["analysis"]}
        path = self.folder / "study.toml"
        path.write_text(title + write_toml(tables))
        return path


def generate(seed, folder):
    generator = Generator(seed, folder)
    while True:
        path = generator.build()
        if generator.tables["analysis"]:
            return path, generator.kind
        generator = Generator(generator.random.random(), folder)


if __name__ == "__main__":
    print(*generate(int(sys.argv[1]), sys.argv[2]))
