//! One trial: its data and what the model makes of its motion.
//!
//! With H the amplifier's response and X_m = H phi_m the series as the amplifier passes them on, channel i is
//!
//! ```text
//! z_i = (d_i + u_i) sqrt(N) e_0 + (1 + h_i) (m/s_i)/c_i sum_m C_im X_m(q) + b_i E + noise,
//! ```
//!
//! u_i and h_i being what zero and sensitivity have moved by, b_i E what is left of the amplifier's own transient, and the standard
//! is (1 + gamma) A q + noise, A its lag. The coefficients C are in [`super::load`]. A channel that is behind the standards is brought
//! forward before it is compared: its harmonics are turned by w_k times its delay, which leaves noise as white as it was.

use alloc::borrow::Cow;
use alloc::vec;
use alloc::vec::Vec;

use glam::DVec3;
use nalgebra::{Complex, DVector};

use super::Known;
use super::colour::Near;
use super::ends::Elsewhere;
use super::estimate::TrialEstimate;
use super::harmonics::{Grid, Projection, harmonic};
use super::load::Share;
use super::motion::{self, Operator, Series};
use super::own::{Kind, Own};
use super::standard::Standard;
use super::unknowns::{AMPLIFIER_CORNER, DRIFT, MASS_PER_SCALE, Unknowns};
use crate::float::{exp, sin_cos, sqrt};
use crate::geometry::LIMBS;
use crate::identify::static_load_sharing::StaticLoadSharing;
use crate::model::Gains;

/// What the rig does in a trial.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Drive {
    /// Moves the sensor along the wedge's direction; the standard is the accelerometer.
    Linear,
    /// Turns it about that direction; the standard is the gyroscope.
    Angular,
}

/// A trial, projected on its harmonics.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Trial {
    pub drive: Drive,
    pub grid: Grid,
    pub gains: Gains,
    /// Nine channels, then the standard.
    pub data: Projection<{ LIMBS + 1 }>,
    /// Noise beside the fitted harmonics, where there is enough to tell.
    pub near: Option<Near>,
    /// Variance of the noise in the fit over [`Self::data`]'s.
    pub louder: [f64; LIMBS + 1],
    pub wedge: usize,
    /// Gravity with the wedge as it is meant to be, m/s^2.
    pub gravity_m_s2: DVec3,
    pub gravity_turns: bool,
    /// Whether the amplifiers are high-passes.
    pub amplifier: bool,
    /// First-order lag of the standard accelerometer, s: known.
    pub accelerometer_lag_s: f64,
    /// Delays of the standard accelerometer and gyroscope, s: known.
    pub standard_delay_s: [f64; 2],
    /// What is known of the angle at which it ends, if that is not the one at which it began.
    pub elsewhere: Option<Elsewhere>,
    /// Harmonics of the motion, and its mean if it ends elsewhere: unknowns of this trial alone.
    pub latent: DVector<f64>,
    /// The other unknowns of this trial alone.
    pub own: Vec<Own>,
}

/// A combination of a trial's parts: their places and weights.
pub(super) type Combination = Vec<(usize, f64)>;

/// Everything that the channels of a trial are combinations of, at the present motion.
pub(super) struct Parts {
    /// The drift's part, then the series, then what they change by in a second that a channel is late, then their derivatives by the
    /// amplifier's corner, its transient and its derivative. Delays and corner are there where they are free.
    pub all: Vec<DVector<f64>>,
    /// Whether the delays are.
    late: bool,
    /// Derivatives of the series by the motion.
    pub by_latent: Vec<Operator>,
    /// Shares of the series in the channels.
    pub shares: Vec<Share>,
}

impl Trial {
    /// Variance of a channel's noise in the fit; behind the limbs the standard's.
    pub fn noise_variance(&self, channel: usize) -> f64 {
        self.data.variance[channel] * self.louder[channel]
    }

    /// Place of an own unknown; none if the trial does not have it.
    pub fn own_place(&self, kind: Kind) -> Option<usize> {
        self.own.iter().position(|own| own.kind == kind)
    }

    /// What is measured of it: nine channels and the standard, and what is known of its own unknowns beforehand.
    pub fn measured(&self) -> usize {
        let known = self.own.iter().filter(|own| own.deviation.is_finite());
        10 * self.grid.coordinates() - usize::from(self.elsewhere.is_none()) + known.count()
    }

    /// What is fitted to that alone.
    pub fn fitted(&self) -> usize {
        self.latent.len() + self.own.len()
    }

    /// What became of the own unknowns, of which these are the variances, with such squares left.
    pub fn estimate(&self, variances: &[f64], squares: f64) -> TrialEstimate {
        let known = |kind| {
            self.own_place(kind).map(|at| Known {
                value: self.own[at].value,
                deviation: sqrt(variances[at]),
            })
        };
        let pair = |[a, b]: [Option<Known>; 2]| Some([a?, b?]);
        TrialEstimate {
            wedge: self.wedge,
            excess: squares - self.measured().saturating_sub(self.fitted()) as f64,
            zero_v: core::array::from_fn(|limb| known(Kind::Zero(limb)).unwrap_or(Known::HELD)),
            sensitivity: core::array::from_fn(|limb| {
                known(Kind::Sensitivity(limb)).unwrap_or(Known::HELD)
            }),
            centre_m: pair([0, 1].map(|side| known(Kind::Centre(side)))),
            plumb: pair([0, 1].map(|side| known(Kind::Plumb(side)))),
        }
    }

    /// Value of an own unknown; 0 if the trial does not have it.
    pub fn own_value(&self, kind: Kind) -> f64 {
        self.own_place(kind).map_or(0.0, |at| self.own[at].value)
    }

    /// H and dH by the corner: at the mean and at each harmonic.
    fn amplifier(&self, corner_rad_s: f64) -> (f64, Vec<Complex<f64>>, Vec<Complex<f64>>) {
        let one = Complex::new(1.0, 0.0);
        if !self.amplifier {
            let count = self.grid.harmonics;
            return (1.0, vec![one; count], vec![one * 0.0; count]);
        }
        let (h, dh) = (1..=self.grid.harmonics)
            .map(|k| {
                let iw = Complex::new(0.0, self.grid.rate_rad_s(k));
                let through = iw / (iw + corner_rad_s);
                (through, -through / (iw + corner_rad_s))
            })
            .unzip();
        (0.0, h, dh)
    }

    /// E, the coordinates of exp(-corner t), and its derivative by the corner: sums of geometric series.
    fn decay(&self, corner_rad_s: f64) -> [DVector<f64>; 2] {
        let grid = &self.grid;
        let samples = grid.samples as f64;
        let per_sample = corner_rad_s * grid.step_s;
        let end = exp(-per_sample * samples);
        let one = Complex::new(1.0, 0.0);
        let sums = |k: usize| {
            let (sin, cos) = sin_cos(grid.rate_rad_s(k) * grid.step_s);
            let ratio = Complex::new(cos, -sin) * exp(-per_sample);
            let rest = one / (one - ratio);
            let sum = rest * (1.0 - end);
            let slope = (rest * (samples * end) - sum * ratio * rest) * grid.step_s;
            [sum, slope]
        };
        [0, 1].map(|which| {
            let z: Vec<Complex<f64>> = (1..=grid.harmonics)
                .map(|k| sums(k)[which] * sqrt(2.0 / samples))
                .collect();
            grid.vector(sums(0)[which].re / sqrt(samples), &z)
        })
    }

    fn series(&self) -> Vec<Series> {
        match self.drive {
            Drive::Linear => motion::linear(&self.grid, &self.latent).into(),
            Drive::Angular => motion::angular(&self.grid, &self.latent, self.gravity_turns),
        }
    }

    /// Motion as the standard alone shows it.
    pub fn start(&mut self, unknowns: &Unknowns) {
        let Standard { response, gain, .. } = self.standard(unknowns);
        let shown = &self.data.coordinates[LIMBS];
        for (k, r) in response.iter().enumerate() {
            let z = Complex::new(shown[2 * k + 1], shown[2 * k + 2])
                / (r * (1.0 + unknowns.values[gain]));
            self.latent[2 * k] = z.re;
            self.latent[2 * k + 1] = z.im;
        }
        if let Some(mean) = self.mean_shown() {
            self.latent[2 * self.grid.harmonics] = mean.value / (1.0 + unknowns.values[gain]);
        }
    }

    /// The mean coordinate that the standard shows, its zero taken off: that of a trial that ends elsewhere.
    pub fn mean_shown(&self) -> Option<Known> {
        let root_n = sqrt(self.grid.samples as f64);
        self.elsewhere.map(|ends| Known {
            value: ends.mean_rate_rad_s.value * root_n,
            deviation: ends.mean_rate_rad_s.deviation * root_n * sqrt(self.louder[LIMBS]),
        })
    }

    /// What the channels are combined of at the present motion; none if the limbs' stiffnesses do not hold the mass.
    pub fn parts(&self, unknowns: &Unknowns, shares: &StaticLoadSharing) -> Option<Parts> {
        let corner = unknowns.values[AMPLIFIER_CORNER];
        let (h_mean, h, dh) = self.amplifier(corner);
        let series = self.series();
        let mut offset = DVector::zeros(self.grid.coordinates());
        offset[0] = sqrt(self.grid.samples as f64);
        let mut all = vec![offset];
        all.extend(series.iter().map(|s| filtered(&s.value, h_mean, &h)));
        let late = unknowns.delay(0).is_some();
        let slope: Vec<Complex<f64>> = (1..=self.grid.harmonics)
            .map(|k| Complex::new(0.0, -self.grid.rate_rad_s(k)))
            .collect();
        if late {
            let slopes: Vec<_> = all[1..].iter().map(|p| filtered(p, 0.0, &slope)).collect();
            all.extend(slopes);
        }
        if self.amplifier {
            all.extend(series.iter().map(|s| filtered(&s.value, 0.0, &dh)));
            let decay = self.decay(corner);
            if late {
                all.push(filtered(&decay[0], 0.0, &slope));
            }
            all.extend(decay);
        }
        Some(Parts {
            all,
            late,
            by_latent: series
                .into_iter()
                .map(|s| s.by_latent.filtered(h_mean, &h))
                .collect(),
            shares: self.shares(unknowns, shares)?,
        })
    }

    /// A channel's coordinates as it showed them, brought forward by its delay.
    pub fn shown(&self, unknowns: &Unknowns, limb: usize) -> Cow<'_, DVector<f64>> {
        let shown = &self.data.coordinates[limb];
        match unknowns.delay(limb) {
            None => Cow::Borrowed(shown),
            Some(delay) => Cow::Owned(self.sooner(shown, unknowns.values[delay])),
        }
    }

    /// Coordinates of what comes a time sooner. A record is one period of what it shows: it begins and ends at rest. The step of one that
    /// ends elsewhere is moved along with the rest, by less than a sample.
    pub fn sooner(&self, v: &DVector<f64>, by_s: f64) -> DVector<f64> {
        let turns: Vec<Complex<f64>> = (1..=self.grid.harmonics)
            .map(|k| {
                let (sin, cos) = sin_cos(self.grid.rate_rad_s(k) * by_s);
                Complex::new(cos, sin)
            })
            .collect();
        filtered(v, 1.0, &turns)
    }

    /// A channel's coordinates as the model has them, were it not behind the standards.
    pub fn prediction(&self, unknowns: &Unknowns, parts: &Parts, limb: usize) -> DVector<f64> {
        let gain = self.volts_per_force(unknowns, limb);
        let zero_v = unknowns.values[DRIFT + limb] + self.own_value(Kind::Zero(limb));
        let mut z = &parts.all[0] * zero_v;
        for (part, share) in parts.all[1..].iter().zip(&parts.shares) {
            z.axpy(gain * share.value[limb], part, 1.0);
        }
        if self.amplifier {
            let transient_v = self.own_value(Kind::Transient(limb));
            z.axpy(transient_v, &parts.all[parts.decay()], 1.0);
        }
        z
    }

    /// The standard's coordinates as the model has them; of its mean, which is its own offset, it knows nothing and takes what
    /// it is.
    pub fn standard_prediction(&self, unknowns: &Unknowns) -> DVector<f64> {
        let Standard { response, gain, .. } = self.standard(unknowns);
        let reading = 1.0 + unknowns.values[gain];
        let z: Vec<Complex<f64>> = response
            .iter()
            .enumerate()
            .map(|(k, r)| r * Complex::new(self.latent[2 * k], self.latent[2 * k + 1]) * reading)
            .collect();
        self.grid.vector(self.data.coordinates[LIMBS][0], &z)
    }

    /// (1 + h_i)/c_i, V/N.
    fn volts_per_newton(&self, limb: usize) -> f64 {
        (1.0 + self.own_value(Kind::Sensitivity(limb))) / self.gains.gain_n_per_v[limb]
    }

    /// (1 + h_i) (m/s_i)/c_i, V per m/s^2.
    pub fn volts_per_force(&self, unknowns: &Unknowns, limb: usize) -> f64 {
        unknowns.values[MASS_PER_SCALE + limb] * self.volts_per_newton(limb)
    }

    /// Derivatives of a channel by the common unknowns and, behind them, by the trial's own.
    pub fn columns(
        &self,
        unknowns: &Unknowns,
        parts: &Parts,
        limb: usize,
    ) -> Vec<(usize, Combination)> {
        let gain = self.volts_per_force(unknowns, limb);
        let shape = |factor: f64| -> Combination {
            let shares = parts.shares.iter().enumerate();
            shares
                .map(|(m, share)| (1 + m, factor * share.value[limb]))
                .collect()
        };
        let mut columns = vec![
            (DRIFT + limb, vec![(0, 1.0)]),
            (MASS_PER_SCALE + limb, shape(self.volts_per_newton(limb))),
        ];
        let mut add =
            |unknown: usize, entry: (usize, f64)| match columns.iter_mut().find(|c| c.0 == unknown)
            {
                Some(column) => column.1.push(entry),
                None => columns.push((unknown, vec![entry])),
            };
        for (m, share) in parts.shares.iter().enumerate() {
            for (unknown, slope) in &share.slopes {
                add(*unknown, (1 + m, gain * slope[limb]));
            }
            for (unknown, slope) in share.by_cross_talk(limb) {
                add(unknown, (1 + m, gain * slope));
            }
        }
        let series = parts.shares.len();
        if let Some(delay) = unknowns.delay(limb) {
            for (part, share) in shape(gain) {
                add(delay, (part + series, share));
            }
            if self.amplifier {
                let transient_v = self.own_value(Kind::Transient(limb));
                add(delay, (parts.decay() - 1, transient_v));
            }
        }
        if self.amplifier {
            let before = if parts.late { 2 * series } else { series };
            for (part, share) in shape(gain) {
                add(AMPLIFIER_CORNER, (part + before, share));
            }
            let transient_v = self.own_value(Kind::Transient(limb));
            add(AMPLIFIER_CORNER, (parts.decay() + 1, transient_v));
        }
        let own = |kind| Some(unknowns.len() + self.own_place(kind)?);
        if let Some(zero) = own(Kind::Zero(limb)) {
            columns.push((zero, vec![(0, 1.0)]));
        }
        if let Some(sensitivity) = own(Kind::Sensitivity(limb)) {
            let usual = gain / (1.0 + self.own_value(Kind::Sensitivity(limb)));
            columns.push((sensitivity, shape(usual)));
        }
        if let Some(transient) = own(Kind::Transient(limb)) {
            columns.push((transient, vec![(parts.decay(), 1.0)]));
        }
        columns
    }
}

impl Parts {
    /// Place of the amplifier's transient, before its derivative by the corner.
    fn decay(&self) -> usize {
        self.all.len() - 2
    }
}

fn filtered(v: &DVector<f64>, mean: f64, factors: &[Complex<f64>]) -> DVector<f64> {
    let mut out = v.clone();
    out[0] *= mean;
    for (k, f) in factors.iter().enumerate() {
        let z = harmonic(v, k + 1) * f;
        out[2 * k + 1] = z.re;
        out[2 * k + 2] = z.im;
    }
    out
}
