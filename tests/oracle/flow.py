"""The motion of a structure between located transitions, by matrix exponentials of its dense model.

While no slider or stop changes its state the structure is linear: `y' = A y + sum of G_j g_j(t)`. The laws `g_j` join the
state (`laws.py`), so that one matrix exponential (of a stride or of a stride halved any number of times) moves everything
along without an error but round-off. Transitions are found by halving the stride.
"""

import itertools
import math

import numpy
import scipy.linalg

import laws as laws_of_time
from study import Unreadable

STICK, OPEN, PUSH, SLACK = 0, "open", "push", "slack"


class Flow:
    """Stands at `t` with displacements `q` and velocities `v` of all coordinates."""

    def __init__(self, model, begin, end, q, v, slips=None, most_strides=300000):
        self.model, self.end = model, end
        self.moved = [i for i, _ in model.moving]
        self.free = [i for i in range(len(model.names)) if i not in self.moved]
        f = self.free
        if not f:
            raise Unreadable("nothing moves freely")
        squares, self.phi = scipy.linalg.eigh(model.K[numpy.ix_(f, f)], model.M[numpy.ix_(f, f)])
        self.squares = squares
        span = max(end - begin, 1e-300)
        self.scale = numpy.sqrt(numpy.maximum(squares, (0.1 / span)**2))
        self.n = len(f)
        self.c = self.phi.T @ model.C[numpy.ix_(f, f)] @ self.phi
        laws = [(vector[f], law) for vector, law in model.loads if numpy.any(vector[f])]
        self.switches = sorted({s for _, law in model.loads for s in law.switches(begin, end)}
                               | {s for _, law in model.moving for s in law.switches(begin, end)})
        laws = [(vector, laws_of_time.of_load(law)) for vector, law in laws]
        for i, law in model.moving:
            laws += [(-matrix[f, i], laws_of_time.of_support(law, derivative))
                     for derivative, matrix in enumerate((model.K, model.C, model.M))]
        self.laws = [law for _, law in laws]
        self.modal_loads = [self.phi.T @ vector for vector, _ in laws]
        self.sliders, self.stops = model.sliders, model.stops
        self.contacts = bool(self.sliders or self.stops)
        self._exact = all(law.exact for law in self.laws)
        self._pushed = None  # the constant load of the contacts, once it is known
        self.b_sliders = [self.phi.T @ s.b[f] for s in self.sliders]
        self.b_stops = [self.phi.T @ s.b[f] for s in self.stops]
        fastest = self.fastest = self._fastest()
        stride = span / 16
        for law in self.laws:
            stride = min(stride, law.longest_stride(begin, end, self.contacts))
        if self.contacts:
            stride = min(stride, 2 * math.pi / fastest / 12 if fastest > 0 else stride)
        self.stride = stride
        if span / stride > most_strides:
            raise Unreadable(f"{span / stride:.3g} strides are too many")
        self._propagators = {}
        mass_phi = self.phi.T @ model.M[numpy.ix_(f, f)]
        self.t = begin
        self.eta, self.rate = mass_phi @ q[f], mass_phi @ v[f]
        self.slips = list(slips) if slips is not None else [0.0] * len(self.sliders)
        self.events = []
        self.slid = [0.0] * len(self.sliders)  # dissipated by slip since the start
        self._ladder = [stride * 0.5**k for k in range(46)]
        self._start()

    # ---- the state

    def _fastest(self):
        stiffness = numpy.diag(numpy.maximum(self.squares, 0.0))
        for s, b in zip(self.sliders, self.b_sliders):
            stiffness = stiffness + s.stiffness * numpy.outer(b, b)
        for s, b in zip(self.stops, self.b_stops):
            stiffness = stiffness + s.stiffness * numpy.outer(b, b)
        squares, psi = numpy.linalg.eigh(stiffness)
        columns = self.b_sliders + self.b_stops
        if columns:  # of the modes that contacts feel
            felt = numpy.max(numpy.abs(numpy.array(columns) @ psi), axis=0)
            squares = squares[felt > 1e-3 * numpy.max(felt)]
        return math.sqrt(max(squares[-1], 0.0))

    def full(self, side=0):
        """q and v of all coordinates."""
        q, v = numpy.zeros(len(self.model.names)), numpy.zeros(len(self.model.names))
        q[self.free], v[self.free] = self.phi @ self.eta, self.phi @ self.rate
        for i, law in self.model.moving:
            q[i], v[i], _ = law.motion(self.t, side)
        return q, v

    def slider_force(self, i):
        slider = self.sliders[i]
        if self.modes[i] == STICK:
            return slider.stiffness * (self.b_sliders[i] @ self.eta - self.slips[i])
        return self.modes[i] * slider.limit

    def slip(self, i):
        return self.b_sliders[i] @ self.eta - self.slider_force(i) / self.sliders[i].stiffness

    def stop_force(self, i):
        stop = self.stops[i]
        if self.stop_modes[i] != PUSH:
            return 0.0
        return stop.stiffness * (self.b_stops[i] @ self.eta - stop.gap) + stop.damping * (self.b_stops[i] @ self.rate)

    def acceleration(self, side=1):
        """Of all coordinates, from equilibrium."""
        f = self.free
        force = -self.squares * self.eta - self.c @ self.rate
        for vector, law in zip(self.modal_loads, self.laws):
            force = force + vector * law.value(self.t, side)
        for i, b in enumerate(self.b_sliders):
            force = force - b * self.slider_force(i)
        for i, b in enumerate(self.b_stops):
            force = force - b * self.stop_force(i)
        a = numpy.zeros(len(self.model.names))
        a[f] = self.phi @ force
        for i, law in self.model.moving:
            a[i] = law.motion(self.t, side)[2]
        return a

    # ---- one linear piece

    def _linear(self):
        """Stiffness and damping in modal coordinates, contacts included."""
        stiffness, damping = numpy.diag(self.squares), self.c.copy()
        for i, (slider, b) in enumerate(zip(self.sliders, self.b_sliders)):
            if self.modes[i] == STICK:
                stiffness = stiffness + slider.stiffness * numpy.outer(b, b)
        for i, (stop, b) in enumerate(zip(self.stops, self.b_stops)):
            if self.stop_modes[i] == PUSH:
                stiffness = stiffness + stop.stiffness * numpy.outer(b, b)
                damping = damping + stop.damping * numpy.outer(b, b)
        return stiffness, damping

    def _constant(self):
        """The constant load of the contacts, in modal coordinates."""
        constant = numpy.zeros(self.n)
        for i, b in enumerate(self.b_sliders):
            slider = self.sliders[i]
            constant += (slider.stiffness * self.slips[i] if self.modes[i] == STICK
                         else -self.modes[i] * slider.limit) * b
        for i, b in enumerate(self.b_stops):
            if self.stop_modes[i] == PUSH:
                constant += self.stops[i].stiffness * self.stops[i].gap * b
        return constant

    def _propagator(self, level):
        key = (tuple(self.modes), tuple(self.stop_modes), level)
        if key not in self._propagators:
            n = self.n
            stiffness, damping = self._linear()
            size = 2 * n + sum(law.size for law in self.laws) + (n if self.contacts else 0)
            a = numpy.zeros((size, size))
            a[:n, n:2 * n] = numpy.diag(self.scale)
            a[n:2 * n, :n] = -stiffness / self.scale[None, :]
            a[n:2 * n, n:2 * n] = -damping
            at = 2 * n
            for load, law in zip(self.modal_loads, self.laws):
                a[n:2 * n, at] = load
                a[at:at + law.size, at:at + law.size] = law.generator(self.stride)
                at += law.size
            if self.contacts:
                a[n:2 * n, at:] = numpy.eye(n)
            self._propagators[key] = scipy.linalg.expm(a * self._ladder[level])
        return self._propagators[key]

    def _fit(self, span):
        """The state of the laws at t for the next `span`, and whether it is good."""
        states = [law.state(self.t, span, self.piece_begin, self.piece_end, self.stride) for law in self.laws]
        return (numpy.concatenate([state for state, _ in states]) if states else numpy.zeros(0),
                all(good for _, good in states))

    def _try(self, level, coefficients):
        """The state after the stride of this level; nothing is changed."""
        if self.contacts and self._pushed is None:
            self._pushed = self._constant()
        y = [self.eta * self.scale, self.rate, coefficients] + ([self._pushed] if self.contacts else [])
        moved = self._propagator(level) @ numpy.concatenate(y)
        n = self.n
        return moved[:n] / self.scale, moved[n:2 * n], moved[2 * n:2 * n + len(coefficients)]

    # ---- contacts

    def _guards(self, eta, rate):
        """Of each contact a number that is negative beyond its transition."""
        guards = []
        for i, (slider, b) in enumerate(zip(self.sliders, self.b_sliders)):
            if self.modes[i] == STICK:
                guards.append(1 - abs(slider.stiffness * (b @ eta - self.slips[i])) / slider.limit)
            else:
                guards.append(self.modes[i] * (b @ rate))
        for i, (stop, b) in enumerate(zip(self.stops, self.b_stops)):
            depth = b @ eta - stop.gap
            force = stop.stiffness * depth + stop.damping * (b @ rate)
            if self.stop_modes[i] == OPEN:
                guards.append(-depth)
            elif self.stop_modes[i] == PUSH:
                guards.append(min(force, depth * stop.stiffness))
            else:
                guards.append(min(-force, depth * stop.stiffness))
        return numpy.array(guards)

    def restart(self, t, eta, rate, slips):
        """From another state, at the start of a piece."""
        self.t, self.eta, self.rate, self.slips = t, eta, rate, list(slips)
        self._start()

    def _start(self):
        self.modes = [STICK] * len(self.sliders)
        self.stop_modes = [OPEN] * len(self.stops)
        self.piece_begin = self.t
        self.piece_end = next((s for s in self.switches if s > self.t), self.end)
        for i, slider in enumerate(self.sliders):  # beyond its limit a slider has slipped
            force = slider.stiffness * (self.b_sliders[i] @ self.eta - self.slips[i])
            if abs(force) > slider.limit:
                self.slips[i] = self.b_sliders[i] @ self.eta - math.copysign(slider.limit, force) / slider.stiffness
        if self.contacts:
            self._settle()

    def _settle(self):
        """Chooses the states of all contacts that stand at a border, so that a short while later none is beyond one."""
        choices = []
        for i, (slider, b) in enumerate(zip(self.sliders, self.b_sliders)):
            force = self.slider_force(i)
            at_limit = abs(force) >= slider.limit * (1 - 1e-9)
            if at_limit:
                self.slips[i] = b @ self.eta - math.copysign(slider.limit, force) / slider.stiffness
            choices.append([STICK, int(math.copysign(1, force))] if at_limit else [STICK])
        for i, (stop, b) in enumerate(zip(self.stops, self.b_stops)):
            depth, speed = b @ self.eta - stop.gap, b @ self.rate
            force = stop.stiffness * depth + stop.damping * speed
            near = abs(depth) <= 1e-9 * (abs(stop.gap) + numpy.abs(b) @ numpy.abs(self.eta) + abs(speed) * self.stride)
            border = abs(force) <= 1e-9 * (stop.stiffness * abs(depth) + stop.damping * abs(speed))
            if near:
                choices.append([OPEN, PUSH, SLACK] if stop.damping else [OPEN, PUSH])
            elif depth < 0:
                choices.append([OPEN])
            elif border:
                choices.append([PUSH, SLACK])
            else:
                choices.append([PUSH if force > 0 else SLACK])
        combinations = list(itertools.product(*choices))
        m = len(self.sliders)

        def take(combination):
            self.modes, self.stop_modes = list(combination[:m]), list(combination[m:])
            self._pushed = None
        if len(combinations) == 1:
            take(combinations[0])
            return
        best = None
        coefficients, _ = self._fit(self._ladder[20])
        for level in (18, 26, 12):
            for combination in combinations:
                take(combination)
                eta, rate, _ = self._try(level, coefficients)
                guards, before = self._guards(eta, rate), self._guards(self.eta, self.rate)
                drop = guards - numpy.minimum(before, 0.0)
                worst = numpy.min(drop)
                if worst >= 0 or numpy.min(guards) >= 0:
                    return
                if best is None or worst > best[0]:
                    best = (worst, combination)
        take(best[1])

    # ---- the march

    def advance(self, target, watch=None):
        """Moves on to `target`. `watch(self)` is called after every stride."""
        while self.t < target:
            if self.t >= self.piece_end and self.piece_end < self.end:
                self.piece_begin = self.piece_end
                self.piece_end = next((s for s in self.switches if s > self.piece_begin), self.end)
                if self.contacts:
                    self._settle()
            goal = min(target, self.piece_end)
            span = goal - self.t if self._exact else min(goal - self.t, self.stride)
            if span <= self._ladder[-3]:
                self._creep(span)
                self.t = goal
                continue
            coefficients, good = self._fit(span)
            while not good and span > self.stride * 2**-12:
                span /= 2
                coefficients, good = self._fit(span)
            stop = goal if span == goal - self.t else self.t + span
            while coefficients is not None and stop - self.t > self._ladder[-3]:
                level = max(0, math.ceil(math.log2(self.stride / ((stop - self.t) * (1 + 1e-9)))))
                coefficients = self._move(level, coefficients)
                if watch:
                    watch(self)
            if coefficients is not None:
                self._creep(stop - self.t)
                self.t = stop

    def _creep(self, span):
        """What is left of a stride, below the shortest one: without contacts strides are long beside the fastest mode."""
        if not self.contacts:
            force = -self.squares * self.eta - self.c @ self.rate
            for vector, law in zip(self.modal_loads, self.laws):
                force = force + vector * law.value(self.t, 1)
            self.eta, self.rate = self.eta + span * self.rate, self.rate + span * force

    def _move(self, level, coefficients):
        """Takes the stride of a level, or goes to the transition in it. Returns the laws there, None after a
        transition."""
        eta, rate, later = self._try(level, coefficients)
        if not self.contacts:
            self.eta, self.rate, self.t = eta, rate, self.t + self._ladder[level]
            return later
        guards = self._guards(eta, rate)
        if guards.min() >= 0:
            if level < 9 and self._may_touch(eta, rate, level):
                return self._move(level + 1, coefficients)
            self._take(eta, rate, level)
            return later
        floor = numpy.minimum(self._guards(self.eta, self.rate), 0.0)
        noise = self._noise()
        if numpy.all(guards >= floor - noise):
            self._take(eta, rate, level)
            return later
        for finer in range(level + 1, len(self._ladder)):  # up to the transition, by halves
            eta, rate, later = self._try(finer, coefficients)
            if numpy.all(self._guards(eta, rate) >= floor - noise):
                self._take(eta, rate, finer)
                coefficients = later
        before = (tuple(self.modes), tuple(self.stop_modes))
        eta, rate, _ = self._try(len(self._ladder) - 1, coefficients)
        beyond = numpy.nonzero(self._guards(eta, rate) < floor - noise)[0]
        self._take(eta, rate, len(self._ladder) - 1)
        m = len(self.sliders)
        for i in beyond:
            if i < m:
                force = self.slider_force(i)
                self.slips[i] = (self.b_sliders[i] @ self.eta
                                 - math.copysign(self.sliders[i].limit, force) / self.sliders[i].stiffness)
        self._settle()
        self.events.append((self.t, before, (tuple(self.modes), tuple(self.stop_modes))))
        if len(self.events) > 20000:
            raise Unreadable("too many transitions")
        return None

    def _may_touch(self, eta, rate, level):
        """Whether a contact may meet its border and return within the stride: it turns there, and so near that it could."""
        for i, b in enumerate(self.b_sliders + self.b_stops):
            before, after = b @ self.rate, b @ rate
            if before * after >= 0:
                continue
            reach = (abs(before) + abs(after)) * self._ladder[level]
            if i >= len(self.sliders):
                near = abs(b @ eta - self.stops[i - len(self.sliders)].gap) < reach
            else:
                slider = self.sliders[i]
                near = (self.modes[i] == STICK
                        and slider.limit / slider.stiffness - abs(b @ eta - self.slips[i]) < reach)
            if near:
                return True
        return False

    def _take(self, eta, rate, level):
        for i, b in enumerate(self.b_sliders):
            if self.modes[i] != STICK:
                self.slid[i] += self.sliders[i].limit * abs(b @ (eta - self.eta))
        self.eta, self.rate, self.t = eta, rate, self.t + self._ladder[level]

    def _noise(self):
        noise = []
        for i, b in enumerate(self.b_sliders):
            size = numpy.abs(b) @ numpy.abs(self.eta) + abs(self.slips[i])
            noise.append(4e-15 * self.sliders[i].stiffness * size / self.sliders[i].limit if self.modes[i] == STICK
                         else 4e-15 * (numpy.abs(b) @ (numpy.abs(self.rate) + self.scale * numpy.abs(self.eta))))
        for i, b in enumerate(self.b_stops):
            size = numpy.abs(b) @ numpy.abs(self.eta) + abs(self.stops[i].gap)
            speed = numpy.abs(b) @ numpy.abs(self.rate)
            noise.append(4e-15 * (size if self.stop_modes[i] == OPEN
                                  else self.stops[i].stiffness * size + self.stops[i].damping * speed))
        return numpy.array(noise)
