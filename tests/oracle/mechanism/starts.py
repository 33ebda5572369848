"""Velocities with which a march begins: rates of joints, and stops on which it begins; impacts on stops.

Rates of joints are rows beside those of the constraints. First the velocities that are not given take them, then all. Stops only press, in
an impact too: their impulses and the rates after it are complementary (Moreau 1988), each stop either pressing or let go.
"""

import itertools

import numpy as np

from study import Unreadable as Refused

NOTHING = 1e-9      # relative: what is no rate, and no impulse


class Starts:
    def take_rates(self, state, t):
        """The velocities given, changed by as little kinetic energy as the rates of joints and the constraints need."""
        m = self.model
        joints = [j for j in m.joints if j.rate is not None]
        if not joints:
            return state
        kin = m.scalars(state)
        G, _, missing, _ = self.rows(state, t, kin)
        ways = np.array([m.way_map[j.way] for j in joints])
        A = np.concatenate([G, ways @ kin[1]])
        gap = -np.concatenate([missing, ways @ kin[2] - [j.rate for j in joints]])
        for movable in (np.flatnonzero(~m.has_velocity), np.arange(m.nf)):
            weigh = np.linalg.inv(np.linalg.cholesky(m.M[np.ix_(movable, movable)])) if len(movable) else np.zeros((0, 0))
            B = weigh @ A[:, movable].T                   # of the rows, seen through the mass
            size = np.linalg.norm(B, axis=0)
            size[size == 0] = 1.0
            change = np.zeros(m.nf)
            change[movable] = weigh.T @ np.linalg.lstsq((B / size).T, gap / size, rcond=1e-9)[0]
            left = np.abs(gap - A @ change) / np.linalg.norm(self.Linv @ A.T, axis=0)
            if np.all(left <= 1e-8 * np.sqrt(2 * self.kinetic(state) + change @ m.M @ change)):
                out = state.copy()
                out.u = state.u + change
                return out
        raise Refused("rates of joints that contradict each other")

    def set_off(self, state, t):
        """Velocities at the start. Stops that a march begins on hold where they are met; what stands on them is left to `settle`."""
        on = [l for l in self.locks if l.held and l.kind == "stop" and (l.rigid or l.met and not self.from_rest)]
        for l in on:
            l.held = False
        state = self.impulse(self.take_rates(state, t), t)[0]
        for _ in range(len(on) + 1):
            met = [l for l in on if not l.held and self._approach(l, state) > 0]
            if not met:
                break
            for l in met:
                l.held = True
            state = self.impact(state, t)[0]
        for l in on:
            l.held = l.held or self._approach(l, state) == 0
        self.rest_dry()
        return state

    def _approach(self, lock, state):
        """The rate towards a lock; 0 where it is but round-off."""
        m = self.model
        _, dS, S1, _ = m.scalars(state)
        way = m.way_map[lock.joint.way]
        rate = lock.side * float(way @ S1)
        return rate if abs(rate) > NOTHING * float(np.abs(way @ dS) @ np.abs(state.u)) else 0.0

    def impact(self, state, t):
        """The state after the impulses of what holds, and the work of the drives; stops whose impulse would pull let go."""
        stops = [l for l in self.locks if l.held and l.rigid and l.kind == "stop"]
        for released in itertools.chain.from_iterable(itertools.combinations(stops, n) for n in range(len(stops) + 1)):
            for l in stops:
                l.held = l not in released
            out, work = self.impulse(state, t)
            impulses = self.lock_parts(self.impulses)
            nothing = NOTHING * np.max(np.abs(self.impulses), initial=0.0)
            if all(l.side * impulses[l] <= nothing for l in stops if l.held) and all(self._approach(l, out) <= 0 for l in released):
                self.pulled = getattr(self, "pulled", 0) + len(released)
                return out, work
        raise Refused("no impulses that all press")

    def lock_parts(self, multipliers):
        """Of each rigid lock that holds its multiplier, or impulse."""
        at = len(self.model.row_map) + len(self.drives)
        held = [l for l in self.locks if l.held and l.rigid]
        return {l: multipliers[at + k] for k, l in enumerate(held)}

    def rest_dry(self):
        """Friction of joints that a rigid lock holds is left out."""
        holding = {id(l.joint) for l in self.locks if l.held and l.rigid}
        for d in self.dry:
            d.resting = id(d.joint) in holding

    def settle_soft(self, state, t):
        """Elastic stops at their place and at rest hold where the parts press on them."""
        m = self.model
        soft = [l for l in self.locks if l.held and l.met and not l.rigid and l.kind == "stop" and self._approach(l, state) == 0
                and abs(self._gap(l, state)) <= 1e-9 * (1 + abs(l.at))]
        if soft:
            kin = m.scalars(state)
            a = self.instant(state, t, kin)[0]
            for l in soft:
                way = m.way_map[l.joint.way]
                l.held = l.side * float(way @ (kin[1] @ a + kin[3])) >= -NOTHING * float(np.abs(way @ kin[1]) @ np.abs(a))

    def _gap(self, lock, state):
        """How far the coordinate is beyond its lock."""
        m = self.model
        way = lock.joint.way
        return lock.side * (float(m.way_map[way] @ m.scalars(state)[0]) + m.way_constant[way] - lock.at)
