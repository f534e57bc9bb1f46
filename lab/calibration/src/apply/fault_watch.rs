//! Decoupling with the fault monitor: `sixaxis decouple --watch`.

use crate::calibration::{CalibratedLimbs, Calibration};
use anyhow::{Context, Result, ensure};
use sixaxis_core::decouple::uncertainty::ZeroWander;
use sixaxis_core::limb_set::LimbSet;
use sixaxis_core::redundancy::fault::{Event, Kind, Watch};
use sixaxis_core::redundancy::reconstruction::MOST_EXCLUDED;
use sixaxis_core::redundancy::tolerant::{FaultTolerant, ROWS_KEPT, Watched};
use sixaxis_core::{LIMBS, Settings, SixAxis};

use super::Row;
use super::exclusions::{self as found, digits};
use super::setup::Setup;

/// Samples from one look at how far zeros have wandered to the next.
const ALLOWED_EVERY: u64 = 64;

/// A fault-tolerant decoder and its messages.
pub struct FaultWatch {
    stream: FaultTolerant<Vec<[f64; LIMBS]>>,
    /// Its messages, each with its sample.
    pub messages: Vec<String>,
    /// Alarms that began an isolation, those among them that were dismissed without a message.
    pub alarms: u64,
    /// What it has found so far, each as of the sample from which it holds.
    pub found: found::Watched,
    /// Whether the recording is decoded once more with what is found: from the failure on, and not from where it is told.
    pub once_more: bool,
    /// Samples before a failure from which a limb is left out then: a filter spreads the failure over them.
    pub reach: u64,
    /// Voltage at the end of the converter's range. At samples at which a channel stands there and is not NaN the sensor is driven too hard,
    /// and what the others show is no failure.
    pub limit_v: f64,
    /// Whether that has happened.
    driven_beyond: bool,
    /// Alarms that nothing explained, and rows that are marked for them.
    dismissed: u64,
    marked_for_nothing: u64,
    /// The sample at which the last alarm was raised, as long as limbs are suspected and none has been named.
    unexplained_since: Option<u64>,
    samples: u64,
    /// How zeros wander, and samples that had come before the first.
    wander: Option<(ZeroWander, u64)>,
}

impl FaultWatch {
    /// For the noise and the errors that the calibration states.
    ///
    /// # Errors
    /// A calibration that does not say how well its parameters are known; a rate of false alarms that is none.
    pub fn new(
        setup: &Setup,
        calibration: &Calibration,
        settings: &Settings,
        false_alarms_per_hour: f64,
    ) -> Result<Self> {
        ensure!(
            false_alarms_per_hour > 0.0,
            "--false-alarms-per-hour {false_alarms_per_hour}: must be positive"
        );
        let propagated = calibration.covariance.propagated.as_ref().context(
            "--watch: the calibration does not say how noisy its channels are; calibrate again",
        )?;
        let covariance = propagated
            .total()
            .context("--watch: the calibration's covariance is not 25 by 25")?;
        let deviation = |i: usize| covariance[(i, i)].max(0.0).sqrt();
        let limbs = calibration.limbs.unwrap_or_else(|| {
            CalibratedLimbs::ordinary(core::array::from_fn(|i| {
                deviation(LIMBS + i) / setup.parameters.scale_per_mass_per_kg[i].abs()
            }))
        });
        let watch = Watch {
            false_alarms_per_hour,
            noise_v: propagated.channel_noise_v,
            zero_drift_sd_v: core::array::from_fn(deviation),
            strain_covariance: limbs.strain_covariance,
            cross_talk_sd: limbs.cross_talk_spread,
        };
        let stream = FaultTolerant::new(
            &setup.sensor,
            &setup.parameters,
            settings,
            &watch,
            vec![[0.0; LIMBS]; ROWS_KEPT],
        )
        .context("--watch")?
        .with_cross_talk(setup.conditioning.cross_talk);
        Ok(Self {
            stream,
            messages: Vec::new(),
            alarms: 0,
            found: found::Watched::default(),
            once_more: false,
            reach: 0,
            limit_v: f64::INFINITY,
            driven_beyond: false,
            dismissed: 0,
            marked_for_nothing: 0,
            unexplained_since: None,
            samples: 0,
            wander: None,
        })
    }

    /// Allows for zeros that wander because a high-pass is undone, so many samples before the first that is watched.
    pub const fn allow_for(&mut self, wander: ZeroWander, before: u64) {
        self.wander = Some((wander, before));
    }

    /// Limbs that are excluded.
    pub fn excluded(&self) -> LimbSet {
        self.stream.excluded()
    }

    /// Takes a row; the answer to the one before with its flags.
    ///
    /// # Errors
    /// Those of [`FaultTolerant::push`].
    pub fn push(&mut self, row: &Row) -> sixaxis_core::Result<Option<(SixAxis, [f64; 2])>> {
        self.push_filtered(row, row)
    }

    /// The same where the row that is decoded comes out of a filter that runs forwards only.
    ///
    /// # Errors
    /// Those of [`FaultTolerant::push_filtered`].
    pub fn push_filtered(
        &mut self,
        row: &Row,
        filtered: &Row,
    ) -> sixaxis_core::Result<Option<(SixAxis, [f64; 2])>> {
        if let Some((wander, before)) = &self.wander
            && self.samples.is_multiple_of(ALLOWED_EVERY)
        {
            self.stream.allow_for(wander, before + self.samples);
        }
        let beyond = (0..LIMBS)
            .filter(|&limb| row[limb].abs() >= self.limit_v)
            .fold(LimbSet::EMPTY, LimbSet::with);
        let mut watched = if beyond.is_empty() {
            self.stream.push_filtered(row, filtered)?
        } else {
            self.stream.pass_over(row, filtered)?
        };
        self.tell(&watched);
        let beyond = beyond.minus(watched.excluded);
        if !beyond.is_empty() && !self.driven_beyond {
            self.driven_beyond = true;
            self.messages.push(format!(
                "sample {}: the sensor is driven beyond the converter's range ({beyond:#}): such rows are marked in suspected_limbs, and rate and attitude from there on are not to be trusted, which no deviation says",
                self.samples
            ));
        }
        watched.suspected = watched.suspected.union(beyond);
        if watched.switched.is_some() {
            let since = self.since(&watched);
            self.found.excluded.from(since, watched.excluded);
            // What was suspected since then is explained.
            self.found.suspected.from(since, watched.suspected);
        }
        if watched.suspected != self.found.suspected.at(self.samples) {
            self.found.suspected.from(self.samples, watched.suspected);
        }
        self.samples += 1;
        let flags = [watched.excluded, watched.suspected].map(digits);
        Ok(watched.answer.map(|answer| (answer, flags)))
    }

    /// The recording has ended: an alarm that nothing has explained by then is said.
    pub fn finish(&mut self) {
        if self.dismissed > 1 {
            self.messages.push(format!(
                "{} alarms were dismissed, for which {} rows in all are marked in suspected_limbs; where that is more than --false-alarms-per-hour allows for, limbs are not those of the calibration, or there is hum",
                self.dismissed, self.marked_for_nothing
            ));
        }
        if let Some(sample) = self.unexplained_since {
            self.messages.push(format!(
                "the recording ends before it can be told what has failed since sample {sample} or before: rows from there on are marked in suspected_limbs and not to be trusted"
            ));
        }
    }

    /// What it has found in a recording that has ended, and has to say of it.
    pub fn into_found(mut self) -> (found::Watched, Vec<String>) {
        self.finish();
        (self.found, self.messages)
    }

    /// The sample from which on other limbs are excluded: the first that may have failed, or this one.
    fn since(&self, watched: &Watched) -> u64 {
        match watched.event {
            Some(Event::Isolated(verdict) | Event::Identified(verdict))
                if verdict.kind != Kind::Passed =>
            {
                verdict.since.0.min(self.samples)
            }
            _ => self.samples,
        }
    }

    fn tell(&mut self, watched: &Watched) {
        let sample = self.samples;
        if let (true, Some(since)) = (
            watched.event == Some(Event::Dismissed),
            self.unexplained_since,
        ) {
            self.dismissed += 1;
            self.marked_for_nothing += sample - since;
            if self.dismissed == 1 {
                self.messages.push(format!(
                    "sample {sample}: what was suspected since sample {since} is dismissed, it is no limb's failure that can be told; rows from there to here are marked in suspected_limbs"
                ));
            }
        }
        if watched.suspected.is_empty() || matches!(watched.event, Some(Event::Identified(_))) {
            self.unexplained_since = None;
        } else if matches!(watched.event, Some(Event::Alarm(_))) {
            self.unexplained_since = Some(sample);
        }
        let text = match watched.event {
            Some(Event::Identified(verdict)) => Some(verdict.to_string()),
            Some(Event::Quiet) => Some("all nine have been quiet for long".to_owned()),
            Some(Event::Alarm(_)) => {
                self.alarms += 1;
                None
            }
            _ => None,
        };
        let verdict = text.is_some();
        let (since, once_more) = (self.since(watched), self.once_more);
        let filtered_since = since.saturating_sub(self.reach);
        let mut say = |text: String| self.messages.push(format!("sample {sample}: {text}"));
        if let Some(text) = text {
            say(text);
        }
        if let Some(switch) = watched.switched {
            if watched.excluded.is_empty() {
                say("decoded with all nine again".to_owned());
            } else {
                let trace = if switch.reaches_onset {
                    ""
                } else {
                    "; the failure is older than that, its trace stays in rate and attitude"
                };
                let from = if once_more {
                    format!("sample {filtered_since} on")
                } else {
                    format!(
                        "here on, rate and attitude as if from sample {} on{trace}",
                        switch.from_sample
                    )
                };
                let last = if watched.excluded.len() == MOST_EXCLUDED {
                    "; no relation is left that could show a further failure"
                } else {
                    ""
                };
                say(format!(
                    "decoded without {:#} from {from}{last}",
                    watched.excluded
                ));
            }
        }
        if verdict && !watched.suspected.is_empty() {
            say(format!(
                "{:#} may have failed and cannot be excluded; answers are not to be trusted, nor are rate and attitude from there on, which no deviation says",
                watched.suspected
            ));
        }
    }
}
