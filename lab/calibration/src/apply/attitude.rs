//! How well the attitude is known while a recording is decoupled, and what keeps it.
//!
//! Ground-axis columns are accelerations that the attitude has turned. From the sample on where the attitude is less certain than asked
//! they are NaN; what is said in sensor axes is not touched.

use std::collections::VecDeque;

use anyhow::{Result, ensure};
use glam::{DQuat, DVec3};
use sixaxis_core::aided::block::{Block, Gathering};
use sixaxis_core::aided::{Aid, AidedDecoupler, ErrorFilter, RestFinder};
use sixaxis_core::{Decoupler, Settings, SixAxis};

use super::Row;
use super::aids::{AidChoice, Fix, fixes};
use super::attitude_summary::{AttitudeSummary, Used};
use super::setup::Setup;

/// Deviation of the attitude up to which ground axes are given unless told otherwise, degrees.
pub const UNTIL_SD_DEG: f64 = 5.0;
/// How well down is known at the first sample, in each of two directions, degrees: as a bubble level shows it.
pub const DOWN_DEG: f64 = 0.1;
/// Blocks where nothing but the deviation is asked, s.
const UNAIDED_BLOCK_S: f64 = 0.1;
/// From one measurement of the velocity to the next are 0.5 to 1.5 of the stated time, each time this share of it further on, so that
/// no periodic motion is always met in the same place.
const GOLDEN: f64 = 0.618_033_988_749_895;

/// Measurements of the velocity as they come due.
struct Velocity {
    every_s: f64,
    aid: Aid,
    next_s: f64,
    taken: f64,
}

/// A decoder with its aids.
struct Aided {
    decoder: AidedDecoupler,
    rests: Option<RestFinder>,
    velocity: Option<Velocity>,
    fixes: VecDeque<Fix>,
    /// A fix of this block, with what was decoded at its time.
    pending: Option<(SixAxis, Aid)>,
}

enum How {
    /// Beside a decoder.
    Beside(Box<(ErrorFilter, Gathering)>),
    /// In its place.
    Aided(Box<Aided>),
}

/// Follows the attitude and its deviation.
pub struct AttitudeStream {
    how: How,
    rate_hz: f64,
    /// Time of the first sample on the recording's clock, s.
    start_s: f64,
    down: DVec3,
    until_rad: f64,
    /// Standard deviations of a single sample's accelerations by its own noise, where theirs are asked for.
    noise: Option<[f64; 6]>,
    /// Of accelerations and attitude of the last sample.
    deviations: [f64; 7],
    summary: AttitudeSummary,
    messages: Vec<String>,
}

impl AttitudeStream {
    /// Beside a decoder that has nothing else to go by.
    #[must_use]
    pub fn beside(filter: ErrorFilter, settings: &Settings, until_deg: f64) -> Self {
        let gathering = Gathering::new(settings.sample_rate_hz, UNAIDED_BLOCK_S);
        Self::of(
            How::Beside(Box::new((filter, gathering))),
            settings,
            until_deg,
        )
    }

    /// In a decoder's place, with aids. `noise` has the standard deviations that a sample's own noise gives its accelerations, where
    /// theirs are asked for.
    ///
    /// # Errors
    /// A file of attitudes that cannot be read.
    pub fn aided(
        decoupler: Decoupler,
        filter: ErrorFilter,
        setup: &Setup,
        settings: &Settings,
        until_deg: f64,
        aids: &[AidChoice],
        (channel_noise_v, noise): (&Row, Option<[f64; 6]>),
    ) -> Result<Self> {
        let mut aided = Aided {
            decoder: AidedDecoupler::new(decoupler, filter, &setup.parameters, settings),
            rests: None,
            velocity: None,
            fixes: VecDeque::new(),
            pending: None,
        };
        for (place, choice) in aids.iter().enumerate() {
            let same =
                |other: &AidChoice| std::mem::discriminant(other) == std::mem::discriminant(choice);
            ensure!(
                !aids[..place].iter().any(same),
                "--aid: {} stands there twice",
                choice.word()
            );
            match choice {
                AidChoice::Rest => {
                    let model = aided.decoder.filter().model();
                    aided.rests = Some(RestFinder::new(
                        model,
                        channel_noise_v,
                        settings.sample_rate_hz,
                    ));
                }
                AidChoice::Velocity {
                    every_s,
                    deviation_m_s,
                } => {
                    aided.velocity = Some(Velocity {
                        every_s: *every_s,
                        aid: Aid::Velocity {
                            deviation_m_s: *deviation_m_s,
                        },
                        next_s: f64::NEG_INFINITY,
                        taken: 0.0,
                    });
                }
                AidChoice::Attitude {
                    file,
                    deviation_deg,
                } => aided.fixes = fixes(file, *deviation_deg)?,
            }
        }
        let mut stream = Self::of(How::Aided(Box::new(aided)), settings, until_deg);
        stream.noise = noise;
        Ok(stream)
    }

    fn of(how: How, settings: &Settings, until_deg: f64) -> Self {
        let filter = match &how {
            How::Beside(beside) => &beside.0,
            How::Aided(aided) => aided.decoder.filter(),
        };
        let down = settings.gravity_ground_m_s2.normalize_or_zero();
        let summary = AttitudeSummary::of(filter, down);
        Self {
            deviations: [
                0.0,
                0.0,
                0.0,
                0.0,
                0.0,
                0.0,
                summary.sd_attitude_deg.to_radians(),
            ],
            how,
            rate_hz: settings.sample_rate_hz,
            start_s: 0.0,
            down,
            until_rad: until_deg.to_radians(),
            noise: None,
            summary,
            messages: Vec::new(),
        }
    }

    /// The recording's clock shows this at the first sample, s.
    pub const fn starts_at(&mut self, time_s: f64) {
        self.start_s = time_s;
    }

    /// Whether it decodes itself.
    #[must_use]
    pub const fn decodes(&self) -> bool {
        matches!(self.how, How::Aided(_))
    }

    /// Takes the next nine voltages, where it decodes itself, and returns the sample before them.
    ///
    /// # Errors
    /// Those of [`Decoupler::push`].
    pub fn push(&mut self, voltage_v: &Row) -> sixaxis_core::Result<Option<SixAxis>> {
        let How::Aided(aided) = &mut self.how else {
            return Ok(None);
        };
        let answer = aided.decoder.push(voltage_v)?;
        let Some(sample) = &answer else {
            return Ok(answer);
        };
        let time_s = self.start_s + sample.sample as f64 / self.rate_hz;
        // This sample was decoded before what is known of it is used.
        if let Some(noise) = &self.noise {
            let by_errors = aided.decoder.accelerations(sample);
            for (deviation, (by_errors, noise)) in
                self.deviations.iter_mut().zip(by_errors.iter().zip(noise))
            {
                *deviation = by_errors.hypot(*noise);
            }
        }
        self.deviations[6] = aided.decoder.deviations().attitude_rad();
        aided.see_fixes(
            sample,
            time_s,
            0.5 / self.rate_hz,
            &mut self.summary.attitude,
        );
        if let Some(block) = aided.decoder.block().copied() {
            aided.use_all(&block, time_s, &mut self.summary);
            self.summary.see(aided.decoder.filter(), self.down);
            self.tell(time_s);
        }
        Ok(answer)
    }

    /// Takes a sample that another decoder has decoded, with the voltages of that same sample.
    pub fn see(&mut self, voltage_v: &Row, sample: &SixAxis) {
        if let How::Beside(beside) = &mut self.how
            && let Some(block) = beside.1.push(voltage_v, sample)
        {
            beside.0.advance(&block);
            self.deviations[6] = beside.0.deviations().attitude_rad();
            self.summary.see(&beside.0, self.down);
            self.tell(self.start_s + sample.sample as f64 / self.rate_hz);
        }
    }

    fn tell(&mut self, time_s: f64) {
        if !self.is_known() && self.summary.unknown_from_s.is_none() {
            self.summary.unknown_from_s = Some(time_s);
            self.messages.push(format!(
                "from {time_s:.2} s on the attitude is less certain than {:.1}° (--until-sd): it is integrated without a reference, and \
                 ground-axis columns are NaN where it is. Specific force in sensor axes (--frame sensor or both) stays true; --aid tells what else is known",
                self.until_rad.to_degrees()
            ));
        }
    }

    /// The recording has ended: what was not used is said.
    pub fn finish(&mut self) {
        if let How::Aided(aided) = &self.how {
            self.summary.attitude.unused += aided.fixes.len() as u64;
        }
        let AttitudeSummary {
            rest,
            velocity,
            attitude,
            ..
        } = self.summary;
        for (what, used) in [
            ("rests", rest),
            ("velocities", velocity),
            ("attitudes", attitude),
        ] {
            let all = used.taken + used.refused;
            if used.refused > 0 {
                self.messages.push(format!(
                    "{} of {all} {what} contradict what was known: velocities are not used, rests and attitudes count little (--aid)",
                    used.refused
                ));
            }
        }
        if attitude.unused > 0 {
            self.messages.push(format!(
                "{} attitudes were not used: no sample is at their time, or another one within a hundredth of a second (--aid)",
                attitude.unused
            ));
        }
    }

    /// Whether the attitude is as certain as asked. Counts rows where it is not.
    pub fn counts(&mut self) -> bool {
        let known = self.is_known();
        self.summary.unknown_rows += u64::from(!known);
        known
    }

    fn is_known(&self) -> bool {
        // NaN is not known.
        self.deviations[6] <= self.until_rad
    }

    /// Standard deviations of the last sample: a, m/s^2, w', rad/s^2, in ground axes, and of the attitude, rad. Those of the accelerations
    /// are 0 where nobody asked for them.
    #[must_use]
    pub const fn deviations(&self) -> &[f64; 7] {
        &self.deviations
    }

    /// What is to be said since the last call.
    pub fn messages(&mut self) -> Vec<String> {
        std::mem::take(&mut self.messages)
    }

    /// What became of it.
    #[must_use]
    pub const fn summary(&self) -> &AttitudeSummary {
        &self.summary
    }
}

impl Aided {
    /// Takes attitudes whose time a sample has reached: what was decoded then is that sample turned back.
    fn see_fixes(&mut self, sample: &SixAxis, time_s: f64, half_step_s: f64, used: &mut Used) {
        while let Some(fix) = self.fixes.pop_front_if(|fix| fix.time_s <= time_s) {
            let late_s = time_s - fix.time_s;
            if late_s > 4.0 * half_step_s {
                used.unused += 1;
                continue;
            }
            used.unused += u64::from(self.pending.is_some());
            let back = DQuat::from_scaled_axis(-late_s * sample.rate_shell_rad_s);
            let then = SixAxis {
                attitude: sample.attitude * back,
                ..*sample
            };
            self.pending = Some((then, fix.aid));
        }
    }

    /// Uses what is known at the end of a block, if anything: an attitude first, since what was decoded at its time is not corrected since.
    fn use_all(&mut self, block: &Block, time_s: f64, summary: &mut AttitudeSummary) {
        if let Some((then, aid)) = self.pending.take() {
            summary.attitude.count(self.decoder.aid_of(&aid, &then));
        }
        if let Some(rest) = self.rests.as_mut().and_then(|rests| rests.push(block)) {
            summary.rest.count(self.decoder.aid(&rest));
        }
        if let Some(velocity) = &mut self.velocity
            && time_s >= velocity.next_s
        {
            velocity.taken += 1.0;
            let share = 0.5 + (GOLDEN * velocity.taken).fract();
            velocity.next_s = time_s + velocity.every_s * share;
            summary.velocity.count(self.decoder.aid(&velocity.aid));
        }
    }
}
