"""Forces, links, and the laws, drives, locks and friction of joints as the study gives them."""

import numpy as np

from formula import Jet
from study import Unreadable as Refused

class Laws:
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
        given = t.get("lock", [])
        j.locks = [dict(at=self.number(lock["at"]), kind=lock["kind"], stiffness=self.number(lock.get("stiffness", 0.0)),
                        damping=self.number(lock.get("damping", 0.0)), side=lock.get("side"))
                   for lock in (given if isinstance(given, list) else [given])]
        j.rate = self.number(t["rate"]) if "rate" in t else None
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
