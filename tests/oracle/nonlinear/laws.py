"""Bouc-Wen elements and nonlinear springs, read from `[[bouc_wen]]` and `[[nonlinear_spring]]`, and what is one of them
under another name: `[[dahl]]`, `[[smooth_friction]]`, `[[cable]]`. A `[[lugre]]` or `[[iwan]]` is not read.

A law gives the force f that acts on the first of its two ends as -f and on the second as +f, while u = x_first - x_second;
on the coordinate of a joint -f acts on the second part.
"""

import math

import numpy
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.special import hyp2f1

from formula import FormulaError, Jet
from study import Unreadable


class BoucWen:
    """f = alpha k u + (1 - alpha) k z,  z' = u' (A - |z|^n (gamma + beta sgn(u' z))),  z = 0 at the start.

    While u goes one way and z keeps its sign, dz/du = A - c |z|^n with c = gamma + beta where |z| grows and gamma - beta
    where it falls. So u - u0 = U(z) - U(z0), where U(z) = z/A 2F1(1, 1/n; 1 + 1/n; c |z|^n/A).
    """

    remembers = True

    def __init__(self, name, b, k, alpha, A, beta, gamma, n, rotation=False):
        self.name, self.b, self.rotation = name, b, rotation
        self.k, self.alpha, self.A, self.beta, self.gamma, self.n = k, alpha, A, beta, gamma, n
        self.z_max = (A / (beta + gamma))**(1 / n) if beta + gamma > 0 else math.inf

    def force(self, u, rate, t, z, chosen=None):
        return self.alpha * self.k * u + (1 - self.alpha) * self.k * z

    def slope(self, z, side_of_rate, side_of_z):
        """dz/du on the branch where u' and z have these signs."""
        return self.A - abs(z)**self.n * (self.gamma + self.beta * side_of_rate * side_of_z)

    def stored(self, u, z):
        return self.alpha * self.k * u * u / 2 + (1 - self.alpha) * self.k * z * z / (2 * self.A)

    def dissipating_force(self, u, rate, t, z, slope):
        """The force whose work is dissipated: what is stored takes the rest."""
        return (1 - self.alpha) * self.k * z * (1 - slope / self.A)

    def tangents(self, u=0.0, z=0.0):
        """df/du and df/du' at z = 0, where both directions have the same."""
        if z != 0:
            raise Unreadable("the tangent of a Bouc-Wen element that remembers")
        return self.alpha * self.k + (1 - self.alpha) * self.k * self.A, 0.0

    def _way(self, z, c):
        """U(z) for z >= 0."""
        x = c * z**self.n / self.A
        return z / self.A * float(hyp2f1(1.0, 1 / self.n, 1 + 1 / self.n, x)) if x < 1 else math.inf

    def _along(self, z, way, c, largest):
        """z for U(z) = way >= 0, below `largest`."""
        if way <= 0:
            return 0.0
        top = largest
        if not math.isfinite(top):
            top = way * self.A
            while self._way(top, c) < way:
                top *= 2
        if self._way(top * (1 - 1e-15), c) <= way:
            return top * (1 - 1e-15)
        return brentq(lambda x: self._way(x, c) - way, 0.0, top * (1 - 1e-15), xtol=1e-300, rtol=1e-14)

    def after(self, z, du):
        """z after u has gone monotonically by du; and dz/du there."""
        if du == 0:
            return z, None
        turn = 1.0 if du > 0 else -1.0
        z, left = turn * z, abs(du)  # as if u grew
        loading, unloading = self.gamma + self.beta, self.gamma - self.beta
        if z < 0:  # |z| falls
            way = self._way(-z, unloading)
            if way > left:
                z = -self._along(0.0, way - left, unloading, -z)
                return turn * z, self.A - unloading * abs(z)**self.n
            z, left = 0.0, left - way
        z = self._along(0.0, self._way(z, loading) + left, loading, self.z_max)
        return turn * z, self.A - loading * z**self.n


class NonlinearSpring:
    """f = force(u, rate, t)."""

    remembers = False

    def __init__(self, name, b, formula, rotation=False):
        self.name, self.b, self.formula, self.rotation = name, b, formula, rotation
        self.used = formula.parsed.used

    def force(self, u, rate, t, z, chosen=None):
        """With `chosen`, the choices of `decisions`, the smooth continuation of one branch."""
        u, rate, t = float(u), float(rate), float(t)
        if chosen:
            return float(self.formula.along(chosen, u=u, rate=rate, t=t))
        return float(self.formula(u=u, rate=rate, t=t))

    def decisions(self, u, rate, t):
        return self.formula.decisions(u=float(u), rate=float(rate), t=float(t))

    def elastic_force(self, u):
        """What is left at rest; nothing of a formula that contains t."""
        return 0.0 if "t" in self.used else float(self.formula(u=float(u), rate=0.0, t=0.0))

    def stored(self, u, z=None):
        """The work of the elastic force from 0 to u."""
        kinks = self._kinks(u)
        points = [0.0] + kinks + [u]
        return sum(quad(self.elastic_force, a, b, epsabs=0.0, epsrel=1e-11, limit=200)[0] for a, b in zip(points, points[1:]) if a != b)

    def _kinks(self, u):
        """Where a choice of the elastic force changes between 0 and u."""
        if not self.decisions(0.0, 0.0, 0.0) and not self.decisions(u, 0.0, 0.0):
            return []
        found, grid = [], numpy.linspace(0.0, u, 65)
        for a, b in zip(grid[:-1], grid[1:]):
            at_a, at_b = self.decisions(a, 0.0, 0.0), self.decisions(b, 0.0, 0.0)
            if at_a == at_b:
                continue
            for _ in range(60):
                middle = 0.5 * (a + b)
                if self.decisions(middle, 0.0, 0.0) == at_a:
                    a = middle
                else:
                    b = middle
            found.append(0.5 * (a + b))
        return found

    def tangents(self, u=0.0, z=None, rate=0.0, t=0.0):
        u, rate, t = float(u), float(rate), float(t)

        def slope(**now):
            value = self.formula(**now)
            return float(value.d) if isinstance(value, Jet) else 0.0
        return slope(u=Jet(u, 1.0), rate=rate, t=t), slope(u=u, rate=Jet(rate, 1.0), t=t)


def read_laws(study, place):
    """The laws of a study; `place(part)` gives what a law keeps of where it acts, and whether that turns."""
    laws = []
    for i, part in enumerate(study.raw.get("bouc_wen", [])):
        b, turns = place(part)
        number = lambda key, default: study.number(part.get(key, default))  # noqa: E731
        laws.append(BoucWen(str(part.get("name", f"bouc_wen{i + 1}")), b, study.number(part["stiffness"]),
                            number("post_yield_ratio", 0.0), number("A", 1.0), number("beta", 0.5), number("gamma", 0.5),
                            number("n", 1.0), turns))
    for i, part in enumerate(study.raw.get("dahl", [])):  # df/du = sigma (1 - sgn(u') f/Fc), with f = sigma z
        b, turns = place(part)
        sigma, limit = study.number(part["stiffness"]), study.number(part["slip_force"])
        laws.append(BoucWen(str(part.get("name", f"dahl{i + 1}")), b, sigma, 0.0, 1.0, sigma / limit, 0.0, 1.0, turns))
    formulas = {"nonlinear_spring": lambda part: str(part["force"]),
                "smooth_friction": lambda part: f"({part['friction_coefficient']})*({part['normal_load']})*tanh(rate/({part['velocity']}))",
                "cable": lambda part: f"({part['stiffness']})*max(u - ({part.get('length', 0)}), 0)"}
    for table, formula_of in formulas.items():
        for i, part in enumerate(study.raw.get(table, [])):
            b, turns = place(part)
            try:
                formula = study.formula(formula_of(part), ("u", "rate", "t"))
            except FormulaError as why:
                raise Unreadable(str(why)) from None
            laws.append(NonlinearSpring(str(part.get("name", f"{table}{i + 1}")), b, formula, turns))
    for table in ("lugre", "iwan"):
        if study.raw.get(table):
            raise Unreadable(f"a {table} element")
    return laws
