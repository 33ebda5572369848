"""Forces, rows of constraints, accelerations and multipliers at an instant.

    M a = Q + G^T multiplier,   G a = w

The rows are those of the joints, of drives, of rigid locks that hold and of dry joints that stick.
"""

import numpy as np

from mechanism.rotations import cross
from study import Unreadable as Refused
from study import beside

class Instant:
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
        mounted, self.mount_told, stored, damper_power = m.mount_forces(state, (S, dS, S1, S2), u)
        Q += mounted
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
        local, self.local_told = self.local_forces(state, t, (S, dS, S1, S2))
        Q = Q + local
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
