//! Whether a defect does harm: a wrong gain of a channel that shows nothing in its trial is no defect that anybody could find,
//! or would have to.
//!
//! The criterion, on the forces that rigid limbs would feel: somewhere the defect changes what is read of a channel by at least
//! [`MATERIAL`] of the largest force of that trial. It is put to defects of channels and to trials of other sensors; the other
//! kinds concern every channel, and their ranges in [`Defect::draw`] begin where they do harm.

use rand_pcg::Pcg64;
use sixaxis_core::{Geometry, LIMBS, Parameters};

use super::defect::{Defect, Where};
use super::plan::{SessionPlan, random_sensor};
use super::schedule::trials;
use crate::campaign::WEDGES;
use crate::rigid::RigidSensor;

/// Least change of a channel that counts, as a share of its trial's largest force.
pub const MATERIAL: f64 = 0.05;

/// Samples per crank period at which forces are looked at.
const SAMPLES_PER_PERIOD: f64 = 64.0;

/// Share of the converter's range that [`crate::chain::amplifier_ranges`] fills at most.
const RANGE_FILLED: f64 = 0.8;

/// Largest drift of a channel over its own signal: most of what an amplifier's range leaves free, the rest being for noise and
/// zero drift. A channel that drifts further would clip, which is another defect.
const ROOM_FOR_DRIFT: f64 = 0.8 * (1.0 / RANGE_FILLED - 1.0);

/// What rigid limbs feel in each trial of a plan.
#[derive(Debug, Clone)]
pub struct Signals {
    parameters: Parameters,
    trials: Vec<Trial>,
    trials_per_step: usize,
}

#[derive(Debug, Clone)]
struct Trial {
    /// Changes of force per mass since the first sample, over the largest of the trial.
    force: Vec<[f64; LIMBS]>,
}

impl Trial {
    fn largest(&self, of: impl Fn(&[f64; LIMBS]) -> f64) -> f64 {
        self.force.iter().map(|f| of(f).abs()).fold(0.0, f64::max)
    }
}

/// Another sensor.
#[must_use]
pub fn foreign_sensor(seed: u64) -> Parameters {
    random_sensor(&mut Pcg64::new(u128::from(seed), 1))
}

impl Signals {
    /// Plays the plan's trials, without any defect, on rigid limbs. Limbs that do not hold the mass feel nothing.
    #[must_use]
    pub fn of(plan: &SessionPlan) -> Self {
        let parameters = plan.parameters();
        let ratio = plan.stiffness_ratio();
        let sensor = RigidSensor::new(&Geometry::PAPER, &parameters.inertia_per_mass, &ratio);
        let trials = sensor.map_or_else(Vec::new, |sensor| {
            trials(plan, None)
                .iter()
                .map(|trial| {
                    let run = trial.run(&plan.rig, trial.direction);
                    let gravity = plan.rig.mounting.gravity_ground_m_s2(trial.direction);
                    let rate_hz = SAMPLES_PER_PERIOD * trial.frequency_hz;
                    let mut force = sensor.play(&run, gravity, rate_hz).limb_force_per_mass_m_s2;
                    let rest = force.first().copied().unwrap_or_default();
                    let largest = force
                        .iter()
                        .flat_map(|f| (0..LIMBS).map(|i| (f[i] - rest[i]).abs()))
                        .fold(f64::MIN_POSITIVE, f64::max);
                    for f in &mut force {
                        *f = core::array::from_fn(|i| (f[i] - rest[i]) / largest);
                    }
                    Trial { force }
                })
                .collect()
        });
        Self {
            parameters,
            trials,
            trials_per_step: plan.trials_per_step,
        }
    }

    /// Whether a defect does harm.
    #[must_use]
    pub fn harmed_by(&self, defect: &Defect) -> bool {
        let peak = |trial: &usize, channel: usize| {
            self.trials
                .get(*trial)
                .map_or(0.0, |t| t.largest(|f| f[channel]))
        };
        let somewhere = |place: &Where, change: &dyn Fn(&Trial) -> f64| {
            self.trials
                .iter()
                .enumerate()
                .any(|(i, trial)| place.holds(Some(i)) && change(trial) >= MATERIAL)
        };
        match defect {
            Defect::DeadLimb { channel, place } => {
                somewhere(place, &|t| t.largest(|f| f[*channel]))
            }
            Defect::SwappedChannels {
                channels: [a, b],
                place,
            } => somewhere(place, &|t| t.largest(|f| f[*a] - f[*b])),
            Defect::InvertedChannel { channel, place } => {
                somewhere(place, &|t| t.largest(|f| 2.0 * f[*channel]))
            }
            Defect::WrongGain {
                channel,
                place,
                factor,
            } => somewhere(place, &|t| t.largest(|f| (factor - 1.0) * f[*channel])),
            Defect::MillivoltMixUp {
                channel,
                place,
                factor,
            } => somewhere(place, &|t| {
                t.largest(|f| {
                    (0..LIMBS)
                        .filter(|i| channel.is_none_or(|c| c == *i))
                        .map(|i| ((factor - 1.0) * f[i]).abs())
                        .fold(0.0, f64::max)
                })
            }),
            // How much is cut off is the defect's own affair; there has to be something to be cut.
            Defect::ClippedConverter { channel, trial, .. } => peak(trial, *channel) >= MATERIAL,
            Defect::DriftDuringRun {
                channel,
                trial: Some(trial),
                share,
            } => {
                let signal = peak(trial, *channel);
                signal >= MATERIAL && share.abs() <= ROOM_FOR_DRIFT * signal
            }
            Defect::ForeignTrial { trial, seed } => {
                let scale = self.parameters.scale_per_mass_per_kg;
                let other = foreign_sensor(*seed).scale_per_mass_per_kg;
                somewhere(&Where::Trial(*trial), &|t| {
                    t.largest(|f| {
                        (0..LIMBS)
                            .map(|i| ((scale[i] / other[i] - 1.0) * f[i]).abs())
                            .fold(0.0, f64::max)
                    })
                })
            }
            Defect::LooseWedge { wedge, .. } => *wedge < WEDGES.len().min(self.trials_per_step),
            Defect::DriftDuringRun { trial: None, .. }
            | Defect::WrongAccelerometer { .. }
            | Defect::WrongGyroscope { .. }
            | Defect::GravityNotHandled { .. }
            | Defect::UnderExcitedAxis { .. }
            | Defect::ReferenceClock { .. }
            | Defect::WrongSampleRate { .. }
            | Defect::GyroscopeLag { .. } => true,
        }
    }
}
