"""What is asked of a random mechanism."""



class Analyses:
    def analyses(self):
        duration = self.duration * self.T
        out = self.tables["analysis"]
        method = self.pick(None, "generalized_alpha", {"name": "generalized_alpha", "rho_inf": self.uniform(0.2, 0.95)},
                           {"name": "hht", "alpha": self.uniform(-0.3, -0.05)}, {"name": "wbz", "rho_inf": self.uniform(0.2, 0.9)})
        tolerance = self.log(1e-6, 1e-4)
        step = {"tolerance": tolerance}
        if self.chance(0.3):
            step["controller"] = self.pick("pi", "pi", "cardona_cassano")
        if self.chance(0.15) and step.get("controller") != "cardona_cassano":
            step["estimator"] = "local_error"
        if self.chance(0.2):
            step["first"] = 1e-4 * duration
        if self.chance(0.2):
            step["largest"] = 0.01 * duration
        auto = {"name": "auto", "type": "transient", "duration": self.value(duration), "step": step,
                "output": self.pick({"interval": duration / 30}, {"every": 1}, {"times": [float(x) * duration for x in (0.1, 0.35, 0.7, 0.999)]})}
        if method is not None:
            auto["method"] = method
        if self.chance(0.4):
            auto["project_velocities"] = True
        if self.has_beams:
            auto["section_forces"] = True
        if self.chance(0.15):
            auto["energy"] = False
        if self.chance(0.15):
            kept = [f"{n}.{'xy'[int(self.rng.integers(2))]}" for n, _, _ in self.parts]
            auto["observe"] = [k for k in kept if not any(s["node"] + "." in k for s in self.tables["support"])] or ["j1"]
            if auto["observe"] == ["j1"]:
                del auto["observe"]
        out.append(auto)
        if self.chance(0.1):
            out.append({"name": "watched", "type": "transient", "duration": duration, "output": {"interval": duration / 20},
                        "step": {"tolerance": 1e-4, "controller": "fixed", "first": duration / 1000}})
        if self.chance(0.2):
            out.append({"name": "reached", "type": "modes", "about": {"analysis": "auto"}})
            if self.chance(0.5):
                out[-1]["about"]["time"] = 0.6 * duration
        if self.chance(0.6):
            n = 400
            equal = self.pick("generalized_alpha", {"name": "hht", "alpha": self.uniform(-0.3, -0.05)}, {"name": "newmark", "beta": 0.3025, "gamma": 0.6},
                              "damped_newmark", {"name": "generalized_alpha", "rho_inf": self.uniform(0.1, 0.95)})
            project = self.chance(0.5)
            for name, count in (("coarse", n), ("half", 2 * n)):
                a = {"name": name, "type": "transient", "method": equal, "duration": duration, "step": duration / count,
                     "output": {"every": count // 40}}
                if project:
                    a["project_velocities"] = True
                out.append(a)
        if self.chance(0.5):
            out.append({"name": "rest", "type": "static"})
            if self.has_beams and self.chance(0.5):
                out[-1]["section_forces"] = ["rod" if "name" in self.tables["beam"][0] else "-".join(self.tables["beam"][0]["nodes"])]
            out.append({"name": "swing", "type": "modes", "about": "static"})
            if self.chance(0.3):
                out.append({"name": "from rest", "type": "transient", "initial": "static", "duration": duration, "step": {"tolerance": tolerance},
                            "output": {"interval": duration / 20}})
        if self.chance(0.4):
            out.append({"name": "given", "type": "modes"})
            if self.chance(0.5):
                out[-1]["about"] = "given"
