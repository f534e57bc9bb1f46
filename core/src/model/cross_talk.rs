//! Cross-talk: what a channel shows of the other limbs' forces, and how it is undone; with it, what the limbs show because the mass's
//! centre is not the cube's and because they have mass themselves.
//!
//! Of the limb forces f over the mass, channel i shows f_i + sum over j of X_ij f_j, so that f = (1 + X)^-1 times what is shown. The force F
//! and the torque t about the mass's centre, c from the cube's, that the decoupler wants have the torque t + c x F about the cube's, and limbs
//! with mass show of F and t what accelerates them. T takes both off ([`super::limb_mass`]). In volts, with V the diagonal of forces over the
//! mass per volt and d the zero drifts,
//!
//! ```text
//! v' = d + V^-1 T (1 + X)^-1 V (v - d).
//! ```
//!
//! What is decoupled then is the acceleration of the mass's centre. What limbs with mass show of the square of the rate is left to the
//! decoupler, which knows the rate ([`Settings::rod_mass`](crate::Settings::rod_mass)).

use glam::DVec3;
use nalgebra::SMatrix;

use super::limb_mass::of_the_mass;
use super::{Parameters, Sensor};
use crate::error::{Error, Result, require_finite, require_not_negative};
use crate::geometry::LIMBS;
use crate::limb_set::LimbSet;

/// Undoes the cross-talk of one recording, of which the gains are known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CrossTalk {
    zero_drift_v: [f64; LIMBS],
    /// What is to be added to the nine voltages for a volt of each channel from its zero.
    by_channel: [[f64; LIMBS]; LIMBS],
}

impl CrossTalk {
    /// From the share of each limb's force (column) that each channel shows (row), the diagonal, a limb's own force, being passed over; and
    /// from where the mass's centre is from the cube's, sensor axes, m, and half a limb's mass over the seismic mass.
    ///
    /// # Errors
    /// Those of [`Parameters::validate`], of the geometry and of the gains; [`Error::OutOfRange`] for shares that cannot be told apart, or
    /// shares, a place or a mass that are none.
    pub fn new(
        sensor: &Sensor,
        parameters: &Parameters,
        shares: &[[f64; LIMBS]; LIMBS],
        mass_centre_m: [f64; 3],
        rod_mass: f64,
    ) -> Result<Self> {
        parameters.validate()?;
        sensor.geometry.validate()?;
        sensor.gains.validate()?;
        for along_m in mass_centre_m {
            require_finite("mass_centre_m", along_m)?;
        }
        require_not_negative("rod_mass", rod_mass)?;
        for &share in shares.as_flattened() {
            require_finite("share of cross-talk", share)?;
        }
        let shown = SMatrix::<f64, LIMBS, LIMBS>::from_fn(|into, from| {
            if into == from {
                1.0
            } else {
                shares[into][from]
            }
        });
        let undone = shown.try_inverse().ok_or(Error::out_of_range(
            "cross-talk",
            shown.determinant(),
            "less than the limbs' own forces",
        ))?;
        let mass_centre_m = DVec3::from_array(mass_centre_m);
        let undone = match mass_centre_m == DVec3::ZERO && rod_mass == 0.0 {
            true => undone,
            false => of_the_mass(sensor, parameters, mass_centre_m, rod_mass)? * undone,
        };
        let force_per_v: [f64; LIMBS] = core::array::from_fn(|i| {
            parameters.scale_per_mass_per_kg[i] * sensor.gains.gain_n_per_v[i]
        });
        Ok(Self {
            zero_drift_v: parameters.zero_drift_v,
            by_channel: core::array::from_fn(|from| {
                core::array::from_fn(|into| {
                    let own = if into == from { 1.0 } else { 0.0 };
                    (undone[(into, from)] - own) * force_per_v[from] / force_per_v[into]
                })
            }),
        })
    }

    /// Nine voltages, V, free of cross-talk. One that is not finite stays so and is not seen in the others.
    #[must_use]
    pub fn undo(&self, voltage_v: &[f64; LIMBS]) -> [f64; LIMBS] {
        self.undo_without(voltage_v, LimbSet::EMPTY)
    }

    /// The same where some channels have failed: nothing that they show is taken for a force.
    #[must_use]
    pub fn undo_without(&self, voltage_v: &[f64; LIMBS], failed: LimbSet) -> [f64; LIMBS] {
        let mut out = *voltage_v;
        let channels = voltage_v
            .iter()
            .zip(&self.zero_drift_v)
            .zip(&self.by_channel);
        for (limb, ((voltage_v, zero_v), shown)) in channels.enumerate() {
            let from_zero = voltage_v - zero_v;
            if from_zero.is_finite() && !failed.contains(limb) {
                for (out, shown) in out.iter_mut().zip(shown) {
                    *out += shown * from_zero;
                }
            }
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture;
    use crate::geometry::DIRECTIONS_SHELL;
    use crate::identify::static_load_sharing::StaticLoadSharing;

    fn shares() -> [[f64; LIMBS]; LIMBS] {
        core::array::from_fn(|i| core::array::from_fn(|j| 1e-2 * ((5 * i + 3 * j) as f64).sin()))
    }

    /// Voltages that nine forces over the mass, m/s^2, cause with and without cross-talk.
    fn voltages(force: &[f64; LIMBS]) -> (CrossTalk, [f64; LIMBS], [f64; LIMBS]) {
        let (sensor, parameters) = (fixture::SENSOR, fixture::parameters());
        let shares = shares();
        let volts = |force: &[f64; LIMBS]| {
            core::array::from_fn(|i| {
                let per_v = parameters.scale_per_mass_per_kg[i] * sensor.gains.gain_n_per_v[i];
                parameters.zero_drift_v[i] + force[i] / per_v
            })
        };
        let shown = core::array::from_fn(|i| {
            let others = (0..LIMBS).filter(|j| *j != i);
            force[i] + others.map(|j| shares[i][j] * force[j]).sum::<f64>()
        });
        let cross_talk =
            CrossTalk::new(&sensor, &parameters, &shares, [0.0; 3], 0.0).expect("small shares");
        (cross_talk, volts(force), volts(&shown))
    }

    /// Force and torque about the cube's centre of nine limb forces.
    fn wrench(force: &[f64; LIMBS]) -> (DVec3, DVec3) {
        let (along, hinges) = (DIRECTIONS_SHELL, fixture::SENSOR.geometry.mass_hinges_m());
        (0..LIMBS).fold((DVec3::ZERO, DVec3::ZERO), |(f, t), i| {
            let one = along[i] * force[i];
            (f + one, t + hinges[i].cross(one))
        })
    }

    #[test]
    fn torque_of_a_mass_off_the_middle_is_taken_off() {
        let (sensor, parameters) = (fixture::SENSOR, fixture::parameters());
        let centre = [3e-4, -2e-4, 1e-4];
        let none = [[0.0; LIMBS]; LIMBS];
        let per_v: [f64; LIMBS] = core::array::from_fn(|i| {
            parameters.scale_per_mass_per_kg[i] * sensor.gains.gain_n_per_v[i]
        });
        let shown: [f64; LIMBS] = core::array::from_fn(|i| 3.0 * (i as f64 + 0.5).cos());
        let volts = core::array::from_fn(|i| parameters.zero_drift_v[i] + shown[i] / per_v[i]);
        let undone = CrossTalk::new(&sensor, &parameters, &none, centre, 0.0)
            .expect("a mass inside the cube")
            .undo(&volts);
        let left = core::array::from_fn(|i| (undone[i] - parameters.zero_drift_v[i]) * per_v[i]);
        let ((force, torque), (same, about_the_mass)) = (wrench(&shown), wrench(&left));
        let off = DVec3::from_array(centre).cross(force);
        assert!(off.length() > 1e-4);
        assert!((same - force).length() < 1e-12);
        assert!((about_the_mass - (torque - off)).length() < 1e-13);
    }

    #[test]
    fn mass_of_the_limbs_is_taken_off() {
        let (sensor, parameters) = (fixture::SENSOR, fixture::parameters());
        let (centre, rod_mass) = (DVec3::new(3e-4, -2e-4, 1e-4), 0.02);
        let none = [[0.0; LIMBS]; LIMBS];
        let (force, angular) = (DVec3::new(9.0, -4.0, 2.0), DVec3::new(30.0, 80.0, -50.0));
        let torque = parameters.inertia_per_mass.matrix_mass_m2() * angular;
        let sharing = StaticLoadSharing::new(&sensor.geometry).expect("the fixture's drawing");
        let borne = sharing.of_wrench(force, torque + centre.cross(force));
        let wanted = sharing.of_wrench(force, torque);
        let middles = sensor.geometry.limb_middles_m();
        let per_v: [f64; LIMBS] = core::array::from_fn(|i| {
            parameters.scale_per_mass_per_kg[i] * sensor.gains.gain_n_per_v[i]
        });
        let left = |rod_mass_taken: f64| -> f64 {
            let volts = core::array::from_fn(|i| {
                let there = force + angular.cross(middles[i] - centre);
                let shown = borne[i] + rod_mass * DIRECTIONS_SHELL[i].dot(there);
                parameters.zero_drift_v[i] + shown / per_v[i]
            });
            let undone = CrossTalk::new(
                &sensor,
                &parameters,
                &none,
                centre.to_array(),
                rod_mass_taken,
            )
            .expect("limbs lighter than the mass")
            .undo(&volts);
            let off = (0..LIMBS)
                .map(|i| ((undone[i] - parameters.zero_drift_v[i]) * per_v[i] - wanted[i]).abs());
            off.fold(0.0, f64::max)
        };
        assert!(left(rod_mass) < 1e-12);
        assert!(left(0.0) > 0.05);
    }

    #[test]
    fn what_a_channel_shows_of_others_is_taken_off() {
        let force = core::array::from_fn(|i| 3.0 * (i as f64 + 0.5).cos());
        let (cross_talk, own, shown) = voltages(&force);
        for (limb, (undone, own)) in cross_talk.undo(&shown).iter().zip(&own).enumerate() {
            assert!((undone - own).abs() < 1e-13, "limb {}", limb + 1);
            assert!((shown[limb] - own).abs() > 1e-5, "limb {}", limb + 1);
        }
    }

    #[test]
    fn a_channel_that_failed_is_not_seen_in_the_others() {
        let force = core::array::from_fn(|i| 3.0 * (i as f64 + 0.5).cos());
        let (cross_talk, _, mut shown) = voltages(&force);
        let before = cross_talk.undo_without(&shown, LimbSet::EMPTY.with(4));
        shown[4] = f64::NAN;
        let after = cross_talk.undo(&shown);
        assert!(after[4].is_nan());
        for limb in (0..LIMBS).filter(|limb| *limb != 4) {
            assert_eq!(before[limb], after[limb], "limb {}", limb + 1);
        }
    }

    #[test]
    fn shares_that_cannot_be_told_apart_are_refused() {
        let (sensor, parameters) = (fixture::SENSOR, fixture::parameters());
        let equal = [[1.0; LIMBS]; LIMBS];
        assert!(CrossTalk::new(&sensor, &parameters, &equal, [0.0; 3], 0.0).is_err());
        let mut unknown = shares();
        unknown[2][7] = f64::NAN;
        assert!(CrossTalk::new(&sensor, &parameters, &unknown, [0.0; 3], 0.0).is_err());
        let nowhere = [f64::INFINITY, 0.0, 0.0];
        assert!(CrossTalk::new(&sensor, &parameters, &shares(), nowhere, 0.0).is_err());
        let weightless = f64::NAN;
        assert!(CrossTalk::new(&sensor, &parameters, &shares(), [0.0; 3], weightless).is_err());
    }
}
