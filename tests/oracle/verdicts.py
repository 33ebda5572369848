"""What a comparison says, and the tables that it reads."""

import csv
import pathlib

import numpy


class Verdict:
    """`kind` of analysis, `outcome` one of agrees, differs, refused, skipped, failed; and what was measured."""

    def __init__(self, analysis, kind, outcome, what="", error=0.0, allowed=0.0):
        self.analysis, self.kind, self.outcome, self.what = analysis, kind, outcome, what
        self.error, self.allowed = float(error), float(allowed)

    def __str__(self):
        numbers = f" error {self.error:.3g}, allowed {self.allowed:.3g}" if self.outcome == "differs" else ""
        return f"{self.analysis} ({self.kind}): {self.outcome} {self.what}{numbers}"


class Table:
    """A CSV file of results: `column("x.position [m]")` [rows]; cells that are no numbers stay text."""

    def __init__(self, path):
        with open(path, newline="") as file:
            rows = list(csv.reader(file))
        self.path, self.head, self.rows = pathlib.Path(path), rows[0], rows[1:]

    def has(self, name):
        return name in self.head

    def text(self, name):
        i = self.head.index(name)
        return [row[i] for row in self.rows]

    def column(self, name):
        return numpy.array([float(cell) if cell else numpy.nan for cell in self.text(name)])


def worst(name, kind, checks):
    """`checks`: (what, error, allowed); the one that fails most decides."""
    decides = max(checks, key=lambda c: (c[1] / c[2] if numpy.isfinite(c[1]) else numpy.inf), default=None)
    if decides is None:
        return Verdict(name, kind, "skipped", "nothing to compare")
    if not decides[1] <= decides[2]:
        return Verdict(name, kind, "differs", decides[0], decides[1], decides[2])
    return Verdict(name, kind, "agrees", decides[0], decides[1], decides[2])


def columns_of(model, name):
    """The headers of position, velocity and acceleration of a coordinate."""
    if model.rotation[model.index(name)]:
        return [f"{name}.angle [rad]", f"{name}.angular_velocity [rad/s]", f"{name}.angular_acceleration [rad/s2]"]
    return [f"{name}.position [m]", f"{name}.velocity [m/s]", f"{name}.acceleration [m/s2]"]


def condition_of(matrix):
    scale = 1 / numpy.sqrt(numpy.maximum(numpy.abs(numpy.diag(matrix)), 1e-300))
    return numpy.linalg.cond(matrix * scale[:, None] * scale[None, :])
