//! How well the attitude is known while a recording is decoupled.
//!
//! Ground-axis columns are accelerations that the attitude has turned. From the sample on where the attitude is less certain than asked
//! they are NaN; what is said in sensor axes is not touched.

use glam::DVec3;
use sixaxis_core::aided::block::Gathering;
use sixaxis_core::aided::{Bound, Deviations, ErrorFilter, SmoothedDecoupler};
use sixaxis_core::decouple::uncertainty::ZeroWander;
use sixaxis_core::{Decoupler, LimbSet, Settings, SixAxis};

use super::Row;
use super::aided::Aided;
use super::attitude_agreement::Contradiction;
use super::attitude_summary::AttitudeSummary;
use super::axis_noise::SampleNoise;
use super::columns::Columns;

/// Deviation of the attitude up to which ground axes are given unless told otherwise, degrees.
pub const UNTIL_SD_DEG: f64 = 5.0;
/// How well down is known at the first sample, in each of two directions, degrees: as a bubble level shows it.
pub const DOWN_DEG: f64 = 0.1;
/// Blocks where nothing but the deviation is asked, s.
const UNAIDED_BLOCK_S: f64 = 0.1;
/// Deviation beyond which nothing is known of an attitude, rad.
const LOST_RAD: f64 = core::f64::consts::PI;

enum How {
    /// Beside a decoder.
    Beside(Box<(ErrorFilter, Gathering)>),
    /// In its place.
    Aided(Box<Aided>),
    /// In its place, a second time.
    Smoothed(Box<SmoothedDecoupler>),
}

/// Follows the attitude and its deviation.
pub struct AttitudeStream {
    how: How,
    rate_hz: f64,
    /// Time of the first sample on the recording's clock, s.
    start_s: f64,
    down: DVec3,
    until_rad: f64,
    /// What a single sample's own noise gives its accelerations, where their deviations are asked for.
    noise: Option<SampleNoise>,
    /// Samples since the deviations were advanced.
    unseen: u32,
    /// Of accelerations and attitude of the last sample.
    deviations: [f64; 7],
    /// Whether it could have been aided.
    aidable: bool,
    /// What is written.
    columns: Columns,
    summary: AttitudeSummary,
    messages: Vec<String>,
}

impl AttitudeStream {
    /// Beside a decoder that has nothing else to go by, or that could have: `aidable`.
    pub fn beside(filter: ErrorFilter, settings: &Settings, until_deg: f64, aidable: bool) -> Self {
        let gathering = Gathering::new(settings.sample_rate_hz, UNAIDED_BLOCK_S);
        let how = How::Beside(Box::new((filter, gathering)));
        Self {
            aidable,
            ..Self::of(how, settings, until_deg)
        }
    }

    /// Of the columns that are written, those that need an attitude are told where it is not known.
    #[must_use]
    pub const fn written_to(mut self, columns: Columns) -> Self {
        self.columns = columns;
        self
    }

    /// It, or the decoder beside, goes on without the channels of these limbs.
    ///
    /// # Errors
    /// Those of [`ErrorFilter::set_excluded`] and [`Decoupler::set_excluded`].
    pub fn set_excluded(&mut self, limbs: LimbSet) -> sixaxis_core::Result<()> {
        match &mut self.how {
            How::Beside(beside) => beside.0.set_excluded(limbs),
            How::Aided(aided) => aided.set_excluded(limbs),
            How::Smoothed(_) => Ok(()),
        }
    }

    /// Zeros wander from the first sample on, which has not come yet.
    pub(super) fn set_zero_wander(&mut self, wander: ZeroWander) {
        match &mut self.how {
            How::Beside(beside) => beside.0.set_zero_wander(wander),
            How::Aided(aided) => aided.set_zero_wander(wander),
            // It has what the first pass knew.
            How::Smoothed(_) => {}
        }
    }

    /// What a sample's own noise gives its accelerations from now on.
    pub fn set_noise(&mut self, noise: SampleNoise) {
        self.noise = Some(noise);
    }

    /// In a decoder's place, with aids. `noise` is what a sample's own noise gives its accelerations, where their deviations are asked for.
    pub fn aided(
        aided: Aided,
        settings: &Settings,
        until_deg: f64,
        noise: Option<SampleNoise>,
    ) -> Self {
        Self {
            noise,
            ..Self::of(How::Aided(Box::new(aided)), settings, until_deg)
        }
    }

    /// For the same recording once more, from its first sample, when it has been decoded to its end: all of it by all aids.
    /// `again` is a new decoupler like the one that this was made with.
    pub fn smoothed(self, again: Decoupler, settings: &Settings) -> Option<Self> {
        let How::Aided(aided) = self.how else {
            return None;
        };
        let second = aided.decoder.smoothed(again, settings)?;
        let how = How::Smoothed(Box::new(second));
        Some(Self {
            summary: self.summary.again(),
            noise: self.noise,
            ..Self::of(how, settings, self.until_rad.to_degrees())
        })
    }

    fn of(how: How, settings: &Settings, until_deg: f64) -> Self {
        let down = settings.gravity_ground_m_s2.normalize_or_zero();
        let mut new = Self {
            unseen: 0,
            deviations: [0.0; 7],
            aidable: true,
            columns: Columns::default(),
            how,
            rate_hz: settings.sample_rate_hz,
            start_s: 0.0,
            down,
            until_rad: until_deg.to_radians(),
            noise: None,
            summary: AttitudeSummary::default(),
            messages: Vec::new(),
        };
        let first = new.how.deviations();
        new.deviations[6] = first.attitude_rad();
        new.summary.see(&first, new.how.tilt_rad(down));
        new
    }

    /// What its aids leave open before the next.
    pub fn bounded_by(&mut self, bound: Option<Bound>) {
        self.summary.bounded_by(bound);
    }

    /// The recording's clock shows this at the first sample, s.
    pub const fn starts_at(&mut self, time_s: f64) {
        self.start_s = time_s;
    }

    /// Whether it decodes itself.
    pub const fn decodes(&self) -> bool {
        !matches!(self.how, How::Beside(_))
    }

    /// Takes the next nine voltages, where it decodes itself, and returns the sample before them.
    ///
    /// # Errors
    /// Those of [`Decoupler::push`].
    pub fn push(&mut self, voltage_v: &Row) -> sixaxis_core::Result<Option<SixAxis>> {
        let Some(sample) = self.how.push(voltage_v)? else {
            return Ok(None);
        };
        let time_s = self.start_s + sample.sample as f64 / self.rate_hz;
        // This sample was decoded before what is known of it is used.
        if let Some(noise) = &self.noise {
            let by_errors = self.how.accelerations(&sample);
            let by_noise = noise.in_ground_axes(sample.attitude);
            for (deviation, (by_errors, by_noise)) in
                (self.deviations.iter_mut()).zip(by_errors.into_iter().zip(by_noise))
            {
                *deviation = by_errors.hypot(by_noise);
            }
        }
        let known = self.how.deviations();
        self.deviations[6] = known.attitude_rad();
        let looks = match &mut self.how {
            How::Aided(aided) => {
                // The filter goes from block to block, the rate's error turns the attitude from sample to sample.
                self.unseen += 1;
                let since_s = f64::from(self.unseen) / self.rate_hz;
                self.deviations[6] += known.rate_shell_rad_s.length() * since_s;
                aided.see(&sample, time_s, 1.0 / self.rate_hz, &mut self.summary)
            }
            _ => true,
        };
        if looks {
            self.unseen = 0;
            self.look(time_s);
        }
        Ok(Some(sample))
    }

    /// Takes a sample that another decoder has decoded, with the voltages of that same sample. Without aids nothing brings a lost attitude
    /// back: it is not followed any further, nor does its deviation grow.
    pub fn see(&mut self, voltage_v: &Row, sample: &SixAxis) {
        if let How::Beside(beside) = &mut self.how
            && self.deviations[6] <= self.until_rad.max(LOST_RAD)
            && let Some(block) = beside.1.push(voltage_v, sample)
        {
            beside.0.advance(&block);
            self.deviations[6] = self.how.deviations().attitude_rad();
            self.look(self.start_s + sample.sample as f64 / self.rate_hz);
        }
    }

    fn look(&mut self, time_s: f64) {
        self.summary
            .see(&self.how.deviations(), self.how.tilt_rad(self.down));
        self.tell(time_s);
    }

    fn tell(&mut self, time_s: f64) {
        if !self.is_known() && self.summary.unknown_from_s.is_none() {
            self.summary.unknown_from_s = Some(time_s);
            let Some(lost) = self.columns.needing_attitude() else {
                return;
            };
            let alone = match &self.how {
                How::Beside(_) => true,
                How::Aided(aided) => aided.is_alone(),
                How::Smoothed(_) => false,
            };
            let why = match (alone, self.aidable) {
                (true, true) => {
                    ": it is integrated without a reference, and --aid tells what else is known"
                }
                (true, false) => ": it is integrated without a reference",
                (false, _) => "",
            };
            let until_deg = self.until_rad.to_degrees();
            let until = match until_deg {
                0.1.. => format!("{until_deg:.1}"),
                _ => format!("{until_deg:.1e}"),
            };
            self.messages.push(format!(
                "from {time_s:.2} s on the attitude is less certain than {until}° (--until-sd){why}. Where it is, {lost}"
            ));
        }
    }

    /// The recording has ended: what was not used is said.
    pub fn finish(&mut self) {
        if let How::Aided(aided) = &self.how {
            self.summary.attitude.unused += aided.unused();
        }
        let AttitudeSummary {
            rest,
            steady,
            velocity,
            attitude,
            ..
        } = self.summary;
        self.messages.extend(steady.sentence());
        for (what, used) in [
            ("rests", rest),
            ("velocities", velocity),
            ("attitudes", attitude),
        ] {
            let all = used.taken + used.refused;
            if used.refused > 0 {
                self.messages.push(format!(
                    "{} of {all} {what} contradict what was known: velocities are not used, rests and attitudes count little (--aid){}",
                    used.refused,
                    if what == "attitudes" {
                        "; are they from the sensor's axes to the ground's, qw first, 1, 0, 0, 0 at the first sample, and on the recording's clock?"
                    } else {
                        ""
                    }
                ));
            }
        }
        let like_rests = rest.taken + rest.refused + steady.turns + steady.cruises;
        if self.looks_for_rests() && like_rests == 0 {
            self.messages.push(
                "no rest was found: nine channels nowhere show nothing but noise for a quarter of a second (--aid rest)".to_owned(),
            );
        }
        if attitude.unused > 0 {
            self.messages.push(format!(
                "attitudes that were not used: {}; no sample is at their time, another one is within a hundredth of a second, or the recording ends there: are their times seconds on its clock? (--aid)",
                attitude.unused
            ));
        }
    }

    /// What is wrong with the attitudes that it is told so far, or when the recording has ended.
    pub(super) fn contradiction(&self, ended: bool) -> Option<Contradiction> {
        match &self.how {
            How::Aided(aided) => aided.contradiction(ended),
            How::Beside(_) | How::Smoothed(_) => None,
        }
    }

    fn looks_for_rests(&self) -> bool {
        matches!(&self.how, How::Aided(aided) if aided.looks_for_rests())
    }

    /// Whether the attitude is as certain as asked. Counts rows where it is not.
    pub fn counts(&mut self) -> bool {
        let known = self.is_known();
        self.summary.unknown_rows += u64::from(!known);
        known
    }

    /// Counts rows that could not be decoded.
    pub(super) fn skips(&mut self, rows: u64) {
        self.summary.unknown_rows += rows;
    }

    fn is_known(&self) -> bool {
        // NaN is not known.
        self.deviations[6] <= self.until_rad
    }

    /// Standard deviations of the last sample: a, m/s^2, w', rad/s^2, in ground axes, and of the attitude, rad. Those of the accelerations
    /// are 0 where nobody asked for them.
    pub const fn deviations(&self) -> &[f64; 7] {
        &self.deviations
    }

    /// What is to be said since the last call.
    pub fn messages(&mut self) -> Vec<String> {
        std::mem::take(&mut self.messages)
    }

    /// What became of it.
    pub const fn summary(&self) -> &AttitudeSummary {
        &self.summary
    }
}

impl How {
    fn push(&mut self, voltage_v: &Row) -> sixaxis_core::Result<Option<SixAxis>> {
        match self {
            Self::Beside(_) => Ok(None),
            Self::Aided(aided) => aided.push(voltage_v),
            Self::Smoothed(second) => second.push(voltage_v),
        }
    }

    /// Of a sample that it has decoded itself.
    fn accelerations(&self, sample: &SixAxis) -> [f64; 6] {
        match self {
            Self::Beside(_) => [0.0; 6],
            Self::Aided(aided) => aided.decoder.accelerations(sample),
            Self::Smoothed(second) => second.accelerations(sample),
        }
    }

    fn deviations(&self) -> Deviations {
        match self {
            Self::Beside(beside) => beside.0.deviations(),
            Self::Aided(aided) => aided.decoder.deviations(),
            Self::Smoothed(second) => second.deviations(),
        }
    }

    fn tilt_rad(&self, down: DVec3) -> f64 {
        match self {
            Self::Beside(beside) => beside.0.tilt_rad(down),
            Self::Aided(aided) => aided.decoder.filter().tilt_rad(down),
            Self::Smoothed(second) => second.state().tilt_rad(down),
        }
    }
}
