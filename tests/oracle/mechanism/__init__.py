"""The mechanisms of a study, read from its pages: parts, joints, forces, and the equations between them.

Everything lives in space; a mechanism of the plane is one whose parts move along x and y and turn about z. Joints are made
of dot products of vectors that bodies carry, whose first and second derivatives are those of a product:

    s = a . b,   s' = a'.b + a.b',   s'' = a''.b + 2 a'.b' + a.b''

A vector is the way between two points, or an axis, of one part or of the world. So the constraints need no formula of their own,
and neither do their derivatives. Generalised velocities are (r', omega) of each part, omega about the part's own axes.
"""

import numpy as np

from mechanism.beams import Beams
from mechanism.joints import GROUND, Joints
from mechanism.kinematics import Kinematics, State, moved
from mechanism.laws import Laws
from mechanism.local_laws import ReadsLocalLaws
from mechanism.mounts import Mounts
from mechanism.parts import Parts
from study import Unreadable as Refused

__all__ = ["GROUND", "Mechanism", "Refused", "State", "moved"]


class Mechanism(Parts, Joints, Mounts, Kinematics, Laws, ReadsLocalLaws, Beams):
    """The mechanism of a `Study`."""

    def __init__(self, source):
        self.source, self.study, self.number = source, source.raw, source.number
        study = self.study
        first = (study.get("node") or study.get("body"))[0]
        self.space = len(first["position"]) == 3
        self.names = ["ground"]
        self.place = [np.zeros(3)]
        self.turn = [np.array([1.0, 0, 0, 0])]
        self.angle = [0.0]
        self.velocity = [np.zeros(6)]
        self.is_body = [False]
        self.M_parts = [np.zeros((6, 6))]
        self.pairs = []                      # beams' mass between two parts
        self.beams = []
        self.given_velocity = [np.zeros(6, bool)]
        self._read_parts()
        self._read_beams()
        self._read_masses()
        self._find_free()
        self.vectors, self.dots, self.atans, self.roots, self.turns = [], [], [], [], []
        self.joints, self.coordinates = [], []
        self._vector_index, self._dot_index = {}, {}
        for table in study.get("joint", []):
            self._read_joint(table)
        self._read_bushings()
        self._freeze()
        self._read_gears()
        self._read_forces()
        self._read_local_laws()
