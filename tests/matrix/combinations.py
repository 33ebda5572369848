"""Every method x way of stepping x kind of model x output."""
from dataclasses import dataclass

from models import MODELS, Model

# name in the study, order of positions and velocities (0: exact on linear models, second order with friction)
METHODS = {
    '"explicit_euler"': 1, '"heun"': 2, '"midpoint"': 2, '"ralston"': 2, '"rk3"': 3, '"rk4"': 4, '"bogacki_shampine"': 3,
    '"dormand_prince"': 5, '"central_difference"': 2, '"fox_goodwin"': 2, '"linear_acceleration"': 2,
    '"average_acceleration"': 2, '"galerkin"': 1, '"backward_difference"': 1, '"damped_newmark"': 1,
    '{ name = "newmark", beta = 0.3, gamma = 0.5 }': 2, '{ name = "newmark", beta = 0.4, gamma = 0.7 }': 1,
    '"wilson_theta"': 2, '{ name = "hht", alpha = -0.1 }': 2, '{ name = "wbz", rho_inf = 0.6 }': 2,
    '"generalized_alpha"': 2, '{ name = "generalized_alpha", rho_inf = 0.0 }': 2, '"exponential"': 0, '"exact"': 0,
}
CONTROLLERS = (None, "pi", "cardona_cassano", "fixed")
ESTIMATORS = (None, "local_error", "embedded", "inertia_jump")
OUTPUTS = ("every", "interval", "times")
# A method of first order takes as many steps as its tolerance is small.
TOLERANCES = {1: (1e-2, 3e-3, 1e-3), 2: (1e-3, 1e-4, 1e-5), 3: (1e-4, 1e-5, 1e-6)}
RUNGS = 5


@dataclass(frozen=True)
class Combination:
    model: Model
    method: str
    stepping: tuple | None    # (controller, estimator) of automatic steps; None: equal steps
    output: str

    @property
    def name(self):
        stepping = "equal" if self.stepping is None else f"{self.stepping[0] or 'default'}/{self.stepping[1] or 'default'}"
        return f"{self.model.name} {self.method} {stepping} {self.output}"

    @property
    def order(self):
        return METHODS[self.method]

    @property
    def has_equal_steps(self):
        return self.stepping is None or self.stepping[0] == "fixed"

    @property
    def has_inertia_jump(self):
        """The estimator whose tolerance is one of its source, which methods of second order have by default with
        `cardona_cassano`: the errors follow its steps at tolerances below those of the others only."""
        is_default = self.stepping == ("cardona_cassano", None) and self.order == 2
        return not self.has_equal_steps and (self.stepping[1] == "inertia_jump" or is_default)

    @property
    def has_stability_limit(self):
        return self.method in ('"central_difference"', '"fox_goodwin"', '"linear_acceleration"')

    def rungs(self):
        """What the ladder varies: steps [s] of equal steps, tolerances of automatic ones, nothing of `exact`."""
        if self.method == '"exact"' and self.stepping is None:
            return [None]
        if self.has_equal_steps:
            return [self.model.step / 2**k for k in range(RUNGS)]
        return list(TOLERANCES[min(self.order or 2, 3)]) + ([1e-6, 1e-7] if self.has_inertia_jump else [])

    def analysis(self, name, rung):
        model = self.model
        lines = ["[[analysis]]", f'name = "{name}"', 'type = "transient"', f"duration = {model.duration}",
                 f"method = {self.method}"]
        if self.stepping is None:
            if rung is not None:
                lines.append(f"step = {rung!r}")
        else:
            controller, estimator = self.stepping
            tolerance = 1e-3 if self.has_equal_steps else rung
            keys = [f"tolerance = {tolerance!r}"]
            keys += [f'controller = "{controller}"'] if controller else []
            keys += [f'estimator = "{estimator}"'] if estimator else []
            if self.has_equal_steps:
                keys.append(f"first = {rung!r}")
            if self.method != '"exact"':
                lines.append(f"step = {{ {', '.join(keys)} }}")
        tenth = model.duration / 10
        if self.output == "interval":
            lines.append(f"output = {{ interval = {tenth!r} }}")
        elif self.output == "times":
            lines.append(f"output = {{ times = {[round(tenth * k, 12) for k in range(11)]} }}")
        else:
            lines.append(f"output = {{ every = {round(tenth / rung) if self.has_equal_steps and rung else 1} }}")
        if model.static:
            lines.append('initial = "static"')
        if model.project:
            lines.append("project_velocities = true")
        lines.append("energy = false")
        return "\n".join(lines) + "\n"


def all_combinations():
    """Each output with equal steps and with the default automatic ones; the other ways of stepping take turns at them."""
    ways = [None] + [(c, e) for c in CONTROLLERS for e in ESTIMATORS]
    chosen = []
    for model in MODELS:
        for method in METHODS:
            for index, way in enumerate(ways):
                outputs = OUTPUTS if way in (None, (None, None)) else OUTPUTS[index % 3:index % 3 + 1]
                chosen += [Combination(model, method, way, output) for output in outputs]
    return chosen
