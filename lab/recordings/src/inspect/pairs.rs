//! How channels go together, and channels that are one signal.

use rayon::prelude::*;

use super::facts::{ChannelFacts, Correlations, Twins};

/// Channels beyond which no correlations are computed: their number grows with the square.
pub const MOST_CHANNELS: usize = 32;
/// Two channels are taken for one signal if they are correlated beyond this,
const ALIKE: f64 = 0.9999;
/// their noise, too,
const NOISE_ALIKE: f64 = 0.9;
/// and their sizes differ by no more than this.
const SIZE: f64 = 1e-3;

/// Sums over rows of a product of two channels.
#[derive(Debug, Clone)]
struct Products {
    n: f64,
    sums: Vec<f64>,
    /// Upper triangle, the diagonal included.
    products: Vec<f64>,
}

impl Products {
    fn new(channels: usize) -> Self {
        Self {
            n: 0.0,
            sums: vec![0.0; channels],
            products: vec![0.0; channels * (channels + 1) / 2],
        }
    }

    fn add(&mut self, columns: &[Vec<f64>]) {
        let rows = columns.first().map_or(0, Vec::len);
        self.n += rows as f64;
        for (sum, column) in self.sums.iter_mut().zip(columns) {
            *sum += column.iter().sum::<f64>();
        }
        let places: Vec<(usize, usize)> = (0..columns.len())
            .flat_map(|i| (i..columns.len()).map(move |j| (i, j)))
            .collect();
        self.products
            .par_iter_mut()
            .zip(&places)
            .for_each(|(product, &(i, j))| *product += dot(&columns[i], &columns[j]));
    }

    fn covariance(&self, i: usize, j: usize, channels: usize) -> f64 {
        let (i, j) = (i.min(j), i.max(j));
        let at = i * channels - i * (i + 1) / 2 + j;
        self.products[at] / self.n - self.sums[i] / self.n * (self.sums[j] / self.n)
    }

    fn correlation(&self, i: usize, j: usize) -> Option<f64> {
        let channels = self.sums.len();
        let (a, b) = (
            self.covariance(i, i, channels),
            self.covariance(j, j, channels),
        );
        let r = self.covariance(i, j, channels) / (a.sqrt() * b.sqrt());
        (a > 0.0 && b > 0.0 && r.is_finite()).then(|| r.clamp(-1.0, 1.0))
    }
}

/// Four sums at a time, for the processor's sake.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<4>(), b.as_chunks::<4>());
    let mut sums = [0.0; 4];
    for (x, y) in a.iter().zip(b) {
        for k in 0..4 {
            sums[k] += x[k] * y[k];
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(x, y)| x * y).sum();
    sums.iter().sum::<f64>() + rest
}

/// Takes blocks as they come.
#[derive(Debug, Clone)]
pub struct Pairs {
    /// Each channel's level, taken off before anything is squared.
    levels: Option<Vec<f64>>,
    values: Products,
    /// Of third differences, which show the noise.
    noise: Products,
}

impl Pairs {
    /// For so many channels; none for one and for more than [`MOST_CHANNELS`].
    pub fn new(channels: usize) -> Option<Self> {
        (2..=MOST_CHANNELS).contains(&channels).then(|| Self {
            levels: None,
            values: Products::new(channels),
            noise: Products::new(channels),
        })
    }

    /// Takes a block. Rows in which any channel is not finite are left out of the block.
    pub fn add(&mut self, columns: &[Vec<f64>]) {
        let rows = columns.first().map_or(0, Vec::len);
        let whole = columns.iter().all(|c| c.iter().all(|x| x.is_finite()));
        let kept: Vec<usize> = if whole {
            Vec::new()
        } else {
            // A channel without any number would leave no rows to the others.
            let some: Vec<bool> = columns
                .iter()
                .map(|c| c.iter().any(|x| x.is_finite()))
                .collect();
            (0..rows)
                .filter(|&row| {
                    columns
                        .iter()
                        .zip(&some)
                        .all(|(c, some)| !some || c[row].is_finite())
                })
                .collect()
        };
        let levels = self
            .levels
            .get_or_insert_with(|| columns.iter().map(|c| level(c)).collect());
        let centred: Vec<Vec<f64>> = columns
            .par_iter()
            .zip(&*levels)
            .map(|(column, level)| {
                if whole {
                    column.iter().map(|x| x - level).collect()
                } else {
                    // What is still not finite belongs to a channel without any number: it shows as one that does not move.
                    kept.iter()
                        .map(|&row| column[row] - level)
                        .map(|x| if x.is_finite() { x } else { 0.0 })
                        .collect()
                }
            })
            .collect();
        self.values.add(&centred);
        let differences: Vec<Vec<f64>> = centred
            .par_iter()
            .map(|column| {
                column
                    .windows(4)
                    .map(|x| (x[3] - x[0]) - 3.0 * (x[2] - x[1]))
                    .collect()
            })
            .collect();
        self.noise.add(&differences);
    }

    /// All coefficients.
    pub fn correlations(&self) -> Correlations {
        let channels = self.values.sums.len();
        Correlations {
            coefficients: (0..channels)
                .map(|i| {
                    (0..channels)
                        .map(|j| self.values.correlation(i, j))
                        .collect()
                })
                .collect(),
        }
    }

    /// Correlation and ratio of sizes of two channels that agree down to their noise.
    fn alike(&self, i: usize, j: usize) -> Option<(f64, f64)> {
        let r = self.values.correlation(i, j)?;
        let noise = self.noise.correlation(i, j)?;
        let channels = self.values.sums.len();
        let size = |k| self.values.covariance(k, k, channels).sqrt();
        let ratio = size(j) / size(i);
        (r.abs() > ALIKE && noise.abs() > NOISE_ALIKE && (ratio - 1.0).abs() < SIZE)
            .then_some((r, ratio))
    }
}

/// Mean of the finite samples; of equal ones exactly their value, so that a channel that stands still has no variance left.
fn level(column: &[f64]) -> f64 {
    let mut finite = column.iter().copied().filter(|x| x.is_finite());
    let Some(first) = finite.next() else {
        return 0.0;
    };
    let (mut sum, mut n) = (0.0, 1.0);
    for x in finite {
        sum += x - first;
        n += 1.0;
    }
    first + sum / n
}

/// Pairs of channels that are one signal.
pub fn twins(channels: &[&ChannelFacts], pairs: Option<&Pairs>) -> Vec<Twins> {
    let mut found = Vec::new();
    for (i, first) in channels.iter().enumerate() {
        for (j, second) in channels.iter().enumerate().skip(i + 1) {
            let (a, b) = (first.prints, second.prints);
            if !(a.moves && b.moves) {
                continue;
            }
            let alike = pairs.and_then(|p| p.alike(i, j));
            let exact = a.same == b.same || a.same == b.turned;
            let opposite = if exact {
                a.same != b.same
            } else {
                match alike {
                    Some((r, _)) => r < 0.0,
                    None => continue,
                }
            };
            found.push(Twins {
                channels: [first.name.clone(), second.name.clone()],
                opposite,
                exact,
                correlation: alike.map(|a| a.0),
                ratio: alike.map(|a| a.1),
            });
        }
    }
    found
}
