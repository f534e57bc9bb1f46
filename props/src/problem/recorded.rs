//! The problems: runs of the rig, and one tumble, recorded without noise from MuJoCo, with their truth.
//!
//! The sensor is the paper's as identified. Solving for what a problem asks needs only what a laboratory has; the
//! truth is there to hold answers against.

use std::f64::consts::{PI, TAU};

use crate::problem::rig;
use crate::truth;
use crate::truth::InCore;
use glam::{DVec3, Vec3Swizzles};
use sixaxis_core::decouple::stream::Decoupler;
use sixaxis_core::identify::inertia::{InertiaEstimate, InertiaIdentification};
use sixaxis_core::identify::scale::{ScaleIdentification, ScalePerMass};
use sixaxis_core::paper::signal::SignalChain;
use sixaxis_core::paper::{self, RateVariable};
use sixaxis_core::{Geometry, LIMBS, Model, Parameters, Scheme, Sensor, Settings};
use sixaxis_reference::laboratory::Laboratory;
use sixaxis_reference::laboratory::recording::SimulatedRecording;
use sixaxis_reference::motion::Motion;
use sixaxis_reference::motion::{SimulatedRun, TrueMotion};
use sixaxis_reference::mujoco::model::SensorModel;
use sixaxis_reference::mujoco::simulate_run;
use sixaxis_reference::mujoco::simulation::{Simulation, Snapshot};
use sixaxis_reference::rig::run::{Mode, Mounting, Run};

/// Step of every simulation, s: half the study's 25 us, at which MuJoCo's own error, 1e-7, would let a fault of that
/// size pass in the schemes of fourth order. At this step it is 6e-9.
pub const STEP_S: f64 = 1.25e-5;
/// Sample rate of recordings that are decoupled, Hz.
pub const DECOUPLE_RATE_HZ: f64 = 10_000.0;
/// Sample rate of recordings that parameters are identified from, Hz.
const IDENTIFY_RATE_HZ: f64 = 1_000.0;
/// Crank frequency of the identification runs, Hz: the upper end of steps 2 and 3.
pub const SLOW_HZ: f64 = 2.0;
/// Crank frequency of the run for step 4, Hz: the upper end of that step.
pub const FAST_HZ: f64 = 5.0;
/// Directions of the identification runs: what makes them independent.
pub const DIRECTIONS: [DVec3; 3] = [
    DVec3::new(1.0, 1.0, 2.0),
    DVec3::new(1.0, 2.0, 1.0),
    DVec3::new(2.0, 1.0, 1.0),
];

/// True parameters of the sensor in every problem.
pub fn true_parameters() -> Parameters {
    truth::identified_parameters()
}

/// The run behind Table 6: compound motion at 5 Hz.
pub fn compound_5_hz() -> Run {
    rig::compound_run()
}

/// MuJoCo's model of the true sensor on the rig of a run.
pub fn model(run: &Run) -> SensorModel {
    let parameters = true_parameters();
    rig::model(&parameters, run.direction_ground, Mounting::AxisVertical)
}

/// One recorded run with its truth.
pub struct Recorded {
    /// What a laboratory has.
    pub recording: SimulatedRecording,
    /// What MuJoCo knows, at the same instants.
    pub truth: Vec<TrueMotion>,
}

impl Recorded {
    /// Plays a run on MuJoCo with [`STEP_S`] and records it without errors.
    ///
    /// # Panics
    /// If MuJoCo refuses the sensor or diverges.
    pub fn play(run: &Run, sample_rate_hz: f64) -> Self {
        Self::play_with_step(run, sample_rate_hz, STEP_S)
    }

    /// Plays a run with another step: what the reference's own error is measured with.
    ///
    /// # Panics
    /// If MuJoCo refuses the sensor or diverges.
    pub fn play_with_step(run: &Run, sample_rate_hz: f64, step_s: f64) -> Self {
        let run = simulate_run(
            &model(run),
            run,
            sample_rate_hz,
            (1.0 / (sample_rate_hz * step_s)).round() as usize,
        )
        .expect("the simulation of a bench's problem");
        Self::record(run)
    }

    /// Plays a [`Tumble`] at [`DECOUPLE_RATE_HZ`].
    ///
    /// # Panics
    /// If MuJoCo refuses the sensor or diverges.
    pub fn tumble() -> Self {
        // Only the standard instruments, which nobody reads here, are aligned with the trial's run.
        let run = compound_5_hz();
        let snapshots = sampled(&run, &Tumble, TUMBLE_S);
        Self::record(SimulatedRun {
            motion: run,
            gravity_ground_m_s2: model(&run).gravity_ground_m_s2,
            sample_rate_hz: DECOUPLE_RATE_HZ,
            limb_force_per_mass_m_s2: snapshots
                .iter()
                .map(|now| now.limb_force_per_mass_m_s2)
                .collect(),
            truth: snapshots.iter().map(Snapshot::true_motion).collect(),
        })
    }

    fn record(run: SimulatedRun) -> Self {
        Self {
            recording: Laboratory::noise_free(truth::sensor(&true_parameters())).record(&run, 0),
            truth: run.truth,
        }
    }

    /// The sensor with the amplifier range of this recording.
    pub fn sensor(&self) -> Sensor {
        self.recording.sensor()
    }

    /// Settings that go with this recording.
    pub fn settings(&self, scheme: Scheme) -> Settings {
        self.recording.settings(scheme)
    }

    /// A decoupler ready for this recording's first sample, with the true parameters.
    ///
    /// # Panics
    /// If the core refuses the problem.
    pub fn decoupler(&self, scheme: Scheme) -> Decoupler {
        Decoupler::new(&self.sensor(), &true_parameters(), &self.settings(scheme))
            .expect("a decoupler of the true sensor")
    }

    /// The paper's decoder ready for this recording's first sample, with w* stepped as printed.
    ///
    /// # Panics
    /// If the core refuses the problem.
    pub fn paper_decoder(&self, parameters: &Parameters) -> paper::Decoder {
        let settings = self.settings(Scheme::Heun);
        Model::new(&self.sensor(), parameters, &settings)
            .and_then(|model| paper::Decoder::new(&model, RateVariable::Shell))
            .expect("a decoder of the true sensor")
    }

    /// Sum of |w*| over the recording and the number of its samples, by the paper's decoder: step 4 for one candidate.
    ///
    /// # Panics
    /// If the core refuses the problem.
    pub fn paper_rate_norm_sum(&self, parameters: &Parameters) -> (f64, usize) {
        let (mut sum, mut count) = (0.0, 0);
        self.paper_decoder(parameters)
            .push_all(&self.recording.voltage_v, |sample| {
                sum += sample.rate_shell_rad_s.length();
                count += 1;
            })
            .expect("samples of a recorded run");
        (sum, count)
    }
}

/// Limb lengths with the poses that MuJoCo had them at.
pub struct Poses {
    /// Nine elongations per sample, m.
    pub elongation_m: Vec<[f64; LIMBS]>,
    /// True position of the mass in the shell, m, and its rotation vector, rad.
    pub truth: Vec<(DVec3, DVec3)>,
}

impl Poses {
    /// Plays a run and keeps lengths and poses at [`DECOUPLE_RATE_HZ`].
    ///
    /// # Panics
    /// If MuJoCo refuses the sensor or diverges.
    pub fn play(run: &Run) -> Self {
        let snapshots = sampled(run, run, run.duration_s());
        Self {
            elongation_m: snapshots.iter().map(|now| now.limb_elongation_m).collect(),
            truth: snapshots.iter().map(Snapshot::relative_pose).collect(),
        }
    }
}

/// Length of a [`Tumble`], s.
const TUMBLE_S: f64 = 0.4;
/// Frequencies of its three axes, Hz.
const TUMBLE_HZ: DVec3 = DVec3::new(3.0, 4.0, 5.0);
/// Linear and angular amplitude of each axis, m/s^2 and rad/s^2: those of the compound run.
const TUMBLE_AMPLITUDE: (f64, f64) = (50.0, 800.0);

/// Motion with an axis that turns in the shell. The rig's axis never does, so that no run of it shows the coning term
/// of the attitude or what a wrong order of rotations does. Swells from rest and is cut off as it dies down.
pub struct Tumble;

impl Motion for Tumble {
    fn acceleration(&self, time_s: f64) -> (DVec3, DVec3) {
        let swell = (PI * time_s / TUMBLE_S).sin().powi(4);
        let phase = TUMBLE_HZ * (TAU * time_s);
        let (linear, angular) = TUMBLE_AMPLITUDE;
        let wave = |phase: DVec3| DVec3::new(phase.x.sin(), phase.y.cos(), phase.z.sin()) * swell;
        (wave(phase.zxy()) * linear, wave(phase) * angular)
    }
}

/// Snapshots at [`DECOUPLE_RATE_HZ`] of a run's sensor in a motion.
fn sampled(run: &Run, motion: &impl Motion, duration_s: f64) -> Vec<Snapshot> {
    let steps_per_sample = (1.0 / (DECOUPLE_RATE_HZ * STEP_S)).round() as usize;
    let steps = (duration_s / STEP_S).round() as usize;
    let mut simulation = simulation(run);
    (0..steps)
        .map(|step| {
            simulation.set_time_s(step as f64 * STEP_S);
            simulation
                .step(motion)
                .expect("a step of a bench's problem")
        })
        .step_by(steps_per_sample)
        .collect()
}

/// The sensor of a run in MuJoCo, hanging at rest.
///
/// # Panics
/// If MuJoCo refuses the sensor.
pub fn simulation(run: &Run) -> Simulation {
    Simulation::new(&model(run), STEP_S).expect("the simulation of a bench's problem")
}

/// Rows of step 2: measured forces, N, and the shell's acceleration, m/s^2.
pub struct ScaleRows(pub Vec<([f64; LIMBS], DVec3)>);

impl ScaleRows {
    /// From three pure linear runs at [`SLOW_HZ`].
    pub fn play() -> Self {
        let drift = true_parameters().zero_drift_v;
        let rows = DIRECTIONS.into_iter().flat_map(|direction| {
            let run = Run::new(Mode::Linear, SLOW_HZ, direction);
            let Recorded { recording, .. } = Recorded::play(&run, IDENTIFY_RATE_HZ);
            let row = |(voltage, &reading): (&[f64; LIMBS], &f64)| {
                let force = recording.gains().measured_force_n(voltage, &drift);
                (force, recording.direction_ground * reading)
            };
            let samples = recording.voltage_v.iter();
            samples
                .zip(&recording.accelerometer_m_s2)
                .map(row)
                .collect::<Vec<_>>()
        });
        Self(rows.collect())
    }

    /// Step 2 with the core.
    ///
    /// # Panics
    /// If the core refuses the rows.
    pub fn solve(&self) -> ScalePerMass {
        let mut step = ScaleIdentification::default();
        for (force, acceleration) in &self.0 {
            step.push(force, *acceleration).expect("a finite row");
        }
        step.solve().expect("a scale per mass")
    }
}

/// Rows of step 3: limb forces per mass, m/s^2; the shell's rate, rad/s, and its derivative, rad/s^2, shell axes.
pub struct InertiaRows(pub Vec<([f64; LIMBS], DVec3, DVec3)>);

impl InertiaRows {
    /// From three pure angular runs at [`SLOW_HZ`]. The rate is the gyroscope's; its derivative is the true one,
    /// because differentiating a reading is not part of the step.
    pub fn play() -> Self {
        let rows = DIRECTIONS.into_iter().flat_map(|direction| {
            let run = Run::new(Mode::Angular, SLOW_HZ, direction);
            let Recorded { recording, truth } = Recorded::play(&run, IDENTIFY_RATE_HZ);
            let chain = SignalChain::new(&recording.gains(), &true_parameters());
            (0..truth.len())
                .map(|i| {
                    (
                        chain.force_per_mass_m_s2(&recording.voltage_v[i]),
                        recording.direction_ground * recording.gyroscope_rad_s[i],
                        truth[i].attitude.inverse() * truth[i].angular_ground_rad_s2,
                    )
                })
                .collect::<Vec<_>>()
        });
        Self(rows.collect())
    }

    /// Step 3 with the core.
    ///
    /// # Panics
    /// If the core refuses the rows.
    pub fn solve(&self) -> InertiaEstimate {
        let mut step = InertiaIdentification::new(Geometry::PAPER);
        for (force, rate, derivative) in &self.0 {
            step.push(force, *rate, *derivative).expect("a finite row");
        }
        step.solve().expect("an inertia per mass")
    }
}

/// A pure linear run at [`FAST_HZ`] for step 4, in which the true rate is zero.
pub fn stiffness_run() -> Recorded {
    let [direction, ..] = DIRECTIONS;
    let run = Run::new(Mode::Linear, FAST_HZ, direction);
    Recorded::play(&run, DECOUPLE_RATE_HZ)
}

/// The true parameters with a candidate k/m.
pub fn candidate(stiffness_per_mass_per_s2: f64) -> Parameters {
    Parameters {
        stiffness_per_mass_per_s2,
        ..true_parameters()
    }
}
