//! Voltages to rows of the answer, with the time of each; `ways` holds by which decoder.

mod ways;

use glam::DVec3;
use sixaxis_core::decouple::uncertainty::{SampleUncertainty, ZeroWander};
use sixaxis_core::{Decoupler, Error, LIMBS, LimbSet, Settings};
use sixaxis_recordings::Block;

use super::Row;
use super::attitude::AttitudeStream;
use super::attitude_agreement::Contradiction;
use super::attitude_summary::AttitudeSummary;
use super::columns::{Columns, DEVIATIONS};
use super::coordination::Coordination;
use super::curves::Curves;
use super::ends::Ends;
use super::exclusions::{FLAGS, WatchedBefore};
use super::fault_watch::FaultWatch;
use super::mean_acceleration::MeanAcceleration;
use super::noise_level::NoiseLevel;

/// A decoupler with the clock of its recording.
pub struct Decoding {
    decoupler: Decoupler,
    columns: Columns,
    /// Specific forces are accelerations less this gravity, ground axes, m/s^2.
    pub(super) gravity_ground_m_s2: DVec3,
    /// Follows how well the attitude is known, and decodes in the decoupler's place where there are aids. Ground axes are NaN
    /// where it is not known.
    pub(super) attitude: Option<AttitudeStream>,
    /// Whether each sample's standard deviations are written, too, into [`DEVIATIONS`]: from `uncertainty`, or from the aided
    /// attitude.
    pub(super) deviates: bool,
    /// Runs beside the decoupler where it is asked how well each sample is known.
    pub(super) uncertainty: Option<Box<SampleUncertainty>>,
    said: Vec<String>,
    finished: bool,
    /// Limbs whose channels are not read.
    excluded: LimbSet,
    /// Voltages of the last sample.
    before: Row,
    /// Decodes in the decoupler's place where failures are to be seen, and says which limbs go into [`FLAGS`], excluded or suspected.
    pub(super) watching: Option<FaultWatch>,
    /// Whether it is known how zeros wander.
    knows_wander: bool,
    /// What such a monitor has found in a first pass, for a second one with aids.
    pub(super) watched: Option<WatchedBefore>,
    /// Checks the coordination equations: looks at the voltages before they are decoded.
    pub(super) coordination: Option<Coordination>,
    /// Sees whether the recording begins in motion.
    pub(super) ends: Option<Ends>,
    /// Sees whether its channels are noisier than the attitude's deviations take them for.
    pub(super) noise_level: Option<NoiseLevel>,
    mean: MeanAcceleration,
    /// Stamps of the samples that have not been answered.
    times_s: Vec<f64>,
    /// Samples taken.
    samples: u64,
    /// Whether the rate has run away, after which no sample can be decoded.
    ran_away: bool,
    /// Rows answered.
    pub rows: u64,
    /// Time of the first row, s.
    pub first_s: Option<f64>,
    /// What a picture of the six accelerations needs, if one is wanted.
    pub picture: Option<Box<Curves>>,
}

impl Decoding {
    /// Nothing answered yet.
    pub fn new(decoupler: Decoupler, columns: Columns, picture: bool) -> Self {
        Self {
            excluded: decoupler.excluded(),
            decoupler,
            columns,
            gravity_ground_m_s2: DVec3::ZERO,
            attitude: None,
            deviates: false,
            uncertainty: None,
            said: Vec::new(),
            finished: false,
            before: [0.0; LIMBS],
            watching: None,
            knows_wander: false,
            watched: None,
            coordination: None,
            ends: None,
            noise_level: None,
            mean: MeanAcceleration::default(),
            times_s: Vec::new(),
            samples: 0,
            ran_away: false,
            rows: 0,
            first_s: None,
            picture: picture.then(Box::default),
        }
    }

    /// What the accelerations in ground axes are no motion's by, if they are not.
    pub fn no_motion(&self, sample_rate_hz: f64) -> Option<String> {
        let down_is_stated = self.gravity_ground_m_s2 != DVec3::ZERO;
        self.mean.verdict(sample_rate_hz, down_is_stated)
    }

    /// Messages of the fault monitor and of the attitude since the last call.
    pub fn messages(&mut self) -> Vec<String> {
        let watching = self.watching.as_mut();
        let mut all = watching.map_or_else(Vec::new, |w| std::mem::take(&mut w.messages));
        all.append(&mut self.said);
        // How it begins is told by how it goes on.
        if self.finished
            && let Some(ends) = self.ends.take()
        {
            let found = self.watched.as_ref().map(|w| w.found.excluded.ever());
            let excluded = found.or(self.watching.as_ref().map(FaultWatch::excluded));
            let excluded = excluded.unwrap_or(LimbSet::EMPTY).union(self.excluded);
            let moves = ends.begins_in_motion();
            all.extend(moves.or_else(|| ends.begins_off_zero(excluded)));
        }
        all.extend(self.attitude.iter_mut().flat_map(AttitudeStream::messages));
        all
    }

    /// Says something beside what it finds by itself.
    pub fn say(&mut self, message: String) {
        self.said.push(message);
    }

    /// The recording has ended.
    pub fn finish(&mut self) {
        self.finished = true;
        self.said
            .extend(self.noise_level.as_ref().and_then(NoiseLevel::verdict));
        self.attitude.iter_mut().for_each(AttitudeStream::finish);
        self.watching.iter_mut().for_each(FaultWatch::finish);
    }

    /// If limbs fail the recording is decoded once more, without them from where each failed.
    pub(super) fn is_decoded_once_more(&mut self) {
        if let Some(watching) = &mut self.watching {
            watching.once_more = true;
        }
    }

    /// The attitude of the recording that has been decoded, for the same recording once more.
    pub fn smoothed(self, again: Decoupler, settings: &Settings) -> Option<AttitudeStream> {
        self.attitude?.smoothed(again, settings)
    }

    /// What became of the attitude, where it was followed.
    pub fn attitude(&self) -> Option<&AttitudeSummary> {
        self.attitude.as_ref().map(AttitudeStream::summary)
    }

    /// Refuses attitudes from a file that contradict the channels so far, or when the recording has ended.
    pub(super) fn check_attitudes(&self, ended: bool) -> Result<(), Contradiction> {
        let attitude = self.attitude.as_ref();
        let found = attitude.and_then(|attitude| attitude.contradiction(ended));
        found.map_or(Ok(()), Err)
    }

    /// Queues the stamps of the next samples, which may be known before these are ready to be decoded.
    pub fn stamps(&mut self, times_s: &[f64]) {
        if let (Some(attitude), 0, [], [first, ..]) =
            (&mut self.attitude, self.rows, &self.times_s[..], times_s)
        {
            attitude.starts_at(*first);
        }
        self.times_s.extend(times_s);
    }

    /// Allows for what undoing a high-pass makes of the channels' noise: to be told before the first sample is decoded.
    pub fn allow_for(&mut self, wander: Option<ZeroWander>) {
        let Some(wander) = wander.filter(|_| !self.knows_wander) else {
            return;
        };
        self.knows_wander = true;
        if let Some(attitude) = &mut self.attitude {
            attitude.set_zero_wander(wander);
        }
        if let Some(watching) = &mut self.watching {
            watching.allow_for(wander, 0);
        }
        if let Some(coordination) = &mut self.coordination {
            coordination.allow_for(wander);
        }
    }

    /// Decodes the next samples, nine columns of voltages, and replaces the contents of `block` with the rows they complete.
    ///
    /// Where the attitude has been lost and the rate then runs away, rows are NaN from there on and a message says so.
    ///
    /// # Errors
    /// Those of [`Decoupler::push_columns`]; the rows before the refused sample are in the block.
    pub fn decode(
        &mut self,
        voltage_v: [&[f64]; LIMBS],
        block: &mut Block,
    ) -> sixaxis_core::Result<()> {
        let deviations = if self.deviates { DEVIATIONS.len() } else { 0 };
        let watches = self.watching.is_some() || self.watched.is_some();
        let flags = if watches { FLAGS.len() } else { 0 };
        block.clear(1 + self.columns.count() + deviations + flags);
        if let Some(coordination) = &mut self.coordination {
            coordination.look(voltage_v);
        }
        if let Some(ends) = &mut self.ends {
            ends.look(voltage_v);
        }
        if let Some(noise_level) = &mut self.noise_level {
            noise_level.look(voltage_v);
        }
        let aided = self.attitude.as_ref().is_some_and(AttitudeStream::decodes);
        self.samples += voltage_v[0].len() as u64;
        let done = if self.ran_away {
            Ok(())
        } else if self.watching.is_some() {
            self.watched(voltage_v, block)
        } else if aided {
            self.aided(voltage_v, block)
        } else {
            self.answers_in_parts(voltage_v, block)
        };
        if let Some(watched) = &self.watched {
            watched.flag(self.rows, block);
        }
        let watched = self
            .watched
            .as_ref()
            .map(|watched| watched.found.excluded.ever());
        let watching = self.watching.as_ref().map(FaultWatch::excluded);
        if let Some(coordination) = &mut self.coordination
            && let Some(excluded) = watched.or(watching)
        {
            coordination.exclude(excluded);
        }
        let done = self.without_run_away(done, block);
        let answered = block.columns[1].len();
        if answered > 0 && self.rows == 0 {
            // The first sample is never answered.
            let unanswered = self.times_s.len().min(1);
            self.times_s.drain(..unanswered);
            self.first_s = self.times_s.first().copied();
        }
        if self.columns.in_ground_axes()
            && let [x, y, z, ..] = &block.columns[1..]
        {
            self.mean.look([x, y, z]);
        }
        let waiting = answered.min(self.times_s.len());
        block.columns[0].extend(self.times_s.drain(..waiting));
        self.rows += answered as u64;
        if let (Some(picture), [times_s, columns @ ..]) = (&mut self.picture, &block.columns[..]) {
            let (answers, more) = columns.split_at(self.columns.count());
            picture.extend(times_s, answers, &more[..deviations]);
        }
        done
    }

    /// A rate that runs away after the attitude was given up is what was announced: the rows that are left are NaN. Before, it is an error of
    /// the calibration, the gains or the recording.
    fn without_run_away(
        &mut self,
        done: sixaxis_core::Result<()>,
        block: &mut Block,
    ) -> sixaxis_core::Result<()> {
        let Some(attitude) = &mut self.attitude else {
            return done;
        };
        if let Err(Error::Overflow { .. }) = done
            && attitude.summary().unknown_from_s.is_some()
        {
            let first = self.times_s.get(block.columns[1].len());
            let from = first.map_or_else(String::new, |time_s| format!("from {time_s:.2} s on "));
            self.said.push(format!(
                "{from}nothing is decoupled: the rate, which is integrated without a reference, has run away, and all columns are NaN"
            ));
            self.ran_away = true;
        } else if !self.ran_away {
            return done;
        }
        // Each sample but the first and the last has a row.
        let rows = self.samples.saturating_sub(2) - self.rows;
        let columns = &mut block.columns[1..];
        attitude.skips(rows - columns[0].len() as u64);
        for column in columns {
            column.resize(rows as usize, f64::NAN);
        }
        Ok(())
    }
}
