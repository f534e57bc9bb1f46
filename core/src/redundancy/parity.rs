//! The three redundancy (parity) relations of nine limbs over six axes: the force coordination equations.
//!
//! A mass has six coordinates, so that nine elongations obey three relations. To first order in the strain the elongations of
//! limbs on an undeformed mass obey, whatever the motion, the mass or its inertia,
//!
//! ```text
//! x1 + x2 + x4 + x5 = 0,    x1 + x3 + x7 + x9 = 0,    x5 + x6 + x8 + x9 = 0,
//! ```
//!
//! and the forces do as far as the limbs are equally stiff. The left sides are the three parity rows: zero except for noise
//! while no limb has failed. [`super::residual()`] keeps their second order, which is one to three hundred-thousandths of the
//! largest force at 9 g.
//!
//! A limb that fails shows along its own column of the rows, its [`SIGNATURES`]. Limbs 1, 5 and 9 each have a signature of
//! their own; 2 and 4, 3 and 7, 6 and 8 share one ([`AMBIGUOUS_PAIRS`]), and no force
//! distinguishes the two limbs of such a pair. Limbs whose signatures are independent can be excluded: [`super::reconstruction`]
//! computes their strains from the others.

use crate::geometry::LIMBS;

/// Number of coordination equations.
pub const ROWS: usize = 3;

/// Limbs (from 0) whose elongations each equation adds up.
pub const COORDINATION: [[usize; 4]; ROWS] = [[0, 1, 3, 4], [0, 2, 6, 8], [4, 5, 7, 8]];

/// Limbs (from 0) that share a signature.
pub const AMBIGUOUS_PAIRS: [[usize; 2]; ROWS] = [[1, 3], [2, 6], [5, 7]];

/// In which rows each limb stands: a failure of limb i shows along `SIGNATURES[i]`.
pub const SIGNATURES: [[i32; ROWS]; LIMBS] = signatures();

const fn signatures() -> [[i32; ROWS]; LIMBS] {
    let mut of = [[0; ROWS]; LIMBS];
    let mut row = 0;
    while row < ROWS {
        let mut place = 0;
        while place < 4 {
            of[COORDINATION[row][place]][row] = 1;
            place += 1;
        }
        row += 1;
    }
    of
}

/// (W^T W)^-1 times [`GRAM_DENOMINATOR`], W the nine signatures: each row adds four limbs, each pair of rows has one in common.
pub const GRAM_INVERSE: [[i32; ROWS]; ROWS] = [[5, -1, -1], [-1, 5, -1], [-1, -1, 5]];
/// See [`GRAM_INVERSE`].
pub const GRAM_DENOMINATOR: i32 = 18;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gram_inverse_is_one() {
        for i in 0..ROWS {
            let mut product = [0; ROWS];
            for (k, inverse) in GRAM_INVERSE.iter().enumerate() {
                let gram: i32 = SIGNATURES.iter().map(|s| s[i] * s[k]).sum();
                for (sum, entry) in product.iter_mut().zip(inverse) {
                    *sum += gram * entry;
                }
            }
            let mut expected = [0; ROWS];
            expected[i] = GRAM_DENOMINATOR;
            assert_eq!(product, expected);
        }
    }
}
