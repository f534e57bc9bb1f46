//! False alarms end to end: healthy laboratories, calibrated from their own recordings, then watched by what
//! `sixaxis decouple --watch` calls, at the rate of false alarms that it has by default.
//!
//! A laboratory is healthy as those of the blind trials: rigid limbs of slightly unequal stiffness, a random sensor, wedges of
//! 0.01 degrees, 60 dB, 16 bits. Nothing in it fails, so that every alarm is false. Beside it, to tell causes apart, the
//! same with limbs equally stiff, and either with the true parameters in the calibration's place, known to be exact.

use std::path::Path;

use glam::DVec3;
use rand::RngExt;
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};
use sixaxis_calibration::apply::check_grade::check_grade;
use sixaxis_calibration::apply::fault_watch::FaultWatch;
use sixaxis_calibration::apply::setup::{Overrides, Setup};
use sixaxis_calibration::calibrate::{Options, calibrate};
use sixaxis_calibration::calibration::{CalibratedLimbs, CalibratedParameters, Calibration};
use sixaxis_calibration::progress::NoProgress;
use sixaxis_calibration::report::Grade;
use sixaxis_core::parameter::PARAMETERS;
use sixaxis_core::{LIMBS, Scheme};
use sixaxis_recordings::session::SessionFile;
use sixaxis_reference::laboratory::chain::Chain;
use sixaxis_reference::laboratory::plan::{ChainPlan, Engine, RigPlan, SensorChoice, SessionPlan};
use sixaxis_reference::laboratory::session::simulate_session;
use sixaxis_reference::laboratory::write::write;
use sixaxis_reference::rig::field::{Field, Pace};
use sixaxis_reference::rig::run::{Mode, Mounting, Run, WEDGES};
use sixaxis_reference::rigid::RigidSensor;

use super::FALSE_ALARMS_PER_HOUR;
use crate::truth;

/// Length of one recording, s.
pub const RECORDING_S: f64 = 60.0;
/// Recordings of each course of motion in a laboratory.
const ROUNDS: usize = 2;
/// Crank frequencies of the rig, from and to, Hz: a session's own bands and what lies beside them.
pub const RIG_HZ: (f64, f64) = (0.5, 5.0);
/// Largest error of a wedge, degrees.
pub const WEDGE_ERROR_DEG: f64 = 0.01;
/// Standard deviation of the limbs' stiffnesses about their mean, relative, where they are not equal.
pub const STIFFNESS_SPREAD: f64 = 2e-3;
/// Random stream of the motions; the noise of recording n has the one n further.
const STREAM: u128 = 1 << 32;

/// What the sensor does in a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Course {
    /// Nothing.
    Rest,
    /// On the rig's slider.
    Linear,
    /// About the rig's pinion.
    Angular,
    /// Both at once.
    Compound,
    /// Turned by hand, slowly.
    Calm,
    /// Turned by hand, fast.
    Brisk,
    /// Shaken by hand.
    Shaken,
}

impl Course {
    /// All.
    pub const ALL: [Self; 7] = [
        Self::Rest,
        Self::Linear,
        Self::Angular,
        Self::Compound,
        Self::Calm,
        Self::Brisk,
        Self::Shaken,
    ];

    const fn on_the_rig(self) -> Result<Mode, Pace> {
        match self {
            Self::Rest => Ok(Mode::Rest),
            Self::Linear => Ok(Mode::Linear),
            Self::Angular => Ok(Mode::Angular),
            Self::Compound => Ok(Mode::Compound),
            Self::Calm => Err(Pace::Calm),
            Self::Brisk => Err(Pace::Brisk),
            Self::Shaken => Err(Pace::Shaken),
        }
    }
}

/// In which respects a laboratory is better than a real one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Corner {
    /// The limbs are equally stiff.
    pub equal_limbs: bool,
    /// The monitor has the true parameters and the true noise, and is told that they are exact.
    pub true_parameters: bool,
}

/// One recording and what was said of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// The laboratory's seed.
    pub seed: u64,
    /// The laboratory and the calibration.
    pub corner: Corner,
    /// The motion.
    pub course: Course,
    /// Samples.
    pub samples: u64,
    /// Alarms that began an isolation.
    pub alarms: u64,
    /// Answers with a limb excluded or suspected.
    pub flagged: u64,
    /// The monitor's messages.
    pub messages: Vec<String>,
}

/// What a laboratory writes down of one recording.
pub struct Recorded {
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Amplifier ranges, N/V.
    pub gain_n_per_v: [f64; LIMBS],
    /// Gravity in the sensor's axes at rest.
    pub down: DVec3,
    /// Nine voltages a sample, V.
    pub voltage_v: Vec<[f64; LIMBS]>,
}

/// The plan of a seed's laboratory.
pub fn plan(seed: u64, equal_limbs: bool) -> SessionPlan {
    SessionPlan {
        seed,
        sensor: SensorChoice::Random,
        engine: Engine::Rigid,
        rig: RigPlan {
            wedge_error_deg: WEDGE_ERROR_DEG,
            ..RigPlan::default()
        },
        chain: ChainPlan {
            stiffness_spread: if equal_limbs { 0.0 } else { STIFFNESS_SPREAD },
            ..ChainPlan::default()
        },
        ..SessionPlan::default()
    }
}

/// Plays a laboratory's session into a folder of its own below `folder`, calibrates what lies there and clears it away: the
/// calibration and its grade.
///
/// # Errors
/// What went wrong, in words, with the seed.
pub fn calibrated(plan: &SessionPlan, folder: &Path) -> Result<Calibration, String> {
    let seed = plan.seed;
    let spread = plan.chain.stiffness_spread;
    let own = folder.join(format!("session-{seed}-{spread}"));
    let at = |what: &str, e: &dyn core::fmt::Display| format!("seed {seed}: {what}: {e}");
    let played = simulate_session(plan).map_err(|e| at("playing", &e))?;
    let session = write(&played, &own, "npz").map_err(|e| at("writing", &e))?;
    drop(played);
    let judged = SessionFile::read(&session)
        .map_err(Into::into)
        .and_then(|file| calibrate(&file, &Options::default(), &NoProgress))
        .map_err(|e| at("judging", &e));
    std::fs::remove_dir_all(&own).map_err(|e| at("clearing", &e))?;
    let calibration = judged?.calibration;
    calibration.ok_or_else(|| at("judging", &"no calibration"))
}

/// The same calibration with the true parameters and stiffnesses and the chain's own noise, all of them stated as exact.
pub fn exact(calibration: &Calibration, plan: &SessionPlan) -> Calibration {
    let chain = Chain::laboratory();
    let step_v = chain.resolution_bits.map_or(0.0, |bits| {
        2.0 * chain.full_scale_v / 2.0_f64.powi(bits as i32)
    });
    // A rounded value is off by an even spread over one step.
    let noise_v = (chain.noise_v().powi(2) + step_v * step_v / 12.0).sqrt();
    let mut exact = calibration.clone();
    exact.parameters = CalibratedParameters::from(truth::parameters(&plan.true_sensor()));
    if let Some(propagated) = &mut exact.covariance.propagated {
        let nothing = vec![vec![0.0; PARAMETERS]; PARAMETERS];
        propagated.noise.clone_from(&nothing);
        propagated.standards = nothing;
        propagated.channel_noise_v = [noise_v; LIMBS];
    }
    exact.limbs = Some(CalibratedLimbs {
        stiffness_ratio: plan.stiffness_ratio(),
        ..CalibratedLimbs::EXACT
    });
    exact
}

/// Makes a laboratory's recording number `index`: a motion drawn anew and noise of its own.
///
/// # Errors
/// Limbs that do not hold the mass.
pub fn record(plan: &SessionPlan, course: Course, index: usize) -> Result<Recorded, String> {
    let mut rng = Pcg64::new(u128::from(plan.seed), STREAM + index as u128);
    let (sensor, chain) = (plan.true_sensor(), Chain::laboratory());
    let rate_hz = plan.sample_rate_hz;
    let rigid = RigidSensor::new(&sensor, &plan.stiffness_ratio())
        .ok_or_else(|| format!("seed {}: limbs that do not hold the mass", plan.seed))?;
    let (forces, gravity) = match course.on_the_rig() {
        Ok(mode) => {
            let frequency_hz = rng.random_range(RIG_HZ.0..RIG_HZ.1);
            let wedge = WEDGES[rng.random_range(0..WEDGES.len())];
            let run = plan.rig.run(mode, frequency_hz, wedge);
            let ramps_s = RECORDING_S
                - Run {
                    steady_periods: 0.0,
                    ..run
                }
                .duration_s();
            let run = Run {
                steady_periods: (ramps_s * frequency_hz).floor(),
                ..run
            };
            let gravity = Mounting::AxisVertical.gravity_ground_m_s2(run.direction_ground);
            let simulated = rigid.simulate(&run, gravity, rate_hz);
            (simulated.limb_force_per_mass_m_s2, gravity)
        }
        Err(pace) => {
            let field = Field::by_hand(&mut rng, pace, RECORDING_S, rate_hz);
            let (loads, _) = field.simulate(&sensor);
            let forces = loads.iter().map(|load| rigid.forces_m_s2(load)).collect();
            (forces, field.gravity_ground_m_s2)
        }
    };
    let gain_n_per_v = chain.amplifier_ranges(&forces, &sensor);
    Ok(Recorded {
        sample_rate_hz: rate_hz,
        gain_n_per_v,
        down: gravity.normalize(),
        voltage_v: chain.record(&forces, &sensor, &gain_n_per_v, rate_hz, &mut rng),
    })
}

impl Recorded {
    /// What the command is told of it beside the calibration.
    pub fn overrides(&self) -> Overrides {
        Overrides {
            gain_n_per_v: self.gain_n_per_v.to_vec(),
            rate_hz: Some(self.sample_rate_hz),
            down: Some(self.down.to_array()),
            ..Overrides::default()
        }
    }

    /// Watches it with a calibration, as the command does: alarms, flagged answers, messages.
    ///
    /// # Errors
    /// Those of the command.
    pub fn watched(&self, calibration: &Calibration) -> Result<(u64, u64, Vec<String>), String> {
        let setup =
            Setup::new(calibration, None, None, &self.overrides()).map_err(|e| format!("{e:#}"))?;
        // The command's default.
        let settings = setup.settings(self.sample_rate_hz, Scheme::HeunSubstepped);
        let watch = FaultWatch::new(&setup, calibration, &settings, FALSE_ALARMS_PER_HOUR);
        let mut watch = watch.map_err(|e| format!("{e:#}"))?;
        let mut flagged = 0;
        for row in &self.voltage_v {
            if let Some((_, flags)) = watch.push(row).map_err(|e| e.to_string())? {
                flagged += u64::from(flags != [0.0; 2]);
            }
        }
        Ok((watch.alarms, flagged, watch.messages))
    }
}

/// Plays and calibrates one laboratory, then watches all courses of motion, with the calibration and with the true parameters:
/// its grade, and each recording. Of a calibration that is not good, which the command refuses, there are no recordings.
///
/// # Errors
/// What went wrong, in words, with the seed.
pub fn watch(
    seed: u64,
    equal_limbs: bool,
    folder: &Path,
) -> Result<(Grade, Vec<Recording>), String> {
    let plan = plan(seed, equal_limbs);
    let calibration = calibrated(&plan, folder)?;
    let grade = calibration.verdict;
    if check_grade("calibration.json", &calibration, false).is_err() {
        return Ok((grade, Vec::new()));
    }
    let exact = exact(&calibration, &plan);
    let mut recordings = Vec::new();
    for index in 0..ROUNDS * Course::ALL.len() {
        let course = Course::ALL[index % Course::ALL.len()];
        let recorded = record(&plan, course, index)?;
        for (true_parameters, known) in [(false, &calibration), (true, &exact)] {
            let (alarms, flagged, messages) = recorded
                .watched(known)
                .map_err(|e| format!("seed {seed}, {course:?}: {e}"))?;
            recordings.push(Recording {
                seed,
                corner: Corner {
                    equal_limbs,
                    true_parameters,
                },
                course,
                samples: recorded.voltage_v.len() as u64,
                alarms,
                flagged,
                messages,
            });
        }
    }
    Ok((grade, recordings))
}
