"""Studies whose springs and dampers are written as laws: the same equations in other words.

`structure(seed, folder)` and `mechanism(seed, folder)` give a random study as tables with the springs and dampers that may be rewritten;
`as_formulas`, `as_hysteresis` and `beside_nothing` rewrite it.
"""

import copy
import math
import tomllib

import numpy
import scipy.io
import scipy.sparse

from generate_more import MoreKeys
from random_mechanism import Generator as RandomMechanism

LARGE = 70  # beyond what is solved by full matrices


class WithParts(MoreKeys):
    """Springs and dampers everywhere, and analyses that take laws."""

    def build(self):
        self.large, self.more = self.chance(0.12), self.chance(0.3)
        return super().build()

    def lumped(self):
        super().lumped()
        if not self.large:
            return
        first, number = self.tables["coordinate"][-1], len(self.names)
        for i in range(number, LARGE):
            name = f"w{i}"
            self.tables["coordinate"].append({"name": name, "mass": first["mass"]})
            self.tables["spring"].append({"between": [name, self.names[-1]], "stiffness": self.stiffness * self.log(0.5, 2)})
            if self.chance(0.3):
                self.tables["spring"].append({"between": [name, "ground"], "stiffness": self.stiffness * self.log(0.5, 2)})
            self.names.append(name)

    def damping(self, n, lumped=True):
        """What is of springs follows those that are written as springs; so nothing but what masses and dashpots do."""
        super().damping(n, lumped)
        if "damping" in self.tables:
            self.tables["damping"] = {"rayleigh": {"mass": self.omega * self.log(1e-3, 0.3)}}

    def contacts(self):
        super().contacts()
        if self.kind == "matrices":
            return
        ends = self.names + (self.rotations if self.frames else [])
        turning = set(self.rotations) if self.frames else set()
        longest = max((math.hypot(*n["position"]) for n in self.tables.get("node", [])), default=1.0) or 1.0
        for _ in range(self.random.choice([1, 2, 2, 3])):
            first = self.random.choice(ends)
            others = [e for e in ends if e != first and (e in turning) == (first in turning)]
            second = self.random.choice([*others, "ground"])
            k = self.stiffness * self.log(0.1, 10) * (longest**2 * self.log(0.01, 0.1) if first in turning else 1)
            between = [first, second] if self.chance(0.5) else [second, first]
            if self.chance(0.7):
                self.tables.setdefault("spring", []).append({"between": between, "stiffness": self.number(k)})
            if self.chance(0.6):
                self.tables.setdefault("damper", []).append({"between": between, "damping": self.number(k / self.omega * self.log(1e-3, 1))})
        if not self.tables.get("spring") and not self.tables.get("damper"):
            self.tables["damper"] = [{"between": [self.names[0], "ground"], "damping": self.number(self.stiffness / self.omega * 0.1)}]

    def from_matrices(self):
        """The matrices hold the springs, and another file is without them."""
        super().from_matrices()
        k = scipy.io.mmread(self.folder / "k.mtx").toarray()
        scipy.io.mmwrite(self.folder / "bare.mtx", scipy.sparse.coo_matrix(k), symmetry="symmetric", precision=17)
        self.inside = []
        for _ in range(2):
            first, second = self.random.sample(range(len(self.names)), 2)
            ends = numpy.zeros(len(self.names))
            ends[first], ends[second] = 1, -1 if self.chance(0.6) else 0
            stiffness = self.stiffness * self.log(0.1, 10)
            k = k + stiffness * numpy.outer(ends, ends)
            between = [str(self.names[first]), str(self.names[second]) if ends[second] else "ground"]
            self.inside.append({"between": between, "stiffness": stiffness})
        scipy.io.mmwrite(self.folder / "k.mtx", scipy.sparse.coo_matrix(k), symmetry="symmetric", precision=17)

    def automatic_keys(self, part):
        super().automatic_keys(part)
        step = part["step"]
        if step.get("controller") == "fixed" or "as_printed" in step:
            part["step"] = {"tolerance": 1e-4}
        if set(part.get("output", {"every": 1})) == {"every"}:  # rows that steps do not decide
            part["output"] = {"interval": self.duration / 40}

    def analyses(self):
        if self.more:
            super().analyses()  # those over Hertz
        else:
            super(MoreKeys, self).analyses()
        kept = []
        for part in self.tables["analysis"]:
            if part["type"] in ("damper_curve", "method_study") or part.get("method") == "exact":
                continue
            if part["type"] == "transient" and isinstance(part["step"], dict):
                part.setdefault("output", {"interval": self.duration / 40})
            if part.get("solver") == "periodic" or part["type"] == "frequency_response" and "slider" in self.tables and "solver" not in part:
                part["solver"] = self.random.choice(["harmonic_balance", "time_marching"])
            if part.get("solver") == "time_marching" and self.frames and "stop" not in self.tables:
                part["solver"] = "harmonic_balance"  # marches of stiff frames take long
                for key in ("method", "steps_per_period", "max_periods"):
                    part.pop(key, None)
            kept.append(part)
            if part.get("solver") == "time_marching" and "force" in self.tables and self.chance(0.2):
                self.tables["force"].append({"on": self.names[0], "amplitude": 0.3 * self.stiffness * self.x, "angular_frequency": self.omega * 1.2345})
        self.tables["analysis"] = kept


def structure(seed, folder):
    """(tables, parts): `parts` are (key, index) of the springs and dampers to be rewritten."""
    generator = WithParts(seed, folder)
    while not generator.build() or not generator.tables["analysis"]:
        generator = WithParts(generator.random.random(), folder)
    tables = tomllib.loads((folder / "study.toml").read_text())
    if generator.kind == "matrices":
        return {**tables, "inside": generator.inside}, [("inside", i) for i in range(len(generator.inside))]
    parts = [(key, i) for key in ("spring", "damper") for i in range(len(tables.get(key, [])))]
    return tables, _some(generator.random, parts)


def mechanism(seed, folder):
    generator = RandomMechanism(seed, folder)
    generator.write()
    tables = tomllib.loads((folder / "study.toml").read_text())
    interval = generator.duration * generator.T / 30
    for part in tables["analysis"]:
        if part["type"] == "transient" and isinstance(part["step"], dict):
            part["output"] = {"interval": interval}
    parts = [(key, i) for key in ("spring", "damper") for i in range(len(tables.get(key, [])))]
    parts += [("joint", i) for i, joint in enumerate(tables.get("joint", [])) if {"stiffness", "damping"} & set(joint)]
    if not parts:
        return tables, parts
    return tables, [parts[i] for i in generator.rng.permutation(len(parts))[:max(1, int(0.7 * len(parts)))]]


def _some(random, parts):
    return random.sample(parts, max(1, min(int(0.7 * len(parts)), 6)))


def as_formulas(tables, parts):
    """Every one of `parts` as `[[nonlinear_spring]]`, a spring and a damper between the same ends in one or in two."""
    tables, laws, taken = copy.deepcopy(tables), [], {"spring": set(), "damper": set(), "inside": set()}
    for key, i in parts:
        part = tables[key][i]
        if key == "joint":
            terms = [f"({part.pop('stiffness')})*(u - ({_rest(tables, part)}))"] if "stiffness" in part else []
            terms += [f"({part.pop('damping')})*rate"] if "damping" in part else []
            part.pop("rest", None)
            _still_a_strut(part)
            laws.append({"joint": part.get("name", f"joint{i + 1}"), "force": " + ".join(terms)})
        elif i not in taken[key]:
            taken[key].add(i)
            terms = [_term(key, part)]
            if key == "inside":
                tables["matrices"]["stiffness"] = "bare.mtx"
            if key == "spring":
                same = [j for other, j in parts if other == "damper" and j not in taken["damper"]
                        and tables["damper"][j]["between"] == part["between"]]
                for j in same:
                    taken["damper"].add(j)
                    terms.append(_term("damper", tables["damper"][j]))
            laws.append({"between": part["between"], "force": " + ".join(terms)})
    return _with(tables, taken, "nonlinear_spring", laws)


def as_hysteresis(tables, parts):
    """Every spring of `parts` as a `[[bouc_wen]]` that never yields."""
    tables, laws, taken = copy.deepcopy(tables), [], {"spring": set(), "inside": set()}
    for key, i in parts:
        part = tables[key][i]
        law = {"post_yield_ratio": 1.0, "n": 1 + i % 3, "beta": 0.3, "gamma": 0.8}
        if key in ("spring", "inside"):
            taken[key].add(i)
            if key == "inside":
                tables["matrices"]["stiffness"] = "bare.mtx"
            laws.append({"between": part["between"], "stiffness": part["stiffness"], **law})
        elif key == "joint" and "stiffness" in part and "rest" not in part and part["type"] != "strut" and not {"angle", "displacement"} & set(part):
            laws.append({"joint": part.get("name", f"joint{i + 1}"), "stiffness": part.pop("stiffness"), **law})
    return _with(tables, taken, "bouc_wen", laws)


def beside_nothing(tables, parts):
    """Laws without a force beside `parts`."""
    tables, laws = copy.deepcopy(tables), []
    for key, i in parts[:2]:
        part = tables[key][i]
        if key == "joint":
            where = {"joint": part.get("name", f"joint{i + 1}")}
        else:
            where = {"between": part["between"]}
        laws.append({**where, "force": ["0", "0*u", "0*u^3 + 0*rate"][i % 3]})
    return _with(tables, {}, "nonlinear_spring", laws)


def _term(key, part):
    return f"({part['damping']})*rate" if key == "damper" else f"({part['stiffness']})*u"


def _with(tables, taken, key, laws):
    """None where nothing could be written so."""
    for name, indices in taken.items():
        kept = [p for i, p in enumerate(tables.get(name, [])) if i not in indices]
        if kept:
            tables[name] = kept
        else:
            tables.pop(name, None)
    if laws:
        tables[key] = laws
    return tables if laws else None


def _rest(tables, joint):
    if "rest" in joint:
        return joint["rest"]
    if joint["type"] == "strut":
        return repr(_length(tables, joint))
    return joint.get("displacement", joint.get("angle", 0.0))


def _length(tables, joint):
    """Between the ends of a strut, as it lies."""
    places = {p["name"]: p["position"] for key in ("node", "body") for p in tables.get(key, [])}
    ends = [numpy.array(joint[key] if key in joint else places[who]) for key, who in zip(("at", "to"), joint["between"])]
    return float(numpy.linalg.norm(ends[1] - ends[0]))


def _still_a_strut(part):
    if part["type"] == "strut" and not {"stiffness", "damping", "force", "drive", "lock", "friction"} & set(part):
        part["force"] = 0
