//! Quantiles of magnitudes that are never held in whole: counted twice, coarse and then fine.
//!
//! Positive numbers order as their bits do. The first pass counts by the leading 16 bits, which says in which stretch of a
//! sixteenth of an octave each quantile lies; the second counts those stretches by the next 16 bits. A quantile is then known
//! to 2^-20 of itself, a millionth, and given as the upper end.

/// Numbers that differ in their leading 16 bits; the sign is never set.
const COARSE: usize = 1 << 15;
/// Parts of a stretch.
const FINE: usize = 1 << 16;

/// The first pass.
#[derive(Debug, Clone)]
pub struct Coarse {
    counts: Vec<u64>,
    total: u64,
}

impl Default for Coarse {
    fn default() -> Self {
        Self {
            counts: vec![0; COARSE],
            total: 0,
        }
    }
}

fn coarse(magnitude: f64) -> usize {
    (magnitude.abs().to_bits() >> 48) as usize
}

impl Coarse {
    /// Counts one number; its sign is not looked at.
    pub fn count(&mut self, value: f64) {
        self.counts[coarse(value)] += 1;
        self.total += 1;
    }

    /// Prepares the second pass for shares of one, such as 0.5 and 0.99. The quantile is the smallest number that at least
    /// this share of all does not exceed.
    pub fn refine(&self, shares: &[f64]) -> Fine {
        let stretches = shares
            .iter()
            .map(|share| {
                let mut rank =
                    ((share * self.total as f64).ceil() as u64).clamp(1, self.total.max(1));
                let mut stretch = 0;
                for (index, count) in self.counts.iter().enumerate() {
                    stretch = index;
                    if rank <= *count {
                        break;
                    }
                    rank -= count;
                }
                Stretch {
                    stretch,
                    rank,
                    counts: vec![0; FINE],
                }
            })
            .collect();
        Fine { stretches }
    }
}

#[derive(Debug, Clone)]
struct Stretch {
    stretch: usize,
    /// Rank within it, from 1.
    rank: u64,
    counts: Vec<u32>,
}

/// The second pass.
#[derive(Debug, Clone)]
pub struct Fine {
    stretches: Vec<Stretch>,
}

impl Fine {
    /// Counts one number.
    pub fn count(&mut self, value: f64) {
        let stretch = coarse(value);
        for quantile in &mut self.stretches {
            if quantile.stretch == stretch {
                let part = (value.abs().to_bits() >> 32) as usize % FINE;
                quantile.counts[part] = quantile.counts[part].saturating_add(1);
            }
        }
    }

    /// The quantiles, in the order of the shares.
    pub fn quantiles(&self) -> Vec<f64> {
        self.stretches
            .iter()
            .map(|quantile| {
                let mut rank = quantile.rank;
                for (part, count) in quantile.counts.iter().enumerate() {
                    if rank <= u64::from(*count) {
                        let bits = (quantile.stretch as u64) << 48
                            | (part as u64) << 32
                            | u64::from(u32::MAX);
                        return f64::from_bits(bits);
                    }
                    rank -= u64::from(*count);
                }
                f64::NAN
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::Coarse;

    #[test]
    fn as_of_the_sorted_series() {
        let mut values: Vec<f64> = (0..100_000_u32)
            .map(|k| f64::from(k.wrapping_mul(2_654_435_761) % 99_991) * 1e-7 - 2e-3)
            .collect();
        let mut counted = Coarse::default();
        values.iter().for_each(|v| counted.count(*v));
        let shares = [0.5, 0.9, 0.99, 1.0];
        let mut fine = counted.refine(&shares);
        values.iter().for_each(|v| fine.count(*v));
        values.iter_mut().for_each(|v| *v = v.abs());
        values.sort_by(f64::total_cmp);
        for (share, found) in shares.iter().zip(fine.quantiles()) {
            let exact = values[(share * values.len() as f64).ceil() as usize - 1];
            // Given as the upper end of a part of 2^-20.
            assert!(
                found >= exact && found <= exact * (1.0 + 1e-6),
                "{share}: {found} {exact}"
            );
        }
    }

    #[test]
    fn all_zero() {
        let mut counted = Coarse::default();
        counted.count(0.0);
        let mut fine = counted.refine(&[0.5]);
        fine.count(0.0);
        assert!(fine.quantiles()[0] < 1e-300);
    }
}
