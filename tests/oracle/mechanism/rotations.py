"""Vectors, quaternions and rotation matrices, for many at once."""

import numpy as np

def skew(a):
    """[..., 3] -> [..., 3, 3], skew(a) b = a x b."""
    a = np.asarray(a, float)
    out = np.zeros(a.shape[:-1] + (3, 3))
    out[..., 0, 1], out[..., 0, 2] = -a[..., 2], a[..., 1]
    out[..., 1, 0], out[..., 1, 2] = a[..., 2], -a[..., 0]
    out[..., 2, 0], out[..., 2, 1] = -a[..., 1], a[..., 0]
    return out


def cross(a, b):
    out = np.empty(a.shape if a.ndim >= b.ndim else b.shape)
    out[..., 0] = a[..., 1] * b[..., 2] - a[..., 2] * b[..., 1]
    out[..., 1] = a[..., 2] * b[..., 0] - a[..., 0] * b[..., 2]
    out[..., 2] = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return out


def quaternion_of(vector):
    """The unit quaternion (w, x, y, z) of a rotation vector [..., 3]."""
    angle = np.linalg.norm(vector, axis=-1)[..., None]
    share = np.where(angle > 1e-9, np.sin(angle / 2) / np.where(angle > 1e-9, angle, 1), 0.5 - angle**2 / 48)
    return np.concatenate([np.cos(angle / 2), share * vector], axis=-1)


def product(p, q):
    """Hamilton's product of quaternions [..., 4]."""
    out = np.empty(np.broadcast_shapes(p.shape, q.shape))
    out[..., 0] = p[..., 0] * q[..., 0] - np.sum(p[..., 1:] * q[..., 1:], axis=-1)
    out[..., 1:] = p[..., :1] * q[..., 1:] + q[..., :1] * p[..., 1:] + cross(p[..., 1:], q[..., 1:])
    return out


def matrix_of(q):
    """The rotation matrices [..., 3, 3] of quaternions [..., 4], of any length."""
    q = q / np.linalg.norm(q, axis=-1)[..., None]
    w, v = q[..., 0, None, None], q[..., 1:]
    s = skew(v)
    return np.eye(3) + 2 * w * s + 2 * s @ s


def vector_of(q):
    """The rotation vector of the shortest turn, of unit quaternions [..., 4]."""
    q = np.where(q[..., :1] < 0, -q, q)
    length = np.linalg.norm(q[..., 1:], axis=-1)[..., None]
    angle = 2 * np.arctan2(length, q[..., :1])
    return np.where(length > 1e-12, angle / np.where(length > 1e-12, length, 1), 2.0) * q[..., 1:]


def unit(v):
    v = np.asarray(v, float)
    return v / np.linalg.norm(v)


def right_jacobian(psi):
    """omega = Jr(psi) psi' in the axes of exp(psi)."""
    angle = np.linalg.norm(psi, axis=-1)[..., None, None]
    s = skew(psi)
    small = angle < 1e-4
    safe = np.where(small, 1.0, angle)
    a = np.where(small, 0.5 - angle**2 / 24, (1 - np.cos(safe)) / safe**2)
    b = np.where(small, 1 / 6 - angle**2 / 120, (safe - np.sin(safe)) / safe**3)
    return np.eye(3) - a * s + b * s @ s


def inverse_right_jacobian(psi):
    angle = np.linalg.norm(psi, axis=-1)[..., None, None]
    s = skew(psi)
    small = angle < 1e-2
    safe = np.where(small, 1.0, angle)
    c = np.where(small, 1 / 12 + angle**2 / 720 + angle**4 / 30240, 1 / safe**2 - (1 + np.cos(safe)) / (2 * safe * np.sin(np.where(small, 1.0, safe))))
    return np.eye(3) + 0.5 * s + c * s @ s
