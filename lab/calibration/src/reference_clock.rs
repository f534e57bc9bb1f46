//! The clock of standards that have files of their own, against that of the channels. Two quartzes differ by some parts in 1e5, and the joint
//! fit notices one part in 1e6: at the end of a run of ten seconds and 2 Hz twenty of them put 0.3 % of the signal into quadrature.
//!
//! By how much the lag of the standards grows along the runs ([`timing`]) tells it to some parts in a million. Where the fit does not account for
//! the trials as they are stated, it is made with the standards read at that, a little faster and a little slower, each about the middle of its
//! run, so that a lag, which is the same at both ends, counts for neither. What each trial then leaves over is a
//! parabola of the rate, whose bottom is that trial's word, and whose curvature says how well it knows. The weighted median of all is taken,
//! so that a bad trial among good ones does not bend it, and their scatter says how well it is known.

use rayon::prelude::*;
use sixaxis_core::LIMBS;
use sixaxis_recordings::session::Session;

use crate::conditioning::Conditioned;
use crate::diagnosis::table::weighted_median;
use crate::diagnosis::timing;
use crate::joint::hypotheses::clock::{Clock, read_on};
use crate::joint::{self, JointReport, Knowledge, Loss, record};
use crate::prepare::PreparedSession;
use crate::response;
use crate::series::median;
use crate::steps::GyroscopeGain;
use crate::trial::Trial;

/// Difference of two rates, relative, up to which it is two quartzes': ordinary ones are good to 1e-4 each, age and warmth included.
const OF_QUARTZES: f64 = 200e-6;
/// Difference from the last estimate at which the fit is made, and how often: a parabola is one nearby, and far off a fit takes long.
const STEP: f64 = 10e-6;
const ROUNDS: usize = 2;
/// Times its deviation that a difference has at least to be taken off.
const SIGNIFICANT: f64 = 5.0;
/// Trials at least, so that a bad one does not count.
const FEWEST: usize = 5;
/// Deviation of a normal distribution over its median departure, and of a median over that of a mean.
const OVER_MEDIAN: f64 = 1.4826;
const OF_A_MEDIAN: f64 = 1.2533;

/// By how much standards are sampled faster than stated, by the clock of the channels, relative.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RateDifference {
    /// The difference; the true rate is 1 and this times the stated one.
    pub faster: f64,
    /// Its standard deviation.
    pub deviation: f64,
    /// Trials that show it.
    pub trials: usize,
}

impl RateDifference {
    /// Whether it is there beyond doubt, and no more than two quartzes may differ by.
    fn is_of_quartzes(&self) -> bool {
        let size = self.faster.abs();
        self.trials >= FEWEST && size > SIGNIFICANT * self.deviation && size <= OF_QUARTZES
    }

    /// That it was taken off, in words.
    #[must_use]
    pub fn in_words(&self) -> String {
        format!(
            "by {} trials the standards, which have files of their own, are sampled at {:.6} times their stated rate by the clock of the channels ({:+.1} ± {:.1} parts \
             per million, as two quartzes may differ), and are read at that; reference_sample_rate_hz can state it",
            self.trials,
            1.0 + self.faster,
            1e6 * self.faster,
            1e6 * self.deviation
        )
    }
}

/// Measures it where the joint fit does not account for the trials as they are stated; none where it does, where no standards have files of
/// their own, and where it is none of two quartzes.
#[must_use]
pub fn measure(session: &Session, stated: &PreparedSession) -> Option<RateDifference> {
    let entries = session.recording.iter();
    let own: Vec<String> = entries
        .filter(|entry| entry.reference_file.is_some())
        .map(|entry| entry.file.display().to_string())
        .collect();
    if own.is_empty() {
        return None;
    }
    let mut found = by_growth(stated, &own).filter(|found| found.faster.abs() <= OF_QUARTZES)?;
    let campaign = &stated.campaign;
    let class = session.gyroscope.class_percent / 100.0;
    let steps = campaign.identify(GyroscopeGain::Certified { class }).ok()?;
    let (rest, start) = (joint::at_rest(&steps.drift), joint::start(campaign, &steps));
    let knowledge = Knowledge::of(session);
    let fit = |faster: f64| -> Option<JointReport> {
        let read = |(trial, _): &(Trial, _)| match own.contains(&trial.name) {
            true => read_on(trial, about_the_middle(trial, faster)),
            false => Some(trial.clone()),
        };
        let trials: Vec<Trial> = campaign.trials.iter().map(read).collect::<Option<_>>()?;
        let borrowed: Vec<&Trial> = trials.iter().collect();
        let geometry = &campaign.geometry;
        joint::fit_trials(
            geometry,
            &borrowed,
            &rest,
            &start,
            &knowledge,
            Loss::Squares,
        )
        .ok()
    };
    let as_stated = fit(0.0);
    if as_stated.as_ref().is_some_and(JointReport::accounts) {
        return None;
    }
    for _ in 0..ROUNDS {
        let middle = found.faster;
        let fits: Option<Vec<JointReport>> = [middle - STEP, middle, middle + STEP]
            .into_par_iter()
            .map(fit)
            .collect();
        // A fit to good instruments may refuse what is ten parts in a million off; the growth alone is good to a few.
        let Some(left) = fits.and_then(|fits| of_parabolas(&fits, &own)) else {
            break;
        };
        found = RateDifference {
            faster: middle + left.faster,
            ..left
        };
    }
    found.is_of_quartzes().then_some(found)
}

/// By how much standards of those trials are sampled faster by the growth of their lags, the middle one of all trials.
fn by_growth(stated: &PreparedSession, own: &[String]) -> Option<RateDifference> {
    let of = |(trial, conditioned): &(Trial, Conditioned)| -> Option<(f64, f64)> {
        if !own.contains(&trial.name) {
            return None;
        }
        // In a compound run what turns lags by its own.
        record(trial)?;
        // A growth has no use for the zeros.
        let force = |row| trial.gains.measured_force_n(row, &[0.0; LIMBS]);
        let force_n: Vec<[f64; LIMBS]> = conditioned.voltage_v.iter().map(force).collect();
        let response = response::measure(trial, conditioned, &force_n)?;
        let [_, (growth, error)] = timing::lag(trial, &response, &[false; LIMBS]);
        let told = error > 0.0 && error.is_finite();
        let error = error / response.duration_s;
        told.then(|| (growth / response.duration_s, 1.0 / (error * error)))
    };
    let trials = stated.campaign.trials.par_iter();
    agreed(trials.filter_map(of).collect())
}

/// A clock that shows the middle of a trial when it is, and runs otherwise.
fn about_the_middle(trial: &Trial, faster: f64) -> Clock {
    let middle_s = 0.5 * trial.voltage_v.len() as f64 / trial.sample_rate_hz;
    Clock {
        behind_s: -faster * middle_s,
        faster,
    }
}

/// Where the parabolas of those trials through three fits, so far apart, have their bottoms, from the fit in the middle.
fn of_parabolas(fits: &[JointReport], own: &[String]) -> Option<RateDifference> {
    let [slower, middle, faster] = fits else {
        return None;
    };
    let all = middle.recordings.iter().enumerate();
    let of_own = all.filter(|(_, name)| own.contains(name));
    let bottom = |(index, _): (usize, &String)| -> Option<(f64, f64)> {
        let [low, here, high] =
            [slower, middle, faster].map(|fit| fit.estimate.trials[index].excess);
        let curvature = (high - 2.0 * here + low) / (2.0 * STEP * STEP);
        let slope = (high - low) / (2.0 * STEP);
        (curvature > 0.0).then(|| (-0.5 * slope / curvature, curvature))
    };
    agreed(of_own.filter_map(bottom).collect())
}

/// What trials agree on, each with its word and one over its variance.
fn agreed(mut words: Vec<(f64, f64)>) -> Option<RateDifference> {
    let faster = weighted_median(&mut words)?;
    // Variances are those of noise, if nothing else is wrong with the trials.
    let departures = words
        .iter()
        .map(|(value, weight)| (value - faster).abs() * weight.sqrt());
    let larger = (OVER_MEDIAN * median(departures)?).max(1.0);
    let weights: f64 = words.iter().map(|(_, weight)| weight).sum();
    Some(RateDifference {
        faster,
        deviation: OF_A_MEDIAN * larger / weights.sqrt(),
        trials: words.len(),
    })
}
