//! Whether the limb forces of a recording add up: the three coordination equations on a thinned sample of its rows.
//!
//! Limbs unequal by a few percent break the sums by as much, but for those of which the calibration knows the ratios: sums of strains are zero then. A calibration of another sensor, a channel that is dead, inverted or
//! plugged in elsewhere breaks them by far more, and the accelerations are wrong then without looking so. Of the changes of forces this
//! is asked of all of the recording; of their means, of its beginning: what these leave is the zeros'. A limb that the motion does not load, and plugs exchanged within an
//! ambiguous pair, need not show: of simulated rig runs with one channel dead, four in five compound runs and all linear ones are
//! told, of those with two plugs exchanged two in three.

use sixaxis_core::decouple::uncertainty::ZeroWander;
use sixaxis_core::paper::signal::SignalChain;
use sixaxis_core::redundancy::parity::{COORDINATION, ROWS};
use sixaxis_core::{LIMBS, LimbSet};
use sixaxis_page::number::percent;

use super::Row;
use super::setup::Setup;
use crate::calibration::Calibration;
use crate::grade::COORDINATION_LIMIT;

/// A sum over four forces of the usual size, from which something else than unequal limbs is at work. Measured on simulated runs
/// of the rig: 0.004 with equal limbs, 0.05 at worst with stiffnesses that scatter by 1 %, 0.14 with 3 %; 0.14 to 0.85, in nine of ten,
/// with the calibration of another sensor drawn at random: one pair in nine is below the limit.
const BROKEN: f64 = 2.0 * COORDINATION_LIMIT;
/// The same where the joint fit has found the stiffness ratios. Measured on nine simulated runs in rooms with 3 % of unequal stiffness and 1 %
/// of cross-talk: 0.014 at worst, with cross-talk left in. A gain off by a factor of two in one channel of three runs: 0.016 to 0.62, above the limit in 53 of
/// 54.
const BROKEN_OWN: f64 = 0.03;
/// What limbs with mass leave of a sum by the square of the rate, over half a limb's mass: 3 to 5 in simulated compound runs, which swing by half a turn.
const OF_LIMB_MASS: f64 = 10.0;
/// One row in so many is looked at: six instructions a sample, 0.1 % of what `decouple` takes from file to file. A prime, so that
/// no period of the motion is met in step.
const THINNED: u64 = 61;
/// Rows that a verdict needs.
const FEWEST: f64 = 16.0;
/// Rows after which a stream gets its first verdict; the next comes after twice as many.
const FIRST_VERDICT: f64 = 64.0;
/// Noise of a channel over its full scale, where the calibration does not state it, and at least.
const NOISE: f64 = 1e-3;
/// Standard deviations of noise that are no motion.
const NOISE_DEVIATIONS: f64 = 3.0;

/// Samples at the beginning whose mean shows the zeros.
const BEGINNING: u64 = 4096;
/// Part of the converter's range by which zeros may have moved.
const ZEROS: f64 = 2e-4;
/// Standard deviations of a mean that are no zero's.
const MEAN_DEVIATIONS: f64 = 6.0;

/// Mean and sum of squared departures from it, of values that come one by one.
#[derive(Debug, Clone, Copy, Default)]
struct Moments {
    mean: f64,
    squares: f64,
}

impl Moments {
    fn push(&mut self, value: f64, number: f64) {
        let from_old = value - self.mean;
        self.mean += from_old / number;
        self.squares += from_old * (value - self.mean);
    }
}

/// The three sums of four limb forces over a recording.
#[derive(Clone)]
pub struct Coordination {
    chain: SignalChain,
    /// Stiffness of each limb over the mean one's, and what breaks sums of forces over these.
    stiffness_ratio: Row,
    limit: f64,
    /// Part of it that limbs with mass make.
    of_limb_mass: f64,
    /// Sums of which no limb is excluded, or has been.
    whole: [bool; ROWS],
    /// Variance of each sum that noise alone gives, m^2/s^4, and of each limb's force in it.
    noise: [f64; ROWS],
    limb_noise: Row,
    /// How zeros wander where a high-pass is undone.
    wander: Option<ZeroWander>,
    samples: u64,
    rows: f64,
    next_verdict: f64,
    sums: [Moments; ROWS],
    forces: [Moments; LIMBS],
    /// Sums over the beginning, V, and its samples.
    beginning_v: Row,
    begun: u64,
    /// Least and largest voltage of each channel there.
    ends_v: [[f64; 2]; LIMBS],
    full_scale_v: f64,
    said: bool,
}

impl Coordination {
    /// Nothing seen yet.
    pub fn new(setup: &Setup, calibration: &Calibration) -> Self {
        let chain = SignalChain::new(&setup.sensor.gains, &setup.parameters);
        let stated_v = calibration.covariance.propagated.as_ref();
        let limb_noise: Row = core::array::from_fn(|limb| {
            let stated_v = stated_v.map_or(0.0, |propagated| propagated.channel_noise_v[limb]);
            let noise_v = stated_v.max(NOISE * setup.full_scale_v);
            (chain.sensitivity_m_s2_per_v()[limb] * noise_v).powi(2)
        });
        let noise = COORDINATION.map(|limbs| limbs.into_iter().map(|limb| limb_noise[limb]).sum());
        let (stiffness_ratio, limit) = match &calibration.limbs {
            Some(limbs) => (limbs.stiffness_ratio, BROKEN_OWN),
            None => ([1.0; LIMBS], BROKEN),
        };
        let of_limb_mass = OF_LIMB_MASS * setup.rod_mass;
        Self {
            chain,
            stiffness_ratio,
            limit: limit + of_limb_mass,
            of_limb_mass,
            whole: [true; ROWS],
            noise,
            limb_noise,
            wander: None,
            samples: 0,
            rows: 0.0,
            next_verdict: FIRST_VERDICT,
            sums: Default::default(),
            forces: Default::default(),
            beginning_v: [0.0; LIMBS],
            begun: 0,
            ends_v: [[f64::INFINITY, f64::NEG_INFINITY]; LIMBS],
            full_scale_v: setup.full_scale_v,
            said: false,
        }
    }

    /// Allows for zeros that wander.
    pub(super) const fn allow_for(&mut self, wander: ZeroWander) {
        self.wander = Some(wander);
    }

    /// Looks at the next samples, nine columns of voltages. Rows that are not finite are passed over.
    pub fn look(&mut self, voltage_v: [&[f64]; LIMBS]) {
        let samples = voltage_v[0].len();
        for at in 0..samples.min(BEGINNING.saturating_sub(self.samples) as usize) {
            let row: Row = voltage_v.map(|column| column[at]);
            if row.iter().all(|u| u.is_finite()) {
                self.begun += 1;
                for (sum, u) in self.beginning_v.iter_mut().zip(row) {
                    *sum += u;
                }
                for ([least, largest], u) in self.ends_v.iter_mut().zip(row) {
                    *least = least.min(u);
                    *largest = largest.max(u);
                }
            }
        }
        let first = ((THINNED - self.samples % THINNED) % THINNED) as usize;
        for at in (first..samples).step_by(THINNED as usize) {
            let row: Row = voltage_v.map(|column| column[at]);
            let force = self.chain.force_per_mass_m_s2(&row);
            if force.iter().all(|f| f.is_finite()) {
                self.rows += 1.0;
                for (moments, f) in self.forces.iter_mut().zip(force) {
                    moments.push(f, self.rows);
                }
                for (moments, limbs) in self.sums.iter_mut().zip(COORDINATION) {
                    let strain = |limb: &usize| force[*limb] / self.stiffness_ratio[*limb];
                    let sum = limbs.iter().map(strain).sum();
                    moments.push(sum, self.rows);
                }
            }
        }
        self.samples += samples as u64;
    }

    /// Takes note that limbs are excluded: sums of theirs say nothing any more.
    pub fn exclude(&mut self, excluded: LimbSet) {
        for (whole, limbs) in self.whole.iter_mut().zip(COORDINATION) {
            *whole &= !limbs.iter().any(|limb| excluded.contains(*limb));
        }
    }

    /// Mean square of the forces' changes, m^2/s^4.
    fn usual(&self) -> f64 {
        self.forces.iter().map(|m| m.squares).sum::<f64>() / (LIMBS as f64 * self.rows)
    }

    /// Each sum over four forces of the usual size, were they independent; none where noise alone explains it.
    fn broken_by(&self) -> [Option<f64>; ROWS] {
        let usual = self.usual();
        core::array::from_fn(|k| {
            let variance = self.sums[k].squares / self.rows;
            let wandered = self
                .wander
                .map_or([0.0; LIMBS], |w| w.variances(self.samples));
            let more = COORDINATION[k].map(|limb| wandered[limb] * self.limb_noise[limb]);
            let all = self.noise[k] + more.iter().sum::<f64>();
            let noise = NOISE_DEVIATIONS * NOISE_DEVIATIONS * all;
            (self.whole[k] && self.rows >= FEWEST && variance > noise)
                .then(|| (variance / (4.0 * usual)).sqrt())
        })
    }

    /// The furthest sum of four mean forces at the beginning, as the shift of one channel's zero that would make it, V; none where
    /// noise, limbs unequal by a few percent or zeros that moved a little explain it.
    fn zero_off_v(&self) -> Option<([usize; 4], f64)> {
        if self.begun < FEWEST as u64 {
            return None;
        }
        let mean_v = self.beginning_v.map(|sum| sum / self.begun as f64);
        let force = self.chain.force_per_mass_m_s2(&mean_v);
        let per_v = self.chain.sensitivity_m_s2_per_v();
        // A square has a mean, and what is seen of the forces so far may still be nothing.
        let by_rate = match self.of_limb_mass {
            0.0 => 0.0,
            share => share * (4.0 * self.usual()).sqrt(),
        };
        let of_row = |k: usize| {
            let limbs = COORDINATION[k];
            let over = |of: &dyn Fn(usize) -> f64| limbs.iter().map(|limb| of(*limb)).sum::<f64>();
            let sum = over(&|limb| force[limb]);
            let by_limbs = COORDINATION_LIMIT * over(&|limb| force[limb].powi(2)).sqrt();
            let by_noise = MEAN_DEVIATIONS * (self.noise[k] / self.begun as f64).sqrt();
            let one_v = over(&|limb| per_v[limb].powi(2)).sqrt();
            let off_v = sum.abs() / one_v;
            let limit = by_limbs + by_rate + by_noise + ZEROS * self.full_scale_v * one_v;
            (self.whole[k] && sum.abs() > limit).then_some((limbs, off_v))
        };
        let off = (0..ROWS).filter_map(of_row);
        off.max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// What is to be said of the sums, once: a sentence without the recording's name.
    pub fn verdict(&mut self) -> Option<String> {
        let broken_by = self.broken_by();
        let most = broken_by.iter().flatten().copied().fold(0.0, f64::max);
        let broken: Vec<String> = broken_by
            .into_iter()
            .zip(COORDINATION)
            .filter_map(|(by, limbs)| {
                let by = by.filter(|by| *by > self.limit)?;
                let limbs = limbs.map(|limb| (limb + 1).to_string()).join(" + ");
                Some(format!("{limbs} by {}", percent(by, 2)))
            })
            .collect();
        if self.said {
            return None;
        }
        if broken.is_empty() {
            let (limbs, off_v) = self.zero_off_v()?;
            self.said = true;
            let sum = limbs.map(|limb| (limb + 1).to_string()).join(" + ");
            let still: Vec<String> = (limbs.into_iter())
                .filter(|limb| self.ends_v[*limb][0] == self.ends_v[*limb][1])
                .map(|limb| {
                    format!(
                        "limb {} reads {} V throughout",
                        limb + 1,
                        self.ends_v[limb][0]
                    )
                })
                .collect();
            if !still.is_empty() {
                return Some(format!(
                    "the mean forces of limbs {sum} do not add up to zero, and {}: is the channel dead? --excluded leaves a limb out, --watch finds it",
                    still.join(", ")
                ));
            }
            return Some(format!(
                "the mean forces of limbs {sum} do not add up to zero, as if a zero were off by {:.1} mV: this recording's zeros, gains or unit are not the calibration's; were zeros taken off, have they moved, are gains another recording's, or channels in another order? Open loop it makes the rate run away",
                1e3 * off_v
            ));
        }
        self.said = true;
        if most < BROKEN {
            return Some(format!(
                "limb forces that add up to zero in any motion do not: limbs {} of their size, where the limbs of the calibration leave {} at most; \
                 a gain is another range's, or the sensitivity of a channel has changed since, which --watch or self-calibrate may name",
                broken.join(", "),
                percent(self.limit, 1)
            ));
        }
        Some(format!(
            "limb forces that add up to zero in any motion do not: limbs {} of their size, which limbs unequal by a few percent do not \
             explain; the calibration or the gains are another sensor's, or a channel is dead, inverted or plugged in elsewhere",
            broken.join(", ")
        ))
    }

    /// [`Self::verdict`] from time to time, for a stream that may never end.
    pub fn verdict_so_far(&mut self) -> Option<String> {
        if self.rows < self.next_verdict {
            return None;
        }
        self.next_verdict *= 2.0;
        self.verdict()
    }
}
