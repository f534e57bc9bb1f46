//! To first order in the limbs' compliance: what step 2 neglects, and what that does to step 4.
//!
//! Let y = m/k. With rigid limbs (y = 0) pure linear motion loads them with phi = J G (a - g; 0), G = (J^T J)^-1, whatever
//! y is; to first order the mass is then at x = y x1, x1 = -G (a - g; 0). Gravity g counts: the sag tilts limbs, and tilted
//! limbs turn the load that is already in them.
//!
//! # Step 2
//! takes sum phi_i e_i = a with the limbs' directions at rest. The full equation, less itself at rest, leaves per y
//!
//! ```text
//! N = G_rr a'' + [sum phi_i de_i(x1)] - [the same at rest],
//! ```
//!
//! so the scale factors come out wrong by shares y eps_i with sum eps_i phi~_i e_i = N in the least-squares sense, phi~ = J G
//! (a; 0) the tared forces. At one frequency without gravity N = -w^2 G_rr a and the nine eps_i solve it exactly: an error
//! that no residual shows.
//!
//! # Step 4
//! decodes with a candidate y + dy. To first order its torque is off by
//!
//! ```text
//! dy D + y sum eps_i phi~_i t_i x e_i,   D = (I/m) G_phir a'' + [sum phi_i d(t_i x e_i)(x1)] - [the same at rest],
//! ```
//!
//! and w* = (I/m)^-1 times its integral. The search balances one against the other: it finds not y but y (1 + rho), and rho
//! does not depend on y. Repeating steps 2 to 4 with a compliance y' leaves rho (y - y') of rho y: the error shrinks by |rho|
//! a pass.

use glam::DVec3;
use nalgebra::{Matrix6, SMatrix};

use crate::columns::{halves, stacked};
use crate::error::{Error, Result};
use crate::geometry::{DIRECTIONS_SHELL, Geometry, LIMBS, LIMBS_PER_NODE};
use crate::model::InertiaPerMass;

/// Rows (e_i, t_i x e_i / n): the wrench of a unit force in each limb, torques over the half edge.
pub(super) fn limb_jacobian() -> SMatrix<f64, LIMBS, 6> {
    // Limbs' lengths do not matter to it.
    let unit = Geometry {
        limb_length_m: 1.0,
        half_edge_m: 1.0,
    };
    unit.limb_jacobian()
}

/// One instant of pure linear motion, in axes that shell and ground share.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearMotion {
    /// a, m/s^2.
    pub acceleration_m_s2: DVec3,
    /// Second time derivative of a, m/s^4.
    pub acceleration_second_derivative_m_s4: DVec3,
    /// g, m/s^2.
    pub gravity_m_s2: DVec3,
}

/// First-order effects of the limbs' compliance in pure linear motion.
#[derive(Debug, Clone, PartialEq)]
pub struct ComplianceEffect {
    geometry: Geometry,
    inertia_per_mass: InertiaPerMass,
    jacobian: SMatrix<f64, LIMBS, 6>,
    /// G, torques over the half edge.
    inverse: Matrix6<f64>,
}

/// Displacement and rotation of the mass.
#[derive(Clone, Copy)]
struct Moved {
    r: DVec3,
    phi: DVec3,
}

impl ComplianceEffect {
    /// From the drawing and I/m.
    ///
    /// # Errors
    /// Those of [`Geometry::validate`] and [`InertiaPerMass::validate`].
    pub fn new(geometry: &Geometry, inertia_per_mass: &InertiaPerMass) -> Result<Self> {
        geometry.validate()?;
        inertia_per_mass.validate()?;
        let jacobian = limb_jacobian();
        let inverse =
            (jacobian.transpose() * jacobian)
                .try_inverse()
                .ok_or(Error::NotConverged {
                    what: "inverse of J^T J",
                    iterations: 0,
                })?;
        Ok(Self {
            geometry: *geometry,
            inertia_per_mass: *inertia_per_mass,
            jacobian,
            inverse,
        })
    }

    /// Forces over mass of rigid limbs under an acceleration without rotation, J G (a; 0), m/s^2.
    #[must_use]
    pub fn rigid_forces_m_s2(&self, acceleration_m_s2: DVec3) -> [f64; LIMBS] {
        (self.jacobian * self.inverse * stacked(acceleration_m_s2, DVec3::ZERO)).into()
    }

    /// N: what (12) neglects, per y, m/s^4. Step 2's rows with it as reference instead of a give the eps_i, 1/s^2.
    #[must_use]
    pub fn neglected_force_m_s4(&self, motion: &LinearMotion) -> DVec3 {
        let inertial = -self.place(motion.acceleration_second_derivative_m_s4).r;
        let of = |a: DVec3| self.tilted(a, |_, _, _, tilt| tilt);
        inertial + of(motion.acceleration_m_s2 - motion.gravity_m_s2) - of(-motion.gravity_m_s2)
    }

    /// D: by how much the torque balance of step 4 changes per unit of y, m^2/s^4.
    #[must_use]
    pub fn torque_m2_s4(&self, motion: &LinearMotion) -> DVec3 {
        let inertial = -(self.inertia_per_mass.matrix_mass_m2()
            * self.place(motion.acceleration_second_derivative_m_s4).phi);
        let of =
            |a: DVec3| self.tilted(a, |arm, turned, e, tilt| turned.cross(e) + arm.cross(tilt));
        inertial + of(motion.acceleration_m_s2 - motion.gravity_m_s2) - of(-motion.gravity_m_s2)
    }

    /// sum eps_i phi~_i t_i x e_i for shares eps of the scale factors: per y if eps is, m^2/s^2 times the unit of eps.
    #[must_use]
    pub fn torque_of_scale_error(&self, eps: &[f64; LIMBS], acceleration_m_s2: DVec3) -> DVec3 {
        let phi = self.rigid_forces_m_s2(acceleration_m_s2);
        (0..LIMBS).fold(DVec3::ZERO, |sum, limb| {
            let arm = self.geometry.node_mass_m(limb / LIMBS_PER_NODE);
            sum + arm.cross(DIRECTIONS_SHELL[limb]) * (eps[limb] * phi[limb])
        })
    }

    /// -G (load; 0): where the mass goes per y.
    fn place(&self, load_m_s2: DVec3) -> Moved {
        let [r, turned] = halves(&-(self.inverse * stacked(load_m_s2, DVec3::ZERO)));
        Moved {
            r,
            phi: turned / self.geometry.half_edge_m,
        }
    }

    /// sum phi_i term(t_i, dt_i, e_i, de_i) under a load, the mass where the load puts it.
    fn tilted(
        &self,
        load_m_s2: DVec3,
        term: impl Fn(DVec3, DVec3, DVec3, DVec3) -> DVec3,
    ) -> DVec3 {
        let Moved { r, phi } = self.place(load_m_s2);
        let forces = self.rigid_forces_m_s2(load_m_s2);
        (0..LIMBS).fold(DVec3::ZERO, |sum, limb| {
            let (arm, e) = (
                self.geometry.node_mass_m(limb / LIMBS_PER_NODE),
                DIRECTIONS_SHELL[limb],
            );
            let turned = phi.cross(arm);
            let hinge = r + turned;
            // A limb follows its hinge sideways only.
            let tilt = (hinge - e * e.dot(hinge)) / self.geometry.limb_length_m;
            sum + term(arm, turned, e, tilt) * forces[limb]
        })
    }
}
