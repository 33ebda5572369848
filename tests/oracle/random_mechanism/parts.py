"""Random bodies and nodes."""

import math

import numpy as np

from random_mechanism.draws import rotation_matrix

class RandomParts:
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
