"""Random studies with the keys that those of `generate.py` lack, for seeds from 20001 on: `generate_more.py SEED FOLDER`.

Models and loads are drawn as there; beams come from files with one section and orientation for all, supports are moved by tables that
end early, responses and curves are over Hertz, and methods have their numbers.
"""

import math
import sys

from generate import Generator

FIRST = 20001


class MoreKeys(Generator):
    def frame(self, space):
        super().frame(space)
        if "beam" not in self.tables or self.chance(0.4):
            return
        beams = self.tables.pop("beam")
        common = {k: beams[0][k] for k in ("formulation", "mass", "material", "section") if k in beams[0]}
        if space and self.chance(0.8):
            common["orientation"] = [self.uniform(-0.3, 0.3), self.uniform(-1, 1), 1.0]
        (self.folder / "beams.csv").write_text("first,second,name\n" + "".join(
            f"{b['nodes'][0]},{b['nodes'][1]},{b.get('name', '')}\n" for b in beams))
        self.tables["beams"] = {"file": "beams.csv", **common}
        for part in self.tables.get("distributed_force", []):  # parts of the beam that it was for had names of their own
            part["on"] = next(b["name"] for b in beams if "name" in b)

    def displacements(self):
        if self.chance(0.7) or len(self.names) < 2 or {"slider", "stop"} & set(self.tables):
            return super().displacements()
        rows = [(i * self.duration / 9, self.x * self.uniform(-1, 1)) for i in range(self.random.randrange(3, 7))]
        beyond = self.random.choice(["zero", "hold"])
        if beyond == "zero":
            rows[0], rows[-1] = (0.0, 0.0), (rows[-1][0], 0.0)
        self.tables["displacement"] = [{"on": self.names[-1], "table": self.table_file(rows), "beyond": beyond}]
        for part in self.tables.get("coordinate", [])[-1:]:
            part.pop("position", None), part.pop("velocity", None)
        for part in self.tables.get("node", [])[-1:]:
            part.pop("velocity", None), part.pop("angular_velocity", None)
        for key in ("position", "velocity"):
            self.tables.get("matrices", {}).get(key, {}).pop(str(self.names[-1]), None)

    def loads(self, kinds):
        self.sweeps = not self.moving() and self.chance(0.8)
        super().loads(("harmonic",) if self.sweeps else kinds)

    def analyses(self):
        names = [str(n) for n in self.names]
        self.tables["analysis"] = list_ = []
        if self.chance(0.5):
            list_.append({"name": "rest", "type": "static", "observe": self.random.sample(names, min(2, len(names)))})
            if len(names) > 1 and not self.frames:
                list_[-1]["observe"].append(f"{names[0]} - {names[-1]}")
        if self.moving() or self.chance(0.2):
            list_.append({"name": "automatic", "type": "transient", "duration": self.duration,
                          "step": {"tolerance": 10.0 ** -self.random.randint(3, 5)}})
        if self.sweeps:
            self.over_hertz(list_)

    def numbered(self):
        """A method with numbers of its own."""
        return self.random.choice([{"name": "generalized_alpha", "rho_inf": self.uniform(0.2, 1)}, {"name": "wbz", "rho_inf": self.uniform(0.2, 1)},
                                   {"name": "newmark", "beta": self.uniform(0.26, 0.4), "gamma": 0.5}, {"name": "hht", "alpha": self.uniform(-0.3, 0)},
                                   {"name": "wilson_theta", "theta": self.uniform(1.38, 2)}])

    def over_hertz(self, list_):
        loads = [p for key in ("force", "distributed_force") for p in self.tables.get(key, []) if "amplitude" in p]
        loads += [self.tables["base_motion"]] if "amplitude" in self.tables.get("base_motion", {}) else []
        if not loads:
            return
        hertz = self.omega / (2 * math.pi)
        self.tables["parameters"].update({"Hertz": 0.9 * hertz, "load": 1.0})
        for i, part in enumerate(loads):
            part.pop("angular_frequency", None)
            part["frequency"] = "Hertz" if i == 0 or self.chance(0.7) else "2*Hertz"
        contacts = {"slider", "stop"} & set(self.tables)
        ends = {"from": 0.3 * hertz * self.log(0.8, 1.2), "to": 2.5 * hertz}
        part = {"name": "response", "type": "frequency_response", "excitation": "Hertz",
                "frequency": {**ends, "points": self.random.choice([3, 5])}}
        if self.chance(0.5):
            part["frequency"]["spacing"] = self.random.choice(["log", "linear"])
        if "stop" in contacts or self.chance(0.4):
            part.update({"solver": "time_marching", "method": self.numbered()})
        elif self.frames:
            part["solver"] = "harmonic_balance"
        if self.chance(0.6):
            part["waveforms"] = {"at": {"from": ends["from"], "to": 2 * hertz, "points": 2}, "points": self.random.choice([24, 40])}
        list_.append(part)
        if len(self.names) <= 3 and not self.frames and "stop" not in contacts and self.chance(0.6):
            self.curve(list_, ends)
        if not contacts and self.chance(0.5):
            step = 1 / hertz / 50
            methods = [self.numbered() for _ in range(3)]
            methods = [m for i, m in enumerate(methods) if m not in methods[:i]]
            list_.append({"name": "methods", "type": "method_study", "step": step, "duration": 100 * step, "methods": methods,
                          "ladder": [step, step / 3]})

    def curve(self, list_, ends):
        """Over what presses the sliders, or over the loads where there are none."""
        for part in self.tables.get("slider", []):
            part["normal_load"] = f"({part['normal_load']})*load"
        if "slider" not in self.tables:
            part = self.tables["force"][0] if "amplitude" in self.tables.get("force", [{}])[0] else None
            if not part:
                return
            part["amplitude"] = f"({part['amplitude']})*(1 + (load - 1.2)^2)"
        part = {"name": "curve", "type": "damper_curve", "parameter": "load", "excitation": "Hertz",
                "range": {"from": self.uniform(0.1, 0.5), "to": self.uniform(2, 5), "points": 4}, "frequency": {**ends, "points": 17}}
        if "slider" in self.tables:
            part["objective"] = self.random.choice(["amplitude", "dissipated"])
        name = next((k for k, v in self.tables["parameters"].items() if k[0] == "p" and isinstance(v, float)), None)
        if name and self.chance(0.5):
            value = self.tables["parameters"][name]
            part["sweep"] = {name: sorted([value, 1.1 * value])}
        list_.append(part)


def generate(seed, folder):
    generator = MoreKeys(seed, folder)
    while True:
        path = generator.build()
        if generator.tables["analysis"]:
            return path, generator.kind
        generator = MoreKeys(generator.random.random(), folder)


if __name__ == "__main__":
    print(*generate(int(sys.argv[1]), sys.argv[2]))
