//! A decoder with what else is known of the motion, each at its time.

use std::collections::VecDeque;

use anyhow::{Result, ensure};
use glam::DQuat;
use sixaxis_core::aided::block::Block;
use sixaxis_core::aided::{Aid, AidedDecoupler, RestFinder};
use sixaxis_core::decouple::uncertainty::ZeroWander;
use sixaxis_core::{LimbSet, SixAxis};

use super::Row;
use super::aids::{AidChoice, Fix, fixes};
use super::attitude_agreement::{Agreement, Contradiction};
use super::attitude_summary::{AttitudeSummary, Used};

/// From one measurement of the velocity to the next are 0.5 to 1.5 of the stated time, each time this share of it further on, so that
/// no periodic motion is always met in the same place.
const GOLDEN: f64 = 0.618_033_988_749_895;

/// Measurements of the velocity as they come due.
struct Velocity {
    every_s: f64,
    aid: Aid,
    next_s: f64,
    /// How many have been.
    due: f64,
}

/// A decoder with its aids.
pub struct Aided {
    pub(super) decoder: AidedDecoupler,
    rests: Option<RestFinder>,
    velocity: Option<Velocity>,
    fixes: VecDeque<Fix>,
    /// A fix of this block, with what was decoded at its time.
    pending: Option<(SixAxis, Fix)>,
    agreement: Option<Agreement>,
}

impl Aided {
    pub(super) const fn looks_for_rests(&self) -> bool {
        self.rests.is_some()
    }

    /// A decoder whose channels have this white noise, V.
    ///
    /// # Errors
    /// An aid that stands there twice; a file of attitudes that cannot be read.
    pub fn new(
        decoder: AidedDecoupler,
        aids: &[AidChoice],
        channel_noise_v: &Row,
        sample_rate_hz: f64,
    ) -> Result<Self> {
        let mut new = Self {
            decoder,
            rests: None,
            velocity: None,
            fixes: VecDeque::new(),
            pending: None,
            agreement: None,
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
                    let model = new.decoder.filter().model();
                    new.rests = Some(RestFinder::new(model, channel_noise_v, sample_rate_hz));
                }
                AidChoice::Velocity {
                    every_s,
                    deviation_m_s,
                } => {
                    new.velocity = Some(Velocity {
                        every_s: *every_s,
                        aid: Aid::Velocity {
                            deviation_m_s: *deviation_m_s,
                        },
                        next_s: f64::NEG_INFINITY,
                        due: 0.0,
                    });
                }
                AidChoice::Attitude {
                    file,
                    deviation_deg,
                } => {
                    new.fixes = fixes(file, *deviation_deg)?;
                    new.agreement = Some(Agreement::new(file, new.decoder.clone()));
                }
            }
        }
        Ok(new)
    }

    /// Goes on without the channels of these limbs.
    ///
    /// # Errors
    /// Those of [`AidedDecoupler::set_excluded`].
    pub(super) fn set_excluded(&mut self, limbs: LimbSet) -> sixaxis_core::Result<()> {
        self.decoder.set_excluded(limbs)?;
        if let Some(agreement) = &mut self.agreement {
            agreement.set_excluded(limbs)?;
        }
        if let Some(rests) = &mut self.rests {
            rests.set_excluded(limbs);
        }
        Ok(())
    }

    /// Zeros wander from the first sample on.
    pub(super) fn set_zero_wander(&mut self, wander: ZeroWander) {
        self.decoder.set_zero_wander(wander);
        if let Some(agreement) = &mut self.agreement {
            agreement.set_zero_wander(wander);
        }
    }

    /// Whether nothing else is known of the motion.
    pub(super) const fn is_alone(&self) -> bool {
        self.rests.is_none() && self.velocity.is_none() && self.agreement.is_none()
    }

    /// Aids that come again and again, with the time from one to the next, s.
    pub fn periodic(&self) -> Vec<(Aid, f64)> {
        let velocity = self.velocity.as_ref().map(|v| (v.aid, v.every_s));
        let fixes = match (self.fixes.front(), self.fixes.back()) {
            (Some(first), Some(last)) if self.fixes.len() > 1 => {
                let steps = (self.fixes.len() - 1) as f64;
                Some((first.aid, (last.time_s - first.time_s) / steps))
            }
            _ => None,
        };
        velocity.into_iter().chain(fixes).collect()
    }

    /// Attitudes whose time no sample has reached, or behind which the recording ended before they were used.
    pub(super) fn unused(&self) -> u64 {
        self.fixes.len() as u64 + u64::from(self.pending.is_some())
    }

    /// Takes the next nine voltages and returns the sample before them, once there are three.
    ///
    /// # Errors
    /// Those of [`AidedDecoupler::push`].
    pub(super) fn push(&mut self, voltage_v: &Row) -> sixaxis_core::Result<Option<SixAxis>> {
        if let Some(agreement) = &mut self.agreement {
            agreement.push(voltage_v);
        }
        self.decoder.push(voltage_v)
    }

    /// What is wrong with the attitudes of its file so far, or when the recording has ended.
    pub(super) fn contradiction(&self, ended: bool) -> Option<Contradiction> {
        self.agreement.as_ref()?.contradiction(ended)
    }

    /// Uses what is known of a decoded sample; whether a block ends there.
    pub(super) fn see(
        &mut self,
        sample: &SixAxis,
        time_s: f64,
        step_s: f64,
        summary: &mut AttitudeSummary,
    ) -> bool {
        self.see_fixes(sample, time_s, 0.5 * step_s, &mut summary.attitude);
        let block = self.decoder.block().copied();
        if let Some(block) = &block {
            self.use_all(block, time_s, summary);
        }
        block.is_some()
    }

    /// Takes attitudes whose time a sample has reached: what was decoded then is that sample turned back.
    fn see_fixes(&mut self, sample: &SixAxis, time_s: f64, half_step_s: f64, used: &mut Used) {
        while let Some(fix) = self.fixes.pop_front_if(|fix| fix.time_s <= time_s) {
            let late_s = time_s - fix.time_s;
            if late_s > 4.0 * half_step_s {
                used.unused += 1;
                continue;
            }
            used.unused += u64::from(self.pending.is_some());
            if let Some(agreement) = &mut self.agreement {
                agreement.look_alone(&fix, late_s);
            }
            self.pending = Some((turned_back(sample, late_s), fix));
        }
    }

    /// Uses what is known at the end of a block, if anything: an attitude first, since what was decoded at its time is not corrected since.
    fn use_all(&mut self, block: &Block, time_s: f64, summary: &mut AttitudeSummary) {
        if let Some((then, fix)) = self.pending.take() {
            if let Some(agreement) = &mut self.agreement {
                agreement.look_aided(&self.decoder, &fix, &then);
            }
            summary.attitude.count(self.decoder.aid_of(&fix.aid, &then));
        }
        if let Some(rest) = self.rests.as_mut().and_then(|rests| rests.push(block)) {
            let taken = self.decoder.aid(&rest);
            summary.rest.count(taken);
            summary.steady.count(taken, time_s);
        }
        if let Some(velocity) = &mut self.velocity
            && time_s >= velocity.next_s
        {
            velocity.due += 1.0;
            let share = 0.5 + (GOLDEN * velocity.due).fract();
            velocity.next_s = time_s + velocity.every_s * share;
            if self.decoder.has_lost_attitude() {
                summary.velocity.unused += 1;
            } else {
                summary.velocity.count(self.decoder.aid(&velocity.aid));
            }
        }
    }
}

/// A sample as it was this much earlier, s, by its rate.
pub(super) fn turned_back(sample: &SixAxis, earlier_s: f64) -> SixAxis {
    let back = DQuat::from_scaled_axis(-earlier_s * sample.rate_shell_rad_s);
    SixAxis {
        attitude: sample.attitude * back,
        ..*sample
    }
}
