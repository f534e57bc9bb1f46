//! The six modes by linear theory, to hold MuJoCo's ring-downs against.

use nalgebra::{Matrix6, SymmetricEigen, Vector6};
use sixaxis_core::{Geometry, InertiaPerMass};

use crate::mjcf::limb_jacobian;

/// One natural mode of the mass in the held shell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mode {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Shape: displacement (unit arbitrary, m) and rotation (rad) of the mass, shell axes.
    pub shape: Vector6<f64>,
}

/// Modes of M x'' + K x = 0 with M = diag(1, I/m), K = (k/m) J^T J, ascending in frequency.
#[must_use]
pub fn modes(
    geometry: &Geometry,
    inertia_per_mass: &InertiaPerMass,
    stiffness_per_mass_per_s2: f64,
) -> [Mode; 6] {
    let jacobian = limb_jacobian(geometry);
    let stiffness: Matrix6<f64> = jacobian.transpose() * jacobian * stiffness_per_mass_per_s2;
    let mut mass = Matrix6::<f64>::identity();
    let tensor = inertia_per_mass.matrix_mass_m2();
    for row in 0..3 {
        for column in 0..3 {
            mass[(3 + row, 3 + column)] = tensor.col(column)[row];
        }
    }
    // M = C C^T turns the problem into an ordinary symmetric one: C^-1 K C^-T y = w^2 y, x = C^-T y.
    let lower = mass
        .cholesky()
        .map_or_else(Matrix6::identity, |cholesky| cholesky.l());
    let inverse = lower.try_inverse().unwrap_or_else(Matrix6::identity);
    let eigen = SymmetricEigen::new(inverse * stiffness * inverse.transpose());
    let mut order: [usize; 6] = core::array::from_fn(|i| i);
    order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
    order.map(|i| Mode {
        frequency_hz: eigen.eigenvalues[i].max(0.0).sqrt() / core::f64::consts::TAU,
        shape: inverse.transpose() * eigen.eigenvectors.column(i),
    })
}

/// The six frequencies alone, ascending, Hz.
#[must_use]
pub fn mode_frequencies_hz(
    geometry: &Geometry,
    inertia_per_mass: &InertiaPerMass,
    stiffness_per_mass_per_s2: f64,
) -> [f64; 6] {
    modes(geometry, inertia_per_mass, stiffness_per_mass_per_s2).map(|mode| mode.frequency_hz)
}
