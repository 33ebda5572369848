"""Equilibrium and modes of mechanisms, from differences of the forces.

The stiffness is the derivative of what is out of balance, Q + G^T multiplier with the multipliers as they are, along every
motion that a part can make by itself; the constraints then leave the motions that are the null space of G.
"""

import itertools

import numpy as np

from mechanism import Refused, State, moved
from mechanism.columns import LETTERS
from mechanism.rotations import quaternion_of


def unbalanced(march, state, mu, t=0.0):
    """M a that would follow, with the multipliers given, at rest."""
    m = march.model
    kin = m.scalars(state)
    Q = march.applied(state, t, kin)
    G = march.rows(state, t, kin)[0]
    return Q + G.T @ mu


def step_sizes(march):
    w = march.model.free % 6
    return np.where(w < 3, 1e-3 * march.box, 1e-3)


def stiffness(march, state, mu, t=0.0, rule=((1, 3 / 4), (2, -3 / 20), (3, 1 / 60))):
    """-d(Q + G^T mu)/dq [nf x nf], by differences of sixth order unless another rule is given."""
    march.linearised = march.linearise(state, t)
    try:
        return _stiffness(march, state, mu, t, rule)
    finally:
        march.linearised = None


def _stiffness(march, state, mu, t, rule):
    m = march.model
    eps = step_sizes(march)
    K = np.empty((m.nf, m.nf))
    for i in range(m.nf):
        e = np.zeros(m.nf)
        total = 0.0
        for factor, weight in rule:
            e[i] = factor * eps[i]
            forward = unbalanced(march, moved(m, state, e), mu, t)
            backward = unbalanced(march, moved(m, state, -e), mu, t)
            total = total + weight * (forward - backward)
        K[:, i] = -total / eps[i]
    return K


def damping(march, state, K, t=0.0):
    m = march.model
    fast = np.sqrt(np.linalg.norm(march.Linv @ K @ march.Linv.T, 2))
    if fast == 0.0:
        fast = max(np.linalg.norm(m.start_u) / march.box, 1e-3)
    # What goes with rate |rate| has no slope at rest, and falls with the step: of two steps that of none.
    size = 1e-6 * fast * np.where(m.free % 6 < 3, march.box, 1.0)
    return 2 * _damping(march, state, size / 2, t) - _damping(march, state, size, t)


def _damping(march, state, size, t):
    m = march.model
    C = np.empty((m.nf, m.nf))
    for i in range(m.nf):
        up, down = state.copy(), state.copy()
        up.u = np.zeros(m.nf)
        down.u = np.zeros(m.nf)
        up.u[i], down.u[i] = size[i], -size[i]
        C[:, i] = -(march.applied(up, t) - march.applied(down, t)) / (2 * size[i])
    return C


def at_rest(march, state):
    out = state.copy()
    out.u = np.zeros(march.model.nf)
    return out


def equilibrium(march, velocities=False, state=None, t=0.0):
    """From the configuration given downhill: Newton's method on K + shift M, whose shift falls with what is out of balance."""
    m = march.model
    march.standing = True
    state = at_rest(march, march.begin(state))
    for d in march.dry:
        d.resting = True
    mu = None
    shift = None
    first = None
    for iteration in range(400):
        state.u = np.zeros(m.nf)
        kin = m.scalars(state)
        a, mu, G = march.instant(state, t, kin)
        R = m.M @ a
        size = np.linalg.norm(march.Linv @ R)
        weight = max(np.linalg.norm(march.Linv @ march.applied(state, t, kin)), 1e-300)
        if first is None:
            first = max(size, 1e-12 * weight)
        if size < 1e-11 * weight or size == 0.0:
            pulling = _pulling(march, kin, mu)
            if not pulling:
                break
            for l in pulling:
                l.held = False
            continue
        K = stiffness(march, state, mu, t, rule=((1e-3, 500.0),))
        if shift is None:
            shift = max(np.abs(np.linalg.eigvalsh(march.Linv @ (K + K.T) / 2 @ march.Linv.T)).max() * 1e-2, size / march_scale(march))
        now = shift * min(1.0, (size / first)) ** 1.0
        if size < 1e-6 * first:
            now = 0.0
        for attempt in range(60):
            n = len(G)
            A = np.zeros((m.nf + n, m.nf + n))
            A[: m.nf, : m.nf] = march.Linv @ (K + now * m.M) @ march.Linv.T
            B = march.Linv @ G.T
            A[: m.nf, m.nf :], A[m.nf :, : m.nf] = -B, B.T
            gap = march.rows(state, t, kin)[1]
            x = np.linalg.lstsq(A, np.concatenate([march.Linv @ R, -gap]), rcond=1e-14)[0]
            dq = march.Linv.T @ x[: m.nf]
            reach = max(np.max(np.abs(dq[m.free % 6 < 3]), initial=0) / march.box, np.max(np.abs(dq[m.free % 6 >= 3]), initial=0))
            if reach < 0.2 and dq @ R >= -1e-12 * abs(dq @ R):
                break
            now = max(now * 3, 1e-3 * shift)
        new = moved(m, state, dq)
        new.u = np.zeros(m.nf)
        state = march.project(new, t, velocities=False)
        _engage(march, state)
    else:
        raise Refused("no equilibrium was found")
    _, K, _, Z, _ = modes_about(march, state)
    stiff = np.abs(np.linalg.eigvals(Z.T @ K @ Z))
    if len(stiff) and stiff.min() < 1e-9 * stiff.max():
        raise Refused("an equilibrium that some motion does not leave")
    return let_go(march, state, velocities)


def state_of_row(march, row):
    """The state that a row of results tells, with the turns of the joints' angles; None where it leaves out a coordinate."""
    m = march.model
    state = m.start_state()
    turned = np.zeros((len(m.names), 3))
    for c in m.free:
        p, i = divmod(int(c), 6)
        column = f"{m.names[p]}.{LETTERS[i]}" + (".position [m]" if i < 3 else ".angle [rad]")
        if column not in row:
            return None
        if i < 3:
            state.r[p, i] = row[column]
        else:
            turned[p, i - 3] = row[column]
    q, angle = state.q.copy(), state.angle.copy()
    for p in {int(c) // 6 for c in m.free if c % 6 >= 3}:
        angle[p] = turned[p, 2]
        q[p] = quaternion_of(turned[p])
    u = state.u.copy()
    for k, c in enumerate(m.free):
        p, i = divmod(int(c), 6)
        u[k] = row.get(f"{m.names[p]}.{LETTERS[i]}." + ("velocity [m/s]" if i < 3 else "angular_velocity [rad/s]"), u[k])
    state = State(state.r, q, u, angle, state.turns)
    if len(m.atans):
        state.turns = m.scalars(state)[0][m.first_atan : m.first_atan + len(m.atans)]
        for c, constant in zip(m.coordinates, m.way_constant):
            ((sort, number),) = c.form
            if sort == "atan" and f"{c.name}.angle [rad]" in row and c.kind == "angle":
                state.turns[number] = row[f"{c.name}.angle [rad]"] - constant
    return state


def equilibrium_at(march, state):
    """The equilibrium next to a state, by Newton's method: what is an equilibrium stays where it is."""
    m = march.model
    march.standing = True
    march.begin()      # locks lie on the side of the start
    state = at_rest(march, state)
    for d in march.dry:
        d.resting = True
    ways = m.way_map @ m.scalars(state)[0] + m.way_constant
    for l in march.locks:
        reach = 1e-9 * (1.0 if m.coordinates[l.joint.way].turning else march.box)
        if l.side * (l.at - ways[l.joint.way]) <= reach:
            l.held = True
            l.done = l.kind == "latch"
    state = march.project(state, 0.0, velocities=False)
    for _ in range(20):
        state.u = np.zeros(m.nf)
        kin = m.scalars(state)
        a, mu, G = march.instant(state, 0.0, kin)
        pulling = _pulling(march, kin, mu)
        K = stiffness(march, state, mu, 0.0)
        n = len(G)
        A = np.zeros((m.nf + n, m.nf + n))
        A[: m.nf, : m.nf] = march.Linv @ K @ march.Linv.T
        B = march.Linv @ G.T
        A[: m.nf, m.nf :], A[m.nf :, : m.nf] = -B, B.T
        x = np.linalg.lstsq(A, np.concatenate([march.Linv @ m.M @ a, np.zeros(n)]), rcond=1e-9)[0]
        dq = march.Linv.T @ x[: m.nf]
        reach = max(np.max(np.abs(dq[m.free % 6 < 3]), initial=0) / march.box, np.max(np.abs(dq[m.free % 6 >= 3]), initial=0))
        if not reach < 0.1:
            raise Refused("no equilibrium next to what is told")
        if reach < 1e-10:
            if pulling:
                for l in pulling:
                    l.held = False
                continue
            weight = np.linalg.norm(march.Linv @ march.applied(state, 0.0, kin))
            stiff = np.linalg.norm(march.Linv @ K @ march.Linv.T, 2) * march_scale(march)
            if not np.linalg.norm(march.Linv @ m.M @ a) <= 1e-8 * max(weight, 1e-3 * stiff):
                raise Refused("what is told is not in balance")
            return let_go(march, state)
        state = march.project(moved(m, state, dq), 0.0, velocities=False)
    raise Refused("no equilibrium next to what is told")


def begin_at_rest(march):
    """The configuration given, with those of the stops that it lies on which press where nothing moves; friction is left out."""
    march.standing = True
    state = at_rest(march, march.begin())
    for d in march.dry:
        d.resting = True
    m, met = march.model, [l for l in march.locks if l.held and l.kind == "stop"]
    kin = m.scalars(state)
    for opened in itertools.product((False, True), repeat=len(met)):
        for l, o in zip(met, opened):
            l.held = not o
        a, mu, _ = march.instant(state, 0.0, kin)
        parts = march.lock_parts(mu)
        gathers = {l: l.side * (m.way_map[l.joint.way] @ (kin[1] @ a + kin[3])) for l in met}
        nothing = 1e-9 * np.max(np.abs(a), initial=0.0)
        if all(l.side * parts[l] <= 1e-12 * np.max(np.abs(mu)) for l in met if l.held and l.rigid) and all(
                (gathers[l] >= -nothing) if l.held else gathers[l] <= nothing for l in met if not l.rigid or not l.held):
            return state
    raise Refused("no consistent choice of stops at rest")


def let_go(march, state, velocities=False):
    """The start of a march from an equilibrium: with the velocities given, or at rest."""
    march.standing = True
    state.memories = march.memories(state, march.model.scalars(state))
    march.rest_dry()
    for d in march.dry:
        d.place = d.maps @ march.model.scalars(state)[0]
    march.standing = not velocities
    state.u = np.array(march.model.start_u) if velocities else np.zeros(march.model.nf)
    return state


def march_scale(march):
    return march.box * np.sqrt(np.max(np.diag(march.model.M)))


def _engage(march, state):
    """Locks that the way there passes hold."""
    m = march.model
    ways = m.way_map @ m.scalars(state)[0] + m.way_constant
    for l in march.locks:
        if not l.held and l.side * (l.at - ways[l.joint.way]) <= 0:
            l.held = True
            l.done = l.kind == "latch"
            if l.rigid:
                projected = march.project(state, 0.0, velocities=False)
                state.r, state.q, state.angle, state.turns, state.R = (projected.r, projected.q, projected.angle,
                                                                        projected.turns, projected.R)


def _pulling(march, kin, mu):
    """Stops that hold and would have to pull."""
    m = march.model
    ways = m.way_map @ kin[0] + m.way_constant
    at = len(m.row_map) + len(march.drives)
    out = []
    for l in march.locks:
        if not l.held:
            continue
        if l.rigid:
            if l.kind == "stop" and l.side * mu[at] > 0:
                out.append(l)
            at += 1
        elif l.kind == "stop" and l.side * (ways[l.joint.way] - l.at) < 0:
            out.append(l)
    return out


def modes_about(march, state, t=0.0):
    """M, C, K of all motions, the rows G and an M-orthonormal basis Z of what they leave."""
    m = march.model
    march.standing = True
    state = at_rest(march, state)
    for d in march.dry:
        d.resting = True
    a, mu, G = march.instant(state, t)
    K = stiffness(march, state, mu, t)
    C = damping(march, state, K, t)
    B = march.Linv @ G.T
    if len(G):
        B = B / np.linalg.norm(B, axis=0)
        u, s, _ = np.linalg.svd(B)
        rank = int(np.sum(s > 1e-9 * s[0]))
        Z = march.Linv.T @ u[:, rank:]
    else:
        Z = march.Linv.T
    return C, K, G, Z, np.linalg.norm(m.M @ a)


def eigenvalues(C, K, Z):
    """All s of (s^2 + s Z'CZ + Z'KZ) x = 0, in a scale of time of the highest."""
    k, c = Z.T @ K @ Z, Z.T @ C @ Z
    n = len(k)
    if n == 0:
        return np.zeros(0, complex)
    w = np.sqrt(max(np.linalg.norm(k, 2), 1e-300))
    A = np.block([[np.zeros((n, n)), np.eye(n)], [-k / w**2, -c / w]])
    return np.linalg.eigvals(A) * w
