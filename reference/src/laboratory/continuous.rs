//! A sampled signal between its samples: what an analogue filter makes of it, and what a recorder with another clock reads.
//!
//! Simulated forces and motions are smooth, so that the cubic through the four nearest samples stands for them in between, to
//! 3/128 (2 pi f h)^4 of a sine of frequency f at the sample interval h: 1e-9 at 5 Hz and 2 kHz. Beyond its ends a signal keeps
//! its first and its last value.

/// Panels of the quadrature of [`lagged`].
const PANELS: u32 = 64;

/// Weights of samples -1, 0, 1 and 2 at a place from 0 to 1: Lagrange's cubic.
fn cubic(s: f64) -> [f64; 4] {
    [
        -s * (s - 1.0) * (s - 2.0) / 6.0,
        (s + 1.0) * (s - 1.0) * (s - 2.0) / 2.0,
        -(s + 1.0) * s * (s - 2.0) / 2.0,
        (s + 1.0) * s * (s - 1.0) / 6.0,
    ]
}

/// The four samples about the interval that begins with sample `index`.
fn neighbours(series: &[f64], index: usize) -> [f64; 4] {
    let last = series.len() - 1;
    let places = [index.saturating_sub(1), index, index + 1, index + 2];
    places.map(|place| series[place.min(last)])
}

/// Value at a time in sample intervals, clamped to the record's ends. NaN for an empty record.
pub(super) fn at(series: &[f64], time: f64) -> f64 {
    if series.is_empty() {
        return f64::NAN;
    }
    let time = time.clamp(0.0, (series.len() - 1) as f64);
    let index = time.floor();
    let weights = cubic(time - index);
    let samples = neighbours(series, index as usize);
    weights.iter().zip(samples).map(|(w, u)| w * u).sum()
}

/// What an analogue first-order low-pass with its -3 dB corner at `corner_hz` shows of a signal, settled to its first value.
///
/// From sample to sample tau x' = u - x has the solution x1 = x0 + integral of r exp(-r (1 - s)) (u(s) - x0) over s from 0 to 1
/// with r = h/tau: a sum over the four samples that u(s) is made of, whose weights are found once, by quadrature. The matching
/// high-pass shows u - x.
pub(super) fn lagged(series: &[f64], corner_hz: f64, sample_rate_hz: f64) -> Vec<f64> {
    let ratio = core::f64::consts::TAU * corner_hz / sample_rate_hz;
    let weights = lag_weights(ratio);
    let Some(&first) = series.first() else {
        return Vec::new();
    };
    let mut shown = first;
    let mut record = vec![first];
    for index in 0..series.len() - 1 {
        let samples = neighbours(series, index);
        let change: f64 = weights
            .iter()
            .zip(samples)
            .map(|(w, u)| w * (u - shown))
            .sum();
        shown += change;
        record.push(shown);
    }
    record
}

/// Integrals of r exp(-r (1 - s)) times each of [`cubic`]'s weights: three-point Gauss on [`PANELS`] panels.
fn lag_weights(ratio: f64) -> [f64; 4] {
    let offset = 0.5 * 0.6_f64.sqrt();
    let nodes = [
        (0.5 - offset, 5.0 / 18.0),
        (0.5, 8.0 / 18.0),
        (0.5 + offset, 5.0 / 18.0),
    ];
    let width = 1.0 / f64::from(PANELS);
    let mut weights = [0.0; 4];
    for panel in 0..PANELS {
        for (place, weight) in nodes {
            let s = (f64::from(panel) + place) * width;
            let pull = weight * width * ratio * (-ratio * (1.0 - s)).exp();
            for (sum, share) in weights.iter_mut().zip(cubic(s)) {
                *sum += pull * share;
            }
        }
    }
    weights
}

/// A series as a recorder takes it whose samples come late and at another rate. At the ends the first and the last value stand.
pub(super) fn on_other_clock(
    series: &[f64],
    rate_hz: f64,
    late_s: f64,
    rate_error: f64,
) -> Vec<f64> {
    (0..series.len())
        .map(|i| at(series, i as f64 / (1.0 + rate_error) + late_s * rate_hz))
        .collect()
}
