//! Preprocessing against SciPy, against exact arithmetic, and against what each stage must leave alone.
//!
//! `../golden/dsp.py` writes the reference values; nothing about sensors belongs here.

mod delay;
mod detrend;
mod differentiate;
mod filter;
#[path = "../golden/dsp.rs"]
#[rustfmt::skip]
mod golden;
mod lag;
mod outlier;
mod refusals;
mod resample;
mod spectrum;
mod stages;
mod tolerance;
mod transposed;

/// A stage with its settings filled in, its answer dropped.
type Stage = fn(&mut [f64]) -> sixaxis_core::Result<()>;

/// Uniform on (-1/2, 1/2), from the generator that `dsp.py` runs, too.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    }
}

/// Two sines, a trend, an offset and noise: `record` in `dsp.py`.
fn record(samples: usize, rate_hz: f64) -> Vec<f64> {
    let mut noise = Noise(golden::SEED);
    (0..samples)
        .map(|k| {
            let t = k as f64 / rate_hz;
            let turn = core::f64::consts::TAU * t;
            1.5 + 0.5 * t
                + 0.8 * (turn * 3.0).sin()
                + 0.3 * (turn * 40.0).sin()
                + 0.2 * noise.next()
        })
        .collect()
}

/// A sine of unit amplitude.
fn sine(samples: usize, frequency_hz: f64, rate_hz: f64) -> Vec<f64> {
    (0..samples)
        .map(|k| (core::f64::consts::TAU * frequency_hz * k as f64 / rate_hz).sin())
        .collect()
}

fn peak(series: &[f64]) -> f64 {
    series.iter().fold(0.0, |a, b| a.max(b.abs()))
}

/// Largest difference over the largest reference value; NaN and unequal lengths are infinitely far.
fn distance(ours: &[f64], reference: &[f64]) -> f64 {
    if ours.len() != reference.len() {
        return f64::INFINITY;
    }
    let mut largest = 0.0_f64;
    for (a, b) in ours.iter().zip(reference) {
        let d = (a - b).abs();
        if d.is_nan() {
            return f64::INFINITY;
        }
        largest = largest.max(d);
    }
    largest / peak(reference)
}

/// Every `stride`th sample, as the golden values are kept.
fn thinned(series: &[f64], stride: usize) -> Vec<f64> {
    series.iter().copied().step_by(stride).collect()
}

/// Fails unless `value` is below `limit`; prints both, so that measured figures can be read off a passing run.
#[track_caller]
fn check_below(what: &str, value: f64, limit: f64) {
    println!("{what}: {value:.2e} (limit {limit:.1e})");
    assert!(value < limit, "{what}: {value:e} is not below {limit:e}");
}

/// Fails unless `value` is above `limit`: the negative controls.
#[track_caller]
fn check_above(what: &str, value: f64, limit: f64) {
    println!("{what}: {value:.2e} (at least {limit:.1e})");
    assert!(value > limit, "{what}: {value:e} is not above {limit:e}");
}
