"""The closed form compiled by numba: numbers and tuples of numbers only, fastmath off.

Nothing is allocated while it decodes, or it does not serve: numba's own count is held against that.
"""

import numpy as np
from numba import njit
from numba.core.runtime import _nrt_python, rtsys
from numba.extending import register_jitable

import closed_form as form
from protocol import Array, Problem, serve

for function in [
    form.add,
    form.sub,
    form.times,
    form.dot,
    form.cross,
    form.apply,
    form.node,
    form.place,
    form.euler,
    form.heun,
    form.turned,
    form.relative_rate,
    form.spin_at_rest,
    form.motion,
    form.step_of_attitude,
    form.multiply,
    form.follow,
    form.ground,
]:
    register_jitable(function)


@njit
def run(k: form.Constants, voltage: Array, rows: Array) -> None:
    before = form.place(k, voltage[0])
    now = form.place(k, voltage[1])
    after = form.place(k, voltage[2])
    spin = form.spin_at_rest(k, before, now, after)
    spin_dot = form.euler(k, spin, now.torque)
    w, w_dot, force = form.motion(k, before, now, after, spin, spin_dot)
    q = k.attitude
    write(rows, 0, form.ground(k, q, force, w_dot))
    for sample in range(3, len(voltage)):
        before, now, after = now, after, form.place(k, voltage[sample])
        spin, spin_dot = form.heun(k, spin, spin_dot, now.torque)
        w0, w0_dot = w, w_dot
        w, w_dot, force = form.motion(k, before, now, after, spin, spin_dot)
        q = form.follow(q, form.step_of_attitude(w0, w0_dot, w, w_dot))
        write(rows, sample - 2, form.ground(k, q, force, w_dot))


@register_jitable
def write(rows: Array, row: int, answer: tuple[form.Vec, form.Vec]) -> None:
    linear, angular = answer
    rows[row, 0], rows[row, 1], rows[row, 2] = linear
    rows[row, 3], rows[row, 4], rows[row, 5] = angular


class Decoder:
    """Constants and rows are made at the first record, which also compiles."""

    def __init__(self) -> None:
        self.arguments: tuple[form.Constants, Array, Array] | None = None

    def __call__(self, p: Problem) -> Array:
        if self.arguments is None:
            rows = np.empty((len(p.voltage_v) - 2, 6))
            self.arguments = form.constants(p), p.voltage_v, rows
            run(*self.arguments)
            refuse_allocations(*self.arguments)
        run(*self.arguments)
        return self.arguments[2]


def refuse_allocations(k: form.Constants, voltage: Array, rows: Array) -> None:
    """Numba notes each array that Python hands it, which counts: the same for three samples as for all."""

    def allocations(samples: int) -> int:
        before = rtsys.get_allocation_stats().alloc
        run(k, voltage[:samples], rows)
        return rtsys.get_allocation_stats().alloc - before

    _nrt_python.memsys_enable_stats()
    count = allocations(len(voltage)) - allocations(3)
    _nrt_python.memsys_disable_stats()
    if count:
        raise RuntimeError(f"numba allocated {count} times while it decoded a record")


if __name__ == "__main__":
    serve(Decoder())
