"""Kinematics vectorised over the record; (8) by SciPy's solve_ivp (RK45) on cubic splines."""

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

from kinematics import Sensed, accelerations, attitudes, sense
from protocol import Array, Problem, serve

RELATIVE_TOLERANCE = 1e-8
ABSOLUTE_TOLERANCE = 1e-8  # rad/s


def cross(a: Array, b: Array) -> Array:
    (ax, ay, az), (bx, by, bz) = a, b
    return np.array([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])


def rates(p: Problem, s: Sensed) -> Array:
    times = p.h * np.arange(len(s.torque))
    known = [s.torque, s.w_r, s.eps, s.inertia.reshape(-1, 9), s.inverse.reshape(-1, 9)]
    spline = CubicSpline(times, np.hstack(known))

    def derivative(time: float, w: Array) -> Array:
        now = spline(time)
        torque, w_r, eps = now[0:3], now[3:6], now[6:9]
        inertia, inverse = now[9:18].reshape(3, 3), now[18:27].reshape(3, 3)
        total = w + w_r
        return inverse @ (torque - cross(total, inertia @ total)) - eps - cross(w, w_r)

    solution = solve_ivp(
        derivative,
        (0.0, times[-1]),
        np.zeros(3),
        method="RK45",
        t_eval=times,
        rtol=RELATIVE_TOLERANCE,
        atol=ABSOLUTE_TOLERANCE,
    )
    if not solution.success:
        raise RuntimeError(solution.message)
    return solution.y.T


def decode(p: Problem) -> Array:
    s = sense(p)
    w = rates(p, s)
    return accelerations(p, s, w, attitudes(p, w))


if __name__ == "__main__":
    serve(decode)
