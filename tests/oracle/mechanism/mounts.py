"""Bushings, whose axes turn with their first part, and gears between the coordinates of joints.

A bushing has the energy u k u/2 + theta K theta/2 and dissipates u' c u' + theta' C theta', with u the way of its point on the second part
along axes of the first, and theta the rotation vector of the second part as seen from the first, both zero in the configuration given.
All forces are minus the derivatives of these by the motions of both parts.
"""

import numpy as np

from mechanism.joints import Coordinate
from mechanism.rotations import inverse_right_jacobian, matrix_of, product, quaternion_of, unit, vector_of
from study import Unreadable as Refused

BACK = np.array([1.0, -1, -1, -1])      # of a quaternion: the turn back


class Bushing:
    def __init__(self, name, first, second, stiffness, damping, ways):
        self.name, self.first, self.second = name, first, second
        self.stiffness, self.damping = stiffness, damping
        self.ways = ways                         # numbers of its coordinates: along its axes, in the plane also its angle
        self.frames = None                       # in space: its axes in those of both parts, as quaternions

    def turn(self, state, u):
        """theta [3], its derivative [3 x 6] by (omega1, omega2) about the parts' own axes, theta', and the axes in the world."""
        one, two = (unit(product(state.q[p], f)) for p, f in zip((self.first, self.second), self.frames))
        theta = vector_of(product(one * BACK, two))
        A, B = matrix_of(one), matrix_of(two)
        by = inverse_right_jacobian(theta) @ B.T @ np.concatenate([-state.R[self.first], state.R[self.second]], axis=1)
        return theta, by, by @ np.concatenate([u[self.first, 3:], u[self.second, 3:]]), A


class Gear:
    def __init__(self, name, first, second, ratio):
        self.name, self.first, self.second, self.ratio = name, first, second, ratio
        self.row = None                          # its number among the rows


class Mounts:
    def _read_bushings(self):
        self.bushings = []
        for table in self.study.get("bushing", []):
            first, second = (self.part(n) for n in table["between"])
            at = self._place_of_bushing(table, first, second)
            axes = np.eye(3)
            if self.space and "rotation" in table:
                axes = matrix_of(quaternion_of(self.numbers(table["rotation"])))
            if not self.space and "axis" in table:
                along = np.zeros(3)
                along[:2] = unit(self.numbers(table["axis"]))
                axes = np.column_stack([along, np.cross([0, 0, 1.0], along), [0, 0, 1.0]])
            name = table.get("name", f"bushing{len(self.bushings) + 1}")
            d = self._way(first, at, second, at)
            ways = [self._mount(name, self._dot(d, self._axis(first, axes[:, i]))) for i in range(3 if self.space else 2)]
            if not self.space:
                ways.append(self._mount(name, self._add("turn", (first, second))))
            k = self.numbers(table["stiffness"])
            c = self.numbers(table["damping"]) if "damping" in table else np.zeros(len(k))
            if len(k) != (6 if self.space else 3) or len(c) != len(k):
                raise Refused("a bushing with other directions")
            b = Bushing(name, first, second, k, c, ways)
            if self.space:
                turn = quaternion_of(self.numbers(table.get("rotation", [0, 0, 0])))
                b.frames = [product(self.start_q[p] * BACK, turn) for p in (first, second)]
            self.bushings.append(b)

    def _place_of_bushing(self, table, first, second):
        if "at" in table:
            return self.point(table["at"])
        for part in (first, second):
            if part and not self.is_body[part]:
                return self.start_r[part]
        raise Refused("a bushing without a place")

    def _mount(self, name, scalar):
        self.coordinates.append(Coordinate(name, "mount", {scalar: 1.0}, 0.0, scalar[0] == "turn"))
        return len(self.coordinates) - 1

    def _read_gears(self):
        """Rows of their own behind those of the joints: s1 - ratio s2 keeps the value of the configuration given."""
        self.gears = []
        scalars = self.scalars(self.start_state(), bias=False)[0]
        for table in self.study.get("gear", []):
            first, second = (next(j for j in self.joints if j.name == str(n)) for n in table["joints"])
            if first.way is None or second.way is None:
                raise Refused("a gear on a joint without a coordinate")
            gear = Gear(table.get("name", f"gear{len(self.gears) + 1}"), first, second, self.number(table["ratio"]))
            line = self.way_map[first.way] - gear.ratio * self.way_map[second.way]
            gear.row = len(self.row_map)
            self.row_map = np.concatenate([self.row_map, line[None]])
            self.row_constant = np.append(self.row_constant, -(line @ scalars))
            self.gears.append(gear)

    def mount_forces(self, state, kin, u):
        """Generalised forces [nf], of each bushing (force and moment on its second part, by its own axes), stored energy, and
        power dissipated."""
        S, dS, S1, _ = kin
        Q, told, stored, lost = np.zeros(self.nf), [], 0.0, 0.0
        for b in self.bushings:
            ways, rates = self.way_map[b.ways] @ S + self.way_constant[b.ways], self.way_map[b.ways] @ S1
            n = len(b.ways)
            force = -b.stiffness[:n] * ways - b.damping[:n] * rates
            Q += force @ (self.way_map[b.ways] @ dS)
            stored += float(b.stiffness[:n] @ ways**2) / 2
            lost += float(b.damping[:n] @ rates**2)
            if self.space:
                theta, by, rate, axes = b.turn(state, u)
                moment = -b.stiffness[3:] * theta - b.damping[3:] * rate
                full = np.zeros((len(self.names), 6))
                full[b.first, 3:], full[b.second, 3:] = np.split(moment @ by, 2)
                Q += full.reshape(-1)[self.free]
                stored += float(b.stiffness[3:] @ theta**2) / 2
                lost += float(b.damping[3:] @ rate**2)
                # of the second part, seen in the axes of the first
                force = np.concatenate([force, axes.T @ state.R[b.second] @ (moment @ by)[3:]])
            told.append(force)
        return Q, told, stored, lost
