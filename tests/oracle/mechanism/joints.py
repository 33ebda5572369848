"""Joints as linear forms of dot products of vectors that parts carry."""

import math

import numpy as np

from mechanism.rotations import unit
from study import Unreadable as Refused

GROUND = 0


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
        self.locks = []
        self.friction = []


class Coordinate:
    """What a joint leaves free: a linear form of the model's scalars, plus a constant."""

    def __init__(self, name, kind, form, constant, turning):
        self.name, self.kind, self.form, self.constant, self.turning = name, kind, form, constant, turning


class Joints:
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
