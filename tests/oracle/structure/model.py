"""From a study to `M a + C v + K q + sliders, stops and laws = f(t)`, dense."""

import csv
import math

import numpy
import scipy.io
import scipy.linalg

from nonlinear.laws import read_laws
from structure import elements
from study import HarmonicLaw, Unreadable


class Slider:
    def __init__(self, name, b, stiffness, limit, rotation):
        self.name, self.b, self.stiffness, self.limit, self.rotation = name, b, stiffness, limit, rotation


class Stop:
    def __init__(self, name, b, gap, stiffness, damping, rotation):
        self.name, self.b, self.gap, self.stiffness, self.damping = name, b, gap, stiffness, damping
        self.rotation = rotation


class ConstantLaw:
    def value(self, t, side=0):
        return 1.0

    def switches(self, begin, end):
        return []

    def shortest_time(self, begin, end):
        return math.inf


class Model:
    """names [n], M C K [n x n], q0 v0 [n], `loads`: pairs of a vector [n] and a law of time, `held` [n]: forces of static
    states, `held_displacements`: pairs of an index and a value, `moving`: pairs of an index and a law."""

    def index(self, name):
        if name not in self.names:
            raise Unreadable(f"no coordinate {name}")
        return self.names.index(name)

    def column(self, between):
        """+1 at the first, -1 at the second; the ground and what a support holds have no entry."""
        b = numpy.zeros(len(self.names))
        for end, sign in zip(between, (1.0, -1.0)):
            if str(end) == "ground" or str(end) in self.pinned:
                continue
            b[self.index(str(end))] += sign
        return b

    def load(self, t, side=0):
        f = numpy.zeros(len(self.names))
        for vector, law in self.loads:
            f += vector * law.value(t, side)
        return f

    def row(self, observed):
        """The row of a coordinate, or of a difference "a - b"."""
        text = str(observed)
        if text in self.names:
            return self.column([text, "ground"])
        first, _, second = text.partition(" - ")
        return self.column([first.strip(), second.strip()])

    def stuck_stiffness(self):
        stiffness = self.tangents()[0]
        for slider in self.sliders:
            stiffness += slider.stiffness * numpy.outer(slider.b, slider.b)
        return stiffness

    def tangents(self):
        """Stiffness and damping without sliders; laws by their tangents where nothing has moved, at rest at t = 0."""
        stiffness, damping = self.K.copy(), self.C.copy()
        for law in self.laws:
            k, c = law.tangents()
            stiffness += k * numpy.outer(law.b, law.b)
            damping += c * numpy.outer(law.b, law.b)
        return stiffness, damping


def _name(value):
    return str(value)


def read_model(study):
    raw = study.raw
    for key in ("body", "joint"):
        if key in raw:
            raise Unreadable("a mechanism")
    model = Model()
    assembly = _Assembly(study)
    if "matrices" in raw:
        assembly.matrices(raw["matrices"])
    for part in raw.get("coordinate", []):
        assembly.coordinate(part)
    assembly.nodes_and_elements()
    model.pinned = assembly.pinned
    free = [i for i, name in enumerate(assembly.names) if name not in assembly.pinned]
    model.names = [assembly.names[i] for i in free]
    model.rotation = [name.rsplit(".", 1)[-1] in ("rx", "ry", "rz") and "." in name and name in assembly.node_dofs
                      for name in model.names]
    pick = numpy.ix_(free, free)
    model.M, model.K, model.C = assembly.M[pick], assembly.K[pick], assembly.C[pick]
    model.q0, model.v0 = assembly.q0[free], assembly.v0[free]
    for part in raw.get("spring", []):
        b = model.column(part["between"])
        model.K += study.number(part["stiffness"]) * numpy.outer(b, b)
    for part in raw.get("damper", []):
        b = model.column(part["between"])
        model.C += study.number(part["damping"]) * numpy.outer(b, b)
    _contacts(study, model)
    _laws(study, model)
    _displacements(study, model)
    model.loads, model.held = [], numpy.zeros(len(model.names))
    _loads(study, model, assembly, free)
    _damping(study, model)
    return model


class _Assembly:
    def __init__(self, study):
        self.study = study
        self.names, self.pinned, self.node_dofs = [], set(), set()
        self.M = self.K = self.C = numpy.zeros((0, 0))
        self.q0 = self.v0 = numpy.zeros(0)
        self.unit_loads = {}  # of beams and trusses: direction -> vector
        self.is_node = []

    def _grow(self, names):
        self.names += names
        more = len(names)
        self.M, self.K, self.C = (numpy.pad(m, ((0, more), (0, more))) for m in (self.M, self.K, self.C))
        self.q0, self.v0 = numpy.pad(self.q0, (0, more)), numpy.pad(self.v0, (0, more))

    def coordinate(self, part):
        self._grow([_name(part["name"])])
        self.M[-1, -1] = self.study.number(part["mass"])
        self.q0[-1] = self.study.number(part.get("position", 0.0))
        self.v0[-1] = self.study.number(part.get("velocity", 0.0))

    def matrices(self, part):
        def read(key):
            matrix = scipy.io.mmread(self.study.folder / part[key])
            return numpy.asarray(matrix.todense() if hasattr(matrix, "todense") else matrix, dtype=float)
        mass = read("mass")
        n = len(mass)
        names = [_name(name) for name in part.get("names", range(1, n + 1))]
        self._grow(names)
        self.M[:], self.K[:] = mass, read("stiffness")
        if "damping" in part:
            self.C[:] = read("damping")
        for key, vector in (("position", self.q0), ("velocity", self.v0)):
            for name, value in part.get(key, {}).items():
                vector[names.index(name) if name in names else int(name) - 1] = self.study.number(value)

    def _mesh_rows(self, key):
        """The rows of `[nodes]` or `[beams]` from a file, as tables of the study."""
        part = self.study.raw.get(key)
        if part is None:
            return []
        with open(self.study.folder / part["file"], newline="") as file:
            rows = [{k.strip(): v.strip() for k, v in row.items()} for row in csv.DictReader(file)]
        if key == "nodes":
            return [{"name": row["name"], "position": [float(row[c]) for c in ("x", "y", "z") if c in row]}
                    for row in rows]
        common = {k: v for k, v in part.items() if k != "file"}
        beams = []
        for row in rows:
            beam = dict(common)
            beam["nodes"] = [row.pop("first"), row.pop("second")]
            beam.update({k: v for k, v in row.items() if v})
            beams.append(beam)
        return beams

    def nodes_and_elements(self):
        study, raw = self.study, self.study.raw
        nodes = raw.get("node", []) + self._mesh_rows("nodes")
        if not nodes:
            return
        places = {_name(node["name"]): study.numbers(node["position"]) for node in nodes}
        space = len(next(iter(places.values()))) == 3
        dofs = elements.SPACE if space else elements.PLANE
        spins = 3 if space else 1
        motion = {}
        for node in nodes:
            v = study.numbers(node.get("velocity", [0.0] * (len(dofs) - spins)))
            w = node.get("angular_velocity", [0.0] * spins)
            motion[_name(node["name"])] = numpy.concatenate([v, study.numbers(w if isinstance(w, list) else [w])])
        materials = {_name(m["name"]): self._material(m) for m in raw.get("material", [])}
        sections = {_name(s["name"]): self._section(s, space) for s in raw.get("section", [])}
        parts = []
        for beam in raw.get("beam", []) + self._mesh_rows("beams"):
            if beam.get("formulation") == "geometrically_exact":
                raise Unreadable("a mechanism")
            parts += self._beam_parts(beam, places, motion)
        for truss in raw.get("truss", []):
            ends = [_name(n) for n in truss["nodes"]]
            parts.append((truss, ends, True, [], _name(truss.get("name", "-".join(ends)))))
        slot = {}
        order = list(places)
        all_names = [f"{node}.{dof}" for node in order for dof in dofs]
        slot = {name: i for i, name in enumerate(all_names)}
        n = len(all_names)
        M, K, C = numpy.zeros((n, n)), numpy.zeros((n, n)), numpy.zeros((n, n))
        loads = {}
        for part, ends, is_truss, released, name in parts:
            rows = [slot[f"{end}.{dof}"] for end in ends for dof in dofs]
            k, m, tau, unit = self._element(part, [places[e] for e in ends], space, is_truss, released,
                                            materials, sections)
            M[numpy.ix_(rows, rows)] += m
            K[numpy.ix_(rows, rows)] += k
            C[numpy.ix_(rows, rows)] += tau * k
            vectors = loads.setdefault(name, numpy.zeros((n, 3 if space else 2)))
            vectors[rows] += unit
        for part in raw.get("mass", []):
            node = _name(part["node"])
            for dof in dofs[:-spins]:
                M[slot[f"{node}.{dof}"], slot[f"{node}.{dof}"]] += study.number(part.get("mass", 0.0))
            inertia = part.get("inertia", [0.0] * spins)
            for dof, value in zip(dofs[-spins:], inertia if isinstance(inertia, list) else [inertia]):
                M[slot[f"{node}.{dof}"], slot[f"{node}.{dof}"]] += study.number(value)
        scale = max(numpy.max(numpy.diag(M)), 1e-300)
        exist = [i for i in range(n) if M[i, i] > 1e-13 * scale * 1e-13]
        names = [all_names[i] for i in exist]
        at = len(self.names)
        self._grow(names)
        pick = numpy.ix_(exist, exist)
        self.M[at:, at:], self.K[at:, at:], self.C[at:, at:] = M[pick], K[pick], C[pick]
        everything = numpy.concatenate([motion[node] for node in order])
        self.v0[at:] = everything[exist]
        self.unit_loads = {name: numpy.concatenate([numpy.zeros((at, vectors.shape[1])), vectors[exist]])
                           for name, vectors in loads.items()}
        self.node_dofs = set(names)
        for part in raw.get("support", []):
            for dof in part["fix"]:
                self.pinned.add(f"{_name(part['node'])}.{dof}")

    def _material(self, part):
        number = self.study.number
        young = number(part["young"])
        shear = (number(part["shear_modulus"]) if "shear_modulus" in part
                 else young / (2 * (1 + number(part["poisson"]))) if "poisson" in part else None)
        return {"young": young, "density": number(part["density"]), "shear_modulus": shear,
                "retardation_time": number(part.get("retardation_time", 0.0))}

    def _section(self, part, space):
        number = self.study.number

        def several(key, default):
            value = part.get(key, default)
            return [number(v) for v in value] if isinstance(value, list) else [number(value)] * 2
        return {"area": number(part["area"]), "inertia": several("inertia", 0.0),
                "shear_factor": several("shear_factor", 1.0), "torsion": number(part.get("torsion", 0.0))}

    def _beam_parts(self, beam, places, motion):
        ends = [_name(n) for n in beam["nodes"]]
        name = _name(beam.get("name", "-".join(ends)))
        n = int(beam.get("elements", 1))
        chain = [ends[0]] + [f"{name}:{i}" for i in range(1, n)] + [ends[1]]
        for i in range(1, n):
            share = i / n
            places[chain[i]] = (1 - share) * places[ends[0]] + share * places[ends[1]]
            motion[chain[i]] = (1 - share) * motion[ends[0]] + share * motion[ends[1]]
        release = beam.get("release", {})
        parts = []
        for i in range(n):
            released = [(0, dof) for dof in release.get("first", []) if i == 0]
            released += [(1, dof) for dof in release.get("second", []) if i == n - 1]
            parts.append((beam, chain[i:i + 2], False, released, name))
        return parts

    def _element(self, part, ends, space, is_truss, released, materials, sections):
        """Stiffness, mass, retardation time, and what unit forces per length along the axes of the model do."""
        material, section = materials[_name(part["material"])], sections[_name(part["section"])]
        orientation = self.study.numbers(part["orientation"]) if "orientation" in part else None
        local = elements.axes(ends[0], ends[1], orientation)
        length = numpy.linalg.norm(ends[1] - ends[0])
        lumped = part.get("mass", "consistent") == "lumped"
        phi = [0.0, 0.0]
        if is_truss:
            k, m = elements.truss(space, length, material, section, lumped)
        else:
            flexible = part.get("formulation", "timoshenko") == "timoshenko"
            k, m = elements.beam(space, length, material, section, flexible, lumped)
            if flexible:
                bends = section["inertia"][::-1] if space else [section["inertia"][0]] * 2
                phi = [12 * material["young"] * i / (factor * section["area"] * material["shear_modulus"] * length**2)
                       for i, factor in zip(bends, section["shear_factor"])]
        dofs = elements.SPACE if space else elements.PLANE
        directions = 3 if space else 2
        unit = numpy.column_stack([elements.even_load(space, length, local[:, d], is_truss, phi[0], phi[1])
                                   for d in range(directions)])
        if released:
            gone = [end * len(dofs) + dofs.index(dof) for end, dof in released]
            t, kept = elements.released_shape(k, gone)
            spread = numpy.zeros((len(k), len(k)))
            spread[:, kept] = t
            k, m, unit = spread.T @ k @ spread, spread.T @ m @ spread, spread.T @ unit
        to_local = elements.turn(space, local)
        return (to_local.T @ k @ to_local, to_local.T @ m @ to_local, material["retardation_time"],
                to_local.T @ unit)


def _contacts(study, model):
    model.sliders, model.stops = [], []
    for i, part in enumerate(study.raw.get("slider", [])):
        b = model.column(part["between"])
        limit = study.number(part["friction_coefficient"]) * study.number(part["normal_load"])
        if limit > 0:
            model.sliders.append(Slider(_name(part.get("name", f"slider{i + 1}")), b,
                                        study.number(part["stiffness"]), limit, _rotates(model, b)))
    for i, part in enumerate(study.raw.get("stop", [])):
        b = model.column(part["between"])
        model.stops.append(Stop(_name(part.get("name", f"stop{i + 1}")), b, study.number(part["gap"]),
                                study.number(part["stiffness"]), study.number(part.get("damping", 0.0)),
                                _rotates(model, b)))


def _laws(study, model):
    def place(part):
        if "joint" in part:
            raise Unreadable("a joint of a structure")
        b = model.column(part["between"])
        return b, _rotates(model, b)
    model.laws = read_laws(study, place)


def _rotates(model, b):
    return any(model.rotation[i] for i in numpy.nonzero(b)[0])


def _displacements(study, model):
    model.held_displacements, model.moving = [], []
    for part in study.raw.get("displacement", []):
        i = model.index(_name(part["on"]))
        if "value" in part:
            model.held_displacements.append((i, study.number(part["value"]), _name(part["on"])))
        else:
            model.moving.append((i, study.law(part)))


def _loads(study, model, assembly, free):
    n = len(assembly.names)
    for part in study.raw.get("force", []):
        name = _name(part["on"])
        vector = numpy.zeros(len(model.names))
        vector[model.index(name)] = 1.0
        if "held" in part:
            model.held += vector * study.number(part["held"])
        else:
            model.loads.append((vector, study.law(part)))
    axis_dofs = ["x", "y", "z"]
    if "gravity" in study.raw:
        g = numpy.zeros(n)
        for dof, value in zip(axis_dofs, study.raw["gravity"]["acceleration"]):
            for i, name in enumerate(assembly.names):
                if name in assembly.node_dofs and name.endswith("." + dof):
                    g[i] = study.number(value)
        model.loads.append(((assembly.M @ g)[free], ConstantLaw()))
    for part in study.raw.get("distributed_force", []):
        unit = assembly.unit_loads[_name(part["on"])]
        model.loads.append(((unit @ study.numbers(part["direction"]))[free], study.law(part)))
    if "base_motion" in study.raw:
        part = study.raw["base_motion"]
        law = study.law(part)
        order = {"acceleration": 0, "velocity": 1, "displacement": 2}[part.get("of", "acceleration")]
        if order:
            w = law.angular_frequency
            law = HarmonicLaw(law.amplitude * w**order, w, law.phase + order * math.pi / 2)
        share = numpy.zeros(n)
        direction = part.get("direction")
        for i, name in enumerate(assembly.names):
            if name in assembly.node_dofs:
                axis = name.rsplit(".", 1)[-1]
                if axis in axis_dofs:
                    share[i] = study.number(direction[axis]) if direction and axis in direction else 0.0
            elif direction is None:
                share[i] = 1.0
            elif name in direction:
                share[i] = study.number(direction[name])
        model.loads.append((-(assembly.M @ share)[free], law))


def _damping(study, model):
    part = study.raw.get("damping", {})
    if "rayleigh" in part:
        model.C += (study.number(part["rayleigh"].get("mass", 0.0)) * model.M
                    + study.number(part["rayleigh"].get("stiffness", 0.0)) * model.K)
    if "modal_ratio" in part:
        moved = [i for i, _ in model.moving]
        free = [i for i in range(len(model.names)) if i not in moved]
        mass, stiffness = model.M[numpy.ix_(free, free)], model.K[numpy.ix_(free, free)]
        squares, phi = scipy.linalg.eigh(stiffness, mass)
        round_off = 1e-13 * numpy.einsum("im,ij,jm->m", numpy.abs(phi), numpy.abs(stiffness), numpy.abs(phi))
        omega = numpy.sqrt(numpy.where(squares > round_off, squares, 0.0))
        ratio = part["modal_ratio"]
        ratios = numpy.zeros(len(free))
        if isinstance(ratio, list) and len(ratio) > 1:
            ratios[:len(ratio)] = study.numbers(ratio)
        else:
            ratios[:] = study.number(ratio[0] if isinstance(ratio, list) else ratio)
        if "modes" in part:
            ratios[int(study.number(part["modes"])):] = 0.0
        damping = mass @ phi @ numpy.diag(2 * ratios * omega) @ phi.T @ mass
        t = numpy.zeros((len(free), len(model.names)))
        t[range(len(free)), free] = 1.0
        if moved:
            t[:, moved] = numpy.linalg.solve(stiffness, model.K[numpy.ix_(free, moved)])
        model.C += t.T @ damping @ t
