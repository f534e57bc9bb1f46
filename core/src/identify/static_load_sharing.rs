//! How limbs share a load: P = K J (J^T K J)^-1 with rows \[e_i^T, (t_i x e_i)^T\] of J and K = diag(k_i/k).
//!
//! Of nine forces statics leave three open; the ratios of the stiffnesses close them, and a wrench per mass W asks for the forces
//! P W. The mass gives way by -(1/(k/m)) G W, G = (J^T K J)^-1, which moves it against the shell and, at first order, adds
//! -(1/(k/m)) P M G W'' to the forces, M = diag(1, I/m). A limb j that is stiffer by a share changes the forces by that share of
//! (e_j - P J_j^T) (J_j G W): it takes over what the others lose, and no wrench comes of it.

use glam::{DMat3, DVec3};
use nalgebra::{Matrix6, SMatrix};

use crate::columns::{halves, stacked};
use crate::error::{Error, Result};
use crate::geometry::{DIRECTIONS_SHELL, Geometry, LIMBS};

/// How the nine limbs share a load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StaticLoadSharing {
    /// J.
    jacobian: SMatrix<f64, LIMBS, 6>,
    /// P.
    matrix: SMatrix<f64, LIMBS, 6>,
    /// G.
    flexibility: Matrix6<f64>,
    /// The limbs' middles from the cube's centre, m.
    middles_m: [DVec3; LIMBS],
}

impl StaticLoadSharing {
    /// For a drawing.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for lengths that mean nothing.
    pub fn new(geometry: &Geometry) -> Result<Self> {
        geometry.validate()?;
        let middles_m = geometry.limb_middles_m();
        Self::of(geometry.limb_jacobian(), middles_m, &[1.0; LIMBS]).ok_or(Error::out_of_range(
            "half_edge_m",
            geometry.half_edge_m,
            "of a size at which nine limbs hold the mass",
        ))
    }

    /// The same limbs with stiffnesses k_i/k; none if these do not hold the mass.
    #[must_use]
    pub fn with_stiffness(&self, ratio: &[f64; LIMBS]) -> Option<Self> {
        Self::of(self.jacobian, self.middles_m, ratio)
    }

    fn of(
        jacobian: SMatrix<f64, LIMBS, 6>,
        middles_m: [DVec3; LIMBS],
        ratio: &[f64; LIMBS],
    ) -> Option<Self> {
        let weighted = SMatrix::<f64, LIMBS, 6>::from_fn(|i, j| ratio[i] * jacobian[(i, j)]);
        let flexibility = (jacobian.transpose() * weighted).try_inverse()?;
        Some(Self {
            jacobian,
            matrix: weighted * flexibility,
            flexibility,
            middles_m,
        })
    }

    /// Force per mass of each limb over the acceleration.
    #[must_use]
    pub fn of_acceleration(&self, limb: usize) -> DVec3 {
        self.row(limb)[0]
    }

    /// Force per mass of each limb over the torque per mass, 1/m.
    #[must_use]
    pub fn of_torque_per_m(&self, limb: usize) -> DVec3 {
        self.row(limb)[1]
    }

    fn row(&self, limb: usize) -> [DVec3; 2] {
        halves(&self.matrix.row(limb).transpose())
    }

    /// Displacement and rotation, negative, under a force and a torque per mass at unit stiffness over mass: G W.
    #[must_use]
    pub fn given_way(&self, force: DVec3, torque: DVec3) -> [DVec3; 2] {
        halves(&(self.flexibility * stacked(force, torque)))
    }

    /// Derivative of [`Self::given_way`] by a limb's k_i/k.
    #[must_use]
    pub fn given_way_by_stiffness(&self, limb: usize, force: DVec3, torque: DVec3) -> [DVec3; 2] {
        let row = self.jacobian.row(limb);
        let shortened = (row * self.flexibility * stacked(force, torque))[0];
        halves(&(self.flexibility * row.transpose() * -shortened))
    }

    /// Derivative of [`Self::of_wrench`] by a limb's k_i/k.
    #[must_use]
    pub fn of_wrench_by_stiffness(&self, limb: usize, force: DVec3, torque: DVec3) -> [f64; LIMBS] {
        let row = self.jacobian.row(limb);
        let shortened = (row * self.flexibility * stacked(force, torque))[0];
        let mut forces = -(self.matrix * row.transpose()) * shortened;
        forces[limb] += shortened;
        forces.into()
    }

    /// Force per mass of each limb, m/s^2, under a force per mass, m/s^2, and a torque per mass, m^2/s^2, on the mass.
    #[must_use]
    pub fn of_wrench(&self, force: DVec3, torque: DVec3) -> [f64; LIMBS] {
        (self.matrix * stacked(force, torque)).into()
    }

    /// What the specific force in each limb's middle has along the limb, m/s^2: `force` at the cube's centre, m/s^2, and from there on
    /// `gradient` more a metre, 1/s^2.
    #[must_use]
    pub fn along_limbs(&self, force: DVec3, gradient: DMat3) -> [f64; LIMBS] {
        core::array::from_fn(|limb| {
            let there = force + gradient * self.middles_m[limb];
            DIRECTIONS_SHELL[limb].dot(there)
        })
    }
}
