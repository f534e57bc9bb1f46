//! Pose and load with limbs excluded: their strains are reconstructed from those of the other limbs, see
//! [`crate::redundancy::reconstruction`].
//!
//! Let K be the reconstruction's weights and rho what the parity relations leave ([`super::parity`]) of strains that are zero for the
//! excluded limbs. K rho is added to these zeros twice, which makes the strains right to first, then to second order: first with
//! rho to first order, then with the second order of rho alone. The third order is added to force and torque only. In the pose it is
//! left out: 58 cubes of the strain, 6e-9 of a strain at the rig's 9 g, of a motion in the shell that is itself a millionth of the
//! shell's.
//!
//! Forces are right to third order. The dropped fourth order is at most 4e-13 of the largest force at the rig's 9 g and 4e-10 at
//! [`placement::STRAIN_LIMIT`]; above that, [`exactly`] takes over.

use super::constants::Constants;
use super::number::{Real, Scalar};
use super::order::{Limbs, to_kernel_order};
use super::parity::sums;
use super::placement::{self, LimbLoad, limb_strains};
use super::weights::{LoadWeights, StrainWeights};
use crate::error::{Error, Result};
use crate::geometry::{Geometry, LIMBS};
use crate::limb_set::LimbSet;
use crate::paper::pose::Pose;
use crate::redundancy::reconstruction::Reconstruction;

/// Cap of [`exactly`], each step of which is smaller than the one before by a factor of about the strain.
const ITERATIONS: usize = 64;
/// Step over the largest strain at which it stops: rounding.
const SETTLED: f64 = 4.0 * f64::EPSILON;

/// What reconstructs strains, and what the reconstruction adds to force and torque.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StrainReconstruction<T: Real> {
    /// To second order.
    pub strain: StrainWeights<T>,
    /// To third order.
    pub load: LoadWeights<T>,
}

impl<T: Scalar> StrainReconstruction<T> {
    /// Of no limb.
    pub fn none() -> Self {
        Self {
            strain: StrainWeights::none(),
            load: LoadWeights::splat(T::default()),
        }
    }

    /// Rounded weights, and what they do to this sensor's forces.
    pub fn new(reconstruction: &Reconstruction, constants: &Constants<f64>) -> Self {
        Self {
            strain: StrainWeights::new(reconstruction),
            load: LoadWeights::new(reconstruction, constants),
        }
    }
}

impl<T: Real> StrainReconstruction<T> {
    /// The same numbers in another type.
    #[inline(always)]
    pub(crate) fn map<U: Real>(&self, f: impl Fn(T) -> U) -> StrainReconstruction<U> {
        StrainReconstruction {
            strain: self.strain.map(&f),
            load: self.load.map(&f),
        }
    }

    /// [`placement::by_series`] with limbs excluded; `constants` gives their strains as zero whatever the voltage
    /// ([`Constants::excluding`]).
    #[inline(always)]
    pub fn by_series(&self, constants: &Constants<T>, voltage_v: Limbs<T>) -> LimbLoad<T> {
        let used = limb_strains(constants, voltage_v);
        let strain = self.strain.to_second_order(used, constants.inverse_nu);
        self.load.by_strains(constants, strain)
    }
}

impl Constants<f64> {
    /// The same with zero strain of the excluded limbs.
    pub fn excluding(&self, excluded: LimbSet) -> Self {
        let kept = to_kernel_order(core::array::from_fn(|limb| {
            f64::from(u8::from(!excluded.contains(limb)))
        }));
        let by = |[a, b, c]: Limbs<f64>| {
            [
                a.mul_elem(kept[0]),
                b.mul_elem(kept[1]),
                c.mul_elem(kept[2]),
            ]
        };
        Self {
            strain_per_v: by(self.strain_per_v),
            strain_at_zero: by(self.strain_at_zero),
            ..*self
        }
    }
}

/// Places the mass without any series: the failed strains are those of the pose that they give together with the others.
/// `constants` makes zero strain of the failed limbs, whose voltages must be numbers. `sample` is for errors.
///
/// # Errors
/// Those of [`placement::exactly`]; [`Error::NotConverged`].
#[cold]
pub fn exactly(
    constants: &Constants<f64>,
    reconstruction: &Reconstruction,
    voltage_v: &[f64; LIMBS],
    sample: usize,
) -> Result<LimbLoad<f64>> {
    placement::refuse(constants, voltage_v, sample)?;
    let geometry = Geometry {
        limb_length_m: 1.0,
        half_edge_m: constants.nu,
    };
    let mut x = placement::strains(constants, voltage_v);
    for _ in 0..ITERATIONS {
        let own = core::array::from_fn(|limb| x[limb] / reconstruction.stiffness_ratio()[limb]);
        let fitted = Pose::from_elongations(&geometry, &own)?.elongations_m(&geometry);
        let beyond = core::array::from_fn(|limb| own[limb] - fitted[limb]);
        let rows = sums(to_kernel_order(beyond)).components();
        let (mut moved, mut size) = (0.0_f64, 0.0_f64);
        let ratios = reconstruction.stiffness_ratio();
        for ((strain, weights), ratio) in x.iter_mut().zip(reconstruction.weights()).zip(ratios) {
            let step: f64 = weights.iter().zip(&rows).map(|(k, rho)| k * rho).sum();
            let step = step * ratio;
            *strain += step;
            moved = moved.max(step.abs());
            size = size.max(strain.abs());
        }
        if moved <= SETTLED * size {
            return placement::exactly_by_strains(constants, &x);
        }
    }
    Err(Error::NotConverged {
        what: "strains of excluded limbs",
        iterations: ITERATIONS,
    })
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::fixture;
    use crate::geometry::LIMBS_PER_NODE;
    use crate::kernel::vec3::Vec3;
    use crate::redundancy::reconstruction::MOST_EXCLUDED;

    /// One volt is one strain.
    fn constants() -> Constants<f64> {
        let numbers = Constants::new(&fixture::model()).expect("a sound sensor");
        Constants {
            strain_per_v: [Vec3::all(1.0); LIMBS_PER_NODE],
            strain_at_zero: [Vec3::all(0.0); LIMBS_PER_NODE],
            ..numbers
        }
    }

    /// Strains of a pose in which the largest is about `scale`.
    fn strains(scale: f64) -> [f64; LIMBS] {
        let unit = Geometry {
            limb_length_m: 1.0,
            half_edge_m: constants().nu,
        };
        let pose = Pose {
            position_shell_m: DVec3::new(0.3, -0.7, 0.5) * scale,
            rotation_rad: DVec3::new(-0.6, 0.2, 0.9) * scale,
        };
        pose.elongations_m(&unit)
    }

    fn survivable() -> impl Iterator<Item = Reconstruction> {
        (0..=MOST_EXCLUDED)
            .flat_map(LimbSet::of_size)
            .filter_map(|set| Reconstruction::new(set).ok())
    }

    /// Largest differences of two placements, all in the order of a strain: where the mass is, and what the limbs pull.
    fn difference(a: &LimbLoad<f64>, b: &LimbLoad<f64>, torque: &Constants<f64>) -> [f64; 2] {
        let size = torque.torque[0].dot(torque.torque[0]).sqrt();
        let off = |u: Vec3<f64>, v: Vec3<f64>| {
            let w = u - v;
            w.dot(w).sqrt()
        };
        [
            off(a.position_thrice, b.position_thrice).max(off(a.rotation, b.rotation)),
            off(a.force, b.force).max(off(a.torque, b.torque) / size),
        ]
    }

    #[test]
    fn what_is_filled_in_is_right_to_second_and_third_order() {
        let errors = |scale: f64| {
            let x = strains(scale);
            let full = constants();
            let healthy = placement::by_series(&full, to_kernel_order(x));
            survivable()
                .map(|reconstruction| {
                    let used = full.excluding(reconstruction.excluded());
                    let ours = StrainReconstruction::new(&reconstruction, &full)
                        .by_series(&used, to_kernel_order(x));
                    difference(&ours, &healthy, &full)
                })
                .fold([0.0; 2], |[p, f], [q, g]| [f64::max(p, q), f64::max(f, g)])
        };
        let ([place, force], [place_half, force_half]) = (errors(1e-4), errors(5e-5));
        // Halving the strain leaves an eighth where its cube is the first that is dropped, a sixteenth where it is the fourth.
        assert!(
            (place / place_half - 8.0).abs() < 0.1,
            "{place} {place_half}"
        );
        assert!(
            (force / force_half - 16.0).abs() < 0.2,
            "{force} {force_half}"
        );
        assert!(place < 1e-6 * 1e-4, "{place}");
        assert!(force < 1e-9 * 1e-4, "{force}");
    }

    #[test]
    fn nothing_to_fill_in_changes_no_bit() {
        let (x, full) = (strains(1e-5), constants());
        let none = Reconstruction::new(LimbSet::EMPTY).expect("no limb");
        let ours = StrainReconstruction::new(&none, &full)
            .by_series(&full.excluding(LimbSet::EMPTY), to_kernel_order(x));
        assert_eq!(ours, placement::by_series(&full, to_kernel_order(x)));
    }

    #[test]
    fn series_and_iteration_agree() {
        let (x, full) = (strains(1e-4), constants());
        for reconstruction in survivable() {
            let used = full.excluding(reconstruction.excluded());
            let ours = StrainReconstruction::new(&reconstruction, &full)
                .by_series(&used, to_kernel_order(x));
            let exact = exactly(&used, &reconstruction, &x, 0).expect("limbs that meet");
            let [place, force] = difference(&ours, &exact, &full);
            let failed = reconstruction.excluded();
            assert!(place < 1e-6 * 1e-4, "{failed}: {place}");
            assert!(force < 1e-9 * 1e-4, "{failed}: {force}");
        }
    }

    #[test]
    fn large_strains_are_filled_in_by_iteration() {
        let (x, full) = (strains(0.1), constants());
        let healthy = placement::exactly(&full, &x, 0).expect("limbs that meet");
        for reconstruction in survivable() {
            let used = full.excluding(reconstruction.excluded());
            let ours = exactly(&used, &reconstruction, &x, 0).expect("limbs that meet");
            let [place, force] = difference(&ours, &healthy, &full);
            let failed = reconstruction.excluded();
            assert!(place.max(force) < 1e-14, "{failed}: {place} {force}");
        }
    }
}
