"""Analyses: static, modes, transients."""

from random_structure.steady_analyses import SteadyAnalyses


class Analyses(SteadyAnalyses):
    def analyses(self):
        list_ = []
        add = list_.append
        if self.chance(0.7):
            add({"name": "rest", "type": "static"})
            if "displacement" in self.tables and "value" in self.tables["displacement"][0] and self.chance(0.5):
                list_[-1]["displacements"] = []
        if self.chance(0.7):
            add({"name": "modes", "type": "modes"})
            if self.chance(0.2):
                list_[-1]["count"] = self.random.randint(1, 3)
            if self.chance(0.1):
                list_[-1]["observe"] = [str(self.names[0])]
        transient = {"type": "transient", "duration": self.number(self.duration)}
        if self.chance(0.3) and self.at_rest():
            transient["initial"] = "static"
        if self.chance(0.2):
            transient["energy"] = False
        tolerance = 10.0 ** -self.random.randint(2, 6)
        step = {"tolerance": tolerance}
        if "slider" in self.tables and self.chance(0.7):
            step["events"] = "locate"
        automatic = {"name": "automatic", **transient, "step": step}
        if self.chance(0.35):
            name = self.random.choice(["average_acceleration", "hht", "wbz", "linear_acceleration", "wilson_theta",
                                       "dormand_prince", "bogacki_shampine", "fox_goodwin", "generalized_alpha",
                                       "newmark", "central_difference"])
            automatic["method"] = self.method(name)
        self.automatic_keys(automatic)
        if self.chance(0.85):
            add(automatic)
        loads_exact = not any("expression" in p for key in ("force", "distributed_force") for p in self.tables.get(key, []))
        loads_exact = loads_exact and "expression" not in self.tables.get("base_motion", {})
        if self.chance(0.5) and loads_exact and "stop" not in self.tables and not self.moving():
            add({"name": "exact", **transient, "method": "exact"})
        if self.chance(0.5):
            name = self.random.choice(["average_acceleration", "hht", "wbz", "linear_acceleration", "wilson_theta", "rk4",
                                       "heun", "central_difference", "generalized_alpha", "damped_newmark", "galerkin",
                                       "backward_difference", "exponential", "newmark", "fox_goodwin", "midpoint", "ralston",
                                       "rk3", "bogacki_shampine", "dormand_prince", "explicit_euler"])
            steps = self.random.choice([400, 1000, 2000])
            duration = self._evaluate(transient["duration"])
            for k in (1, 2):
                add({"name": f"equal@{k}", **transient, "method": self.method(name), "step": duration / steps / k,
                     "output": {"every": 10 * k}})
        self.steady_analyses(add)
        self.random.shuffle(list_)
        list_.sort(key=lambda a: a["name"])
        self.tables["analysis"] = list_

    def automatic_keys(self, part):
        """The rarer keys of a transient whose steps choose themselves."""
        step, duration = part["step"], self.duration
        if self.chance(0.15):
            step["first"] = self.number(duration / self.random.choice([1000, 5000]))
        if self.chance(0.15):
            step["largest"] = self.number(duration / self.random.choice([60, 200, 500]))
        if self.chance(0.1):
            step["smallest"] = self.number(duration * 1e-11)
        if self.chance(0.1):
            step["rebuild"] = False
        method = part.get("method", "generalized_alpha")
        method = method["name"] if isinstance(method, dict) else method
        pairs = ("dormand_prince", "bogacki_shampine", "wilson_theta")
        way = self.random.random()
        if way < 0.06 and method not in pairs:
            step["estimator"] = "local_error"
        elif way < 0.1 and method in pairs:
            step["estimator"] = "embedded"
        elif way < 0.16 and method not in ("dormand_prince", "bogacki_shampine"):
            step.update({"controller": "cardona_cassano", "estimator": "inertia_jump", "tolerance": 1e-3})
            if self.chance(0.5):
                step["reference"] = self.random.choice(["initial", self.x])
            if self.chance(0.3):
                step["as_printed"] = True
            step["first"] = duration / 2000
        elif way < 0.2:
            step.update({"controller": "fixed", "first": duration / 2000})
        elif way < 0.25:
            step["controller"] = "pi"
        if self.chance(0.1) and "stop" in self.tables:
            step["events"] = "pass"
        if self.chance(0.15):
            part["output"] = self.random.choice([{"every": 2}, {"interval": self.duration / 50},
                                                 {"times": [0.1 * self.duration, 0.55 * self.duration, self.duration]}])
        if self.chance(0.12):
            part["observe"] = [str(n) for n in self.names[:2]]
            if len(self.names) > 1 and not self.frames:
                part["observe"].append(f"{self.names[0]} - {self.names[-1]}")
        if "initial" in part and "displacement" in self.tables and "value" in self.tables["displacement"][0] and self.chance(0.5):
            part["displacements"] = [str(self.tables["displacement"][0]["on"])]
        if self.chance(0.05):
            part["allow_unstable"] = True

    def at_rest(self):
        """Static starts find the positions, so none may be given."""
        return not any("position" in c for c in self.tables.get("coordinate", [])) and "position" not in self.tables.get(
            "matrices", {})

    def method(self, name):
        if name == "hht" and self.chance(0.7):
            return {"name": name, "alpha": -0.1}
        if name in ("wbz", "generalized_alpha") and self.chance(0.5):
            return {"name": name, "rho_inf": self.uniform(0.3, 1)}
        if name == "newmark":
            return {"name": name, "beta": 0.3, "gamma": 0.55}
        if name == "wilson_theta" and self.chance(0.5):
            return {"name": name, "theta": 1.42}
        return name

    def moving(self):
        return any("value" not in d for d in self.tables.get("displacement", []))
