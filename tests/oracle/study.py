"""A study file as plain data: parameters, numbers, formulas, and laws of time with the times at which they switch.

This is all that the structures (`structure/`) and the mechanisms (`mechanism*.py`) of the oracle have in common.
"""

import bisect
import csv
import math
import pathlib
import re
import tomllib

import numpy
from scipy.interpolate import CubicSpline

from formula import Formula, Jet


class Unreadable(Exception):
    """The oracle cannot answer this study, or believes that it is refused."""


class Study:
    """`raw` is the TOML as it stands; `parameters` the values of the parameters, by name.

    `with_parameters({"Omega": 2.0})` is the same study with other values, as `--set` and sweeps make it: parameters
    given by formulas follow, unless they are set themselves.
    """

    def __init__(self, path, settings=None):
        self.path = pathlib.Path(path)
        self.folder = self.path.parent
        self.raw = tomllib.loads(self.path.read_text())
        self.settings = dict(settings or {})
        self.parameters = {}
        for name, value in self.raw.get("parameters", {}).items():
            self.parameters[name] = (float(self.settings[name]) if name in self.settings else self.number(value))
        unknown = set(self.settings) - set(self.parameters)
        if unknown:
            raise Unreadable(f"no such parameters: {unknown}")

    def with_parameters(self, settings):
        return Study(self.path, {**self.settings, **settings})

    def number(self, value):
        """A number, or a formula of the parameters."""
        if isinstance(value, bool):
            raise Unreadable("a number is expected, found a boolean")
        if isinstance(value, (int, float)):
            return float(value)
        return float(Formula(value, self.parameters)(**self.parameters))

    def numbers(self, values):
        return numpy.array([self.number(value) for value in values])

    def formula(self, text, variables=("t",)):
        """A callable of the variables, by keyword; parameters are put in. It has `.parsed`, the Formula."""
        parsed = Formula(text, set(self.parameters) | set(variables))
        constants = dict(self.parameters)

        def value(**variables_now):
            return parsed(**{**constants, **variables_now})
        value.parsed = parsed
        value.decisions = lambda **now: parsed.decisions(**{**constants, **now})
        value.along = lambda chosen, **now: parsed.along(chosen, **{**constants, **now})
        return value

    def table(self, name):
        """The columns of a CSV file of numbers below its header: an array [rows x columns]."""
        rows = []
        with open(self.folder / name, newline="") as file:
            for row in csv.reader(line for line in file if line.strip() and not line.lstrip().startswith("#")):
                try:
                    rows.append([float(cell) for cell in row])
                except ValueError:
                    if rows:
                        raise Unreadable(f"{name}: {row}") from None
        return numpy.array(rows)

    def law(self, part):
        """The law of time in a table of the study: `[[force]]`, `[base_motion]`, `[[displacement]]`, ..."""
        if "amplitude" in part:
            frequency = (self.number(part["angular_frequency"]) if "angular_frequency" in part
                         else 2 * math.pi * self.number(part["frequency"]))
            return HarmonicLaw(self.number(part["amplitude"]), frequency, self.number(part.get("phase", 0.0)))
        if "expression" in part:
            return FormulaLaw(self.formula(part["expression"]))
        if "table" in part:
            return TableLaw(self.table(part["table"]), part.get("beyond", "error"))
        raise Unreadable(f"no law of time in {part}")


class HarmonicLaw:
    """amplitude cos(angular_frequency t + phase)"""

    def __init__(self, amplitude, angular_frequency, phase):
        self.amplitude, self.angular_frequency, self.phase = amplitude, angular_frequency, phase

    def value(self, t, side=0):
        return self.amplitude * math.cos(self.angular_frequency * t + self.phase)

    def motion(self, t, side=0):
        """Value, first and second derivative."""
        w, angle = self.angular_frequency, self.angular_frequency * t + self.phase
        return (self.amplitude * math.cos(angle), -self.amplitude * w * math.sin(angle),
                -self.amplitude * w * w * math.cos(angle))

    def switches(self, begin, end):
        return []

    def shortest_time(self, begin, end):
        return 2 * math.pi / abs(self.angular_frequency) if self.angular_frequency else math.inf


class FormulaLaw:
    def __init__(self, formula):
        self.formula = formula

    def value(self, t, side=0):
        """At `t`; with side -1 or +1 just before or after, where the formula may switch. No time precedes the study."""
        return float(self.formula(t=beside(t, side) if t or side > 0 else 0.0))

    def motion(self, t, side=0):
        jet = self.formula(t=Jet(beside(t, side) if t or side > 0 else 0.0, 1.0, 0.0))
        return (jet.v, jet.d, jet.dd) if isinstance(jet, Jet) else (float(jet), 0.0, 0.0)

    def switches(self, begin, end, samples=5003):
        """Times inside at which a choice within the formula changes, to round-off; found by sampling."""
        text = self.formula.parsed.text
        if not re.search(r"[<>?]|==|!=|&&|\|\||abs|min|max|sign|rint", text):
            return []
        times = numpy.linspace(begin, end, samples)
        found = []

        def search(a, at_a, b, at_b):
            if at_a == at_b:
                return
            middle = 0.5 * (a + b)
            if middle <= a or middle >= b or b - a < 1e-18 * (end - begin):  # where a row may stand on it
                found.append(b)
                return
            at_middle = self.formula.decisions(t=middle)
            search(a, at_a, middle, at_middle)
            search(middle, at_middle, b, at_b)
        before = self.formula.decisions(t=times[0])
        for a, b in zip(times[:-1], times[1:]):
            after = self.formula.decisions(t=b)
            search(a, before, b, after)
            before = after
        merged = []
        for t in sorted(found):
            if begin < t < end and (not merged or t - merged[-1] > 1e-13 * max(end, -begin)):
                merged.append(t)
        return merged

    def shortest_time(self, begin, end):
        return (end - begin) / 50


class TableLaw:
    """Rows (time, value), straight in between; two rows of one time are a jump."""

    def __init__(self, rows, beyond):
        self.times, self.values, self.beyond = [float(t) for t in rows[:, 0]], rows[:, 1], beyond
        self._spline = None

    def value(self, t, side=0):
        if t < self.times[0] or t > self.times[-1] or (t == self.times[-1] and side > 0 and self.beyond != "error"):
            return self._outside(t)
        if t == self.times[0] and side < 0 and t > 0 and self.beyond == "zero":
            return 0.0
        # of two rows at t the second, unless the value before is asked for
        after = bisect.bisect_left(self.times, t) if side < 0 else bisect.bisect_right(self.times, t)
        if after == 0:
            return float(self.values[0])
        if after == len(self.times):
            return float(self.values[-1])
        t0, t1 = self.times[after - 1], self.times[after]
        if t1 == t0:
            return float(self.values[after])
        return float(self.values[after - 1] + (self.values[after] - self.values[after - 1]) * (t - t0) / (t1 - t0))

    def _outside(self, t):
        if self.beyond == "zero":
            return 0.0
        if self.beyond == "hold":
            return float(self.values[0] if t < self.times[0] else self.values[-1])
        raise Unreadable(f"the table ends before {t}")

    def motion(self, t, side=0):
        """Of a support that moves: a natural cubic spline through the rows."""
        if self._spline is None:
            self._spline = CubicSpline(self.times, self.values, bc_type="natural")
        if t < self.times[0] or t > self.times[-1]:
            return self._outside(t), 0.0, 0.0
        return tuple(float(self._spline(t, order)) for order in range(3))

    def switches(self, begin, end):
        return sorted({t for t in self.times if begin < t < end})

    def shortest_time(self, begin, end):
        gaps = [b - a for a, b in zip(self.times[:-1], self.times[1:]) if b > a]
        return 2 * min(gaps) if gaps else math.inf


def beside(t, side):
    return t if side == 0 else t + side * 4e-15 * max(1e-3, abs(t)) * 16
