"""Reference values for `core/tests/dsp`, by other people's code or by exact arithmetic.

    pip install scipy==1.17.1 numpy==2.4.6 mpmath==1.4.1
    python core/tests/golden/dsp.py

rewrites `dsp.rs` beside this file. SciPy answers wherever it has the function. Where its own rounding is not
far below ours (a corner at 5e-4 of the sample rate; high orders in long windows) the reference is the same
definition in 50 digits (mpmath) or in fractions, and SciPy's distance from that is printed as a comment.
"""

from fractions import Fraction
from pathlib import Path

import mpmath
import numpy as np
import scipy
from scipy import fft, interpolate, optimize, signal

mpmath.mp.dps = 50
SEED = 20130921
MULTIPLIER, INCREMENT = 6364136223846793005, 1442695040888963407


def record(samples, rate_hz):
    """Two sines, a trend, an offset and noise; `record` in `main.rs` is the same sum."""
    state, values = SEED, []
    for k in range(samples):
        state = (MULTIPLIER * state + INCREMENT) % 2**64
        noise = (state >> 11) / 2.0**53 - 0.5
        t = k / rate_hz
        values.append(
            1.5 + 0.5 * t + 0.8 * np.sin(2 * np.pi * 3.0 * t) + 0.3 * np.sin(2 * np.pi * 40.0 * t) + 0.2 * noise
        )
    return np.array(values)


def butter(kind, order, corner_hz, rate_hz):
    return signal.butter(order, corner_hz, btype=kind, output="sos", fs=rate_hz)


def exact_sections(kind, order, corner_hz, rate_hz):
    """Butterworth by the bilinear transform, as sections (b0, b1, b2, a1, a2) of 50 digits."""
    mp = mpmath
    k = mp.tan(mp.pi * mp.mpf(corner_hz) / mp.mpf(rate_hz))
    sections = []
    sign = 1 if kind == "lowpass" else -1
    for pair in range(order // 2):
        d = 2 * mp.sin(mp.pi * (2 * pair + 1) / (2 * order)) * k
        n = 1 + d + k * k
        b = (k * k if sign > 0 else 1) / n
        sections.append((b, sign * 2 * b, b, 2 * (k * k - 1) / n, (1 - d + k * k) / n))
    if order % 2:
        b = (k if sign > 0 else 1) / (1 + k)
        sections.append((b, sign * b, mp.mpf(0), (k - 1) / (1 + k), mp.mpf(0)))
    return sections


def exact_zero_phase(kind, order, corner_hz, rate_hz, x):
    """`sosfiltfilt` in 50 digits."""
    pad = 3 * (order + 1)
    x = [mpmath.mpf(float(v)) for v in x]
    y = [2 * x[0] - v for v in x[pad:0:-1]] + x + [2 * x[-1] - v for v in x[-2 : -pad - 2 : -1]]
    for _ in range(2):
        for b0, b1, b2, a1, a2 in exact_sections(kind, order, corner_hz, rate_hz):
            settled = (b0 + b1 + b2) / (1 + a1 + a2) * y[0]
            s2 = b2 * y[0] - a2 * settled
            s1 = b1 * y[0] - a1 * settled + s2
            for i, v in enumerate(y):
                out = b0 * v + s1
                s1 = b1 * v - a1 * out + s2
                s2 = b2 * v - a2 * out
                y[i] = out
        y.reverse()
    return np.array([float(v) for v in y[pad:-pad]])


def solve(matrix, right):
    """Gauss-Jordan in fractions."""
    n = len(right)
    rows = [row[:] + [r] for row, r in zip(matrix, right)]
    for i in range(n):
        pivot = next(j for j in range(i, n) if rows[j][i] != 0)
        rows[i], rows[pivot] = rows[pivot], rows[i]
        rows[i] = [v / rows[i][i] for v in rows[i]]
        for j in range(n):
            if j != i:
                rows[j] = [v - rows[j][i] * w for v, w in zip(rows[j], rows[i])]
    return [row[-1] for row in rows]


def exact_slope_weights(half_width, order):
    """Weights of the first derivative per sample in the middle of the window, from the normal equations."""
    places = range(-half_width, half_width + 1)
    moment = [Fraction(sum(i**p for i in places)) for p in range(2 * order + 1)]
    c = solve(
        [[moment[r + s] for s in range(order + 1)] for r in range(order + 1)],
        [Fraction(int(r == 1)) for r in range(order + 1)],
    )
    return [sum(cr * i**r for r, cr in enumerate(c)) for i in places]


def bandwidth(half_width, order, rate_hz):
    """Lowest frequency at which the slope weights' gain over that of j omega falls to the root of a half."""
    w = np.array([float(v) for v in exact_slope_weights(half_width, order)])
    i = np.arange(-half_width, half_width + 1)

    def excess(phase):
        return w @ np.sin(phase * i) / phase - np.sqrt(0.5)

    grid = np.linspace(1e-6, np.pi, 200 * (half_width + 1))
    first = next(n for n, p in enumerate(grid) if excess(p) < 0)
    return optimize.brentq(excess, grid[first - 1], grid[first], xtol=1e-15, rtol=1e-15) * rate_hz / (2 * np.pi)


def hampel(x, half_width, sigmas):
    y, found = x.copy(), []
    for i in range(len(x)):
        window = x[max(0, i - half_width) : i + half_width + 1]
        median = np.median(window)
        mad = np.median(np.abs(window - median))
        if abs(x[i] - median) > sigmas * mad / 0.6744897501960817:
            y[i] = median
            found.append(i)
    return y, found


OUT = [
    "//! Written by dsp.py beside this file; do not edit.",
    f"//! SciPy {scipy.__version__}, NumPy {np.__version__}, mpmath {mpmath.__version__}, seed {SEED}.",
    "",
    f"pub const SEED: u64 = {SEED};",
]


def emit(name, values, comment=None):
    if comment:
        OUT.append(f"// {comment}")
    OUT.append(f"pub const {name}: &[f64] = &[")
    text = [repr(float(v)) for v in values]
    for i in range(0, len(text), 6):
        OUT.append("    " + ", ".join(text[i : i + 6]) + ",")
    OUT.append("];")


# (name, kind, order, corner Hz, rate Hz, samples, stride)
ZERO_PHASE = [
    ("LOW_PASS_1", "lowpass", 1, 100.0, 1000.0, 60, 2),
    ("LOW_PASS_4", "lowpass", 4, 50.0, 1000.0, 300, 7),
    ("LOW_PASS_5", "lowpass", 5, 120.0, 1000.0, 200, 5),
    ("LOW_PASS_10", "lowpass", 10, 300.0, 1000.0, 200, 5),
]
for name, kind, order, corner, rate, samples, stride in ZERO_PHASE:
    y = signal.sosfiltfilt(butter(kind, order, corner, rate), record(samples, rate))
    exact = exact_zero_phase(kind, order, corner, rate, record(samples, rate))
    error = np.max(np.abs(y - exact)) / np.max(np.abs(exact))
    emit(name, y[::stride], f"SciPy is {error:.1e} of the peak from 50 digits.")

x = record(6000, 2000.0)
exact = exact_zero_phase("lowpass", 8, 1.0, 2000.0, x)
scipys = signal.sosfiltfilt(butter("lowpass", 8, 1.0, 2000.0), x)
error = np.max(np.abs(scipys - exact)) / np.max(np.abs(exact))
emit("NARROW_LOW_PASS_8", scipys[::100], "SciPy.")
emit("NARROW_LOW_PASS_8_EXACT", exact[::100], f"50 digits; SciPy is {error:.1e} of the peak away.")
emit("CAUSAL_LOW_PASS_6", signal.sosfilt(butter("lowpass", 6, 30.0, 1000.0), record(200, 1000.0))[::5])

emit("DETREND_CONSTANT", signal.detrend(record(200, 1000.0), type="constant")[::5])

emit("SLOPE_7_4", signal.savgol_filter(record(120, 1000.0), 15, 4, deriv=1, delta=1e-3))
for half_width, order in [(3, 6), (50, 6), (200, 5)]:
    weights = exact_slope_weights(half_width, order)
    scipys = signal.savgol_coeffs(2 * half_width + 1, order, deriv=1, use="dot")
    exact = np.array([float(v) for v in weights])
    error = np.max(np.abs(scipys - exact)) / np.max(np.abs(exact))
    emit(
        f"SLOPE_WEIGHTS_{half_width}_{order}",
        exact[half_width :: max(1, half_width // 25)],
        f"Fractions, from the middle outwards; SciPy is {error:.1e} of the largest away.",
    )
BANDWIDTHS = [(1, 1), (3, 2), (10, 4), (50, 3), (50, 6), (200, 5)]
emit("BANDWIDTH_HZ", [bandwidth(m, p, 1000.0) for m, p in BANDWIDTHS])

spiky = record(150, 1000.0)
for index, height in [(0, 4.0), (1, -3.0), (40, 6.0), (41, 6.0), (90, -2.0), (149, 5.0)]:
    spiky[index] += height
replaced, found = hampel(spiky, 5, 3.0)
emit("HAMPEL", replaced)
OUT.append(f"pub const HAMPEL_INDICES: &[usize] = &{found};")

for name, corner, numerator in [("LAG_LOW_PASS", 10.0, lambda tau: [1.0]), ("LAG_HIGH_PASS", 2.0, lambda tau: [tau, 0.0])]:
    tau = 1 / (2 * np.pi * corner)
    # From rest: lsim starts at the first input, so that one has to be zero.
    u = record(300, 1000.0)
    u[0] = 0.0
    _, y, _ = signal.lsim((numerator(tau), [tau, 1.0]), u, np.arange(300) / 1000.0, interp=True)
    emit(name, y[::7])



def exact_first_order(corner_hz, rate_hz, x):
    """Low-pass under an input linear between samples, from rest, in 50 digits."""
    mp = mpmath
    r = 2 * mp.pi * mp.mpf(corner_hz) / mp.mpf(rate_hz)
    pole, mean = mp.exp(-r), (1 - mp.exp(-r)) / r
    state, before, y = mp.mpf(0), mp.mpf(0), []
    for u in (mp.mpf(float(v)) for v in x):
        state = pole * state + (mean - pole) * before + (1 - mean) * u
        before = u
        y.append(float(state))
    return y


emit("LAG_SLOW", exact_first_order(0.001, 1000.0, record(300, 1000.0))[::7])
emit("LAG_FAST", exact_first_order(400.0, 1000.0, record(300, 1000.0))[::7])


def jittered(samples, rate_hz, share):
    """Time stamps off the even ones by up to `share` of half a step; `jittered` in `resample.rs` is the same."""
    state, times = SEED + 1, []
    for k in range(samples):
        state = (MULTIPLIER * state + INCREMENT) % 2**64
        times.append((k + share * ((state >> 11) / 2.0**53 - 0.5)) / rate_hz)
    return np.array(times)


def exact_spline(times, values, wanted):
    """Not-a-knot cubic spline in 50 digits, solved for the slopes at the samples."""
    mp = mpmath
    x, y = [mp.mpf(float(v)) for v in times], [mp.mpf(float(v)) for v in values]
    h = [b - a for a, b in zip(x, x[1:])]
    d = [(b - a) / s for a, b, s in zip(y, y[1:], h)]
    n = len(x)
    lower, own, upper, right = [mp.mpf(0)] * n, [mp.mpf(0)] * n, [mp.mpf(0)] * n, [mp.mpf(0)] * n
    for i in range(1, n - 1):
        lower[i], own[i], upper[i] = h[i], 2 * (h[i - 1] + h[i]), h[i - 1]
        right[i] = 3 * (h[i] * d[i - 1] + h[i - 1] * d[i])
    first, last = h[0] + h[1], h[-1] + h[-2]
    own[0], upper[0] = h[1], first
    right[0] = ((h[0] + 2 * first) * h[1] * d[0] + h[0] ** 2 * d[1]) / first
    lower[-1], own[-1] = last, h[-2]
    right[-1] = (h[-1] ** 2 * d[-2] + (2 * last + h[-1]) * h[-2] * d[-1]) / last
    for i in range(1, n):
        ratio = lower[i] / own[i - 1]
        own[i] -= ratio * upper[i - 1]
        right[i] -= ratio * right[i - 1]
    m = [mp.mpf(0)] * n
    m[-1] = right[-1] / own[-1]
    for i in range(n - 2, -1, -1):
        m[i] = (right[i] - upper[i] * m[i + 1]) / own[i]
    answers = []
    for t in (mp.mpf(float(v)) for v in wanted):
        i = min(max(k for k in range(n) if x[k] <= t), n - 2)
        u, s = (t - x[i]) / h[i], h[i]
        answers.append(
            float(
                (1 + 2 * u) * (1 - u) ** 2 * y[i]
                + u * (1 - u) ** 2 * s * m[i]
                + u * u * (3 - 2 * u) * y[i + 1]
                + u * u * (u - 1) * s * m[i + 1]
            )
        )
    return np.array(answers)


def spread(times, wanted):
    """Times from the first to the last stamp, evenly."""
    return np.array([times[0] + (times[-1] - times[0]) * (k / wanted) for k in range(wanted + 1)])


SPLINES = [
    ("SPLINE_EVEN", np.arange(200) / 1000.0, record(200, 1000.0), 67),
    ("SPLINE_JITTERED", jittered(200, 1000.0, 0.9), record(200, 1000.0), 67),
    ("SPLINE_GROWING", np.array([1.5**k for k in range(30)]), record(30, 1000.0), 40),
    ("SPLINE_SHRINKING", np.array([-(1.5**k) for k in range(30)][::-1]), record(30, 1000.0), 40),
    ("SPLINE_4", jittered(4, 1000.0, 0.9), record(4, 1000.0), 12),
    ("SPLINE_5", jittered(5, 1000.0, 0.9), record(5, 1000.0), 12),
]
for name, times, values, wanted in SPLINES:
    y = interpolate.CubicSpline(times, values)(spread(times, wanted))
    exact = exact_spline(times, values, spread(times, wanted))
    error = np.max(np.abs(y - exact)) / np.max(np.abs(exact))
    emit(name, y, f"SciPy is {error:.1e} of the peak from 50 digits.")

for name, samples, segment, rate, stride in [
    ("WELCH_256", 3000, 256, 1000.0, 3),
    ("WELCH_64", 100, 64, 250.0, 1),
    ("WELCH_ONE", 128, 128, 1000.0, 3),
]:
    frequencies, density = signal.welch(record(samples, 1000.0), fs=rate, nperseg=segment)
    emit(name, density[::stride])
    emit(f"{name}_HZ", frequencies[::stride])

x = record(256, 1000.0)
exact = [
    mpmath.fsum(mpmath.mpf(float(v)) * mpmath.expjpi(-mpmath.mpf(2 * ((k * n) % 256)) / 256) for n, v in enumerate(x))
    for k in range(129)
]
error = max(abs(mpmath.mpc(complex(a)) - b) for a, b in zip(fft.rfft(x), exact)) / mpmath.sqrt(
    mpmath.fsum(abs(b) ** 2 for b in exact)
)
emit(
    "FOURIER_256_EXACT",
    [part for v in exact[::4] for part in (v.real, v.imag)],
    f"50 digits; SciPy is {float(error):.1e} of the root of the sum of squares away.",
)
emit("FOURIER_4096", [part for v in fft.rfft(record(4096, 1000.0))[::64] for part in (v.real, v.imag)])


def noise_floor(x):
    d = np.diff(x, 3)
    return np.median(np.abs(d - np.median(d))) / 0.6744897501960817 / np.sqrt(20.0)


emit("NOISE_FLOOR", [noise_floor(record(samples, 1000.0)) for samples in (32, 200, 1001, 5000)])
wild = record(150, 1000.0)
wild[::10] += 5.0
emit("NOISE_FLOOR_WILD", [noise_floor(wild)])

Path(__file__).with_suffix(".rs").write_text("\n".join(OUT) + "\n")
