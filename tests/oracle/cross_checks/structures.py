"""Random structures without analyses: the models of `generate.py`, with loads and damping as a check asks for them."""

import math

import numpy
import scipy.linalg

from generate import Generator
from random_structure.toml import write_toml
from structure.model import read_model
from study import Study


class Structure(Generator):
    """`tables` is the model; `write(analyses)` makes a study of it.

    @param contacts  which of sliders and stops it may have, a subset of {"slider", "stop"}
    """

    def __init__(self, seed, folder, contacts=("slider", "stop"), kinds=("lumped", "lumped", "matrices", "plane", "space")):
        super().__init__(seed, folder)
        kind = self.random.choice(kinds)
        self.frames = kind in ("plane", "space")
        if kind == "lumped":
            self.lumped()
        elif kind == "matrices":
            self.from_matrices()
        else:
            self.frame(kind == "space")
        self.kind = kind
        self.names = [str(name) for name in self.names]
        self.duration = 2 * math.pi / self.omega * 5
        self.contacts()
        for key in {"slider", "stop"} - set(contacts):
            self.tables.pop(key, None)
        self.at_rest_at_start()
        self.tables.pop("distributed_force", None)

    def at_rest_at_start(self):
        for key, names in (("coordinate", ("position", "velocity")), ("node", ("velocity", "angular_velocity"))):
            for part in self.tables.get(key, []):
                for name in names:
                    part.pop(name, None)
        for name in ("position", "velocity"):
            self.tables.get("matrices", {}).pop(name, None)

    def damped(self, low=0.03, high=0.3):
        """Every mode by a share of its critical damping, beside what the dampers of the model do."""
        if self.kind == "matrices" and "damping" in self.tables["matrices"]:
            return
        if self.chance(0.5):
            self.tables["damping"] = {"modal_ratio": self.log(low, high)}
        else:
            self.tables["damping"] = {"rayleigh": {"mass": self.omega * 2 * self.log(low, high),
                                                   "stiffness": self.log(low, high) / self.omega}}

    def undamped(self):
        for key in ("damping", "damper"):
            self.tables.pop(key, None)
        self.tables.get("matrices", {}).pop("damping", None)
        for part in self.tables.get("material", []):
            part.pop("retardation_time", None)

    def force(self, law, size):
        """A load of any kind with a law of time, `law(size)`: a force, one along a beam, or a motion of the ground."""
        named = [b["name"] for b in self.tables.get("beam", []) if "name" in b]
        way = self.random.random()
        if way < 0.15 and "base_motion" not in self.tables:
            part = law(self.x * self.omega**2 * size)
            if "amplitude" in part and self.chance(0.5):
                part["of"] = self.random.choice(["acceleration", "velocity", "displacement"])
                part["amplitude"] = self.x * size * self.omega ** {"acceleration": 2, "velocity": 1}.get(part["of"], 0)
            if self.frames:
                part["direction"] = {"x": 1.0, "y": self.uniform(-1, 1)}
            elif self.chance(0.4):
                part["direction"] = {name: self.uniform(-1, 2) for name in self.names}
            self.tables["base_motion"] = part
        elif way < 0.3 and named and "distributed_force" not in self.tables:
            direction = [self.uniform(-1, 1) for _ in self.tables["node"][-1]["position"]]
            self.tables["distributed_force"] = [{"on": self.random.choice(named), "direction": direction,
                                                 **law(self.stiffness * self.x * size)}]
        else:
            self.tables.setdefault("force", []).append({"on": self.random.choice(self.names),
                                                        **law(self.stiffness * self.x * size)})

    def write(self, analyses, name="study.toml", **replaced):
        """A study of this model with other tables in place of some of its own."""
        tables = {k: v for k, v in {**self.tables, **replaced}.items() if v}
        first = {"parameters": tables.pop("parameters")} if "parameters" in tables else {}
        path = self.folder / name
        path.write_text(write_toml({**first, **tables, "analysis": analyses}))
        return path

    def model(self, **replaced):
        """As the oracle reads it; its rates tell how long a march takes, and nothing is compared with it."""
        return read_model(Study(self.write([{"name": "rest", "type": "static"}], "model.toml", **replaced)))


def rates(model):
    """All eigenvalues s [1/s] of the model, its sliders removed and stuck."""
    found = []
    scale = 1 / numpy.sqrt(numpy.diag(model.M))
    free = [i for i in range(len(model.names)) if i not in [j for j, _ in model.moving]]
    for stiffness in [model.K, model.stuck_stiffness()] if model.sliders else [model.K]:
        mass, damping, stiff = (a[numpy.ix_(free, free)] * scale[free, None] * scale[None, free]
                                for a in (model.M, model.C, stiffness))
        n = len(free)
        squares = scipy.linalg.eigh(stiff, mass, eigvals_only=True)
        if n and squares[0] < 1e-10 * squares[-1]:
            found.append(numpy.zeros(1))  # a rigid motion
        unit = math.sqrt(max(squares[-1], 1e-300))
        inverse = numpy.linalg.inv(mass)
        system = numpy.block([[numpy.zeros((n, n)), numpy.eye(n)],
                              [-inverse @ stiff / unit**2, -inverse @ damping / unit]])
        found.append(unit * numpy.linalg.eigvals(system))
    return numpy.concatenate(found)
