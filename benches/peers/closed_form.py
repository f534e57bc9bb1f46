"""The decoder of closed_form.cpp in Python: formulas over numbers, which numba compiles and NumPy and JAX take whole records through.

A vector is a tuple of three numbers, or of three arrays with one number a sample. The unit of length is the limb length, that of
time the sample interval.
"""

import math
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from protocol import Problem

Number: TypeAlias = Any  # float, NumPy's array or JAX's
Vec: TypeAlias = tuple[Number, Number, Number]
Quaternion: TypeAlias = tuple[Number, Vec]


class Constants(NamedTuple):
    slope: tuple[float, ...]  # nine, strain per volt
    zero: tuple[float, ...]  # nine, strain at zero volt
    nu: float  # n/L
    inverse_nu: float
    chi: float  # force per mass of a limb of unit strain
    torque: tuple[Vec, Vec, Vec]  # rows: torque over chi nu to one over the moments, principal axes
    to_mass: tuple[Vec, Vec, Vec]  # rows: principal axes to mass axes
    to_principal: tuple[Vec, Vec, Vec]
    gyro: Vec  # (I2 - I3)/I1 and cyclic
    gravity: Vec  # m/s^2
    per_s2: float  # 1/h^2
    m_per_s2: float  # L/h^2
    attitude: Quaternion  # at the first decoupled sample


class Placed(NamedTuple):
    """What the voltages say of a sample."""

    r3: Vec  # three times the position of the mass in the shell
    phi: Vec  # its rotation vector
    force: Vec  # sum of the limb forces over chi, shell axes
    torque: Vec  # of the limb forces, over the principal moments, principal axes


def constants(p: Problem) -> Constants:
    strain_per_force = -1.0 / (p.stiffness * p.length)  # a limb that pushes is shorter
    nu = p.half_edge / p.length
    chi = p.h * p.h / (p.length * strain_per_force)
    moments, axes = np.linalg.eigh(p.inertia / (p.length * p.length))
    if np.linalg.det(axes) < 0.0:
        axes[:, 2] *= -1.0
    r = p.attitude
    w = 0.5 * math.sqrt(1.0 + np.trace(r))
    v = np.array([r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]]) / (4.0 * w)

    def rows(matrix: Any) -> Any:
        return tuple(tuple(row) for row in matrix.tolist())

    return Constants(
        slope=tuple((p.sensitivity * strain_per_force).tolist()),
        zero=tuple(((p.preload - p.sensitivity * p.drift_v) * strain_per_force).tolist()),
        nu=nu,
        inverse_nu=1.0 / nu,
        chi=chi,
        torque=rows(axes.T * (chi * nu / moments)[:, None]),
        to_mass=rows(axes),
        to_principal=rows(axes.T),
        gyro=tuple(((np.roll(moments, -1) - np.roll(moments, -2)) / moments).tolist()),
        gravity=tuple(p.gravity.tolist()),
        per_s2=1.0 / (p.h * p.h),
        m_per_s2=p.length / (p.h * p.h),
        attitude=(w, tuple(v.tolist())),
    )


def add(a: Vec, b: Vec) -> Vec:
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def sub(a: Vec, b: Vec) -> Vec:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def times(s: Number, a: Vec) -> Vec:
    return s * a[0], s * a[1], s * a[2]


def dot(a: Vec, b: Vec) -> Number:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vec, b: Vec) -> Vec:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def apply(m: tuple[Vec, Vec, Vec], v: Vec) -> Vec:
    return dot(m[0], v), dot(m[1], v), dot(m[2], v)


def node(x: Number, y: Number, z: Number) -> tuple[Vec, Vec]:
    """Displacement of a node along its limbs and the force there over chi, from its three strains."""
    xx, yy, zz = x * x, y * y, z * z
    a, b = xx + yy + zz, x + y + z
    half_s = 0.5 * (a - a * b + (x * xx + y * yy + z * zz))
    u, v, w = 0.5 * xx - half_s, 0.5 * yy - half_s, 0.5 * zz - half_s
    p, q, r = x + u, y + v, z + w
    others = b - a
    force = (
        x + x * u + p * (others - (x - xx)),
        y + y * v + q * (others - (y - yy)),
        z + z * w + r * (others - (z - zz)),
    )
    return (p, q, r), force


def place(k: Constants, volts: Number) -> Placed:
    """(1), (2), (10), (11), the pose in closed form and the sums of (3) and (8)."""
    s, o, u = k.slope, k.zero, volts
    # Directions (5); the nodes are on the z, y and x axis.
    p, f = node(s[0] * u[0] + o[0], s[1] * u[1] + o[1], s[2] * u[2] + o[2])
    p1, f1 = (-p[2], -p[1], p[0]), (-f[2], -f[1], f[0])
    p, f = node(s[3] * u[3] + o[3], s[4] * u[4] + o[4], s[5] * u[5] + o[5])
    p2, f2 = (-p[2], p[1], -p[0]), (-f[2], f[1], -f[0])
    p, f = node(s[6] * u[6] + o[6], s[7] * u[7] + o[7], s[8] * u[8] + o[8])
    p3, f3 = (p[2], -p[1], -p[0]), (f[2], -f[1], -f[0])

    # The rotation that fits the nodes best: linear in the displacements, then what R_r - 1 has beyond phi x.
    third, sixth = 1.0 / 3.0, 1.0 / 6.0
    every = add(add(p1, p2), p3)
    mx = p1[1] - p2[2] + third * (every[2] - every[1])
    my = p3[2] - p1[0] + third * (every[0] - every[2])
    mz = p2[0] - p3[1] + third * (every[1] - every[0])
    mean = sixth * (mx + my + mz)
    linear = times(k.inverse_nu, (mx - mean, my - mean, mz - mean))
    x, y, z = linear
    total = x + y + z
    c = sixth * total
    cc = c * c
    bend, keep = cc * total, 1.0 - 3.0 * cc
    arc = (
        keep * x + c * (z - y) + bend,
        keep * y + c * (x - z) + bend,
        keep * z + c * (y - x) + bend,
    )
    phi = add(arc, times(sixth * dot(linear, linear), linear))
    x, y, z = arc
    leaning = (1.0 + 0.5 * (y - z), 1.0 + 0.5 * (z - x), 1.0 + 0.5 * (x - y))
    r3 = add(every, times(k.nu, cross(arc, leaning)))

    # sum t_j x R_r^T F_j over the half edge, to the second power of phi.
    t = (f1[1] - f2[2], f3[2] - f1[0], f2[0] - f3[1])
    turned_force = add(times(phi[0], f3), add(times(phi[1], f2), times(phi[2], f1)))
    along = f3[0] + f2[1] + f1[2] - 0.5 * dot(phi, t)
    torque = sub(add(t, times(along, phi)), turned_force)
    torque = add(torque, times(0.5, cross(phi, turned_force)))
    return Placed(r3, phi, add(add(f1, f2), f3), apply(k.torque, torque))


def euler(k: Constants, w: Vec, torque: Vec) -> Vec:
    """(8) for the rate of the mass in principal axes: the relative acceleration drops out of it."""
    g = k.gyro
    return (
        g[0] * w[1] * w[2] + torque[0],
        g[1] * w[2] * w[0] + torque[1],
        g[2] * w[0] * w[1] + torque[2],
    )


def heun(k: Constants, spin: Vec, slope: Vec, torque: Vec) -> tuple[Vec, Vec]:
    """One step of (8): the rate reached and its derivative."""
    spin = add(spin, times(0.5, add(slope, euler(k, add(spin, slope), torque))))
    return spin, euler(k, spin, torque)


def turned(phi: Vec, v: Vec) -> Vec:
    """R v for the rotation vector phi, to its second power."""
    return add(v, cross(phi, add(v, times(0.5, cross(phi, v)))))


def relative_rate(before: Placed, now: Placed, after: Placed) -> Vec:
    d = times(0.5, sub(after.phi, before.phi))
    return add(d, times(0.5, cross(now.phi, d)))


def spin_at_rest(k: Constants, before: Placed, now: Placed, after: Placed) -> Vec:
    """Rate of the mass in principal axes while the shell does not turn."""
    back = times(-1.0, now.phi)
    return apply(k.to_principal, turned(back, relative_rate(before, now, after)))


def motion(
    k: Constants, before: Placed, now: Placed, after: Placed, spin: Vec, spin_dot: Vec
) -> tuple[Vec, Vec, Vec]:
    """w*, w*' and, by (3), R^T (a - g)."""
    phi, r = now.phi, now.r3
    w_r = relative_rate(before, now, after)
    second = sub(add(after.phi, before.phi), times(2.0, phi))
    eps = add(second, times(0.5, cross(phi, second)))
    w = sub(turned(phi, apply(k.to_mass, spin)), w_r)
    w_dot = add(sub(turned(phi, apply(k.to_mass, spin_dot)), eps), cross(w_r, w))
    relative = sub(add(after.r3, before.r3), times(2.0, r))
    inner = add(cross(w, r), sub(after.r3, before.r3))
    carried = add(add(relative, cross(w, inner)), cross(w_dot, r))
    return w, w_dot, sub(times(k.chi, now.force), times(1.0 / 3.0, carried))


def step_of_attitude(w0: Vec, w0_dot: Vec, w: Vec, w_dot: Vec) -> Quaternion:
    """(9) over one step to fourth order: Hermite's quadrature of the rate and the coning term."""
    small = add(cross(w0, w), sub(w0_dot, w_dot))
    half = add(times(0.25, add(w0, w)), times(1.0 / 24.0, small))
    z = dot(half, half)
    sinc = 1.0 + z * (-1.0 / 6.0 + z * (1.0 / 120.0 - z * (1.0 / 5040.0)))
    cosine = 1.0 + z * (-0.5 + z * (1.0 / 24.0 - z * (1.0 / 720.0)))
    return cosine, times(sinc, half)


def multiply(p: Quaternion, q: Quaternion) -> Quaternion:
    (pw, pv), (qw, qv) = p, q
    v = add(add(times(pw, qv), times(qw, pv)), cross(pv, qv))
    return pw * qw - dot(pv, qv), v


def follow(q: Quaternion, step: Quaternion) -> Quaternion:
    """The next attitude, its length brought back to one."""
    qw, qv = q
    unit = 1.5 - 0.5 * (qw * qw + dot(qv, qv))
    return multiply((unit * qw, times(unit, qv)), step)


def ground(k: Constants, q: Quaternion, force: Vec, w_dot: Vec) -> tuple[Vec, Vec]:
    """Linear and angular acceleration, SI, ground axes."""
    qw, qv = q
    twice = add(qv, qv)
    a = add(force, cross(twice, add(times(qw, force), cross(qv, force))))
    b = add(w_dot, cross(twice, add(times(qw, w_dot), cross(qv, w_dot))))
    return add(times(k.m_per_s2, a), k.gravity), times(k.per_s2, b)


# What a whole record is taken through at once: the samples that are decoupled, their neighbours, and the steps between them.


def neighbours(k: Constants, volts: Number) -> list[Placed]:
    """Placements before, at and after the decoupled samples, from voltages (n, 9)."""
    placed = place(k, volts.T)
    samples = len(volts)
    return [
        Placed(*(tuple(x[i : samples - 2 + i] for x in vector) for vector in placed))
        for i in range(3)
    ]


def steps(w: Vec, w_dot: Vec) -> Quaternion:
    early, late = slice(None, -1), slice(1, None)
    w0, w1 = (tuple(x[part] for x in w) for part in (early, late))
    d0, d1 = (tuple(x[part] for x in w_dot) for part in (early, late))
    return step_of_attitude(w0, d0, w1, d1)
