//! The clock of standards that have files of their own, against that of the channels. Two quartzes differ by some parts in 1e5, and the joint
//! fit notices one part in 1e6: at the end of a run of ten seconds and 2 Hz twenty of them put 0.3 % of the signal into quadrature.
//!
//! By how much the lag of the standards grows along the runs ([`timing`]) tells it to some parts in a million. Where the fit does not account for
//! the trials as they are stated, it is made with the standards read at that, a little faster and a little slower, each about the middle of its
//! run, so that a lag, which is the same at both ends, counts for neither. What each trial then leaves over is a
//! parabola of the rate, whose bottom is that trial's word, and whose curvature says how well it knows. The weighted median of all is taken,
//! so that a bad trial among good ones does not bend it, and their scatter says how well it is known.

use rayon::prelude::*;
use sixaxis_core::identify::joint::AtRest;
use sixaxis_core::{LIMBS, Parameters};
use sixaxis_recordings::session::Session;

use crate::conditioning::Conditioned;
use crate::diagnosis::table::weighted_median;
use crate::diagnosis::timing;
use crate::error::Result;
use crate::joint::hypotheses::clock::{Clock, read_on};
use crate::joint::{self, JointReport, Knowledge, Loss, record};
use crate::prepare::PreparedSession;
use crate::response;
use crate::series::median;
use crate::steps::{Campaign, GyroscopeGain};
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

/// A session with it taken off, where the joint fit does not account for the trials as they are stated and leaves less without it; as it is
/// stated where the fit does, where no standards have files of their own, and where it is none of two quartzes. `read_faster` reads the
/// session with standards that are sampled faster than stated by this share.
///
/// # Errors
/// Those of `read_faster`.
pub fn taken_off(
    session: &Session,
    stated: PreparedSession,
    read_faster: impl Fn(f64) -> Result<PreparedSession>,
) -> Result<PreparedSession> {
    let own = with_own_files(session);
    if own.len() < FEWEST {
        return Ok(stated);
    }
    let about = |day: &PreparedSession| -> Option<RateDifference> {
        by_growth(day, &own)
            .filter(|found| found.trials >= FEWEST && found.faster.abs() <= OF_QUARTZES)
    };
    let Some(growth) = about(&stated) else {
        return Ok(stated);
    };
    let as_stated = Day::of(session, &stated, &own).and_then(|day| day.fit(0.0));
    if as_stated.as_ref().is_some_and(JointReport::accounts) {
        return Ok(stated);
    }
    let refined = |day: &PreparedSession, from| match Day::of(session, day, &own) {
        Some(day) => day.refined(from),
        None => from,
    };
    let first = refined(&stated, growth);
    if !first.is_of_quartzes() {
        return Ok(stated);
    }
    // Files that begin together are half a run's growth apart in its middle as long as they are read at the wrong rate, and with that lag left
    // the best rate is a little less than the true one. Read at about the right one they are together.
    let near = read_faster(first.faster)?;
    let found = about(&near).map_or(first, |growth| {
        let left = refined(&near, growth);
        RateDifference {
            faster: (1.0 + first.faster) * (1.0 + left.faster) - 1.0,
            ..left
        }
    });
    if !found.is_of_quartzes() {
        return Ok(stated);
    }
    let read = read_faster(found.faster)?;
    let left = Day::of(session, &read, &own).and_then(|day| day.fit(0.0));
    let less = left.is_some_and(|left| {
        as_stated.is_none_or(|stated| left.misfit.per_degree < stated.misfit.per_degree)
    });
    Ok(match less {
        true => PreparedSession {
            reference_clock: Some(found),
            ..read
        },
        false => stated,
    })
}

/// Recordings whose standards have files of their own.
fn with_own_files(session: &Session) -> Vec<String> {
    let entries = session.recording.iter();
    entries
        .filter(|entry| entry.reference_file.is_some())
        .map(|entry| entry.file.display().to_string())
        .collect()
}

/// What the joint fit of a day is made of.
struct Day<'a> {
    campaign: &'a Campaign,
    /// Trials whose standards have files of their own.
    own: &'a [String],
    rest: AtRest,
    start: Parameters,
    knowledge: Knowledge,
}

impl<'a> Day<'a> {
    fn of(session: &Session, day: &'a PreparedSession, own: &'a [String]) -> Option<Self> {
        let campaign = &day.campaign;
        let class = session.gyroscope.class_percent / 100.0;
        let steps = campaign.identify(GyroscopeGain::Certified { class }).ok()?;
        Some(Self {
            campaign,
            own,
            rest: joint::at_rest(&steps.drift),
            start: joint::start(campaign, &steps),
            knowledge: Knowledge::of(session),
        })
    }

    /// The fit with standards that are sampled faster than they were read by this share, each about the middle of its run.
    fn fit(&self, faster: f64) -> Option<JointReport> {
        let read = |(trial, _): &(Trial, Conditioned)| match self.own.contains(&trial.name) {
            true if faster != 0.0 => read_on(trial, about_the_middle(trial, faster)),
            _ => Some(trial.clone()),
        };
        let trials = self.campaign.trials.iter().map(read);
        let trials: Vec<Trial> = trials.collect::<Option<_>>()?;
        let borrowed: Vec<&Trial> = trials.iter().collect();
        joint::fit_trials(
            &self.campaign.geometry,
            &borrowed,
            &self.rest,
            &self.start,
            &self.knowledge,
            Loss::Squares,
        )
        .ok()
    }

    /// A difference by the bottoms of the trials' parabolas about it. A fit to good instruments may refuse what is ten parts in a million off;
    /// then what was known of it remains, and the growth alone is good to a few.
    fn refined(&self, mut found: RateDifference) -> RateDifference {
        for _ in 0..ROUNDS {
            let middle = found.faster;
            let fits: Option<Vec<JointReport>> = [middle - STEP, middle, middle + STEP]
                .into_par_iter()
                .map(|faster| self.fit(faster))
                .collect();
            let Some(left) = fits.and_then(|fits| of_parabolas(&fits, self.own)) else {
                break;
            };
            found = RateDifference {
                faster: middle + left.faster,
                ..left
            };
        }
        found
    }
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
