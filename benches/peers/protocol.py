"""What the Python peers share: the exported problem and the line protocol of benches/examples/serve."""

import json
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Problem:
    """The record and what is known of the sensor; letters are the paper's."""

    voltage_v: Array  # (n, 9)
    drift_v: Array  # (9,)
    sensitivity: Array  # (9,), (s_i/m) c_i
    preload: Array  # (9,), static limb force per mass, m/s^2
    stiffness: float  # k/m, s^-2
    t: Array  # (9, 3), m, mass axes
    b: Array  # (9, 3), m, shell axes
    length: float  # L, m
    half_edge: float  # n, m
    inertia: Array  # (3, 3), I/m, m^2
    gravity: Array  # (3,), ground axes, m/s^2
    attitude: Array  # (3, 3), R at the first decoupled sample
    h: float  # s


def read(folder: Path) -> Problem:
    given = json.loads((folder / "problem.json").read_text())
    scale = np.array(given["scale_per_mass_per_kg"])
    return Problem(
        voltage_v=np.fromfile(folder / "voltage.bin", "<f8").reshape(-1, 9),
        drift_v=np.array(given["zero_drift_v"]),
        sensitivity=scale * np.array(given["gain_n_per_v"]),
        preload=np.array(given["preload_per_mass_m_s2"]),
        stiffness=given["stiffness_per_mass_per_s2"],
        t=np.array(given["mass_hinge_m"]),
        b=np.array(given["shell_hinge_m"]),
        length=given["limb_length_m"],
        half_edge=given["half_edge_m"],
        inertia=np.array(given["inertia_per_mass_m2"]),
        gravity=np.array(given["gravity_ground_m_s2"]),
        attitude=np.array(given["initial_attitude"]),
        h=1.0 / given["sample_rate_hz"],
    )


def serve(decode: Callable[[Problem], Array]) -> None:
    """Obeys requests until "quit".

    `decode` gives rows of linear, then angular acceleration, ground axes.
    """
    problem = read(Path(sys.argv[1]))
    for line in sys.stdin:
        request, _, argument = line.strip().partition(" ")
        if request == "answer":
            rows = decode(problem)
            rows.astype("<f8").tofile(argument)
            print(len(rows), flush=True)
        elif request == "time":
            repeats = int(argument)
            decode(problem)  # another peer has had the caches
            start = time.perf_counter()
            for _ in range(repeats):
                decode(problem)
            print((time.perf_counter() - start) / repeats, flush=True)
        elif request == "quit":
            break
        else:
            raise ValueError(f"no such request: {line!r}")
