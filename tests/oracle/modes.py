"""Natural modes: `scipy.linalg.eigh` and, with damping, `eig` of the first-order form in modal coordinates."""

import numpy
import scipy.linalg


def free_part(model):
    moved = [i for i, _ in model.moving]
    return [i for i in range(len(model.names)) if i not in moved]


def matrices(model, limit):
    f = free_part(model)
    pick = numpy.ix_(f, f)
    stiffness, damping = model.tangents()
    stiffness = stiffness if limit == "free" else model.stuck_stiffness()
    return model.M[pick], damping[pick], stiffness[pick], f


def eigenvalues(model, limit):
    """omega [n] of the undamped modes, and all s [2n] of (s^2 M + s C + K) x = 0."""
    mass, damping, stiffness, _ = matrices(model, limit)
    # balanced by the diagonal of the mass, so that units and light parts do not matter
    scale = 1 / numpy.sqrt(numpy.diag(mass))
    mass, damping, stiffness = (m * scale[:, None] * scale[None, :] for m in (mass, damping, stiffness))
    squares, phi = scipy.linalg.eigh(stiffness, mass)
    omega = numpy.sqrt(numpy.maximum(squares, 0.0))
    low = _from_below(mass, stiffness)
    if low is not None:  # the lowest modes, where stiffness is badly scaled, from the inverse problem
        few = low < 1e-4 * omega[-1]
        omega[few] = low[few]
        squares = numpy.where(few, omega**2, squares)
    c = phi.T @ damping @ phi
    n = len(omega)
    # state (w eta, eta'), w = max(omega, 1e-4 of the mean): rigid motions keep their place
    reference = numpy.maximum(omega, 1e-4 * max(numpy.median(omega), 1e-300))
    a = numpy.zeros((2 * n, 2 * n))
    a[:n, n:] = numpy.diag(reference)
    a[n:, :n] = -numpy.diag(squares / reference)
    a[n:, n:] = -c
    return omega, numpy.linalg.eigvals(a)


def _from_below(mass, stiffness):
    scale = 1 / numpy.sqrt(numpy.maximum(numpy.diag(stiffness), 1e-300))
    try:
        inverse = scipy.linalg.eigh(mass * scale[:, None] * scale[None, :], stiffness * scale[:, None] * scale[None, :],
                                    eigvals_only=True)
    except numpy.linalg.LinAlgError:
        return None
    return 1 / numpy.sqrt(numpy.maximum(inverse[::-1], 1e-300))


def residual(model, limit, s, shape):
    """|(s^2 M + s C + K) x| row by row, over 1e-8 of the inertia of a shape of unit mass and 1e-12 of the terms of the
    row: at most 1, however badly the rows are scaled."""
    mass, damping, stiffness, f = matrices(model, limit)
    x = shape[f]
    terms = (abs(s)**2 * numpy.abs(mass) @ numpy.abs(x) + abs(s) * numpy.abs(damping) @ numpy.abs(x)
             + numpy.abs(stiffness) @ numpy.abs(x))
    left = numpy.abs(s * s * (mass @ x) + s * (damping @ x) + stiffness @ x)
    root = numpy.sqrt(numpy.diag(mass))
    if abs(s)**2 < 1e-13 * numpy.max(numpy.diag(stiffness) / root**2):  # rigid: what does not move does so to round-off
        terms = terms + 1e-3 * numpy.abs(stiffness) @ (numpy.max(numpy.abs(x) * root) / root)
    return numpy.max(left / (1e-8 * abs(s)**2 * numpy.sqrt(numpy.diag(mass)) + 1e-12 * terms + 1e-300))
