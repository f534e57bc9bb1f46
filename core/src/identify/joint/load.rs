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
//!
//! A limb with mass shows, beside its share, what accelerates half of itself: mu e_i . (F + G (p_i - c)), mu being half its mass over the
//! seismic one, p_i its middle and G what the specific force has more of a metre from the mass's centre, \[n\]x of w' and \[n\]x^2 of w^2.
//! What the mass's motion in the shell adds to that is left out: mu of 1e-5.

use alloc::vec;
use alloc::vec::Vec;

use glam::{DMat3, DVec3};

use super::own::{Kind, plumb};
use super::trial::{Drive, Trial};
use super::unknowns::{
    COMPLIANCE, INERTIA, MASS_CENTRE, OTHERS, ROD_MASS, STIFFNESS, Unknowns, inertia_entry,
};
use crate::columns::cross;
use crate::geometry::LIMBS;
use crate::identify::static_load_sharing::StaticLoadSharing;

/// Force and torque over the mass, per unit of a series.
type Wrench = [DVec3; 2];

/// What is asked of the limbs, per unit of a series.
#[derive(Clone, Copy)]
struct Asked {
    wrench: Wrench,
    /// Specific force that limbs themselves are accelerated with: at the centre that the wrench is about, and what it has more of a
    /// metre from there.
    field: (DVec3, DMat3),
}

impl Asked {
    /// Of a mass that moves against its limbs.
    fn of_mass(wrench: Wrench) -> Self {
        let field = (DVec3::ZERO, DMat3::ZERO);
        Self { wrench, field }
    }

    /// Of all that moves with the shell.
    fn of_all([force, torque]: Wrench, gradient: DMat3) -> Self {
        Self {
            wrench: [force, torque],
            field: (force, gradient),
        }
    }

    fn of_force(force: DVec3) -> Self {
        Self::of_all([force, DVec3::ZERO], DMat3::ZERO)
    }

    fn of_torque(torque: DVec3) -> Self {
        Self::of_mass([DVec3::ZERO, torque])
    }

    fn about_the_cubes_centre(self, c: DVec3) -> Self {
        let [force, torque] = self.wrench;
        let (there, gradient) = self.field;
        Self {
            wrench: [force, torque + c.cross(force)],
            field: (there - gradient * c, gradient),
        }
    }

    /// Forces that the limbs show.
    fn shown_by(self, sharing: &StaticLoadSharing, rod_mass: f64) -> [f64; LIMBS] {
        let [force, torque] = self.wrench;
        let (shared, own) = (sharing.of_wrench(force, torque), self.of_rods(sharing));
        core::array::from_fn(|limb| shared[limb] + rod_mass * own[limb])
    }

    /// What a limb of half the seismic mass twice would show of its own.
    fn of_rods(self, sharing: &StaticLoadSharing) -> [f64; LIMBS] {
        sharing.along_limbs(self.field.0, self.field.1)
    }
}

/// What is asked for a series and its derivatives by unknowns, common or, behind them, own.
struct Load {
    asked: Asked,
    slopes: Vec<(usize, Asked)>,
}

impl Load {
    /// The same about the cube's centre, from which the mass's is c.
    fn about_the_cubes_centre(mut self, c: DVec3) -> Self {
        let ([force, _], (_, gradient)) = (self.asked.wrench, self.asked.field);
        self.asked = self.asked.about_the_cubes_centre(c);
        for (_, slope) in &mut self.slopes {
            *slope = slope.about_the_cubes_centre(c);
        }
        let by_centre = DVec3::AXES.map(|axis| Asked {
            wrench: [DVec3::ZERO, axis.cross(force)],
            field: (-(gradient * axis), DMat3::ZERO),
        });
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
        let (centre, rod_mass) = (unknowns.mass_centre_m(), unknowns.values[ROD_MASS]);
        let of = |load: Load| {
            let Load { asked, slopes } = load.about_the_cubes_centre(centre);
            let [force, torque] = asked.wrench;
            let forces = asked.shown_by(&sharing, rod_mass);
            let shown = |by: &[f64; LIMBS]| unknowns.shown(by);
            let mut slopes: Vec<(usize, [f64; LIMBS])> = (slopes.iter())
                .map(|(unknown, slope)| (*unknown, shown(&slope.shown_by(&sharing, rod_mass))))
                .collect();
            slopes.push((ROD_MASS, shown(&asked.of_rods(&sharing))));
            slopes.extend((0..LIMBS).map(|limb| {
                let by = sharing.of_wrench_by_stiffness(limb, force, torque);
                (STIFFNESS + limb, shown(&by))
            }));
            Share {
                value: shown(&forces),
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
        let mut slopes = vec![(COMPLIANCE, Asked::of_mass(given_way(n)))];
        slopes.extend((0..6).map(|j| {
            let by = inertia_entry(j) * turned * compliance;
            (INERTIA + j, Asked::of_torque(by))
        }));
        slopes.extend((0..2).map(|side| {
            let by = times(compliance, given_way(sideways[side]));
            (angles + side, Asked::of_mass(by))
        }));
        slopes.extend((0..LIMBS).map(|limb| {
            let by = resisted(sharing.given_way_by_stiffness(limb, n, DVec3::ZERO));
            (STIFFNESS + limb, Asked::of_mass(times(compliance, by)))
        }));
        vec![
            Load {
                asked: Asked::of_force(n),
                slopes: (0..2)
                    .map(|side| (angles + side, Asked::of_force(sideways[side])))
                    .collect(),
            },
            Load {
                asked: Asked::of_mass(times(compliance, given_way(n))),
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
        let turn = cross(n);
        let mut tangential: Vec<(usize, Asked)> = (0..6)
            .map(|j| (INERTIA + j, Asked::of_torque(inertia_entry(j) * n)))
            .collect();
        let mut quadratic: Vec<(usize, Asked)> = (0..6)
            .map(|j| (INERTIA + j, Asked::of_torque(n.cross(inertia_entry(j) * n))))
            .collect();
        for (side, b) in sideways.into_iter().enumerate() {
            let by_turn = cross(b);
            let tangentially = Asked::of_all([b.cross(r), tensor * b], by_turn);
            tangential.push((angles + side, tangentially));
            let force = b.cross(n.cross(r)) + n.cross(b.cross(r));
            let torque = b.cross(tensor * n) + n.cross(tensor * b);
            let twice = by_turn * turn + turn * by_turn;
            quadratic.push((angles + side, Asked::of_all([force, torque], twice)));
            if let Some(own) = self.own_place(Kind::Centre(side)) {
                let by = n.cross(axes[side]);
                tangential.push((unknowns.len() + own, Asked::of_force(by)));
                quadratic.push((unknowns.len() + own, Asked::of_force(n.cross(by))));
            }
        }
        let mut loads = vec![
            Load {
                asked: Asked::of_all([n.cross(r), tensor * n], turn),
                slopes: tangential,
            },
            Load {
                asked: Asked::of_all([n.cross(n.cross(r)), n.cross(tensor * n)], turn * turn),
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
        let slopes = |by_direction: &dyn Fn(DVec3) -> DVec3,
                      by_gravity: &dyn Fn(DVec3) -> DVec3| {
            let mut slopes: Vec<(usize, Asked)> = (0..2)
                .map(|side| (angles + side, Asked::of_force(by_direction(sideways[side]))))
                .collect();
            for (side, dg) in by_turn.into_iter().enumerate() {
                if let Some(own) = self.own_place(Kind::Plumb(side)) {
                    slopes.push((unknowns.len() + own, Asked::of_force(by_gravity(dg))));
                }
            }
            slopes
        };
        let square = |g: DVec3| g - n * n.dot(g);
        [
            Load {
                asked: Asked::of_force(n.cross(g)),
                slopes: slopes(&|b| b.cross(g) + n.cross(b * along), &|dg| n.cross(dg)),
            },
            Load {
                asked: Asked::of_force(square(g)),
                slopes: slopes(
                    &|b| square(b * along) - (b * n.dot(g) + n * b.dot(g)),
                    &square,
                ),
            },
        ]
    }
}
