"""Laws of time as part of a linear system: a state `z` with `z' = Z z` whose first entry is the law.

A harmonic law turns, a table between two of its rows and a constant are polynomials: exact for any time. A formula is
fitted by a polynomial over a short span, in which it must be smooth.
"""

import math

import numpy

from structure.model import ConstantLaw
from study import FormulaLaw, HarmonicLaw, TableLaw

DEGREE = 7


def of_load(law):
    if isinstance(law, HarmonicLaw):
        return _Turning(law.amplitude, law.angular_frequency, law.phase)
    if isinstance(law, ConstantLaw) or isinstance(law, FormulaLaw) and not law.formula.parsed.used & {"t"}:
        return _Polynomial(law, 0)
    return _Polynomial(law, 1 if isinstance(law, TableLaw) else DEGREE)


def of_support(law, derivative):
    """The motion of a support, or one of its derivatives."""
    if isinstance(law, HarmonicLaw):
        w = law.angular_frequency
        return _Turning(law.amplitude * w**derivative, w, law.phase + derivative * math.pi / 2)
    return _Polynomial(_Derivative(law, derivative), DEGREE)


class _Turning:
    size, exact = 2, True

    def __init__(self, amplitude, angular_frequency, phase):
        self.amplitude, self.angular_frequency, self.phase = amplitude, angular_frequency, phase

    def value(self, t, side=0):
        return self.amplitude * math.cos(self.angular_frequency * t + self.phase)

    def generator(self, stride):
        w = self.angular_frequency
        return numpy.array([[0.0, -w], [w, 0.0]])

    def state(self, t, span, begin, end, stride):
        angle = self.angular_frequency * t + self.phase
        return self.amplitude * numpy.array([math.cos(angle), math.sin(angle)]), True

    def longest_stride(self, begin, end, contacts):
        """With contacts short enough to see what they do."""
        return 0.08 * 2 * math.pi / abs(self.angular_frequency) if contacts and self.angular_frequency else math.inf


class _Derivative:
    """The law of a moving support, or one of its derivatives."""

    def __init__(self, law, order):
        self.law, self.order = law, order

    def value(self, t, side=0):
        return self.law.motion(t, side)[self.order]

    def shortest_time(self, begin, end):
        return self.law.shortest_time(begin, end)


class _Polynomial:
    """The state: derivatives times powers of the stride."""

    def __init__(self, law, degree):
        self.law, self.degree, self.size = law, degree, degree + 1
        self.exact = degree < DEGREE
        self._largest = 0.0
        self._powers = [math.factorial(k) for k in range(self.size)]

    def value(self, t, side=0):
        return self.law.value(t, side)

    def generator(self, stride):
        return numpy.diag(numpy.full(self.degree, 1 / stride), 1)

    def longest_stride(self, begin, end, contacts):
        return 0.08 * self.law.shortest_time(begin, end) if not self.exact else math.inf

    def state(self, t, span, begin, end, stride):
        """At t, for a span within the piece from `begin` to `end` in which nothing switches; and whether it fits."""
        x = _nodes(self.degree)
        values = [self._within(t + span * xi, begin, end) for xi in x]
        c = _inverse(self.degree) @ values
        largest = max(map(abs, values))
        good = True
        if not self.exact:
            for xi in (0.037, 0.31, 0.69, 0.963):
                there = self._within(t + span * xi, begin, end)
                fitted = 0.0
                for ck in c[::-1]:
                    fitted = fitted * xi + ck
                good = good and abs(fitted - there) <= 1e-10 * max(abs(there), largest, 1e-3 * self._largest)
        self._largest = max(self._largest, largest)
        return numpy.array([ck * p * (stride / span)**k for k, (ck, p) in enumerate(zip(c, self._powers))]), good

    def _within(self, t, begin, end):
        if t <= begin:
            return self.law.value(begin, 1)
        if t >= end:
            return self.law.value(end, -1)
        return self.law.value(t, 0)


_nodes_of, _inverses = {}, {}


def _nodes(degree):
    """Those of Chebyshev and Lobatto in 0..1."""
    if degree not in _nodes_of:
        _nodes_of[degree] = [0.5 * (1 - math.cos(math.pi * k / degree)) for k in range(degree + 1)] if degree else [0.0]
    return _nodes_of[degree]


def _inverse(degree):
    if degree not in _inverses:
        _inverses[degree] = numpy.linalg.inv(numpy.vander(_nodes(degree), increasing=True))
    return _inverses[degree]
