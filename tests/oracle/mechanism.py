"""The mechanisms of a study, read from its pages: parts, joints, forces, and the equations between them.

Everything lives in space; a mechanism of the plane is one whose parts move along x and y and turn about z. Joints are made
of dot products of vectors that bodies carry, whose first and second derivatives are those of a product:

    s = a . b,   s' = a'.b + a.b',   s'' = a''.b + 2 a'.b' + a.b''

A vector is the way between two points, or an axis, of one part or of the world. So the constraints need no formula of their own,
and neither do their derivatives. Generalised velocities are (r', omega) of each part, omega about the part's own axes.
"""

import math

import numpy as np

from formula import Jet
from study import Unreadable as Refused

GROUND = 0


def skew(a):
    """[..., 3] -> [..., 3, 3], skew(a) b = a x b."""
    a = np.asarray(a, float)
    out = np.zeros(a.shape[:-1] + (3, 3))
    out[..., 0, 1], out[..., 0, 2] = -a[..., 2], a[..., 1]
    out[..., 1, 0], out[..., 1, 2] = a[..., 2], -a[..., 0]
    out[..., 2, 0], out[..., 2, 1] = -a[..., 1], a[..., 0]
    return out


def cross(a, b):
    out = np.empty(a.shape if a.ndim >= b.ndim else b.shape)
    out[..., 0] = a[..., 1] * b[..., 2] - a[..., 2] * b[..., 1]
    out[..., 1] = a[..., 2] * b[..., 0] - a[..., 0] * b[..., 2]
    out[..., 2] = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return out


def quaternion_of(vector):
    """The unit quaternion (w, x, y, z) of a rotation vector [..., 3]."""
    angle = np.linalg.norm(vector, axis=-1)[..., None]
    share = np.where(angle > 1e-9, np.sin(angle / 2) / np.where(angle > 1e-9, angle, 1), 0.5 - angle**2 / 48)
    return np.concatenate([np.cos(angle / 2), share * vector], axis=-1)


def product(p, q):
    """Hamilton's product of quaternions [..., 4]."""
    out = np.empty(np.broadcast_shapes(p.shape, q.shape))
    out[..., 0] = p[..., 0] * q[..., 0] - np.sum(p[..., 1:] * q[..., 1:], axis=-1)
    out[..., 1:] = p[..., :1] * q[..., 1:] + q[..., :1] * p[..., 1:] + cross(p[..., 1:], q[..., 1:])
    return out


def matrix_of(q):
    """The rotation matrices [..., 3, 3] of quaternions [..., 4], of any length."""
    q = q / np.linalg.norm(q, axis=-1)[..., None]
    w, v = q[..., 0, None, None], q[..., 1:]
    s = skew(v)
    return np.eye(3) + 2 * w * s + 2 * s @ s


def vector_of(q):
    """The rotation vector of the shortest turn, of unit quaternions [..., 4]."""
    q = np.where(q[..., :1] < 0, -q, q)
    length = np.linalg.norm(q[..., 1:], axis=-1)[..., None]
    angle = 2 * np.arctan2(length, q[..., :1])
    return np.where(length > 1e-12, angle / np.where(length > 1e-12, length, 1), 2.0) * q[..., 1:]


def unit(v):
    v = np.asarray(v, float)
    return v / np.linalg.norm(v)


class Joint:
    """One joint as the study gives it, and the numbers of its rows and coordinates among the model's scalars."""

    def __init__(self, table, name, kind, first, second):
        self.table, self.name, self.type = table, name, kind
        self.first, self.second = first, second
        self.rows = []          # (linear form of scalars, constant): the constraints
        self.way = None         # its coordinate, an index into the model's coordinates
        self.ways = []          # two of friction in two directions
        self.law = None
        self.drive = None
        self.lock = None
        self.friction = []


class Coordinate:
    """What a joint leaves free: a linear form of the model's scalars, plus a constant."""

    def __init__(self, name, kind, form, constant, turning):
        self.name, self.kind, self.form, self.constant, self.turning = name, kind, form, constant, turning


class Mechanism:
    """The mechanism of a `Study`."""

    def __init__(self, source):
        self.source, self.study, self.number = source, source.raw, source.number
        study = self.study
        first = (study.get("node") or study.get("body"))[0]
        self.space = len(first["position"]) == 3
        self.names = ["ground"]
        self.place = [np.zeros(3)]
        self.turn = [np.array([1.0, 0, 0, 0])]
        self.angle = [0.0]
        self.velocity = [np.zeros(6)]
        self.is_body = [False]
        self.M_parts = [np.zeros((6, 6))]
        self.pairs = []                      # beams' mass between two parts
        self.beams = []
        self.given_velocity = {}
        self._read_parts()
        self._read_beams()
        self._read_masses()
        self._find_free()
        self.vectors, self.dots, self.atans, self.roots, self.turns = [], [], [], [], []
        self.joints, self.coordinates = [], []
        self._vector_index, self._dot_index = {}, {}
        for table in study.get("joint", []):
            self._read_joint(table)
        self._freeze()
        self._read_forces()

    # ---- reading ----------------------------------------------------------------------------------------------------
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
        self.is_body.append(body)
        self.M_parts.append(np.zeros((6, 6)))
        return len(self.names) - 1

    def _read_velocity(self, part, table):
        if "velocity" in table:
            v = self.numbers(table["velocity"])
            self.velocity[part][: len(v)] = v
        if "angular_velocity" in table:
            w = table["angular_velocity"]
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

    # vectors are (kind, ...) and scalars of them; equal ones are shared
    def _vector(self, key):
        if key not in self._vector_index:
            self._vector_index[key] = len(self.vectors)
            self.vectors.append(key)
        return self._vector_index[key]

    def _axis(self, part, direction):
        """The axis that has this direction in the world at the start, and moves with the part."""
        return self._vector(("axis", part, tuple(self.start_R[part].T @ direction)))

    def _way(self, first, at, second, to):
        s1 = tuple(self.start_R[first].T @ (at - self.start_r[first]))
        s2 = tuple(self.start_R[second].T @ (to - self.start_r[second]))
        return self._vector(("way", first, s1, second, s2))

    def _dot(self, a, b):
        key = (a, b)
        if key not in self._dot_index:
            self._dot_index[key] = len(self.dots)
            self.dots.append(key)
        return ("dot", self._dot_index[key])

    def _add(self, sort, value):
        pool = dict(atan=self.atans, root=self.roots, turn=self.turns)[sort]
        pool.append(value)
        return (sort, len(pool) - 1)

    def part(self, name):
        return GROUND if name == "ground" else self.names.index(str(name))

    def _read_joint(self, table):
        a, b = (self.part(n) for n in table["between"])
        kind = table["type"]
        j = Joint(table, table.get("name", f"joint{len(self.joints) + 1}"), kind, a, b)
        carrier = lambda p: self.start_r[p] if p != GROUND and not self.is_body[p] else None
        at = self.point(table["at"]) if "at" in table else None
        to = self.point(table["to"]) if "to" in table else None
        if at is None:
            at = carrier(a) if carrier(a) is not None else (to if to is not None else carrier(b))
            if at is None:
                raise Refused("a joint without a place")
            if to is None:
                to = carrier(b) if carrier(b) is not None and kind in ("distance", "strut") else at
        elif to is None:
            to = carrier(b) if carrier(b) is not None and carrier(a) is None and kind in ("distance", "strut") else at
            if carrier(b) is not None and kind in ("distance", "strut"):
                to = carrier(b)
        j.at, j.to = at, to
        j.arm1 = self.start_R[a].T @ (at - self.start_r[a])
        j.arm2 = self.start_R[b].T @ (to - self.start_r[b])
        d = self._way(a, at, b, to)
        world = [self._vector(("axis", GROUND, tuple(e))) for e in np.eye(3)]
        gaps = [self._dot(d, w) for w in (world if self.space else world[:2])]
        if self.space:
            if "axis" in table:
                z = unit(self.numbers(table["axis"]))
            else:
                z = np.array([0.0, 0, 1])
            if kind == "universal":
                x, y = z, unit(self.numbers(table["second_axis"]))
                z = np.cross(x, y)
            else:
                x = unit(np.cross(z, np.eye(3)[int(np.argmin(np.abs(z)))]))
                y = np.cross(z, x)
        else:
            z = np.array([0.0, 0, 1])
            x, y = np.eye(3)[0], np.eye(3)[1]
            if "axis" in table:
                along = np.zeros(3)
                along[:2] = unit(self.numbers(table["axis"]))
                across = np.cross(z, along)
        j.frame = np.column_stack([x, y, z])
        A1 = [self._axis(a, e) for e in (x, y, z)]
        A2 = [self._axis(b, e) for e in (x, y, z)]
        align = lambda i, k: self._dot(A1[i], A2[k])
        straight = [align(1, 2), align(0, 2)]
        locked = straight + [align(0, 1)] if self.space else [align(0, 1)]
        form = lambda s, factor=1.0: {s: factor}
        zero = lambda s: (form(s), 0.0)

        def about_z():
            if self.space:
                return self._add("atan", (self._dot(A1[1], A2[0]), self._dot(A1[0], A2[0])))
            return self._add("turn", (a, b))

        def coordinate(sort, scalar, given, turning):
            c = Coordinate(j.name, sort, form(scalar), given, turning)
            self.coordinates.append(c)
            return len(self.coordinates) - 1

        angle0 = self.number(table.get("angle", 0.0))
        way0 = self.number(table.get("displacement", 0.0))
        if kind == "revolute":
            j.rows = [zero(s) for s in gaps + (straight if self.space else [])]
            if self.turns_freely[a] or self.turns_freely[b] or a == GROUND or b == GROUND:
                j.way = coordinate("angle", about_z(), angle0, True)
        elif kind == "rigid":
            j.rows = [zero(s) for s in gaps + locked]
        elif kind == "prismatic":
            if self.space:
                j.rows = [zero(self._dot(d, A1[0])), zero(self._dot(d, A1[1]))] + [zero(s) for s in locked]
                along = z
            else:
                j.rows = [zero(self._dot(d, self._axis(a, across)))] + [zero(s) for s in locked]
            j.way = coordinate("displacement", self._dot(d, self._axis(a, along)), way0, False)
            j.constant_way = True
        elif kind == "cylindrical":
            j.rows = [zero(self._dot(d, A1[0])), zero(self._dot(d, A1[1]))] + [zero(s) for s in straight]
            j.ways = [coordinate("displacement", self._dot(d, A1[2]), way0, False), coordinate("angle", about_z(), angle0, True)]
        elif kind == "screw":
            turn = about_z()
            lead = self.number(table["lead"])
            along_z = self._dot(d, A1[2])
            j.rows = [zero(self._dot(d, A1[0])), zero(self._dot(d, A1[1])), ({along_z: 1.0, turn: -lead / (2 * math.pi)}, 0.0)]
            j.rows += [zero(s) for s in straight]
            j.way = coordinate("angle", turn, angle0, True)
            j.slide = along_z
            j.lead = lead
        elif kind == "spherical":
            j.rows = [zero(s) for s in gaps]
        elif kind == "universal":
            j.rows = [zero(s) for s in gaps] + [zero(align(0, 1))]
            j.ways = [
                coordinate("first", self._add("atan", (align(2, 1), align(1, 1))), 0.0, True),
                coordinate("second", self._add("atan", (align(0, 2), align(0, 0))), 0.0, True),
            ]
        elif kind == "planar":
            j.rows = [zero(self._dot(d, A1[2]))] + [zero(s) for s in straight]
            j.ways = [coordinate("x", self._dot(d, A1[0]), 0.0, False), coordinate("y", self._dot(d, A1[1]), 0.0, False)]
        elif kind in ("distance", "strut"):
            square = self._dot(d, d)
            if kind == "distance":
                L = self.number(table["length"]) if "length" in table else float(np.linalg.norm(to - at))
                j.rows = [({square: 1 / (2 * L)}, -L / 2)]
            else:
                j.way = coordinate("length", self._add("root", square), 0.0, False)
        else:
            raise Refused(f"joint {kind}")
        self.joints.append(j)

    # ---- kinematics -------------------------------------------------------------------------------------------------
    def _freeze(self):
        """Turns the lists of vectors and scalars into arrays."""
        way = [(k, v) for k, v in enumerate(self.vectors) if v[0] == "way"]
        axis = [(k, v) for k, v in enumerate(self.vectors) if v[0] == "axis"]
        self._w = np.array([k for k, _ in way], int)
        self._wp = np.array([[v[1], v[3]] for _, v in way], int).reshape(-1, 2)
        self._ws = np.array([[v[2], v[4]] for _, v in way], float).reshape(-1, 2, 3)
        self._a = np.array([k for k, _ in axis], int)
        self._ap = np.array([v[1] for _, v in axis], int)
        self._ae = np.array([v[2] for _, v in axis], float).reshape(-1, 3)
        self._ae_skew, self._ws_skew = -skew(self._ae), skew(self._ws)
        self._w3, self._a3 = np.arange(3)[None, :, None], self._a[:, None, None]
        self._a_columns = (6 * self._ap[:, None] + 3 + np.arange(3))[:, None, :]
        self._w_columns = (6 * self._wp[:, :, None] + 3 + np.arange(3))[:, :, None, :]
        self._da = np.array([a for a, _ in self.dots], int)
        self._db = np.array([b for _, b in self.dots], int)
        nd, na, nr = len(self.dots), len(self.atans), len(self.roots)
        self._at = np.array([[y[1], x[1]] for y, x in self.atans], int).reshape(-1, 2)
        self._rt = np.array([s[1] for s in self.roots], int)
        self._tn = np.array(self.turns, int).reshape(-1, 2)
        base = dict(dot=0, atan=nd, root=nd + na, turn=nd + na + nr)
        self.scalar_count = nd + na + nr + len(self.turns)
        self.first_atan = nd
        place = lambda s: base[s[0]] + s[1]
        self.row_owner = []
        rows, constants = [], []
        for k, j in enumerate(self.joints):
            j.row_numbers = []
            for form, constant in j.rows:
                line = np.zeros(self.scalar_count)
                for s, factor in form.items():
                    line[place(s)] += factor
                j.row_numbers.append(len(rows))
                rows.append(line)
                constants.append(constant)
                self.row_owner.append(k)
        self.row_map = np.array(rows).reshape(len(rows), self.scalar_count)
        self.row_constant = np.array(constants, float)
        lines = []
        for c in self.coordinates:
            line = np.zeros(self.scalar_count)
            for s, factor in c.form.items():
                line[place(s)] += factor
            lines.append(line)
        self.way_map = np.array(lines).reshape(len(lines), self.scalar_count)
        self.way_constant = np.array([c.constant for c in self.coordinates], float)
        # threads: the slip along the helix is made of the turn and the way
        self.thread_map = {}
        for j in self.joints:
            if j.type == "screw":
                self.thread_map[j.name] = (self.way_map[j.way].copy(), np.eye(self.scalar_count)[place(j.slide)])
        # columns of the vectors' derivatives
        n = len(self.names)
        self._inverse = -np.ones(6 * n, int)
        self._inverse[self.free] = np.arange(self.nf)
        # a prismatic joint begins at its displacement wherever its points lie
        scalars = self.scalars(self.start_state(), bias=False)[0]
        begin = self.way_map @ scalars
        for k, c in enumerate(self.coordinates):
            if c.kind in ("displacement", "x", "y"):
                self.way_constant[k] -= begin[k]

    def start_state(self):
        return State(self.start_r.copy(), self.start_q.copy(), self.start_u.copy(), self.start_angle.copy(), np.zeros(len(self.atans)))

    def scalars(self, state, bias=True):
        """Values [s], derivatives [s x nf], rates [s] and second derivatives at constant velocities [s] of all scalars."""
        n, nv = len(self.names), len(self.vectors)
        r, R = state.r, state.R
        u = np.zeros(6 * n)
        u[self.free] = state.u
        u = u.reshape(n, 6)
        v, w = u[:, :3], np.einsum("pij,pj->pi", R, u[:, 3:])
        value, rate, second = np.zeros((nv, 3)), np.zeros((nv, 3)), np.zeros((nv, 3))
        J = np.zeros((nv, 3, 6 * n))
        if len(self._a):
            p = self._ap
            e = np.einsum("kij,kj->ki", R[p], self._ae)
            value[self._a] = e
            rate[self._a] = cross(w[p], e)
            second[self._a] = cross(w[p], rate[self._a])
            J[self._a3, self._w3, self._a_columns] = R[p] @ self._ae_skew
        for end, sign in ((0, -1.0), (1, 1.0)):
            if len(self._w) == 0:
                break
            p, s = self._wp[:, end], self._ws[:, end]
            arm = np.einsum("kij,kj->ki", R[p], s)
            swing = cross(w[p], arm)
            value[self._w] += sign * (r[p] + arm)
            rate[self._w] += sign * (v[p] + swing)
            second[self._w] += sign * cross(w[p], swing)
            for i in range(3):
                J[self._w, i, 6 * p + i] += sign
            J[self._w[:, None, None], self._w3, self._w_columns[:, end]] -= sign * R[p] @ self._ws_skew[:, end]
        J = J[:, :, self.free]
        a, b = self._da, self._db
        S = np.einsum("ki,ki->k", value[a], value[b])
        dS = np.einsum("kij,ki->kj", J[a], value[b]) + np.einsum("kij,ki->kj", J[b], value[a])
        S1 = np.einsum("ki,ki->k", rate[a], value[b]) + np.einsum("ki,ki->k", rate[b], value[a])
        S2 = (np.einsum("ki,ki->k", second[a], value[b]) + 2 * np.einsum("ki,ki->k", rate[a], rate[b])
              + np.einsum("ki,ki->k", second[b], value[a]))
        S, dS, S1, S2 = [S], [dS], [S1], [S2]
        if len(self._at):
            y, x = self._at[:, 0], self._at[:, 1]
            Y, X, Y1, X1, Y2, X2 = S[0][y], S[0][x], S1[0][y], S1[0][x], S2[0][y], S2[0][x]
            q = X * X + Y * Y
            angle = np.arctan2(Y, X)
            angle += 2 * np.pi * np.round((state.turns - angle) / (2 * np.pi))
            S.append(angle)
            dS.append((X[:, None] * dS[0][y] - Y[:, None] * dS[0][x]) / q[:, None])
            turn = (X * Y1 - Y * X1) / q
            S1.append(turn)
            S2.append((X * Y2 - Y * X2) / q - 2 * (X * X1 + Y * Y1) * turn / q)
        if len(self._rt):
            s = np.sqrt(S[0][self._rt])
            S.append(s)
            dS.append(dS[0][self._rt] / (2 * s[:, None]))
            S1.append(S1[0][self._rt] / (2 * s))
            S2.append(S2[0][self._rt] / (2 * s) - S1[0][self._rt] ** 2 / (4 * s**3))
        if len(self._tn):
            one, two = self._tn[:, 0], self._tn[:, 1]
            S.append(state.angle[two] - state.angle[one] - self.start_angle[two] + self.start_angle[one])
            line = np.zeros((len(one), 6 * n))
            line[np.arange(len(one)), 6 * two + 5] += 1
            line[np.arange(len(one)), 6 * one + 5] -= 1
            dS.append(line[:, self.free])
            S1.append(u[two, 5] - u[one, 5])
            S2.append(np.zeros(len(one)))
        return np.concatenate(S), np.concatenate(dS), np.concatenate(S1), np.concatenate(S2)

    # ---- forces -----------------------------------------------------------------------------------------------------
    def _coordinate(self, name):
        """The column of a coordinate NODE.x, or None of the ground or what is held; and its start value."""
        if name == "ground":
            return None, 0.0
        part, letter = name.rsplit(".", 1)
        p = self.names.index(part)
        k = ["x", "y", "z", "rx", "ry", "rz"].index(letter)
        return self.column.get((p, letter)), (p, k)

    def _read_forces(self):
        study = self.study
        self.gravity = np.zeros(3)
        if "gravity" in study:
            g = self.numbers(study["gravity"]["acceleration"])
            self.gravity[: len(g)] = g
        everywhere = np.zeros((len(self.names), 6))
        everywhere[:, :3] = self.gravity
        self.weight = (self.M_all @ everywhere.reshape(-1))[self.free]
        self.forces = []
        for table in study.get("force", []):
            part_name, letter = table["on"].rsplit(".", 1)
            p = self.names.index(part_name)
            k = ["x", "y", "z", "rx", "ry", "rz"].index(letter)
            following = table.get("following", self.space and k >= 3)
            arm = None
            if "at" in table:
                arm = self.start_R[p].T @ (self.point(table["at"]) - self.start_r[p])
            self.forces.append((p, k, following, arm, self.source.law(table)))
        self.links = []
        for table in study.get("spring", []) + study.get("damper", []):
            ends = [self._coordinate(n) for n in table["between"]]
            self.links.append((ends, self.number(table.get("stiffness", 0.0)), self.number(table.get("damping", 0.0))))
        for j in self.joints:
            self._read_law(j)
        if self.beams:
            self._freeze_beams()

    def _read_law(self, j):
        t = j.table
        way = "angle" if j.type in ("revolute", "screw") else "length" if j.type == "strut" else "displacement"
        j.stiffness = self.number(t.get("stiffness", 0.0))
        j.rest = self.number(t["rest"]) if "rest" in t else None
        j.damping = self.number(t.get("damping", 0.0))
        j.formula, j.points = None, None
        law = t.get("moment", t.get("force"))
        if isinstance(law, dict):
            j.points = self.source.table(law["table"])
            j.beyond = law.get("beyond", "error")
        elif law is not None:
            j.formula = self.source.formula(str(law), (way, "rate", "t"))
            j.formula_way = way
        j.drive_formula, j.drive_points = None, None
        if "drive" in t:
            if isinstance(t["drive"], dict):
                j.drive_points = self.source.table(t["drive"]["table"])
                j.drive_beyond = t["drive"].get("beyond", "error")
            else:
                j.drive_formula = self.source.formula(str(t["drive"]), ("t",))
        j.lock = None
        if "lock" in t:
            lock = t["lock"]
            j.lock = dict(at=self.number(lock["at"]), kind=lock.get("kind"), stiffness=self.number(lock.get("stiffness", 0.0)),
                          damping=self.number(lock.get("damping", 0.0)))
        j.friction = None
        if "friction" in t:
            f = t["friction"]
            j.friction = dict(mu=self.number(f["coefficient"]), preload=self.number(f.get("preload", 0.0)),
                              reaction=f.get("normal_load") == "reaction", radius=self.number(f.get("radius", 1.0)))
            if isinstance(f.get("normal_load"), (int, float)):
                raise Refused("a normal load that is a number")

    def drive_at(self, j, t, side=1):
        """The drive's value and its first two derivatives; at a row of a table those of the given side."""
        if j.drive_formula is not None:
            jet = j.drive_formula(t=Jet(t, 1.0, 0.0))
            return (jet.v, jet.d, jet.dd) if isinstance(jet, Jet) else (float(jet), 0.0, 0.0)
        x, y = j.drive_points[:, 0], j.drive_points[:, 1]
        if t < x[0] or (t == x[0] and side < 0):
            return y[0], 0.0, 0.0
        if t > x[-1] or (t == x[-1] and side > 0):
            return y[-1], 0.0, 0.0
        k = np.searchsorted(x, t, side="right" if side > 0 else "left") - 1
        k = min(max(k, 0), len(x) - 2)
        slope = (y[k + 1] - y[k]) / (x[k + 1] - x[k])
        return y[k] + slope * (t - x[k]), slope, 0.0

    def _freeze_beams(self):
        self.bp = np.array([b["parts"] for b in self.beams])
        self.bL = np.array([b["L"] for b in self.beams])
        self.bC = np.array([b["C"] for b in self.beams])
        self.btau = np.array([b["tau"] for b in self.beams])
        self.bR0 = np.array([b["axes"] for b in self.beams])
        if not self.space:
            self.bC[:, 2:5] = 0.0

    def beam_state(self, state, u=None):
        """Strains [b, 6] (stretch, shears, twist, bends), their derivatives [b, 6, 12] by (r', omega) of both ends, rates."""
        p, q = self.bp[:, 0], self.bp[:, 1]
        L = self.bL[:, None]
        R1, R2, R0 = state.R[p], state.R[q], self.bR0
        T = lambda m: np.swapaxes(m, 1, 2)
        back = state.q[p] * np.array([1.0, -1, -1, -1])
        relative = vector_of(product(back, state.q[q])) if self.space else np.zeros((len(p), 3))
        if not self.space:
            relative[:, 2] = state.angle[q] - state.angle[p]
        half = matrix_of(quaternion_of(relative / 2))
        Rm = R1 @ half @ R0                                # axes of the section in the middle
        d = state.r[q] - state.r[p]
        gamma = np.einsum("bji,bj->bi", Rm, d) / L - np.array([1.0, 0, 0])
        kappa = np.einsum("bji,bj->bi", R0, relative) / L
        # psi' = Jr^-1 omega2 - Jl^-1 omega1, omega of the middle = exp(-psi/2) omega1 + Jr(psi/2) psi'/2, in the axes of R1 half
        inv_r, inv_l = inverse_right_jacobian(relative), inverse_right_jacobian(-relative)
        jr = right_jacobian(relative / 2)
        mid1 = T(half) - jr @ inv_l / 2
        mid2 = jr @ inv_r / 2
        B = np.zeros((len(p), 6, 12))
        B[:, :3, 0:3] = -T(Rm) / L[:, :, None]
        B[:, :3, 6:9] = T(Rm) / L[:, :, None]
        whole = gamma + np.array([1.0, 0, 0])
        B[:, :3, 3:6] = skew(whole) @ T(R0) @ mid1
        B[:, :3, 9:12] = skew(whole) @ T(R0) @ mid2
        B[:, 3:, 3:6] = -T(R0) @ inv_l / L[:, :, None]
        B[:, 3:, 9:12] = T(R0) @ inv_r / L[:, :, None]
        strain = np.concatenate([gamma, kappa], axis=1)
        if u is None:
            u = self.all_velocities(state.u)
        ends = np.concatenate([u[p], u[q]], axis=1)
        return strain, B, np.einsum("bij,bj->bi", B, ends)

    def all_velocities(self, u):
        out = np.zeros(6 * len(self.names))
        out[self.free] = u
        return out.reshape(-1, 6)


def right_jacobian(psi):
    """omega = Jr(psi) psi' in the axes of exp(psi)."""
    angle = np.linalg.norm(psi, axis=-1)[..., None, None]
    s = skew(psi)
    small = angle < 1e-4
    safe = np.where(small, 1.0, angle)
    a = np.where(small, 0.5 - angle**2 / 24, (1 - np.cos(safe)) / safe**2)
    b = np.where(small, 1 / 6 - angle**2 / 120, (safe - np.sin(safe)) / safe**3)
    return np.eye(3) - a * s + b * s @ s


def inverse_right_jacobian(psi):
    angle = np.linalg.norm(psi, axis=-1)[..., None, None]
    s = skew(psi)
    small = angle < 1e-2
    safe = np.where(small, 1.0, angle)
    c = np.where(small, 1 / 12 + angle**2 / 720 + angle**4 / 30240, 1 / safe**2 - (1 + np.cos(safe)) / (2 * safe * np.sin(np.where(small, 1.0, safe))))
    return np.eye(3) + 0.5 * s + c * s @ s


class State:
    """Where everything is: places [n, 3], quaternions [n, 4], velocities [nf], plane angles [n], counted turns."""

    def __init__(self, r, q, u, angle, turns):
        self.r, self.q, self.u, self.angle, self.turns = r, q, u, angle, turns
        self.R = matrix_of(q)

    def copy(self):
        return State(self.r.copy(), self.q.copy(), self.u.copy(), self.angle.copy(), self.turns.copy())


def moved(model, state, dq):
    """The state after a small motion dq [nf] in (dr, rotation vector about the part's own axes)."""
    step = model.all_velocities(dq)
    q = product(state.q, quaternion_of(step[:, 3:]))
    q /= np.linalg.norm(q, axis=1)[:, None]
    out = State(state.r + step[:, :3], q, state.u.copy(), state.angle + step[:, 5] if not model.space else state.angle, state.turns.copy())
    if len(model.atans):
        out.turns = model.scalars(out)[0][model.first_atan : model.first_atan + len(model.atans)]
    return out
