//! Unknowns that one trial has for itself, beside its motion.
//!
//! The sensor is mounted anew for a trial, or has been sitting in the rig for an hour since the last one: its zeros and its
//! sensitivities have moved a little, its centre is not where it was, and neither is the plumb line. None of that is the next
//! trial's, so that it is eliminated with the motion and costs the common unknowns only what it takes away from them.

use alloc::vec::Vec;

use glam::DVec3;

use super::room::Room;
use super::trial::Drive;
use crate::geometry::LIMBS;

/// Sine of the angle between gravity and axis below which they span no plane.
const UPRIGHT: f64 = 1e-6;

/// Times its usual spread that a turn is left open which the trial itself tells.
const TOLD: f64 = 10.0;

/// What an own unknown is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// Zero of a channel against the static record's, V.
    Zero(usize),
    /// Sensitivity of a channel against its usual one, relative.
    Sensitivity(usize),
    /// What is left of an amplifier's own transient, V.
    Transient(usize),
    /// From the axis to the mass's centre along one of the wedge's two sideways directions, m.
    Centre(usize),
    /// What gravity in the sensor at rest has more of, over its size, along one of two directions square to the axis: of the
    /// plane that holds both, and out of it. What it has along the axis no turn about it shows.
    Plumb(usize),
}

/// One of a trial's own unknowns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Own {
    pub kind: Kind,
    pub value: f64,
    /// Standard deviation beforehand about 0; infinite if nothing is known.
    pub deviation: f64,
}

/// Those that a trial has in a room. A centre off the axis and a tilted axis show only where the sensor turns.
pub(super) fn of(
    drive: Drive,
    amplifier: bool,
    room: &Room,
    axis: DVec3,
    gravity_m_s2: DVec3,
) -> Vec<Own> {
    let mut all = Vec::new();
    let mut add = |kind, deviation: f64| {
        if deviation > 0.0 {
            all.push(Own {
                kind,
                value: 0.0,
                deviation,
            });
        }
    };
    for limb in 0..LIMBS {
        add(Kind::Zero(limb), room.zero_v);
        add(Kind::Sensitivity(limb), room.sensitivity.usual);
        if amplifier {
            add(Kind::Transient(limb), f64::INFINITY);
        }
    }
    if drive == Drive::Angular {
        for side in 0..2 {
            add(Kind::Centre(side), room.centre_m);
        }
        // What each trial tells by itself, the room must not tell: else gravity's size would, and with it the accelerometer's
        // gain. Gravity that is square to the axis already loses by a turn only its square's half, and that the room does tell.
        let turn = room.plumb_rad;
        let along = gravity_m_s2.normalize_or_zero().dot(axis).abs();
        add(Kind::Plumb(0), (TOLD * turn * along).max(0.5 * turn * turn));
        add(Kind::Plumb(1), TOLD * turn);
    }
    all
}

/// Directions square to the axis in which gravity may have more than it should: in the plane of both, and out of it.
pub(super) fn plumb(axis: DVec3, gravity_m_s2: DVec3) -> [DVec3; 2] {
    let square = gravity_m_s2 - axis * axis.dot(gravity_m_s2);
    // Where the axis is upright, any two will do.
    let upright = square.length() <= UPRIGHT * gravity_m_s2.length();
    let within = if upright {
        axis.any_orthonormal_vector()
    } else {
        square.normalize()
    };
    [within, axis.cross(within)]
}
