"""Bouc-Wen elements and nonlinear springs of mechanisms: on the coordinate of a joint, or between coordinates as springs are.

What an element remembers stands in the state. Held still, and in equilibria, it has the memory of a way from the start that does not
turn back.
"""

import numpy as np

from nonlinear.laws import read_laws
from study import Unreadable as Refused

NEAR = 1e-11      # relative: what counts as on a border


class ReadsLocalLaws:
    """Of the model: `local_laws`."""

    def _read_local_laws(self):
        def place(part):
            if "joint" not in part:
                return [self._coordinate(n) for n in part["between"]], any(str(n).rsplit(".", 1)[-1].startswith("r") for n in part["between"])
            joint = next((j for j in self.joints if j.name == str(part["joint"])), None)
            if joint is None or joint.way is None:
                raise Refused("a law on a joint without a coordinate")
            return joint, self.coordinates[joint.way].turning
        self.local_laws = read_laws(self.source, place)

    def law_motion(self, law, state, kin):
        """u, u' and du/dq [nf]."""
        S, dS, S1, _ = kin
        if not isinstance(law.b, list):
            way = law.b.way
            return self.way_map[way] @ S + self.way_constant[way], self.way_map[way] @ S1, self.way_map[way] @ dS
        u = rate = 0.0
        row = np.zeros(self.nf)
        for (column, where), sign in zip(law.b, (1.0, -1.0)):
            if column is None:
                continue
            p, i = where
            u += sign * (state.r[p, i] - self.start_r[p, i] if i < 3 else state.angle[p] - self.start_angle[p])
            rate += sign * state.u[column]
            row[column] += sign
        return u, rate, row


class MarchesLocalLaws:
    """Of the march: memories, branches and borders of the laws."""

    linearised = None      # of each law (u, f, df/du): its tangent there instead of itself

    def _read_local_memories(self):
        m = self.model
        self.starts = [m.law_motion(law, m.start_state(), m.scalars(m.start_state()))[0] for law in m.local_laws]
        self.branches = [(1.0, 1.0)] * len(m.local_laws)
        self.largest = np.full((len(m.local_laws), 2), 1e-300)      # of u' and of u, so far

    def memories(self, state, kin):
        m = self.model
        if not self.standing:
            return state.memories if state.memories is not None else np.zeros(len(m.local_laws))
        return np.array([law.after(0.0, m.law_motion(law, state, kin)[0] - start)[0] if law.remembers else 0.0
                         for law, start in zip(m.local_laws, self.starts)])

    def has_memories(self, state):
        return any(law.remembers and abs(z) > 1e-9 * min(law.z_max, law.A * (1.0 if law.rotation else self.box))
                   for law, z in zip(self.model.local_laws, self.memories(state, self.model.scalars(state))))

    def local_forces(self, state, t, kin):
        """Generalised forces, and of each law u, u', f, z."""
        m = self.model
        Q, told = np.zeros(m.nf), []
        if not m.local_laws:
            return Q, told
        memories = self.memories(state, kin) if self.linearised is None else [0.0] * len(m.local_laws)
        for k, (law, z) in enumerate(zip(m.local_laws, memories)):
            u, rate, row = m.law_motion(law, state, kin)
            f = law.force(u, rate, t, z)
            if self.linearised is not None:
                u0, f0, slope = self.linearised[k]
                f = f0 + slope * (u - u0) + (0.0 if law.remembers else law.force(u0, rate, t, 0.0) - law.force(u0, 0.0, t, 0.0))
            Q -= f * row
            told.append((u, rate, f, z))
        return Q, told

    def linearise(self, state, t):
        """The tangents at a state; of an element that remembers on the branch that goes on."""
        m = self.model
        kin = m.scalars(state)
        out = []
        for law, start, (u, _, f, z) in zip(m.local_laws, self.starts, self.local_forces(state, t, kin)[1]):
            if law.remembers:
                slope = law.after(0.0, u - start)[1] if self.standing and u != start else law.slope(z, 1.0, 1.0)
                out.append((u, f, law.alpha * law.k + (1 - law.alpha) * law.k * slope))
            else:
                out.append((u, f, law.tangents(u, rate=0.0, t=t)[0]))
        return out

    def local_slopes(self, told):
        """Rates of the memories, and power dissipated."""
        rates, lost = [], []
        for law, branch, (u, rate, f, z) in zip(self.model.local_laws, self.branches, told):
            if law.remembers:
                slope = law.slope(z, *branch)
                rates.append(rate * slope)
                lost.append(law.dissipating_force(u, rate, 0.0, z, slope) * rate)
            else:
                rates.append(0.0)
                lost.append((f - law.elastic_force(u)) * rate if law.used & {"rate", "t"} else 0.0)
        return rates, lost

    def local_guards(self, state, kin):
        """[((what, number), value)] over their sizes; beyond their borders where below -NEAR."""
        out = []
        for k, law in enumerate(self.model.local_laws):
            if not law.remembers:
                continue
            u, rate, _ = self.model.law_motion(law, state, kin)
            self.largest[k] = np.maximum(self.largest[k], [abs(rate), abs(u - self.starts[k])])
            size_z = min(law.z_max, law.A * self.largest[k, 1])
            out.append((("turns", k), self.branches[k][0] * rate / self.largest[k, 0]))
            out.append((("vanishes", k), self.branches[k][1] * state.memories[k] / size_z))
        return out

    def change_local(self, what):
        kind, k = what
        a, b = self.branches[k]
        self.branches[k] = (-a, b) if kind == "turns" else (a, -b)

    def settle_local(self, state, t):
        """Branches by velocities, or by accelerations of what rests."""
        m = self.model
        if not any(law.remembers for law in m.local_laws):
            return
        kin = m.scalars(state)
        a = self.instant(state, t, kin)[0]
        for k, law in enumerate(m.local_laws):
            if not law.remembers:
                continue
            u, rate, row = m.law_motion(law, state, kin)
            self.largest[k] = np.maximum(self.largest[k], [abs(rate), abs(u - self.starts[k])])
            moving = rate if abs(rate) > NEAR * self.largest[k, 0] and abs(rate) > 1e-300 else row @ a
            side = 1.0 if moving >= 0 else -1.0
            z = state.memories[k]
            size_z = min(law.z_max, law.A * self.largest[k, 1])
            self.branches[k] = (side, side if abs(z) <= NEAR * size_z else (1.0 if z > 0 else -1.0))
