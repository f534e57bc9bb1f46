//! What the motion of a trial asks of the limbs: a wrench per mass for each of its series, and how it depends on the unknowns.
//!
//! With n the direction of travel and axis, r from the axis to the mass's centre and g gravity in the sensor at rest, the
//! specific force and Euler's torque about that centre, of a motion along or about n, are
//!
//! | series | force per mass | torque per mass |
//! |---|---|---|
//! | a | n | 0 |
//! | -a'' | 1/(k/m) times G \[n, 0\], as far as it moves | I/m times what it turns |
//! | w' | n x r | (I/m) n |
//! | w^2 | n x (n x r) | n x (I/m) n |
//! | sin theta | n x g | 0 |
//! | 1 - cos theta | g - n (n . g) | 0 |
//!
//! Limbs end on the cube: about its centre, from which the mass's is c, a force F has the torque c x F besides. I/m is about the mass's
//! own. The limbs share it ([`StaticLoadSharing`]), and channels show each other's shares ([`Unknowns::shown`]).

use alloc::vec;
use alloc::vec::Vec;

use glam::DVec3;

use super::own::{Kind, plumb};
use super::trial::{Drive, Trial};
use super::unknowns::{
    COMPLIANCE, INERTIA, MASS_CENTRE, OTHERS, STIFFNESS, Unknowns, inertia_entry,
};
use crate::geometry::LIMBS;
use crate::identify::static_load_sharing::StaticLoadSharing;

/// Force and torque over the mass, per unit of a series.
type Wrench = [DVec3; 2];

/// A series' wrench and its derivatives by unknowns, common or, behind them, own.
struct Load {
    wrench: Wrench,
    slopes: Vec<(usize, Wrench)>,
}

impl Load {
    /// The same with the torque about the cube's centre, from which the mass's is c.
    fn about_the_cubes_centre(mut self, c: DVec3) -> Self {
        let [force, _] = self.wrench;
        let about = |[force, torque]: Wrench| [force, torque + c.cross(force)];
        self.wrench = about(self.wrench);
        for (_, slope) in &mut self.slopes {
            *slope = about(*slope);
        }
        let by_centre = DVec3::AXES.map(|axis| [DVec3::ZERO, axis.cross(force)]);
        self.slopes.extend((MASS_CENTRE..).zip(by_centre));
        self
    }
}

/// A series' share in each channel and how it depends on the unknowns.
pub(super) struct Share {
    /// Per unit of the series, m/s^2 of limb force over mass.
    pub value: [f64; LIMBS],
    /// Derivatives by unknowns that concern all channels.
    pub slopes: Vec<(usize, [f64; LIMBS])>,
    /// The limbs' forces themselves, which are the derivatives by the cross-talk.
    forces: [f64; LIMBS],
}

impl Share {
    /// Derivatives of one channel by its cross-talk.
    pub fn by_cross_talk(&self, into: usize) -> [(usize, f64); OTHERS] {
        core::array::from_fn(|other| {
            let from = if other < into { other } else { other + 1 };
            (Unknowns::cross_talk(into, from), self.forces[from])
        })
    }
}

impl Trial {
    /// Share of each series in each channel; none if the limbs' stiffnesses do not hold the mass.
    pub(super) fn shares(
        &self,
        unknowns: &Unknowns,
        nominal: &StaticLoadSharing,
    ) -> Option<Vec<Share>> {
        let sharing = nominal.with_stiffness(&unknowns.stiffness_ratio())?;
        let loads = match self.drive {
            Drive::Linear => self.linear_loads(unknowns, &sharing),
            Drive::Angular => self.angular_loads(unknowns),
        };
        let centre = unknowns.mass_centre_m();
        let of = |load: Load| {
            let load = load.about_the_cubes_centre(centre);
            let [force, torque] = load.wrench;
            let forces = sharing.of_wrench(force, torque);
            let mut slopes: Vec<(usize, [f64; LIMBS])> = load
                .slopes
                .iter()
                .map(|(unknown, [force, torque])| {
                    (
                        *unknown,
                        unknowns.shown(&sharing.of_wrench(*force, *torque)),
                    )
                })
                .collect();
            slopes.extend((0..LIMBS).map(|limb| {
                let by = sharing.of_wrench_by_stiffness(limb, force, torque);
                (STIFFNESS + limb, unknowns.shown(&by))
            }));
            Share {
                value: unknowns.shown(&forces),
                slopes,
                forces,
            }
        };
        Some(loads.into_iter().map(of).collect())
    }

    fn linear_loads(&self, unknowns: &Unknowns, sharing: &StaticLoadSharing) -> Vec<Load> {
        let tensor = unknowns.inertia().matrix_mass_m2();
        let (n, sideways) = unknowns.direction(self.wedge);
        let angles = unknowns.angles(self.wedge);
        let compliance = unknowns.values[COMPLIANCE];
        let resisted = |[moved, turned]: [DVec3; 2]| [moved, tensor * turned];
        let given_way = |direction| resisted(sharing.given_way(direction, DVec3::ZERO));
        let times = |factor: f64, [force, torque]: Wrench| [force * factor, torque * factor];
        let turned = sharing.given_way(n, DVec3::ZERO)[1];
        let mut slopes = vec![(COMPLIANCE, given_way(n))];
        slopes.extend((0..6).map(|j| {
            let by = inertia_entry(j) * turned * compliance;
            (INERTIA + j, [DVec3::ZERO, by])
        }));
        slopes.extend((0..2).map(|side| {
            let by = times(compliance, given_way(sideways[side]));
            (angles + side, by)
        }));
        slopes.extend((0..LIMBS).map(|limb| {
            let by = resisted(sharing.given_way_by_stiffness(limb, n, DVec3::ZERO));
            (STIFFNESS + limb, times(compliance, by))
        }));
        vec![
            Load {
                wrench: [n, DVec3::ZERO],
                slopes: (0..2)
                    .map(|side| (angles + side, [sideways[side], DVec3::ZERO]))
                    .collect(),
            },
            Load {
                wrench: times(compliance, given_way(n)),
                slopes,
            },
        ]
    }

    fn angular_loads(&self, unknowns: &Unknowns) -> Vec<Load> {
        let tensor = unknowns.inertia().matrix_mass_m2();
        let (n, sideways) = unknowns.direction(self.wedge);
        let angles = unknowns.angles(self.wedge);
        let axes = unknowns.wedges[self.wedge].sideways;
        let r: DVec3 = (0..2)
            .map(|side| axes[side] * self.own_value(Kind::Centre(side)))
            .sum();
        let mut tangential: Vec<(usize, Wrench)> = (0..6)
            .map(|j| (INERTIA + j, [DVec3::ZERO, inertia_entry(j) * n]))
            .collect();
        let mut quadratic: Vec<(usize, Wrench)> = (0..6)
            .map(|j| (INERTIA + j, [DVec3::ZERO, n.cross(inertia_entry(j) * n)]))
            .collect();
        for (side, b) in sideways.into_iter().enumerate() {
            tangential.push((angles + side, [b.cross(r), tensor * b]));
            let force = b.cross(n.cross(r)) + n.cross(b.cross(r));
            let torque = b.cross(tensor * n) + n.cross(tensor * b);
            quadratic.push((angles + side, [force, torque]));
            if let Some(own) = self.own_place(Kind::Centre(side)) {
                let by = n.cross(axes[side]);
                tangential.push((unknowns.len() + own, [by, DVec3::ZERO]));
                quadratic.push((unknowns.len() + own, [n.cross(by), DVec3::ZERO]));
            }
        }
        let mut loads = vec![
            Load {
                wrench: [n.cross(r), tensor * n],
                slopes: tangential,
            },
            Load {
                wrench: [n.cross(n.cross(r)), n.cross(tensor * n)],
                slopes: quadratic,
            },
        ];
        if self.gravity_turns {
            loads.extend(self.weight_loads(unknowns, n, sideways));
        }
        loads
    }

    /// Gravity square to the axis and in it.
    fn weight_loads(&self, unknowns: &Unknowns, n: DVec3, sideways: [DVec3; 2]) -> [Load; 2] {
        let angles = unknowns.angles(self.wedge);
        let nominal = unknowns.wedges[self.wedge].nominal;
        let size = self.gravity_m_s2.length();
        let by_turn = plumb(nominal, self.gravity_m_s2).map(|direction| direction * size);
        // A wedge that misses its direction carries along what gravity has along the axis.
        let along = self.gravity_m_s2.dot(nominal);
        let g = (0..2).fold(self.gravity_m_s2 + (n - nominal) * along, |g, side| {
            g + by_turn[side] * self.own_value(Kind::Plumb(side))
        });
        let force_alone = |force: DVec3| [force, DVec3::ZERO];
        let slopes = |by_direction: &dyn Fn(DVec3) -> DVec3,
                      by_gravity: &dyn Fn(DVec3) -> DVec3| {
            let mut slopes: Vec<(usize, Wrench)> = (0..2)
                .map(|side| (angles + side, force_alone(by_direction(sideways[side]))))
                .collect();
            for (side, dg) in by_turn.into_iter().enumerate() {
                if let Some(own) = self.own_place(Kind::Plumb(side)) {
                    slopes.push((unknowns.len() + own, force_alone(by_gravity(dg))));
                }
            }
            slopes
        };
        let square = |g: DVec3| g - n * n.dot(g);
        [
            Load {
                wrench: force_alone(n.cross(g)),
                slopes: slopes(&|b| b.cross(g) + n.cross(b * along), &|dg| n.cross(dg)),
            },
            Load {
                wrench: force_alone(square(g)),
                slopes: slopes(
                    &|b| square(b * along) - (b * n.dot(g) + n * b.dot(g)),
                    &square,
                ),
            },
        ]
    }
}
