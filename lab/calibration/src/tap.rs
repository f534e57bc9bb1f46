//! k/m from the session's taps: each evaluated by itself, then taken together.
//!
//! A tap is evaluated with scale factors and I/m of steps 2 and 3 and with what these are off by: noise and differences between
//! trials, which every entry has of its own, and the standards' class, which all entries of I/m have in common. What the
//! scale factors have in common a tap does not notice.
//!
//! An estimate's error has a part from the recording's noise, which is another in each tap, and one from what is known
//! beforehand, which is the same in all. Taps are weighed by the former; the latter does not average out.

use nalgebra::{Matrix6, Vector6};
use sixaxis_core::identify::tap::{self, Setup, Tap};
use sixaxis_core::identify::{Reason, Verdict};
use sixaxis_core::significance::{NORMAL_95, chi_square_limit};
use sixaxis_core::{Geometry, LIMBS, Parameters};

use crate::report::ParameterReport;
use crate::trial::Trial;

/// Relative standard deviation of an amplifier range's gain about another's: a tap is recorded in other ranges than step 2.
const RANGE_DEVIATION: f64 = 0.005;
/// And of I/m at least, over the mean moment: a covariance must not be singular.
const INERTIA_DEVIATION: f64 = 1e-6;
/// Noise of a tap, as a variance, over all of its error at least.
const LEAST_NOISE: f64 = 1e-6;
/// Share of what is known beforehand that a tap has of its own: half, for gains of ranges of which some differ.
const OWN_SHARE: f64 = 0.5;
/// What a shell that moves with a hundred times the seismic mass adds to k/m, relative, or flexures that carry half a per cent of the axial load
/// across. Nobody states either, and inertias tell them only where they are off by more than the angular trials leave open.
const HELD: f64 = 0.01;
/// How often inertias that are off by normal errors of the covariance that is known are taken for others. Those of a few wedges' trials scatter
/// more widely.
const BY_CHANCE: f64 = 1e-3;
/// Standard errors of their difference by which a tap may be off from all taps' mean.
const DISAGREE: f64 = 4.0;

/// One tap as it came out.
#[derive(Debug, Clone, PartialEq)]
pub struct TapReport {
    /// Its file.
    pub name: String,
    /// The fit, or why it leaves k/m undetermined.
    pub outcome: Result<Tap, String>,
}

/// k/m from all taps.
#[derive(Debug, Clone, PartialEq)]
pub struct Stiffness {
    /// k/m, 1/s^2.
    pub per_mass_per_s2: f64,
    /// Half width of the 95 % interval, 1/s^2.
    pub half_width_95: f64,
    /// Half width that the recordings' noise alone would give.
    pub from_noise: f64,
    /// Half width that errors of I/m and gains alone would give.
    pub from_known: f64,
    /// Half width that how still the shell is held alone would give.
    pub from_holding: f64,
    /// Taps that it is from.
    pub taps: usize,
}

/// The taps of a session.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Taps {
    /// Each.
    pub reports: Vec<TapReport>,
    /// All together; none where no tap determines k/m.
    pub stiffness: Option<Stiffness>,
    /// What is to be said against them.
    pub remarks: Vec<String>,
}

impl Taps {
    /// Evaluates the taps with the parameters in use, of which `known` says how well they are known; k/m is looked for about
    /// the design's.
    pub fn identify(
        trials: &[Trial],
        geometry: Geometry,
        used: &Parameters,
        design: &Parameters,
        known: &[ParameterReport],
    ) -> Self {
        let parameters = Parameters {
            stiffness_per_mass_per_s2: design.stiffness_per_mass_per_s2,
            ..*used
        };
        let reports: Vec<TapReport> = trials
            .iter()
            .map(|trial| TapReport {
                name: trial.name.clone(),
                outcome: evaluate(trial, geometry, &parameters, known),
            })
            .collect();
        let mut remarks: Vec<String> = reports
            .iter()
            .filter_map(|report| Some((report, report.outcome.as_ref().err()?)))
            .map(|(report, cause)| format!("{}: says nothing of k/m: {cause}", report.name))
            .collect();
        let used: Vec<(&TapReport, &Tap)> = reports
            .iter()
            .filter_map(|report| Some((report, report.outcome.as_ref().ok()?)))
            .collect();
        let stiffness = together(&used, &mut remarks);
        Self {
            reports,
            stiffness,
            remarks,
        }
    }
}

fn evaluate(
    trial: &Trial,
    geometry: Geometry,
    parameters: &Parameters,
    known: &[ParameterReport],
) -> Result<Tap, String> {
    let covariance = inertia_covariance(parameters, known);
    let setup = Setup {
        sensor: &trial.sensor(geometry),
        parameters,
        inertia_covariance_m4: covariance,
        gain_deviation: gain_deviation(known),
        sample_rate_hz: trial.sample_rate_hz,
        full_scale_v: trial.full_scale_v,
    };
    let tap = tap::identify(&setup, &trial.voltage_v).map_err(|e| format!("{e}; tap again"))?;
    if tap.verdict.is_determined() {
        let off = inertia_departure(&tap, parameters, &covariance);
        match off {
            Some(percent) => Err(format!(
                "its modes ask for other inertias than the angular trials, {percent:+.1} % in their sum, and more than these leave open: either the shell follows the mass, by which k/m would be off as much, and must be held by far more mass, or a standard's gain, or an angular trial, is wrong"
            )),
            None => Ok(tap),
        }
    } else if matches!(
        tap.verdict,
        Verdict::Undetermined {
            reason: Reason::Misfit { .. }
        }
    ) {
        Err(format!(
            "what follows the blow is not the decay of six modes, {:.1} % of it is left over; the shell must be held still, gain_n_per_v be this recording's, limbs alike to some tenths of a per cent and damped in proportion to their stiffness; tap again",
            100.0 * tap.residual_over_signal
        ))
    } else {
        Err(format!(
            "its noise leaves k/m uncertain by {:.0} %; tap again",
            100.0 * tap.standard_error_ln
        ))
    }
}

/// Sum of the moments over that which is known, less one, %, where the inertias that a tap asks for are further from those that are known
/// than these leave open. A shell that follows the mass raises the modes in which it travels, and only inertias that are larger as well bring
/// the others back to where they are.
fn inertia_departure(tap: &Tap, known: &Parameters, covariance: &Matrix6<f64>) -> Option<f64> {
    let [ours, theirs] = [tap.inertia_per_mass, known.inertia_per_mass].map(|i| i.to_paper_order());
    let departure = Vector6::from_fn(|k, _| ours[k] - theirs[k]);
    let squares = departure.dot(&covariance.cholesky()?.solve(&departure));
    let trace = |i: [f64; 6]| i[0] + i[1] + i[2];
    let limit = chi_square_limit(BY_CHANCE, 6).ok()?;
    (squares > limit).then(|| 100.0 * (trace(ours) / trace(theirs) - 1.0))
}

/// What differs from trial to trial, as a standard deviation.
fn differs(report: &ParameterReport) -> f64 {
    let noise = report.from_noise.unwrap_or(0.0);
    report.from_trials.unwrap_or(0.0).max(noise) / NORMAL_95
}

fn gain_deviation(known: &[ParameterReport]) -> [f64; LIMBS] {
    core::array::from_fn(|limb| {
        let own = known
            .get(LIMBS + limb)
            .map_or(0.0, |s| differs(s) / s.estimate.abs());
        RANGE_DEVIATION.hypot(own)
    })
}

fn inertia_covariance(parameters: &Parameters, known: &[ParameterReport]) -> Matrix6<f64> {
    let values = parameters.inertia_per_mass.to_paper_order();
    let least = INERTIA_DEVIATION * (values[0] + values[1] + values[2]) / 3.0;
    let of = |k: usize| known.get(2 * LIMBS + k);
    let own = Vector6::from_fn(|k, _| of(k).map_or(0.0, differs).hypot(least).powi(2));
    let common = Vector6::from_fn(|k, _| {
        let standards = of(k).and_then(|i| i.from_standards).unwrap_or(0.0);
        standards.copysign(values[k]) / NORMAL_95
    });
    Matrix6::from_diagonal(&own) + common * common.transpose()
}

/// Weighs taps by their noise and looks whether they agree.
fn together(used: &[(&TapReport, &Tap)], remarks: &mut Vec<String>) -> Option<Stiffness> {
    if used.is_empty() {
        return None;
    }
    let noise2 = |tap: &Tap| {
        let (whole, known) = (tap.standard_error_ln, tap.standard_error_known_ln);
        // What is left when one nearly equals the other is rounding.
        (whole * whole - known * known).max(LEAST_NOISE * whole * whole)
    };
    let weights: Vec<f64> = used.iter().map(|(_, tap)| 1.0 / noise2(tap)).collect();
    let total: f64 = weights.iter().sum();
    let mean = |of: &dyn Fn(&Tap) -> f64| -> f64 {
        let sum: f64 = used
            .iter()
            .zip(&weights)
            .map(|((_, tap), w)| w * of(tap))
            .sum();
        sum / total
    };
    let ln = mean(&|tap| tap.stiffness_per_mass_per_s2.ln());
    let known = mean(&|tap| tap.standard_error_known_ln);
    // What the taps have in common cannot set them apart: they are judged by their noise, and by the gains of the ranges they
    // were recorded in, which are another tap's only in part.
    let own2 = |tap: &Tap| noise2(tap) + (OWN_SHARE * tap.standard_error_known_ln).powi(2);
    let departure = |tap: &Tap| (tap.stiffness_per_mass_per_s2.ln() - ln) / own2(tap).sqrt();
    let worst = used
        .iter()
        .max_by(|a, b| departure(a.1).abs().total_cmp(&departure(b.1).abs()))?;
    let disagreement = departure(worst.1).abs();
    if disagreement > DISAGREE {
        remarks.push(format!(
            "{}: its k/m is {:.1} standard errors from that of all {} taps: tap again",
            worst.0.name,
            disagreement,
            used.len()
        ));
    }
    // Birge's ratio: as far apart as they are, they know no better.
    let chi_square: f64 = used.iter().map(|(_, tap)| departure(tap).powi(2)).sum();
    let freedom = used.len().saturating_sub(1).max(1) as f64;
    let wider = (chi_square / freedom).max(1.0).sqrt();
    let per_mass_per_s2 = ln.exp();
    let from_noise = NORMAL_95 * per_mass_per_s2 * wider / total.sqrt();
    let from_known = NORMAL_95 * per_mass_per_s2 * known;
    let from_holding = HELD * per_mass_per_s2;
    Some(Stiffness {
        per_mass_per_s2,
        half_width_95: from_noise.hypot(from_known).hypot(from_holding),
        from_noise,
        from_known,
        from_holding,
        taps: used.len(),
    })
}
