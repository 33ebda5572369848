"""Random studies of structures over the whole language, from a seed: `generate.py SEED FOLDER`."""

import math
import sys

from random_structure.analyses import Analyses
from random_structure.toml import write_toml


class Generator(Analyses):
    """One study; `build` writes it."""

    def build(self):
        kind = self.random.choices(["lumped", "plane", "space", "matrices"], [6, 3, 2, 1])[0]
        self.frames = kind in ("plane", "space")
        if kind == "lumped":
            self.lumped()
        elif kind == "matrices":
            self.from_matrices()
        else:
            self.frame(kind == "space")
        self.kind = kind
        self.duration = float(f"{2 * math.pi / self.omega * self.uniform(2, 8):.6g}")
        self.contacts()
        self.displacements()
        self.sweeps = self.chance(0.35)
        self.loads(("harmonic",) if self.sweeps else self.random.choice(
            [("harmonic",), ("harmonic", "table"), ("harmonic", "expression", "table")]))
        self.analyses()
        if not self.tables["parameters"]:
            del self.tables["parameters"]
        title = "" if self.chance(0.8) else 'title = "A random study"\n\n'
        order = ["parameters", "analysis"]
        tables = {k: v for k, v in self.tables.items() if k not in order}
        tables = {**({"parameters": self.tables["parameters"]} if "parameters" in self.tables else {}), **tables,
                  "analysis": self.tables["analysis"]}
        path = self.folder / "study.toml"
        path.write_text(title + write_toml(tables))
        return path


def generate(seed, folder):
    generator = Generator(seed, folder)
    while True:
        path = generator.build()
        if generator.tables["analysis"]:
            return path, generator.kind
        generator = Generator(generator.random.random(), folder)


if __name__ == "__main__":
    print(*generate(int(sys.argv[1]), sys.argv[2]))
