//! How equally stiff limbs share a load: P = J (J^T J)^-1 with rows \[e_i^T, (t_i x e_i)^T\] of J.
//!
//! Of nine forces statics leave three open; equal stiffness closes them, and a wrench per mass W asks for the forces P W. The mass
//! gives way by -(1/(k/m)) (J^T J)^-1 W, which moves it against the shell and, at first order, adds
//! -(1/(k/m)) P M (J^T J)^-1 W'' to the forces, M = diag(1, I/m).

use glam::{DMat3, DVec3};
use nalgebra::{Matrix6, SMatrix, Vector6};

use crate::error::{Error, Result};
use crate::geometry::{Geometry, LIMBS};

/// How the nine limbs share a load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StaticLoadSharing {
    matrix: SMatrix<f64, LIMBS, 6>,
    /// (J^T J)^-1.
    flexibility: Matrix6<f64>,
}

impl StaticLoadSharing {
    /// For a drawing.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for lengths that mean nothing.
    pub fn new(geometry: &Geometry) -> Result<Self> {
        geometry.validate()?;
        let jacobian = geometry.limb_jacobian();
        let flexibility =
            (jacobian.transpose() * jacobian)
                .try_inverse()
                .ok_or(Error::out_of_range(
                    "half_edge_m",
                    geometry.half_edge_m,
                    "of a size at which nine limbs hold the mass",
                ))?;
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
    /// `direction`: a linear function of the inertia tensor, m^2, and of the direction.
    #[must_use]
    pub fn of_compliance(&self, tensor: DMat3, direction: DVec3) -> [f64; LIMBS] {
        let [moved, turned] = self.given_way(direction);
        self.of_wrench(moved, tensor * turned)
    }

    /// Derivative of [`Self::of_compliance`] by the tensor along `change`.
    #[must_use]
    pub fn of_compliance_by_inertia(&self, change: DMat3, direction: DVec3) -> [f64; LIMBS] {
        let [_, turned] = self.given_way(direction);
        self.of_wrench(DVec3::ZERO, change * turned)
    }

    /// Displacement and rotation under a unit acceleration at unit stiffness over mass.
    fn given_way(&self, direction: DVec3) -> [DVec3; 2] {
        let d = direction;
        let moved = self.flexibility * Vector6::new(d.x, d.y, d.z, 0.0, 0.0, 0.0);
        [0, 3].map(|from| DVec3::new(moved[from], moved[from + 1], moved[from + 2]))
    }

    /// Force per mass of each limb, m/s^2, under a force per mass, m/s^2, and a torque per mass, m^2/s^2, on the mass.
    #[must_use]
    pub fn of_wrench(&self, force: DVec3, torque: DVec3) -> [f64; LIMBS] {
        let wrench = Vector6::new(force.x, force.y, force.z, torque.x, torque.y, torque.z);
        (self.matrix * wrench).into()
    }
}
