//! Minimum, maximum and mean over time in bounded memory.

/// Bins at most: about two for each pixel of a wide figure.
pub const BINS: usize = 2048;
/// Shortest history of which a drift is told, in bins.
const FEWEST_BINS: usize = 200;
/// A drift beyond so many standard deviations of the bins' means within the two tenths stands out.
const STANDS_OUT: f64 = 3.0;
/// Share of the range that a drift must reach to stand out.
const SHARE: f64 = 0.01;

/// Consecutive samples as one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bin {
    /// Smallest finite sample.
    pub minimum: f64,
    /// Largest finite sample.
    pub maximum: f64,
    /// Sum of the finite samples.
    pub sum: f64,
    /// Number of finite samples.
    pub count: u64,
}

impl Bin {
    const EMPTY: Self = Self {
        minimum: f64::INFINITY,
        maximum: f64::NEG_INFINITY,
        sum: 0.0,
        count: 0,
    };

    fn merge(self, other: Self) -> Self {
        Self {
            minimum: self.minimum.min(other.minimum),
            maximum: self.maximum.max(other.maximum),
            sum: self.sum + other.sum,
            count: self.count + other.count,
        }
    }

    fn mean(&self) -> f64 {
        self.sum / self.count as f64
    }
}

/// A history in at most [`BINS`] bins of equal width, which doubles whenever they are full.
#[derive(Debug, Clone, PartialEq)]
pub struct Envelope {
    bins: Vec<Bin>,
    width: u64,
    current: Bin,
    rows: u64,
}

impl Default for Envelope {
    fn default() -> Self {
        Self {
            bins: Vec::new(),
            width: 1,
            current: Bin::EMPTY,
            rows: 0,
        }
    }
}

impl Envelope {
    /// Takes the next samples; what is not finite leaves a hole.
    pub fn extend(&mut self, mut samples: &[f64]) {
        while !samples.is_empty() {
            let room = (self.width - self.rows % self.width) as usize;
            let (now, later) = samples.split_at(room.min(samples.len()));
            let mut bin = self.current;
            for &x in now {
                if x.is_finite() {
                    bin.minimum = bin.minimum.min(x);
                    bin.maximum = bin.maximum.max(x);
                    bin.sum += x;
                    bin.count += 1;
                }
            }
            self.current = bin;
            self.rows += now.len() as u64;
            if self.rows.is_multiple_of(self.width) {
                self.bins
                    .push(std::mem::replace(&mut self.current, Bin::EMPTY));
                if self.bins.len() == BINS {
                    self.bins = self
                        .bins
                        .as_chunks::<2>()
                        .0
                        .iter()
                        .map(|[a, b]| a.merge(*b))
                        .collect();
                    self.width *= 2;
                }
            }
            samples = later;
        }
    }

    /// Samples of a bin.
    #[must_use]
    pub const fn width(&self) -> u64 {
        self.width
    }

    /// The bins, the last one perhaps with fewer samples.
    #[must_use]
    pub fn bins(&self) -> Vec<Bin> {
        let mut bins = self.bins.clone();
        if !self.rows.is_multiple_of(self.width) {
            bins.push(self.current);
        }
        bins
    }

    /// Mean of the last tenth of the bins less mean of the first, and whether it stands out of their scatter, of `noise` and of
    /// the range. None below 200 bins and where a tenth has no finite sample.
    #[must_use]
    pub fn drift(&self, noise: f64) -> Option<(f64, bool)> {
        let tenth = self.bins.len() / 10;
        if self.bins.len() < FEWEST_BINS {
            return None;
        }
        let first = tenth_of(&self.bins[..tenth])?;
        let last = tenth_of(&self.bins[self.bins.len() - tenth..])?;
        let drift = last.mean - first.mean;
        let scatter = (0.5 * (first.variance + last.variance)).sqrt();
        let whole = self.bins.iter().copied().fold(Bin::EMPTY, Bin::merge);
        let least = (STANDS_OUT * scatter)
            .max(noise)
            .max(SHARE * (whole.maximum - whole.minimum));
        drift.is_finite().then_some((drift, drift.abs() > least))
    }
}

struct Tenth {
    mean: f64,
    /// Of the bins' means.
    variance: f64,
}

fn tenth_of(bins: &[Bin]) -> Option<Tenth> {
    let full: Vec<&Bin> = bins.iter().filter(|b| b.count > 0).collect();
    if full.len() < 2 {
        return None;
    }
    let all = full.iter().fold(Bin::EMPTY, |a, b| a.merge(**b));
    let mean = all.mean();
    let variance = full
        .iter()
        .map(|b| (b.mean() - mean) * (b.mean() - mean))
        .sum::<f64>()
        / full.len() as f64;
    Some(Tenth { mean, variance })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_peak_is_lost_and_pieces_do_not_matter() {
        let series: Vec<f64> = (0..100_003)
            .map(|k| if k == 77_777 { 9.0 } else { f64::from(k % 7) })
            .collect();
        let mut whole = Envelope::default();
        whole.extend(&series);
        let mut pieces = Envelope::default();
        for piece in series.chunks(997) {
            pieces.extend(piece);
        }
        assert_eq!(whole, pieces);
        let bins = whole.bins();
        assert!(bins.len() <= BINS && bins.len() > BINS / 2);
        assert_eq!(bins.iter().map(|b| b.count).sum::<u64>(), 100_003);
        let peak = bins.iter().position(|b| b.maximum == 9.0).expect("kept");
        assert_eq!(peak as u64, 77_777 / whole.width());
    }

    #[test]
    fn drift_is_told_from_motion() {
        let drifting = |slope: f64| {
            let mut envelope = Envelope::default();
            let series: Vec<f64> = (0..20_000)
                .map(|k| {
                    let t = f64::from(k) / 20_000.0;
                    (t * 500.0).sin() + slope * t
                })
                .collect();
            envelope.extend(&series);
            envelope.drift(0.0).expect("long enough")
        };
        assert!(!drifting(0.0).1);
        let (drift, stands_out) = drifting(5.0);
        // From the middle of the first tenth to that of the last: nine tenths of the line, and a remainder of the sine.
        assert!((drift - 4.5).abs() < 0.1 && stands_out, "{drift}");
    }
}
