//! The strains of excluded limbs from those of the others.
//!
//! With P = W (W^T W)^-1 W^T, the projector on the strains that no pose produces, the excluded strains x_F that make the rows
//! smallest solve P_FF x_F = -P_FS x_S. Let rho be the rows with zero in place of the excluded strains: x_F = -P_FF^-1 W_F (W^T W)^-1 rho.
//! With the strains so reconstructed, sums over nine limbs are least squares over the remaining ones, since
//! J^T (x_S; J_F u) = J^T J u for the pose u = (J_S^T J_S)^-1 J_S^T x_S. Nothing else of a decoupler changes.
//!
//! P_FF is 1/18 of a matrix of whole numbers, so that its rank is decided without rounding: of 129 sets of up to
//! three limbs, 93 can be excluded. In the other 36 there are forces in excluded limbs alone that cancel in every row; the
//! load that needs them is unobservable with the remaining limbs.

use glam::DVec3;

use super::parity::{GRAM_DENOMINATOR, GRAM_INVERSE, ROWS, SIGNATURES};
use crate::error::{Error, Result, require};
use crate::geometry::{DIRECTIONS_SHELL, LIMBS, LIMBS_PER_NODE, NODE_DIRECTIONS_MASS};
use crate::limb_set::LimbSet;
use crate::unobservable::LostLoad;

/// Largest number of limbs that can be excluded: six accelerations need six channels.
pub const MOST_EXCLUDED: usize = 3;

/// Strains of excluded limbs as combinations of the parity rows' residuals with those strains set to zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reconstruction {
    excluded: LimbSet,
    /// Stiffness of each limb over the mean one's.
    stiffness_ratio: [f64; LIMBS],
    /// Rows of -P_FF^-1 W_F (W^T W)^-1; zero for limbs that are not excluded.
    weights: [[f64; ROWS]; LIMBS],
}

impl Reconstruction {
    /// For a set of excluded limbs, which may be empty.
    ///
    /// # Errors
    /// [`Error::LostLoad`] where the others do not determine six accelerations; [`Error::OutOfRange`] for more than
    /// [`MOST_EXCLUDED`].
    pub fn new(excluded: LimbSet) -> Result<Self> {
        let mut weights = [[0.0; ROWS]; LIMBS];
        require(
            excluded.len() <= MOST_EXCLUDED,
            "excluded limbs",
            excluded.len() as f64,
            "at most three: six accelerations want six channels",
        )?;
        let none = Self {
            excluded,
            stiffness_ratio: [1.0; LIMBS],
            weights,
        };
        if excluded.is_empty() {
            return Ok(none);
        }
        // Never by index from here on: no panic must be in reach of a decoupler that does without a limb in mid-stream.
        let mut limbs = [None; MOST_EXCLUDED];
        let numbered = SIGNATURES.into_iter().zip(SCALED).enumerate();
        let chosen = numbered.filter(|(index, _)| excluded.contains(*index));
        for (place, (_, limb)) in limbs.iter_mut().zip(chosen) {
            *place = Some(limb);
        }
        // 18 P_FF; ones on the diagonal for places that are not taken.
        let block: [[i32; 3]; 3] = core::array::from_fn(|i| {
            core::array::from_fn(|j| match (limbs[i], limbs[j]) {
                (Some((_, a)), Some((b, _))) => dot(a, b),
                _ => i32::from(i == j),
            })
        });
        let (adjugate, determinant) = adjugate(&block);
        if determinant == 0 {
            return Err(Error::LostLoad {
                excluded,
                load: lost_load(
                    excluded,
                    limbs.map(|limb| limb.map(|(signature, _)| signature)),
                ),
            });
        }
        let rows = adjugate.map(|row| {
            let mut sum = [0; ROWS];
            for (share, limb) in row.into_iter().zip(limbs) {
                let along = limb.map_or([0; ROWS], |(_, scaled)| scaled);
                for (sum, entry) in sum.iter_mut().zip(along) {
                    *sum += share * entry;
                }
            }
            sum.map(|sum| -f64::from(sum) / f64::from(determinant))
        });
        let numbered = weights.iter_mut().enumerate();
        let chosen = numbered.filter(|(index, _)| excluded.contains(*index));
        for ((_, weights), row) in chosen.zip(rows) {
            *weights = row;
        }
        Ok(Self { weights, ..none })
    }

    /// The same of limbs of these stiffnesses over their mean: strains are forces over them.
    #[must_use]
    pub const fn with_stiffness(self, ratio: &[f64; LIMBS]) -> Self {
        Self {
            stiffness_ratio: *ratio,
            ..self
        }
    }

    /// Stiffness of each limb over the mean one's.
    #[must_use]
    pub const fn stiffness_ratio(&self) -> &[f64; LIMBS] {
        &self.stiffness_ratio
    }

    /// The excluded limbs.
    #[must_use]
    pub const fn excluded(&self) -> LimbSet {
        self.excluded
    }

    /// Force of an excluded limb by that of another, all others' being zero.
    #[must_use]
    pub fn share(&self, excluded: usize, of: usize) -> f64 {
        let weights = self.weights[excluded].iter();
        weights
            .zip(SIGNATURES[of])
            .map(|(weight, sign)| weight * f64::from(sign))
            .sum::<f64>()
            * (self.stiffness_ratio[excluded] / self.stiffness_ratio[of])
    }

    /// Force and torque, shell axes, that a force of each limb is: its own and, as those are made of it, that of the excluded ones, whose own
    /// are none.
    #[must_use]
    pub fn wrenches(&self, arms_m: &[DVec3; LIMBS]) -> [[DVec3; 2]; LIMBS] {
        let own = |limb: usize| [DIRECTIONS_SHELL[limb], arms_m[limb]];
        core::array::from_fn(|limb| {
            if self.excluded.contains(limb) {
                return [DVec3::ZERO; 2];
            }
            let mut all = own(limb);
            for made in self.excluded.indices() {
                let share = self.share(made, limb);
                all = core::array::from_fn(|part| all[part] + own(made)[part] * share);
            }
            all
        })
    }

    /// What the three rows' residuals, with zero for the excluded strains, are multiplied with and added up to, limb by limb.
    #[must_use]
    pub const fn weights(&self) -> &[[f64; ROWS]; LIMBS] {
        &self.weights
    }
}

/// 18 W (W^T W)^-1, limb by limb.
const SCALED: [[i32; ROWS]; LIMBS] = scaled();

const fn scaled() -> [[i32; ROWS]; LIMBS] {
    let mut of = [[0; ROWS]; LIMBS];
    let mut limb = 0;
    while limb < LIMBS {
        let mut row = 0;
        while row < ROWS {
            of[limb][row] = dot(GRAM_INVERSE[row], SIGNATURES[limb]);
            row += 1;
        }
        limb += 1;
    }
    of
}

const fn dot([a, b, c]: [i32; ROWS], [x, y, z]: [i32; ROWS]) -> i32 {
    a * x + b * y + c * z
}

const _: () = assert!(GRAM_DENOMINATOR == 18);

fn adjugate(m: &[[i32; 3]; 3]) -> ([[i32; 3]; 3], i32) {
    let minor = |i: usize, j: usize| {
        let (r, s) = ((i + 1) % 3, (i + 2) % 3);
        let (c, d) = ((j + 1) % 3, (j + 2) % 3);
        m[r][c] * m[s][d] - m[r][d] * m[s][c]
    };
    let adjugate: [[i32; 3]; 3] = core::array::from_fn(|i| core::array::from_fn(|j| minor(j, i)));
    let determinant = (0..3).map(|j| m[0][j] * minor(0, j)).sum();
    (adjugate, determinant)
}

/// The load behind forces of -1, 0 or 1 in excluded limbs, of these signatures, that cancel in every row; the fewest that do.
fn lost_load(excluded: LimbSet, limbs: [Option<[i32; ROWS]>; MOST_EXCLUDED]) -> LostLoad {
    let mut best = ([0; MOST_EXCLUDED], usize::MAX);
    for code in 0..27 {
        let force = [code / 9 - 1, code / 3 % 3 - 1, code % 3 - 1];
        let used = force.iter().filter(|&&f| f != 0).count();
        let borne = || limbs.iter().zip(force);
        let idle = borne().all(|(limb, f)| limb.is_some() || f == 0);
        let mut rows = [0; ROWS];
        for (limb, f) in borne() {
            for (row, share) in rows.iter_mut().zip(limb.unwrap_or_default()) {
                *row += f * share;
            }
        }
        if idle && rows == [0; ROWS] && used > 0 && used < best.1 {
            best = (force, used);
        }
    }
    let mut load = [DVec3::ZERO; 2];
    let arms = NODE_DIRECTIONS_MASS
        .iter()
        .flat_map(|arm| [arm; LIMBS_PER_NODE]);
    let numbered = DIRECTIONS_SHELL.iter().zip(arms).enumerate();
    let chosen = numbered.filter(|(index, _)| excluded.contains(*index));
    for ((_, (direction, arm)), force) in chosen.zip(best.0) {
        let along = direction * f64::from(force);
        load[0] += along;
        load[1] += arm.cross(along);
    }
    // Sums of three unit axes: whole numbers.
    let [force_shell, torque_over_half_edge_shell] = load.map(|v| v.to_array().map(|x| x as i32));
    LostLoad {
        force_shell,
        torque_over_half_edge_shell,
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::format;

    use super::*;

    #[test]
    fn sets_that_can_be_done_without() {
        let able = |n| {
            LimbSet::of_size(n)
                .filter(|&set| Reconstruction::new(set).is_ok())
                .count()
        };
        assert_eq!([0, 1, 2, 3].map(able), [1, 9, 33, 51]);
    }

    #[test]
    fn what_is_lost_loads_failed_limbs_only() {
        for size in 1..=MOST_EXCLUDED {
            for set in LimbSet::of_size(size) {
                let Err(Error::LostLoad { excluded, load }) = Reconstruction::new(set) else {
                    continue;
                };
                assert_eq!(excluded, set);
                let torque = DVec3::from(load.torque_over_half_edge_shell.map(f64::from));
                let force = DVec3::from(load.force_shell.map(f64::from));
                assert!(torque != DVec3::ZERO || force != DVec3::ZERO);
                // Forces of equally stiff limbs: J (J^T J)^-1 load.
                let shares = crate::identify::static_load_sharing::StaticLoadSharing::new(
                    &crate::Geometry {
                        limb_length_m: 1.0,
                        half_edge_m: 1.0,
                    },
                )
                .expect("a cube");
                for limb in (0..LIMBS).filter(|&limb| !set.contains(limb)) {
                    let borne = shares.of_acceleration(limb).dot(force)
                        + shares.of_torque_per_m(limb).dot(torque);
                    assert!(
                        borne.abs() < 1e-15,
                        "{set}: limb {} bears {borne}",
                        limb + 1
                    );
                }
            }
        }
    }

    #[test]
    fn a_lost_load_is_named() {
        let set = LimbSet::from_numbers([2, 4]).expect("limbs");
        let error = Reconstruction::new(set).expect_err("an ambiguous pair");
        assert_eq!(
            format!("{error}"),
            "limbs 2 and 4 excluded: the remaining limbs cannot observe a force along y - z together with a torque about 2 x over the half edge"
        );
    }
}
