"""Kinematics vectorised over the record; Heun on (8), which cannot be, over Python floats."""

import numpy as np

from kinematics import Sensed, accelerations, attitudes, sense
from protocol import Array, Problem, serve


def rates(p: Problem, s: Sensed) -> Array:
    """w* at every sample, by Heun on (8)."""

    def derivative(k: int, x: float, y: float, z: float) -> tuple[float, float, float]:
        (rx, ry, rz), (tx, ty, tz), (ex, ey, ez) = w_r[k], torque[k], eps[k]
        xx, xy, xz, _, yy, yz, _, _, zz = inertia[k]
        ixx, ixy, ixz, _, iyy, iyz, _, _, izz = inverse[k]
        ux, uy, uz = x + rx, y + ry, z + rz
        lx = xx * ux + xy * uy + xz * uz
        ly = xy * ux + yy * uy + yz * uz
        lz = xz * ux + yz * uy + zz * uz
        mx = tx - (uy * lz - uz * ly)
        my = ty - (uz * lx - ux * lz)
        mz = tz - (ux * ly - uy * lx)
        return (
            ixx * mx + ixy * my + ixz * mz - ex - (y * rz - z * ry),
            ixy * mx + iyy * my + iyz * mz - ey - (z * rx - x * rz),
            ixz * mx + iyz * my + izz * mz - ez - (x * ry - y * rx),
        )

    # Lists of floats: taking one number from an array costs more than the arithmetic done with it.
    w_r, torque, eps = s.w_r.tolist(), s.torque.tolist(), s.eps.tolist()
    inertia, inverse = s.inertia.reshape(-1, 9).tolist(), s.inverse.reshape(-1, 9).tolist()
    h = p.h
    x = y = z = 0.0
    w = [(x, y, z)]
    fx, fy, fz = derivative(0, x, y, z)
    for k in range(1, len(torque)):
        gx, gy, gz = derivative(k, x + h * fx, y + h * fy, z + h * fz)
        x += 0.5 * h * (fx + gx)
        y += 0.5 * h * (fy + gy)
        z += 0.5 * h * (fz + gz)
        w.append((x, y, z))
        fx, fy, fz = derivative(k, x, y, z)
    return np.array(w)


def decode(p: Problem) -> Array:
    s = sense(p)
    w = rates(p, s)
    return accelerations(p, s, w, attitudes(p, w))


if __name__ == "__main__":
    serve(decode)
