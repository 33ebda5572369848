"""Small draws, numbers as formulas of parameters, and laws of time."""

import math
import pathlib
import random

from formula import Formula


class Draws:
    """`tables` is the content of a study; files besides are written into the folder."""

    def __init__(self, seed, folder):
        self.random = random.Random(seed)
        self.folder = pathlib.Path(folder)
        self.folder.mkdir(parents=True, exist_ok=True)
        self.tables = {"parameters": {}}
        self.files = 0

    # ---- small things

    def chance(self, p):
        return self.random.random() < p

    def log(self, low, high):
        return float(f"{10 ** self.random.uniform(math.log10(low), math.log10(high)):.6g}")

    def uniform(self, low, high):
        return float(f"{self.random.uniform(low, high):.6g}")

    def sign(self):
        return self.random.choice([-1, 1])

    def number(self, value):
        """Now and then an expression of a new parameter."""
        value = float(f"{value:.8g}")
        if value == 0 or not self.chance(0.12):
            return value
        name = f"p{len(self.tables['parameters'])}"
        way = self.random.randrange(4)
        if way == 0:
            self.tables["parameters"][name] = value
            return name
        if way == 1:
            self.tables["parameters"][name] = value / 2
            return f"2*{name}"
        if way == 2:
            self.tables["parameters"][name] = f"sqrt({value * value!r})*{self.random.choice(['1', '(2 > 1)', '2^0'])}"
            return name if value > 0 else f"-{name}"
        self.tables["parameters"][name] = value * 3
        return f"{name}/(2 < 1 ? 7 : 3)"

    def table_file(self, rows, header="time [s],value"):
        self.files += 1
        name = f"table{self.files}.csv"
        (self.folder / name).write_text(header + "\n" + "".join(f"{t!r},{v!r}\n" for t, v in rows))
        return name

    # ---- laws of time

    def harmonic(self, size, omega):
        law = {"amplitude": self.number(size * self.sign())}
        w = omega * self.log(0.1, 3)
        if self.chance(0.3):
            law["frequency"] = self.number(w / (2 * math.pi))
        else:
            law["angular_frequency"] = self.number(w)
        if self.chance(0.6):
            law["phase"] = self.number(self.uniform(-4, 4))
        return law

    def expression(self, size, omega, duration):
        a, w, t = f"{size:.6g}", f"{omega * self.log(0.2, 2):.6g}", duration
        t1 = self.moment(self.uniform(0.05, 0.6), t)
        t2 = t1 + self.moment(self.uniform(0.05, 0.3), t)
        k = self.random.randrange(14)
        return {"expression": [
            f"{a}*sin({w}*t)", f"t > {t1!r} && t < {t2!r} ? {a} : 0", f"{a}*min(t/{t1!r}, 1)",
            f"{a}*exp(-((t - {t1!r})/{t2 - t1!r})^2)", f"{a}*abs(sin({w}*t))",
            f"{a}*sin({w}*t)*exp(-t/{t2!r})", f"0.3 || 0 ? {a}*cos({w}*t) : 0",
            f"t < {t1!r} ? {a} : (t < {t2!r} ? -{a} : {a}/2)", f"{a}*sign(sin({w}*t))",
            f"-{a}*(t/{t!r})^2 + {a}*tanh(t/{t1!r})", f"max({a}*sin({w}*t), {a}*cos({w}*t), 0)",
            f"{a}", f"{a}*rint(3*t/{t!r})", f"{a}*sqrt(1 + t/{t1!r})*sin({w}*t + ln(1 + t/{t!r}))"][k]}

    def moment(self, share, duration):
        """Mostly where equal steps end."""
        return (max(round(share * 40), 1) / 40 if self.chance(0.6) else share) * duration

    def rows(self, size, duration, covers):
        n = self.random.randrange(3, 12)
        times = sorted({self.moment(self.uniform(0.02, 0.98), duration) for _ in range(n)})
        rows = [(0.0, self.uniform(-1, 1) * size)]
        for t in times:
            rows.append((t, self.uniform(-1, 1) * size))
            if self.chance(0.2):
                rows.append((t, self.uniform(-1, 1) * size))
        if covers:
            rows.append((duration * 1.01, self.uniform(-1, 1) * size))
        if self.chance(0.15):
            rows.insert(0, (-0.1 * duration, 0.0))
        if self.chance(0.15):
            at = next(i for i, row in enumerate(rows) if row[0] == 0.0)
            rows.insert(at, (0.0, self.uniform(-1, 1) * size))
        return rows

    def law(self, size, omega, duration, kinds=("harmonic", "expression", "table")):
        kind = self.random.choice(kinds)
        if kind == "harmonic":
            return self.harmonic(size, omega)
        if kind == "expression":
            return self.expression(size, omega, duration)
        beyond = self.random.choice([None, "zero", "hold"])
        rows = self.rows(size, duration, beyond is None)
        if beyond == "zero" and self.chance(0.8):
            rows.append((rows[-1][0], 0.0))
        law = {"table": self.table_file(rows)}
        if beyond:
            law["beyond"] = beyond
        return law

    def _evaluate(self, value):
        known = {}
        for name, number in self.tables["parameters"].items():
            known[name] = number if isinstance(number, float) else Formula(number, known)(**known)
        return value if isinstance(value, float) else Formula(value, known)(**known)
