//! Whether a defect does harm. A wrong gain of a channel without signal in its trial, for one, can neither be found nor matters.
//!
//! The criterion, on the forces that rigid limbs would feel: somewhere the defect changes what is read of a channel by at least
//! [`MATERIAL`] of the largest force of that trial. It applies to defects of channels and to trials of other sensors; the other
//! kinds concern every channel, and their ranges in [`Defect::draw`] begin where they do harm.

use rand::seq::IndexedRandom;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::chain::RANGE_FILLED;
use super::defect::{Defect, Kind, Where};
use super::plan::{DefectChoice, SessionPlan};
use super::schedule::{foreign_sensor, trials};
use crate::geometry::LIMBS;
use crate::rig::run::WEDGES;
use crate::rigid::RigidSensor;
use crate::sensor::TrueSensor;

/// Least change of a channel that counts, as a share of its trial's largest force.
pub const MATERIAL: f64 = 0.05;

/// Samples per crank period at which forces are looked at.
const SAMPLES_PER_PERIOD: f64 = 64.0;

/// Largest drift of a channel over its own signal: most of what an amplifier's range leaves free, the rest being for noise and
/// zero drift. A channel that drifts further would clip, which is another defect.
const ROOM_FOR_DRIFT: f64 = 0.8 * (1.0 / RANGE_FILLED - 1.0);

/// What rigid limbs feel in each trial of a plan.
#[derive(Debug, Clone)]
pub struct Signals {
    sensor: TrueSensor,
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

/// Random stream of [`DefectChoice::Random`].
const KIND_STREAM: u128 = 8;
/// Draws of a defect's particulars before a harmless one is let pass.
const MOST_DRAWS: usize = 1000;

/// The defect of a plan, drawn if only its kind is given or not even that. Drawn ones are drawn again until they do harm, as
/// [`Signals::harmed_by`] has it; what is given exactly is simulated as it is.
#[must_use]
pub fn drawn_defect(plan: &SessionPlan) -> Option<Defect> {
    match &plan.defect {
        DefectChoice::None => None,
        DefectChoice::Random => {
            let mut rng = Pcg64::new(u128::from(plan.seed), KIND_STREAM);
            let kind = Kind::ALL.choose(&mut rng).copied();
            kind.filter(|_| rng.random_bool(0.5))
                .map(|kind| harmful(plan, kind))
        }
        DefectChoice::Kind(kind) => Some(harmful(plan, *kind)),
        DefectChoice::Exactly(defect) => Some(defect.clone()),
    }
}

fn harmful(plan: &SessionPlan, kind: Kind) -> Defect {
    let mut rng = Pcg64::seed_from_u64(plan.seed ^ 0x0d_efec7);
    let signals = Signals::of(plan);
    let mut defect = Defect::draw(kind, plan.trials_per_step, &mut rng);
    // On a rig where nothing does harm, the last one stands.
    for _ in 0..MOST_DRAWS {
        if signals.harmed_by(&defect) {
            break;
        }
        defect = Defect::draw(kind, plan.trials_per_step, &mut rng);
    }
    defect
}

impl Signals {
    /// Simulates the plan's trials, without any defect, on rigid limbs. Limbs that do not hold the mass feel nothing.
    #[must_use]
    pub fn of(plan: &SessionPlan) -> Self {
        let sensor = plan.true_sensor();
        let trials =
            RigidSensor::new(&sensor, &plan.stiffness_ratio()).map_or_else(Vec::new, |rigid| {
                trials(&plan.rig, plan.trials_per_step, None)
                    .iter()
                    .map(|trial| {
                        let rate_hz = SAMPLES_PER_PERIOD * trial.run.frequency_hz;
                        let simulated =
                            rigid.simulate(&trial.run, trial.gravity_ground_m_s2(), rate_hz);
                        let mut force = simulated.limb_force_per_mass_m_s2;
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
            sensor,
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
                let scale = self.sensor.scale_per_mass_per_kg;
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
