"""Matrices of straight beams and trusses in their local axes, by Gauss quadrature of the static shape functions.

Degrees of freedom: of each end x, y, rz in the plane and x, y, z, rx, ry, rz in space.
"""

import numpy

PLANE = ["x", "y", "rz"]
SPACE = ["x", "y", "z", "rx", "ry", "rz"]
_POINTS, _WEIGHTS = numpy.polynomial.legendre.leggauss(8)
_POINTS, _WEIGHTS = 0.5 * (_POINTS + 1), 0.5 * _WEIGHTS


def shapes(s, length, phi):
    """Deflection h, rotation theta, and their slopes h', theta', at x = s length of the exact static shapes
    (Przemieniecki 1968), over (v1, theta1, v2, theta2)."""
    c = 1 + phi
    h = numpy.array([2 * s**3 - 3 * s**2 - phi * s + c, length * (s**3 - (2 + phi / 2) * s**2 + (1 + phi / 2) * s),
                     -2 * s**3 + 3 * s**2 + phi * s, length * (s**3 - (1 - phi / 2) * s**2 - phi / 2 * s)]) / c
    dh = numpy.array([6 * s**2 - 6 * s - phi, length * (3 * s**2 - (4 + phi) * s + 1 + phi / 2),
                      -6 * s**2 + 6 * s + phi, length * (3 * s**2 - (2 - phi) * s - phi / 2)]) / c / length
    theta = numpy.array([6 * (s * s - s) / length, 3 * s * s - (4 + phi) * s + c,
                         -6 * (s * s - s) / length, 3 * s * s - (2 - phi) * s]) / c
    dtheta = numpy.array([6 * (2 * s - 1) / length, 6 * s - (4 + phi),
                          -6 * (2 * s - 1) / length, 6 * s - (2 - phi)]) / c / length
    return h, theta, dh, dtheta


def bending(length, bend, shear, line_mass, rotary, lumped):
    """Stiffness and mass [4 x 4] over (v1, theta1, v2, theta2); `bend` = E I, `shear` = kappa A G or None."""
    phi = 12 * bend / (shear * length**2) if shear else 0.0
    stiffness, translation, rotation = numpy.zeros((4, 4)), numpy.zeros((4, 4)), numpy.zeros((4, 4))
    for s, weight in zip(_POINTS, _WEIGHTS):
        h, theta, dh, dtheta = shapes(s, length, phi)
        stiffness += weight * length * bend * numpy.outer(dtheta, dtheta)
        if shear:
            stiffness += weight * length * shear * numpy.outer(dh - theta, dh - theta)
        translation += weight * length * line_mass * numpy.outer(h, h)
        rotation += weight * length * rotary * numpy.outer(theta, theta)
    if not lumped:
        return stiffness, translation + rotation
    scale = line_mass * length / (translation[0, 0] + translation[2, 2])
    return stiffness, numpy.diag([line_mass * length / 2, scale * translation[1, 1] + rotary * length / 2,
                                  line_mass * length / 2, scale * translation[3, 3] + rotary * length / 2])


def two_ends(stretch, line, length, lumped):
    """Linear functions over both ends: stretching or twisting."""
    mass = line * length * (numpy.eye(2) / 2 if lumped else numpy.array([[2, 1], [1, 2]]) / 6)
    return stretch / length * numpy.array([[1.0, -1.0], [-1.0, 1.0]]), mass


def beam(space, length, material, section, shear_flexible, lumped):
    """Stiffness and mass in local axes [6 x 6] or [12 x 12]."""
    n = 6 if space else 3
    stiffness, mass = numpy.zeros((2 * n, 2 * n)), numpy.zeros((2 * n, 2 * n))
    e, rho, area = material["young"], material["density"], section["area"]

    def add(rows, signs, matrices):
        t = numpy.zeros((len(rows), 2 * n))
        for i, (row, sign) in enumerate(zip(rows, signs)):
            t[i, row] = sign
        stiffness[:] += t.T @ matrices[0] @ t
        mass[:] += t.T @ matrices[1] @ t
    add([0, n], [1, 1], two_ends(e * area, rho * area, length, lumped))

    def bend(inertia, factor):
        shear = factor * area * material["shear_modulus"] if shear_flexible else None
        return bending(length, e * inertia, shear, rho * area, rho * inertia if shear_flexible else 0.0, lumped)
    if not space:
        add([1, 2, 4, 5], [1, 1, 1, 1], bend(section["inertia"][0], section["shear_factor"][0]))
        return stiffness, mass
    iy, iz = section["inertia"]
    add([1, 5, 7, 11], [1, 1, 1, 1], bend(iz, section["shear_factor"][0]))
    add([2, 4, 8, 10], [1, -1, 1, -1], bend(iy, section["shear_factor"][1]))  # dw/dx = -ry
    add([3, 9], [1, 1], two_ends(material["shear_modulus"] * section["torsion"], rho * (iy + iz), length, lumped))
    return stiffness, mass


def truss(space, length, material, section, lumped):
    n = 6 if space else 3
    stiffness, mass = numpy.zeros((2 * n, 2 * n)), numpy.zeros((2 * n, 2 * n))
    k, m = two_ends(material["young"] * section["area"], material["density"] * section["area"], length, lumped)
    stiffness[numpy.ix_([0, n], [0, n])] = k
    for direction in range(3 if space else 2):
        mass[numpy.ix_([direction, n + direction], [direction, n + direction])] = m
    return stiffness, mass


def even_load(space, length, force, is_truss, phi_y, phi_z):
    """What an even force per length in local axes does to the ends: the integral of the shapes."""
    n = 6 if space else 3
    f = numpy.zeros(2 * n)
    for direction in range(3 if space else 2):
        f[direction] = f[n + direction] = force[direction] * length / 2
    if not is_truss:
        for s, weight in zip(_POINTS, _WEIGHTS):
            h = shapes(s, length, phi_y)[0]
            f[n - 1] += weight * length * force[1] * h[1]
            f[2 * n - 1] += weight * length * force[1] * h[3]
            if space:
                h = shapes(s, length, phi_z)[0]
                f[4] -= weight * length * force[2] * h[1]
                f[10] -= weight * length * force[2] * h[3]
    return f


def axes(first, second, orientation):
    """Rows: the local axes in those of the model."""
    x = (second - first) / numpy.linalg.norm(second - first)
    if len(first) == 2:
        return numpy.array([x, [-x[1], x[0]]])
    along = numpy.array([0.0, 0.0, 1.0]) if orientation is None else orientation
    z = numpy.cross(x, along)
    if numpy.linalg.norm(z) < 1e-9 * numpy.linalg.norm(along):
        z = numpy.cross(x, [1.0, 0.0, 0.0])  # a vertical beam, the same about both axes
    z /= numpy.linalg.norm(z)
    return numpy.array([x, numpy.cross(z, x), z])


def turn(space, rows):
    """The matrix that takes displacements of both ends from the axes of the model to the local ones."""
    if not space:
        t = numpy.eye(6)
        t[0:2, 0:2] = t[3:5, 3:5] = rows
        return t
    t = numpy.zeros((12, 12))
    for i in range(0, 12, 3):
        t[i:i + 3, i:i + 3] = rows
    return t


def released_shape(stiffness, released):
    """T [all x kept] by which the released degrees of freedom follow the kept ones without resistance."""
    n = len(stiffness)
    kept = [i for i in range(n) if i not in released]
    t = numpy.zeros((n, len(kept)))
    t[kept, range(len(kept))] = 1.0
    inner = stiffness[numpy.ix_(released, released)]
    t[released, :] = -numpy.linalg.solve(inner, stiffness[numpy.ix_(released, kept)])
    return t, kept
