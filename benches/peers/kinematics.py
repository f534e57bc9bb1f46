"""What needs no integration, for the whole record at once: what the vectorised peers share."""

from dataclasses import dataclass

import numpy as np

from protocol import CONVERGED_M, ITERATIONS, Array, Problem


@dataclass(frozen=True)
class Sensed:
    """What the limbs say at the decoupled samples: everything in (3) and (8) but w*."""

    r: Array  # (n, 3)
    v: Array
    a_r: Array
    w_r: Array
    eps: Array
    force: Array
    torque: Array
    inertia: Array  # (n, 3, 3)
    inverse: Array


def exponential(phi: Array) -> Array:
    """Rotations (..., 3, 3) of rotation vectors (..., 3)."""
    angle = np.linalg.norm(phi, axis=-1)[..., None, None]
    k = np.zeros((*phi.shape, 3))
    k[..., 2, 1], k[..., 0, 2], k[..., 1, 0] = phi[..., 0], phi[..., 1], phi[..., 2]
    k -= np.swapaxes(k, -1, -2)
    return (
        np.eye(3) + np.sinc(angle / np.pi) * k + 0.5 * np.sinc(angle / (2 * np.pi)) ** 2 * (k @ k)
    )


def limbs(p: Problem, r: Array, rotation: Array) -> tuple[Array, Array, Array]:
    """Directions (n, 9, 3), moments (n, 9, 3) and lengths (n, 9) of the limbs."""
    t = p.t @ np.swapaxes(rotation, -1, -2)
    limb = r[:, None, :] + t - p.b
    length = np.sqrt(np.einsum("nij,nij->ni", limb, limb))
    e = limb / length[..., None]
    return e, np.cross(t, e), length


def poses(p: Problem, elongation: Array) -> tuple[Array, Array]:
    """Gauss-Newton from the unloaded pose, all samples together until the last has converged."""
    r = np.zeros((len(elongation), 3))
    phi = np.zeros_like(r)
    for _ in range(ITERATIONS):
        e, moment, length = limbs(p, r, exponential(phi))
        jacobian = np.concatenate([e, moment], axis=2)
        transposed = np.swapaxes(jacobian, 1, 2)
        residual = p.length + elongation - length
        step = np.linalg.solve(transposed @ jacobian, transposed @ residual[..., None])[..., 0]
        r, phi = r + step[:, :3], phi + step[:, 3:]
        size = np.linalg.norm(step[:, :3], axis=1)
        size += p.half_edge * np.linalg.norm(step[:, 3:], axis=1)
        if size.max() < CONVERGED_M:
            break
    return r, phi


def sense(p: Problem) -> Sensed:
    # (10), (11), (2)
    force = p.sensitivity * (p.voltage_v - p.drift_v) + p.preload
    r, phi = poses(p, -force / p.stiffness)

    def derivatives(x: Array) -> tuple[Array, Array]:
        after, now, before = x[2:], x[1:-1], x[:-2]
        return (after - before) / (2.0 * p.h), (after - 2.0 * now + before) / (p.h * p.h)

    v, a_r = derivatives(r)
    phi_dot, phi_ddot = derivatives(phi)
    r, phi, force = r[1:-1], phi[1:-1], force[1:-1]
    rotation = exponential(phi)
    e, moment, _ = limbs(p, r, rotation)
    inertia = rotation @ p.inertia @ np.swapaxes(rotation, 1, 2)
    inverse = np.linalg.inv(inertia)
    return Sensed(
        r=r,
        v=v,
        a_r=a_r,
        w_r=phi_dot + 0.5 * np.cross(phi, phi_dot),
        eps=phi_ddot + 0.5 * np.cross(phi, phi_ddot),
        force=np.einsum("ni,nij->nj", force, e),
        torque=np.einsum("ni,nij->nj", force, moment),
        inertia=inertia,
        inverse=inverse,
    )


def turn(matrices: Array, vectors: Array) -> Array:
    return np.einsum("nij,nj->ni", matrices, vectors)


def rate_derivative(s: Sensed, w: Array) -> Array:
    """(8) at every sample."""
    total = w + s.w_r
    torque = s.torque - np.cross(total, turn(s.inertia, total))
    return turn(s.inverse, torque) - s.eps - np.cross(w, s.w_r)


def attitudes(p: Problem, w: Array) -> Array:
    """(9) by the mean rate of each step; a running product in log2(n) passes, not n steps."""
    turns = np.empty((len(w), 3, 3))
    turns[0] = p.attitude
    turns[1:] = exponential(0.5 * p.h * (w[:-1] + w[1:]))
    span = 1
    while span < len(turns):
        turns[span:] = turns[:-span] @ turns[span:]
        span *= 2
    return turns


def accelerations(p: Problem, s: Sensed, w: Array, attitude: Array) -> Array:
    """(3) and the angular acceleration, ground axes."""
    w_dot = rate_derivative(s, w)
    a = (
        s.force
        - s.a_r
        - np.cross(w_dot, s.r)
        - np.cross(w, np.cross(w, s.r))
        - 2.0 * np.cross(w, s.v)
    )
    return np.hstack([turn(attitude, a) + p.gravity, turn(attitude, w_dot)])
