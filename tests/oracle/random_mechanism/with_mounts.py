"""Random mechanisms with bushings, gears, several locks on a joint, starts on locks and rates of joints, for seeds from 40001 on; each with
a gear for seeds from 45001 on."""

import pathlib

import numpy as np

from random_mechanism import Generator

FIRST, GEARED, LAST = 40001, 45001, 49999
ONE_WAY = ("revolute", "prismatic", "screw", "strut")
IMPLICIT = ["average_acceleration", "galerkin", "backward_difference", "damped_newmark", {"name": "newmark", "beta": 0.3025, "gamma": 0.6},
            {"name": "hht", "alpha": -0.2}, {"name": "wbz", "rho_inf": 0.6}, {"name": "generalized_alpha", "rho_inf": 1.0}]


class WithMounts(Generator):
    geared = 0.35      # the share of models for which a gear is sought

    def push(self, names):
        super().push(names)
        wanted = [what for what, share in ((self.gears, self.geared), (self.bushings, 0.45), (self.locks, 0.5), (self.rates, 0.4)) if self.chance(share)]
        for what in wanted:
            what()
        for what in (self.bushings, self.locks, self.rates):
            if not self.tables.get("gear") and not self.tables.get("bushing") and not any({"lock", "rate"} & set(t) for t in self.tables["joint"]):
                what()

    def analyses(self):
        """Equal steps by every implicit method."""
        super().analyses()
        method = self.pick(*IMPLICIT)
        for part in self.tables["analysis"]:
            if part["name"] in ("coarse", "half"):
                part["method"] = method
                if method == "average_acceleration" or isinstance(method, dict) and method.get("rho_inf") == 1.0:
                    part["project_velocities"] = True

    # ---- what is drawn ----------------------------------------------------------------------------------------------
    def gears(self):
        """Between joints of different parts, of which one more may be tied: never two that are driven, or one and a lock."""
        joints = [t for t in self.one_way() if self.tables["node"] or t["type"] != "strut"]
        if len(joints) < 2 or self.closed():
            return
        first, second = (joints[i] for i in self.rng.permutation(len(joints))[:2])
        if "drive" in first and ("drive" in second or "lock" in second) or "drive" in second and "lock" in first:
            return
        if "friction" in first and "friction" in second or any("drive" in t for t in (first, second)):
            first.pop("friction", None), second.pop("friction", None)
        for table in (first, second):
            self.still_something(table)
        ratio = self.log(0.3, 3) * self.pick(1, -1) * self.measure(first) / self.measure(second)
        gear = {"joints": [self.name_of(first), self.name_of(second)], "ratio": self.value(ratio)}
        if self.chance(0.6):
            gear["name"] = self.pick("wheels", "teeth 1")
        self.tables["gear"] = [gear]

    def bushings(self):
        turning = [n for n, _, is_body in self.parts if is_body or any(n == m["node"] and "inertia" in m for m in self.tables["mass"])
                   or self.has_beams and any(n in b["nodes"] for b in self.tables["beam"])]
        turning = [n for n in turning if not any(s["node"] == n for s in self.tables["support"])]
        out = []
        for _ in range(self.pick(1, 1, 2) if turning else 0):
            ends = [str(x) for x in self.rng.choice(["ground"] + turning, 2, replace=False)]
            stiff, turn = self.F / self.L, self.F * self.L
            units = [stiff] * 3 + [turn] * 3 if self.space else [stiff] * 2 + [turn]
            table = {"between": ends, "at": self.vector(self.place_of(ends[1]) + 0.5 * self.point(), self.L),
                     "stiffness": [0.0 if self.chance(0.1) else self.log(0.5, 30) * u for u in units]}
            if self.chance(0.7) or not any(table["stiffness"]):
                table["damping"] = [0.0 if self.chance(0.1) else self.log(0.05, 2) * u * self.T for u in units]
                table["damping"][0] = 0.3 * stiff * self.T
            if self.space and self.chance(0.6):
                table["rotation"] = [float(x) for x in self.rng.normal(size=3)]
            if not self.space and self.chance(0.6):
                table["axis"] = self.vector(self.axis())
            if self.chance(0.6):
                table["name"] = f"mount {len(out) + 1}"
            out.append(table)
        if out:
            self.tables["bushing"] = out

    def locks(self):
        """One to three on a joint, in any order; rigid ones lie behind the others of their side. Some joints start on one."""
        joints = [t for t in self.one_way() if "drive" not in t and not self.driven_by_gear(t)]
        if self.closed() and any("drive" in t for t in self.tables["joint"]):
            return
        for i in self.rng.permutation(len(joints))[: self.pick(1, 1, 2)]:
            table = joints[i]
            here, measure = self.here(table), self.measure(table)
            unit = self.F * (self.L if measure == 1.0 else 1)
            locks = []
            for side in self.pick([-1, 1], [-1, 1], [-1], [1]):
                reach = abs(here) if table["type"] == "strut" else measure
                distances = sorted(self.uniform(0.05, 0.4) * reach for _ in range(self.pick(1, 1, 2)))
                if locks == [] and self.chance(0.3):
                    distances[0] = 0.0
                for k, distance in enumerate(distances):
                    soft = k + 1 < len(distances) or self.chance(0.4)
                    lock = {"at": here + side * distance, "kind": self.pick("stop", "stop", "stop", "latch")}
                    if soft:
                        lock["stiffness"] = self.log(30, 300) * unit / measure
                        if self.chance(0.6):
                            lock["damping"] = self.uniform(0.2, 3) * unit * self.T / measure
                    if distance == 0 or self.chance(0.3):
                        lock["side"] = "below" if side > 0 else "above"
                    locks.append(lock)
            table["lock"] = [locks[k] for k in self.rng.permutation(len(locks))] if len(locks) > 1 or self.chance(0.5) else locks[0]

    def rates(self):
        """Of one or two joints; bodies whose velocities are left out follow."""
        if self.has_beams:
            return
        joints = [t for t in self.one_way() if "drive" not in t and not self.driven_by_gear(t)]
        if self.closed() and any("drive" in t for t in self.tables["joint"]) or any(t["type"] == "distance" for t in self.tables["joint"]):
            return
        geared = {n for g in self.tables.get("gear", []) for n in g["joints"]}
        for k, i in enumerate(self.rng.permutation(len(joints))[: 1 if self.closed() else 2]):
            if k and self.name_of(joints[i]) in geared:
                continue
            joints[i]["rate"] = self.value(self.rng.normal() * self.measure(joints[i]) / self.T)
        for part in self.tables["body"] + self.tables["node"]:
            for key in ("velocity", "angular_velocity"):
                if self.chance(0.6):
                    part.pop(key, None)

    # ---- what is there ----------------------------------------------------------------------------------------------
    def one_way(self):
        """Joints that leave one coordinate; of nodes that do not turn hinges have none."""
        bodies = {"ground"} | {b["name"] for b in self.tables["body"]}
        return [t for t in self.tables["joint"] if t["type"] == "strut" or t["type"] in ONE_WAY and set(t["between"]) <= bodies]

    def closed(self):
        """A linkage of one freedom, or a part that joints hold twice: what ties more of it may hold it altogether."""
        seconds = [tuple(sorted(t["between"])) for t in self.tables["joint"]]
        held = len([t for t in self.tables["joint"] if t["type"] not in ("strut",)])
        return bool(self.tables["body"]) and held > len(self.tables["body"]) or len(set(seconds)) < len(seconds)

    def driven_by_gear(self, table):
        geared = next((g["joints"] for g in self.tables.get("gear", []) if self.name_of(table) in g["joints"]), [])
        return any("drive" in t and self.name_of(t) in geared for t in self.tables["joint"])

    def name_of(self, table):
        return table.get("name", f"joint{self.tables['joint'].index(table) + 1}")

    def measure(self, table):
        return 1.0 if table["type"] in ("revolute", "screw") else self.L

    def still_something(self, table):
        if table["type"] == "strut" and not set(table) & {"stiffness", "damping", "force", "drive", "lock", "friction"}:
            table["force"] = 0

    def here(self, table):
        """The coordinate in the configuration given, in the units of the study."""
        if table["type"] != "strut":
            given = table.get("angle", table.get("displacement", 0.0))
            return 2 * self.tables["parameters"][given.partition("*")[2]] if isinstance(given, str) else given
        ends = [np.array(table[key]) if key in table else self.place_of(str(who))[: 3 if self.space else 2] * self.L
                for key, who in zip(("at", "to"), table["between"])]
        return float(np.linalg.norm(ends[1] - ends[0]))


def generate(seed, folder):
    pathlib.Path(folder).mkdir(parents=True, exist_ok=True)
    made = WithMounts(seed, folder)
    made.geared = 1.0 if seed >= GEARED else made.geared
    path = made.write()
    while seed >= GEARED and "gear" not in made.tables:
        made = WithMounts(int(made.rng.integers(1 << 31)), folder)
        made.geared = 1.0
        path = made.write()
    return path
