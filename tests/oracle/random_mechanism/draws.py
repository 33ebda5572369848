"""Small draws, and laws of time."""

import math

import numpy as np

def number(value):
    """A number as a formula takes it."""
    return f"({float(value):.13g})"


def rotation_matrix(v):
    angle = np.linalg.norm(v)
    if angle == 0:
        return np.eye(3)
    x, y, z = v / angle
    s = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + math.sin(angle) * s + (1 - math.cos(angle)) * s @ s


class Draws:
    def chance(self, p):
        return bool(self.rng.random() < p)

    def pick(self, *options):
        return options[int(self.rng.integers(len(options)))]

    def uniform(self, a, b):
        return float(self.rng.uniform(a, b))

    def log(self, a, b):
        return float(10 ** self.rng.uniform(math.log10(a), math.log10(b)))

    def point(self):
        p = self.rng.uniform(-1, 1, 3)
        if not self.space:
            p[2] = 0
        return p

    def vector(self, p, scale=1.0):
        return [float(x) * scale for x in (p if self.space else p[:2])]

    def axis(self):
        """A direction, as a vector of any length."""
        if self.space and self.chance(0.4):
            e = np.zeros(3)
            e[int(self.rng.integers(3))] = self.pick(1.0, -1.0)
            return e
        v = self.rng.normal(size=3)
        if not self.space:
            v[2] = 0
        return v / np.linalg.norm(v) * self.pick(1.0, 1.0, 2.5)

    def value(self, x):
        """A number, now and then as an expression of a parameter."""
        if self.chance(0.1):
            name = f"p{len(self.tables['parameters']) + 1}"
            self.tables["parameters"][name] = float(x) / 2
            return f"2*{name}"
        return float(x)

    # ---- laws of time -----------------------------------------------------------------------------------------------
    def time_formula(self, size):
        """A formula of t of about this size."""
        a, w = number(size), number(self.uniform(1, 6) / self.T)
        t0 = number(self.uniform(0.2, 0.8) * self.duration * self.T)
        t1 = number(self.uniform(0.05, 0.2) * self.duration * self.T)
        kind = int(self.rng.integers(9))
        if kind >= 5:
            self.jumps = True
        return [f"{a}*sin({w}*t)", f"{a}*exp(-t/{t1})", f"{a}*(1 - cos({w}*t))^2/4", f"{a}*tanh(sin({w}*t))", f"{a}",
                f"t < {t0} ? {a} : -0.5*{a}", f"t > {t0} && t < {t0} + {t1} ? {a} : 0", f"{a}*abs(t - {t0})/{t0}",
                f"{a}*min(1, t/{t0})"][kind]

    def table_file(self, header, rows):
        self.count += 1
        name = f"table{self.count}.csv"
        (self.folder / name).write_text(header + "\n" + "".join(f"{a:.13g},{b:.13g}\n" for a, b in rows))
        return name

    def load(self, size, unit):
        kind = int(self.rng.integers(4))
        if kind == 0:
            law = {"amplitude": self.value(size), "phase": self.uniform(-3, 3)}
            w = self.uniform(1, 8) / self.T
            if self.chance(0.5):
                law["angular_frequency"] = self.value(w)
            else:
                law["frequency"] = self.value(w / (2 * math.pi))
            return law
        if kind == 1:
            n = int(self.rng.integers(2, 6))
            times = np.sort(self.rng.uniform(0, self.duration, n)) * self.T
            times[0] = 0 if self.chance(0.7) else times[0]
            last = self.duration * self.T * (1.01 if self.chance(0.5) else 0.7)
            rows = [(t, self.uniform(-1, 1) * size) for t in times] + [(max(last, times[-1] + 0.01 * self.T), 0.3 * size)]
            beyond = self.pick("zero", "hold")
            if self.chance(0.2):
                rows.insert(1, (rows[1][0], -rows[1][1]))
                self.jumps = True
            self.jumps = True
            return {"table": self.table_file(f"time [s],force [{unit}]", rows), "beyond": beyond}
        return {"expression": self.time_formula(size)}
