//! Linear theory of the mass on nine limbs in a held or slowly driven shell, to hold MuJoCo against.

use core::f64::consts::TAU;

use nalgebra::{Matrix6, SymmetricEigen, Vector6};

use crate::geometry::Geometry;
use crate::limbs::Limbs;
use crate::rig::run::{Mode as RigMode, Run};
use crate::sensor::{InertiaPerMass, TrueSensor};

/// K/m of the mass's six degrees of freedom, shell axes: s^-2, m/s^2 and m^2/s^2. For ideal limbs (k/m) J^T J with J their wrenches.
pub(crate) fn stiffness_per_mass(
    geometry: &Geometry,
    stiffness_per_mass_per_s2: f64,
    limbs: &Limbs,
) -> Matrix6<f64> {
    limbs.stiffness(geometry) * stiffness_per_mass_per_s2
}

/// One natural mode of the mass in the held shell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct NaturalMode {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Shape: displacement (unit arbitrary, m) and rotation (rad) of the mass, shell axes.
    pub shape: Vector6<f64>,
}

/// The six modes of M x'' + K x = 0 with M = diag(1, I/m) and what the limbs add to it, ascending in frequency.
pub(crate) fn modes(
    geometry: &Geometry,
    inertia_per_mass: &InertiaPerMass,
    stiffness_per_mass_per_s2: f64,
    limbs: &Limbs,
) -> [NaturalMode; 6] {
    let stiffness = stiffness_per_mass(geometry, stiffness_per_mass_per_s2, limbs);
    let mut mass = Matrix6::<f64>::identity();
    let tensor = inertia_per_mass.tensor_m2();
    for row in 0..3 {
        for column in 0..3 {
            mass[(3 + row, 3 + column)] = tensor.col(column)[row];
        }
    }
    if limbs.mass > 0.0 {
        mass += limbs.mass_matrix(geometry);
    }
    // M = C C^T turns the problem into an ordinary symmetric one: C^-1 K C^-T y = w^2 y, x = C^-T y.
    let lower = mass
        .cholesky()
        .map_or_else(Matrix6::identity, |cholesky| cholesky.l());
    let inverse = lower.try_inverse().unwrap_or_else(Matrix6::identity);
    let eigen = SymmetricEigen::new(inverse * stiffness * inverse.transpose());
    let mut order: [usize; 6] = core::array::from_fn(|i| i);
    order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
    order.map(|i| NaturalMode {
        frequency_hz: eigen.eigenvalues[i].max(0.0).sqrt() / TAU,
        shape: inverse.transpose() * eigen.eigenvectors.column(i),
    })
}

/// The six frequencies of [`modes`] alone, ascending, Hz.
pub fn mode_frequencies_hz(sensor: &TrueSensor) -> [f64; 6] {
    let TrueSensor {
        geometry,
        inertia_per_mass,
        stiffness_per_mass_per_s2,
        ..
    } = sensor;
    let k = *stiffness_per_mass_per_s2;
    modes(geometry, inertia_per_mass, k, &Limbs::IDEAL).map(|mode| mode.frequency_hz)
}

/// Amplitude of the mass's acceleration in the shell during a run at full speed, w^2 |K^-1 M a|: m/s^2 or, for pure angular
/// motion, rad/s^2. NaN for limbs that do not hold the mass.
pub fn relative_acceleration(sensor: &TrueSensor, run: &Run) -> f64 {
    let omega2 = (TAU * run.frequency_hz).powi(2);
    let d = run.direction_ground;
    let angular = run.mode == RigMode::Angular;
    let load = if angular {
        let torque =
            sensor.inertia_per_mass.tensor_m2() * d * (run.rotation_amplitude_rad * omega2);
        Vector6::new(0.0, 0.0, 0.0, torque.x, torque.y, torque.z)
    } else {
        let force = d * (run.slider_amplitude_m * omega2);
        Vector6::new(force.x, force.y, force.z, 0.0, 0.0, 0.0)
    };
    let k = sensor.stiffness_per_mass_per_s2;
    let stiffness = stiffness_per_mass(&sensor.geometry, k, &Limbs::IDEAL);
    let Some(cholesky) = stiffness.cholesky() else {
        return f64::NAN;
    };
    let moved = cholesky.solve(&load);
    let part = if angular { 3 } else { 0 };
    moved.fixed_rows::<3>(part).norm() * omega2
}
