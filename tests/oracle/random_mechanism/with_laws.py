"""Random mechanisms with Bouc-Wen elements and nonlinear springs on the coordinates of joints, and between coordinates, for seeds from 35001
on."""

import pathlib

import numpy as np

from random_mechanism import Generator
from random_mechanism.draws import number

FIRST, LAST = 35001, 39999


class WithLaws(Generator):
    """Joints with laws have neither drives nor locks of their own: those are the other seeds'."""

    def push(self, names):
        super().push(names)
        free = [t for t in self.tables["joint"] if t["type"] in ("revolute", "prismatic", "screw", "strut") and "drive" not in t and "lock" not in t]
        self.rng.shuffle(free)
        for table in free[: int(self.rng.integers(1, 4))]:
            name = table.get("name", f"joint{self.tables['joint'].index(table) + 1}")
            turning = table["type"] in ("revolute", "screw")
            unit = self.F * self.L if turning else self.F
            here = self._here(table) if table["type"] == "strut" else 0.0
            self.law({"joint": name}, unit, 1.0 if turning else self.L, here)
        if not free or self.chance(0.3):
            self.between()

    def _here(self, table):
        """The length with which a strut begins."""
        ends = [np.array(table[key]) if key in table else self.place_of(str(who))[: len(self.vector(np.zeros(3)))] * self.L
                for key, who in zip(("at", "to"), table["between"])]
        return float(np.linalg.norm(ends[1] - ends[0])) / self.L

    def between(self):
        parts = [p for p in self.parts if not any(s["node"] == p[0] for s in self.tables["support"])]
        if not parts:
            return
        name, _, is_body = parts[int(self.rng.integers(len(parts)))]
        letter = self.pick("x", "y", "rz") if is_body and not self.space else self.pick("x", "y")
        ends = [f"{name}.{letter}", "ground"] if self.chance(0.5) else ["ground", f"{name}.{letter}"]
        turning = letter == "rz"
        self.law({"between": ends}, self.F * (self.L if turning else 1), 1.0 if turning else self.L, 0.0)

    def law(self, where, unit, measure, here):
        k = self.log(0.3, 20) * unit / measure
        if self.chance(0.55):
            n = self.pick(1, 1.5, 2, 3)
            A = self.pick(1.0, self.log(0.5, 2))
            start = here * measure
            together = A / ((max(self.log(0.1, 2), 0.2 * abs(here)) * measure) ** n)
            share = self.pick(0.5, self.uniform(0.5, 1.4), 0.3)
            part = {**where, "stiffness": self.value(k), "post_yield_ratio": 0.0 if start else self.uniform(0, 0.5), "A": A,
                    "beta": self.value(together * share), "gamma": self.value(together * (1 - share)), "n": n}
            key = "bouc_wen"
        else:
            u, v = f"((u - {number(here * measure)})/{number(measure)})", f"(rate*{number(self.T / measure)})"
            a = number(self.log(0.3, 8) * unit)
            formulas = [f"{a}*{u}^3", f"{a}*({u} + 0.3*{u}^3)", f"{a}*tanh(2*{u})", f"{a}*{u} + 0.2*{a}*{v}", f"{a}*max({u} - 0.1, 0) + 0.1*{a}*{v}*abs({v})",
                        f"{a}*sinh({u}) + 0.1*{a}*{v}*(1 + {u}^2)", f"{a}*{u}*(1 + 0.4*sin(3*t*{number(1 / self.T)}))",
                        f"0.3*{a}*tanh({v})"]
            part, key = {**where, "force": self.pick(*formulas)}, "nonlinear_spring"
        if self.chance(0.5):
            part["name"] = self.pick("mount ", "wire") + str(sum(len(self.tables.get(k, [])) for k in ("bouc_wen", "nonlinear_spring")))
        self.tables.setdefault(key, []).append(part)


def generate(seed, folder):
    pathlib.Path(folder).mkdir(parents=True, exist_ok=True)
    return WithLaws(seed, folder).write()
