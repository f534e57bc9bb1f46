//! Motions that go on for an hour: turned and shaken, with or without rests, by hand or as a vehicle is.
//!
//! Nothing is kept of what has gone by, so that an hour needs no more memory than a second. The attitude is that of the rate, by
//! Magnus' series of fourth order in each sample interval.

use core::f64::consts::{PI, TAU};

use glam::{DQuat, DVec3};
use rand::{Rng, RngExt};

use super::tumble::{SINES, Sine, sum};
use crate::motion::{Motion, TrueMotion};
use crate::smooth_step::smooth_step;

/// Gauss' two points in an interval, from its middle, over its length.
const GAUSS: f64 = 0.288_675_134_594_812_9;

/// What kind of motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// Where it is put, for ever.
    Still,
    /// Turned by hand about all axes, and at rest for one second in ten.
    TumbleWithRests,
    /// Shaken on a bench about where it stands, without rests.
    Shaken,
    /// Fast and far, with turns of a minute.
    Vehicle,
    /// From one place to another and still there, as a robot's hand.
    PickAndPlace,
}

impl Kind {
    /// All of them.
    pub const ALL: [Self; 5] = [
        Self::Still,
        Self::TumbleWithRests,
        Self::Shaken,
        Self::Vehicle,
        Self::PickAndPlace,
    ];

    /// Frequencies from and to, Hz, largest velocity of a sine, m/s, and largest rate of one, rad/s.
    const fn sizes(self) -> [(f64, f64, f64); 2] {
        match self {
            Self::Still => [(0.5, 1.0, 0.0), (0.5, 1.0, 0.0)],
            Self::TumbleWithRests => [(0.3, 1.5, 0.15), (0.2, 1.0, 0.8)],
            Self::Shaken => [(0.5, 3.0, 0.1), (0.5, 2.0, 0.4)],
            Self::Vehicle => [(0.01, 0.05, 4.0), (0.01, 0.05, 0.05)],
            Self::PickAndPlace => [(0.3, 0.8, 0.3), (0.3, 0.8, 0.5)],
        }
    }

    /// Time over which it rises from rest and falls to rest, s.
    const fn rise_s(self) -> f64 {
        match self {
            Self::Vehicle => 20.0,
            _ => 1.0,
        }
    }

    /// Time from one rest to the next and how long it lasts, s.
    const fn rests(self) -> Option<(f64, f64)> {
        match self {
            Self::TumbleWithRests => Some((10.0, 1.0)),
            Self::PickAndPlace => Some((4.0, 1.0)),
            Self::Still | Self::Shaken | Self::Vehicle => None,
        }
    }
}

/// A motion of a kind.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Journey {
    kind: Kind,
    position_ground_m: [Sine; SINES],
    rate_shell_rad_s: [Sine; SINES],
    gravity_ground_m_s2: DVec3,
}

impl Journey {
    /// Drawn.
    pub fn random(kind: Kind, rng: &mut impl Rng) -> Self {
        let mut sines = |(low, high, size): (f64, f64, f64), per_rate: i32| {
            core::array::from_fn(|_| {
                let frequency_hz = rng.random_range(low..high);
                let scale = size / (TAU * frequency_hz).powi(per_rate);
                let mut three = |from: f64, to: f64| {
                    DVec3::from_array(core::array::from_fn(|_| rng.random_range(from..to)))
                };
                Sine {
                    amplitude: three(0.3, 1.0) * scale,
                    frequency_hz,
                    phase_rad: three(-PI, PI),
                }
            })
        };
        let [linear, angular] = kind.sizes();
        Self {
            kind,
            position_ground_m: sines(linear, 1),
            rate_shell_rad_s: sines(angular, 0),
            gravity_ground_m_s2: DVec3::new(0.0, 0.0, -crate::paper::GRAVITY_M_S2),
        }
    }

    /// g, ground axes, which are the sensor's at the start, m/s^2.
    pub const fn gravity_ground_m_s2(&self) -> DVec3 {
        self.gravity_ground_m_s2
    }

    /// Share of the motion that is let in at a time, and its first two derivatives. The first half second is at rest in any case.
    fn window(&self, time_s: f64) -> [f64; 3] {
        let rise_s = self.kind.rise_s();
        let up = |since: f64| {
            let [_, w, dw, ddw] = smooth_step(since / rise_s);
            [w, dw / rise_s, ddw / (rise_s * rise_s)]
        };
        let Some((period, rest)) = self.kind.rests() else {
            return up(time_s - 0.5);
        };
        let phase = time_s.rem_euclid(period);
        let falls = period - rise_s;
        if phase < falls {
            up(phase - rest)
        } else {
            let [w, dw, ddw] = up(phase - falls);
            [1.0 - w, -dw, -ddw]
        }
    }

    fn rate(&self, time_s: f64) -> [DVec3; 2] {
        let [w, dw, _] = self.window(time_s);
        let [r, dr, _] = sum(&self.rate_shell_rad_s, time_s);
        [w * r, dw * r + w * dr]
    }

    fn linear_m_s2(&self, time_s: f64) -> DVec3 {
        let [w, dw, ddw] = self.window(time_s);
        let [p, dp, ddp] = sum(&self.position_ground_m, time_s);
        ddw * p + 2.0 * dw * dp + w * ddp
    }

    /// All samples from the start on, without an end.
    pub fn play(&self, sample_rate_hz: f64) -> impl Iterator<Item = TrueMotion> + '_ {
        let step_s = 1.0 / sample_rate_hz;
        let mut attitude = DQuat::IDENTITY;
        (0_u64..).map(move |sample| {
            let time_s = sample as f64 * step_s;
            let here = attitude;
            let [a, b] = [-GAUSS, GAUSS].map(|x| self.rate(time_s + (0.5 + x) * step_s)[0]);
            let turn = 0.5 * step_s * (a + b) + GAUSS * 0.5 * step_s * step_s * a.cross(b);
            attitude = (attitude * DQuat::from_scaled_axis(turn)).normalize();
            let [rate, angular] = self.rate(time_s);
            TrueMotion {
                linear_ground_m_s2: self.linear_m_s2(time_s),
                angular_ground_rad_s2: here * angular,
                rate_shell_rad_s: rate,
                attitude: here,
            }
        })
    }
}

impl Motion for Journey {
    fn acceleration(&self, time_s: f64) -> (DVec3, DVec3) {
        (self.linear_m_s2(time_s), self.rate(time_s)[1])
    }
}
