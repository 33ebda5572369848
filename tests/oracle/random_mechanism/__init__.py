"""Random mechanisms over the whole language, from a seed: `generate(seed, folder)` writes study.toml and its tables.

Everything is drawn in units in which lengths, masses and times are about 1, and written in units of `length`, `mass` and
`time` that lie anywhere between 1e-3 and 1e3 (now and then 1e-9 and 1e9), so that what the command does may not depend on them.
"""

import pathlib

import numpy as np

from random_mechanism.analyses import Analyses
from random_mechanism.draws import Draws
from random_mechanism.families import Families
from random_mechanism.joints import RandomJoints
from random_mechanism.parts import RandomParts


def text_of(value):
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, np.integer)):
        return str(int(value))
    if isinstance(value, (float, np.floating)):
        return repr(float(f"{value:.13g}"))
    if isinstance(value, str):
        return '"' + value + '"'
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{k} = {text_of(v)}" for k, v in value.items()) + " }"
    return "[" + ", ".join(text_of(v) for v in value) + "]"


class Generator(Draws, RandomParts, RandomJoints, Families, Analyses):
    def __init__(self, seed, folder):
        self.rng = np.random.default_rng([seed, 15])
        self.seed, self.folder = seed, pathlib.Path(folder)
        r = self.rng
        wide = 9 if r.random() < 0.06 else 3
        self.L, self.Mass, self.T = (10 ** r.uniform(-wide, wide) if r.random() < 0.6 else 1.0 for _ in range(3))
        if wide == 9 and self.L**2 * self.Mass > 1e14:
            self.L = 1.0
        self.F = self.Mass * self.L / self.T**2
        self.space = bool(r.random() < 0.5)
        self.tables = {"parameters": {}, "body": [], "node": [], "joint": [], "mass": [], "support": [], "material": [],
                       "section": [], "beam": [], "force": [], "spring": [], "damper": [], "analysis": []}
        self.parts = []        # (name, place, is_body)
        self.count = 0
        self.dry = 0
        self.duration = r.uniform(1.0, 2.5)
        self.jumps = False
        self.reaction = False
        self.friction_wanted = r.random() < 0.35
        self.lock_wanted = r.random() < 0.3
        self.drive_wanted = r.random() < 0.3
        self.has_beams = False

    def write(self):
        self.folder.mkdir(parents=True, exist_ok=True)
        family = self.pick(self.chain, self.chain, self.chain, self.four_bar, self.slider_crank, self.net, self.flexible)
        names = family()
        if family in (self.chain, self.net):
            self.close_loops(names)
        if not self.tables["joint"] and not self.tables["body"] and not self.tables["beam"]:
            return self.write()
        self.push(names)
        self.analyses()
        lines = [f"title = \"mechanism {self.seed}: {family.__name__}\""]
        if self.tables["parameters"]:
            lines += ["", "[parameters]"] + [f"{k} = {text_of(v)}" for k, v in self.tables["parameters"].items()]
        if "gravity" in self.tables:
            lines += ["", "[gravity]", f"acceleration = {text_of(self.tables['gravity']['acceleration'])}"]
        for key, tables in self.tables.items():
            if key in ("parameters", "gravity"):
                continue
            for table in tables:
                lines += ["", f"[[{key}]]"] + [f"{k} = {text_of(v)}" for k, v in table.items()]
        path = self.folder / "study.toml"
        path.write_text("\n".join(lines) + "\n")
        return path


def generate(seed, folder):
    pathlib.Path(folder).mkdir(parents=True, exist_ok=True)
    return Generator(seed, folder).write()
