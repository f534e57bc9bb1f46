//! How equally stiff limbs share a load: P = J (J^T J)^-1 with rows \[e_i^T, (t_i x e_i)^T\] of J.
//!
//! Of nine forces statics leave three open; equal stiffness closes them, and a wrench per mass W asks for the forces P W. The mass
//! gives way by -(1/(k/m)) (J^T J)^-1 W, which moves it against the shell and, at first order, adds
//! -(1/(k/m)) P M (J^T J)^-1 W'' to the forces, M = diag(1, I/m).

use glam::DVec3;
use nalgebra::{Matrix6, SMatrix, Vector6};

use crate::error::{Error, Result};
use crate::geometry::{DIRECTIONS_SHELL, Geometry, LIMBS};
use crate::parameters::InertiaPerMass;

/// Shares of the nine limbs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shares {
    matrix: SMatrix<f64, LIMBS, 6>,
    /// (J^T J)^-1.
    flexibility: Matrix6<f64>,
}

impl Shares {
    /// For a drawing.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for lengths that mean nothing.
    pub fn new(geometry: &Geometry) -> Result<Self> {
        geometry.validate()?;
        let hinges = geometry.mass_hinges_m();
        let jacobian = SMatrix::<f64, LIMBS, 6>::from_fn(|limb, column| {
            let e = DIRECTIONS_SHELL[limb];
            let m = hinges[limb].cross(e);
            [e.x, e.y, e.z, m.x, m.y, m.z][column]
        });
        let flexibility =
            (jacobian.transpose() * jacobian)
                .try_inverse()
                .ok_or(Error::OutOfRange {
                    name: "half_edge_m",
                    value: geometry.half_edge_m,
                    requirement: "of a size at which nine limbs hold the mass",
                })?;
        Ok(Self {
            matrix: jacobian * flexibility,
            flexibility,
        })
    }

    /// Force per mass of each limb over the acceleration.
    #[must_use]
    pub fn of_acceleration(&self, limb: usize) -> DVec3 {
        self.row(limb, 0)
    }

    /// Force per mass of each limb over the torque per mass, 1/m.
    #[must_use]
    pub fn of_torque_per_m(&self, limb: usize) -> DVec3 {
        self.row(limb, 3)
    }

    fn row(&self, limb: usize, from: usize) -> DVec3 {
        DVec3::new(
            self.matrix[(limb, from)],
            self.matrix[(limb, from + 1)],
            self.matrix[(limb, from + 2)],
        )
    }

    /// Force per mass of each limb over the compliance and the second derivative, negative, of a linear acceleration along
    /// `direction`.
    #[must_use]
    pub fn of_compliance(&self, inertia: &InertiaPerMass, direction: DVec3) -> [f64; LIMBS] {
        let d = direction;
        let moved = self.flexibility * Vector6::new(d.x, d.y, d.z, 0.0, 0.0, 0.0);
        let turned = inertia.matrix_mass_m2() * DVec3::new(moved[3], moved[4], moved[5]);
        let wrench = Vector6::new(moved[0], moved[1], moved[2], turned.x, turned.y, turned.z);
        (self.matrix * wrench).into()
    }
}
