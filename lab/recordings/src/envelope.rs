//! A series of any length in bounded memory, for drawing: smallest, largest and mean sample of each of some thousand bins.

/// Bins at most: about two for each pixel of a wide figure.
pub const BINS: usize = 2048;
/// Bins below which no drift is told.
const FEWEST_BINS: usize = 200;
/// A drift beyond so many standard deviations of the bins' means within the two tenths stands out.
const STANDS_OUT: f64 = 3.0;
/// Share of the range that a drift must reach to stand out.
const SHARE: f64 = 0.01;

/// Position, such as a time or the number of a sample, and value.
pub type Point = (f64, f64);

/// Consecutive samples as one.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Bin {
    /// Position of the first sample, finite or not.
    start: f64,
    smallest: Point,
    largest: Point,
    /// Sum and number of the finite samples.
    sum: f64,
    count: u64,
}

impl Bin {
    const fn empty(start: f64) -> Self {
        Self {
            start,
            smallest: (start, f64::INFINITY),
            largest: (start, f64::NEG_INFINITY),
            sum: 0.0,
            count: 0,
        }
    }

    fn take(&mut self, at: f64, value: f64) {
        if value.is_finite() {
            if value < self.smallest.1 {
                self.smallest = (at, value);
            }
            if value > self.largest.1 {
                self.largest = (at, value);
            }
            self.sum += value;
            self.count += 1;
        }
    }

    fn merge(self, later: Self) -> Self {
        let (a, b) = (self, later);
        Self {
            start: a.start,
            smallest: if b.smallest.1 < a.smallest.1 {
                b.smallest
            } else {
                a.smallest
            },
            largest: if b.largest.1 > a.largest.1 {
                b.largest
            } else {
                a.largest
            },
            sum: a.sum + b.sum,
            count: a.count + b.count,
        }
    }

    fn mean(&self) -> f64 {
        self.sum / self.count as f64
    }
}

/// A history in at most [`BINS`] bins of equally many samples; their width doubles whenever all are full.
#[derive(Debug, Clone, PartialEq)]
pub struct Envelope {
    /// Full bins.
    bins: Vec<Bin>,
    width: u64,
    /// The bin that is being filled, and the samples in it, finite or not.
    current: Bin,
    in_current: u64,
}

impl Default for Envelope {
    fn default() -> Self {
        Self {
            bins: Vec::new(),
            width: 1,
            current: Bin::empty(0.0),
            in_current: 0,
        }
    }
}

impl Envelope {
    /// Takes the next sample, which stands after all before it. A value that is not finite leaves a hole.
    pub fn push(&mut self, at: f64, value: f64) {
        if self.in_current == 0 {
            self.current = Bin::empty(at);
        }
        self.current.take(at, value);
        self.in_current += 1;
        if self.in_current == self.width {
            self.bins.push(self.current);
            self.in_current = 0;
            if self.bins.len() == BINS {
                let (pairs, _) = self.bins.as_chunks::<2>();
                self.bins = pairs.iter().map(|[a, b]| a.merge(*b)).collect();
                self.width *= 2;
            }
        }
    }

    /// Smallest and largest sample of each bin in the order of their positions; NaN at the start of a bin without a finite
    /// sample, which interrupts the curve.
    pub fn points(&self) -> Vec<Point> {
        let mut points = Vec::with_capacity(2 * self.bins.len() + 2);
        let current = (self.in_current > 0).then_some(self.current);
        for bin in self.bins.iter().copied().chain(current) {
            let (a, b) = (bin.smallest, bin.largest);
            if bin.count == 0 {
                points.push((bin.start, f64::NAN));
            } else if a.0 == b.0 {
                points.push(a);
            } else {
                points.extend(if a.0 < b.0 { [a, b] } else { [b, a] });
            }
        }
        points
    }

    /// Mean of the last tenth of the bins less mean of the first, and whether it stands out of their scatter, of `noise` and of
    /// the range. None below 200 bins and where a tenth has no finite sample.
    pub fn drift(&self, noise: f64) -> Option<(f64, bool)> {
        let tenth = self.bins.len() / 10;
        if self.bins.len() < FEWEST_BINS {
            return None;
        }
        let (first, first_variance) = mean_and_variance(&self.bins[..tenth])?;
        let (last, last_variance) = mean_and_variance(&self.bins[self.bins.len() - tenth..])?;
        let drift = last - first;
        let scatter = (0.5 * (first_variance + last_variance)).sqrt();
        let whole = merged(&self.bins);
        let least = (STANDS_OUT * scatter)
            .max(noise)
            .max(SHARE * (whole.largest.1 - whole.smallest.1));
        drift.is_finite().then_some((drift, drift.abs() > least))
    }
}

fn merged<'a>(bins: impl IntoIterator<Item = &'a Bin>) -> Bin {
    bins.into_iter()
        .fold(Bin::empty(0.0), |all, bin| all.merge(*bin))
}

/// Mean of the samples of some bins, and variance of the bins' means about it.
fn mean_and_variance(bins: &[Bin]) -> Option<(f64, f64)> {
    let some: Vec<&Bin> = bins.iter().filter(|b| b.count > 0).collect();
    if some.len() < 2 {
        return None;
    }
    let mean = merged(some.iter().copied()).mean();
    let squares: f64 = some.iter().map(|b| (b.mean() - mean).powi(2)).sum();
    Some((mean, squares / some.len() as f64))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn envelope(samples: impl Iterator<Item = f64>) -> Envelope {
        let mut envelope = Envelope::default();
        samples
            .enumerate()
            .for_each(|(k, x)| envelope.push(k as f64, x));
        envelope
    }

    #[test]
    fn short_series_are_kept_whole() {
        let points = envelope((0..1000).map(|k| f64::from(k % 7))).points();
        assert_eq!(points.len(), 1000);
        assert_eq!(points[999], (999.0, 5.0));
    }

    #[test]
    fn extremes_of_long_series_survive_in_place() {
        let found = envelope((0..1_000_000).map(|k| match k {
            654_321 => 9.0,
            654_322 => -9.0,
            700_000..710_000 => f64::NAN,
            _ => (f64::from(k) * 1e-3).sin(),
        }));
        let points = found.points();
        assert!(points.len() <= 2 * BINS);
        assert!(points.contains(&(654_321.0, 9.0)) && points.contains(&(654_322.0, -9.0)));
        assert!(points.windows(2).all(|w| w[0].0 < w[1].0));
        assert!(points[points.len() - 1].0 > 999_000.0);
        // The hole is drawn as one.
        let hole = |at: f64| (700_000.0..710_000.0).contains(&at);
        assert!(points.iter().any(|p| hole(p.0) && p.1.is_nan()));
        let counted: u64 = found.bins.iter().map(|b| b.count).sum();
        assert_eq!(
            counted + found.current.count * u64::from(found.in_current > 0),
            990_000
        );
    }

    #[test]
    fn drift_is_told_from_motion() {
        let drift = |slope: f64| {
            let series = (0..20_000).map(|k| {
                let t = f64::from(k) / 20_000.0;
                (t * 500.0).sin() + slope * t
            });
            envelope(series).drift(0.0).expect("long enough")
        };
        assert!(!drift(0.0).1);
        let (drift, stands_out) = drift(5.0);
        // From the middle of the first tenth to that of the last: nine tenths of the line, and a remainder of the sine.
        assert!((drift - 4.5).abs() < 0.1 && stands_out, "{drift}");
    }
}
