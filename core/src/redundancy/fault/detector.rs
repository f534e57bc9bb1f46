//! Detection: tests of the parity rows with exact distributions, thresholds from a rate of false alarms.
//!
//! For a healthy sensor z_t = L^-1 rho_t is white and standard normal ([`super::noise`]). Of each sample |z|^2 is chi-square with
//! three degrees of freedom. Of a window of N samples, mean, slope and the energy of the rest are independent, chi-square with
//! 3, 3 and 3 N - 6. A window of 8 detects within a millisecond what a single sample cannot, one of 4096 detects a drift.
//!
//! The rate of false alarms is the expected number of failed tests, a sum over the tests of how often each is made times its
//! probability. This is linear, and hence exact however the tests depend on one another; each test has an equal share of it.
//!
//! Errors of calibration are not noise: they persist. Relative errors of the scale factors and errors of the zero drifts add
//! W^T diag(x^2 sd_scale^2 + sd_drift^2) W to the covariance of a sample or of a mean, and the same of a slope with the strains'
//! slope. With [`CalibrationErrors`] given, the tests keep their distribution over calibrations.

use super::moments::Moments;
use super::noise::{RowNoise, apply, dot, inverse_root};
use crate::error::{Result, require, require_not_negative};
use crate::float::sqrt;
use crate::geometry::LIMBS;
use crate::redundancy::parity::ROWS;
use crate::significance::chi_square_limit;

/// Lengths of the windows, samples.
pub const WINDOWS: [u64; 4] = [8, 64, 512, 4096];

/// A statistic of the rows that is tested.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Test {
    /// One sample.
    Sample,
    /// The mean of a window of that many samples.
    Mean(u64),
    /// The slope in it.
    Slope(u64),
    /// The energy that mean and slope leave in it.
    Energy(u64),
}

/// The tests, in the order in which they are made. The energy of the two longest windows would repeat the test of 64 samples, slope
/// and energy of eight samples that of a single one.
pub const TESTS: [Test; 9] = [
    Test::Sample,
    Test::Mean(8),
    Test::Mean(64),
    Test::Slope(64),
    Test::Energy(64),
    Test::Mean(512),
    Test::Slope(512),
    Test::Mean(4096),
    Test::Slope(4096),
];

impl Test {
    /// Samples from one such test to the next.
    #[must_use]
    pub const fn samples(self) -> u64 {
        match self {
            Self::Sample => 1,
            Self::Mean(n) | Self::Slope(n) | Self::Energy(n) => n,
        }
    }

    /// Degrees of freedom of its statistic.
    #[must_use]
    pub const fn freedom(self) -> usize {
        match self {
            Self::Sample | Self::Mean(_) | Self::Slope(_) => 3,
            Self::Energy(n) => 3 * n as usize - 6,
        }
    }
}

/// Standard deviations of the errors that calibration leaves, per limb.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CalibrationErrors {
    /// Of the scale factor, relative.
    pub scale: [f64; LIMBS],
    /// Of the zero drift, strain.
    pub drift: [f64; LIMBS],
}

/// A test that failed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Alarm {
    /// Last sample that went into it, from 0.
    pub sample: u64,
    /// Which.
    pub test: Test,
    /// Its statistic.
    pub statistic: f64,
    /// The threshold that it exceeds.
    pub threshold: f64,
}

/// The tests that failed at one sample.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Alarms([Option<Alarm>; TESTS.len()]);

impl Alarms {
    /// Those of the shortest windows first.
    pub fn iter(&self) -> impl Iterator<Item = Alarm> + '_ {
        self.0.iter().flatten().copied()
    }

    /// The one of the shortest window, which bounds the onset best.
    #[must_use]
    pub fn first(&self) -> Option<Alarm> {
        self.iter().next()
    }
}

/// Sums over one window.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Window {
    rows: Moments,
    strain: [f64; LIMBS],
    strain_ramp: [f64; LIMBS],
    strain_square: [f64; LIMBS],
}

/// The tests.
#[derive(Debug, Clone, PartialEq)]
pub struct Detector {
    noise: RowNoise,
    errors: Option<CalibrationErrors>,
    thresholds: [f64; TESTS.len()],
    windows: [Window; WINDOWS.len()],
    received: u64,
}

impl Detector {
    /// Largest rate of false alarms, per sample, that leaves every test a probability below one.
    pub const LARGEST_RATE: f64 = 1e-3;

    /// For a rate of false alarms per sample: a rate per hour over 3600 times the sample rate.
    ///
    /// # Errors
    /// [`crate::Error::OutOfRange`] for a rate outside 1e-18 to [`Self::LARGEST_RATE`], or errors of calibration below zero.
    pub fn new(
        noise: RowNoise,
        false_alarms_per_sample: f64,
        errors: Option<CalibrationErrors>,
    ) -> Result<Self> {
        let rate = false_alarms_per_sample;
        require(
            (1e-18..=Self::LARGEST_RATE).contains(&rate),
            "false alarms per sample",
            rate,
            "from 1e-18 to 1e-3",
        )?;
        for value in errors
            .iter()
            .flat_map(|e| e.scale.into_iter().chain(e.drift))
        {
            require_not_negative("standard deviation of a calibration error", value)?;
        }
        let share = rate / TESTS.len() as f64;
        let mut thresholds = [0.0; TESTS.len()];
        for (threshold, test) in thresholds.iter_mut().zip(TESTS) {
            *threshold = chi_square_limit(share * test.samples() as f64, test.freedom())?;
        }
        Ok(Self {
            noise,
            errors,
            thresholds,
            windows: [Window::default(); WINDOWS.len()],
            received: 0,
        })
    }

    /// The noise it was made for.
    #[must_use]
    pub const fn noise(&self) -> &RowNoise {
        &self.noise
    }

    /// Threshold of each of [`TESTS`].
    #[must_use]
    pub const fn thresholds(&self) -> &[f64; TESTS.len()] {
        &self.thresholds
    }

    /// Samples taken.
    #[must_use]
    pub const fn received(&self) -> u64 {
        self.received
    }

    /// The window of that length as it was filled last or is being filled: what a test looked at.
    pub(super) fn rows_of(&self, test: Test) -> Moments {
        let place = WINDOWS.iter().position(|&n| n == test.samples());
        place
            .and_then(|place| self.windows.get(place))
            .map_or(Moments::default(), |window| window.rows)
    }

    /// Takes the whitened rows and the strains of a sample and makes the tests that are due.
    pub fn push(&mut self, z: &[f64; ROWS], strain: &[f64; LIMBS]) -> Alarms {
        let sample = self.received;
        self.received += 1;
        for (window, length) in self.windows.iter_mut().zip(WINDOWS) {
            // A full window stays to be looked at until the next sample.
            if window.rows.samples() == length {
                *window = Window::default();
            }
            let place = window.rows.samples() as f64;
            window.rows.push(z);
            if self.errors.is_some() {
                let sums = window.strain.iter_mut().zip(&mut window.strain_ramp);
                for (((sum, ramp), squares), &x) in sums.zip(&mut window.strain_square).zip(strain)
                {
                    *sum += x;
                    *ramp += place * x;
                    *squares += x * x;
                }
            }
        }
        let mut alarms = Alarms::default();
        for ((test, &threshold), alarm) in TESTS.iter().zip(&self.thresholds).zip(&mut alarms.0) {
            if !self.is_due(*test) {
                continue;
            }
            let statistic = self.statistic(*test, z, strain);
            if statistic > threshold {
                *alarm = Some(Alarm {
                    sample,
                    test: *test,
                    statistic,
                    threshold,
                });
            }
        }
        alarms
    }

    /// Begins all windows anew.
    pub fn restart(&mut self) {
        self.windows = [Window::default(); WINDOWS.len()];
    }

    fn is_due(&self, test: Test) -> bool {
        let mut windows = self.windows.iter().zip(WINDOWS);
        let window = windows.find(|(_, length)| *length == test.samples());
        window.is_none_or(|(window, length)| window.rows.samples() == length)
    }

    fn statistic(&self, test: Test, z: &[f64; ROWS], strain: &[f64; LIMBS]) -> f64 {
        let mut windows = self.windows.iter().zip(WINDOWS);
        let Some((window, _)) = windows.find(|(_, length)| *length == test.samples()) else {
            return self.weighted(z, |limb, errors| {
                square(strain[limb] * errors.scale[limb]) + square(errors.drift[limb])
            });
        };
        let n = window.rows.samples() as f64;
        let [mean, slope] = window.rows.mean_and_slope();
        // Coefficients of a limb's strain in the same two shapes.
        let strain_mean = |limb: usize| window.strain[limb] / sqrt(n);
        let strain_slope = |limb: usize| {
            (window.strain_ramp[limb] - 0.5 * (n - 1.0) * window.strain[limb])
                / sqrt(n * (n * n - 1.0) / 12.0)
        };
        match test {
            Test::Sample | Test::Mean(_) => self.weighted(&mean, |limb, errors| {
                square(strain_mean(limb) * errors.scale[limb]) + n * square(errors.drift[limb])
            }),
            Test::Slope(_) => self.weighted(&slope, |limb, errors| {
                square(strain_slope(limb) * errors.scale[limb])
            }),
            Test::Energy(_) => {
                let rest = window.rows.energy() - dot(&mean, &mean) - dot(&slope, &slope);
                let Some(errors) = &self.errors else {
                    return rest;
                };
                // The errors' expected share, taken off: the test stays on the safe side in expectation only.
                let sum = self.noise.whitened_sum(&core::array::from_fn(|limb| {
                    let rest = window.strain_square[limb]
                        - square(strain_mean(limb))
                        - square(strain_slope(limb));
                    rest.max(0.0) * square(errors.scale[limb])
                }));
                let share = (sum[0][0] + sum[1][1] + sum[2][2]) / (3.0 * n - 6.0);
                rest / (1.0 + share)
            }
        }
    }

    /// v^T (1 + what errors of calibration add)^-1 v.
    fn weighted(
        &self,
        v: &[f64; ROWS],
        variance: impl Fn(usize, &CalibrationErrors) -> f64,
    ) -> f64 {
        let Some(errors) = &self.errors else {
            return dot(v, v);
        };
        let mut sum = self
            .noise
            .whitened_sum(&core::array::from_fn(|limb| variance(limb, errors)));
        for (i, row) in sum.iter_mut().enumerate() {
            row[i] += 1.0;
        }
        // One plus a sum of squares has a root unless it overflowed, which is no strain of a healthy limb.
        let Some(root) = inverse_root(&sum) else {
            return f64::INFINITY;
        };
        let white = apply(&root, v);
        dot(&white, &white)
    }
}

fn square(x: f64) -> f64 {
    x * x
}
