//! One channel's numbers, all in one pass.

use std::collections::BTreeMap;

use sixaxis_core::dsp::spectrum::{MIN_NOISE_SAMPLES, Welch, noise_floor};

use super::allan::Allan;
use super::extreme::Extreme;
use super::facts::{ChannelFacts, Densities, Line, Prints, UnitFacts};
use super::jumps::{Jump, Jumps};
use super::resolution::{Steps, keep_every_second};
use super::spectrum;
use crate::channel::Channel;
use crate::envelope::Envelope;
use crate::runs::Runs;

/// Samples of which one noise floor is told.
const NOISE_PIECE: usize = 4096;
/// Noise floors kept.
const NOISE_KEPT: usize = 4096;

/// One channel, sample by sample.
#[derive(Debug, Clone, Default)]
pub struct Series {
    rows: u64,
    not_a_number: u64,
    infinite: u64,
    first_not_finite: Option<u64>,
    finite: f64,
    mean: f64,
    /// Sum of the squared differences from the mean.
    squares: f64,
    /// A sample is no whole number.
    fractional: bool,
    high: Extreme,
    low: Extreme,
    steps: Steps,
    runs: Runs,
    same: u64,
    turned: u64,
    envelope: Envelope,
    noise: Noise,
    welch: Option<Welch>,
    /// Of a recording at rest.
    allan: Option<Allan>,
    full_scale: f64,
    at_full_scale: u64,
}

impl Series {
    /// Nothing taken yet. `welch` is left out for a recording that is too short for a spectrum; `full_scale` is the converter's
    /// limit in the channel's unit, infinite if it is not known. `at_rest`: Allan deviations, too.
    pub fn new(welch: Option<Welch>, full_scale: f64, at_rest: bool) -> Self {
        Self {
            welch,
            allan: at_rest.then(Allan::default),
            full_scale,
            ..Self::default()
        }
    }

    /// Takes the next samples.
    pub fn extend(&mut self, samples: &[f64]) {
        let (mut n, mut sum) = (0.0, 0.0);
        for &x in samples {
            let row = self.rows;
            self.rows += 1;
            self.runs.push(x);
            self.same = mix(self.same, x);
            self.turned = mix(self.turned, -x);
            self.envelope.push(row as f64, x);
            if !x.is_finite() {
                self.first_not_finite.get_or_insert(row);
                if x.is_nan() {
                    self.not_a_number += 1;
                } else {
                    self.infinite += 1;
                }
                continue;
            }
            n += 1.0;
            sum += x;
            self.fractional |= x.fract() != 0.0;
            self.high.push(x, row);
            self.low.push(-x, row);
            self.steps.push(x, row);
            self.at_full_scale += u64::from(x.abs() >= self.full_scale);
        }
        if n > 0.0 {
            // Chan's rule: the block's own mean and squares, merged.
            let mean = sum / n;
            let squares: f64 = samples
                .iter()
                .filter(|x| x.is_finite())
                .map(|x| (x - mean) * (x - mean))
                .sum();
            let all = self.finite + n;
            let apart = mean - self.mean;
            self.squares += squares + apart * apart * (self.finite / all) * n;
            self.mean += apart * (n / all);
            self.finite = all;
        }
        self.noise.extend(samples);
        if let Some(allan) = &mut self.allan {
            allan.extend(samples);
        }
        if let Some(welch) = &mut self.welch {
            welch.push(samples);
        }
    }

    /// The answer, with frequencies in Hz if the rate is known. Densities are kept.
    pub fn finish(self, channel: &Channel, rate_hz: Option<f64>) -> ChannelFacts {
        let mut absent = BTreeMap::new();
        let any = self.finite > 0.0;
        let nothing = if self.rows == 0 {
            "no samples"
        } else {
            "no finite sample"
        };
        let mut number = |name, value: Option<f64>, why| match value {
            Some(x) if x.is_finite() => Some(x),
            Some(_) => {
                absent.insert(name, "too large for a double");
                None
            }
            None => {
                absent.insert(name, if any { why } else { nothing });
                None
            }
        };
        let (low, high) = (-self.low.value(), self.high.value());
        let (constant, span) = (any && high == low, high - low);
        let resolution = self.steps.finish();
        let spectra = Spectra::of(self.welch, rate_hz, constant);
        let (noise_floor, jumps) = self.noise.finish();
        let noise_floor = number(
            "noise_floor",
            noise_floor,
            "fewer than 32 finite samples in a row",
        );
        let drift = self.envelope.drift(noise_floor.unwrap_or(0.0));
        let bits = |step: f64| (span / step + 1.0).log2();
        let no_bits = match constant {
            true => "constant",
            false => "the samples stand on no common grid",
        };
        let no_drift = "fewer than 200 samples, or none finite at one end";
        let mut facts = ChannelFacts {
            name: channel.name.clone(),
            unit: channel.unit.as_deref().map(UnitFacts::new),
            start_offset_s: channel.start_offset_s,
            samples: self.rows,
            not_a_number: self.not_a_number,
            infinite: self.infinite,
            first_not_finite: self.first_not_finite,
            minimum: number("minimum", any.then_some(low), ""),
            maximum: number("maximum", any.then_some(high), ""),
            mean: number("mean", any.then_some(self.mean), ""),
            standard_deviation: number(
                "standard_deviation",
                any.then(|| (self.squares / self.finite).sqrt()),
                "",
            ),
            noise_floor,
            noise_density: noise_floor
                .zip(rate_hz)
                .map(|(sigma, rate)| sigma * (2.0 / rate).sqrt()),
            smallest_step: number("smallest_step", resolution.smallest_step, "constant"),
            bits_used: number("bits_used", resolution.grid_step().map(bits), no_bits),
            constant,
            runs: self.runs,
            flat_bottom: self.low.flat(span, &resolution, !self.fractional, -1.0),
            flat_top: self.high.flat(span, &resolution, !self.fractional, 1.0),
            at_full_scale: self.full_scale.is_finite().then_some(self.at_full_scale),
            drift: number("drift", drift.map(|d| d.0), no_drift),
            jumps,
            drift_stands_out: drift.is_some_and(|d| d.1),
            dominant: spectra.dominant,
            mains: spectra.mains,
            spectrum: spectra.densities,
            stability: self
                .allan
                .zip(rate_hz)
                .and_then(|(allan, rate)| allan.finish(self.rows, rate)),
            prints: Prints {
                same: self.same,
                turned: self.turned,
                moves: high > low,
            },
            absent,
            history: self.envelope,
        };
        if facts.spectrum.is_none() {
            let why = if spectra.too_short {
                "fewer than 16 samples"
            } else if !any {
                nothing
            } else {
                "no segment without a value that is not finite"
            };
            facts.absent.extend([("spectrum", why), ("dominant", why)]);
        } else if facts.dominant.is_none() {
            facts.absent.insert("dominant", "no line stands out");
        }
        facts
    }
}

/// What a channel's spectrum shows.
#[derive(Default)]
struct Spectra {
    too_short: bool,
    dominant: Option<Line>,
    mains: Vec<Line>,
    densities: Option<Densities>,
}

impl Spectra {
    fn of(welch: Option<Welch>, rate_hz: Option<f64>, constant: bool) -> Self {
        let mut spectra = Self::default();
        let Some(welch) = welch else {
            spectra.too_short = true;
            return spectra;
        };
        let rate = rate_hz.unwrap_or(1.0);
        let distance = rate / welch.segment() as f64;
        let Some(found) = welch.spectrum(rate) else {
            return spectra;
        };
        if !constant {
            spectra.dominant = spectrum::dominant(&found.densities, distance);
            if rate_hz.is_some() {
                spectra.mains = spectrum::mains(&found.densities, distance);
            }
        }
        spectra.densities = Some(Densities {
            segment: welch.segment(),
            segments: found.segments,
            segments_left_out: welch.left_out(),
            line_distance: distance,
            densities: found.densities,
        });
        spectra
    }
}

/// A running checksum of samples; the two zeros are one, as are all that are not a number.
#[inline]
fn mix(state: u64, x: f64) -> u64 {
    let bits = if x.is_nan() {
        u64::MAX
    } else {
        (x + 0.0).to_bits()
    };
    (state.rotate_left(23) ^ bits).wrapping_mul(0x9e37_79b9_7f4a_7c15)
}

/// Median of the noise floors of pieces without a gap, and what jumps there.
#[derive(Debug, Clone, Default)]
struct Noise {
    piece: Vec<f64>,
    /// The sample behind the piece.
    behind: u64,
    jumps: Jumps,
    floors: Vec<f64>,
    /// Pieces seen, and how often the floors were halved: every 2^halvings-th piece is looked at.
    pieces: u64,
    halvings: u32,
}

impl Noise {
    fn extend(&mut self, samples: &[f64]) {
        for run in samples.split_inclusive(|x| !x.is_finite()) {
            let (mut finite, broken) = match run.split_last() {
                Some((last, before)) if !last.is_finite() => (before, true),
                _ => (run, false),
            };
            let mut left = finite.len() + usize::from(broken);
            self.behind += left as u64;
            while !finite.is_empty() {
                let room = NOISE_PIECE - self.piece.len();
                let (now, later) = finite.split_at(room.min(finite.len()));
                self.piece.extend_from_slice(now);
                left -= now.len();
                finite = later;
                if self.piece.len() == NOISE_PIECE {
                    self.tell(left);
                }
            }
            if broken {
                // A short piece is better than none.
                if self.floors.is_empty() {
                    self.tell(left);
                }
                self.look(left);
                self.piece.clear();
                self.jumps.gap();
            }
        }
    }

    /// Takes a piece with so many samples before [`Self::behind`] still to come.
    fn tell(&mut self, left: usize) {
        let due = self.pieces.trailing_zeros() >= self.halvings;
        self.pieces += 1;
        if due && self.piece.len() >= MIN_NOISE_SAMPLES {
            // Refused only for differences that overflow.
            if let Ok(floor) = noise_floor(&self.piece) {
                self.floors.push(floor);
            }
        }
        self.look(left);
        if self.floors.len() == NOISE_KEPT {
            keep_every_second(&mut self.floors);
            self.halvings += 1;
        }
        self.piece.clear();
    }

    /// Looks for jumps in a piece, by the noise of the last that was long enough to tell it.
    fn look(&mut self, left: usize) {
        if let Some(floor) = self.floors.last() {
            let from = self.behind - (left + self.piece.len()) as u64;
            self.jumps.look(&self.piece, from, *floor);
        }
    }

    fn finish(mut self) -> (Option<f64>, Vec<Jump>) {
        if self.floors.is_empty() {
            self.tell(0);
        }
        self.look(0);
        (spectrum::median(&self.floors), self.jumps.first)
    }
}
