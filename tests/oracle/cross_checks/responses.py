"""A steady response by each of its solvers against a long transient under the same loads.

What may differ: the linear limits are solved to round-off, `periodic` to 1e-8 of the amplitudes, the two others to their tolerance
(four times it, for it is an estimate), and rates of sliders and stops five times as much, for no tolerance is of them. The
transient adds the error of its own steps, what has not died away (told by its last periods), and, where an extreme lies on a
kink, what lies between two of its rows. Its accelerations are `M^-1 (f - C v - K x)`: they magnify what its velocities err by in
the fastest motion of rate s by `|s|/Omega`, which is 8,000 where damping by stiffness meets an explicit pair (seed 118: 0.25 % at a tolerance of
1e-7, 0.0002 % at 1e-10).
"""

import math

import numpy

from cross_checks.command import NoAnswer, Wrong, coordinates, motions, run, table
from cross_checks.structures import Structure, rates

ROWS = 384           # a period
MOST_PERIODS = 500


def study(seed, folder):
    """A damped structure under harmonic loads of "Omega"."""
    made = Structure(seed, folder, kinds=("lumped", "lumped", "lumped", "matrices", "plane", "space"))
    made.damped()
    made.tables["parameters"]["Omega"] = made.omega

    def law(size):
        if made.chance(0.15):
            return {"expression": f"{size * made.sign():.8g}"}
        part = {"amplitude": size * made.sign()}
        if made.chance(0.3):
            part["frequency"] = made.random.choice(["Omega/(2*pi)", "Omega/pi"])
        else:
            part["angular_frequency"] = made.random.choice(["Omega", "Omega", "Omega", "2*Omega", "3*Omega"])
        if made.chance(0.6):
            part["phase"] = made.uniform(-4, 4)
        return part
    made.tables["force"] = [{"on": made.random.choice(made.names), "amplitude": made.stiffness * made.x * made.log(0.1, 1),
                             "angular_frequency": "Omega"}]
    for _ in range(made.random.choice([0, 0, 1, 2])):
        made.force(law, made.log(0.05, 1))
    if made.chance(0.1) and len(made.names) > 1 and not {"slider", "stop"} & set(made.tables):
        made.tables["displacement"] = [{"on": made.names[-1], "amplitude": made.x * made.sign(), "angular_frequency": "Omega",
                                        "phase": made.uniform(-3, 3)}]
        made.tables["force"] = [f for f in made.tables["force"] if str(f["on"]) != made.names[-1]]
    return made


def solvers(made):
    """(analysis, tolerance of its amplitudes)."""
    if "stop" in made.tables:
        kinds = [("time_marching", 1e-3)]
    elif "slider" in made.tables:
        kinds = [("harmonic_balance", made.random.choice([1e-2, 1e-3, 1e-4])), ("time_marching", 1e-3)]
        kinds += [("periodic", None)] if not made.frames else []
    else:
        kinds = [(None, None), ("harmonic_balance", None), ("time_marching", made.random.choice([1e-2, 1e-3, 1e-4]))]
    out = []
    for solver, tolerance in kinds:
        part = {"name": solver or "linear", "type": "frequency_response", "excitation": "Omega"}
        if solver:
            part["solver"] = solver
        if tolerance and tolerance != 1e-3:
            part["tolerance"] = tolerance
        if made.chance(0.3):
            part["harmonics"] = [2, 3]
        out.append((part, 4 * tolerance if tolerance else 2e-7))
    return out


def check(command, seed, folder):
    """[(what, error, allowed)] of every solver, frequency and column."""
    made = study(seed, folder)
    frequencies = sorted(float(f"{made.omega * made.log(0.25, 2.5):.6g}") for _ in range(2))
    analyses = solvers(made)
    for part, _ in analyses:
        part["angular_frequency"] = frequencies
    results = run(command, made.write([part for part, _ in analyses]), folder / "steady")
    found, notes = [], []
    for row, w in enumerate(frequencies):
        try:
            found += [(f"Omega = {w:g}: {what}", error, allowed)
                      for what, error, allowed in _at(command, made, results, analyses, row, w, folder)]
        except NoAnswer as why:
            notes.append(why)
    if not found:
        raise NoAnswer(notes[0].outcome, "; ".join(map(str, notes)))
    return found


def _at(command, made, results, analyses, row, w, folder):
    answers = [(part["name"], table(results, part["name"]), limit) for part, limit in analyses]
    answers = [(name, rows, limit) for name, rows, limit in answers if rows.text("status")[row] == "converged"]
    if answers:
        march = March(command, made, w, folder / f"march{row}")
        for name, rows, limit in answers:
            yield from ((f"{name}: {what}", error, allowed) for what, error, allowed in march.differences(rows, row, limit, name))
            yield from ((f"{name}: {what}", error, allowed) for what, error, allowed in march.energies(rows, row, limit))
    if "slider" in made.tables:
        limits = table(results, f"{analyses[0][0]['name']}.linear")
        # stuck by a load beyond any force here: springs in their place would change what [damping] is made of
        held = [{**slider, "normal_load": 1e9 * made.stiffness * made.x} for slider in made.tables["slider"]]
        for word, sliders in (("free", []), ("stuck", held)):
            march = March(command, made, w, folder / f"{word}{row}", slider=sliders, stop=[])
            yield from march.limits(limits, row, word)
    if not answers:
        raise NoAnswer("skipped", "no solver converged")


class March:
    """The last periods of a long transient at one frequency, with other tables in place of some of the model's."""

    def __init__(self, command, made, w, folder, **replaced):
        replaced["parameters"] = {**made.tables["parameters"], "Omega": w}
        model = made.model(**replaced)
        self.omega = made.omega
        found = rates(model)
        slowest = float(numpy.min(-found.real))
        self.fastest = float(numpy.max(numpy.abs(found))) / w
        period = 2 * math.pi / w  # all loads are of Omega and of multiples of it
        if not slowest > 0:
            raise NoAnswer("skipped", "a motion that does not die away")
        self.periods = max(6, math.ceil(20 / slowest / period))
        if self.periods > MOST_PERIODS:
            raise NoAnswer("skipped", f"{self.periods} periods until the motion repeats")
        self.contacts = bool(model.sliders or model.stops)
        self.way = made.random.choice(["exact", "exact", "pair", "implicit"])
        if self.way == "exact" and (model.stops or model.moving):
            self.way = "pair"
        times = [period * (self.periods - 3 + k / ROWS) for k in range(3 * ROWS + 1)]
        part = {"name": "march", "type": "transient", "duration": period * self.periods * (1 + 1e-9), "output": {"times": times}}
        if self.way == "exact":
            part["method"] = "exact"
            self.error = 1e-7 if self.contacts else 1e-8
        else:
            tolerance = {"pair": 1e-7, "implicit": 1e-5}[self.way]
            part["step"] = {"tolerance": tolerance, **({"events": "locate"} if self.contacts else {})}
            if self.way == "pair":
                part["method"] = "dormand_prince"
            self.error = tolerance * (50 if self.contacts else 10)
        rows = table(run(command, made.write([part], f"{folder.name}.toml", **replaced), folder), "march")
        self.names = coordinates(rows)
        self.x = [motions(rows, self.names, order) for order in range(3)]
        if len(self.x[0]) != 3 * ROWS + 1:
            raise Wrong(f"{len(self.x[0])} rows of {3 * ROWS + 1}")
        self.error += self._unsettled()
        self._sliders(rows)
        ledger = table(folder, "march.energy")
        self.works = {head: ledger.column(head)[-1] - ledger.column(head)[-1 - ROWS] for head in ledger.head[1:]}

    def _unsettled(self):
        """What the motion still has to go, of its size: changes of the last periods fall by a factor each."""
        x = self.x[0]
        size = max(numpy.max(numpy.abs(x[-ROWS:])), 1e-300)
        before, last = (numpy.max(numpy.abs(x[k * ROWS:(k + 1) * ROWS] - x[(k + 1) * ROWS:(k + 2) * ROWS])) / size for k in (0, 1))
        if last > 1e-4:
            raise NoAnswer("skipped", f"the march does not repeat ({last:.1e} after {self.periods} periods)")
        factor = min(last / before, 0.9) if before > 0 else 0.0
        return last / (1 - factor)

    def _sliders(self, rows):
        """A slider that rests now and has slipped before remembers what one without force at the start does not."""
        for head in rows.head:
            if head.endswith((".slip [m]", ".slip_angle [rad]")):
                slip = rows.column(head)[-ROWS:]
                scale = numpy.max(numpy.abs(self.x[0]))
                if numpy.ptp(slip) <= 1e-9 * scale < numpy.max(numpy.abs(slip)):
                    raise NoAnswer("skipped", "a slider rests that has slipped")

    def _columns(self, rows, turns, word):
        return [i for i, (name, t) in enumerate(self.names) if t == turns and rows.has(name + word)]

    def _size(self, order, places):
        """Of a rate at least round-off of what was moved before."""
        whole = numpy.max(numpy.abs(self.x[order][-ROWS - 1:-1, places]))
        return max(whole, 1e-9 * self.omega**order * numpy.max(numpy.abs(self.x[0][:, places])), 1e-300)

    def differences(self, rows, row, limit, solver):
        marched = solver == "time_marching" or solver == "harmonic_balance" and self.contacts
        for turns in (False, True):
            places = self._columns(rows, turns, WORDS[turns][0])
            if not places:
                continue
            for order, word in enumerate(WORDS[turns]):
                if order == 2 and (self.contacts or self.way == "implicit"):
                    continue  # an acceleration is as exact as the force at that instant, which no tolerance is of
                magnified = 10**order if order < 2 or self.way == "exact" else max(100, self.fastest)
                allowed = limit * (5 if order and marched else 1) + self.error * magnified
                size = self._size(order, places)
                for place in places:
                    name = self.names[place][0]
                    x = self.x[order][-ROWS - 1:-1, place]
                    value, between = half_range(x)
                    kink = between if self.contacts else of_parabolas(x)
                    yield f"{name}{word}", abs(rows.column(name + word)[row] - value) / size, allowed + kink / size
            size = self._size(0, places)
            for place in places:
                name, x = self.names[place][0], self.x[0][-ROWS - 1:-1, place]
                first = first_harmonic(x)
                if abs(first) > 1e-3 * size:
                    told = numpy.exp(1j * rows.column(f"{name}.phase [rad]")[row])
                    yield f"{name}.phase [rad]", abs(told - first / abs(first)) * abs(first) / size, 3 * (limit + self.error)
                for word, value in ((".angle_mean [rad]" if turns else ".mean [m]", numpy.mean(x)),
                                    (".angle_rms [rad]" if turns else ".rms [m]", math.sqrt(numpy.mean(x * x)))):
                    yield name + word, abs(rows.column(name + word)[row] - value) / size, limit + self.error

    def energies(self, rows, row, limit):
        """What a period takes and gives, of the ledger; works are of second order in amplitudes and their errors. Those of
        steps are trapezoids, which err by more than the tolerance."""
        if self.way != "exact":
            return
        taken = {"slider_dissipated [J]": sum(rows.column(head)[row] for head in rows.head if head.endswith(".dissipated [J]")),
                 "damper_dissipated [J]": rows.column("viscous_work [J]")[row]}
        size = max(sum(self.works.get(head, 0.0) for head in taken), 1e-300)
        for head, work in taken.items():
            yield head, abs(self.works.get(head, 0.0) - work) / size, 10 * (limit + self.error)
        given = sum(self.works.get(head, 0.0) for head in ("load_work [J]", "drive_work [J]"))
        yield "input_work [J]", abs(given - rows.column("input_work [J]")[row]) / size, 10 * (limit + self.error)

    def limits(self, rows, row, limit):
        """The linear limits: solved to round-off."""
        for turns in (False, True):
            word = f".{limit}_angle_amplitude [rad]" if turns else f".{limit}_amplitude [m]"
            places = self._columns(rows, turns, word)
            size = self._size(0, places) if places else 1.0
            for place in places:
                name, x = self.names[place][0], self.x[0][-ROWS - 1:-1, place]
                error = abs(rows.column(name + word)[row] - half_range(x)[0]) / size
                yield name + word, error, 2e-7 + self.error + of_parabolas(x) / size
                first = first_harmonic(x)
                if abs(first) > 1e-3 * size:
                    told = numpy.exp(1j * rows.column(f"{name}.{limit}_phase [rad]")[row])
                    yield f"{name}.{limit}_phase", abs(told - first / abs(first)) * abs(first) / size, 6e-7 + 3 * self.error


WORDS = {False: [".amplitude [m]", ".velocity_amplitude [m/s]", ".acceleration_amplitude [m/s2]"],
         True: [".angle_amplitude [rad]", ".angular_velocity_amplitude [rad/s]", ".angular_acceleration_amplitude [rad/s2]"]}


def first_harmonic(x):
    """A of A cos(Omega t + phase), complex, of a period that begins at a multiple of its length, where the phase is that at t = 0."""
    return 2 * numpy.mean(x * numpy.exp(-2j * math.pi * numpy.arange(len(x)) / len(x)))


def of_parabolas(x):
    """What half_range errs by where x is smooth: with twice the distance of rows it errs at least eight times as much. The top of a
    wave may be flat by its harmonics, so that its bend says little of it (seed 144)."""
    return abs(half_range(x[::2])[0] - half_range(x)[0]) / 4


def half_range(x):
    """Half peak to peak by parabolas through the extreme rows, and how far the rows beside lie from them."""
    def top(y):
        i = int(numpy.argmax(y))
        a, b, c = y[i - 1], y[i], y[(i + 1) % len(y)]
        bend = a - 2 * b + c
        return (b - (c - a)**2 / (8 * bend) if bend < 0 else b), max(b - a, b - c)
    (high, above), (low, below) = top(x), top(-x)
    return 0.5 * (high + low), 0.5 * (above + below)
