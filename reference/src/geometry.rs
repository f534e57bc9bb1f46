//! Where the nine limbs are: equations (5) and (6) as the paper prints them, and the lengths of its drawing.
//!
//! This file shares nothing with the geometry of `sixaxis-core`; the test `inv_two_geometries_are_one` compares the two.

use glam::DVec3;
use nalgebra::SMatrix;
use serde::Serialize;

/// Number of limbs, and so of voltage channels.
pub const LIMBS: usize = 9;

/// Equation (5): unit directions of the unloaded limbs in shell axes. Rows x, y, z; columns limb 1 to 9.
const DIRECTIONS: [[f64; LIMBS]; 3] = [
    [0.0, 0.0, -1.0, 0.0, 0.0, -1.0, 0.0, 0.0, 1.0],
    [0.0, -1.0, 0.0, 0.0, 1.0, 0.0, 0.0, -1.0, 0.0],
    [1.0, 0.0, 0.0, -1.0, 0.0, 0.0, -1.0, 0.0, 0.0],
];

/// Equation (6) over n: where the limbs end on the mass, from its centre. Rows x, y, z; columns limb 1 to 9.
const ENDS: [[f64; LIMBS]; 3] = [
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0, -1.0, -1.0],
    [0.0, 0.0, 0.0, -1.0, -1.0, -1.0, 0.0, 0.0, 0.0],
    [-1.0, -1.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
];

/// The two lengths of the drawing.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Geometry {
    /// L, length of an unloaded limb from hinge to hinge, m.
    pub limb_length_m: f64,
    /// n, half edge of the cubic mass, m.
    pub half_edge_m: f64,
}

impl Geometry {
    /// The paper's: L = 25.5 mm, n = 21 mm.
    pub const PAPER: Self = Self {
        limb_length_m: 25.5e-3,
        half_edge_m: 21e-3,
    };

    /// Unit directions e_i of the unloaded limbs, from shell to mass, shell axes.
    pub fn directions_shell() -> [DVec3; LIMBS] {
        columns(&DIRECTIONS)
    }

    /// Hinges t_i on the mass, from its centre, mass axes, m.
    pub fn mass_hinges_m(&self) -> [DVec3; LIMBS] {
        columns(&ENDS).map(|end| end * self.half_edge_m)
    }

    /// Hinges b_i = t_i - L e_i on the shell, shell axes, m.
    ///
    /// The paper does not print b_i. With the other sign the hinges of limbs 1, 5 and 9 would lie inside the mass; with this
    /// one a limb that pushes on the mass along e_i is compressed.
    pub fn shell_hinges_m(&self) -> [DVec3; LIMBS] {
        let directions = Self::directions_shell();
        let ends = self.mass_hinges_m();
        core::array::from_fn(|limb| ends[limb] - directions[limb] * self.limb_length_m)
    }

    /// The unit wrenches of the limbs on the mass at rest: row i is \[e_i, t_i x e_i\], shell axes, 1 and m.
    pub fn limb_wrenches(&self) -> SMatrix<f64, LIMBS, 6> {
        let directions = Self::directions_shell();
        let ends = self.mass_hinges_m();
        SMatrix::from_fn(|limb, column| {
            let force = directions[limb];
            let moment = ends[limb].cross(force);
            [force.x, force.y, force.z, moment.x, moment.y, moment.z][column]
        })
    }
}

fn columns(rows: &[[f64; LIMBS]; 3]) -> [DVec3; LIMBS] {
    core::array::from_fn(|limb| DVec3::new(rows[0][limb], rows[1][limb], rows[2][limb]))
}
