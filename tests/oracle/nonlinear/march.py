"""The motion of a structure with nonlinear laws: DOP853 in modal coordinates, from event to event.

Between events everything is smooth: sliders stick or slip, stops are open, push or are slack, a Bouc-Wen element has one sign of u' and
one of z, and each formula has its choices. Where one of them changes the march stops, to round-off, and goes on with the new ones; the old
branch is continued a little beyond its end, so that no step sees a kink.
"""

import math

import numpy
import scipy.linalg
from scipy.integrate import DOP853
from scipy.optimize import brentq

from study import HarmonicLaw, Unreadable

STICK, OPEN, PUSH, SLACK = 0, "open", "push", "slack"
NEAR = 1e-12  # relative: what counts as on a border


class March:
    """Stands at `t` with displacements and velocities of all coordinates, memories of sliders and laws, and works since the start."""

    def __init__(self, model, begin, end, q, v, slips=None, memories=None, tolerance=1e-11, most_steps=60000):
        if model.moving:
            raise Unreadable("laws and a support that moves")
        self.model, self.end, self.tolerance, self.most_steps, self.steps = model, end, tolerance, most_steps, 0
        self.free = list(range(len(model.names)))
        self.squares, self.phi = scipy.linalg.eigh(model.K, model.M)
        self.c, self.n = self.phi.T @ model.C @ self.phi, len(model.names)
        self.sliders, self.stops, self.laws = model.sliders, model.stops, model.laws
        self.B = numpy.array([self.phi.T @ part.b for part in self.sliders + self.stops + self.laws]).reshape(-1, self.n)
        self._read_loads(begin, end)
        mass_phi = self.phi.T @ model.M
        self.eta, self.rate = mass_phi @ q, mass_phi @ v
        self.t = self.origin = begin
        m = len(self.sliders)
        self.slips = list(slips) if slips is not None else [0.0] * m
        self.z = numpy.array([0.0 if memories is None else memories[i] for i in range(len(self.laws))])
        self.slid, self.lost = numpy.zeros(m), numpy.zeros(len(self.laws))
        self.events = []
        self._measure(begin, end)
        self.piece_begin, self.piece_end = begin, next((s for s in self.switches if s > begin), end)
        self._settle()

    # ---- loads and sizes

    def _read_loads(self, begin, end):
        loads = [(self.phi.T @ vector, law) for vector, law in self.model.loads if numpy.any(vector)]
        harmonic = [(vector, law) for vector, law in loads if isinstance(law, HarmonicLaw)]
        self.turning = (numpy.array([v for v, _ in harmonic]).reshape(-1, self.n).T, *(numpy.array([getattr(law, key) for _, law in harmonic])
                        for key in ("amplitude", "angular_frequency", "phase")))
        self.other_loads = [(vector, law) for vector, law in loads if not isinstance(law, HarmonicLaw)]
        self.switches = sorted({s for _, law in self.other_loads for s in law.switches(begin, end)})

    def load(self, t):
        columns, a, w, phase = self.turning
        force = columns @ (a * numpy.cos(w * t + phase)) if len(a) else numpy.zeros(self.n)
        for vector, law in self.other_loads:
            if t <= self.piece_begin:
                value = law.value(self.piece_begin, 1)
            elif t >= self.piece_end:
                value = law.value(self.piece_end, -1)
            else:
                value = law.value(t)
            force = force + vector * value
        return force

    def _measure(self, begin, end):
        """An energy-like size of the motion, from which what is small is told."""
        span = max(end - begin, 1e-300)
        stiffness = numpy.diag(self.squares)
        for part, b in zip(self.sliders + self.stops + self.laws, self.B):
            k = part.stiffness if hasattr(part, "stiffness") else abs(part.tangents(b @ self.eta)[0])
            stiffness = stiffness + k * numpy.outer(b, b)
        highest = numpy.linalg.eigvalsh(stiffness)[-1]
        self.fastest = math.sqrt(max(highest, (2 * math.pi / span)**2))
        w = numpy.sqrt(numpy.maximum(numpy.diag(stiffness), (1 / min(span, 100 / self.fastest))**2))
        largest = numpy.zeros(self.n)
        for t in numpy.linspace(begin, min(end, begin + 1000 / self.fastest), 65):
            self.piece_begin, self.piece_end = begin, end
            largest = numpy.maximum(largest, numpy.abs(self.load(t)))
        forces = numpy.array([part.force(b @ self.eta, b @ self.rate, begin, 0.0) for part, b in
                              zip(self.laws, self.B[len(self.sliders) + len(self.stops):])])
        self.size = max(numpy.max(largest / w), numpy.max(numpy.abs(self.eta) * w), numpy.max(numpy.abs(self.rate)),
                        numpy.max(numpy.abs(forces @ self.B[len(self.B) - len(self.laws):]) / w) if len(forces) else 0.0, 1e-300)
        self.w = w
        self.size_u = numpy.abs(self.B) @ (self.size / w)
        self.size_rate = numpy.abs(self.B).sum(axis=1) * self.size
        m, k = len(self.sliders), len(self.sliders) + len(self.stops)
        self.size_z = numpy.array([min(law.z_max, law.A * self.size_u[k + i]) if law.remembers else 1.0 for i, law in enumerate(self.laws)])
        self.atol = self.tolerance * numpy.concatenate([self.size / w, numpy.full(self.n, self.size), self.size_z,
                                                        numpy.full(m + len(self.laws), 10 * self.size**2)])
        self.longest = 2 * math.pi / self.fastest / 8

    # ---- forces

    def _forces(self, u, rate, t, z):
        m, k = len(self.sliders), len(self.sliders) + len(self.stops)
        forces = numpy.empty(len(u))
        for i, slider in enumerate(self.sliders):
            forces[i] = slider.stiffness * (u[i] - self.slips[i]) if self.modes[i] == STICK else self.modes[i] * slider.limit
        for i, stop in enumerate(self.stops, m):
            forces[i] = stop.stiffness * (u[i] - stop.gap) + stop.damping * rate[i] if self.stop_modes[i - m] == PUSH else 0.0
        for i, law in enumerate(self.laws):
            forces[k + i] = law.force(u[k + i], rate[k + i], t, z[i], self.branches[i] if not law.remembers else None)
        return forces

    def _split(self, y):
        n, laws = self.n, len(self.laws)
        return y[:n], y[n:2 * n], y[2 * n:2 * n + laws]

    def _slope(self, t, y):
        eta, v, z = self._split(y)
        u, rate = self.B @ eta, self.B @ v
        forces = self._forces(u, rate, t, z)
        k = len(self.sliders) + len(self.stops)
        out = numpy.zeros(len(y))
        out[:self.n] = v
        out[self.n:2 * self.n] = self.load(t) - self.squares * eta - self.c @ v - self.B.T @ forces
        at = 2 * self.n
        for i, law in enumerate(self.laws):
            if law.remembers:
                slope = law.slope(z[i], *self.branches[i])
                out[at + i] = rate[k + i] * slope
                lost = law.dissipating_force(u[k + i], rate[k + i], t, z[i], slope)
            else:
                lost = forces[k + i] - law.elastic_force(u[k + i]) if law.used & {"rate", "t"} else 0.0
            out[at + len(self.laws) + len(self.sliders) + i] = lost * rate[k + i]
        for i, slider in enumerate(self.sliders):
            if self.modes[i] != STICK:
                out[at + len(self.laws) + i] = forces[i] * rate[i]
        return out

    # ---- borders

    def _guards(self, t, y):
        """Numbers that are negative beyond a border, over their sizes."""
        eta, v, z = self._split(y)
        u, rate = self.B @ eta, self.B @ v
        m, k = len(self.sliders), len(self.sliders) + len(self.stops)
        guards = []
        for i, slider in enumerate(self.sliders):
            if self.modes[i] == STICK:
                force = slider.stiffness * (u[i] - self.slips[i])
                guards.append((slider.limit - abs(force)) / (slider.limit + slider.stiffness * self.size_u[i]))
            else:
                guards.append(self.modes[i] * rate[i] / self.size_rate[i])
        for j, stop in enumerate(self.stops):
            i = m + j
            depth = (u[i] - stop.gap) / (abs(stop.gap) + self.size_u[i])
            force = ((stop.stiffness * (u[i] - stop.gap) + stop.damping * rate[i])
                     / (stop.stiffness * (abs(stop.gap) + self.size_u[i]) + stop.damping * self.size_rate[i]))
            guards.append(-depth if self.stop_modes[j] == OPEN else min(depth, force if self.stop_modes[j] == PUSH else -force))
        for i, law in enumerate(self.laws):
            if law.remembers:
                side_of_rate, side_of_z = self.branches[i]
                guards.append(side_of_rate * rate[k + i] / self.size_rate[k + i])
                guards.append(side_of_z * z[i] / self.size_z[i])
            else:
                guards += [1.0 if self._choices(i, u[k + i], rate[k + i], t) == self.branches[i] else -1.0, 1.0]
        return numpy.array(guards)

    def _choices(self, i, u, rate, t):
        if t <= self.piece_begin:
            t = self.piece_begin
        return self.laws[i].decisions(u, rate, t)

    def _settle(self):
        """Branches from where everything stands; of what rests, from where it is pushed."""
        m = len(self.sliders)
        eta, v, z = self.eta, self.rate, self.z
        u, rate = self.B @ eta, self.B @ v
        k = m + len(self.stops)
        self.modes, self.stop_modes = [STICK] * m, [OPEN] * len(self.stops)
        self.branches = [None] * len(self.laws)
        for i, slider in enumerate(self.sliders):
            force = slider.stiffness * (u[i] - self.slips[i])
            if abs(force) >= slider.limit * (1 - 1e-9):
                self.slips[i] = u[i] - math.copysign(slider.limit, force) / slider.stiffness
        for j, stop in enumerate(self.stops):
            i = m + j
            depth, size = u[i] - stop.gap, abs(stop.gap) + self.size_u[i]
            force = stop.stiffness * depth + stop.damping * rate[i]
            if depth > NEAR * size or (depth > -NEAR * size and rate[i] > NEAR * self.size_rate[i]):
                self.stop_modes[j] = PUSH if force >= 0 else SLACK
        for i, law in enumerate(self.laws):
            self.branches[i] = (1.0, 1.0) if law.remembers else self._choices(i, u[k + i], rate[k + i], self.t)
        self._u, self._rate = u, rate
        gather = self.B @ self._acceleration()
        for i, slider in enumerate(self.sliders):
            force = slider.stiffness * (u[i] - self.slips[i])
            if abs(force) >= slider.limit * (1 - 1e-9):
                going = rate[i] if abs(rate[i]) > NEAR * self.size_rate[i] else gather[i]
                if going * force > 0:
                    self.modes[i] = int(math.copysign(1, force))
        for i, law in enumerate(self.laws):
            if law.remembers:
                moving = rate[k + i] if abs(rate[k + i]) > NEAR * self.size_rate[k + i] else gather[k + i]
                side = math.copysign(1.0, moving)
                self.branches[i] = (side, side if abs(z[i]) <= NEAR * self.size_z[i] else math.copysign(1.0, z[i]))

    def _change(self, t, y, beyond):
        """What lies beyond its border at y: the new branches."""
        eta, v, z = self._split(y)
        u, rate = self.B @ eta, self.B @ v
        m, k = len(self.sliders), len(self.sliders) + len(self.stops)
        for g in beyond:
            if g < m:
                if self.modes[g] == STICK:
                    force = self.sliders[g].stiffness * (u[g] - self.slips[g])
                    self.modes[g] = int(math.copysign(1, force))
                else:
                    self.slips[g] = u[g] - self.modes[g] * self.sliders[g].limit / self.sliders[g].stiffness
                    self.modes[g] = STICK
            elif g < k:
                stop, j = self.stops[g - m], g - m
                depth = u[g] - stop.gap
                force = stop.stiffness * depth + stop.damping * rate[g]
                size = stop.stiffness * (abs(stop.gap) + self.size_u[g])
                if self.stop_modes[j] == OPEN:
                    self.stop_modes[j] = PUSH
                elif stop.stiffness * depth <= NEAR * size:
                    self.stop_modes[j] = OPEN
                else:
                    self.stop_modes[j] = PUSH if force > 0 else SLACK
            else:
                i, which = divmod(g - k, 2)
                if not self.laws[i].remembers:
                    self.branches[i] = self._choices(i, u[k + i], rate[k + i], t)
                    continue
                side_of_rate, side_of_z = self.branches[i]
                self.branches[i] = (-side_of_rate, side_of_z) if which == 0 else (side_of_rate, -side_of_z)
        self.events.append((t, list(beyond)))
        if len(self.events) > 50000:
            raise Unreadable("too many transitions")

    # ---- the march

    def _pack(self):
        return numpy.concatenate([self.eta, self.rate, self.z, self.slid, self.lost])

    def _take(self, t, y):
        n, laws, m = self.n, len(self.laws), len(self.sliders)
        self.t = t
        self.eta, self.rate, self.z = y[:n].copy(), y[n:2 * n].copy(), y[2 * n:2 * n + laws].copy()
        self.slid, self.lost = y[2 * n + laws:2 * n + laws + m].copy(), y[2 * n + laws + m:].copy()

    def advance(self, target, samples=(), watch=None):
        """Moves on to `target`; `watch(t, y)` is called at each of the samples on the way."""
        waiting, at = list(samples), 0
        while self.t < target:
            if self.t >= self.piece_end and self.piece_end < self.end:
                self.piece_begin = self.piece_end
                self.piece_end = next((s for s in self.switches if s > self.piece_begin), self.end)
                for i, law in enumerate(self.laws):
                    if not law.remembers:
                        u, rate = self.B[-len(self.laws) + i] @ self.eta, self.B[-len(self.laws) + i] @ self.rate
                        self.branches[i] = self._choices(i, u, rate, self.t)
            goal = min(target, self.piece_end)
            if goal - self.t <= 1e-14 * max(abs(goal), goal - self.origin):
                self.t = goal
                continue
            solver = DOP853(self._slope, self.t, self._pack(), goal, rtol=self.tolerance, atol=self.atol, max_step=self.longest)
            while solver.status == "running":
                begin = solver.t
                message = solver.step()
                if solver.status == "failed":
                    raise Unreadable(f"DOP853 at {begin}: {message}")
                self.steps += 1
                if self.steps > self.most_steps:
                    raise Unreadable("too many steps")
                dense = solver.dense_output() if len(self.B) or at < len(waiting) and waiting[at] <= solver.t else None
                event = self._first_event(dense, begin, solver.t, solver.y) if len(self.B) else None
                end = event[0] if event else solver.t
                while at < len(waiting) and waiting[at] <= end:
                    watch(waiting[at], dense(waiting[at]))
                    at += 1
                if event:
                    y = dense(end)
                    self._take(end, y)
                    self._change(event[2], dense(event[2]), event[1])
                    break
                self._take(solver.t, solver.y)
            if self.t >= target - 1e-15 * abs(target):
                self.t = target

    def _first_event(self, dense, begin, end, last):
        """(time before, which, time beyond) of the first border that is passed, to round-off."""
        earlier = begin
        for t in begin + (end - begin) * numpy.array([0.25, 0.5, 0.75, 1.0]):
            y = last if t == end else dense(t)
            guards = self._guards(t, y)
            if numpy.all(guards >= -NEAR):
                earlier = t
                continue
            a, b = earlier, t
            smooth = self._brackets(dense, a, b, guards)
            if smooth is not None:
                a, b = smooth
            while b - a > 4e-16 * max(abs(a), abs(b)):
                middle = 0.5 * (a + b)
                if middle <= a or middle >= b:
                    break
                now = self._guards(middle, dense(middle))
                if numpy.all(now >= -NEAR):
                    a = middle
                else:
                    b, guards = middle, now
            if smooth is not None:
                guards = self._guards(b, dense(b))
            return a, [int(g) for g in numpy.nonzero(guards < -NEAR)[0]], b
        return None

    def _brackets(self, dense, a, b, guards):
        """A narrow bracket of the first passage, by the roots of what is beyond at b."""
        beyond = numpy.nonzero(guards < -NEAR)[0]
        if numpy.any(guards[beyond] == -1.0):
            return None
        first = b
        for g in beyond:
            f = lambda t: self._guards(t, dense(t))[g] + NEAR  # noqa: E731
            if f(a) <= 0:
                return None
            first = min(first, brentq(f, a, b, xtol=1e-15 * max(abs(b), 1e-300), rtol=8.9e-16))
        reach = 1e-13 * (b - a) + 8e-16 * max(abs(a), abs(b))
        for _ in range(40):
            low, high = max(a, first - reach), min(b, first + reach)
            if numpy.all(self._guards(low, dense(low)) >= -NEAR) and numpy.any(self._guards(high, dense(high)) < -NEAR):
                return low, high
            reach *= 8
        return None

    # ---- what is told

    def _acceleration(self):
        force = self.load(self.t) - self.squares * self.eta - self.c @ self.rate
        return force - self.B.T @ self._forces(self.B @ self.eta, self.B @ self.rate, self.t, self.z)

    def full(self, side=0):
        return self.phi @ self.eta, self.phi @ self.rate

    def acceleration(self, side=1):
        kept = self.piece_begin, self.piece_end
        if self.t >= self.piece_end and self.piece_end < self.end:  # a row at a switch tells what follows
            self.piece_begin, self.piece_end = self.piece_end, self.end
        try:
            return self.phi @ self._acceleration()
        finally:
            self.piece_begin, self.piece_end = kept

    def slider_force(self, i):
        slider = self.sliders[i]
        return (slider.stiffness * (self.B[i] @ self.eta - self.slips[i]) if self.modes[i] == STICK else self.modes[i] * slider.limit)

    def slip(self, i):
        return self.B[i] @ self.eta - self.slider_force(i) / self.sliders[i].stiffness

    def stop_force(self, i):
        stop, b = self.stops[i], self.B[len(self.sliders) + i]
        if self.stop_modes[i] != PUSH:
            return 0.0
        return stop.stiffness * (b @ self.eta - stop.gap) + stop.damping * (b @ self.rate)

    def law_row(self):
        """Displacements, forces, stored and dissipated energies of the laws."""
        k = len(self.sliders) + len(self.stops)
        u, rate = self.B[k:] @ self.eta, self.B[k:] @ self.rate
        forces = [law.force(u[i], rate[i], self.t, self.z[i]) for i, law in enumerate(self.laws)]
        return u, numpy.array(forces), numpy.array([law.stored(u[i], self.z[i]) for i, law in enumerate(self.laws)]), self.lost.copy()
