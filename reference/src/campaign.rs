//! The paper's calibration campaign: which runs, on which wedges, and what the laboratory records of them.

use glam::DVec3;
use rand_pcg::Pcg64;
use serde::Serialize;
use sixaxis_core::{Gains, Geometry, LIMBS, Parameters};

use crate::chain::{Chain, amplifier_ranges};
use crate::instruments::Instruments;
use crate::mjcf::SensorModel;
use crate::paper;
use crate::recording::{Recording, SimulatedRun};
use crate::rig::{Mode, Mounting, Run};

/// Seismic mass that the design s/m implies at s = 1, kg.
pub const MASS_KG: f64 = 1.0 / paper::DESIGN_SCALE_PER_MASS_PER_KG;

/// Limb damping of the reference: 2 % of critical keeps rounding noise out of the modes and changes a limb's length at
/// 5 Hz by 1e-4 of its micrometre, 1e-9 of an acceleration.
pub const DAMPING_RATIO: f64 = 0.02;

/// Length of the static record, s, and its rate after preprocessing, Hz: the paper's ten minutes.
pub const STATIC_DURATION_S: f64 = 600.0;
/// See [`STATIC_DURATION_S`].
pub const STATIC_RATE_HZ: f64 = 100.0;

/// The wedges: six directions that turn up in the paper's tables or are the sensor's own axes.
pub const WEDGES: [DVec3; 6] = [
    DVec3::X,
    DVec3::Y,
    DVec3::Z,
    DVec3::new(1.0, 1.0, 2.0),
    DVec3::new(1.0, 2.0, 1.0),
    DVec3::new(2.0, 1.0, 1.0),
];

/// What a run is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// Step 2: pure linear, 1-2 Hz.
    Linear,
    /// Step 3: pure angular, 1-2 Hz.
    Angular,
    /// Step 4: pure linear, 4-5 Hz.
    FastLinear,
    /// Tables 4 to 6: compound, 1, 3 and 5 Hz.
    Compound,
}

/// One planned run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Trial {
    /// What for.
    pub role: Role,
    /// What the rig does.
    pub run: Run,
    /// How the sensor hangs.
    pub mounting: Mounting,
}

/// The paper's campaign: `per_step` frequencies for each of steps 2 to 4, evenly over the band, wedges in turn, then
/// the three compound runs.
#[must_use]
pub fn plan(per_step: usize, mounting: Mounting) -> Vec<Trial> {
    let mut trials = Vec::new();
    for (role, mode, (low, high)) in [
        (Role::Linear, Mode::Linear, (1.0, 2.0)),
        (Role::Angular, Mode::Angular, (1.0, 2.0)),
        (Role::FastLinear, Mode::Linear, (4.0, 5.0)),
    ] {
        for i in 0..per_step {
            let share = i as f64 / (per_step.max(2) - 1) as f64;
            trials.push(Trial {
                role,
                run: Run::new(mode, low + (high - low) * share, WEDGES[i % WEDGES.len()]),
                mounting,
            });
        }
    }
    trials.extend(compound(mounting));
    trials
}

/// The three runs of Tables 4 to 6.
#[must_use]
pub fn compound(mounting: Mounting) -> [Trial; 3] {
    paper::COMPOUND_TABLES.map(|table| Trial {
        role: Role::Compound,
        run: Run::new(Mode::Compound, table.frequency_hz, table.direction),
        mounting,
    })
}

impl Trial {
    /// The simulated sensor, hung as this trial hangs it.
    #[must_use]
    pub fn model(&self, parameters: &Parameters) -> SensorModel {
        SensorModel {
            geometry: Geometry::PAPER,
            mass_kg: MASS_KG,
            inertia_per_mass: parameters.inertia_per_mass,
            stiffness_per_mass_per_s2: parameters.stiffness_per_mass_per_s2,
            damping_ratio: DAMPING_RATIO,
            gravity_ground_m_s2: self.mounting.gravity_ground_m_s2(self.run.direction_ground),
        }
    }
}

/// The laboratory that records a campaign: its measuring chain, its instruments and the true sensor.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Laboratory {
    /// The sensor's true parameters.
    pub parameters: Parameters,
    /// Measuring chain of the nine channels.
    pub chain: Chain,
    /// Standard instruments.
    pub instruments: Instruments,
    /// Seed of every random number in the campaign.
    pub seed: u64,
}

/// Random stream of the instruments' own errors; runs use their index plus [`FIRST_RUN_STREAM`].
const INSTRUMENT_STREAM: u128 = 1;
const STATIC_STREAM: u128 = 2;
const FIRST_RUN_STREAM: u128 = 16;

impl Laboratory {
    /// A laboratory without errors.
    #[must_use]
    pub const fn noise_free(parameters: Parameters) -> Self {
        Self {
            parameters,
            chain: Chain::noise_free(),
            instruments: Instruments::perfect(),
            seed: 0,
        }
    }

    /// A laboratory with the paper's errors: 60 dB channels, instruments of the 1 % class, 10 Hz gyroscope.
    #[must_use]
    pub fn with_errors(parameters: Parameters, seed: u64) -> Self {
        Self {
            parameters,
            chain: Chain::laboratory(),
            instruments: Instruments::of_class(&mut Pcg64::new(
                u128::from(seed),
                INSTRUMENT_STREAM,
            )),
            seed,
        }
    }

    /// Ten minutes at rest. The simulated sensor at rest does not move, so its one state is recorded over and over;
    /// only the chain's noise differs from sample to sample.
    #[must_use]
    pub fn record_static(&self, rest_force_per_mass_m_s2: [f64; LIMBS]) -> Recording {
        let samples = (STATIC_DURATION_S * STATIC_RATE_HZ) as usize;
        let forces = vec![rest_force_per_mass_m_s2; samples];
        let gains = Gains::uniform(1.0);
        let mut rng = Pcg64::new(u128::from(self.seed), STATIC_STREAM);
        Recording {
            sample_rate_hz: STATIC_RATE_HZ,
            gains,
            full_scale_v: self.chain.full_scale_v,
            voltage_v: self.chain.record(
                &forces,
                &self.parameters,
                &gains,
                STATIC_RATE_HZ,
                &mut rng,
            ),
            accelerometer_m_s2: vec![0.0; samples],
            gyroscope_rad_s: vec![0.0; samples],
            direction_ground: DVec3::Z,
            gravity_ground_m_s2: DVec3::ZERO,
            frequency_hz: 0.0,
        }
    }

    /// Records one simulated run. `index` numbers the run within the campaign: it picks the random stream, so that a
    /// run's noise does not depend on which runs were recorded before it.
    #[must_use]
    pub fn record(&self, simulated: &SimulatedRun, index: usize) -> Recording {
        let mut rng = Pcg64::new(u128::from(self.seed), FIRST_RUN_STREAM + index as u128);
        let direction = simulated.run.direction_ground;
        let along = |get: fn(&crate::recording::TrueMotion) -> DVec3| -> Vec<f64> {
            simulated
                .truth
                .iter()
                .map(|truth| get(truth).dot(direction))
                .collect()
        };
        let gains = amplifier_ranges(
            &simulated.limb_force_per_mass_m_s2,
            &self.parameters,
            self.chain.full_scale_v,
        );
        let rate = simulated.sample_rate_hz;
        Recording {
            sample_rate_hz: rate,
            gains,
            full_scale_v: self.chain.full_scale_v,
            voltage_v: self.chain.record(
                &simulated.limb_force_per_mass_m_s2,
                &self.parameters,
                &gains,
                rate,
                &mut rng,
            ),
            accelerometer_m_s2: self
                .instruments
                .read_accelerometer(&along(|t| t.linear_ground_m_s2), &mut rng),
            gyroscope_rad_s: self.instruments.read_gyroscope(
                &along(|t| t.rate_shell_rad_s),
                rate,
                &mut rng,
            ),
            direction_ground: direction,
            gravity_ground_m_s2: simulated.gravity_ground_m_s2,
            frequency_hz: simulated.run.frequency_hz,
        }
    }
}
