"""Random studies with Bouc-Wen and Dahl elements, nonlinear springs, cables and regularised friction, for seeds from 30001 on: `generate_laws.py SEED FOLDER`.

Models, sliders, stops and loads are drawn as in `generate.py`.
"""

import math
import sys

import numpy

from generate import Generator
from structure.model import read_model
from study import Study, Unreadable

FIRST, LAST = 30001, 34999


class WithLaws(Generator):
    def contacts(self):
        self.periodic = self.chance(0.4)  # whether responses are asked for: forces of t have no place there
        super().contacts()
        ends = list(self.names)
        turning = [r for r in getattr(self, "rotations", [])] if self.frames else []
        several = self.random.choice([1, 1, 1, 2, 2, 3])
        for _ in range(several):
            between, k, x = self.ends(ends), self.stiffness * self.log(0.1, 3), self.x
            if turning and self.chance(0.2):
                between = [self.random.choice(turning), "ground"]
                length = self.lever() * self.log(0.03, 0.3)
                k, x = k * length**2, x / length
            if self.chance(0.2):
                self.named(between, k, x)
            elif self.chance(0.5):
                self.bouc_wen(between, k, x)
            else:
                self.spring(between, k, x)

    def lever(self):
        return max(math.hypot(*node["position"]) for node in self.tables["node"]) or 1.0

    def ends(self, ends):
        first = self.random.choice(ends)
        second = self.random.choice([e for e in ends if e != first] + ["ground", "ground"])
        return [first, second] if self.chance(0.6) or second == "ground" and self.chance(0.5) else [second, first]

    def bouc_wen(self, between, k, x):
        n = self.random.choice([1, 1.5, 2, 3])
        A = self.random.choice([1.0, 1.0, self.log(0.4, 2.5)])
        together = A / (x * self.log(0.1, 3))**n  # beta + gamma, from the largest z
        share = self.random.choice([0.5, 0.5, self.uniform(0.5, 1.5), 0.25])
        part = {"between": between, "stiffness": self.number(k)}
        if self.chance(0.8):
            part["post_yield_ratio"] = self.number(self.random.choice([0.0, 0.1, self.uniform(0.01, 0.6)]))
        if A != 1 or self.chance(0.3):
            part["A"] = self.number(A)
        part["beta"] = self.number(together * share)
        part["gamma"] = self.number(float(f"{together - float(f'{together * share:.8g}'):.8g}"))
        if n != 1 or self.chance(0.5):
            part["n"] = n if self.chance(0.8) else self.number(n)
        if self.chance(0.5):
            part["name"] = self.random.choice(["joint ", "wire", "frame "]) + str(len(self.tables.get("bouc_wen", [])))
        self.tables.setdefault("bouc_wen", []).append(part)

    def named(self, between, k, x):
        """Laws that are Bouc-Wen elements and formulas under names of their own."""
        table = self.random.choice(["dahl", "smooth_friction", "cable"])
        part = {"between": between}
        if table == "dahl":
            part |= {"stiffness": self.number(k), "slip_force": self.number(k * x * self.log(0.1, 3))}
        elif table == "cable":
            # Not at rest where it becomes taut: which slope it has there is a matter of taste.
            part |= {"stiffness": self.number(k), "length": self.number(x * self.random.choice([-1, 1]) * self.uniform(0.1, 0.5))}
        else:
            part |= {"friction_coefficient": self.number(self.uniform(0.1, 0.8)), "normal_load": self.number(k * x),
                     "velocity": self.number(x * self.omega * self.log(0.1, 1))}
        if self.chance(0.5):
            part["name"] = f"{table} of its own {len(self.tables.get(table, []))}"
        self.tables.setdefault(table, []).append(part)

    def spring(self, between, k, x):
        a = self.size
        v, t = x * self.omega, self.duration
        elastic = [f"{a(k)}*u + {a(k * self.log(0.1, 2) / x**2)}*u^3", f"{a(k * x)}*tanh(u/{a(x)})", f"{a(k * x)}*sinh(u/{a(x)})/2",
                   f"{a(k)}*max(u - {a(0.3 * x)}, 0)", f"{a(k)}*u/(1 + abs(u)/{a(x)})", f"{a(k)}*u + {a(0.3 * k / x)}*u*abs(u)",
                   f"abs(u) < {a(0.5 * x)} ? {a(k)}*u : {a(2 * k)}*u - sign(u)*{a(0.5 * k * x)}", f"{a(k * self.log(0.1, 2) / x**2)}*u^3",
                   f"{a(k)}*u - {a(k * self.uniform(0.05, 0.3) / x)}*u^2 + {a(k * 0.4 / x**2)}*u^3", f"{a(k)}*u + {a(0.2 * k * x)}*atan(3*u/{a(x)})"]
        c = k / self.omega * self.log(0.01, 0.5)
        viscous = [f"{a(c)}*rate", f"{a(c / v)}*rate*abs(rate)", f"{a(c)}*rate*(1 + (u/{a(x)})^2)", f"{a(c * v)}*tanh(rate/{a(0.3 * v)})",
                   f"{a(c / v**2)}*rate^3", f"{a(c)}*max(rate, 0) + {a(c / 3)}*min(rate, 0)"]
        force = self.random.choice(elastic)
        if self.chance(0.4):
            force = f"({force}) + {self.random.choice(viscous)}"
        elif self.chance(0.15):
            force = self.random.choice(viscous)
        if not self.periodic and self.chance(0.15):
            force += self.random.choice([f" + {a(0.2 * k * x)}*sin({a(self.omega * 0.7)}*t)", f" + {a(0.3 * k)}*u*sin({a(self.omega)}*t)^2",
                                         f" + (t < {a(0.41 * t)} ? 0 : {a(0.5 * k)}*u)"])
        part = {"between": between, "force": force}
        if self.chance(0.5):
            part["name"] = self.random.choice(["cable ", "rubber", "web "]) + str(len(self.tables.get("nonlinear_spring", [])))
        self.tables.setdefault("nonlinear_spring", []).append(part)

    def size(self, value):
        """A number within a formula, now and then by a parameter."""
        number = self.number(float(f"{value:.6g}"))
        return f"({number})"

    def displacements(self):
        if self.chance(0.12):
            self.tables["displacement"] = [{"on": self.random.choice(self.names), "value": self.number(self.x * self.uniform(-1, 1))}]

    def loads(self, kinds):
        self.sweeps = self.periodic
        super().loads(("harmonic",) if self.sweeps else kinds)
        if "force" not in self.tables:  # something has to happen
            self.tables["force"] = [{"on": self.random.choice(self.names), **self.harmonic(self.stiffness * self.x, self.omega)}]

    def analyses(self):
        self.tables["analysis"] = list_ = []
        add = list_.append
        if self.chance(0.7):
            add({"name": "rest", "type": "static"})
        if self.chance(0.5):
            add({"name": "modes", "type": "modes"})
        transient = {"type": "transient", "duration": self.number(self.duration)}
        if self.chance(0.25) and self.at_rest():
            transient["initial"] = "static"
        if self.chance(0.1):
            transient["energy"] = False
        step = {"tolerance": 10.0 ** -self.random.randint(3, 6)}
        if "slider" in self.tables and self.chance(0.7):
            step["events"] = "locate"
        automatic = {"name": "automatic", **transient, "step": step}
        if self.chance(0.4):
            method = self.random.choice(["average_acceleration", "hht", "wbz", "linear_acceleration", "dormand_prince",
                                         "bogacki_shampine", "generalized_alpha", "newmark", "central_difference"])
            if not {"bouc_wen", "dahl"} & set(self.tables) or method not in ("dormand_prince", "bogacki_shampine"):  # pairs are refused
                automatic["method"] = self.method(method)
        if self.chance(0.15):
            automatic["output"] = self.random.choice([{"every": 2}, {"interval": self.duration / 50}])
        if self.chance(0.85):
            add(automatic)
        if self.chance(0.5):
            name = self.random.choice(["average_acceleration", "hht", "wbz", "linear_acceleration", "rk4", "heun", "central_difference",
                                       "generalized_alpha", "newmark", "fox_goodwin", "midpoint", "rk3", "dormand_prince"])
            steps = self.random.choice([1000, 2000])
            duration = self._evaluate(transient["duration"])
            method = self.method(name)
            for k in (1, 2):
                add({"name": f"equal@{k}", **transient, "method": method, "step": duration / steps / k, "output": {"every": 10 * k}})
        if self.sweeps and len(self.names) <= 3 and not self.frames:
            self.responses(add)
        list_.sort(key=lambda a: a["name"])

    def responses(self, add):
        harmonics = [p for key in ("force", "distributed_force") for p in self.tables.get(key, []) if "amplitude" in p]
        harmonics += [self.tables["base_motion"]] if "base_motion" in self.tables else []
        self.tables["parameters"]["Omega"] = self.omega * 0.9
        for i, part in enumerate(harmonics):
            part.pop("frequency", None)
            part["angular_frequency"] = "Omega" if i == 0 or self.chance(0.7) else "2*Omega"
        if not harmonics:
            return
        values = [float(f"{self.omega * f:.6g}") for f in sorted(self.log(0.25, 3) for _ in range(3))]
        for solver in ("time_marching", "harmonic_balance"):
            if self.chance(0.2) or solver == "harmonic_balance" and "stop" in self.tables:
                continue
            part = {"name": solver, "type": "frequency_response", "solver": solver, "angular_frequency": values, "excitation": "Omega"}
            if self.chance(0.5):
                part["tolerance"] = self.random.choice([1e-2, 1e-3, 1e-4])
            add(part)


def generate(seed, folder):
    """A study that the oracle can march: its fastest motion is not much faster than what it does."""
    generator = WithLaws(seed, folder)
    while True:
        path = generator.build()
        try:
            if generator.tables["analysis"] and _fastest(read_model(Study(path))) * generator.duration < 5000:
                return path, generator.kind
        except Unreadable:  # a law on a rotation that all beams release
            pass
        generator = WithLaws(generator.random.random(), folder)


def _fastest(model):
    root = 1 / numpy.sqrt(numpy.diag(model.M))
    scaled = [numpy.linalg.norm(matrix * root[:, None] * root[None, :], 2) for matrix in (model.stuck_stiffness(), model.tangents()[1])]
    return max(math.sqrt(scaled[0]), scaled[1])


if __name__ == "__main__":
    print(*generate(int(sys.argv[1]), sys.argv[2]))
