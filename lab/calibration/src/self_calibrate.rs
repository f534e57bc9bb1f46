//! A calibration is checked with a recording from the field, without any standard.

mod cause;
mod common;
mod correction;
mod measured;
mod summary;

use std::path::Path;

use anyhow::{Context, Result, bail, ensure};
use sixaxis_core::paper::signal::SignalChain;
use sixaxis_core::redundancy::parity::AMBIGUOUS_PAIRS;
use sixaxis_core::redundancy::self_calibration::{
    Drifted, KnownChange, Limits, PerLimbs, ScaleRatios, Scales, drifted,
};
use sixaxis_core::{Error, LIMBS, LimbSet};

use crate::apply::setup::Setup;
use crate::calibration::Calibration;

use cause::{Expected, Judged};
use common::Common;
use measured::Measured;
pub use measured::Rest;
pub use summary::{Finding, Summary};

/// Misfit, as a probability, from which limbs are not named.
const MISFIT: f64 = 1e-6;
/// Correlation of neighbouring blocks, in deviations and as such, from which the intervals are reported as too narrow.
const CORRELATED: (f64, f64) = (5.0, 0.1);
/// Logarithm of a factor from which a change is hardly a limb's own.
const NO_DRIFT: f64 = 0.1;
/// Standard deviations within which two changes are what exchanged plugs would show.
const EXCHANGED: f64 = 3.0;
/// What breaks the equations.
const NO_MODEL: &str = "Cross-talk, a bent frame, a channel that is dead or not linear";
/// Largest logarithm of a common factor that is accepted: half as much again.
const LARGEST_COMMON: f64 = 0.4;

/// What is checked with what.
pub struct Check<'a> {
    /// The calibration.
    pub calibration: &'a Calibration,
    /// Its name.
    pub calibration_name: &'a Path,
    /// The recording of a tumble.
    pub recording: &'a Path,
    /// One at the time of the calibration.
    pub since: Option<&'a Path>,
    /// What is known of a recording.
    pub setup: &'a dyn Fn(&Path) -> Result<Setup>,
    /// Known change of acceleration between two rests.
    pub known_change: Option<Known>,
    /// How often a sensor that has not drifted is reported to have.
    pub false_alarm: f64,
    /// Whether the calibration's own errors are left out.
    pub calibration_exact: bool,
    /// Whether a calibration is corrected by changes that are hardly drift, too.
    pub force: bool,
}

/// A known change of acceleration.
#[derive(Debug, Clone, Copy)]
pub struct Known {
    /// Its length, m/s^2.
    pub length_m_s2: f64,
    /// Standard deviation of that, m/s^2.
    pub deviation_m_s2: f64,
    /// The rests before and after.
    pub rests: [Rest; 2],
}

impl Check<'_> {
    /// Measures, and names limbs that have drifted. `correct` asks for the calibration with the scale factors that were
    /// found; `advance` is told of the samples that there are and of those that have been read since.
    ///
    /// # Errors
    /// A recording that cannot be read, a known change that contradicts it, a correction that is not determined. A recording
    /// that leaves ratios unobservable is no error but a [`Finding`].
    pub fn run(
        &self,
        correct: bool,
        advance: &dyn Fn(u64, u64),
    ) -> Result<(Summary, Option<Calibration>)> {
        let own = (self.setup)(self.recording)?;
        let rests = self.known_change.map(|known| known.rests);
        let measured = Measured::of(self.recording, &own, rests, advance)?;
        let mut summary = Summary::new(self, &measured);
        summary.notes.extend(own.notes.iter().cloned());
        let (ln_stiffness, stated) = correction::strains_per_v(self.calibration)?;
        let judged = self.judged(&measured, &ln_stiffness);
        let now = match measured.moments.ratios(&Limits::default()) {
            Ok(ratios) => ratios,
            Err(Error::UnobservableScaleRatios { directions }) => {
                summary.open = directions.pairs().map(Into::into).collect();
                summary.put_open(directions.to_string(), judged);
                return Ok((summary, None));
            }
            Err(error @ Error::NotConverged { .. }) => {
                summary.finding = Finding::Misfit;
                let place = self.recording.display();
                summary
                    .warnings
                    .push(format!("{place}: {error}: {NO_MODEL}"));
                return Ok((summary, None));
            }
            Err(error) => return Err(measured.explained(self.recording, error)),
        };
        let stated = if self.calibration_exact {
            PerLimbs::zeros()
        } else {
            stated
        };
        // A stiffer limb shows less of a force, as one of a smaller scale factor does.
        let with_stiffness = |ratios: ScaleRatios| ScaleRatios {
            ln_ratio: core::array::from_fn(|i| ratios.ln_ratio[i] + ln_stiffness[i]),
            ..ratios
        };
        let now = with_stiffness(now);
        let ratios = match self.since {
            None => now,
            Some(path) => {
                let then = Measured::of(path, &(self.setup)(path)?, None, advance)?;
                summary.warnings.extend(then.warnings.iter().cloned());
                let then = then
                    .moments
                    .ratios(&Limits::default())
                    .map(with_stiffness)
                    .map_err(|error| then.explained(path, error))?;
                ScaleRatios {
                    ln_ratio: core::array::from_fn(|i| now.ln_ratio[i] - then.ln_ratio[i]),
                    covariance: now.covariance + then.covariance,
                    ..now
                }
            }
        };
        let calibrated = match self.since {
            None => stated,
            Some(_) => PerLimbs::zeros(),
        };
        note_misfit(&mut summary, &now, judged);
        let found = drifted(&ratios, &calibrated, self.false_alarm).context("--false-alarm")?;
        summary.put(&found);
        let own_share = drifted(&ratios, &PerLimbs::zeros(), self.false_alarm);
        let own_share = own_share.context("--false-alarm")?;
        summary.put_unknown(&found, &own_share, NO_DRIFT, judged);
        let scales = match (self.known_change, &measured.change) {
            (Some(known), Some(change)) => {
                let chain = SignalChain::new(&own.sensor.gains, &own.parameters);
                let with_errors = ScaleRatios {
                    covariance: now.covariance + stated,
                    ..now
                };
                let scales = KnownChange {
                    voltage_change_v: change.voltage_v,
                    voltage_deviation_v: change.deviation_v,
                    length_m_s2: known.length_m_s2,
                    length_deviation_m_s2: known.deviation_m_s2,
                }
                .scales(&chain, &with_errors)
                .context("--known-change")?;
                ensure!(
                    scales.ln_common.abs() < LARGEST_COMMON,
                    "--known-change: between the rests the forces change by {:.2} m/s², not {}; was the sensor at rest there, and turned in between?",
                    known.length_m_s2 * (-scales.ln_common).exp(),
                    known.length_m_s2
                );
                let calibrated = if self.calibration_exact {
                    0.0
                } else {
                    correction::common_deviation(self.calibration)
                };
                let common = Common::of(&scales, found.limbs, calibrated, self.false_alarm)
                    .context("--false-alarm")?;
                summary.put_scales(&scales, &common);
                Some(scales)
            }
            _ => None,
        };
        let doubt = plugs_exchanged(&found, &own, &ln_stiffness)
            .or_else(|| no_drift(&found, scales.as_ref()));
        ensure!(
            !correct || self.force || doubt.is_none(),
            "--write-calibration: {} --force writes it nonetheless",
            doubt.unwrap_or_default()
        );
        summary.warnings.extend(doubt);
        let corrected = correct
            .then(|| corrected(self.calibration, &summary, &found, scales.as_ref()))
            .transpose()?;
        Ok((summary, corrected))
    }

    /// What the channels say of themselves; none where the calibration does not state their noise.
    fn judged(&self, measured: &Measured, ln_stiffness: &[f64; LIMBS]) -> Option<Judged> {
        let noise = self.calibration.covariance.propagated.as_ref()?;
        let limbs = self.calibration.limbs.as_ref();
        measured.scatter.judge(&Expected {
            noise_v: &noise.channel_noise_v,
            ln_stiffness,
            cross_talk_sd: limbs.map_or(0.0, |limbs| limbs.cross_talk_spread),
        })
    }
}

/// Why what was found is hardly a drift: a change as large as a step of an amplifier's range, and none of a few years.
fn no_drift(found: &Drifted, scales: Option<&Scales>) -> Option<String> {
    let ln = |limb: usize| match scales {
        Some(scales) => scales.ln_scale[limb],
        None if found.limbs.contains(limb) => found.ln_change[limb],
        None => 0.0,
    };
    if let Some(scales) = scales
        && scales.ln_common.abs() > NO_DRIFT
    {
        return Some(format!(
            "all nine would have changed together by {:+.1} %, and limbs rarely do: is --known-change right, and was the sensor at rest in both --rests and turned in between?",
            1e2 * scales.ln_common.exp_m1()
        ));
    }
    let far: Vec<usize> = (0..LIMBS)
        .filter(|limb| ln(*limb).abs() > NO_DRIFT)
        .collect();
    let change = |limb: &usize| format!("limb {} by {:+.1} %", limb + 1, 1e2 * ln(*limb).exp_m1());
    let changes: Vec<String> = far.iter().map(change).collect();
    let whose = match far.len() {
        0 => return None,
        1 => "is its gain (--gain or --session) the range",
        _ => "are their gains (--gain or --session) the ranges",
    };
    Some(format!(
        "limbs rarely drift as far as it would have been ({}): {whose} that this recording was made with?",
        changes.join(", ")
    ))
}

/// Why two changes are hardly drift: limbs of a pair stand in the same equations, so that each limb's signal in the other's
/// channel, before the amplifiers or behind them, is two changes of opposite sign, of the size that their scale factors say.
fn plugs_exchanged(found: &Drifted, setup: &Setup, ln_stiffness: &[f64; LIMBS]) -> Option<String> {
    let [i, j] = AMBIGUOUS_PAIRS
        .into_iter()
        .find(|[i, j]| found.limbs == LimbSet::EMPTY.with(*i).with(*j))?;
    let scale = &setup.parameters.scale_per_mass_per_kg;
    let gain = &setup.sensor.gains.gain_n_per_v;
    let before = (scale[j] / scale[i]).ln() + ln_stiffness[i] - ln_stiffness[j];
    let behind = before + (gain[j] / gain[i]).ln();
    let is = |expected: f64| {
        [(i, expected), (j, -expected)]
            .iter()
            .all(|&(limb, x)| (found.ln_change[limb] - x).abs() < EXCHANGED * found.deviation[limb])
    };
    (is(before) || is(behind)).then(|| {
        format!(
            "limbs {} and {} would show the same with their plugs exchanged, which no motion tells from two drifts: is each in its own channel?",
            i + 1,
            j + 1
        )
    })
}

/// Warns of what contradicts the equations or the model of the noise.
fn note_misfit(summary: &mut Summary, ratios: &ScaleRatios, judged: Option<Judged>) {
    summary
        .warnings
        .extend(judged.and_then(summary::contradiction));
    if ratios.misfit.chance() < MISFIT {
        summary.finding = Finding::Misfit;
        summary.warnings.push(format!(
            "the three equations contradict each other: limb 1 would have to count {:+.3} % more in its first row than in its second ({:.0} standard deviations). {NO_MODEL}",
            1e2 * ratios.misfit.ln_ratio,
            ratios.misfit.z().abs()
        ));
    }
    if ratios.lag_one_z() > CORRELATED.0 && ratios.lag_one_correlation > CORRELATED.1 {
        summary.warnings.push(format!(
            "what the equations leave is no white noise (neighbouring blocks correlate by {:.2}): drifts, slow noise or crosstalk; intervals are too narrow",
            ratios.lag_one_correlation
        ));
    }
}

/// The calibration with the scale factors of the limbs that drifted, or of all with a known change.
fn corrected(
    calibration: &Calibration,
    summary: &Summary,
    found: &Drifted,
    scales: Option<&Scales>,
) -> Result<Calibration> {
    let (ln_change, deviation): ([f64; LIMBS], [f64; LIMBS]) = match scales {
        Some(scales) => (scales.ln_scale, scales.deviation),
        None => {
            if !matches!(summary.finding, Finding::Drifted | Finding::Nothing) {
                bail!(
                    "--write-calibration: it is not determined which limbs kept their scale; only --known-change determines all nine"
                );
            }
            let of = |i: usize, x: f64| if found.limbs.contains(i) { x } else { 0.0 };
            (
                core::array::from_fn(|i| of(i, found.ln_change[i])),
                core::array::from_fn(|i| of(i, found.deviation[i])),
            )
        }
    };
    Ok(correction::corrected(
        calibration.clone(),
        &ln_change,
        &deviation,
    ))
}
