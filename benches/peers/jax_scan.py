"""The closed form in JAX: the whole record at once, `lax.scan` over the two things that are sequential, one jitted function.

Double precision, on the processor.
"""

import os

os.environ["JAX_PLATFORMS"] = "cpu"
os.environ["JAX_ENABLE_X64"] = "1"
# One core, as everybody else.
os.environ["XLA_FLAGS"] = "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1"

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import lax

import closed_form as form
from protocol import Array, Problem, serve

# Steps that XLA makes one turn of its loop of. Of eight, its fusion computes shared terms anew and takes 400 times as long.
UNROLL = 4


def decoder(k: form.Constants) -> Callable[[jax.Array], jax.Array]:
    """From voltages (n, 9) to columns (6, n - 2)."""

    def heun(state: Any, torque: form.Vec) -> Any:
        state = form.heun(k, *state, torque)
        return state, state

    def follow(q: form.Quaternion, step: form.Quaternion) -> Any:
        q = form.follow(q, step)
        return q, q

    def scanned(step: Callable, start: Any, along: Any) -> Any:
        """What each step gives, the start before it."""
        start = jax.tree.map(jnp.float64, start)
        _, later = lax.scan(step, start, along, unroll=UNROLL)
        return jax.tree.map(lambda first, rest: jnp.concatenate([first[None], rest]), start, later)

    @jax.jit
    def decode(voltage: jax.Array) -> jax.Array:
        before, now, after = form.neighbours(k, voltage)
        spin = tuple(x[0] for x in form.spin_at_rest(k, before, now, after))
        spin_dot = form.euler(k, spin, tuple(x[0] for x in now.torque))
        spin, spin_dot = scanned(heun, (spin, spin_dot), tuple(x[1:] for x in now.torque))
        w, w_dot, force = form.motion(k, before, now, after, spin, spin_dot)
        q = scanned(follow, k.attitude, form.steps(w, w_dot))
        linear, angular = form.ground(k, q, force, w_dot)
        return jnp.stack([*linear, *angular])

    return decode


class Decoder:
    """The jitted function and the voltages where it wants them, made at the first record."""

    def __init__(self) -> None:
        self.jitted: Callable[[jax.Array], jax.Array] | None = None

    def __call__(self, p: Problem) -> Array:
        if self.jitted is None:
            self.jitted = decoder(form.constants(p))
            self.voltage = jnp.asarray(p.voltage_v)
        return np.asarray(self.jitted(self.voltage)).T


if __name__ == "__main__":
    serve(Decoder())
