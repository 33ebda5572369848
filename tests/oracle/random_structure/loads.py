"""Contacts, displacements that are held or moved, and loads."""

from random_structure.models import Models


class Loads(Models):
    def contacts(self):
        ends = list(self.names)

        def between():
            first = self.random.choice(ends)
            others = [e for e in ends if e != first] + ["ground"]
            second = self.random.choice(others)
            return [first, second] if self.chance(0.5) or second == "ground" else [second, first]
        if self.chance(0.35):
            self.tables["slider"] = []
            for i in range(self.random.choice([1, 1, 2, 3])):
                stiffness = self.stiffness * self.log(0.1, 10)
                part = {"between": between(), "stiffness": self.number(stiffness),
                        "friction_coefficient": self.number(self.uniform(0.1, 0.8)),
                        "normal_load": self.number(stiffness * self.x * self.log(0.03, 3))}
                if self.chance(0.5):
                    part["name"] = f"slider {i}"
                self.tables["slider"].append(part)
        if self.chance(0.2):
            self.tables["stop"] = []
            for i in range(self.random.choice([1, 1, 2])):
                stiffness = self.stiffness * self.log(0.3, 100)
                part = {"between": between(), "gap": self.number(self.x * self.uniform(-0.2, 1.0)),
                        "stiffness": self.number(stiffness)}
                if self.chance(0.4):
                    part["damping"] = self.number(stiffness / self.omega * self.log(1e-3, 0.1))
                if self.chance(0.5):
                    part["name"] = f"stop {i}"
                self.tables["stop"].append(part)

    def displacements(self):
        if self.chance(0.15):
            self.tables["displacement"] = [{"on": self.random.choice(self.names), "value": self.number(self.x * self.uniform(-1, 1))}]
        elif self.chance(0.12) and len(self.names) > 1 and "slider" not in self.tables and "stop" not in self.tables:
            law = self.harmonic(self.x, self.omega) if self.chance(0.5) else {
                "expression": self.random.choice([
                    f"{self.x:.6g}*(1 - cos({self.omega * 0.7:.6g}*t))", f"{self.x:.6g}*sin({self.omega * 0.4:.6g}*t)^2",
                    f"{self.x:.6g}*t^2*{(self.omega**2):.6g}*exp(-t*{self.omega * 0.6:.6g})"])}
            if self.chance(0.25):
                law = {"table": self.table_file([(i * self.duration / 7, self.x * self.uniform(-1, 1)) for i in range(9)])}
            self.tables["displacement"] = [{"on": self.names[-1], **law}]
            for part in self.tables.get("coordinate", [])[-1:]:
                part.pop("position", None), part.pop("velocity", None)
            for part in self.tables.get("node", [])[-1:]:
                part.pop("velocity", None), part.pop("angular_velocity", None)
            for key in ("position", "velocity"):
                self.tables.get("matrices", {}).get(key, {}).pop(str(self.names[-1]), None)

    def loads(self, kinds):
        forces = []
        self.steady = kinds == ("harmonic",)
        for _ in range(self.random.choice([0, 1, 1, 2, 3])):
            part = {"on": self.random.choice(self.names)}
            part.update(self.law(self.stiffness * self.x * self.log(0.05, 1), self.omega, self.duration, kinds))
            forces.append(part)
        if self.chance(0.12):
            forces.append({"on": self.random.choice(self.names), "held": self.number(self.stiffness * self.x * self.uniform(-1, 1))})
        if forces:
            self.tables["force"] = forces
        for part in self.tables.get("distributed_force", []):
            del part["law"]
            part.update(self.law(self.stiffness * self.x, self.omega, self.duration, kinds))
        if self.chance(0.2):
            part = self.law(self.x * self.omega**2, self.omega, self.duration, kinds)
            if "amplitude" in part and self.chance(0.5):
                part["of"] = self.random.choice(["acceleration", "velocity", "displacement"])
                part["amplitude"] = self.number(self.x * self.omega ** {"acceleration": 2, "velocity": 1}.get(part["of"], 0))
            if self.frames:
                part["direction"] = {"x": self.number(1.0), "y": self.uniform(-1, 1)}
            elif self.chance(0.4):
                part["direction"] = {str(n): self.uniform(-1, 2) for n in self.names if self.chance(0.7)}
            self.tables["base_motion"] = part
