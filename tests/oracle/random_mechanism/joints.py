"""Random joints: their laws, friction, locks and drives."""

import numpy as np

from random_mechanism.draws import number

class RandomJoints:
    def joint(self, kind, first, second, at=None, to=None, plain=False, axis=None):
        L, F = self.L, self.F
        number_here = len(self.tables["joint"]) + 1
        name = f"j{number_here}" if self.chance(0.8) else f"joint {number_here}"
        table = {"name": name, "type": kind, "between": [first, second]}
        if self.chance(0.1):
            name = f"joint{number_here}"     # what it is called without a name
            del table["name"]
        if at is not None:
            table["at"] = self.vector(at, L)
        if to is not None:
            table["to"] = self.vector(to, L)
        if axis is None:
            axis = self.axis()
        if kind in ("prismatic",) or (self.space and kind in ("revolute", "cylindrical", "screw", "planar", "universal")):
            table["axis"] = self.vector(axis)
        if kind == "universal":
            other = np.cross(axis, self.rng.normal(size=3))
            other /= np.linalg.norm(other)
            table["second_axis"] = self.vector(other)
        if kind == "screw":
            table["lead"] = self.pick(-1.0, 1.0) * self.uniform(0.3, 3.0) * L
        if kind == "distance" and self.chance(0.3):
            table["length"] = float(np.linalg.norm((to if to is not None else self.place_of(second))
                                                   - (at if at is not None else self.place_of(first)))) * L
        turning = kind in ("revolute", "screw")
        unit = F * L if turning else F
        here = 0.0
        if turning and self.chance(0.3):
            here = self.uniform(-2, 2)
            table["angle"] = self.value(here)
        if kind == "prismatic" and self.chance(0.3):
            here = self.uniform(-1, 1)
            table["displacement"] = self.value(here * L)
        if kind == "strut":
            here = float(np.linalg.norm((to if to is not None else self.place_of(second)) - (at if at is not None else self.place_of(first))))
        measure = 1.0 if turning else L
        if kind in ("revolute", "prismatic", "screw", "strut") and not plain:
            self.decorate(table, kind, here, measure, unit, turning)
        if kind in ("revolute", "prismatic", "screw", "strut", "cylindrical", "universal", "planar") and "drive" not in table:
            self.rub(table, kind)
        if kind == "strut" and not set(table) & {"stiffness", "damping", "force", "drive", "lock", "friction"}:
            table["force"] = 0
        self.tables["joint"].append(table)
        return name

    def decorate(self, table, kind, here, measure, unit, turning):
        T = self.T
        way = "angle" if turning else "length" if kind == "strut" else "displacement"
        if self.drive_wanted and self.chance(0.35):
            self.drive_wanted = False
            table["drive"] = self.drive(here, measure)
            if self.chance(0.3):
                table["damping"] = self.uniform(0.1, 1) * unit * T / measure
            return
        if self.chance(0.5):
            table["stiffness"] = self.value(self.log(0.5, 30) * unit / measure)
            if self.chance(0.5):
                table["rest"] = self.value((here + self.uniform(-0.5, 0.5) * (1 if kind != "strut" else here)) * measure)
        if self.chance(0.4):
            table["damping"] = self.value(self.log(0.05, 2) * unit * T / measure)
        what = self.rng.random()
        key = "moment" if turning else "force"
        if what < 0.3:
            a = number(self.uniform(0.3, 2) * unit)
            x = f"(({way} - {number(here * measure)})/{number(measure)})"
            v = f"(rate*{number(T / measure)})"
            t = f"(t/{number(T)})"
            formulas = [f"-{a}*{x}^3", f"-{a}*tanh(3*{v})", f"{a}*sin(3*{t}) - {a}*{v}", f"-{a}*{v}*abs({v})",
                        f"t < {number(0.5 * self.duration * T)} ? {a} : -{a}*{x}", f"{a}*cos(2*{x})", f"{a}*(1 - 0.5*{v})",
                        f"-{a}*max(0, {x} - 0.03)", f"{a}*exp(-{x}^2)*{t}"]
            if kind == "strut":
                formulas += [f"{a}/(0.3 + ({way}/{number(measure)})^2)"]
            table[key] = self.pick(*formulas)
            self.jumps = True
        elif what < 0.45:
            n = int(self.rng.integers(2, 6))
            if kind == "strut":
                x = np.linspace(0.1 * here, 3 * here, n)
            else:
                x = here + 0.137 + np.linspace(-1, 1, n) * self.uniform(0.5, 4)   # no row at the start: a kink has two slopes
            rows = [(a * measure, self.uniform(-1, 1) * unit) for a in x]
            head = "angle [rad],moment [N m]" if turning else "length [m],force [N]"
            table[key] = {"table": self.table_file(head, rows), "beyond": self.pick("zero", "hold")}
        if self.lock_wanted and self.chance(0.5) and (self.chance(0.4) or not {"force", "moment"} & set(table)):
            self.lock_wanted = False
            side = self.pick(-1.0, 1.0)
            at = here + side * self.uniform(0.05, 0.4) * (here if kind == "strut" else 1.0)
            lock = {"at": at * measure, "kind": self.pick("stop", "latch")}
            if self.chance(0.6):
                lock["stiffness"] = self.log(30, 300) * unit / measure
                if self.chance(0.6):
                    lock["damping"] = self.uniform(0.2, 3) * unit * T / measure
            table["lock"] = lock

    def rub(self, table, kind):
        if not self.friction_wanted or self.dry >= 2 or self.reaction or not self.chance(0.5):
            return
        turning = kind in ("revolute", "screw", "cylindrical", "universal")
        f = {"coefficient": self.value(self.uniform(0.05, 0.4))}
        if kind != "strut" and self.dry == 0 and self.chance(0.5):
            f["normal_load"] = "reaction"
            self.reaction = True
        else:
            f["preload"] = self.value(self.uniform(0.5, 5) * self.F)
        if turning:
            f["radius"] = self.uniform(0.05, 0.3) * self.L
        table["friction"] = f
        self.dry += 2 if kind in ("cylindrical", "planar", "universal") else 1

    def drive(self, here, measure):
        T = self.T
        a, w = number(self.uniform(0.2, 0.8) * measure * self.pick(1, -1)), number(self.uniform(1, 4) / T)
        h, tau = number(here * measure), number(self.uniform(0.1, 0.4) * T)
        if self.chance(0.2):
            times = np.concatenate([[0], np.sort(self.rng.uniform(0.1, 0.9, 2))]) * self.duration * T
            values = here * measure + np.concatenate([[0], self.rng.uniform(-0.4, 0.4, 2) * measure])
            self.jumps = True
            return {"table": self.table_file("time [s],value", list(zip(times, values))), "beyond": "hold"}
        return self.pick(f"{h} + {a}*(1 - cos({w}*t))", f"{h} + {a}*sin({w}*t)", f"{h} + {a}*{w}*(t - {tau}*(1 - exp(-t/{tau})))",
                         f"{h} + {a}*({w}*t)^3/(1 + ({w}*t)^2)", f"{h} + {a}*tanh({w}*t)^2")
