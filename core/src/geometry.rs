//! Where the nine limbs are: eqs. (5) and (6) of the paper.
//!
//! Everything here is fixed by the drawing and never identified. Frame {1} is the shell, frame {2} the
//! seismic mass; with unloaded limbs both origins sit in the mass's centre and their axes coincide.

use glam::DVec3;
use nalgebra::SMatrix;
use serde::{Deserialize, Serialize};

use crate::error::{Result, require};

pub use crate::limb_set::LIMBS;

/// Number of corner points of the mass at which limbs end.
pub const NODES: usize = 3;

/// Limbs that end at one node; their directions are mutually orthogonal.
pub const LIMBS_PER_NODE: usize = 3;

const X: DVec3 = DVec3::X;
const Y: DVec3 = DVec3::Y;
const Z: DVec3 = DVec3::Z;
const NX: DVec3 = DVec3::NEG_X;
const NY: DVec3 = DVec3::NEG_Y;
const NZ: DVec3 = DVec3::NEG_Z;

/// Unit directions e_i of the unloaded limbs in shell axes, from the shell's hinge to the mass's: eq. (5).
pub const DIRECTIONS_SHELL: [DVec3; LIMBS] = [Z, NY, NX, NZ, Y, NX, NZ, NY, X];

/// Unit directions from the mass's centre to its three nodes: eq. (6) divided by n. Limb `i` ends at node `i / 3`.
pub const NODE_DIRECTIONS_MASS: [DVec3; NODES] = [NZ, NY, NX];

/// The two lengths that the drawing fixes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Geometry {
    /// Length L of an unloaded limb between its two spherical hinges, m.
    pub limb_length_m: f64,
    /// Half edge n of the cubic mass, m.
    pub half_edge_m: f64,
}

impl Geometry {
    /// The paper's drawing: L = 25.5 mm, n = 21 mm.
    pub const PAPER: Self = Self {
        limb_length_m: 25.5e-3,
        half_edge_m: 21e-3,
    };

    /// Refuses lengths that are not positive and finite, or whose squares overflow or vanish.
    ///
    /// # Errors
    /// [`crate::Error::OutOfRange`] names the field.
    pub fn validate(&self) -> Result<()> {
        for (name, value) in [
            ("limb_length_m", self.limb_length_m),
            ("half_edge_m", self.half_edge_m),
        ] {
            require(
                value > 0.0 && (value * value).is_normal(),
                name,
                value,
                "positive and finite, and its square, too",
            )?;
        }
        Ok(())
    }

    /// Position t of a node from the mass's centre in mass axes, m: eq. (6).
    #[must_use]
    pub fn node_mass_m(&self, node: usize) -> DVec3 {
        NODE_DIRECTIONS_MASS[node] * self.half_edge_m
    }

    /// The mass's hinge t_i of each limb in mass axes, m: eq. (6) limb by limb.
    #[must_use]
    pub fn mass_hinges_m(&self) -> [DVec3; LIMBS] {
        core::array::from_fn(|limb| self.node_mass_m(limb / LIMBS_PER_NODE))
    }

    /// The shell's hinge b_i = t_i - L e_i of each limb in shell axes, m.
    ///
    /// The paper does not print b_i. Only this choice puts the hinges of limbs 1, 5 and 9 outside the mass, and
    /// with it eqs. (3) and (4) make a limb force positive in compression.
    #[must_use]
    pub fn shell_hinges_m(&self) -> [DVec3; LIMBS] {
        let mass = self.mass_hinges_m();
        core::array::from_fn(|limb| mass[limb] - DIRECTIONS_SHELL[limb] * self.limb_length_m)
    }

    /// Middle t_i - (L/2) e_i of each limb at rest, m.
    #[must_use]
    pub fn limb_middles_m(&self) -> [DVec3; LIMBS] {
        let mass = self.mass_hinges_m();
        core::array::from_fn(|limb| {
            mass[limb] - DIRECTIONS_SHELL[limb] * (0.5 * self.limb_length_m)
        })
    }

    /// t_i x e_i of each limb at rest, m: the torque about the mass's centre of a unit force in it.
    #[must_use]
    pub fn arms_m(&self) -> [DVec3; LIMBS] {
        let hinges = self.mass_hinges_m();
        core::array::from_fn(|limb| hinges[limb].cross(DIRECTIONS_SHELL[limb]))
    }

    /// J, rows \[e_i^T, (t_i x e_i)^T\]: the force and, in m, the torque about the mass's centre of a unit force in each limb.
    #[must_use]
    pub fn limb_jacobian(&self) -> SMatrix<f64, LIMBS, 6> {
        let arms = self.arms_m();
        SMatrix::from_fn(|limb, column| match column {
            0..3 => DIRECTIONS_SHELL[limb][column],
            _ => arms[limb][column - 3],
        })
    }
}
