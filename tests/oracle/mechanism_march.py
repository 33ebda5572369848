"""Transients of mechanisms by brute force: the equations with multipliers, by DOP853 from event to event.

At every instant the accelerations and multipliers are those of

    M a = Q + G^T multiplier,   G a = w

whose rows are those of the joints, of drives, of rigid locks that hold and of dry joints that stick. Positions and velocities are
put back onto the constraints after every step.
"""

import itertools
import math

import numpy as np
from scipy.integrate import DOP853
from scipy.optimize import brentq

from mechanism import GROUND, Mechanism, Refused, State, cross, moved, product, quaternion_of, vector_of
from study import beside

SEPARATE = 1e-9   # relative: what counts as rest


class Dry:
    """One friction: its joint, the maps of its slip (one or two linear forms of scalars), and how it goes."""

    def __init__(self, joint, maps, names, mu, preload, rows, scale):
        self.joint, self.maps, self.names, self.mu, self.preload, self.rows = joint, np.array(maps), names, mu, preload, rows
        self.scale = scale            # of the reported force, for a unit of mu N
        self.going = None             # None: sticks; else the direction in which it slides
        self.resting = False          # a rigid lock holds its joint

    def limit(self, mu):
        """mu (preload + N) with the multipliers of this instant."""
        return self.mu * (self.preload + (np.linalg.norm(mu[self.rows]) if self.rows else 0.0))


class Lock:
    def __init__(self, joint, side):
        t = joint.lock
        self.joint, self.side = joint, side
        self.at, self.kind, self.k, self.c = t["at"], t["kind"], t["stiffness"], t["damping"]
        self.held = False
        self.done = False             # a latch that holds: the law of the joint has ended

    @property
    def rigid(self):
        return self.k == 0.0


class March:
    def __init__(self, model: Mechanism, rtol=1e-10):
        self.model, self.rtol = model, rtol
        m = model
        L = np.linalg.cholesky(m.M)
        self.Linv = np.linalg.inv(L)
        self.box = self._size()
        self.dry, self.locks = [], []
        self.events = []
        self.lost = 0.0
        self.window = (0.0, math.inf)
        self.drives = [j for j in m.joints if j.drive_formula is not None or j.drive_points is not None]
        self._read_friction()

    def _size(self):
        places = [p for p in self.model.start_r[1:]]
        for j in self.model.joints:
            places += [j.at, j.to]
        places = np.array(places)
        size = np.linalg.norm(places.max(0) - places.min(0))
        return size if size > 0 else 1.0

    def _read_friction(self):
        m = self.model
        for j in m.joints:
            f = j.friction
            if f is None:
                continue
            mu, preload, radius = f["mu"], f["preload"], f["radius"]
            rows = j.row_numbers if f["reaction"] else []
            way = lambda k: m.way_map[k]
            if j.type == "revolute":
                self.dry.append(Dry(j, [radius * way(j.way)], [j.name], mu, preload, rows[: 3 if m.space else 2], [radius]))
            elif j.type == "prismatic":
                self.dry.append(Dry(j, [way(j.way)], [j.name], mu, preload, rows[: 2 if m.space else 1], [1.0]))
            elif j.type == "strut":
                self.dry.append(Dry(j, [way(j.way)], [j.name], mu, preload, [], [1.0]))
            elif j.type == "screw":
                a = math.atan2(j.lead / (2 * math.pi), radius)
                turn, slide = m.thread_map[j.name]
                s = math.cos(a) ** 2 * turn + math.sin(a) * math.cos(a) / radius * slide
                worth = radius / math.cos(a) ** 2
                self.dry.append(Dry(j, [worth * s], [j.name], mu, preload, rows[2:3], [worth]))
            elif j.type == "cylindrical":
                self.dry.append(Dry(j, [way(j.ways[0]), radius * way(j.ways[1])], [j.name], mu, preload, rows[:2], [1.0, radius]))
            elif j.type == "planar":
                self.dry.append(Dry(j, [way(j.ways[0]), way(j.ways[1])], [j.name], mu, preload, rows[:1], [1.0, 1.0]))
            elif j.type == "universal":
                for k, which in enumerate(("first", "second")):
                    self.dry.append(Dry(j, [radius * way(j.ways[k])], [f"{j.name}.{which}"], mu, preload, rows[:3], [radius]))
            else:
                raise Refused(f"friction in {j.type}")

    # ---- the equations at an instant --------------------------------------------------------------------------------
    def clamp(self, t):
        begin, end = self.window
        if t <= begin:
            return beside(begin, 1)
        if t >= end:
            return beside(end, -1)
        return t

    def applied(self, state, t, kin=None, tally=False):
        """Generalised forces [nf] without constraints and friction; with `tally` also the powers and the energy stored."""
        m = self.model
        S, dS, S1, S2 = kin if kin is not None else m.scalars(state)
        t = self.clamp(t)
        Q = m.weight.copy()
        u = m.all_velocities(state.u)
        load_power = float(m.weight @ state.u)
        damper_power = stored = 0.0
        full = np.zeros((len(m.names), 6))
        Jw = np.einsum("pij,pj->pi", m.J_parts, u[:, 3:])
        full[:, 3:] -= cross(u[:, 3:], Jw)
        extra = np.zeros_like(full)
        for p, k, following, arm, law in m.forces:
            f = law.value(t)
            e = np.zeros(3)
            e[k % 3] = f
            R = state.R[p]
            if k < 3:
                world = R @ e if following else e
                extra[p, :3] += world
                if arm is not None:
                    extra[p, 3:] += np.cross(arm, R.T @ world)
            elif following or not m.space:
                extra[p, 3:] += e
            else:
                extra[p, 3:] += R.T @ e
        load_power += float(np.sum(extra * u))
        full += extra
        if m.beams:
            strain, B, rates = m.beam_state(state, u)
            stress = m.bC * strain
            viscous = m.btau[:, None] * m.bC * rates
            force = np.einsum("bij,bi->bj", B, stress + viscous) * m.bL[:, None]
            np.add.at(full, m.bp[:, 0], -force[:, :6])
            np.add.at(full, m.bp[:, 1], -force[:, 6:])
            if tally:
                stored += float(np.sum(m.bL[:, None] * stress * strain)) / 2
                damper_power += float(np.sum(m.bL[:, None] * viscous * rates))
        Q += full.reshape(-1)[m.free]
        for ends, k, c in m.links:
            x = v = 0.0
            for (column, where), sign in zip(ends, (1.0, -1.0)):
                if column is None:
                    continue
                p, i = where
                here = state.r[p, i] - m.start_r[p, i] if i < 3 else state.angle[p] - m.start_angle[p]
                x, v = x + sign * here, v + sign * state.u[column]
            force = k * x + c * v
            for (column, _), sign in zip(ends, (1.0, -1.0)):
                if column is not None:
                    Q[column] -= sign * force
            stored += k * x * x / 2
            damper_power += c * v * v
        ways = m.way_map @ S + m.way_constant
        rates = m.way_map @ S1
        self.law_force = {}
        for j in m.joints:
            if j.way is None:
                continue
            s, rate = ways[j.way], rates[j.way]
            latched = any(l.joint is j and l.done for l in self.locks)
            force = 0.0
            spring = j.stiffness * (s - (j.rest if j.rest is not None else self.rest_default[j.way])) if j.stiffness else 0.0
            if j.stiffness:
                stored += spring * spring / (2 * j.stiffness)
            force += -spring - j.damping * rate
            damper_power += j.damping * rate * rate
            if j.formula is not None and not latched:
                value = float(j.formula(**{j.formula_way: s, "rate": rate, "t": t}))
                force += value
                load_power += value * rate
            if j.points is not None and not latched:
                value, potential = self._table(j, s)
                force += value
                stored += potential
            for l in self.locks:
                if l.joint is j and l.held and not l.rigid:
                    force += -l.k * (s - l.at) - l.c * rate
                    stored += l.k * (s - l.at) ** 2 / 2
                    damper_power += l.c * rate * rate
            self.law_force[j.name] = force
            if force:
                Q += force * (m.way_map[j.way] @ dS)
        if tally:
            return Q, dict(load=load_power, damper=damper_power, stored=stored)
        return Q

    @staticmethod
    def _table(j, s):
        x, y = j.points[:, 0], j.points[:, 1]
        if (s < x[0] or s > x[-1]) and j.beyond == "zero":
            value = 0.0
        elif (s < x[0] or s > x[-1]) and j.beyond == "error":
            # a trial of the integrator may reach a little beyond
            k = 0 if s < x[0] else len(x) - 2
            value = y[k] + (y[k + 1] - y[k]) / (x[k + 1] - x[k]) * (s - x[k])
        else:
            value = float(np.interp(s, x, y))
        knots = np.concatenate([[x[0]], x[(x > min(x[0], s)) & (x < s)], [min(s, x[-1])] if s > x[0] else []])
        if s <= x[0]:
            outside = (s - x[0]) * (y[0] if j.beyond == "hold" else 0.0)
            return value, -outside
        work = float(np.trapz(np.interp(knots, x, y), knots))
        if s > x[-1] and j.beyond == "hold":
            work += y[-1] * (s - x[-1])
        return value, -work

    def rows(self, state, t, kin):
        """Rows [m x nf], their positions, rates, and second derivatives that have to vanish; and how many are of joints."""
        m = self.model
        S, dS, S1, S2 = kin
        maps = [m.row_map]
        offset = [m.row_constant]
        target1, target2 = [np.zeros(len(m.row_map))], [np.zeros(len(m.row_map))]
        tc = self.clamp(t)
        for j in self.drives:
            s, s1, s2 = m.drive_at(j, tc)
            if self.standing:
                s1 = s2 = 0.0
            maps.append(m.way_map[j.way][None])
            offset.append([m.way_constant[j.way] - s])
            target1.append([s1])
            target2.append([s2])
        for l in self.locks:
            if l.held and l.rigid:
                maps.append(m.way_map[l.joint.way][None])
                offset.append([m.way_constant[l.joint.way] - l.at])
                target1.append([0.0])
                target2.append([0.0])
        for d in self.dry:
            if d.going is None and not d.resting:
                maps.append(d.maps)
                offset.append(-d.place)
                target1.append(np.zeros(len(d.maps)))
                target2.append(np.zeros(len(d.maps)))
        maps = np.concatenate(maps)
        return (maps @ dS, maps @ S + np.concatenate(offset), maps @ S1 - np.concatenate(target1),
                maps @ S2 - np.concatenate(target2))

    def _through(self, G):
        """The columns of the rows seen through the mass, and the solver of their products."""
        B = self.Linv @ G.T
        scale = np.linalg.norm(B, axis=0)
        scale[scale == 0] = 1.0
        B = B / scale
        q, r = np.linalg.qr(B)
        pivots = np.abs(np.diag(r))
        self.undetermined = len(G) > self.model.nf or pivots.min() < 1e-7 * pivots.max()
        if self.undetermined:
            pseudo = np.linalg.pinv(B, rcond=1e-6)

            def solve(rhs):
                return (pseudo @ (pseudo.T @ (rhs / scale))) / scale
        else:
            def solve(rhs):
                return np.linalg.solve(r, np.linalg.solve(r.T, rhs / scale)) / scale
        return solve

    undetermined = False
    standing = False      # drives are held where they are

    def instant(self, state, t, kin=None):
        """Accelerations [nf] and multipliers (force along each row), with the friction of this instant."""
        m = self.model
        kin = kin if kin is not None else m.scalars(state)
        Q = self.applied(state, t, kin)
        G, _, _, second = self.rows(state, t, kin)
        solve = self._through(G) if len(G) else None
        weigh = lambda f: self.Linv.T @ (self.Linv @ f)
        sliding = [d for d in self.dry if d.going is not None and not d.resting]
        directions = []
        for d in sliding:
            g = d.maps @ kin[1]
            slip = d.maps @ kin[2]
            size = np.linalg.norm(slip)
            if len(d.maps) == 1 or d.fresh or size == 0:
                way = d.going
            else:
                way = slip / size
            directions.append(-(way @ g))
        forces = [Q] + directions
        free = [weigh(f) for f in forces]
        if len(G):
            mult = [solve(-(G @ free[0]) - second)] + [solve(-(G @ x)) for x in free[1:]]
            free = [x + weigh(G.T @ y) for x, y in zip(free, mult)]
        else:
            mult = [np.zeros(0)] * len(free)
        limit = np.array([d.mu * d.preload for d in sliding])
        if any(d.rows for d in sliding):
            A = np.array(mult)
            for _ in range(100):
                now = A[0] + (limit @ A[1:] if len(sliding) else 0)
                F, D = limit.copy(), np.eye(len(sliding))
                for k, d in enumerate(sliding):
                    part = now[d.rows]
                    N = np.linalg.norm(part)
                    F[k] -= d.mu * (d.preload + N)
                    if N > 0:
                        D[k] -= d.mu * (A[1:][:, d.rows] @ part) / N
                step = np.linalg.solve(D, -F)
                limit = limit + step
                if np.max(np.abs(step)) <= 1e-14 * max(np.max(np.abs(limit)), 1e-300):
                    break
            else:
                raise Refused("friction of reactions found no limit")
        for d, L, way in zip(sliding, limit, directions):
            d.limit_now = L
        a = free[0] + sum(L * x for L, x in zip(limit, free[1:]))
        mu = mult[0] + sum(L * x for L, x in zip(limit, mult[1:]))
        return a, mu, G

    # ---- packing ----------------------------------------------------------------------------------------------------
    def pack(self, state, works):
        if self.model.space:
            return np.concatenate([state.r.ravel(), state.q.ravel(), state.u, state.turns, works])
        return np.concatenate([state.r[:, :2].ravel(), state.angle, state.u, works])

    def unpack(self, y):
        m, n = self.model, len(self.model.names)
        if m.space:
            r, q = y[: 3 * n].reshape(n, 3), y[3 * n : 7 * n].reshape(n, 4)
            return State(r, q, y[7 * n : 7 * n + m.nf], m.start_angle, y[7 * n + m.nf : 7 * n + m.nf + len(m.atans)]), y[-4:]
        r = np.zeros((n, 3))
        r[:, :2] = y[: 2 * n].reshape(n, 2)
        angle = y[2 * n : 3 * n]
        q = np.zeros((n, 4))
        q[:, 0], q[:, 3] = np.cos(angle / 2), np.sin(angle / 2)
        return State(r, q, y[3 * n : 3 * n + m.nf], angle, np.zeros(0)), y[-4:]

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
        works = [tally["damper"], friction, tally["load"], drive]
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
        if len(G) == 0:
            return state, 0.0
        impulses = -self._through(G)(rate)
        out = state.copy()
        out.u = state.u + self.Linv.T @ (self.Linv @ (G.T @ impulses))
        work = 0.0
        for k, j in enumerate(self.drives):
            line = G[len(m.row_map) + k]
            work += impulses[len(m.row_map) + k] * (line @ state.u + line @ out.u) / 2
        return out, work

    # ---- the march --------------------------------------------------------------------------------------------------
    def begin(self, state=None):
        """The start: onto the constraints, locks open on the side of the start, velocities projected."""
        m = self.model
        self.window = (0.0, math.inf)
        state = state if state is not None else m.start_state()
        ways = m.way_map @ m.scalars(m.start_state())[0] + m.way_constant
        self.rest_default = ways.copy()
        for d in self.dry:
            d.going, d.resting, d.fresh, d.place = np.zeros(len(d.maps)), True, False, np.zeros(len(d.maps))
        state = self.project(state, 0.0)
        here = m.way_map @ m.scalars(state)[0] + m.way_constant
        if not self.locks:
            self.locks = [Lock(j, math.copysign(1.0, j.lock["at"] - here[j.way])) for j in m.joints if j.lock is not None]
        self._refuse_immobile(state)
        for d in self.dry:
            d.resting = False
        return state

    def _refuse_immobile(self, state):
        """What a dry joint carries that the other joints leave no motion is not determined."""
        kin = self.model.scalars(state)
        G = self.rows(state, 0.0, kin)[0]
        if not self.dry or len(G) == 0:
            return
        basis = np.linalg.svd(self.Linv @ G.T, full_matrices=False)
        span = basis[0][:, basis[1] > 1e-9 * basis[1][0]]
        for d in self.dry:
            for line in d.maps @ kin[1]:
                seen = self.Linv @ line
                if np.linalg.norm(seen - span @ (span.T @ seen)) < 1e-6 * np.linalg.norm(seen):
                    raise Refused("a dry joint that the others leave no motion")

    def breaks(self, duration):
        m = self.model
        found = set()
        for *_, law in m.forces:
            found.update(law.switches(0.0, duration))
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
        m = self.model
        state = self.begin(start)
        works = np.zeros(4)
        self.duration = duration
        marks = self.breaks(duration) + [duration]
        t = 0.0
        self.window = (0.0, marks[0])
        self.rates_scale = self._rate_scale(state, duration)
        self.settle_by_rates(state)
        state = self.settle(state, t)
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
                    works = works + np.array([0.0, 0.0, 0.0, work])
                    self.settle_by_rates(state)
                state = self.settle(state, t)
            while t < mark:
                solver = DOP853(self.slope, t, self.pack(state, works), mark, rtol=self.rtol, atol=self._atol(state))
                found = None
                while solver.status == "running":
                    t0 = solver.t
                    y0 = solver.y
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
                    state = self.change(state, t, found[1])
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
        y = self.pack(state, np.zeros(4))
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
        atol[-4:] = 1e300
        return atol

    def kinetic(self, state):
        return float(state.u @ self.model.M @ state.u) / 2

    # ---- events -----------------------------------------------------------------------------------------------------
    def guards(self, state, t):
        """[(what, value)]: a guard is positive, and its event is where it turns negative."""
        m = self.model
        kin = m.scalars(state)
        ways = m.way_map @ kin[0] + m.way_constant
        rates = m.way_map @ kin[2]
        out = []
        a = mu = None
        needs = any(l.held and l.rigid and l.kind == "stop" for l in self.locks) or any(
            d.going is None and not d.resting for d in self.dry)
        if needs:
            a, mu, G = self.instant(state, t, kin)
        at = len(m.row_map) + len(self.drives)
        for l in self.locks:
            s, rate = ways[l.joint.way], rates[l.joint.way]
            if not l.held:
                out.append((("meets", l), l.side * (l.at - s)))
            elif l.rigid:
                if l.kind == "stop":
                    out.append((("leaves", l), -l.side * mu[at]))
                at += 1
            elif l.kind == "stop":
                out.append((("leaves", l), l.side * (l.k * (s - l.at) + l.c * rate)))
        for d in self.dry:
            if d.resting:
                continue
            if d.going is None:
                hold = mu[at : at + len(d.maps)]
                at += len(d.maps)
                out.append((("slips", d), d.limit(mu) - np.linalg.norm(hold)))
            else:
                slip = d.maps @ kin[2]
                out.append((("stops", d), float(d.going @ slip)))
        return out

    def first_event(self, dense, t0, t1):
        if not self.locks and not self.dry:
            return None
        for d in self.dry:
            if d.going is not None and len(d.maps) == 2 and not d.fresh:
                s, _ = self.unpack(dense(t0))
                slip = d.maps @ self.model.scalars(s)[2]
                if np.linalg.norm(slip) > 0:
                    d.going = slip / np.linalg.norm(slip)
        grid = t0 + (t1 - t0) * np.linspace(0, 1, 9)
        before = None
        for a, b in zip(grid[:-1], grid[1:]):
            if before is None:
                before = self.guards(self.unpack(dense(a))[0], a)
            after = self.guards(self.unpack(dense(b))[0], b)
            hits = []
            for k, ((what, x), (_, y)) in enumerate(zip(before, after)):
                if x > 0 >= y or (x == 0 > y and what[0] != "meets"):
                    f = lambda t: self.guards(self.unpack(dense(t))[0], t)[k][1]
                    hits.append((brentq(f, a, b, xtol=1e-15 * max(abs(b), 1e-300), rtol=1e-14) if x > 0 else a, what))
                elif what[0] in ("stops",) and x <= 0 and y < 0 and a == t0:
                    hits.append((a + 1e-3 * (b - a), what))
            if hits:
                return min(hits, key=lambda h: h[0])
            before = after
        return None

    def change(self, state, t, what):
        kind, item = what
        self.events.append((t, kind, item.joint.name))
        if kind == "meets":
            item.held = True
            if item.kind == "latch":
                item.done = True
            if item.rigid:
                for d in self.dry:
                    if d.joint is item.joint:
                        d.resting = True
                kept = [(d, d.going) for d in self.dry]
                for d in self.dry:     # impulses are taken without friction
                    if d.going is None:
                        d.going = np.zeros(len(d.maps))
                before = self.kinetic(state)
                state, work = self.impulse(self.project(state, t, velocities=False), t)
                self.lost += before - self.kinetic(state) + work
                self.driven += work
                for d, going in kept:
                    d.going = going
                self.settle_by_rates(state)
            return self.settle(state, t)
        if kind == "leaves":
            if not item.rigid:
                ways = self.model.way_map @ self.model.scalars(state)[0] + self.model.way_constant
                self.lost += item.k * (ways[item.joint.way] - item.at) ** 2 / 2
            item.held = False
            for d in self.dry:
                if d.joint is item.joint and d.resting:
                    d.resting = False
                    d.going = None
                    d.place = d.maps @ self.model.scalars(state)[0]
            return self.settle(state, t)
        if kind == "slips":
            a, mu, G = self.instant(state, t)
            at = len(self.model.row_map) + len(self.drives) + sum(l.held and l.rigid for l in self.locks)
            for d in self.dry:
                if d.going is None and not d.resting:
                    if d is item:
                        break
                    at += len(d.maps)
            hold = mu[at : at + len(item.maps)]
            item.going = -hold / np.linalg.norm(hold)
            item.fresh = True
            return self.settle(state, t, leave={id(item)})
        if kind == "stops":
            slip = item.maps @ self.model.scalars(state)[2]
            if len(item.maps) == 2 and np.linalg.norm(slip) > 1e-6 * self.rates_scale:
                item.going = slip / np.linalg.norm(slip)
                return state
            item.going = None
            item.place = item.maps @ self.model.scalars(state)[0]
            return self.settle(state, t)
        raise AssertionError(kind)

    def settle_by_rates(self, state):
        """What moves slides the way it moves; the rest is at rest and left to `settle`."""
        kin = self.model.scalars(state)
        for d in self.dry:
            slip = d.maps @ kin[2]
            d.fresh = False
            if np.linalg.norm(slip) > SEPARATE * self.rates_scale * (1 if d.scale[0] == 1.0 else d.scale[0]):
                d.going = slip / np.linalg.norm(slip)
            else:
                d.going = None
                d.place = d.maps @ kin[0]

    def settle(self, state, t, leave=()):
        """Of what is at rest, which sticks and which slides: the one consistent choice, found by trying all."""
        m = self.model
        kin = m.scalars(state)
        rest = [d for d in self.dry if not d.resting and id(d) not in leave and d.going is None]
        pressing = [l for l in self.locks if l.held and l.rigid and l.kind == "stop"]
        best = None
        choices = [[None] + ([np.array([1.0]), np.array([-1.0])] if len(d.maps) == 1 else ["away"]) for d in rest]
        for opened in itertools.product([False, True], repeat=len(pressing)):
            for l, o in zip(pressing, opened):
                l.held = not o
                for d in self.dry:
                    if d.joint is l.joint:
                        d.resting = not o
            for choice in sorted(itertools.product(*choices), key=lambda c: sum(x is not None for x in c)):
                for d, c in zip(rest, choice):
                    d.going, d.fresh = c, c is not None
                    d.place = d.maps @ kin[0]
                if self._consistent(state, t, rest, pressing, kin):
                    best = True
                    break
            if best:
                break
        if not best:
            raise Refused(f"no consistent choice of what sticks at {t}")
        if rest or leave or pressing:
            self._give_places(kin)
            state = self.project(state, t, tries=3)
        return state

    def _give_places(self, kin):
        for d in self.dry:
            if d.going is None:
                d.place = d.maps @ kin[0]

    def _consistent(self, state, t, rest, pressing, kin):
        m = self.model
        for d in rest:
            if isinstance(d.going, str) and not self._direction(d, state, t, kin):
                return False
        try:
            a, mu, G = self.instant(state, t, kin)
        except np.linalg.LinAlgError:
            return False
        at = len(m.row_map) + len(self.drives)
        for l in self.locks:
            if l.held and l.rigid:
                if l.kind == "stop" and l.side * mu[at] > 1e-12 * np.max(np.abs(mu)):
                    return False
                at += 1
        for l in pressing:
            if not l.held and l.side * (m.way_map[l.joint.way] @ (kin[1] @ a + kin[3])) > 0:
                return False
        for d in self.dry:
            if d.resting:
                continue
            if d.going is None:
                hold = mu[at : at + len(d.maps)]
                at += len(d.maps)
                if d in rest and np.linalg.norm(hold) > d.limit(mu) * (1 - 1e-12):
                    return False
            elif d in rest:
                gather = d.maps @ (kin[1] @ a + kin[3])
                if d.going @ gather <= 0:
                    return False
        return True

    def _direction(self, d, state, t, kin):
        """The way in which a friction in two directions begins to slip: along its own acceleration."""
        d.going = None
        a, mu, G = self.instant(state, t, kin)
        at = len(self.model.row_map) + len(self.drives) + sum(l.held and l.rigid for l in self.locks)
        for e in self.dry:
            if e is d:
                break
            if e.going is None and not e.resting:
                at += len(e.maps)
        hold = mu[at : at + 2]
        if np.linalg.norm(hold) == 0:
            return False
        d.going = -hold / np.linalg.norm(hold)
        d.fresh = True
        for _ in range(200):
            a, mu, G = self.instant(state, t, kin)
            gather = d.maps @ (kin[1] @ a + kin[3])
            new = gather / np.linalg.norm(gather)
            if np.linalg.norm(new - d.going) < 1e-13:
                return True
            d.going = new
        return True


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
