//! Random six-axis motions of random sensors, simulated and decoupled: the comparison that the project stands on.
//!
//! Half of them keep to the rig's travel and speed, half go far beyond, drawn up to 200 Hz and 500 m/s^2; all turn about axes that
//! turn. Each is simulated twice, with a step and with half of it, and what that changes in the comparison is the
//! reference's own error. The decoupler is given voltages, the true parameters and how the sensor hangs; truth comes
//! from the simulator's state.

use core::array::from_fn;
use core::f64::consts::{PI, TAU};

use crate::truth;
use glam::DVec3;
use rand::RngExt;
use rand_pcg::Pcg64;
use rayon::prelude::*;
use sixaxis_core::decouple::stream::Decoupler;
use sixaxis_core::redundancy::fault::Watch;
use sixaxis_core::redundancy::tolerant::{FaultTolerant, ROWS_KEPT};
use sixaxis_core::{
    CrossTalk, Geometry, LIMBS, Parameters, Scheme, Sensor, Settings, SixAxis, StaticResponse,
};
use sixaxis_reference::limbs::shown_of_rods_m_s2;
use sixaxis_reference::motion::TrueMotion;
use sixaxis_reference::mujoco::model::SensorModel;
use sixaxis_reference::mujoco::simulation::Simulation;
use sixaxis_reference::rig::tumble::{SINES, Sine, Tumble};
use sixaxis_reference::{paper, rig};

use crate::compare::largest;
use crate::evidence::Row;
use crate::tolerance::Tolerance;

/// Lowest sample rate, Hz, and samples per period of the fastest sine above it.
const LOWEST_RATE_HZ: f64 = 10_000.0;
const SAMPLES_PER_PERIOD: f64 = 500.0;
/// Longest Runge-Kutta step of the coarser simulation, s.
const LONGEST_STEP_S: f64 = 2.5e-5;

/// Random stream of the cases.
const STREAM: u128 = 33;

/// Share of full scale that limb damping may move the limb lengths by: the core, like the paper, knows of none.
const DAMPING_EFFECT: f64 = 2e-8;
/// Damping that keeps rounding noise out of the modes where motion is slow enough to allow it.
const LARGEST_DAMPING_RATIO: f64 = 0.02;

/// One random motion of one random sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Case {
    /// True parameters.
    pub parameters: Parameters,
    /// Motion of the shell.
    pub motion: Tumble,
    /// Gravity, ground axes, m/s^2.
    pub gravity_ground_m_s2: DVec3,
    /// What the channels say of a constant load.
    pub static_response: StaticResponse,
    /// Half a limb's mass over the seismic mass, which its channel shows.
    pub rod_mass: f64,
}

impl Case {
    /// Number `index` of the cases that `seed` stands for, the same on every machine: a random sensor under gravity, and a
    /// random motion of it, within the rig's travel and speed (up to 93 mm, 100 deg, 1 to 5 Hz) or, as often, far beyond (up
    /// to 500 m/s^2, 50 rad/s, 5 to 200 Hz).
    pub fn numbered(seed: u64, index: u64) -> Self {
        let rng = &mut Pcg64::new((u128::from(seed) << 64) | u128::from(index), STREAM);
        let parameters = truth::random_parameters(rng);
        let motion = random_motion(rng);
        let down = in_cube(rng, 1.0).normalize_or(DVec3::NEG_Z);
        Self {
            parameters,
            motion,
            gravity_ground_m_s2: down * paper::GRAVITY_M_S2,
            static_response: if rng.random() {
                StaticResponse::Full
            } else {
                StaticResponse::Tared
            },
            rod_mass: 0.0,
        }
    }

    /// Samples per second.
    pub fn sample_rate_hz(&self) -> f64 {
        (SAMPLES_PER_PERIOD * self.motion.highest_frequency_hz()).max(LOWEST_RATE_HZ)
    }

    /// The rise and two periods of the fastest sine.
    pub fn duration_s(&self) -> f64 {
        self.motion.rise_s + 2.0 / self.motion.highest_frequency_hz()
    }

    fn model(&self) -> SensorModel {
        // A damper's share of a limb's force at frequency f is 2 zeta f/f0, and a limb's length weighs (f/f0)^2 in the
        // accelerations, f0 being the frequency of the mass on one limb.
        let f0 = self.parameters.stiffness_per_mass_per_s2.sqrt() / TAU;
        let share = self.motion.highest_frequency_hz() / f0;
        SensorModel {
            damping_ratio: (DAMPING_EFFECT / (2.0 * share.powi(3))).min(LARGEST_DAMPING_RATIO),
            ..truth::model(&self.parameters, self.gravity_ground_m_s2)
        }
    }

    /// Simulates with `refinement` times the usual number of steps and records without errors.
    ///
    /// # Panics
    /// If the simulation refuses.
    pub fn recorded(&self, refinement: usize) -> Recorded {
        let rate = self.sample_rate_hz();
        let steps = (1.0 / (rate * LONGEST_STEP_S)).ceil() as usize * refinement;
        let run = sixaxis_reference::mujoco::simulate(
            &self.model(),
            &self.motion,
            self.duration_s(),
            rate,
            steps,
        )
        .expect("the simulation of a random motion");
        let rest = match self.static_response {
            StaticResponse::Tared => {
                Simulation::mean_rest_force_per_mass_m_s2(&self.model(), LONGEST_STEP_S)
                    .expect("the simulation of a sensor at rest")
            }
            StaticResponse::Full => [0.0; LIMBS],
        };
        let drawing = sixaxis_reference::geometry::Geometry::PAPER;
        let of_rods = |motion: &TrueMotion| {
            shown_of_rods_m_s2(&drawing, self.rod_mass, motion, self.gravity_ground_m_s2)
        };
        let at_rest = match (self.static_response, run.truth.first()) {
            (StaticResponse::Tared, Some(first)) => of_rods(&TrueMotion::at_rest(first.attitude)),
            _ => [0.0; LIMBS],
        };
        let forces: Vec<[f64; LIMBS]> = run
            .limb_force_per_mass_m_s2
            .iter()
            .zip(&run.truth)
            .map(|(force, motion)| {
                let of_rods = of_rods(motion);
                from_fn(|i| (force[i] - rest[i]) + (of_rods[i] - at_rest[i]))
            })
            .collect();
        let gains = truth::amplifier_ranges(&forces, &self.parameters);
        let signal = truth::sensor(&self.parameters);
        let voltages = forces
            .iter()
            .map(|force| signal.voltage_v(force, &gains.gain_n_per_v));
        Recorded {
            sensor: Sensor {
                geometry: Geometry::PAPER,
                gains,
            },
            voltage_v: voltages.collect(),
            truth: run.truth,
        }
    }

    fn settings(&self, scheme: Scheme, rod_mass: f64) -> Settings {
        Settings {
            scheme,
            static_response: self.static_response,
            gravity_ground_m_s2: self.gravity_ground_m_s2,
            rod_mass,
            ..Settings::new(self.sample_rate_hz())
        }
    }

    /// Whether a monitor that takes limbs to have this mass is alarmed by sound ones, at a thousandth of the peak of noise.
    ///
    /// # Panics
    /// If the decoupler refuses.
    pub fn alarms(&self, recorded: &Recorded, rod_mass: f64) -> bool {
        let peak_v = largest(recorded.voltage_v.as_flattened().iter().copied());
        let watch = Watch::exact(1.0, [1e-3 * peak_v; LIMBS]);
        let settings = self.settings(Scheme::Heun, rod_mass);
        let rows = vec![[0.0; LIMBS]; ROWS_KEPT];
        let mut stream =
            FaultTolerant::new(&recorded.sensor, &self.parameters, &settings, &watch, rows)
                .expect("a random sensor is a sound one")
                .with_cross_talk(self.of_rods(&recorded.sensor));
        let mut events = recorded.voltage_v.iter().map(|row| {
            let watched = stream.push(row).expect("a simulated sample");
            watched.event.is_some()
        });
        events.any(|alarmed| alarmed)
    }

    fn of_rods(&self, sensor: &Sensor) -> Option<CrossTalk> {
        let none = [[0.0; LIMBS]; LIMBS];
        (self.rod_mass > 0.0).then(|| {
            CrossTalk::new(sensor, &self.parameters, &none, [0.0; 3], self.rod_mass)
                .expect("limbs lighter than the mass")
        })
    }

    /// Decouples what was recorded; what limbs with mass show of the square of the rate is taken off for limbs of this mass.
    ///
    /// # Panics
    /// If the decoupler refuses.
    pub fn decoupled(&self, recorded: Recorded, scheme: Scheme, rod_mass: f64) -> Decoupled {
        let Recorded {
            sensor,
            voltage_v,
            truth,
        } = recorded;
        let settings = self.settings(scheme, rod_mass);
        let parameters = &self.parameters;
        let of_rods = self.of_rods(&sensor);
        let mut decoupler =
            Decoupler::new(&sensor, parameters, &settings).expect("a random sensor is a sound one");
        let mut ours = Vec::with_capacity(voltage_v.len());
        for row in &voltage_v {
            let row = of_rods.map_or(*row, |of_rods| of_rods.undo(row));
            let completed = decoupler.push(&row).expect("a simulated sample");
            ours.extend(completed);
        }
        Decoupled { ours, truth }
    }

    /// Nine rows of the suite `motions`: three axes each of linear acceleration, angular acceleration and rate, over the
    /// peak of the vector.
    pub fn compare(&self, case: &str, scheme: Scheme, tolerance: Tolerance) -> Vec<Row> {
        let frequency_hz = self.motion.highest_frequency_hz();
        let [usual, halved] = [1, 2]
            .map(|refinement| self.decoupled(self.recorded(refinement), scheme, self.rod_mass));
        let quantities: [(&str, &str, [Get; 2]); 3] = [
            (
                "linear acceleration",
                "m/s^2",
                [
                    |d, i| d.ours[i].linear_ground_m_s2,
                    |d, i| d.truth_of(i).linear_ground_m_s2,
                ],
            ),
            (
                "angular acceleration",
                "rad/s^2",
                [
                    |d, i| d.ours[i].angular_ground_rad_s2,
                    |d, i| d.truth_of(i).angular_ground_rad_s2,
                ],
            ),
            (
                "rate",
                "rad/s",
                [
                    |d, i| d.ours[i].rate_shell_rad_s,
                    |d, i| d.truth_of(i).rate_shell_rad_s,
                ],
            ),
        ];
        let mut rows = Vec::new();
        for (quantity, unit, [ours, truth]) in quantities {
            let samples = halved.ours.len();
            let peak = largest((0..samples).map(|i| truth(&halved, i).length()));
            let error = |d: &Decoupled, i: usize| (ours(d, i) - truth(d, i)) / peak;
            for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
                let worst = (0..samples)
                    .max_by(|&a, &b| {
                        error(&halved, a)[axis]
                            .abs()
                            .total_cmp(&error(&halved, b)[axis].abs())
                    })
                    .unwrap_or(0);
                let change =
                    largest((0..samples).map(|i| error(&usual, i)[axis] - error(&halved, i)[axis]));
                rows.push(
                    Row::of(
                        "motions",
                        format!("{case}: {frequency_hz:.1} Hz, {name}"),
                        format!("{quantity}, random motion"),
                        error(&halved, worst)[axis].abs(),
                        tolerance,
                    )
                    .sides(
                        truth(&halved, worst)[axis],
                        ours(&halved, worst)[axis],
                        unit,
                    )
                    .beyond(change),
                );
            }
        }
        rows
    }
}

/// A motion within the rig's travel and speed or beyond, of three sines along and about each axis.
fn random_motion(rng: &mut Pcg64) -> Tumble {
    let speed: f64 = rng.random();
    let (frequency_hz, acceleration, rate) = if rng.random() {
        let frequency_hz = 1.0 + 4.0 * speed;
        let omega = TAU * frequency_hz;
        (
            frequency_hz,
            rig::run::SLIDER_AMPLITUDE_M * omega * omega,
            rig::run::ROTATION_AMPLITUDE_RAD * omega,
        )
    } else {
        let size = rng.random_range(0.1..1.0);
        (5.0 * 40.0_f64.powf(speed), 500.0 * size, 50.0 * size)
    };
    let fractions: [f64; SINES] = from_fn(|i| match i {
        0 => 1.0,
        _ => rng.random_range(0.3..1.0),
    });
    // Three sines of up to sqrt(3) each share the amplitude.
    let share = 1.0 / (SINES as f64 * 3.0_f64.sqrt());
    let mut sines = |amplitude: &dyn Fn(f64) -> f64| {
        fractions.map(|fraction| Sine {
            amplitude: in_cube(rng, 1.0) * (share * amplitude(TAU * frequency_hz * fraction)),
            frequency_hz: frequency_hz * fraction,
            phase_rad: in_cube(rng, PI),
        })
    };
    Tumble {
        position_ground_m: sines(&|omega| acceleration / (omega * omega)),
        rate_shell_rad_s: sines(&|_| rate),
        // Long enough that the start does not ring the modes.
        rise_s: (1.5 / frequency_hz).max(0.01),
    }
}

/// A vector with components up to `size`.
fn in_cube(rng: &mut Pcg64, size: f64) -> DVec3 {
    DVec3::from_array(from_fn(|_| rng.random_range(-size..size)))
}

type Get = fn(&Decoupled, usize) -> DVec3;

/// A simulated motion as its sensor's channels show it.
#[derive(Debug, Clone)]
pub struct Recorded {
    sensor: Sensor,
    voltage_v: Vec<[f64; LIMBS]>,
    truth: Vec<TrueMotion>,
}

/// What the decoupler made of a simulated motion, with the truth.
#[derive(Debug, Clone)]
pub struct Decoupled {
    /// Decoupled samples.
    pub ours: Vec<SixAxis>,
    /// True motion, sample by sample of the recording.
    pub truth: Vec<TrueMotion>,
}

impl Decoupled {
    fn truth_of(&self, i: usize) -> &TrueMotion {
        &self.truth[self.ours[i].sample as usize]
    }

    /// Largest error of linear and angular acceleration and of the rate, over the peak of each.
    pub fn largest_errors(&self) -> [f64; 3] {
        let pairs = |i: usize| {
            let (ours, truth) = (&self.ours[i], self.truth_of(i));
            [
                [ours.linear_ground_m_s2, truth.linear_ground_m_s2],
                [ours.angular_ground_rad_s2, truth.angular_ground_rad_s2],
                [ours.rate_shell_rad_s, truth.rate_shell_rad_s],
            ]
        };
        from_fn(|quantity| {
            let all = (0..self.ours.len()).map(|i| pairs(i)[quantity]);
            let peak = largest(all.clone().map(|[_, truth]| truth.length()));
            largest(all.map(|[ours, truth]| (ours - truth).length() / peak))
        })
    }
}

/// The rows of `count` cases in order, computed in parallel; `done` is called after each.
pub fn compare_all(
    seed: u64,
    count: u64,
    scheme: Scheme,
    tolerance: Tolerance,
    done: impl Fn() + Sync,
) -> Vec<Row> {
    let suite_rows: Vec<Vec<Row>> = (0..count)
        .into_par_iter()
        .map(|index| {
            let case = format!("motion {index} of seed {seed}");
            let rows = Case::numbered(seed, index).compare(&case, scheme, tolerance);
            done();
            rows
        })
        .collect();
    suite_rows.into_iter().flatten().collect()
}
