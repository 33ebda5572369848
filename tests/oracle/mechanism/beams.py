"""Strains of geometrically exact beams and their derivatives."""

import numpy as np

from mechanism.rotations import inverse_right_jacobian, matrix_of, product, quaternion_of, right_jacobian, skew, vector_of

class Beams:
    def _freeze_beams(self):
        self.bp = np.array([b["parts"] for b in self.beams])
        self.bL = np.array([b["L"] for b in self.beams])
        self.bC = np.array([b["C"] for b in self.beams])
        self.btau = np.array([b["tau"] for b in self.beams])
        self.bR0 = np.array([b["axes"] for b in self.beams])
        if not self.space:
            self.bC[:, 2:5] = 0.0

    def beam_state(self, state, u=None):
        """Strains [b, 6] (stretch, shears, twist, bends), their derivatives [b, 6, 12] by (r', omega) of both ends, rates."""
        p, q = self.bp[:, 0], self.bp[:, 1]
        L = self.bL[:, None]
        R1, R0 = state.R[p], self.bR0
        T = lambda m: np.swapaxes(m, 1, 2)
        back = state.q[p] * np.array([1.0, -1, -1, -1])
        relative = vector_of(product(back, state.q[q])) if self.space else np.zeros((len(p), 3))
        if not self.space:
            relative[:, 2] = state.angle[q] - state.angle[p]
        half = matrix_of(quaternion_of(relative / 2))
        Rm = R1 @ half @ R0                                # axes of the section in the middle
        d = state.r[q] - state.r[p]
        gamma = np.einsum("bji,bj->bi", Rm, d) / L - np.array([1.0, 0, 0])
        kappa = np.einsum("bji,bj->bi", R0, relative) / L
        # psi' = Jr^-1 omega2 - Jl^-1 omega1, omega of the middle = exp(-psi/2) omega1 + Jr(psi/2) psi'/2, in the axes of R1 half
        inv_r, inv_l = inverse_right_jacobian(relative), inverse_right_jacobian(-relative)
        jr = right_jacobian(relative / 2)
        mid1 = T(half) - jr @ inv_l / 2
        mid2 = jr @ inv_r / 2
        B = np.zeros((len(p), 6, 12))
        B[:, :3, 0:3] = -T(Rm) / L[:, :, None]
        B[:, :3, 6:9] = T(Rm) / L[:, :, None]
        whole = gamma + np.array([1.0, 0, 0])
        B[:, :3, 3:6] = skew(whole) @ T(R0) @ mid1
        B[:, :3, 9:12] = skew(whole) @ T(R0) @ mid2
        B[:, 3:, 3:6] = -T(R0) @ inv_l / L[:, :, None]
        B[:, 3:, 9:12] = T(R0) @ inv_r / L[:, :, None]
        strain = np.concatenate([gamma, kappa], axis=1)
        if u is None:
            u = self.all_velocities(state.u)
        ends = np.concatenate([u[p], u[q]], axis=1)
        return strain, B, np.einsum("bij,bj->bi", B, ends)
