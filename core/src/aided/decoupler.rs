//! A decoupler and its filter in one stream.

#[cfg(feature = "alloc")]
use alloc::boxed::Box;

use glam::DVec3;

use super::aid::{Aid, Measurement, Taken};
use super::block::{Block, Gathering};
use super::channels::Channels;
use super::correction::Correction;
use super::deviations::Deviations;
use super::filter::{ErrorFilter, FIRST_ORDER_RAD};
#[cfg(feature = "alloc")]
use super::history::{Event, History};
#[cfg(feature = "alloc")]
use super::second_pass::SmoothedDecoupler;
use super::steady::Steady;
use crate::decouple::stream::Decoupler;
use crate::decouple::uncertainty::ZeroWander;
use crate::error::Result;
use crate::geometry::LIMBS;
use crate::limb_set::LimbSet;
use crate::model::{Parameters, Settings};
use crate::six_axis::SixAxis;

/// Length of a block, s: corrections come as often at most.
const BLOCK_S: f64 = 0.01;
/// Rests or attitudes in a row that contradict the filter, from which on it is the filter that is doubted.
const BELIEVED_AFTER: u32 = 4;

/// Nine voltages in, six accelerations out, held by what else is known: no allocation, no panic.
#[derive(Debug, Clone, PartialEq)]
pub struct AidedDecoupler {
    decoupler: Decoupler,
    filter: ErrorFilter,
    gathering: Gathering,
    step_s: f64,
    channels: Channels,
    /// Those with which the last samples were decoupled, where they have been corrected since.
    corrected_from: Option<Channels>,
    /// Voltages of the sample that is answered next, and of the one that was answered last.
    before: [f64; LIMBS],
    answered: [f64; LIMBS],
    last: Option<(Block, SixAxis)>,
    /// What the decoded accelerations add up to, m/s.
    velocity: DVec3,
    gravity_ground_m_s2: DVec3,
    /// Rests and attitudes in a row that contradict what is known.
    refused: [u32; 2],
    /// Whether the rest before was a steady turn.
    turning: bool,
    #[cfg(feature = "alloc")]
    history: Option<Box<History>>,
}

impl AidedDecoupler {
    /// Puts both together; both must be of the same sensor, parameters and settings, without the same limbs, and new.
    #[must_use]
    pub fn new(
        decoupler: Decoupler,
        filter: ErrorFilter,
        parameters: &Parameters,
        settings: &Settings,
    ) -> Self {
        Self {
            decoupler,
            filter,
            gathering: Gathering::new(settings.sample_rate_hz, BLOCK_S),
            step_s: 1.0 / settings.sample_rate_hz,
            channels: Channels::new(*parameters),
            corrected_from: None,
            before: [0.0; LIMBS],
            answered: [0.0; LIMBS],
            last: None,
            velocity: DVec3::ZERO,
            refused: [0; 2],
            turning: false,
            #[cfg(feature = "alloc")]
            history: None,
            gravity_ground_m_s2: settings.gravity_ground_m_s2,
        }
    }

    /// Takes the next nine voltages and returns the sample before them, once there are three.
    ///
    /// # Errors
    /// Those of [`Decoupler::push`], of this sample or, after a correction, of the two before it, which are then left as they were.
    pub fn push(&mut self, voltage_v: &[f64; LIMBS]) -> Result<Option<SixAxis>> {
        if self.corrected_from.is_some() {
            self.mend_recent()?;
        }
        let mended = self.channels.mended(voltage_v);
        let answer = self.decoupler.push(&mended)?;
        self.answered = core::mem::replace(&mut self.before, mended);
        self.pass();
        if let Some(sample) = &answer {
            self.velocity += sample.linear_ground_m_s2 * self.step_s;
            if let Some(block) = self.gathering.push(&self.answered, sample) {
                self.filter.advance(&block);
                self.last = Some((block, *sample));
            }
        }
        Ok(answer)
    }

    /// What has been found of the channels holds for the sample that is answered next, too, and for the one before it.
    #[cold]
    fn mend_recent(&mut self) -> Result<()> {
        let Some(before) = self.corrected_from.take() else {
            return Ok(());
        };
        let rows = [&mut self.answered, &mut self.before];
        self.decoupler.mend_recent(rows, &self.channels, &before)
    }

    /// The block that the last sample completed: what is known can be used now, and deviations are those of this sample.
    #[must_use]
    pub fn block(&self) -> Option<&Block> {
        self.last.as_ref().map(|(block, _)| block)
    }

    /// The last sample with its corrections, where it ends a block.
    #[must_use]
    pub fn last(&self) -> Option<&SixAxis> {
        self.last.as_ref().map(|(_, sample)| sample)
    }

    /// Uses what is known of the last sample; refused, too, where no block ends there, or where it is a velocity and the attitude is lost.
    pub fn aid(&mut self, aid: &Aid) -> Taken {
        let Some((_, sample)) = &self.last else {
            return Taken::Refused;
        };
        self.aid_of(aid, &sample.clone())
    }

    /// Uses what is known of an earlier sample of the block, in which errors hardly grow. Nothing may have been used since that sample.
    pub fn aid_of(&mut self, aid: &Aid, sample: &SixAxis) -> Taken {
        let taken = match aid {
            _ if self.last.is_none() => return Taken::Refused,
            Aid::Velocity { .. } if self.has_lost_attitude() => return Taken::Refused,
            Aid::Rest {
                deviation_m_s,
                continues,
                ..
            } => {
                let turned = continues.then_some(self.turning);
                let taken = self.rest(aid, sample, *deviation_m_s, turned);
                self.turning = taken == Taken::Turn;
                taken
            }
            _ => self.take(aid, sample),
        };
        // A rest or an attitude that goes on contradicting is right.
        let counter = match aid {
            Aid::Rest { .. } => &mut self.refused[0],
            Aid::Attitude { .. } => &mut self.refused[1],
            Aid::Velocity { .. } => return taken,
        };
        *counter = match taken {
            Taken::Refused => *counter + 1,
            _ => 0,
        };
        if *counter >= BELIEVED_AFTER {
            #[cfg(feature = "alloc")]
            self.happened(Event::Doubted);
            self.filter.doubt();
        }
        taken
    }

    fn take(&mut self, aid: &Aid, sample: &SixAxis) -> Taken {
        let [measurement, _] = aid.against(sample, self.velocity, self.down());
        match measurement {
            Some(measurement) if self.measure(&measurement) => Taken::Used,
            _ => Taken::Refused,
        }
    }

    /// A rest, or what constant channels may show as well.
    fn rest(
        &mut self,
        aid: &Aid,
        sample: &SixAxis,
        deviation_m_s: f64,
        turned: Option<bool>,
    ) -> Taken {
        let mut taken = Taken::Used;
        for part in 0..2 {
            // Anew for the second one: the first has corrected what that is held against.
            let all = aid.against(sample, self.velocity, self.down());
            let (Some(measurement), Some((block, _))) = (&all[part], &self.last) else {
                return Taken::Refused;
            };
            let steady = match taken {
                Taken::Used => {
                    self.filter
                        .steady(measurement, block, sample, self.gravity_ground_m_s2, turned)
                }
                _ => None,
            };
            match steady {
                Some(Steady::Turn(across)) => {
                    if let Some(across) = across {
                        self.measure(&across);
                    }
                    return Taken::Turn;
                }
                Some(Steady::Cruise) => {
                    #[cfg(feature = "alloc")]
                    self.happened(Event::Tared(deviation_m_s));
                    self.filter.tare_velocity(deviation_m_s);
                    self.velocity = DVec3::ZERO;
                    return Taken::Cruise;
                }
                None if self.measure(measurement) => {}
                None => taken = Taken::Refused,
            }
        }
        taken
    }

    /// Takes off what a measurement finds; false where it contradicts what was known.
    fn measure(&mut self, measurement: &Measurement) -> bool {
        #[cfg(feature = "alloc")]
        self.happened(Event::Measured(*measurement));
        let found = self.filter.take(measurement);
        if let Some(found) = &found {
            self.correct(found);
        }
        found.is_some_and(|found| !found.contradicts)
    }

    #[cfg(feature = "alloc")]
    fn happened(&mut self, event: Event) {
        if let Some(history) = &mut self.history {
            history.happened(event);
        }
    }

    fn down(&self) -> DVec3 {
        self.gravity_ground_m_s2.normalize_or_zero()
    }

    /// How far what is known of an earlier sample of the block is from what was decoded, before it is used:
    /// [`ErrorFilter::departure`] of its first measurement.
    #[must_use]
    pub fn departure(&self, aid: &Aid, sample: &SixAxis) -> Option<f64> {
        let [measurement, _] = aid.against(sample, self.velocity, self.down());
        self.filter.departure(&measurement?)
    }

    /// Goes on without the channels of these limbs, from the next sample on.
    ///
    /// # Errors
    /// Those of [`Decoupler::set_excluded`]; nothing has changed then.
    // Compiled where it is called, so that the decoupler's own is, too: alone in this crate it costs a sixth more.
    #[inline]
    pub fn set_excluded(&mut self, limbs: LimbSet) -> Result<()> {
        self.decoupler.set_excluded(limbs)?;
        self.filter.set_excluded(limbs)
    }

    /// Zeros wander from the first sample on. To be called before it.
    pub fn set_zero_wander(&mut self, wander: ZeroWander) {
        self.filter.set_zero_wander(wander);
        #[cfg(feature = "alloc")]
        if let Some(history) = &mut self.history {
            **history = History::new(&self.filter, &self.channels);
        }
    }

    /// Whether nothing of first order is known of the attitude. A velocity that is only bounded would be held against gravity in any
    /// direction then, and the rate run away by it: it is not used.
    #[must_use]
    pub fn has_lost_attitude(&self) -> bool {
        self.deviations().attitude_rad() > FIRST_ORDER_RAD
    }

    fn correct(&mut self, found: &Correction) {
        let Some((_, now)) = &mut self.last else {
            return;
        };
        let turn_shell = now.attitude.inverse() * -found.attitude_ground_rad;
        self.decoupler.steer(turn_shell, -found.rate_shell_rad_s);
        now.attitude = (now.attitude * crate::paper::attitude::exp(turn_shell)).normalize();
        now.rate_shell_rad_s -= found.rate_shell_rad_s;
        self.velocity -= found.velocity_ground_m_s;
        self.corrected_from.get_or_insert(self.channels);
        self.channels.take(found);
    }

    /// How well rate, attitude and velocity are known.
    #[must_use]
    pub fn deviations(&self) -> Deviations {
        self.filter.deviations()
    }

    /// Standard deviations of a and w' of the sample that was answered last, ground axes, m/s^2 and rad/s^2, but for its own noise.
    #[must_use]
    pub fn accelerations(&self, answered: &SixAxis) -> [f64; 6] {
        self.filter.accelerations(&self.answered, answered)
    }

    /// The parameters, with zero drifts and scale factors as they have been corrected.
    #[must_use]
    pub fn parameters(&self) -> Parameters {
        self.channels.parameters()
    }

    /// The filter.
    #[must_use]
    pub fn filter(&self) -> &ErrorFilter {
        &self.filter
    }

    /// Nothing more is used of the last sample.
    fn pass(&mut self) {
        let _last = self.last.take();
        #[cfg(feature = "alloc")]
        if let (Some(history), Some((block, corrected))) = (&mut self.history, _last) {
            history.pass(block, corrected, &self.filter, &self.channels);
        }
    }
}

#[cfg(feature = "alloc")]
impl AidedDecoupler {
    /// Remembers what [`Self::smoothed`] needs: some 300 bytes a block. To be called before the first sample.
    #[must_use]
    pub fn remembering(mut self) -> Self {
        self.history = Some(Box::new(History::new(&self.filter, &self.channels)));
        self
    }

    /// Decouples the same recording once more, from its first sample, each sample by all aids together, those that came later, too. `again` is a
    /// new decoupler like the one that this was made with. Nothing without [`Self::remembering`].
    #[must_use]
    pub fn smoothed(mut self, again: Decoupler, settings: &Settings) -> Option<SmoothedDecoupler> {
        self.pass();
        SmoothedDecoupler::new(*self.history?, again, settings)
    }
}
