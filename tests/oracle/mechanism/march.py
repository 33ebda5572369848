"""Transients of mechanisms by brute force: DOP853 from event to event.

Positions and velocities are put back onto the constraints after every step.
"""

import math

import numpy as np
from scipy.integrate import DOP853

from mechanism import Mechanism, Refused, State, moved
from mechanism.events import Events
from mechanism.friction import Lock, ReadsFriction
from mechanism.instant import Instant
from mechanism.local_laws import MarchesLocalLaws
from mechanism.rotations import product
from mechanism.starts import Starts


class March(ReadsFriction, MarchesLocalLaws, Instant, Starts, Events):
    def __init__(self, model: Mechanism, rtol=1e-10):
        self.model, self.rtol = model, rtol
        m = model
        L = np.linalg.cholesky(m.M)
        self.Linv = np.linalg.inv(L)
        self.box = self._size()
        self.dry, self.immobile, self.locks = [], [], []
        self.led = False       # a drive leads a dry joint: what that carries at rest is not determined
        self.events = []
        self.ended_laws = False      # a latch ended a law that stores energy, whose zero is anywhere
        self.lost = 0.0
        self.window = (0.0, math.inf)
        self.drives = [j for j in m.joints if j.drive_formula is not None or j.drive_points is not None]
        self._read_friction()
        self._read_local_memories()
        self.works = 4 + len(model.local_laws)      # of dampers, friction, loads, drives and each law

    def _size(self):
        places = [p for p in self.model.start_r[1:]]
        for j in self.model.joints:
            places += [j.at, j.to]
        places = np.array(places)
        size = np.linalg.norm(places.max(0) - places.min(0))
        return size if size > 0 else 1.0

    # ---- packing ----------------------------------------------------------------------------------------------------
    def pack(self, state, works):
        memories = state.memories if state.memories is not None else np.zeros(len(self.model.local_laws))
        if self.model.space:
            return np.concatenate([state.r.ravel(), state.q.ravel(), state.u, state.turns, memories, works])
        return np.concatenate([state.r[:, :2].ravel(), state.angle, state.u, memories, works])

    def unpack(self, y):
        m, n = self.model, len(self.model.names)
        works, memories = y[len(y) - self.works :], y[len(y) - self.works - len(m.local_laws) : len(y) - self.works]
        if m.space:
            r, q = y[: 3 * n].reshape(n, 3), y[3 * n : 7 * n].reshape(n, 4)
            return State(r, q, y[7 * n : 7 * n + m.nf], m.start_angle, y[7 * n + m.nf : 7 * n + m.nf + len(m.atans)], memories), works
        r = np.zeros((n, 3))
        r[:, :2] = y[: 2 * n].reshape(n, 2)
        angle = y[2 * n : 3 * n]
        q = np.zeros((n, 4))
        q[:, 0], q[:, 3] = np.cos(angle / 2), np.sin(angle / 2)
        return State(r, q, y[3 * n : 3 * n + m.nf], angle, np.zeros(0), memories), works

    def slope(self, t, y):
        m = self.model
        state, _ = self.unpack(y)
        kin = m.scalars(state)
        a, mu, G = self.instant(state, t, kin)
        _, tally = self.applied(state, t, kin, tally=True)
        u = m.all_velocities(state.u)
        friction = 0.0
        for d in self.dry:
            if d.going is not None and not d.resting:
                slip = d.maps @ kin[2]
                friction += d.limit_now * (np.linalg.norm(slip) if len(slip) > 1 else float(d.going @ slip))
        drive = 0.0
        for k, j in enumerate(self.drives):
            drive += mu[len(m.row_map) + k] * m.drive_at(j, self.clamp(t))[1]
        memory_rates, lost = self.local_slopes(self.local_told)
        works = memory_rates + [tally["damper"], friction, tally["load"], drive] + lost
        if m.space:
            q1 = product(state.q, np.concatenate([np.zeros((len(u), 1)), u[:, 3:]], axis=1)) / 2
            atans = kin[2][m.first_atan : m.first_atan + len(m.atans)]
            return np.concatenate([u[:, :3].ravel(), q1.ravel(), a, atans, works])
        return np.concatenate([u[:, :2].ravel(), u[:, 5], a, works])

    # ---- constraints ------------------------------------------------------------------------------------------------
    def project(self, state, t, positions=True, velocities=True, tries=20):
        m = self.model
        if positions:
            for _ in range(tries):
                kin = m.scalars(state)
                G, gap, _, _ = self.rows(state, t, kin)
                if len(G) == 0:
                    break
                solve = self._through(G)
                dq = -(self.Linv.T @ (self.Linv @ (G.T @ solve(gap))))
                u = state.u
                state = moved(m, state, dq)
                state.u = u
                if np.linalg.norm(dq) < 1e-13 * (1 + self.box):
                    break
        if velocities:
            state = self.project_velocities(state, t)
        return state

    def project_velocities(self, state, t):
        return self.impulse(state, t)[0]

    def impulse(self, state, t):
        """The state with velocities that the rows allow, and the work of the drives' impulses: each times the mean of its rate."""
        m = self.model
        kin = m.scalars(state)
        G, _, rate, _ = self.rows(state, t, kin)
        self.impulses = np.zeros(len(G))
        if len(G) == 0:
            return state, 0.0
        impulses = self.impulses = -self._through(G)(rate)
        out = state.copy()
        out.u = state.u + self.Linv.T @ (self.Linv @ (G.T @ impulses))
        work = 0.0
        for k, j in enumerate(self.drives):
            line = G[len(m.row_map) + k]
            work += impulses[len(m.row_map) + k] * (line @ state.u + line @ out.u) / 2
        return out, work

    # ---- the march --------------------------------------------------------------------------------------------------
    def begin(self, state=None):
        """The start: onto the constraints; locks open but for those that the start lies on; velocities, unless drives stand."""
        m = self.model
        self.window = (0.0, math.inf)
        self.from_rest = state is not None
        state = state if state is not None else m.start_state()
        if state.memories is None:
            state.memories = np.zeros(len(m.local_laws))
        ways = m.way_map @ m.scalars(m.start_state())[0] + m.way_constant
        self.rest_default = ways.copy()
        for d in self.dry:
            d.going, d.resting, d.fresh, d.place = np.zeros(len(d.maps)), True, False, np.zeros(len(d.maps))
        if not self.locks:
            self.locks = [Lock(j, lock, ways[j.way]) for j in m.joints for lock in j.locks]
            for l in self.locks:
                l.held = l.met and not self.from_rest
                l.done = l.held and l.kind == "latch"
        state = self.project(state, 0.0, velocities=False)
        self._leave_out_immobile(state)
        self.rest_dry()
        return state if self.standing else self.set_off(state, 0.0)

    def _leave_out_immobile(self, state):
        """A dry joint that the other joints leave no motion rubs nowhere; what it carries is not determined."""
        m = self.model
        kin = m.scalars(state)
        rows = self.rows(state, 0.0, kin)[0]
        for d in list(self.dry):
            seen = self.Linv @ (d.maps @ kin[1]).T
            joints = len(m.row_map)
            held, led = (_spans(self.Linv @ G.T, seen) for G in (rows[:joints], rows[: joints + len(self.drives)]))
            if held.all():
                self.dry.remove(d)
                self.immobile.append(d)
            elif held.any():
                raise Refused("a dry joint that the others leave one of two motions")
            self.led = self.led or (led & ~held).any()
        if self.immobile and any(d.rows for d in self.dry):
            raise Refused("friction of a reaction that is not determined")

    def breaks(self, duration):
        m = self.model
        found = set()
        for *_, law in m.forces:
            found.update(law.switches(0.0, duration))
        for law, u in zip(m.local_laws, self.starts):
            if not law.remembers and "t" in law.used:
                found.update(_switches(lambda t: law.decisions(u, 0.0, t), 0.0, duration))
        for j in m.joints:
            if j.formula is not None and "t" in j.formula.parsed.used:
                ways = {j.formula_way: float(self.rest_default[j.way]), "rate": 0.0}
                found.update(_switches(lambda t: j.formula.decisions(t=t, **ways), 0.0, duration))
            if j.drive_formula is not None:
                found.update(_switches(lambda t: j.drive_formula.decisions(t=t), 0.0, duration))
            if j.drive_points is not None:
                found.update(t for t in j.drive_points[:, 0] if 0 < t < duration)
        merged = []
        for t in sorted(found):
            if not merged or t - merged[-1] > 1e-12 * duration:
                merged.append(t)
        return merged

    def run(self, duration, times, start=None, columns=None):
        """Marches and returns what `columns(march, state, t, works)` gives at each of the times."""
        state = self.begin(start)
        if self.led:
            raise Refused("a dry joint that a drive leads")
        works = np.zeros(self.works)
        self.duration = duration
        marks = self.breaks(duration) + [duration]
        t = 0.0
        self.window = (0.0, marks[0])
        self.rates_scale = self._rate_scale(state, duration)
        self.settle_by_rates(state)
        state = self.settle(state, t)
        self.settle_soft(state, t)
        self.settle_local(state, t)
        out, next_time = [], 0
        times = list(times)

        def write(state, t, works):
            out.append(columns(self, state, t, works) if columns else (t, state.copy()))

        for mark in marks:
            self.window = (t, mark)
            if t > 0:
                u0 = state.u
                state, work = self.impulse(state, t)
                if np.linalg.norm(state.u - u0) > 1e-12 * self.rates_scale:
                    works = works.copy()
                    works[3] += work
                    self.settle_by_rates(state)
                state = self.settle(state, t)
                self.settle_local(state, t)
            while t < mark:
                # what begins to slip in two directions keeps its own for the first step only
                pair = any(d.fresh and d.going is not None and len(d.maps) == 2 for d in self.dry)
                solver = DOP853(self.slope, t, self.pack(state, works), mark, rtol=self.rtol, atol=self._atol(state),
                                first_step=min(1e-5 * duration, mark - t) if pair else None)
                found = None
                while solver.status == "running":
                    t0 = solver.t
                    message = solver.step()
                    if solver.status == "failed":
                        raise Refused(f"DOP853 at {t0}: {message}")
                    dense = solver.dense_output()
                    found = self.first_event(dense, t0, solver.t)
                    end = found[0] if found else solver.t
                    while next_time < len(times) and times[next_time] <= end and (times[next_time] < end or (not found and end == mark)
                                                                                   or not found):
                        s, w = self.unpack(dense(times[next_time]))
                        s = self.project(s.copy(), times[next_time], tries=3)
                        write(s, times[next_time], w)
                        next_time += 1
                    for d in self.dry:
                        d.fresh = False
                    if found:
                        break
                    s, w = self.unpack(solver.y)
                    s = self.project(s.copy(), solver.t, tries=2)
                    solver.y = self.pack(s, w)
                    solver.f = solver.fun(solver.t, solver.y)
                    self.steps = getattr(self, "steps", 0) + 1
                    if self.steps > 20000:
                        raise Refused("too many steps")
                if found:
                    t = found[0]
                    s, works = self.unpack(dense(t))
                    state = self.project(s.copy(), t, tries=3)
                    works = works.copy()
                    self.driven = 0.0
                    if found[1][0] in ("turns", "vanishes"):
                        self.change_local(found[1])
                        self.turned = getattr(self, "turned", 0) + 1
                        if self.turned > 5000:
                            raise Refused("too many turns of laws")
                        continue
                    state = self.change(state, t, found[1])
                    self.settle_local(state, t)
                    works[3] += self.driven
                    if len(self.events) > 400:
                        raise Refused("too many events")
                else:
                    t = solver.t
                    state, works = self.unpack(solver.y)
                    state, works = state.copy(), works.copy()
        while next_time < len(times):
            write(state, times[next_time], works)
            next_time += 1
        return out

    def _rate_scale(self, state, duration):
        return max(np.linalg.norm(state.u), 1e-3 * self.box / duration)

    def _atol(self, state):
        y = self.pack(state, np.zeros(self.works))
        n, nf = len(self.model.names), self.model.nf
        places = 3 * n if self.model.space else 2 * n
        turns = 4 * n if self.model.space else n
        atol = np.empty(len(y))
        atol[:places] = self.rtol * self.box
        atol[places : places + turns] = self.rtol
        w = self.model.free % 6
        speed = max(np.linalg.norm(state.u[w < 3]) if np.any(w < 3) else 0, self.box / self.duration)
        spin = max(np.linalg.norm(state.u[w >= 3]) if np.any(w >= 3) else 0, 1 / self.duration)
        atol[places + turns : places + turns + nf] = self.rtol * np.where(w < 3, speed, spin)
        atol[places + turns + nf :] = self.rtol
        # works are integrals that nothing else watches: laws may have kinks where the motion has none
        mass = np.max(np.diag(self.model.M)[w < 3], initial=np.max(np.diag(self.model.M)) / self.box**2)
        sizes = [min(law.z_max, law.A * (1.0 if law.rotation else self.box)) if law.remembers else 1.0 for law in self.model.local_laws]
        atol[len(y) - self.works - len(sizes) : len(y) - self.works] = self.rtol * np.array(sizes)
        atol[len(y) - self.works :] = 1e-7 * max(self.kinetic(state), mass * (self.box / self.duration) ** 2)
        return atol

    def kinetic(self, state):
        return float(state.u @ self.model.M @ state.u) / 2


def _spans(columns, seen):
    """Which of `seen` are combinations of the columns."""
    if columns.shape[1] == 0:
        return np.zeros(seen.shape[1], bool)
    u, s, _ = np.linalg.svd(columns / np.maximum(np.linalg.norm(columns, axis=0), 1e-300), full_matrices=False)
    span = u[:, s > 1e-9 * s[0]]
    return np.linalg.norm(seen - span @ (span.T @ seen), axis=0) < 1e-6 * np.linalg.norm(seen, axis=0)


def _switches(decisions, begin, end, samples=4001):
    times = np.linspace(begin, end, samples)
    found = []

    def search(a, at_a, b, at_b):
        if at_a == at_b:
            return
        middle = 0.5 * (a + b)
        if middle <= a or middle >= b:
            found.append(b)
            return
        at_middle = decisions(middle)
        search(a, at_a, middle, at_middle)
        search(middle, at_middle, b, at_b)

    before = decisions(times[0])
    if not before and not decisions(times[-1]):
        return []
    for a, b in zip(times[:-1], times[1:]):
        after = decisions(b)
        search(a, before, b, after)
        before = after
    return [t for t in found if begin < t < end]
