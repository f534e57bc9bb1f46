//! What the peers know beside the voltages.

use std::error::Error;

use glam::DMat3;
use serde::{Deserialize, Serialize};
use sixaxis_core::geometry::DIRECTIONS_SHELL;
use sixaxis_core::paper::preload::static_preload_m_s2;
use sixaxis_core::{Geometry, LIMBS};
use sixaxis_props::problem::recorded::true_parameters;
use sixaxis_props::truth::InCore;
use sixaxis_reference::laboratory::recording::SimulatedRecording;
use sixaxis_reference::mujoco::model::{SHELL_INERTIA_KG_M2, SHELL_MASS_KG};

/// The order of the fields is that of the numbers in `problem.bin`.
#[derive(Serialize, Deserialize)]
pub struct Problem {
    pub samples: usize,
    pub sample_rate_hz: f64,
    pub limb_length_m: f64,
    pub half_edge_m: f64,
    pub direction_shell: [[f64; 3]; LIMBS],
    pub mass_hinge_m: [[f64; 3]; LIMBS],
    pub shell_hinge_m: [[f64; 3]; LIMBS],
    pub gain_n_per_v: [f64; LIMBS],
    pub zero_drift_v: [f64; LIMBS],
    pub scale_per_mass_per_kg: [f64; LIMBS],
    pub inertia_per_mass_m2: [[f64; 3]; 3],
    pub stiffness_per_mass_per_s2: f64,
    pub preload_per_mass_m_s2: [f64; LIMBS],
    pub gravity_ground_m_s2: [f64; 3],
    /// R at the first decoupled sample, by rows.
    pub initial_attitude: [[f64; 3]; 3],
    /// For engines, which think in kilograms.
    pub mass_kg: f64,
    pub shell_mass_kg: f64,
    pub shell_inertia_kg_m2: f64,
}

impl Problem {
    pub fn of(recording: &SimulatedRecording) -> Result<Self, Box<dyn Error>> {
        let (geometry, parameters) = (Geometry::PAPER, true_parameters());
        let gravity = recording.gravity_ground_m_s2;
        let stiffness = parameters.stiffness_per_mass_per_s2;
        Ok(Self {
            samples: recording.voltage_v.len(),
            sample_rate_hz: recording.sample_rate_hz,
            limb_length_m: geometry.limb_length_m,
            half_edge_m: geometry.half_edge_m,
            direction_shell: DIRECTIONS_SHELL.map(Into::into),
            mass_hinge_m: geometry.mass_hinges_m().map(Into::into),
            shell_hinge_m: geometry.shell_hinges_m().map(Into::into),
            gain_n_per_v: recording.gains().gain_n_per_v,
            zero_drift_v: parameters.zero_drift_v,
            scale_per_mass_per_kg: parameters.scale_per_mass_per_kg,
            inertia_per_mass_m2: parameters
                .inertia_per_mass
                .matrix_mass_m2()
                .to_cols_array_2d(),
            stiffness_per_mass_per_s2: stiffness,
            preload_per_mass_m_s2: static_preload_m_s2(&geometry, stiffness, gravity)?,
            gravity_ground_m_s2: gravity.into(),
            initial_attitude: DMat3::IDENTITY.to_cols_array_2d(),
            mass_kg: sixaxis_reference::sensor::MASS_KG,
            shell_mass_kg: SHELL_MASS_KG,
            shell_inertia_kg_m2: SHELL_INERTIA_KG_M2,
        })
    }

    pub fn inertia(&self) -> DMat3 {
        DMat3::from_cols_array_2d(&self.inertia_per_mass_m2)
    }

    /// The same numbers one after the other, for peers that read no JSON.
    pub fn flat(&self) -> Vec<f64> {
        [
            &[
                self.samples as f64,
                self.sample_rate_hz,
                self.limb_length_m,
                self.half_edge_m,
            ],
            self.direction_shell.as_flattened(),
            self.mass_hinge_m.as_flattened(),
            self.shell_hinge_m.as_flattened(),
            &self.gain_n_per_v,
            &self.zero_drift_v,
            &self.scale_per_mass_per_kg,
            self.inertia_per_mass_m2.as_flattened(),
            &[self.stiffness_per_mass_per_s2],
            &self.preload_per_mass_m_s2,
            &self.gravity_ground_m_s2,
            self.initial_attitude.as_flattened(),
            &[self.mass_kg, self.shell_mass_kg, self.shell_inertia_kg_m2],
        ]
        .concat()
    }
}
