//! What the instruments and wedges turned out to be: the unknowns of the joint fit beside the 25.

use serde::Serialize;
use sixaxis_core::identify::joint::Known;
use sixaxis_core::identify::joint::estimate::TrialEstimate;
use sixaxis_core::identify::joint::unknowns::{
    AMPLIFIER_CORNER, ANGLES, GYROSCOPE_GAIN, GYROSCOPE_LAG, MASS_CENTRE, ROD_MASS,
};

use super::JointReport;

/// A wedge as it was made.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WedgeFound {
    /// Unit vector that it is meant to set, sensor axes at rest.
    pub nominal: [f64; 3],
    /// Unit vector that it sets.
    pub direction: [f64; 3],
    /// Angles by which it misses its direction, degrees; none where the session says that wedges are right.
    pub angles_deg: Option<[Known; ANGLES]>,
}

/// The room as the trials show it. Spreads are standard deviations.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RoomFound {
    /// Of the limbs' stiffnesses, relative.
    pub stiffness_spread: f64,
    /// Of the shares that channels side by side show of each other.
    pub cross_talk_beside_spread: f64,
    /// Of those that other channels show.
    pub cross_talk_apart_spread: f64,
    /// Of a channel's sensitivity from trial to trial, relative.
    pub sensitivity_spread: f64,
    /// Of each of a wedge's angles, degrees.
    pub wedge_spread_deg: f64,
    /// From the cube's centre to that of its mass, sensor axes, m; none where nothing speaks against one place.
    pub mass_centre_m: Option<[Known; 3]>,
    /// Half a limb's mass over the seismic mass; none where nothing speaks against limbs without mass.
    pub rod_mass: Option<Known>,
    /// Farthest that the mass's centre is from the axis in any trial, m.
    pub centre_off_axis_m: f64,
    /// Most that gravity is off where the session has it, degrees.
    pub off_plumb_deg: f64,
}

/// Everything beside the 25. The certificates' priors are included in the deviations.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Nuisances {
    /// What nobody states.
    pub room: RoomFound,
    /// Reading over truth of the standard accelerometer, less one.
    pub accelerometer_gain: Known,
    /// Whether the trials say more of that than the certificate.
    pub accelerometer_gain_is_told: bool,
    /// Reading over truth of the standard gyroscope, less one.
    pub gyroscope_gain: Option<Known>,
    /// Lag of the gyroscope, s; none if it is said to follow at once.
    pub gyroscope_lag_s: Option<Known>,
    /// Corner of the charge amplifiers' high-pass, Hz; none if the session states none.
    pub amplifier_corner_hz: Option<Known>,
    /// The wedges in the order in which the session first uses them.
    pub wedges: Vec<WedgeFound>,
}

/// Share of the certificate's spread below which the trials are what tells.
const TOLD: f64 = 0.5;

impl JointReport {
    /// What the fit found beside the 25.
    pub fn nuisances(&self) -> Nuisances {
        let unknowns = &self.estimate.unknowns;
        let wedges = unknowns
            .wedges
            .iter()
            .enumerate()
            .map(|(index, wedge)| {
                let at = unknowns.angles(index);
                let angles: [Option<Known>; ANGLES] = core::array::from_fn(|j| {
                    Some(times(1.0_f64.to_degrees(), self.found(at + j)?))
                });
                WedgeFound {
                    nominal: wedge.nominal.to_array(),
                    direction: unknowns.direction(index).0.to_array(),
                    angles_deg: match angles {
                        [Some(a), Some(b)] => Some([a, b]),
                        _ => None,
                    },
                }
            })
            .collect();
        let mass_centre: [Option<Known>; 3] =
            core::array::from_fn(|axis| self.found(MASS_CENTRE + axis));
        let trials = &self.estimate.trials;
        let farthest = |of: fn(&TrialEstimate) -> Option<[Known; 2]>| {
            let sizes = trials.iter().filter_map(of);
            sizes
                .map(|[a, b]| a.value.hypot(b.value))
                .fold(0.0, f64::max)
        };
        let spreads = &self.estimate.spreads;
        Nuisances {
            room: RoomFound {
                stiffness_spread: spreads.stiffness,
                cross_talk_beside_spread: spreads.cross_talk_beside,
                cross_talk_apart_spread: spreads.cross_talk_apart,
                sensitivity_spread: spreads.sensitivity,
                wedge_spread_deg: spreads.wedge_rad.to_degrees(),
                mass_centre_m: match mass_centre {
                    [Some(x), Some(y), Some(z)] => Some([x, y, z]),
                    _ => None,
                },
                rod_mass: self.found(ROD_MASS),
                centre_off_axis_m: farthest(|trial| trial.centre_m),
                off_plumb_deg: farthest(|trial| trial.plumb).to_degrees(),
            },
            accelerometer_gain: Known {
                value: self.gain.mean(),
                deviation: self.gain.deviation(),
            },
            accelerometer_gain_is_told: self.gain_is_told(),
            gyroscope_gain: self.found(GYROSCOPE_GAIN),
            gyroscope_lag_s: self.found(GYROSCOPE_LAG),
            amplifier_corner_hz: self
                .found(AMPLIFIER_CORNER)
                .map(|found| times(1.0 / core::f64::consts::TAU, found)),
            wedges,
        }
    }

    /// Whether the trials say more of the accelerometer's gain than its certificate does.
    pub fn gain_is_told(&self) -> bool {
        // The deviation of an even spread.
        self.gain.deviation() < TOLD * self.gain.limit / 3.0_f64.sqrt()
    }

    /// An unknown at the accelerometer's gain as it is known.
    pub(super) fn at_known_gain(&self, unknown: usize) -> f64 {
        let slope = self.estimate.by_accelerometer_gain[unknown];
        let moved = self.gain.mean() - self.estimate.accelerometer_gain_held();
        self.estimate.unknowns.values[unknown] + moved * slope
    }

    /// The same with its deviation; none if it was held.
    fn found(&self, unknown: usize) -> Option<Known> {
        let variance = self.estimate.covariance[(unknown, unknown)];
        let slope = self.estimate.by_accelerometer_gain[unknown];
        (variance > 0.0).then(|| Known {
            value: self.at_known_gain(unknown),
            deviation: (self.misfit.wider() * variance.sqrt()).hypot(self.gain.deviation() * slope),
        })
    }
}

fn times(factor: f64, known: Known) -> Known {
    Known {
        value: factor * known.value,
        deviation: factor * known.deviation,
    }
}
