//! The rotation by which the linear trials' directions differ from the stated ones, whatever its angle.
//!
//! Channel i answers a motion along d by h_i a_i . (R d): h its scale factor, a_i the limb's share of an acceleration, R the rotation. Least
//! squares over trials in three directions give the row h_i R^T a_i, and R takes the nine rows, each at unit length, as near the a_i as one
//! rotation can. No scale factor need be known for it but its sign.

use glam::{DMat3, DQuat, DVec3};
use sixaxis_core::identify::static_load_sharing::StaticLoadSharing;
use sixaxis_core::{LIMBS, Parameters};

use crate::diagnosis::trial_case::TrialCase;
use crate::joint::account::rotation;
use sixaxis_recordings::session::Role;

/// The rotation; none if the linear trials' directions leave it open.
pub(super) fn shown(
    shares: &StaticLoadSharing,
    design: &Parameters,
    cases: &[TrialCase<'_>],
) -> Option<DQuat> {
    let mut normal = DMat3::ZERO;
    let mut along = [DVec3::ZERO; LIMBS];
    for case in cases.iter().filter(|case| case.trial.role == Role::Linear) {
        let Some(response) = &case.response else {
            continue;
        };
        let d = case.trial.direction_ground;
        normal += DMat3::from_cols(d * d.x, d * d.y, d * d.z);
        for (row, channel) in along.iter_mut().zip(&response.channels) {
            *row += channel.response * d;
        }
    }
    let inverse = normal.try_inverse()?;
    let pairs = (0..LIMBS).map(|i| {
        let sign = design.scale_per_mass_per_kg[i].signum();
        let row = sign * (inverse * along[i]);
        Some((
            row.try_normalize()?,
            shares.of_acceleration(i).try_normalize()?,
        ))
    });
    rotation(&pairs.collect::<Option<Vec<_>>>()?)
}
