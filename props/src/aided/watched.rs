//! One run with its aids: decoupled sample by sample, and its errors looked at.

use glam::{DQuat, DVec3};
use nalgebra::{Matrix3, SVector, Vector3};
use rand_pcg::Pcg64;
use sixaxis_core::aided::block::Block;
use sixaxis_core::aided::filter::ErrorCovariance;
use sixaxis_core::aided::model::{ATTITUDE, DYNAMIC, RATE};
use sixaxis_core::aided::{Aid, AidedDecoupler, Bound, RestFinder, Smoothed};
use sixaxis_core::parameter::SCALE;
use sixaxis_core::{Decoupler, LIMBS, Settings, SixAxis};
use sixaxis_reference::motion::TrueMotion;

use super::Aids;

/// Deviation of the attitude up to which errors are of first order, rad: `decouple`'s own limit.
pub const KNOWN_RAD: f64 = 0.0873;
/// Blocks from one look at an acceleration to the next: no motion has its frequency.
const BLOCKS_FROM_LOOK_TO_LOOK: u64 = 97;
/// Time after which nobody asks how wrong the open loop is, s.
pub const OPEN_S: f64 = 65.0;

/// Errors at one time of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Checked {
    /// Time, s.
    pub time_s: f64,
    /// Squared error of the attitude over its covariance, three degrees of freedom.
    pub attitude: f64,
    /// The same of the rate.
    pub rate: f64,
    /// The same of the scale factors, nine degrees of freedom.
    pub scale: f64,
    /// Error of down, rad.
    pub tilt_error_rad: f64,
    /// Error of the rate across the plumb line, rad/s.
    pub rate_across_error_rad_s: f64,
    /// What the attitude's error makes of a, m/s^2.
    pub linear_error_m_s2: f64,
    /// Deviation of the attitude, rad.
    pub attitude_deviation_rad: f64,
    /// Of down, and of the rate across it.
    pub across: Bound,
}

/// How far an estimate of one run was right.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Judged {
    /// Errors at the times asked for, as far as it was decoupled.
    pub looks: Vec<Checked>,
    /// Errors of decoded a, component by component, over their deviations, about once a second while the attitude is known.
    pub over_deviation: Vec<[f64; 3]>,
    /// Time from which on the attitude was not known for the first time, s.
    pub unknown_from_s: Option<f64>,
}

/// What became of one run with its aids.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// As it was decoupled sample by sample.
    pub filtered: Judged,
    /// As it was decoupled with what its whole says, where that was asked for.
    pub smoothed: Option<Judged>,
    /// What its aids leave open in steady state.
    pub bound: Option<Bound>,
}

/// A run with its aids, sample by sample.
pub(super) struct Run<'a> {
    pub(super) aids: &'a Aids,
    pub(super) rng: Pcg64,
    pub(super) aided: AidedDecoupler,
    pub(super) rests: RestFinder,
    pub(super) next_velocity_s: f64,
    pub(super) next_fix_s: f64,
    pub(super) looks: f64,
    pub(super) blocks: u64,
    pub(super) ended: bool,
    /// Samples at the times asked for, with the truth, and those whose acceleration is looked at.
    pub(super) times: Vec<(u64, TrueMotion)>,
    pub(super) looked: Vec<(u64, TrueMotion)>,
    pub(super) outcome: Outcome,
}

/// What all runs of a seed have in common.
pub(super) struct Common<'a> {
    pub(super) times_s: &'a [f64],
    pub(super) rate_hz: f64,
    pub(super) gravity: DVec3,
    /// White noise of a sample in the direction that has most of it.
    pub(super) noise_m_s2: f64,
    /// Scale factors as they are.
    pub(super) scale_per_mass_per_kg: [f64; LIMBS],
}

impl Run<'_> {
    /// Takes a sample; the truth is that of the one before, which is answered.
    pub(super) fn push(
        &mut self,
        voltage_v: &[f64; LIMBS],
        truth: Option<&TrueMotion>,
        common: &Common<'_>,
    ) {
        if self.ended {
            return;
        }
        // A rate without a hold may outgrow what can be decoded.
        let Ok(answer) = self.aided.push(voltage_v) else {
            self.ended = true;
            return;
        };
        let (Some(answer), Some(truth), Some(block)) = (answer, truth, self.aided.block().copied())
        else {
            return;
        };
        let time_s = answer.sample as f64 / common.rate_hz;
        let look = common
            .times_s
            .get(self.outcome.filtered.looks.len())
            .is_some_and(|due_s| time_s >= *due_s);
        let known = self.aided.deviations().attitude_rad() < KNOWN_RAD;
        self.blocks += 1;
        if self.blocks.is_multiple_of(BLOCKS_FROM_LOOK_TO_LOOK) {
            self.looked.push((answer.sample, *truth));
            if known {
                // This sample was decoded before what is known of it is used.
                let deviations = self.aided.accelerations(&answer);
                let off = common.over_deviation(&answer, truth, &deviations);
                self.outcome.filtered.over_deviation.push(off);
            }
        }
        if !known && self.outcome.filtered.unknown_from_s.is_none() {
            self.outcome.filtered.unknown_from_s = Some(time_s);
        }
        self.aid(&block, time_s, truth);
        if look {
            self.times.push((answer.sample, *truth));
            let found = self.now().check(time_s, truth, common);
            self.outcome.filtered.looks.push(found);
        }
        self.ended = self.outcome.filtered.looks.len() == common.times_s.len()
            || (*self.aids == Aids::default() && time_s > OPEN_S);
    }

    fn now(&self) -> State<'_> {
        let now = self.aided.last().expect("a block ends here");
        State {
            attitude: now.attitude,
            rate_shell_rad_s: now.rate_shell_rad_s,
            scale_per_mass_per_kg: self.aided.parameters().scale_per_mass_per_kg,
            covariance: self.aided.filter().covariance(),
            attitude_deviation_rad: self.aided.deviations().attitude_rad(),
        }
    }

    /// The same once more, with what its whole says.
    pub(super) fn smooth(
        self,
        voltages_v: &[[f64; LIMBS]],
        again: Decoupler,
        settings: &Settings,
        common: &Common<'_>,
    ) -> Outcome {
        let mut outcome = self.outcome;
        let mut judged = Judged::default();
        let (mut times, mut looked) = (self.times.iter().peekable(), self.looked.iter().peekable());
        let mut second = self.aided.smoothed(again, settings).expect("it remembers");
        for voltage_v in voltages_v {
            let Ok(answer) = second.push(voltage_v) else {
                break;
            };
            let state = second.state();
            let time_s = state.sample as f64 / common.rate_hz;
            let deviation_rad = state.deviations().attitude_rad();
            if deviation_rad > KNOWN_RAD && judged.unknown_from_s.is_none() {
                judged.unknown_from_s = Some(time_s);
            }
            if let Some((_, truth)) = times.next_if(|(sample, _)| *sample == state.sample) {
                judged
                    .looks
                    .push(State::of(state).check(time_s, truth, common));
            }
            let Some(answer) = answer else {
                continue;
            };
            if let Some((_, truth)) = looked.next_if(|(sample, _)| *sample == answer.sample)
                && deviation_rad < KNOWN_RAD
            {
                let deviations = second.accelerations(&answer);
                let off = common.over_deviation(&answer, truth, &deviations);
                judged.over_deviation.push(off);
            }
        }
        outcome.smoothed = Some(judged);
        outcome
    }

    fn aid(&mut self, block: &Block, time_s: f64, truth: &TrueMotion) {
        if let Some(rest) = self.rests.push(block)
            && self.aids.rests
        {
            self.aided.aid(&rest);
        }
        if let Some((period, deviation_m_s)) = self.aids.velocity
            && time_s >= self.next_velocity_s
        {
            self.looks += 1.0;
            self.next_velocity_s =
                time_s + period * (0.5 + (0.618_033_988_749_895 * self.looks) % 1.0);
            self.aided.aid(&Aid::Velocity { deviation_m_s });
        }
        if let Some((period, deviation_rad)) = self.aids.attitude
            && time_s >= self.next_fix_s
        {
            self.next_fix_s = time_s + period;
            let off = crate::statistics::normal(&mut self.rng) * deviation_rad;
            let attitude = DQuat::from_scaled_axis(off) * truth.attitude;
            self.aided.aid(&Aid::Attitude {
                attitude,
                deviation_rad,
            });
        }
    }
}

impl Common<'_> {
    /// Errors of a sample's a over what is said of them, its own noise with it.
    fn over_deviation(
        &self,
        answer: &SixAxis,
        truth: &TrueMotion,
        deviations: &[f64; 6],
    ) -> [f64; 3] {
        let linear = answer.linear_ground_m_s2 - truth.linear_ground_m_s2;
        core::array::from_fn(|i| linear[i].abs() / deviations[i].hypot(self.noise_m_s2))
    }
}

/// An estimate at one time, with its covariance.
struct State<'a> {
    attitude: DQuat,
    rate_shell_rad_s: DVec3,
    scale_per_mass_per_kg: [f64; LIMBS],
    covariance: &'a ErrorCovariance,
    attitude_deviation_rad: f64,
}

impl<'a> State<'a> {
    fn of(smoothed: &'a Smoothed) -> Self {
        Self {
            attitude: smoothed.attitude,
            rate_shell_rad_s: smoothed.rate_shell_rad_s,
            scale_per_mass_per_kg: smoothed.parameters().scale_per_mass_per_kg,
            covariance: &smoothed.covariance,
            attitude_deviation_rad: smoothed.deviations().attitude_rad(),
        }
    }

    /// Squared error of the scale factors over its covariance.
    fn scale(&self, truth: &[f64; LIMBS]) -> f64 {
        const SCALES: usize = DYNAMIC + SCALE.start;
        let off = SVector::<f64, LIMBS>::from_fn(|i, _| self.scale_per_mass_per_kg[i] - truth[i]);
        let own = self.covariance.fixed_view::<LIMBS, LIMBS>(SCALES, SCALES);
        let inverse = own.into_owned().try_inverse();
        inverse.map_or(f64::INFINITY, |inverse| off.dot(&(inverse * off)))
    }

    fn check(&self, time_s: f64, truth: &TrueMotion, common: &Common<'_>) -> Checked {
        let gravity = common.gravity;
        let of = |at: usize| self.covariance.fixed_view::<3, 3>(at, at).into_owned();
        let (attitude_covariance, rate_covariance) = (of(ATTITUDE), of(RATE));
        let off = (self.attitude * truth.attitude.inverse())
            .normalize()
            .to_scaled_axis();
        let rate = self.rate_shell_rad_s - truth.rate_shell_rad_s;
        let column = |v: DVec3| Vector3::new(v.x, v.y, v.z);
        let normalised = |covariance: &Matrix3<f64>, e: DVec3| {
            let inverse = covariance.try_inverse();
            inverse.map_or(f64::INFINITY, |inverse| {
                column(e).dot(&(inverse * column(e)))
            })
        };
        let across = |covariance: &Matrix3<f64>, along: DVec3| {
            let of_along = column(along).dot(&(covariance * column(along)));
            (covariance.trace() - of_along).max(0.0).sqrt()
        };
        let force = truth.attitude.inverse() * (truth.linear_ground_m_s2 - gravity);
        let linear = self.attitude * force + gravity - truth.linear_ground_m_s2;
        let down = gravity.normalize_or_zero();
        let down_shell = self.attitude.inverse() * down;
        Checked {
            time_s,
            attitude: normalised(&attitude_covariance, off),
            rate: normalised(&rate_covariance, rate),
            scale: self.scale(&common.scale_per_mass_per_kg),
            tilt_error_rad: off.reject_from(gravity).length(),
            rate_across_error_rad_s: rate.reject_from(down_shell).length(),
            linear_error_m_s2: linear.length(),
            attitude_deviation_rad: self.attitude_deviation_rad,
            across: Bound {
                tilt_rad: across(&attitude_covariance, down),
                rate_rad_s: across(&rate_covariance, down_shell),
            },
        }
    }
}
