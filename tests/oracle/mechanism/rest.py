"""Equilibrium and modes of mechanisms, from differences of the forces.

The stiffness is the derivative of what is out of balance, Q + G^T multiplier with the multipliers as they are, along every
motion that a part can make by itself; the constraints then leave the motions that are the null space of G.
"""

import numpy as np

from mechanism import Refused, moved


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
    C = np.empty((m.nf, m.nf))
    size = 1e-6 * fast * np.where(m.free % 6 < 3, march.box, 1.0)
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
    given = m.start_u
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
    for d in march.dry:
        d.resting = False
        d.place = d.maps @ m.scalars(state)[0]
    march.standing = not velocities
    state.u = np.array(given)
    if velocities:
        state = march.project_velocities(state, t)
    else:
        state.u = np.zeros(m.nf)
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
