"""Models: masses and springs, matrices, frames. Each leaves names, a time scale and scales of displacement and force."""

import math

import numpy
import scipy.io
import scipy.sparse

from random_structure.draws import Draws


class Models(Draws):
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
