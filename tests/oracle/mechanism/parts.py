"""Nodes, bodies, beams and masses as the study gives them: places, start velocities, the mass matrix, what is free."""

import math

import numpy as np

from mechanism.rotations import matrix_of, quaternion_of, unit
from study import Unreadable as Refused

class Parts:
    def numbers(self, entry):
        return np.array([self.number(x) for x in entry], float)

    def point(self, entry):
        p = np.zeros(3)
        p[: len(entry)] = self.numbers(entry)
        return p

    def _add_part(self, name, place, body):
        if name in self.names:
            raise Refused("two parts of one name")
        self.names.append(name)
        self.place.append(np.asarray(place, float))
        self.turn.append(np.array([1.0, 0, 0, 0]))
        self.angle.append(0.0)
        self.velocity.append(np.zeros(6))
        self.given_velocity.append(np.zeros(6, bool))
        self.is_body.append(body)
        self.M_parts.append(np.zeros((6, 6)))
        return len(self.names) - 1

    def _read_velocity(self, part, table):
        if "velocity" in table:
            v = self.numbers(table["velocity"])
            self.velocity[part][: len(v)] = v
            self.given_velocity[part][:3] = True
        if "angular_velocity" in table:
            w = table["angular_velocity"]
            self.given_velocity[part][3:] = True
            if self.space:
                self.velocity[part][3:] = self.numbers(w)
            else:
                self.velocity[part][5] = self.number(w)

    def _read_parts(self):
        for table in self.study.get("node", []):
            part = self._add_part(str(table["name"]), self.point(table["position"]), False)
            self._read_velocity(part, table)
        for table in self.study.get("body", []):
            part = self._add_part(table["name"], self.point(table["position"]), True)
            self._read_velocity(part, table)
            if self.space and "rotation" in table:
                self.turn[part] = quaternion_of(self.numbers(table["rotation"]))
            if not self.space and "angle" in table:
                self.angle[part] = self.number(table["angle"])
            mass, inertia = self._inertia(table)
            self.M_parts[part][:3, :3] += mass * np.eye(3)
            self.M_parts[part][3:, 3:] += inertia

    def _inertia(self, table):
        shape = table.get("shape")
        if shape is None:
            mass = self.number(table["mass"])
            if not self.space:
                J = np.zeros((3, 3))
                J[2, 2] = self.number(table["inertia"])
                return mass, J
            j = self.numbers(table["inertia"])
            J = np.diag(j[:3])
            if len(j) == 6:
                J[0, 1] = J[1, 0] = j[3]
                J[0, 2] = J[2, 0] = j[4]
                J[1, 2] = J[2, 1] = j[5]
            return mass, J
        kind = shape["kind"]
        if kind == "box":
            a, b, c = self.numbers(shape["size"])
            volume, unit_inertia = a * b * c, np.diag([b * b + c * c, a * a + c * c, a * a + b * b]) / 12
        elif kind == "cylinder":
            r, h = self.number(shape["radius"]), self.number(shape["length"])
            volume = math.pi * r * r * h
            unit_inertia = np.diag([(3 * r * r + h * h) / 12, (3 * r * r + h * h) / 12, r * r / 2])
        elif kind == "sphere":
            r = self.number(shape["radius"])
            volume, unit_inertia = 4 * math.pi * r**3 / 3, 0.4 * r * r * np.eye(3)
        else:
            raise Refused(f"shape {kind}")
        mass = self.number(shape["density"]) * volume if "density" in shape else self.number(table["mass"])
        if not self.space:
            unit_inertia = np.diag([0, 0, unit_inertia[2, 2]])
        return mass, mass * unit_inertia

    def _read_beams(self):
        materials = {m["name"]: m for m in self.study.get("material", [])}
        sections = {s["name"]: s for s in self.study.get("section", [])}
        for table in self.study.get("beam", []):
            if table.get("formulation", "timoshenko") != "geometrically_exact":
                raise Refused("a linear beam in a mechanism")
            a, b = (self.names.index(str(n)) for n in table["nodes"])
            name = table.get("name", f"{table['nodes'][0]}-{table['nodes'][1]}")
            material, section = materials[table["material"]], sections[table["section"]]
            E = self.number(material["young"])
            rho = self.number(material["density"])
            G = self.number(material["shear_modulus"]) if "shear_modulus" in material else E / (2 * (1 + self.number(material["poisson"])))
            tau = self.number(material.get("retardation_time", 0.0))
            A = self.number(section["area"])
            inertia, shear = section["inertia"], section["shear_factor"]
            if self.space:
                Iy, Iz = self.numbers(inertia)
                ky, kz = self.numbers(shear) if isinstance(shear, list) else (self.number(shear),) * 2
                torsion = self.number(section["torsion"])
            else:
                Iy, Iz, ky, kz, torsion = 0.0, self.number(inertia), self.number(shear), 0.0, 0.0
            n = int(self.number(table.get("elements", 8)))
            x = unit(self.place[b] - self.place[a])
            if self.space:
                up = self.numbers(table.get("orientation", [0.0, 0.0, 1.0]))
                z = np.cross(x, up)
                if np.linalg.norm(z) < 1e-9 * np.linalg.norm(up):
                    raise Refused("a beam along its orientation")
                z = unit(z)
            else:
                z = np.array([0.0, 0.0, 1.0])
            axes = np.column_stack([x, np.cross(z, x), z])
            L = np.linalg.norm(self.place[b] - self.place[a]) / n
            chain = [a]
            for k in range(1, n):
                chain.append(self._add_part(f"{name}:{k}", self.place[a] + (self.place[b] - self.place[a]) * k / n, False))
                self.velocity[-1] = self.velocity[a] + (self.velocity[b] - self.velocity[a]) * k / n
                self.given_velocity[-1] = self.given_velocity[a] | self.given_velocity[b]
            chain.append(b)
            C = np.array([E * A, ky * G * A, kz * G * A, G * torsion, E * Iy, E * Iz])
            lumped = table.get("mass", "consistent") == "lumped"
            for k in range(n):
                p, q = chain[k], chain[k + 1]
                self.beams.append(dict(name=name, index=k + 1, parts=(p, q), axes=axes, L=L, C=C, tau=tau))
                m = rho * A * L
                own, other = (m / 2, 0.0) if lumped else (m / 3, m / 6)
                share = 1 / 2 if lumped or self.space else 1 / 3
                J = rho * L * share * axes @ np.diag([Iy + Iz, Iy, Iz]) @ axes.T
                for part in (p, q):
                    self.M_parts[part][:3, :3] += own * np.eye(3)
                    self.M_parts[part][3:, 3:] += J
                # in the plane the turning of sections is interpolated too, in space it goes to the nodes by halves
                self.pairs.append((p, q, other, 0.0 if lumped or self.space else rho * L * Iz / 6))

    def _read_masses(self):
        for table in self.study.get("mass", []):
            part = self.names.index(str(table["node"]))
            if "mass" in table:
                self.M_parts[part][:3, :3] += self.number(table["mass"]) * np.eye(3)
            if "inertia" in table:
                if self.space:
                    self.M_parts[part][3:, 3:] += np.diag(self.numbers(table["inertia"]))
                else:
                    self.M_parts[part][5, 5] += self.number(table["inertia"])

    def _find_free(self):
        n = len(self.names)
        M = np.zeros((6 * n, 6 * n))
        for p in range(n):
            M[6 * p : 6 * p + 6, 6 * p : 6 * p + 6] += self.M_parts[p]
        for p, q, other, turning in self.pairs:
            M[6 * p + 5, 6 * q + 5] += turning
            M[6 * q + 5, 6 * p + 5] += turning
            for i in range(3):
                M[6 * p + i, 6 * q + i] += other
                M[6 * q + i, 6 * p + i] += other
        self.M_all = M
        columns = range(6) if self.space else (0, 1, 5)
        fixed = set()
        letters = ["x", "y", "z", "rx", "ry", "rz"]
        for table in self.study.get("support", []):
            part = self.names.index(str(table["node"]))
            for letter in table["fix"]:
                fixed.add(6 * part + letters.index(letter))
        self.held = np.zeros(n, bool)
        free = []
        for p in range(1, n):
            for c in columns:
                if M[6 * p + c, 6 * p + c] > 0 and 6 * p + c not in fixed:
                    free.append(6 * p + c)
        self.turns_freely = np.array([M[6 * p + 5, 6 * p + 5] > 0 for p in range(n)])
        self.free = np.array(free, int)
        self.nf = len(free)
        self.M = M[np.ix_(free, free)]
        self.column = {}
        for k, c in enumerate(free):
            self.column[(c // 6, letters[c % 6])] = k
        self.J_parts = np.array([m[3:, 3:] for m in self.M_parts])
        self.start_r = np.array(self.place)
        self.start_q = np.array(self.turn)
        if not self.space:
            half = np.array(self.angle) / 2
            self.start_q = np.stack([np.cos(half), 0 * half, 0 * half, np.sin(half)], axis=-1)
        self.start_angle = np.array(self.angle)
        self.start_R = matrix_of(self.start_q)
        self.start_u = np.array(self.velocity).reshape(-1)[self.free]
        self.has_velocity = np.array(self.given_velocity).reshape(-1)[self.free]

    def all_velocities(self, u):
        out = np.zeros(6 * len(self.names))
        out[self.free] = u
        return out.reshape(-1, 6)
