"""The closed form in NumPy: the whole record at once; Heun on (8), which cannot be, over Python floats."""

from typing import Any

import numpy as np

import closed_form as form
from protocol import Array, Problem, serve


def scanned(k: form.Constants, spin: form.Vec, torque: form.Vec) -> tuple[form.Vec, form.Vec]:
    """The rate of the mass and its derivative at every sample."""
    # Lists of floats: taking one number from an array costs more than the arithmetic done with it.
    torques = zip(*(x.tolist() for x in torque), strict=True)
    state = spin, form.euler(k, spin, next(torques))
    states = [state]
    for now in torques:
        state = form.heun(k, *state, now)
        states.append(state)
    both = np.array(states)
    return tuple(both[:, 0].T), tuple(both[:, 1].T)


def attitudes(start: form.Quaternion, steps: form.Quaternion) -> form.Quaternion:
    """A running product in log2(n) passes, not n steps."""

    def join(a: Any, b: Any) -> Array:
        return np.concatenate([np.atleast_1d(a), b])

    w = join(start[0], steps[0])
    v = tuple(join(a, b) for a, b in zip(start[1], steps[1], strict=True))
    span = 1
    while span < len(w):
        early = w[:-span], tuple(x[:-span] for x in v)
        late = w[span:], tuple(x[span:] for x in v)
        product, vector = form.multiply(early, late)
        w = join(w[:span], product)
        v = tuple(join(x[:span], y) for x, y in zip(v, vector, strict=True))
        span *= 2
    return w, v


def decode(p: Problem) -> Array:
    k = form.constants(p)
    before, now, after = form.neighbours(k, p.voltage_v)
    spin = form.spin_at_rest(k, before, now, after)
    first = tuple(float(x[0]) for x in spin)
    w, w_dot, force = form.motion(k, before, now, after, *scanned(k, first, now.torque))
    q = attitudes(k.attitude, form.steps(w, w_dot))
    linear, angular = form.ground(k, q, force, w_dot)
    return np.stack([*linear, *angular]).T


if __name__ == "__main__":
    serve(decode)
