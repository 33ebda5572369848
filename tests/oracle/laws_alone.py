"""The oracle's Bouc-Wen elements and nonlinear springs, without the command: `laws_alone.py`. Exit status 1 where anything differs.

Held against numbers that were computed elsewhere (events and closed forms between turns; shooting and harmonic balance of high order),
against the flow by matrix exponentials where formulas are linear, against balances of energy, and mechanisms against structures.
"""

import math
import os
import pathlib
import sys
import tempfile

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import numpy  # noqa: E402
from scipy.integrate import quad  # noqa: E402
from scipy.optimize import brentq, minimize_scalar  # noqa: E402

import flow  # noqa: E402
import statics  # noqa: E402
import transient  # noqa: E402
from mechanism import Mechanism  # noqa: E402
from mechanism.columns import transient_row  # noqa: E402
from mechanism.march import March as MechanismMarch  # noqa: E402
from nonlinear.laws import BoucWen  # noqa: E402
from nonlinear.steady import Shooting  # noqa: E402
from structure.model import read_model  # noqa: E402
from study import Study  # noqa: E402

failures = []
scratch = tempfile.TemporaryDirectory()


def check(what, value, expected, allowed):
    error = abs(value - expected) / max(abs(expected), 1e-300) if expected else abs(value)
    good = error <= allowed
    print(f"{'ok' if good else 'DIFFERS':8}{what:70}{error:10.2e} of {allowed:.0e}")
    if not good:
        failures.append(what)


def study_of(text):
    path = pathlib.Path(scratch.name) / "study.toml"
    path.write_text(text + '\n[[analysis]]\nname = "a"\ntype = "static"\n')
    return Study(path)


# ---- loops of a given displacement
LOOPS = {  # (n, beta, gamma, U): z at three turns
    (1, 0.5, 0.5, 1): (0.632120558829, -0.745353619956, 0.71482332544),
    (1, 0.5, 0.5, 3): (0.950212931632, -0.993589301659, 0.993305109787),
    (1, 0.2, 0.8, 1): (0.632120558829, -0.700376504051, 0.664278087442),
    (2, 0.5, 0.5, 1): (0.761594155956, -0.845000321512, 0.819403604953),
    (2, 0.5, 0.5, 3): (0.995054753687, -0.999910097811, 0.999909220586),
    (2, 0.2, 0.8, 1): (0.761594155956, -0.809397263251, 0.781545876275)}
AREAS = {(1, 0.5, 0.5, 3): 7.04011320673, (2, 0.5, 0.5, 3): 7.61415952897}  # of the loop that repeats


def loops():
    for (n, beta, gamma, U), turns in LOOPS.items():
        law = BoucWen("b", None, 1.0, 0.0, 1.0, beta, gamma, n)
        name, z = f"loop n={n} beta={beta} U={U}", 0.0
        for number, (du, expected) in enumerate(zip((U, -2 * U, 2 * U), turns), 1):
            z = law.after(z, du)[0]
            check(f"{name}: turn {number}", z, expected, 1e-11)
        for _ in range(400):
            z = law.after(law.after(z, -2 * U)[0], 2 * U)[0]
        fall = gamma - beta  # from z to 0, and on to -z, in closed form
        back = {1: lambda x: x if fall == 0 else -math.log(1 - fall * x) / fall,
                2: lambda x: x if fall == 0 else math.atanh(math.sqrt(fall) * x) / math.sqrt(fall)}[n]
        on = {1: lambda way: 1 - math.exp(-way), 2: math.tanh}[n]
        repeats = brentq(lambda x: on(2 * U - back(x)) - x, 1e-6, 1 - 1e-9, xtol=1e-15)
        check(f"{name}: turn of what repeats", z, repeats, 1e-11)
        down = brentq(lambda du: law.after(z, -du)[0], 0, 2 * U, xtol=1e-14)
        check(f"{name}: where z vanishes", down, back(repeats), 1e-11)
        area = -2 * quad(lambda du: law.after(z, -du)[0], 0, 2 * U, points=[down], epsabs=1e-13, epsrel=1e-13, limit=200)[0]
        if (n, beta, gamma, U) in AREAS:
            check(f"{name}: area", area, AREAS[n, beta, gamma, U], 1e-10)


# ---- periodic motions of one mass
OSCILLATOR = """
[parameters]
Omega = 1.0
F = {F}
[[coordinate]]
name = "x"
mass = 1.0
[[damper]]
between = ["x", "ground"]
damping = {c}
{law}
[[force]]
on = "x"
amplitude = "F"
angular_frequency = "Omega"
"""
BOUC_WEN = '[[bouc_wen]]\nbetween = ["x", "ground"]\nstiffness = 1.0\npost_yield_ratio = 0.1\nbeta = 0.5\ngamma = 0.5\nn = {n}'
STEADY = {  # (n, w): largest u, (1 - alpha) k of the area in z, a period
    (1, 0.5): (0.450780851511, 0.053834863548), (1, 0.7): (0.847936441856, 0.33720943227), (1, 0.85): (1.3257405138, 1.12861316178),
    (1, 1): (0.991463047334, 0.521487967447), (1, 1.3): (0.38530775992, 0.0338176475331),
    (2, 0.5): (0.408333928153, 0.0124864683822), (2, 0.7): (0.642662212912, 0.0758199955675),
    (2, 0.85): (1.34836949001, 1.16555726886), (2, 1): (1.15416536236, 0.69696710315), (2, 1.3): (0.420820285801, 0.0140817147059)}


def largest(shooting, x, periods=1):
    """The largest x of a motion, to round-off: at v = 0 of the march."""
    shooting.put(x)
    march, found = shooting.flow, []

    def watch(t, y):
        found.append((float(march.phi[0] @ y[:march.n]), t))
    march.advance(periods * shooting.period, numpy.linspace(0, periods * shooting.period, 400 * periods + 1)[1:-1], watch)
    top = max(found)[1]

    def at(t):
        shooting.put(x)
        march.advance(t)
        return -float(march.full()[0][0])
    reach = shooting.period / 400
    return -minimize_scalar(at, bounds=(top - reach, top + reach), method="bounded", options={"xatol": 1e-9}).fun


def multipliers(shooting, x):
    moves = 1e-4 * numpy.max(numpy.abs(x)) * numpy.eye(len(x))
    return numpy.linalg.eigvals(numpy.array([(8 * (shooting.after(x + d) - shooting.after(x - d)) - shooting.after(x + 2 * d)
                                              + shooting.after(x - 2 * d)) / (12 * numpy.max(d)) for d in moves]).T)


def hysteretic_steady():
    for (n, w), (u, work) in STEADY.items():
        study = study_of(OSCILLATOR.format(F=0.3, c=0.02, law=BOUC_WEN.format(n=n)))
        shooting = Shooting(read_model(study.with_parameters({"Omega": w})), tolerance=1e-12)
        x = shooting.solve(shooting.march(shooting.state(), 30), settled=1e-12)
        check(f"Bouc-Wen n={n} w={w}: largest u", largest(shooting, x), u, 1e-9)
        lost = shooting.waves(x, 8)["lost"][0]
        check(f"Bouc-Wen n={n} w={w}: work", lost, work, 1e-9)


DUFFING = '[[spring]]\nbetween = ["x", "ground"]\nstiffness = 1.0\n[[nonlinear_spring]]\nbetween = ["x", "ground"]\nforce = "0.1*u^3"'
BRANCHES = {  # w, x0, v0: largest x, first harmonic, a multiplier
    (0.7, 0.3455, 0.0164): (0.346347610791, 0.346042258797, -0.74444292159 + 0.29017093438j),
    (1.0, 1.2197, 0.4928): (1.31256260159, 1.30534547319, 0.67636379289 + 0.52243153687j),
    (1.2, 1.3342, 2.5429): (2.54557670058, 2.50919758111, 0.80986414531 + 0.33732103201j),
    (1.2, -1.4619, 2.0943): (2.28664818219, 2.26054889051, 1.3149072722),
    (1.2, -0.4136, 0.0700): (0.417672948936, 0.417520453585, 0.48848658645 + 0.72872921401j),
    (1.3, -0.2605, 0.0325): (0.26168132047, 0.261649785437, 0.127281502 + 0.87699589331j)}
ESCAPE = '[[nonlinear_spring]]\nbetween = ["x", "ground"]\nforce = "u - u^2"'


def smooth_steady():
    study = study_of(OSCILLATOR.format(F=0.18, c=0.05, law=DUFFING))
    for (w, x0, v0), (top, first, multiplier) in BRANCHES.items():
        model = read_model(study.with_parameters({"Omega": w}))
        shooting = Shooting(model, 1e-12, (numpy.array([x0]), numpy.array([v0])))
        x = shooting.solve(shooting.state(), settled=1e-12)
        name = f"Duffing w={w} x0={x0}"
        check(f"{name}: largest x", largest(shooting, x), top, 1e-10)
        q = shooting.waves(x, 512)["q"][:, 0]
        check(f"{name}: first harmonic", abs(numpy.fft.rfft(q)[1]) / 256, first, 1e-9)
        check(f"{name}: multiplier", min(abs(multipliers(shooting, x) - multiplier)), 0.0, 1e-7)
    # escape: where the period doubles, and one of two periods beyond
    shooting = Shooting(read_model(study_of(OSCILLATOR.format(F=0.100501010278, c=0.1, law=ESCAPE)).with_parameters({"Omega": 0.85})), 1e-12,
                        (numpy.array([-0.337]), numpy.array([0.37])))
    x = shooting.solve(shooting.state(), settled=1e-12)
    check("escape, the period doubles: largest x", largest(shooting, x), 0.782440383659, 1e-9)
    shooting = Shooting(read_model(study_of(OSCILLATOR.format(F=0.101501010278, c=0.1, law=ESCAPE)).with_parameters({"Omega": 0.85})), 1e-12)
    shooting.period *= 2
    x = shooting.solve(shooting.march(numpy.array([-0.28, 0.427]) / shooting.scales, 25), settled=1e-12)
    check("escape, two periods: largest x", largest(shooting, x), 0.821861493985, 1e-9)
    check("escape, two periods: multiplier", min(abs(multipliers(shooting, x) - (0.447890966 + 0.165519396j))), 0.0, 1e-7)


# ---- formulas that are linear, and elements that are springs, against matrix exponentials
CHAIN = """
[[coordinate]]
name = "a"
mass = 1.0
velocity = 0.4
[[coordinate]]
name = "b"
mass = 0.6
position = 0.3
[[spring]]
between = ["a", "ground"]
stiffness = 20.0
[[slider]]
between = ["a", "b"]
stiffness = 15.0
friction_coefficient = 0.3
normal_load = 2.0
[[stop]]
between = ["b", "ground"]
gap = 0.08
stiffness = 300.0
damping = 1.5
[[force]]
on = "b"
expression = "t < 1.3 ? 3*sin(4*t) : 2*cos(7*t)"
"""
LINEAR = '[[spring]]\nbetween = ["b", "a"]\nstiffness = 8.0\n[[damper]]\nbetween = ["b", "ground"]\ndamping = 0.2\n'
FORMULAS = {
    "formula": '[[nonlinear_spring]]\nbetween = ["b", "a"]\nforce = "8*u"\n[[nonlinear_spring]]\nbetween = ["b", "ground"]\nforce = "0.2*rate"\n',
    "Bouc-Wen without z": '[[bouc_wen]]\nbetween = ["b", "a"]\nstiffness = 8.0\npost_yield_ratio = 1.0\n'
                          '[[nonlinear_spring]]\nbetween = ["b", "ground"]\nforce = "0.2*rate"\n',
    "Bouc-Wen without a limit": '[[bouc_wen]]\nbetween = ["b", "a"]\nstiffness = 8.0\nbeta = 0\ngamma = 0\n'
                                '[[nonlinear_spring]]\nbetween = ["b", "ground"]\nforce = "rate > 0 ? 0.2*rate : 0.2*rate"\n'}


def against_exponentials():
    times = list(numpy.linspace(0, 6, 61))
    rows, exact = transient.march(read_model(study_of(CHAIN + LINEAR)), {}, times)
    assert isinstance(exact, flow.Flow)
    for name, text in FORMULAS.items():
        if "without a limit" in name:  # z = u only where it starts at u = 0
            continue
        other, _ = transient.march(read_model(study_of(CHAIN + text)), {}, times)
        for key, allowed in (("q", 1e-8), ("v", 1e-8), ("slider_force", 1e-8), ("stop_force", 1e-7), ("slid", 1e-8)):
            size = numpy.max(numpy.abs(rows[key]))
            check(f"{name}: {key} with slider and stop", numpy.max(numpy.abs(other[key] - rows[key])) / size, 0.0, allowed)
    start = CHAIN.replace("position = 0.3", "")
    rows, _ = transient.march(read_model(study_of(start + LINEAR)), {}, times)
    other, _ = transient.march(read_model(study_of(start + FORMULAS["Bouc-Wen without a limit"])), {}, times)
    check("Bouc-Wen without a limit: q", numpy.max(numpy.abs(other["q"] - rows["q"])) / numpy.max(numpy.abs(rows["q"])), 0.0, 1e-8)


FREE = """
[[coordinate]]
name = "x"
mass = 2.0
velocity = 1.5
[[bouc_wen]]
between = ["ground", "x"]
stiffness = 3.0
post_yield_ratio = 0.2
A = 1.4
beta = {beta}
gamma = {gamma}
n = {n}
[[nonlinear_spring]]
between = ["x", "ground"]
force = "0.5*u + 0.7*u^3 + 0.1*max(u - 0.2, 0)"
"""


def balances():
    """What is stored and what was dissipated add up; and z is that of closed form along the way of u."""
    for n, beta, gamma in ((1, 0.5, 0.5), (1.5, 2.0, -0.7), (2, 0.8, 0.8), (3, 0.4, 1.6)):
        model = read_model(study_of(FREE.format(n=n, beta=beta, gamma=gamma)))
        times = list(numpy.linspace(0, 12, 49))
        rows, march = transient.march(model, {}, times)
        energy = rows["v"][:, 0]**2 + rows["law_stored"].sum(axis=1) + rows["law_dissipated"].sum(axis=1)
        check(f"balance of energy n={n}", numpy.max(numpy.abs(energy / energy[0] - 1)), 0.0, 1e-8)
        if abs(gamma) <= beta:
            check(f"nothing comes from nothing n={n}", float(numpy.min(numpy.diff(rows["law_dissipated"][:, 0])) < -1e-9), 0.0, 0.5)
        law, again = model.laws[0], transient.begin(model, {}, 12.0)
        z, u, shares = 0.0, 0.0, []
        for t in numpy.linspace(0, 12, 49)[1:]:
            turns = []
            again.advance(t)
            turns = [e[0] for e in again.events if e[1] == [0]]
            u = rows_at(model, turns + [t])
            z = 0.0
            for before, now in zip([0.0] + u[:-1], u):
                z = law.after(z, now - before)[0]
            shares.append(abs(z - again.z[0]))
        check(f"z along the way of u n={n}", max(shares) / numpy.max(numpy.abs(rows["law_force"])), 0.0, 1e-8)


def rows_at(model, times):
    march, found = transient.begin(model, {}, 12.0), []
    for t in times:
        march.advance(t)
        found.append(float(model.laws[0].b @ march.full()[0]))
    return found


def equilibria():
    for n, curve in ((1, lambda u: 1 - math.exp(-u)), (2, math.tanh)):
        text = OSCILLATOR.format(F=0.0, c=0.0, law=BOUC_WEN.format(n=n))
        for load in (0.2, 0.8, 3.0):
            model = read_model(study_of(text.replace('amplitude = "F"\nangular_frequency = "Omega"', f"held = {load}")))
            u = brentq(lambda x: 0.1 * x + 0.9 * curve(x) - load, 0, 50, xtol=1e-14)
            state = statics.equilibrium(model)
            check(f"equilibrium n={n} of {load}", float(state.q[0]), u, 1e-11)
            check(f"memory there n={n} of {load}", state.memories[0], curve(u), 1e-11)


# ---- a slide and a hinge against one coordinate
SLIDE = """
[[body]]
name = "block"
position = [0.0, 0.0]
mass = 1.7
inertia = 0.3
velocity = [0.9, 0.0]
[[joint]]
name = "way"
type = "prismatic"
between = ["ground", "block"]
at = [0.0, 0.0]
axis = [1.0, 0.0]
damping = 0.1
{laws}
[[force]]
on = "block.x"
amplitude = 2.0
angular_frequency = 3.0
"""
SLIDE_ALONE = """
[[coordinate]]
name = "x"
mass = 1.7
velocity = 0.9
[[damper]]
between = ["x", "ground"]
damping = 0.1
{laws}
[[force]]
on = "x"
amplitude = 2.0
angular_frequency = 3.0
"""
LAWS = """
[[bouc_wen]]
{where}
stiffness = 6.0
post_yield_ratio = 0.15
beta = 3.0
gamma = 2.0
n = 1.5
[[nonlinear_spring]]
{where}
force = "2*u + 3*u^3 + 0.2*rate*abs(rate)"
"""


def mechanisms():
    times = list(numpy.linspace(0, 5, 41))
    alone, _ = transient.march(read_model(study_of(SLIDE_ALONE.format(laws=LAWS.format(where='between = ["x", "ground"]')))), {}, times)
    hinge = SLIDE.replace("prismatic", "revolute").replace("axis = [1.0, 0.0]\n", "").replace("inertia = 0.3", "inertia = 1.7").replace(
        "velocity = [0.9, 0.0]", "angular_velocity = 0.9").replace("block.x", "block.rz")
    for name, text, where, column in (("slide", SLIDE, 'joint = "way"', "block.x.position [m]"),
                                      ("coordinate of a body", SLIDE, 'between = ["block.x", "ground"]', "block.x.position [m]"),
                                      ("hinge", hinge, 'joint = "way"', "block.rz.angle [rad]")):
        march = MechanismMarch(Mechanism(study_of(text.format(laws=LAWS.format(where=where)))))
        pairs = march.run(5.0, times, columns=transient_row)
        x = numpy.array([row[column] for row, _ in pairs])
        check(f"{name}: motion", numpy.max(numpy.abs(x - alone["q"][:, 0])) / numpy.max(numpy.abs(x)), 0.0, 1e-7)
        for k, law in enumerate(("bouc_wen1", "nonlinear_spring1")):
            f = numpy.array([row[f"{law}.force [N]"] for row, _ in pairs])
            check(f"{name}: force of {law}", numpy.max(numpy.abs(f - alone["law_force"][:, k])) / numpy.max(numpy.abs(f)), 0.0, 1e-6)
            lost = numpy.array([row[f"{law}.dissipated [J]"] for row, _ in pairs])
            check(f"{name}: work of {law}", numpy.max(numpy.abs(lost - alone["law_dissipated"][:, k])) / numpy.max(lost), 0.0, 1e-6)


def main():
    for part in (loops, hysteretic_steady, smooth_steady, against_exponentials, balances, equilibria, mechanisms):
        part()
    print(f"{len(failures)} differ" + "".join(f"\n  {what}" for what in failures))
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
