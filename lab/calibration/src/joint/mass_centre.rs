//! A mass whose centre is not the cube's, which a fit that holds it there takes for cross-talk.
//!
//! With its centre c from the cube's, a mass asks of the limbs the torque c x F beside the force F, so that each channel shows a little of
//! what the other limbs bear: P \[0, c x e_j\], of their directions e_j and their sharing P of a load. Cables do not couple channels that are
//! apart, nor by three numbers. Where a fit says that such channels show something of each other, and three numbers account for some of it, it is
//! made again with the centre free; and that is what holds if it leaves channels apart much less.
//!
//! The trials tell of a channel's cross-talk only what loads that hold the mass show of it, X P, and of that what is no other
//! scale factor of its own limb: five numbers a channel.

use glam::DVec3;
use nalgebra::{DMatrix, DVector, Vector6};
use sixaxis_core::geometry::DIRECTIONS_SHELL;
use sixaxis_core::identify::joint::estimate::JointEstimate;
use sixaxis_core::identify::joint::unknowns::Unknowns;
use sixaxis_core::identify::static_load_sharing::StaticLoadSharing;
use sixaxis_core::{Geometry, LIMBS};

use super::JointReport;

/// How far a workshop may miss the middle of the cube, a standard deviation, m.
pub(super) const DEVIATION_M: f64 = 1e-3;
/// Spread of what channels apart show of each other from which on it is worth a second fit.
const LEAST: f64 = 3e-5;
/// Share of all cross-talk that three numbers account for then: of nothing but chance it is 3 in 45.
const EXPLAINED: f64 = 0.15;
/// Spread of what channels apart show of each other with the centre free that is more than nothing.
const LEFT_OVER: f64 = 1e-4;
/// Distance from the cube's centre that is remarkable, m.
const FAR_M: f64 = 1e-3;
/// Share that the second fit leaves of that spread at most.
const LEFT: f64 = 0.5;

/// Whether a fit's cross-talk may be a mass off the middle.
pub(super) fn may_be(geometry: &Geometry, held: &JointEstimate) -> bool {
    let Ok(sharing) = StaticLoadSharing::new(geometry) else {
        return false;
    };
    // Torques as forces at half an edge.
    let shares: [Vector6<f64>; LIMBS] = core::array::from_fn(|limb| {
        let torque = sharing.of_torque_per_m(limb) * geometry.half_edge_m;
        let force = sharing.of_acceleration(limb);
        Vector6::new(force.x, force.y, force.z, torque.x, torque.y, torque.z)
    });
    let told = |share: &dyn Fn(usize, usize) -> f64| -> DVector<f64> {
        let channels = (0..LIMBS).flat_map(|into| {
            let others = (0..LIMBS).filter(|from| *from != into);
            let shown: Vector6<f64> = others.map(|from| shares[from] * share(into, from)).sum();
            let own = shares[into].normalize();
            let beside_its_own = shown - own * own.dot(&shown);
            beside_its_own.iter().copied().collect::<Vec<f64>>()
        });
        DVector::from_iterator(6 * LIMBS, channels)
    };
    let cross_talk = |into, from| held.unknowns.values[Unknowns::cross_talk(into, from)];
    let by_centre = DVec3::AXES.map(|axis| {
        told(&|into, from| {
            let torque = axis.cross(DIRECTIONS_SHELL[from]);
            sharing.of_torque_per_m(into).dot(torque)
        })
    });
    let (shown, by_centre) = (told(&cross_talk), DMatrix::from_columns(&by_centre));
    let Some(normal) = by_centre.tr_mul(&by_centre).cholesky() else {
        return false;
    };
    let explained = &by_centre * normal.solve(&by_centre.tr_mul(&shown));
    held.spreads.cross_talk_apart > LEAST
        && explained.norm_squared() > EXPLAINED * shown.norm_squared()
}

impl JointReport {
    /// What is odd about a mass that was found off the middle: that it is farther than a workshop misses it, or not all of what looked like it.
    pub fn odd_mass_centre(&self) -> Option<String> {
        let place = self.nuisances().room.mass_centre_m?;
        let off_m = DVec3::from_array(place.map(|along| along.value)).length();
        let apart = self.estimate.spreads.cross_talk_apart;
        let found = format!(
            "the mass's centre comes out {:.2} mm from the cube's",
            1e3 * off_m
        );
        if apart > LEFT_OVER {
            return Some(format!(
                "{found}, and channels that are apart show {:.3} % of each other beside what that explains: it may hide a channel that is another in one kind of trials",
                100.0 * apart
            ));
        }
        (off_m > FAR_M).then(|| format!("{found}: more than a workshop misses the middle by; see whether something is loose, or lies on the mass"))
    }
}

/// Whether a fit with the centre free is the better one.
pub(super) fn is_it(held: &JointEstimate, free: &JointEstimate) -> bool {
    free.spreads.cross_talk_apart < LEFT * held.spreads.cross_talk_apart
}
