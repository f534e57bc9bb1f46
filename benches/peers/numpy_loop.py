"""The paper's equations sample by sample: the decoder of eigen.cpp in NumPy, vectorised over the nine limbs only."""

import numpy as np

from protocol import CONVERGED_M, ITERATIONS, Array, Problem, serve


def cross(a: Array, b: Array) -> Array:
    """Of two vectors: np.cross takes 20 us for its checks."""
    return np.array(
        [
            a[1] * b[2] - a[2] * b[1],
            a[2] * b[0] - a[0] * b[2],
            a[0] * b[1] - a[1] * b[0],
        ]
    )


def exponential(phi: Array) -> Array:
    angle = np.sqrt(phi @ phi)
    if angle == 0.0:
        return np.eye(3)
    x, y, z = phi / angle
    k = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle) * k + (1.0 - np.cos(angle)) * (k @ k)


def limbs(p: Problem, r: Array, rotation: Array) -> tuple[Array, Array, Array]:
    """Directions e_i, moments t_i x e_i and lengths of the limbs."""
    t = p.t @ rotation.T
    limb = r + t - p.b
    length = np.sqrt((limb * limb).sum(axis=1))
    e = limb / length[:, None]
    return e, np.cross(t, e), length


def pose(p: Problem, elongation: Array, r: Array, phi: Array) -> tuple[Array, Array]:
    for _ in range(ITERATIONS):
        e, moment, length = limbs(p, r, exponential(phi))
        jacobian = np.hstack([e, moment])
        residual = p.length + elongation - length
        step = np.linalg.solve(jacobian.T @ jacobian, jacobian.T @ residual)
        r, phi = r + step[:3], phi + step[3:]
        if np.linalg.norm(step[:3]) + p.half_edge * np.linalg.norm(step[3:]) < CONVERGED_M:
            break
    return r, phi


def decode(p: Problem) -> Array:
    h = p.h
    rows = np.empty((len(p.voltage_v) - 2, 6))
    before = now = (np.zeros(3), np.zeros(3))
    now_force = np.zeros(9)
    attitude = p.attitude
    w = w_dot = np.zeros(3)
    for k, voltage in enumerate(p.voltage_v):
        # (10), (11), (2)
        force = p.sensitivity * (voltage - p.drift_v) + p.preload
        after = pose(p, -force / p.stiffness, *now)
        if k >= 2:
            (r0, phi0), (r, phi), (r1, phi1) = before, now, after
            v, a_r = (r1 - r0) / (2.0 * h), (r1 - 2.0 * r + r0) / (h * h)
            phi_dot, phi_ddot = (phi1 - phi0) / (2.0 * h), (phi1 - 2.0 * phi + phi0) / (h * h)
            w_r = phi_dot + 0.5 * cross(phi, phi_dot)
            eps = phi_ddot + 0.5 * cross(phi, phi_ddot)
            rotation = exponential(phi)
            e, moment, _ = limbs(p, r, rotation)
            force_sum, torque_sum = now_force @ e, now_force @ moment
            inertia = rotation @ p.inertia @ rotation.T
            inverse = np.linalg.inv(inertia)

            def rate_derivative(w: Array) -> Array:  # (8)
                total = w + w_r
                torque = torque_sum - cross(total, inertia @ total)
                return inverse @ torque - eps - cross(w, w_r)

            if k > 2:
                # (8) by Heun, (9) by the mean rate of the step
                w_next = w + 0.5 * h * (w_dot + rate_derivative(w + h * w_dot))
                attitude = attitude @ exponential(0.5 * h * (w + w_next))
                w = w_next
            w_dot = rate_derivative(w)
            # (3)
            a = force_sum - a_r - cross(w_dot, r) - cross(w, cross(w, r)) - 2.0 * cross(w, v)
            rows[k - 2, :3] = attitude @ a + p.gravity
            rows[k - 2, 3:] = attitude @ w_dot
        before, now, now_force = now, after, force
    return rows


if __name__ == "__main__":
    serve(decode)
