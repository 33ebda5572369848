"""Analyses over frequency, damper curves and studies of methods."""

import math

from random_structure.loads import Loads


class SteadyAnalyses(Loads):
    def steady_analyses(self, add):
        if not self.sweeps or self.moving():
            return
        harmonics = [p for key in ("force", "distributed_force") for p in self.tables.get(key, []) if "amplitude" in p]
        if "base_motion" in self.tables:
            harmonics.append(self.tables["base_motion"])
        if not harmonics:
            return
        self.tables["parameters"]["Omega"] = self.omega * 0.9
        for i, part in enumerate(harmonics):
            part.pop("frequency", None)
            part["angular_frequency"] = "Omega" if i == 0 or self.chance(0.6) else "3*Omega"
        solver = self.random.choice([None, "periodic", "harmonic_balance", "time_marching"])
        if "stop" in self.tables:
            solver = "time_marching"
        part = {"name": "response", "type": "frequency_response",
                "angular_frequency": [float(f"{self.omega * f:.6g}") for f in sorted(self.log(0.2, 4) for _ in range(3))]}
        if self.chance(0.4):
            part["angular_frequency"] = {"from": self.omega * 0.3, "to": self.omega * 3, "points": 7, "spacing": self.random.choice(["log", "linear"])}
        if self.chance(0.3):
            part["excitation"] = "Omega"
        if solver:
            part["solver"] = solver
        if self.chance(0.2):
            part["observe"] = [str(self.names[0])] + ([f"{self.names[0]} - {self.names[-1]}"] if len(self.names) > 1 else [])
        if self.chance(0.3):
            part["harmonics"] = [3] if self.chance(0.5) else [2, 3]
        if solver == "time_marching":
            if self.chance(0.4):
                part["method"] = self.method(self.random.choice(["average_acceleration", "exponential", "hht"]))
            if self.chance(0.3):
                part["steps_per_period"] = 512
            if self.chance(0.3):
                part["max_periods"] = 600
        if solver and solver != "periodic" and self.chance(0.4):
            part["tolerance"] = self.number(self.random.choice([1e-2, 1e-3, 1e-4]))
        if self.chance(0.2):
            at = part["angular_frequency"]
            part["waveforms"] = {"at": [at[0] if isinstance(at, list) else at["from"]], "points": 32}
        if self.chance(0.15):
            part["start"] = self.random.choice(["unloaded", "previous", "rest"])
            if part["start"] == "previous" and self.chance(0.5):
                part["direction"] = self.random.choice(["up", "down", "both"])
        if self.chance(0.35):
            self.sweep(part)
        if self.chance(0.15) and "Hz" not in part:
            part["frequency"] = [w / (2 * math.pi) for w in self.frequencies(part.pop("angular_frequency"))]
            for load in harmonics:
                if load.get("angular_frequency") in ("Omega", "3*Omega"):
                    load["frequency"] = load.pop("angular_frequency")
            if "excitation" not in part:
                part["excitation"] = "Omega"
            self.tables["parameters"]["Omega"] = self.omega * 0.9 / (2 * math.pi)
        add(part)
        if self.chance(0.3) and len(self.names) <= 3 and not self.frames and "stop" not in self.tables and "frequency" not in part:
            name = next((k for k in self.tables["parameters"] if k[0] == "p" and isinstance(self.tables["parameters"][k], float)), None)
            if name:
                value = self.tables["parameters"][name]
                curve = {"name": "curve", "type": "damper_curve", "parameter": name,
                         "range": sorted([value * 0.8, value * 1.3, value]),
                         "angular_frequency": {"from": self.omega * 0.3, "to": self.omega * 3, "points": 33},
                         "excitation": "Omega", "optimum": self.chance(0.3)}
                if self.chance(0.2):
                    curve["objective"] = self.random.choice(["amplitude", "dissipated"])
                if self.chance(0.3):
                    curve["observe"] = str(self.names[0])
                add(curve)
        if self.chance(0.2) and not self.frames and "slider" not in self.tables and "stop" not in self.tables:
            period = 2 * math.pi / self.omega
            study = {"name": "methods", "type": "method_study", "step": period / 100, "duration": 3 * period}
            if self.chance(0.5):
                study["methods"] = ["average_acceleration", {"name": "hht", "alpha": -0.1}]
            if self.chance(0.3):
                study["ladder"] = [period / 100, period / 200]
            if self.chance(0.3):
                study["observe"] = str(self.names[0])
            add(study)

    @staticmethod
    def frequencies(values):
        if isinstance(values, list):
            return values
        return [values["from"], 0.5 * (values["from"] + values["to"]), values["to"]]

    def sweep(self, part):
        names = [k for k, v in self.tables["parameters"].items() if k[0] == "p" and isinstance(v, float)]
        if not names:
            return
        name = names[0]
        value = self.tables["parameters"][name]
        way = self.random.randrange(4)
        if way == 0:
            part["sweep"] = {name: [value, value * 1.2]}
        elif way == 1:
            low, high = sorted([value, value * 1.5])
            part["sweep"] = {name: {"from": low, "to": high, "points": 2}}
            if len(names) > 1:
                part["sweep"][names[1]] = [self.tables["parameters"][names[1]]]
        elif way == 2:
            (self.folder / "cases.csv").write_text(f"{name}\n{value!r}\n{value * 0.9!r}\n")
            part["sweep"] = {"file": "cases.csv"}
        else:
            part["sweep"] = {"samples": 2, "seed": self.random.randrange(100),
                             "sampling": self.random.choice(["latin_hypercube", "sobol", "random"]),
                             "parameters": {name: self.random.choice([
                                 {"distribution": "normal", "mean": value, "deviation": abs(value) * 0.02},
                                 {"distribution": "uniform", "from": min(value, value * 1.1), "to": max(value, value * 1.1)},
                                 {"distribution": "lognormal", "median": abs(value), "deviation": 0.05}])}}
