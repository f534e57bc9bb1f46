//! k/m from a tap: the shell is held by the rig and tapped, and the mass rings in it.
//!
//! In the band of step 4, k/m contributes some four millionths of the torques. The six modes of the mass, at 2 to 7 kHz, depend on it
//! directly: one of them, of the design at 4.85 kHz, is a translation and lies at sqrt(3 k/m) whatever I/m is, the others mix both. A tap of a tenth of a millisecond excites
//! all six, and some milliseconds of free decay in nine channels determine k/m at 1 % noise to 6e-4 where a limb
//! has 2 % of what is critical under the whole mass (the modes then have 2 to 5 %), and to 1e-4 where it has 0.5 % (root mean square).
//!
//! [`model`] is the decay and its derivatives, `fit` the least squares, `onset` finds the beginning and the useful length of the
//! decay, `evidence` tests the residuals.
//!
//! # Assumptions
//! - After the tap the shell is at rest, or moves so evenly that no force shows: the rig holds it. A shell that hangs free is the
//!   second body of a two-body problem with other frequencies: (1 + m/M) times the k/m of a translation. The shell's motion during
//!   the contact does not matter, nor do the tap's strength, place and direction.
//! - The limbs are equally stiff, with dampers in proportion.
//! - Anything linear and equal in all nine channels, an amplifier's bandwidth or an anti-aliasing filter, multiplies each mode by a
//!   number, and these factors are free. Unequal filters are not allowed: 1 us between channels is 2.5 degrees at 7 kHz.
//! - I/m comes with a covariance (step 3), the channels with standard deviations of their gains; both are estimated along. The
//!   common scale of the channels has no effect.
//! - Only I/m over the square of the half edge matters. The half edge is the drawing's, as in step 3.

mod evidence;
mod fit;
pub mod model;
mod onset;

use core::ops::Range;

use alloc::vec::Vec;

use nalgebra::{Matrix6, SMatrix};

use self::evidence::Evidence;
use self::fit::{Fitted, Prior, Shared, Unknowns, Window};
pub use self::model::{MODES, RingDown, SHARED};
use super::{Reason, Verdict, noise_verdict};
use crate::error::{Error, Result, require, require_positive};
use crate::float::sqrt;
use crate::geometry::LIMBS;
use crate::model::Sensor;
use crate::model::{InertiaPerMass, Parameters};
use crate::paper::signal::SignalChain;
use crate::recording::check_channels;
use crate::significance::NORMAL_95;

/// Name of the step in errors.
const WHAT: &str = "stiffness per mass (tap)";

/// Samples per period of the highest mode that are asked for.
pub const SAMPLES_PER_PERIOD: f64 = 3.0;
/// The search for k/m extends from the design's value over this factor to the design's times it.
pub const SEARCH_FACTOR: f64 = 4.0;
/// From one candidate to the next. In the first stretch the modes turn 15 to 60 rad, so that half a step is off by a third of a
/// radian in the fastest.
const SEARCH_STEP: f64 = 1.02;
/// Minima of the search from which a fit is started.
const CANDIDATES: usize = 3;
/// Damping ratio that the search begins with.
const TYPICAL_DAMPING: f64 = 0.02;
/// Length of the stretch in which k/m is searched, s; three periods of a slow sensor's lowest mode.
const FIRST_STRETCH_S: f64 = 1.5e-3;
/// Initial noise, over the peak of the largest channel.
const NOISE_AT_FIRST: f64 = 0.02;
/// Least noise, over a channel's own peak: rounding and the limbs' geometry leave as much of a simulated decay.
const NOISE_AT_LEAST: f64 = 1e-9;
/// Repetitions of the fit at full length, each with the noise of the one before.
const REWEIGHTED: usize = 2;
/// Least share of the variance that six decaying modes explain if there is a decay.
const EXPLAINED: f64 = 0.5;
/// How often, and by how much, s, the beginning is delayed where the residual is larger there than later.
const DELAY: usize = 8;
const DELAY_S: f64 = 0.25e-3;
/// Length of the beginning that is compared with the second half, s.
const BEGINNING_S: f64 = 0.5e-3;

/// The sensor, its parameters and their errors, with which a tap is evaluated.
#[derive(Debug, Clone, PartialEq)]
pub struct Setup<'a> {
    /// Geometry and amplifier gains.
    pub sensor: &'a Sensor,
    /// Scale factors and I/m as identified; k/m of the design, about which is searched. Zero drifts are not used.
    pub parameters: &'a Parameters,
    /// Covariance of I1 to I6 over m, m^4: noise and what is common to all trials.
    pub inertia_covariance_m4: Matrix6<f64>,
    /// Relative standard deviation of each channel's gain, c_i s_i/m, about what is common to all.
    pub gain_deviation: [f64; LIMBS],
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Limit of the converter, V; infinite for none.
    pub full_scale_v: f64,
}

/// The result of a tap.
#[derive(Debug, Clone, PartialEq)]
pub struct Tap {
    /// k/m, s^-2.
    pub stiffness_per_mass_per_s2: f64,
    /// Standard error of ln k/m.
    pub standard_error_ln: f64,
    /// The part of it that comes from the errors of I/m and gains, which all taps evaluated with them share.
    pub standard_error_known_ln: f64,
    /// Damping of one limb as a share of critical under the whole mass: c/m = 2 z sqrt(k/m).
    pub damping_ratio: f64,
    /// I/m, that of step 3 improved by the tap.
    pub inertia_per_mass: InertiaPerMass,
    /// Covariance of ln k/m, damping ratio, I1 to I6 over m.
    pub covariance: SMatrix<f64, SHARED, SHARED>,
    /// ln of each channel's gain over what it was given as, the common part undetermined.
    pub gain_ln: [f64; LIMBS],
    /// Frequencies without damping, ascending, Hz.
    pub mode_frequencies_hz: [f64; MODES],
    /// Damping ratios of the modes.
    pub mode_damping_ratios: [f64; MODES],
    /// Standard deviation of each channel's noise, from the residuals, V.
    pub noise_v: [f64; LIMBS],
    /// Residual over signal at the beginning of the decay.
    pub residual_over_signal: f64,
    /// Correlation of neighbouring residuals: 0 is white.
    pub residual_correlation: f64,
    /// Samples of the decay that were fitted.
    pub fitted: Range<usize>,
    /// Whether the tap determines k/m.
    pub verdict: Verdict,
}

impl Tap {
    /// The 95 % interval of k/m, s^-2.
    #[must_use]
    pub fn interval_95_per_s2(&self) -> (f64, f64) {
        let factor = crate::float::exp(NORMAL_95 * self.standard_error_ln);
        let k = self.stiffness_per_mass_per_s2;
        (k / factor, k * factor)
    }
}

impl Setup<'_> {
    fn prior(&self) -> Result<Prior> {
        self.parameters.validate()?;
        self.sensor.geometry.validate()?;
        self.sensor.gains.validate()?;
        self.sensor.gains.validate_with(self.parameters)?;
        for value in self.gain_deviation {
            require(
                value > 0.0 && (1.0 / value).is_finite() && value.is_finite(),
                "gain_deviation",
                value,
                "positive and finite",
            )?;
        }
        require_positive("sample_rate_hz", self.sample_rate_hz)?;
        let whitening = self
            .inertia_covariance_m4
            .cholesky()
            .and_then(|root| root.l().solve_lower_triangular(&Matrix6::identity()))
            .filter(|inverse| inverse.iter().sum::<f64>().is_finite())
            .ok_or(Error::out_of_range(
                "inertia_covariance_m4",
                self.inertia_covariance_m4.trace(),
                "positive definite",
            ))?;
        Ok(Prior {
            geometry: self.sensor.geometry,
            inertia_m2: self.parameters.inertia_per_mass.to_paper_order(),
            whitening,
            gain_deviation: self.gain_deviation,
        })
    }

    fn start(&self) -> Unknowns {
        Unknowns {
            stiffness_per_mass_per_s2: self.parameters.stiffness_per_mass_per_s2,
            damping_ratio: TYPICAL_DAMPING,
            inertia_m2: self.parameters.inertia_per_mass.to_paper_order(),
            gain_ln: [0.0; LIMBS],
        }
    }

    /// Refuses a sample rate that is too low for the highest mode.
    fn check_rate(&self, ring: &RingDown) -> Result<()> {
        let highest_mode_hz = ring.frequencies_hz()[MODES - 1];
        if self.sample_rate_hz < SAMPLES_PER_PERIOD * highest_mode_hz {
            return Err(Error::SampledTooSlowly {
                sample_rate_hz: self.sample_rate_hz,
                highest_mode_hz,
                needed_hz: SAMPLES_PER_PERIOD * highest_mode_hz,
            });
        }
        Ok(())
    }

    fn samples(&self, duration_s: f64) -> usize {
        (duration_s * self.sample_rate_hz) as usize
    }
}

/// Identifies k/m from the recording of one tap.
///
/// # Errors
/// [`Error::OutOfRange`] for settings that cannot be; those of [`check_channels`], a clipped sample anywhere among them;
/// [`Error::SampledTooSlowly`] below [`SAMPLES_PER_PERIOD`] of the highest mode; [`Error::TooFewSamples`] if the decay is shorter
/// than 1.5 ms; [`Error::NoRingDown`] where no k/m within [`SEARCH_FACTOR`] of the design's explains half of what follows the largest
/// sample; [`Error::NotConverged`] and [`Error::RankDeficient`] of the fit.
pub fn identify(setup: &Setup, voltage_v: &[[f64; LIMBS]]) -> Result<Tap> {
    let prior = setup.prior()?;
    let chain = SignalChain::new(&setup.sensor.gains, setup.parameters);
    check_channels(voltage_v, setup.full_scale_v)?;
    let mut unknowns = setup.start();
    setup.check_rate(&RingDown::new(
        &prior.geometry,
        &setup.parameters.inertia_per_mass,
        unknowns.stiffness_per_mass_per_s2,
        unknowns.damping_ratio,
    )?)?;
    let onset = onset::find(voltage_v, setup.sample_rate_hz);
    let shortest = setup.samples(FIRST_STRETCH_S).max(8);
    let window = |range: Range<usize>, noise_v: [f64; LIMBS]| Window {
        voltage_v: &voltage_v[range],
        step_s: 1.0 / setup.sample_rate_hz,
        volts_per_m_s2: chain.sensitivity_m_s2_per_v().map(|s| 1.0 / s),
        noise_v,
    };
    let largest = onset.peak_v.iter().fold(0.0_f64, |a, b| a.max(*b));
    let mut noise_v = [NOISE_AT_FIRST * largest; LIMBS];
    let mut searched = false;
    let mut delay = 0;
    loop {
        let from = onset.decay_from + delay * setup.samples(DELAY_S);
        let decay = from..onset::end(voltage_v, &onset, from, setup.sample_rate_hz).max(from);
        if decay.len() < shortest {
            return Err(Error::TooFewSamples {
                what: "the decay after a tap",
                needed: from + shortest,
                got: voltage_v.len(),
            });
        }
        if !searched {
            let first = window(from..from + shortest, noise_v);
            unknowns = search(setup, &prior, &first)?;
            let mut length = 2 * shortest;
            while length < decay.len() {
                let stretch = window(from..from + length, noise_v);
                unknowns = stretch.fit(&prior, &unknowns)?.0.unknowns;
                length *= 2;
            }
            searched = true;
        }
        let mut whole = window(decay.clone(), noise_v);
        let (mut fitted, mut covariance) = whole.fit(&prior, &unknowns)?;
        for _ in 0..REWEIGHTED {
            noise_v = noise(&fitted, decay.len(), &onset.peak_v);
            whole.noise_v = noise_v;
            (fitted, covariance) = whole.fit(&prior, &fitted.unknowns)?;
        }
        setup.check_rate(&fitted.ring)?;
        let evidence = Evidence::of(
            &whole,
            &fitted,
            &onset.level_v,
            setup.samples(BEGINNING_S).max(1),
        );
        if evidence.still_driven() && delay < DELAY {
            delay += 1;
            unknowns = fitted.unknowns;
            continue;
        }
        return Ok(conclude(&fitted, covariance, noise_v, &evidence, decay));
    }
}

/// Searches k/m in the first stretch: over a grid, then by fits from its best minima.
fn search(setup: &Setup, prior: &Prior, first: &Window) -> Result<Unknowns> {
    let start = setup.start();
    let design = start.stiffness_per_mass_per_s2;
    let mut curve: Vec<(Unknowns, f64)> = Vec::new();
    let mut k = design / SEARCH_FACTOR;
    while k <= design * SEARCH_FACTOR {
        let unknowns = Unknowns {
            stiffness_per_mass_per_s2: k,
            ..start
        };
        k *= SEARCH_STEP;
        // A candidate out of range or too fast for the sample rate is excluded.
        if let Ok(fitted) = first.solve(prior, &unknowns)
            && setup.check_rate(&fitted.ring).is_ok()
        {
            curve.push((unknowns, fitted.cost));
        }
    }
    let mut minima: Vec<(Unknowns, f64)> = (0..curve.len())
        .filter(|i| {
            let cost = curve[*i].1;
            curve[i.saturating_sub(1)].1 >= cost && curve[(i + 1).min(curve.len() - 1)].1 >= cost
        })
        .map(|i| curve[i])
        .collect();
    minima.sort_by(|a, b| a.1.total_cmp(&b.1));
    let best = minima
        .iter()
        .take(CANDIDATES)
        .filter_map(|(unknowns, _)| first.fit(prior, unknowns).ok())
        .min_by(|a, b| a.0.cost.total_cmp(&b.0.cost));
    let explained = best.as_ref().map_or(0.0, |(fitted, _)| {
        let left: f64 = fitted.squares_v2.iter().sum();
        1.0 - left / variance(first.voltage_v)
    });
    match best {
        // Written so that 0/0 is refused.
        Some((fitted, _)) if explained > EXPLAINED => Ok(fitted.unknowns),
        _ => Err(Error::NoRingDown {
            explained: explained.clamp(0.0, 1.0),
        }),
    }
}

/// Sum of squares about each channel's mean.
fn variance(voltage_v: &[[f64; LIMBS]]) -> f64 {
    let n = voltage_v.len() as f64;
    (0..LIMBS)
        .map(|limb| {
            let mean = voltage_v.iter().map(|row| row[limb]).sum::<f64>() / n;
            voltage_v
                .iter()
                .map(|row| (row[limb] - mean) * (row[limb] - mean))
                .sum::<f64>()
        })
        .sum()
}

/// Each channel's noise from its residuals, with its share of the common unknowns taken off the degrees of freedom.
fn noise(fitted: &Fitted, samples: usize, peak_v: &[f64; LIMBS]) -> [f64; LIMBS] {
    let own = 2.0 + (SHARED + 2 * MODES) as f64 / LIMBS as f64;
    core::array::from_fn(|i| {
        sqrt(fitted.squares_v2[i] / (samples as f64 - own)).max(NOISE_AT_LEAST * peak_v[i])
    })
}

fn conclude(
    fitted: &Fitted,
    shared: Shared,
    noise_v: [f64; LIMBS],
    evidence: &Evidence,
    decay: Range<usize>,
) -> Tap {
    // Correlated noise carries less information than its variance implies: at worst, at low frequency, by this factor.
    let rho = evidence.correlation.clamp(0.0, 0.99);
    let inflated = (1.0 + rho) / (1.0 - rho);
    let Shared {
        covariance,
        from_known_ln2,
    } = shared;
    let covariance = covariance * inflated;
    let standard_error_ln = sqrt(covariance[(0, 0)]);
    let verdict = if evidence.still_driven() || evidence.coloured() {
        Verdict::Undetermined {
            reason: Reason::Misfit {
                residual_over_signal: evidence.residual_over_signal,
                correlation: evidence.correlation,
            },
        }
    } else {
        noise_verdict(&[1.0], &[standard_error_ln])
    };
    Tap {
        stiffness_per_mass_per_s2: fitted.unknowns.stiffness_per_mass_per_s2,
        standard_error_ln,
        standard_error_known_ln: sqrt(from_known_ln2 * inflated).min(standard_error_ln),
        damping_ratio: fitted.unknowns.damping_ratio,
        inertia_per_mass: InertiaPerMass::from_paper_order(fitted.unknowns.inertia_m2),
        covariance,
        gain_ln: fitted.unknowns.gain_ln,
        mode_frequencies_hz: fitted.ring.frequencies_hz(),
        mode_damping_ratios: fitted.ring.damping_ratios(),
        noise_v,
        residual_over_signal: evidence.residual_over_signal,
        residual_correlation: evidence.correlation,
        fitted: decay,
        verdict,
    }
}
