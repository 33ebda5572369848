"""Where locks meet and leave and dry joints stick and slip, and what follows then."""

import itertools

import numpy as np
from scipy.optimize import brentq

from mechanism.local_laws import NEAR
from study import Unreadable as Refused


SEPARATE = 1e-9   # relative: what counts as rest


class Events:
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
        laws = any(law.remembers for law in self.model.local_laws)
        if not self.locks and not self.dry and not laws:
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
            hits = self._turns(dense, a, b) if laws else []
            for k, ((what, x), (_, y)) in enumerate(zip(before, after)):
                if x > 0 >= y or (x == 0 > y and what[0] != "meets"):
                    f = lambda t: self.guards(self.unpack(dense(t))[0], t)[k][1]
                    hits.append((brentq(f, a, b, xtol=1e-15 * max(abs(b), 1e-300), rtol=1e-14) if x > 0 else a, what))
                elif what[0] in ("stops",) and x <= 0 and y < 0 and a == t0:
                    hits.append((a + 1e-3 * (b - a), what))
                elif what[0] == "meets" and a == t0 and -1e-9 * self._far(what[1]) <= x <= 0 and y < -1e-12 * self._far(what[1]):
                    hits.append((self._comes_back(lambda t: self.guards(self.unpack(dense(t))[0], t)[k][1], a, b), what))
            if hits:
                return min(hits, key=lambda h: h[0])
            before = after
        return None

    def _far(self, lock):
        """What a small part of is nothing on the way of a lock."""
        return abs(lock.at) + (1.0 if self.model.coordinates[lock.joint.way].turning else self.box)

    @staticmethod
    def _comes_back(gap, a, b):
        """When what begins on an open lock at a, and is beyond it at b, reaches it: at once, or after a way that is shorter than a step."""
        times = [a, *(a + (b - a) * np.logspace(-6, 0, 25))]
        outside = [k for k, t in enumerate(times) if gap(t) > 0]
        if not outside:
            return a
        return brentq(gap, times[outside[-1]], times[outside[-1] + 1], xtol=1e-15 * max(abs(b), 1e-300), rtol=1e-14)

    def _turns(self, dense, a, b):
        """Borders of laws that are passed between a and b."""
        def local(t):
            state = self.unpack(dense(t))[0]
            return self.local_guards(state, self.model.scalars(state))
        hits = []
        local(a)
        for k, (what, value) in enumerate(local(b)):
            if value >= -NEAR:
                continue
            f = lambda t: local(t)[k][1] + NEAR
            hits.append((brentq(f, a, b, xtol=1e-15 * max(abs(b), 1e-300), rtol=1e-14) if f(a) > 0 else a, what))
        return hits

    def change(self, state, t, what):
        kind, item = what
        self.events.append((t, kind, item.joint.name))
        if kind == "meets":
            item.held = True
            if item.kind == "latch":
                if item.joint.points is not None and not item.done:      # the law ends, and what it stored
                    ways = self.model.way_map @ self.model.scalars(state)[0] + self.model.way_constant
                    self.lost += self._table(item.joint, ways[item.joint.way])[1]
                    self.ended_laws = True
                item.done = True
            if item.rigid:
                self.rest_dry()
                kept = [(d, d.going) for d in self.dry]
                for d in self.dry:     # impulses are taken without friction
                    if d.going is None:
                        d.going = np.zeros(len(d.maps))
                before = self.kinetic(state)
                state, work = self.impact(self.project(state, t, velocities=False), t)
                self.lost += before - self.kinetic(state) + work
                self.driven += work
                for d, going in kept:
                    d.going = going
                self.rest_dry()
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
        pressing = [l for l in self.locks if l.held and l.rigid and l.kind == "stop"]
        rest = [d for d in self.dry if id(d) not in leave and (d.going is None and not d.resting
                                                               or d.resting and any(l.joint is d.joint for l in pressing))]
        best = None
        choices = [[None] + ([np.array([1.0]), np.array([-1.0])] if len(d.maps) == 1 else ["away"]) for d in rest]
        for opened in itertools.product([False, True], repeat=len(pressing)):
            for l, o in zip(pressing, opened):
                l.held = not o
            self.rest_dry()
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
