//! What limbs with mass show of it, beside the force on the seismic mass, and how it is taken off.
//!
//! A limb's element shows what accelerates half of its own limb along it: mu e_i . (F + W' x q_i + W x (W x q_i)), where mu is half a limb's mass over the
//! seismic mass m, F the specific force at the centre of m, W its rate and q_i the limb's middle from that centre, c being the centre from the cube's.
//! With g = (I/m)^-1 (W x (I/m) W) and the torque t about the centre, W' = (I/m)^-1 t - g. So the nine show
//!
//! ```text
//! of the wrench   P [F, t + c x F] + mu J [F + c x (I/m)^-1 t, (I/m)^-1 t]
//! of the rate     mu (e_i . (W x (W x q_i)) - J_i [c x g, g]).
//! ```
//!
//! P shares a wrench among the limbs, J has the rows of [`limb_jacobian`](crate::Geometry::limb_jacobian). The former is linear in the nine and taken
//! off them by T ([`of_the_mass`]); the latter is T times six products of the rate ([`volts_by_rate`]). What the mass's motion in the shell adds to
//! a limb's acceleration is left out: 10^-5 of it.

use glam::DVec3;
use nalgebra::{Matrix6, SMatrix, SVector};

use super::{Parameters, Sensor};
use crate::columns::{halves, stacked};
use crate::error::{Error, Result};
use crate::geometry::{DIRECTIONS_SHELL, LIMBS};

/// Products of a rate: xx, yy, zz, yz, zx, xy.
pub(crate) const PRODUCTS: usize = 6;

/// T: leaves of forces over the mass those of a mass at the cube's centre on limbs without mass.
///
/// # Errors
/// [`Error::OutOfRange`] for limbs whose mass leaves the mass's own wrench open.
pub(crate) fn of_the_mass(
    sensor: &Sensor,
    parameters: &Parameters,
    centre_m: DVec3,
    rod_mass: f64,
) -> Result<SMatrix<f64, LIMBS, LIMBS>> {
    let taken_off = || {
        let jacobian = sensor.geometry.limb_jacobian();
        let wrench_of = jacobian.transpose();
        let together = wrench_of * jacobian;
        let sharing = jacobian * together.try_inverse()?;
        let angular = parameters.inertia_per_mass.matrix_mass_m2().inverse();
        // The wrench of all that is shown for each of the mass's own six.
        let shown: [_; 6] = core::array::from_fn(|of| {
            let own = Matrix6::identity().column(of).into_owned();
            let [force, torque] = halves(&own);
            let turned = angular * torque;
            let of_rods = together * stacked(force + centre_m.cross(turned), turned);
            stacked(force, torque + centre_m.cross(force)) + of_rods * rod_mass
        });
        let own = Matrix6::from_columns(&shown).try_inverse()?;
        let too_much = wrench_of - own * wrench_of;
        Some(SMatrix::identity() - sharing * too_much)
    };
    let wanted = "of limbs lighter than the mass that they hold";
    taken_off().ok_or(Error::out_of_range("rod_mass", rod_mass, wanted))
}

/// What each channel shows of [`PRODUCTS`] of the rate after T, V over (rad/s)^2, of a mass in the cube's middle.
///
/// # Errors
/// As [`of_the_mass`].
pub(crate) fn volts_by_rate(
    sensor: &Sensor,
    parameters: &Parameters,
    rod_mass: f64,
) -> Result<[[f64; LIMBS]; PRODUCTS]> {
    let taken_off = of_the_mass(sensor, parameters, DVec3::ZERO, rod_mass)?;
    let jacobian = sensor.geometry.limb_jacobian();
    let middles_m = sensor.geometry.limb_middles_m();
    let inertia = parameters.inertia_per_mass.matrix_mass_m2();
    let angular = inertia.inverse();
    let of_rate = |w: DVec3| {
        let turned = jacobian * stacked(DVec3::ZERO, angular * w.cross(inertia * w));
        let shown = SVector::<f64, LIMBS>::from_fn(|i, _| {
            DIRECTIONS_SHELL[i].dot(w.cross(w.cross(middles_m[i]))) - turned[i]
        });
        taken_off * shown * rod_mass
    };
    let [x, y, z] = DVec3::AXES;
    let squares = [x, y, z].map(of_rate);
    let product =
        |a: usize, b: usize| of_rate(DVec3::AXES[a] + DVec3::AXES[b]) - squares[a] - squares[b];
    let [xx, yy, zz] = squares;
    let products = [xx, yy, zz, product(1, 2), product(2, 0), product(0, 1)];
    Ok(products.map(|force| {
        core::array::from_fn(|i| {
            force[i] / (parameters.scale_per_mass_per_kg[i] * sensor.gains.gain_n_per_v[i])
        })
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture;
    use crate::identify::static_load_sharing::StaticLoadSharing;

    /// Forces over the mass that limbs with mass show in any motion, and those of limbs without.
    #[test]
    fn nothing_is_left_of_any_motion() {
        let (sensor, parameters, rod_mass) = (fixture::SENSOR, fixture::parameters(), 0.02);
        let inertia = parameters.inertia_per_mass.matrix_mass_m2();
        let (force, rate, angular) = (
            DVec3::new(9.0, -4.0, 2.0),
            DVec3::new(5.0, -12.0, 7.0),
            DVec3::new(30.0, 80.0, -50.0),
        );
        let sharing = StaticLoadSharing::new(&sensor.geometry).expect("the fixture's drawing");
        let wanted = sharing.of_wrench(force, inertia * angular + rate.cross(inertia * rate));
        let middles_m = sensor.geometry.limb_middles_m();
        let shown = SVector::<f64, LIMBS>::from_fn(|i, _| {
            let carried = angular.cross(middles_m[i]) + rate.cross(rate.cross(middles_m[i]));
            wanted[i] + rod_mass * DIRECTIONS_SHELL[i].dot(force + carried)
        });
        let linear =
            of_the_mass(&sensor, &parameters, DVec3::ZERO, rod_mass).expect("light limbs") * shown;
        let volts = volts_by_rate(&sensor, &parameters, rod_mass).expect("light limbs");
        let DVec3 { x, y, z } = rate;
        let products = [x * x, y * y, z * z, y * z, z * x, x * y];
        let left = |taken: f64| {
            let off = (0..LIMBS).map(|i| {
                let per_v = parameters.scale_per_mass_per_kg[i] * sensor.gains.gain_n_per_v[i];
                let by_rate = (0..PRODUCTS).map(|of| volts[of][i] * products[of]);
                (linear[i] - taken * by_rate.sum::<f64>() * per_v - wanted[i]).abs()
            });
            off.fold(0.0, f64::max)
        };
        assert!(left(1.0) < 1e-12, "{}", left(1.0));
        assert!(left(0.0) > 0.05, "{}", left(0.0));
    }
}
