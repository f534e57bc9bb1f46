//! A series of any length, kept for drawing: the smallest and the largest sample of each of some thousand stretches.

/// Stretches kept, at most: more than a figure has pixels across, so that drawing loses nothing more.
const CAPACITY: usize = 4096;

/// Time, s, and value.
type Point = (f64, f64);

/// What is kept of a series.
#[derive(Debug, Clone, PartialEq)]
pub struct Envelope {
    /// Smallest and largest sample of each stretch.
    stretches: Vec<(Point, Point)>,
    /// Samples of a full stretch.
    length: u64,
    /// Samples of the last stretch.
    in_last: u64,
}

impl Default for Envelope {
    fn default() -> Self {
        Self {
            stretches: Vec::new(),
            length: 1,
            in_last: 1,
        }
    }
}

impl Envelope {
    /// Takes the next sample.
    pub fn push(&mut self, time_s: f64, value: f64) {
        let point = (time_s, value);
        if self.in_last < self.length
            && let Some(last) = self.stretches.last_mut()
        {
            *last = merged(*last, (point, point));
            self.in_last += 1;
            return;
        }
        if self.stretches.len() == CAPACITY {
            let halved: Vec<_> = self
                .stretches
                .chunks_exact(2)
                .map(|pair| merged(pair[0], pair[1]))
                .collect();
            self.stretches = halved;
            self.length *= 2;
        }
        self.stretches.push((point, point));
        self.in_last = 1;
    }

    /// Its points in the order of time.
    #[must_use]
    pub fn points(&self) -> Vec<Point> {
        let mut points = Vec::with_capacity(2 * self.stretches.len());
        for &(low, high) in &self.stretches {
            let (first, second) = if low.0 <= high.0 {
                (low, high)
            } else {
                (high, low)
            };
            points.push(first);
            if second.0 > first.0 {
                points.push(second);
            }
        }
        points
    }
}

fn merged(a: (Point, Point), b: (Point, Point)) -> (Point, Point) {
    (
        if b.0.1 < a.0.1 { b.0 } else { a.0 },
        if b.1.1 > a.1.1 { b.1 } else { a.1 },
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_series_are_kept_whole() {
        let mut envelope = Envelope::default();
        for k in 0..1000 {
            envelope.push(f64::from(k), f64::from(k % 7));
        }
        let points = envelope.points();
        assert_eq!(points.len(), 1000);
        assert_eq!(points[999], (999.0, 5.0));
    }

    #[test]
    fn extremes_of_long_series_survive_in_place() {
        let mut envelope = Envelope::default();
        for k in 0..1_000_000_u32 {
            let value = match k {
                654_321 => 9.0,
                654_322 => -9.0,
                _ => (f64::from(k) * 1e-3).sin(),
            };
            envelope.push(f64::from(k), value);
        }
        let points = envelope.points();
        assert!(points.len() <= 2 * CAPACITY);
        assert!(points.contains(&(654_321.0, 9.0)) && points.contains(&(654_322.0, -9.0)));
        assert!(points.windows(2).all(|w| w[0].0 < w[1].0));
        assert!(points[points.len() - 1].0 > 999_000.0);
    }
}
