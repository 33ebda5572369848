"""Families of mechanisms: chains, linkages, nets of nodes, soft beams; and what pushes them."""

import numpy as np

class Families:
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
        M, T = self.Mass, self.T
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
