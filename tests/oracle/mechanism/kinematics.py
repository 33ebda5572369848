"""Values, derivatives and rates of the scalars of which joints are made."""

import numpy as np

from mechanism.rotations import cross, matrix_of, product, quaternion_of, skew

class Kinematics:
    def _freeze(self):
        """Turns the lists of vectors and scalars into arrays."""
        way = [(k, v) for k, v in enumerate(self.vectors) if v[0] == "way"]
        axis = [(k, v) for k, v in enumerate(self.vectors) if v[0] == "axis"]
        self._w = np.array([k for k, _ in way], int)
        self._wp = np.array([[v[1], v[3]] for _, v in way], int).reshape(-1, 2)
        self._ws = np.array([[v[2], v[4]] for _, v in way], float).reshape(-1, 2, 3)
        self._a = np.array([k for k, _ in axis], int)
        self._ap = np.array([v[1] for _, v in axis], int)
        self._ae = np.array([v[2] for _, v in axis], float).reshape(-1, 3)
        self._ae_skew, self._ws_skew = -skew(self._ae), skew(self._ws)
        self._w3, self._a3 = np.arange(3)[None, :, None], self._a[:, None, None]
        self._a_columns = (6 * self._ap[:, None] + 3 + np.arange(3))[:, None, :]
        self._w_columns = (6 * self._wp[:, :, None] + 3 + np.arange(3))[:, :, None, :]
        self._da = np.array([a for a, _ in self.dots], int)
        self._db = np.array([b for _, b in self.dots], int)
        nd, na, nr = len(self.dots), len(self.atans), len(self.roots)
        self._at = np.array([[y[1], x[1]] for y, x in self.atans], int).reshape(-1, 2)
        self._rt = np.array([s[1] for s in self.roots], int)
        self._tn = np.array(self.turns, int).reshape(-1, 2)
        base = dict(dot=0, atan=nd, root=nd + na, turn=nd + na + nr)
        self.scalar_count = nd + na + nr + len(self.turns)
        self.first_atan = nd
        place = lambda s: base[s[0]] + s[1]
        rows, constants = [], []
        for j in self.joints:
            j.row_numbers = []
            for form, constant in j.rows:
                line = np.zeros(self.scalar_count)
                for s, factor in form.items():
                    line[place(s)] += factor
                j.row_numbers.append(len(rows))
                rows.append(line)
                constants.append(constant)
        self.row_map = np.array(rows).reshape(len(rows), self.scalar_count)
        self.row_constant = np.array(constants, float)
        lines = []
        for c in self.coordinates:
            line = np.zeros(self.scalar_count)
            for s, factor in c.form.items():
                line[place(s)] += factor
            lines.append(line)
        self.way_map = np.array(lines).reshape(len(lines), self.scalar_count)
        self.way_constant = np.array([c.constant for c in self.coordinates], float)
        # threads: the slip along the helix is made of the turn and the way
        self.thread_map = {}
        for j in self.joints:
            if j.type == "screw":
                self.thread_map[j.name] = (self.way_map[j.way].copy(), np.eye(self.scalar_count)[place(j.slide)])
        # columns of the vectors' derivatives
        n = len(self.names)
        self._inverse = -np.ones(6 * n, int)
        self._inverse[self.free] = np.arange(self.nf)
        # a prismatic joint begins at its displacement wherever its points lie
        scalars = self.scalars(self.start_state(), bias=False)[0]
        begin = self.way_map @ scalars
        for k, c in enumerate(self.coordinates):
            if c.kind in ("displacement", "x", "y", "mount"):
                self.way_constant[k] -= begin[k]

    def start_state(self):
        return State(self.start_r.copy(), self.start_q.copy(), self.start_u.copy(), self.start_angle.copy(), np.zeros(len(self.atans)))

    def scalars(self, state, bias=True):
        """Values [s], derivatives [s x nf], rates [s] and second derivatives at constant velocities [s] of all scalars."""
        n, nv = len(self.names), len(self.vectors)
        r, R = state.r, state.R
        u = np.zeros(6 * n)
        u[self.free] = state.u
        u = u.reshape(n, 6)
        v, w = u[:, :3], np.einsum("pij,pj->pi", R, u[:, 3:])
        value, rate, second = np.zeros((nv, 3)), np.zeros((nv, 3)), np.zeros((nv, 3))
        J = np.zeros((nv, 3, 6 * n))
        if len(self._a):
            p = self._ap
            e = np.einsum("kij,kj->ki", R[p], self._ae)
            value[self._a] = e
            rate[self._a] = cross(w[p], e)
            second[self._a] = cross(w[p], rate[self._a])
            J[self._a3, self._w3, self._a_columns] = R[p] @ self._ae_skew
        for end, sign in ((0, -1.0), (1, 1.0)):
            if len(self._w) == 0:
                break
            p, s = self._wp[:, end], self._ws[:, end]
            arm = np.einsum("kij,kj->ki", R[p], s)
            swing = cross(w[p], arm)
            value[self._w] += sign * (r[p] + arm)
            rate[self._w] += sign * (v[p] + swing)
            second[self._w] += sign * cross(w[p], swing)
            for i in range(3):
                J[self._w, i, 6 * p + i] += sign
            J[self._w[:, None, None], self._w3, self._w_columns[:, end]] -= sign * R[p] @ self._ws_skew[:, end]
        J = J[:, :, self.free]
        a, b = self._da, self._db
        S = np.einsum("ki,ki->k", value[a], value[b])
        dS = np.einsum("kij,ki->kj", J[a], value[b]) + np.einsum("kij,ki->kj", J[b], value[a])
        S1 = np.einsum("ki,ki->k", rate[a], value[b]) + np.einsum("ki,ki->k", rate[b], value[a])
        S2 = (np.einsum("ki,ki->k", second[a], value[b]) + 2 * np.einsum("ki,ki->k", rate[a], rate[b])
              + np.einsum("ki,ki->k", second[b], value[a]))
        S, dS, S1, S2 = [S], [dS], [S1], [S2]
        if len(self._at):
            y, x = self._at[:, 0], self._at[:, 1]
            Y, X, Y1, X1, Y2, X2 = S[0][y], S[0][x], S1[0][y], S1[0][x], S2[0][y], S2[0][x]
            q = X * X + Y * Y
            angle = np.arctan2(Y, X)
            angle += 2 * np.pi * np.round((state.turns - angle) / (2 * np.pi))
            S.append(angle)
            dS.append((X[:, None] * dS[0][y] - Y[:, None] * dS[0][x]) / q[:, None])
            turn = (X * Y1 - Y * X1) / q
            S1.append(turn)
            S2.append((X * Y2 - Y * X2) / q - 2 * (X * X1 + Y * Y1) * turn / q)
        if len(self._rt):
            s = np.sqrt(S[0][self._rt])
            S.append(s)
            dS.append(dS[0][self._rt] / (2 * s[:, None]))
            S1.append(S1[0][self._rt] / (2 * s))
            S2.append(S2[0][self._rt] / (2 * s) - S1[0][self._rt] ** 2 / (4 * s**3))
        if len(self._tn):
            one, two = self._tn[:, 0], self._tn[:, 1]
            S.append(state.angle[two] - state.angle[one] - self.start_angle[two] + self.start_angle[one])
            line = np.zeros((len(one), 6 * n))
            line[np.arange(len(one)), 6 * two + 5] += 1
            line[np.arange(len(one)), 6 * one + 5] -= 1
            dS.append(line[:, self.free])
            S1.append(u[two, 5] - u[one, 5])
            S2.append(np.zeros(len(one)))
        return np.concatenate(S), np.concatenate(dS), np.concatenate(S1), np.concatenate(S2)


class State:
    """Where everything is: places [n, 3], quaternions [n, 4], velocities [nf], plane angles [n], counted turns, memories of laws."""

    def __init__(self, r, q, u, angle, turns, memories=None):
        self.r, self.q, self.u, self.angle, self.turns, self.memories = r, q, u, angle, turns, memories
        self.R = matrix_of(q)

    def copy(self):
        memories = None if self.memories is None else self.memories.copy()
        return State(self.r.copy(), self.q.copy(), self.u.copy(), self.angle.copy(), self.turns.copy(), memories)


def moved(model, state, dq):
    """The state after a small motion dq [nf] in (dr, rotation vector about the part's own axes)."""
    step = model.all_velocities(dq)
    q = product(state.q, quaternion_of(step[:, 3:]))
    q /= np.linalg.norm(q, axis=1)[:, None]
    out = State(state.r + step[:, :3], q, state.u.copy(), state.angle + step[:, 5] if not model.space else state.angle, state.turns.copy(),
                None if state.memories is None else state.memories.copy())
    if len(model.atans):
        out.turns = model.scalars(out)[0][model.first_atan : model.first_atan + len(model.atans)]
    return out
