//! Detection: tests of the parity rows with exact distributions, thresholds from a rate of false alarms.
//!
//! For a healthy sensor z_t = L^-1 rho_t is white and standard normal ([`super::noise`]). Of each sample |z|^2 is chi-square with
//! three degrees of freedom. Of a window of N samples, mean, slope and the energy of the rest are independent, chi-square with
//! 3, 3 and 3 N - 6. A window of 8 detects within a millisecond what a single sample cannot, one of 4096 detects a drift.
//!
//! The rate of false alarms is the expected number of failed tests, a sum over the tests of how often each is made times its
//! probability. This is linear, and hence exact however the tests depend on one another; each test has an equal share of it.
//!
//! Errors of calibration are not noise: they persist. Relative errors of covariance E in the strain that a volt of each channel is,
//! shares of cross-talk of deviation c and errors of the zero drifts add
//!
//! ```text
//! W^T (diag(x) E diag(x) + diag(c^2 (|x|^2 - x_i^2) + sd_drift^2)) W
//! ```
//!
//! to the covariance of a sample or of a mean, and the same of a slope with the strains' slope. With [`CalibrationErrors`] given,
//! these tests are not exceeded more often than stated over calibrations, and less often where E says more than is so: asked for one alarm an hour, the
//! published run (`props/results/watch.json`) has 28 and 29 in 44.6 h of calibrated streams. A limb stiffer than the others by a share e makes rows as a scale factor
//! off by -e does: an error of its stiffness is one of E, too. To the energy of a window
//! the errors of one calibration, which are the same in all of its samples, may add many times their expectation: as often as the test
//! may fail, they do not exceed it by more than chi-square with one degree of freedom exceeds one, which the test allows for.

use super::calibration_errors::CalibrationErrors;
use super::noise::{RowNoise, apply, dot, inverse_root};
use super::window::Window;
use crate::error::{Result, require, require_not_negative};
use crate::geometry::LIMBS;
use crate::limb_set::LimbSet;
use crate::redundancy::parity::ROWS;
use crate::significance::chi_square_limit;

/// Lengths of the windows, samples.
pub const WINDOWS: [u64; 4] = [8, 64, 512, 4096];

/// Samples of the shortest window.
const BLOCK: usize = WINDOWS[0] as usize;

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

    /// Degrees of freedom of its statistic, of three relations.
    #[must_use]
    pub const fn freedom(self) -> usize {
        match self {
            Self::Sample | Self::Mean(_) | Self::Slope(_) => 3,
            Self::Energy(n) => 3 * n as usize - 6,
        }
    }
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

/// The tests.
#[derive(Debug, Clone, PartialEq)]
pub struct Detector {
    noise: RowNoise,
    errors: Option<CalibrationErrors>,
    rate: f64,
    thresholds: [f64; TESTS.len()],
    /// How many times their expectation the errors of one calibration may add to an energy.
    energy_margin: f64,
    /// The rows and strains of the window that is being filled, of the shortest ones.
    block: [([f64; ROWS], [f64; LIMBS]); BLOCK],
    filled: usize,
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
            .flat_map(|e| e.alone.into_iter().chain(e.drift))
        {
            require_not_negative("standard deviation of a calibration error", value)?;
        }
        let mut detector = Self {
            noise,
            errors,
            rate,
            thresholds: [0.0; TESTS.len()],
            energy_margin: 0.0,
            block: [([0.0; ROWS], [0.0; LIMBS]); BLOCK],
            filled: 0,
            windows: [Window::default(); WINDOWS.len()],
            received: 0,
        };
        detector.set_thresholds()?;
        Ok(detector)
    }

    /// The same tests of the relations that are left without some limbs, begun anew.
    ///
    /// # Errors
    /// [`crate::Error::OutOfRange`] where none is left.
    pub fn without(&self, limbs: LimbSet) -> Result<Self> {
        let mut detector = Self {
            noise: self.noise.without(limbs),
            ..self.clone()
        };
        detector.restart();
        detector.set_thresholds()?;
        Ok(detector)
    }

    fn set_thresholds(&mut self) -> Result<()> {
        let share = self.rate / TESTS.len() as f64;
        let mut thresholds = [0.0; TESTS.len()];
        for (threshold, test) in thresholds.iter_mut().zip(TESTS) {
            let probability = share * test.samples() as f64;
            *threshold = chi_square_limit(probability, self.freedom(test))?;
            if let Test::Energy(_) = test {
                self.energy_margin = chi_square_limit(probability, 1)?;
            }
        }
        self.thresholds = thresholds;
        Ok(())
    }

    /// Zeros are off by these deviations by now, strain, and change by these variances from sample to sample, strain^2.
    pub(super) fn set_zero_errors(&mut self, drift: [f64; LIMBS], steps: [[f64; LIMBS]; 2]) {
        let exact = CalibrationErrors::independent([0.0; LIMBS], [0.0; LIMBS]);
        let errors = self.errors.get_or_insert(exact);
        errors.drift = drift;
        errors.drift_steps = steps;
    }

    /// The errors of calibration that it allows for.
    #[must_use]
    pub const fn errors(&self) -> Option<&CalibrationErrors> {
        self.errors.as_ref()
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

    /// The window of that length as it was filled last: what a test looked at.
    pub(super) fn window_of(&self, test: Test) -> Window {
        let place = WINDOWS.iter().position(|&n| n == test.samples());
        place
            .and_then(|place| self.windows.get(place))
            .copied()
            .unwrap_or_default()
    }

    /// Takes the whitened rows and the strains, counted from rest, of a sample and makes the tests that are due.
    pub fn push(&mut self, z: &[f64; ROWS], strain: &[f64; LIMBS]) -> Alarms {
        if self.take(z, strain) {
            self.tests(z, strain)
        } else {
            Alarms::default()
        }
    }

    /// The same, of the alarms the first.
    #[inline]
    pub(super) fn first_alarm(&mut self, z: &[f64; ROWS], strain: &[f64; LIMBS]) -> Option<Alarm> {
        if self.take(z, strain) {
            self.tests(z, strain).first()
        } else {
            None
        }
    }

    /// Whether a test is due of which the outcome is open.
    #[inline]
    fn take(&mut self, z: &[f64; ROWS], strain: &[f64; LIMBS]) -> bool {
        self.received += 1;
        if let Some(row) = self.block.get_mut(self.filled) {
            *row = (*z, *strain);
        }
        self.filled += 1;
        if self.filled < BLOCK {
            return dot(z, z) > self.thresholds[0];
        }
        self.end_block();
        // Mostly the shortest window alone is full, and quiet.
        let [shortest, next, ..] = &self.windows;
        next.rows.samples() == WINDOWS[1]
            || dot(z, z) > self.thresholds[0]
            || shortest.rows.energy_of_mean() > self.thresholds[1]
    }

    /// Each window is made of those before it: eight of one are the next. A full one stays to be looked at until the next block.
    #[inline(never)]
    fn end_block(&mut self) {
        self.filled = 0;
        let [shortest, longer @ ..] = &mut self.windows;
        *shortest = Window::of(&self.block);
        let mut earlier = Some(&*shortest);
        for (window, length) in longer.iter_mut().zip(WINDOWS.into_iter().skip(1)) {
            if window.rows.samples() == length {
                *window = Window::default();
            }
            let Some(full) = earlier.take() else {
                continue;
            };
            window.append(full);
            if window.rows.samples() == length {
                earlier = Some(&*window);
            }
        }
    }

    #[inline(never)]
    fn tests(&mut self, z: &[f64; ROWS], strain: &[f64; LIMBS]) -> Alarms {
        let mut alarms = Alarms::default();
        for ((test, &threshold), alarm) in TESTS.iter().zip(&self.thresholds).zip(&mut alarms.0) {
            if !self.is_due(*test) {
                continue;
            }
            let statistic = self.statistic(*test, threshold, z, strain);
            if statistic > threshold {
                *alarm = Some(Alarm {
                    sample: self.received.saturating_sub(1),
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
        self.filled = 0;
        self.windows = [Window::default(); WINDOWS.len()];
    }

    fn is_due(&self, test: Test) -> bool {
        let mut windows = self.windows.iter().zip(WINDOWS);
        let window = windows.find(|(_, length)| *length == test.samples());
        window.is_none_or(|(window, length)| self.filled == 0 && window.rows.samples() == length)
    }

    /// Calibration's errors only lessen a statistic: where it is below the threshold without them they are left out.
    fn statistic(&self, test: Test, threshold: f64, z: &[f64; ROWS], strain: &[f64; LIMBS]) -> f64 {
        if test == Test::Sample && dot(z, z) <= threshold {
            return dot(z, z);
        }
        let mut windows = self.windows.iter().zip(WINDOWS);
        let mut one = Window::default();
        let window = match windows.find(|(_, length)| *length == test.samples()) {
            Some((window, _)) => window,
            None => {
                one.push(z, strain);
                &one
            }
        };
        let [mean, slope] = window.rows.mean_and_slope();
        let all = window.all();
        let alone = match test {
            Test::Sample | Test::Mean(_) => all.mean,
            Test::Slope(_) => all.slope,
            Test::Energy(_) => all.rest,
        };
        let Some(errors) = self.errors.as_ref().filter(|_| alone > threshold) else {
            return alone;
        };
        let added = window.errors(&self.noise, errors);
        match test {
            Test::Sample | Test::Mean(_) => weighted(&mean, added.mean),
            Test::Slope(_) => weighted(&slope, added.slope),
            Test::Energy(_) => {
                let share = added.rest[0][0] + added.rest[1][1] + added.rest[2][2];
                alone / (1.0 + self.energy_margin * share / self.freedom(test) as f64)
            }
        }
    }

    fn freedom(&self, test: Test) -> usize {
        test.freedom() / ROWS * self.noise.relations()
    }
}

/// v^T (1 + what errors of calibration add)^-1 v.
fn weighted(v: &[f64; ROWS], mut added: [[f64; ROWS]; ROWS]) -> f64 {
    for (i, row) in added.iter_mut().enumerate() {
        row[i] += 1.0;
    }
    // One plus a sum of squares has a root unless it overflowed, which is no strain of a healthy limb.
    let Some(root) = inverse_root(&added) else {
        return f64::INFINITY;
    };
    let white = apply(&root, v);
    dot(&white, &white)
}
