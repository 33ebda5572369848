"""The kinds of model that the matrix crosses with every method.

Each model is a study without analyses. It says how long it runs, the base step of the ladder of equal steps (shorter than
the stability limit of explicit methods where these are to be tried), and whether its motion is smooth: where sliders,
stops, friction and impacts change the equations within a step, methods have the order of their transitions only.
"""
from dataclasses import dataclass, field


@dataclass
class Model:
    name: str
    text: str
    duration: float          # [s]
    step: float              # [s], duration/step is a whole number that 8 divides
    smooth: bool = True
    damped: bool = True      # Fox-Goodwin has order 4 where nothing is damped
    mechanism: bool = False
    static: bool = False     # analyses start with initial = "static"
    project: bool = False    # analyses have project_velocities = true
    reference: str = 'method = "dormand_prince"\nstep = { tolerance = 1e-10, events = "locate" }'
    files: dict = field(default_factory=dict)

    @property
    def least_size(self):
        """Of what errors are relative to, in each unit."""
        return 0.01 if self.mechanism else 0.0


EXACT = 'method = "exact"'
FINE = 'step = { tolerance = 1e-7, events = "locate" }'

TWO_MASSES = """
[[coordinate]]
name = "a"
mass = 1.0
position = 0.3
[[coordinate]]
name = "b"
mass = 0.5
velocity = -0.8
[[spring]]
between = ["a", "ground"]
stiffness = 30.0
[[spring]]
between = ["a", "b"]
stiffness = 12.0
[[damper]]
between = ["b", "ground"]
damping = 0.15
"""

UNDAMPED = TWO_MASSES.replace("""[[damper]]
between = ["b", "ground"]
damping = 0.15
""", "")

AT_REST = TWO_MASSES.replace("position = 0.3\n", "").replace("velocity = -0.8\n", "")

CANTILEVER = """
[[node]]
name = "root"
position = [0.0, 0.0]
[[node]]
name = "tip"
position = [1.0, 0.2]
[[material]]
name = "steel"
young = 2e11
poisson = 0.3
density = 7800.0
retardation_time = 2e-4
[[section]]
name = "strip"
area = 2e-4
inertia = 6e-9
shear_factor = 0.8
[[beam]]
name = "arm"
nodes = ["root", "tip"]
section = "strip"
material = "steel"
elements = 2
mass = "lumped"
[[support]]
node = "root"
fix = ["x", "y", "rz"]
"""

PENDULUMS = """
[[body]]
name = "upper"
mass = 2.0
inertia = 0.05
position = [0.3, 0.0]
[[body]]
name = "lower"
mass = 1.0
inertia = 0.02
position = [0.8, 0.1]
[[joint]]
name = "A"
type = "revolute"
between = ["ground", "upper"]
at = [0.0, 0.0]
{A}
[[joint]]
name = "B"
type = "revolute"
between = ["upper", "lower"]
at = [0.6, 0.0]
{B}
[gravity]
acceleration = [0.0, -9.81]
"""


def pendulums(first="", second=""):
    return PENDULUMS.replace("{A}", first).replace("{B}", second)


SLIDER_CRANK = """
[[body]]
name = "crank"
mass = 1.0
inertia = 0.01
position = [0.1, 0.0]
[[body]]
name = "rod"
mass = 2.0
inertia = 0.06
position = [0.5, 0.0]
[[body]]
name = "piston"
mass = 1.5
inertia = 0.002
position = [0.8, 0.0]
[[joint]]
name = "shaft"
type = "revolute"
between = ["ground", "crank"]
at = [0.0, 0.0]
{shaft}
[[joint]]
name = "pin"
type = "revolute"
between = ["crank", "rod"]
at = [0.2, 0.0]
[[joint]]
name = "wrist"
type = "revolute"
between = ["rod", "piston"]
at = [0.8, 0.0]
[[joint]]
name = "cylinder"
type = "prismatic"
between = ["ground", "piston"]
at = [0.8, 0.0]
axis = [1.0, 0.0]
{cylinder}
"""


def slider_crank(shaft="", cylinder=""):
    return SLIDER_CRANK.replace("{shaft}", shaft).replace("{cylinder}", cylinder)


TOP = """
[[body]]
name = "top"
mass = 15.0
inertia = [0.234375, 0.46875, 0.234375]
position = [0.0, 1.0, 0.0]
velocity = [1.0, 0.0, 0.0]
angular_velocity = [0.0, 20.0, -1.0]
[[joint]]
name = "foot"
type = "spherical"
between = ["ground", "top"]
at = [0.0, 0.0, 0.0]
[gravity]
acceleration = [0.0, 0.0, -9.81]
"""

TILTED = """
[[body]]
name = "flap"
mass = 3.0
inertia = [0.2, 0.05, 0.22]
position = [0.3, 0.4, 0.0]
[[joint]]
name = "hinge"
type = "revolute"
between = ["ground", "flap"]
at = [0.0, 0.0, 0.0]
axis = [0.2, 1.0, 0.3]
{hinge}
[[body]]
name = "tail"
mass = 0.7
inertia = [0.02, 0.02, 0.01]
position = [0.9, 0.4, 0.1]
[[joint]]
name = "cross"
type = "universal"
between = ["flap", "tail"]
at = [0.6, 0.4, 0.0]
axis = [0.0, 1.0, 0.0]
second_axis = [0.0, 0.0, 1.0]
[gravity]
acceleration = [0.0, 0.0, -9.81]
"""


def tilted(hinge=""):
    return TILTED.replace("{hinge}", hinge)


MASS_MTX = "%%MatrixMarket matrix coordinate real symmetric\n4 4 4\n1 1 2.0\n2 2 1.0\n3 3 1.5\n4 4 0.5\n"
STIFFNESS_MTX = ("%%MatrixMarket matrix coordinate real symmetric\n4 4 7\n1 1 50.0\n2 2 60.0\n3 3 40.0\n4 4 20.0\n"
                 "2 1 -20.0\n3 2 -15.0\n4 3 -12.0\n")
DAMPING_MTX = "%%MatrixMarket matrix coordinate real symmetric\n4 4 2\n1 1 0.4\n3 3 0.2\n"
MATRICES = """
[matrices]
mass = "mass.mtx"
stiffness = "stiffness.mtx"
damping = "damping.mtx"
"""
MATRIX_FILES = {"mass.mtx": MASS_MTX, "stiffness.mtx": STIFFNESS_MTX, "damping.mtx": DAMPING_MTX}

# Corners of the table lie on the equal steps of every ladder; the last value jumps.
TABLE = "time [s],force [N]\n0,0\n0.5,6\n1.0,6\n1.0,-4\n2.0,0\n"
FORCE_TABLE = """
[[force]]
on = "{on}"
table = "force.csv"
beyond = "zero"
"""


def force(on, law):
    return f'[[force]]\non = "{on}"\n{law}\n'


HARMONIC = "amplitude = 2.0\nangular_frequency = 4.0\nphase = 0.4"
FORMULA = 'expression = "3*sin(5*t) + (t < 1 ? 2 : 0)"'

MODELS = [
    Model("lumped-free", TWO_MASSES, 2.0, 0.02, reference=EXACT),
    Model("lumped-undamped", UNDAMPED, 2.0, 0.02, damped=False, reference=EXACT),
    Model("lumped-rayleigh", UNDAMPED + "[damping]\nrayleigh = { mass = 0.1, stiffness = 0.01 }\n" + force("a", HARMONIC),
          2.0, 0.02, reference=EXACT),
    Model("lumped-modal", UNDAMPED + "[damping]\nmodal_ratio = 0.05\n" + force("b", HARMONIC), 2.0, 0.02, reference=EXACT),
    Model("lumped-formula", TWO_MASSES + force("a", FORMULA), 2.0, 0.02),
    Model("lumped-table", TWO_MASSES + FORCE_TABLE.format(on="b"), 2.0, 0.02, reference=EXACT,
          files={"force.csv": TABLE}),
    Model("lumped-table-ends", TWO_MASSES + FORCE_TABLE.format(on="a"), 2.0, 0.02, reference=EXACT,
          files={"force.csv": "time [s],force [N]\n0.4,2\n1.2,5\n"}),
    Model("lumped-base", TWO_MASSES + "[base_motion]\namplitude = 0.1\nangular_frequency = 3.0\nof = \"displacement\"\n",
          2.0, 0.02, reference=EXACT),
    Model("lumped-static", AT_REST + force("a", "held = 9.0") + force("b", HARMONIC), 2.0, 0.02, static=True,
          reference=EXACT),
    Model("lumped-support", TWO_MASSES.replace('velocity = -0.8\n', '') +
          '[[displacement]]\non = "b"\nexpression = "0.2*sin(3*t)^2"\n', 2.0, 0.02),
    Model("lumped-slider", TWO_MASSES + """[[slider]]
name = "pad"
between = ["a", "b"]
stiffness = 20.0
friction_coefficient = 0.5
normal_load = 3.0
""" + force("a", HARMONIC), 2.0, 0.02, smooth=False, reference=EXACT),
    Model("lumped-stop", TWO_MASSES + """[[stop]]
name = "bumper"
between = ["a", "ground"]
gap = 0.1
stiffness = 200.0
damping = 0.5
""" + force("a", HARMONIC), 2.0, 0.02, smooth=False),
    Model("frame-static", CANTILEVER + '[[displacement]]\non = "tip.y"\nvalue = 0.01\n', 0.16, 2e-5, static=True,
          reference=EXACT),
    Model("frame-loads", CANTILEVER + "[gravity]\nacceleration = [0.0, -9.81]\n"
          '[[distributed_force]]\non = "arm"\ndirection = [0.0, 1.0]\namplitude = 20.0\nangular_frequency = 40.0\n'
          '[base_motion]\namplitude = 1.5\nangular_frequency = 60.0\ndirection = { x = 1.0 }\n', 0.16, 2e-5),
    Model("frame-slider", CANTILEVER + """[[slider]]
name = "pad"
between = ["tip.y", "ground"]
stiffness = 5e3
friction_coefficient = 0.5
normal_load = 20.0
""" + force("tip.y", "amplitude = 30.0\nangular_frequency = 70.0"), 0.16, 2e-5, smooth=False, reference=EXACT),
    Model("frame-stop", CANTILEVER + """[[stop]]
name = "bumper"
between = ["tip.y", "ground"]
gap = 0.002
stiffness = 2e4
damping = 5.0
""" + force("tip.y", "amplitude = 30.0\nangular_frequency = 70.0"), 0.16, 2e-5, smooth=False),
    Model("matrices-table", MATRICES + FORCE_TABLE.format(on="1"), 2.0, 0.02, reference=EXACT,
          files={**MATRIX_FILES, "force.csv": TABLE}),
    Model("matrices-slider", MATRICES + """[[slider]]
name = "pad"
between = ["2", "4"]
stiffness = 15.0
friction_coefficient = 0.4
normal_load = 2.0
""" + force("1", HARMONIC), 2.0, 0.02, smooth=False, reference=EXACT, files=MATRIX_FILES),
    Model("plane-pendulums", pendulums("damping = 0.3"), 1.0, 0.005, mechanism=True, reference=FINE),
    Model("plane-projected", pendulums("damping = 0.3"), 1.0, 0.005, mechanism=True, project=True, reference=FINE),
    Model("plane-static", pendulums("stiffness = 60.0\ndamping = 0.5", "stiffness = 20.0") + force("lower.x", FORMULA),
          3.0, 0.005, mechanism=True, static=True, reference=FINE),
    Model("plane-table", pendulums("damping = 0.3") + FORCE_TABLE.format(on="lower.y"), 1.0, 0.005, mechanism=True,
          reference=FINE, files={"force.csv": TABLE}),
    Model("plane-friction", pendulums("friction = { coefficient = 0.3, preload = 40.0, radius = 0.05 }"), 1.0, 0.005,
          mechanism=True, smooth=False, reference=FINE),
    Model("plane-stop", pendulums('lock = { at = -1.2, kind = "stop", stiffness = 2e3, damping = 3.0 }', "damping = 0.2"),
          1.0, 0.005, mechanism=True, smooth=False, reference=FINE),
    Model("plane-latch", pendulums('damping = 0.2\nlock = { at = -1.0, kind = "latch" }', "damping = 0.2"), 1.0, 0.005,
          mechanism=True, smooth=False, reference=FINE),
    Model("plane-crank", slider_crank('moment = "8*(1 - rate/20)"', "damping = 10.0"), 1.0, 0.005, mechanism=True,
          reference=FINE),
    Model("plane-drive", slider_crank('drive = "2*t^2 + 0.3*sin(6*t)"', "damping = 10.0\nstiffness = 50.0"), 1.0, 0.005,
          mechanism=True, reference=FINE),
    Model("space-top", TOP, 0.4, 0.002, mechanism=True, reference=FINE),
    Model("space-hinge", tilted("damping = 0.4\nstiffness = 5.0"), 0.8, 0.004, mechanism=True, reference=FINE),
    Model("space-friction", tilted("friction = { coefficient = 0.2, preload = 50.0, radius = 0.04 }"), 0.8, 0.004,
          mechanism=True, smooth=False, reference=FINE),
    Model("space-drive", tilted('drive = "0.5*sin(3*t)^2"'), 0.8, 0.004, mechanism=True, reference=FINE),
    Model("space-stop", tilted('damping = 0.2\nlock = { at = 0.9, kind = "stop", stiffness = 1e3, damping = 2.0 }'), 0.8, 0.004,
          mechanism=True, smooth=False, reference=FINE),
]
