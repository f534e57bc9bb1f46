"""The paper's equations sample by sample on small arrays, compiled by numba.

numpy_loop.py with its loops spelt out.
"""

import numpy as np
from numba import njit

from protocol import CONVERGED_M, ITERATIONS, Array, Problem, serve


@njit
def cross(a: Array, b: Array) -> Array:
    c = np.empty(3)
    c[0] = a[1] * b[2] - a[2] * b[1]
    c[1] = a[2] * b[0] - a[0] * b[2]
    c[2] = a[0] * b[1] - a[1] * b[0]
    return c


@njit
def exponential(phi: Array) -> Array:
    angle = np.sqrt(np.dot(phi, phi))
    rotation = np.eye(3)
    if angle > 0.0:
        x, y, z = phi / angle
        k = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
        rotation += np.sin(angle) * k + (1.0 - np.cos(angle)) * np.dot(k, k)
    return rotation


@njit
def pose(
    elongation: Array, r: Array, phi: Array, t: Array, b: Array, length: float, half_edge: float
) -> tuple[Array, Array]:
    jacobian = np.empty((9, 6))
    residual = np.empty(9)
    for _ in range(ITERATIONS):
        rotation = exponential(phi)
        for i in range(9):
            arm = np.dot(rotation, t[i])
            limb = r + arm - b[i]
            now = np.sqrt(np.dot(limb, limb))
            e = limb / now
            jacobian[i, :3] = e
            jacobian[i, 3:] = cross(arm, e)
            residual[i] = length + elongation[i] - now
        step = np.linalg.solve(np.dot(jacobian.T, jacobian), np.dot(jacobian.T, residual))
        r, phi = r + step[:3], phi + step[3:]
        if np.linalg.norm(step[:3]) + half_edge * np.linalg.norm(step[3:]) < CONVERGED_M:
            break
    return r, phi


@njit
def rate_derivative(
    w: Array, torque: Array, w_r: Array, eps: Array, inertia: Array, inverse: Array
) -> Array:
    """(8)"""
    total = w + w_r
    moment = torque - cross(total, np.dot(inertia, total))
    return np.dot(inverse, moment) - eps - cross(w, w_r)


@njit
def run(
    voltage: Array,
    drift: Array,
    sensitivity: Array,
    preload: Array,
    stiffness: float,
    t: Array,
    b: Array,
    length: float,
    half_edge: float,
    inertia_mass: Array,
    gravity: Array,
    attitude: Array,
    h: float,
) -> Array:
    rows = np.empty((len(voltage) - 2, 6))
    r0, phi0 = np.zeros(3), np.zeros(3)
    r, phi = np.zeros(3), np.zeros(3)
    now_force = np.zeros(9)
    w, w_dot = np.zeros(3), np.zeros(3)
    for k in range(len(voltage)):
        # (10), (11), (2)
        force = sensitivity * (voltage[k] - drift) + preload
        r1, phi1 = pose(-force / stiffness, r, phi, t, b, length, half_edge)
        if k >= 2:
            v, a_r = (r1 - r0) / (2.0 * h), (r1 - 2.0 * r + r0) / (h * h)
            phi_dot, phi_ddot = (phi1 - phi0) / (2.0 * h), (phi1 - 2.0 * phi + phi0) / (h * h)
            w_r = phi_dot + 0.5 * cross(phi, phi_dot)
            eps = phi_ddot + 0.5 * cross(phi, phi_ddot)
            rotation = exponential(phi)
            force_sum, torque_sum = np.zeros(3), np.zeros(3)
            for i in range(9):
                arm = np.dot(rotation, t[i])
                limb = r + arm - b[i]
                e = limb / np.sqrt(np.dot(limb, limb))
                force_sum += now_force[i] * e
                torque_sum += now_force[i] * cross(arm, e)
            inertia = np.dot(np.dot(rotation, inertia_mass), rotation.T)
            inverse = np.linalg.inv(inertia)
            if k > 2:
                # (8) by Heun, (9) by the mean rate of the step
                f1 = rate_derivative(w + h * w_dot, torque_sum, w_r, eps, inertia, inverse)
                w_next = w + 0.5 * h * (w_dot + f1)
                attitude = np.dot(attitude, exponential(0.5 * h * (w + w_next)))
                w = w_next
            w_dot = rate_derivative(w, torque_sum, w_r, eps, inertia, inverse)
            # (3)
            a = force_sum - a_r - cross(w_dot, r) - cross(w, cross(w, r)) - 2.0 * cross(w, v)
            rows[k - 2, :3] = np.dot(attitude, a) + gravity
            rows[k - 2, 3:] = np.dot(attitude, w_dot)
        r0, phi0, r, phi, now_force = r, phi, r1, phi1, force
    return rows


def decode(p: Problem) -> Array:
    return run(
        p.voltage_v,
        p.drift_v,
        p.sensitivity,
        p.preload,
        p.stiffness,
        p.t,
        p.b,
        p.length,
        p.half_edge,
        p.inertia,
        p.gravity,
        p.attitude,
        p.h,
    )


if __name__ == "__main__":
    serve(decode)
