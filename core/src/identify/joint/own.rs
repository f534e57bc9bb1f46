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

/// What an own unknown is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// Zero of a channel against the static record's, V.
    Zero(usize),
    /// Sensitivity of a channel against its usual one, relative.
    Sensitivity(usize),
    /// What is left of an amplifier's own transient, V.
    Transient(usize),
    /// From the axis to the sensor's centre along one of the wedge's two sideways directions, m.
    Centre(usize),
    /// Turn of gravity's direction in the sensor at rest, rad, along one of two directions square to it.
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
pub(super) fn of(drive: Drive, amplifier: bool, room: &Room) -> Vec<Own> {
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
            add(Kind::Plumb(side), room.plumb_rad);
        }
    }
    all
}

/// Gravity turned by two small angles about directions square to it, and its derivatives by them. It keeps its size.
pub(super) fn plumb(nominal_m_s2: DVec3, angles_rad: [f64; 2]) -> (DVec3, [DVec3; 2]) {
    let size = nominal_m_s2.length();
    let Some(down) = nominal_m_s2.try_normalize() else {
        return (nominal_m_s2, [DVec3::ZERO; 2]);
    };
    let (a, b) = down.any_orthonormal_pair();
    let long = down + a * angles_rad[0] + b * angles_rad[1];
    let length = long.length();
    let turned = long / length;
    let by = |side: DVec3| (side - turned * turned.dot(side)) * (size / length);
    (turned * size, [by(a), by(b)])
}
