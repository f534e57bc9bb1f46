//! The six directions in the parity rows along which nine limbs fail: limbs of one class cannot be distinguished by forces.

use crate::geometry::LIMBS;
use crate::limb_set::LimbSet;
use crate::redundancy::parity::{ROWS, SIGNATURES};

/// Number of directions.
pub const CLASSES: usize = 6;

/// First limb (from 0) of each class.
const FIRST: [usize; CLASSES] = [0, 4, 8, 1, 2, 5];

/// Class of each limb: {1}, {5}, {9}, {2, 4}, {3, 7}, {6, 8}.
pub const CLASS_OF: [usize; LIMBS] = [0, 3, 4, 3, 1, 5, 4, 5, 2];

/// Signature of each class.
#[must_use]
pub const fn signature(class: usize) -> [i32; ROWS] {
    SIGNATURES[FIRST[class]]
}

/// Limbs of a class: one limb, or an ambiguous pair.
#[must_use]
pub fn members(class: usize) -> LimbSet {
    (0..LIMBS)
        .filter(|&limb| CLASS_OF[limb] == class)
        .fold(LimbSet::EMPTY, LimbSet::with)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_class_shares_a_signature_and_no_two_do() {
        for a in 0..LIMBS {
            for b in 0..LIMBS {
                assert_eq!(
                    CLASS_OF[a] == CLASS_OF[b],
                    SIGNATURES[a] == SIGNATURES[b],
                    "{a} {b}"
                );
            }
            assert_eq!(signature(CLASS_OF[a]), SIGNATURES[a]);
            assert!(members(CLASS_OF[a]).contains(a));
        }
    }
}
