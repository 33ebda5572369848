"""Equal steps of every method on a linear model under harmonic loads, from the formulas of the theory page and textbooks.

The loads are linear in z = (1, cos w t, sin w t, ...), which turns by a constant matrix. So a step is one matrix T on
(q, h v, h^2 A, z); A is the acceleration that a method keeps. Rates are scaled by h, for else their sizes are far apart.
"""

import math

import numpy
import scipy.linalg
from scipy.integrate import RK23, RK45

from study import HarmonicLaw, Unreadable
from structure.model import ConstantLaw


class Problem:
    """M, C, K [n x n], loads L z [n x m], start q v [n]."""

    def __init__(self, M, C, K, L, frequencies, q, v):
        self.M, self.C, self.K, self.L, self.frequencies = M, C, K, L, frequencies
        self.q, self.v, self.n = q, v, len(q)
        self.z = numpy.array([1.0] + [1.0, 0.0] * len(frequencies))
        self.a = numpy.linalg.solve(M, L @ self.z - C @ v - K @ q)

    @classmethod
    def of_model(cls, model):
        parts = []
        for vector, law in model.loads:
            if isinstance(law, HarmonicLaw):
                parts.append((vector, law.amplitude, law.angular_frequency, law.phase))
            elif isinstance(law, ConstantLaw):
                parts.append((vector, 1.0, 0.0, 0.0))
            else:
                raise Unreadable("a load that is not harmonic")
        frequencies = sorted({w for _, _, w, _ in parts if w})
        L = numpy.zeros((len(model.names), 1 + 2 * len(frequencies)))
        for vector, amplitude, w, phase in parts:
            if w:  # a cos(w t + phase)
                k = 1 + 2 * frequencies.index(w)
                L[:, k] += vector * amplitude * math.cos(phase)
                L[:, k + 1] -= vector * amplitude * math.sin(phase)
            else:
                L[:, 0] += vector * amplitude * math.cos(phase)
        return cls(model.M, model.C, model.K, L, frequencies, model.q0.copy(), model.v0.copy())

    @classmethod
    def of_mode(cls, squared):
        """An undamped one of unit mass, without loads."""
        one = numpy.ones((1, 1))
        return cls(one, 0 * one, squared * one, 0 * one, [], numpy.ones(1), numpy.zeros(1))

    def turn(self, t):
        out = numpy.eye(len(self.z))
        for i, w in enumerate(self.frequencies):
            k, c, s = 1 + 2 * i, math.cos(w * t), math.sin(w * t)
            out[k:k + 2, k:k + 2] = [[c, -s], [s, c]]
        return out

    def start(self, h):
        return numpy.concatenate([self.q, h * self.v, h * h * self.a, self.z])

    def step(self, method, h):
        """T of a method: (name, parameters)."""
        n, m = self.n, len(self.z)
        unit = numpy.eye(3 * n + m)
        q, v, a, z = unit[:n], unit[n:2 * n] / h, unit[2 * n:3 * n] / (h * h), unit[3 * n:]
        name, values = method
        if name == "exponential":
            q, v, a = self._exact(h, q, v, z)
        elif name in TABLEAUS:
            q, v, a = self._runge_kutta(TABLEAUS[name], h, q, v, z)
        elif name == "wilson_theta":
            q, v, a = self._wilson(values.get("theta", 1.4), h, q, v, a, z)
        else:
            q, v, a = self._alpha(alphas(name, values), h, q, v, a, z)
        return numpy.vstack([q, h * v, h * h * a, self.turn(h) @ z])

    def _runge_kutta(self, tableau, h, q, v, z):
        stages, weights, times = tableau
        speeds, forces = [], []
        for row, c in zip(stages, times):
            qi = q + h * sum((x * k for x, k in zip(row, speeds)), 0 * q)
            vi = v + h * sum((x * k for x, k in zip(row, forces)), 0 * v)
            speeds.append(vi)
            forces.append(numpy.linalg.solve(self.M, self.L @ self.turn(c * h) @ z - self.C @ vi - self.K @ qi))
        return (q + h * sum(w * k for w, k in zip(weights, speeds)), v + h * sum(w * k for w, k in zip(weights, forces)), 0 * q)

    def _alpha(self, numbers, h, q, v, a, z):
        alpha_m, alpha_f, beta, gamma = numbers
        q_known, v_known = q + h * v + h * h * (0.5 - beta) * a, v + h * (1 - gamma) * a
        left = (1 - alpha_m) * self.M + (1 - alpha_f) * (gamma * h * self.C + beta * h * h * self.K)
        right = ((1 - alpha_f) * (self.L @ self.turn(h) @ z - self.C @ v_known - self.K @ q_known)
                 + alpha_f * (self.L @ z - self.C @ v - self.K @ q) - alpha_m * self.M @ a)
        new = numpy.linalg.solve(left, right)
        return q_known + beta * h * h * new, v_known + gamma * h * new, new

    def _wilson(self, theta, h, q, v, a, z):
        long = theta * h
        f = self.L @ z + theta * (self.L @ self.turn(h) @ z - self.L @ z)
        left = self.M + 0.5 * long * self.C + long * long / 6 * self.K
        far = numpy.linalg.solve(left, f - self.C @ (v + 0.5 * long * a) - self.K @ (q + long * v + long * long / 3 * a))
        new = a + (far - a) / theta
        return q + h * v + h * h * (2 * a + new) / 6, v + 0.5 * h * (a + new), new

    def _exact(self, h, q, v, z):
        n, m = self.n, len(self.z)
        rate = numpy.zeros((2 * n + m, 2 * n + m))
        rate[:n, n:2 * n] = numpy.eye(n)
        rate[n:2 * n, :n] = -h * h * numpy.linalg.solve(self.M, self.K)
        rate[n:2 * n, n:2 * n] = -h * numpy.linalg.solve(self.M, self.C)
        rate[n:2 * n, 2 * n:] = h * h * numpy.linalg.solve(self.M, self.L)
        for i, w in enumerate(self.frequencies):
            k = 2 * n + 1 + 2 * i
            rate[k, k + 1], rate[k + 1, k] = -w * h, w * h
        new = scipy.linalg.expm(rate) @ numpy.vstack([q, h * v, z])
        return new[:n], new[n:2 * n] / h, 0 * q

    def march(self, method, h, count, row, thinned=1):
        """row . q at 0, thinned h, ..., count times after the first."""
        T = numpy.linalg.matrix_power(self.step(method, h), thinned)
        y, n = self.start(h), self.n
        x = [row @ y[:n]]
        for _ in range(count):
            y = T @ y
            x.append(row @ y[:n])
        return numpy.array(x)

    def exact(self, h, count, row):
        return self.march(("exponential", {}), h, count, row)

    def exact_between(self, h, count, row, parts):
        """The same with `parts` times as many samples: powers of the short step, turned to the row, on every state."""
        T, y = self.step(("exponential", {}), h), self.start(h)
        states = [y]
        for _ in range(count - 1):
            states.append(T @ states[-1])
        short = numpy.ones(len(y))  # states of the short step hold h v and h h a of its own length
        short[self.n:2 * self.n], short[2 * self.n:3 * self.n] = 1 / parts, 1 / parts**2
        T = self.step(("exponential", {}), h / parts)
        rows = [numpy.concatenate([row, numpy.zeros(len(y) - self.n)])]
        for _ in range(parts):
            rows.append(rows[-1] @ T)
        states, rows = numpy.array(states) * short, numpy.array(rows)
        return numpy.append((states @ rows[:-1].T).ravel(), states[-1] @ rows[-1])

    def grows(self, method, h):
        """The spectral radius of a step without loads; of one acceleration more than there are motions, too."""
        name, _ = method
        n = self.n if name in TABLEAUS or name == "exponential" else 1.5 * self.n
        T = self.step(method, h)[:round(2 * n), :round(2 * n)]
        return numpy.max(numpy.abs(numpy.linalg.eigvals(T)))


def alphas(name, values):
    """alpha_m, alpha_f, beta, gamma."""
    newmark = {"central_difference": (0.0, 0.5), "fox_goodwin": (1 / 12, 0.5), "linear_acceleration": (1 / 6, 0.5),
               "average_acceleration": (0.25, 0.5), "damped_newmark": (0.3025, 0.6), "galerkin": (0.8, 1.5),
               "backward_difference": (1.0, 1.5)}
    if name in newmark:
        return (0.0, 0.0, *newmark[name])
    if name == "newmark":
        return 0.0, 0.0, values["beta"], values["gamma"]
    if name == "hht":
        alpha = values.get("alpha", -0.05)
        return 0.0, -alpha, (1 - alpha)**2 / 4, 0.5 - alpha
    rho = values.get("rho_inf", 0.9)
    if name == "wbz":
        m = (rho - 1) / (rho + 1)
        return m, 0.0, (1 - m)**2 / 4, 0.5 - m
    m, f = (2 * rho - 1) / (rho + 1), rho / (rho + 1)
    return m, f, (1 - m + f)**2 / 4, 0.5 - m + f


def _pair(solver):
    return [list(row[:i]) for i, row in enumerate(solver.A)], list(solver.B), list(solver.C)


# rows of stages, weights, times
TABLEAUS = {
    "explicit_euler": ([[]], [1.0], [0.0]),
    "heun": ([[], [1.0]], [0.5, 0.5], [0.0, 1.0]),
    "midpoint": ([[], [0.5]], [0.0, 1.0], [0.0, 0.5]),
    "ralston": ([[], [0.75]], [1 / 3, 2 / 3], [0.0, 0.75]),
    "rk3": ([[], [0.5], [-1.0, 2.0]], [1 / 6, 4 / 6, 1 / 6], [0.0, 0.5, 1.0]),
    "rk4": ([[], [0.5], [0.0, 0.5], [0.0, 0.0, 1.0]], [1 / 6, 2 / 6, 2 / 6, 1 / 6], [0.0, 0.5, 0.5, 1.0]),
    "bogacki_shampine": _pair(RK23),
    "dormand_prince": _pair(RK45),
}

ORDERS = {"explicit_euler": 1, "rk3": 3, "rk4": 4, "bogacki_shampine": 3, "dormand_prince": 5, "galerkin": 1,
          "backward_difference": 1, "damped_newmark": 1}


def order_of(method):
    name, values = method
    if name == "newmark":
        return 2 if values["gamma"] == 0.5 else 1
    return ORDERS.get(name, 2)


# In the order of the catalogue; Newmark's method has no numbers of its own.
ALL = ["explicit_euler", "heun", "midpoint", "ralston", "rk3", "rk4", "bogacki_shampine", "dormand_prince", "central_difference",
       "fox_goodwin", "linear_acceleration", "average_acceleration", "galerkin", "backward_difference", "damped_newmark",
       "wilson_theta", "hht", "wbz", "generalized_alpha", "exponential"]
