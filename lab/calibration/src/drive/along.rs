//! Whether a standard goes along with the channels, at whatever frequency: the speed of a drive that is cranked by hand wanders, and each
//! series has its own median cycle then.

use nalgebra::{DMatrix, DVector};
use sixaxis_core::LIMBS;

/// Share of the variance of a standard that goes along, which the channels account for. Of a standard that moves at another frequency, by a
/// twentieth over ten cycles, they account for half.
const ALONG: f64 = 0.9;
/// Channels, their sums since the first sample, which show a rate where they show its derivative, a constant and a slope.
const COLUMNS: usize = 2 * LIMBS + 2;
/// Rows that are looked at, at most.
const ROWS: usize = 4000;
/// Added to each column's own square: of channels that hang together less is not told apart.
const RIDGE: f64 = 1e-9;

/// Whether a series is made of what nine channels show at the same times.
pub(super) fn goes_along(series: &[f64], voltage_v: &[[f64; LIMBS]]) -> bool {
    let sums = voltage_v.iter().scan([0.0; LIMBS], |sums, row| {
        for (sum, v) in sums.iter_mut().zip(row) {
            *sum += v;
        }
        Some(*sums)
    });
    let count = voltage_v.len();
    let every = count.div_ceil(ROWS).max(1);
    let kept: Vec<[f64; COLUMNS]> = voltage_v
        .iter()
        .zip(sums)
        .enumerate()
        .step_by(every)
        .map(|(k, (row, sums))| {
            let mut columns = [1.0; COLUMNS];
            columns[..LIMBS].copy_from_slice(row);
            columns[LIMBS..2 * LIMBS].copy_from_slice(&sums);
            columns[COLUMNS - 1] = k as f64 / count as f64;
            columns
        })
        .collect();
    let mut table = DMatrix::from_fn(kept.len(), COLUMNS, |row, column| kept[row][column]);
    let mut shown = DVector::from_iterator(kept.len(), series.iter().copied().step_by(every));
    if shown.len() != table.nrows() {
        return false;
    }
    shown.add_scalar_mut(-shown.mean());
    for mut column in table.column_iter_mut() {
        let size = column.norm();
        if size > 0.0 {
            column /= size;
        }
    }
    let square = table.tr_mul(&table) + DMatrix::identity(COLUMNS, COLUMNS) * RIDGE;
    let Some(found) = square.cholesky().map(|it| it.solve(&table.tr_mul(&shown))) else {
        return false;
    };
    let left = &shown - &table * found;
    left.norm_squared() < (1.0 - ALONG) * shown.norm_squared()
}

#[cfg(test)]
mod tests {
    use core::f64::consts::TAU;

    use super::*;

    const SAMPLES: usize = 20_000;
    const RATE_HZ: f64 = 2000.0;

    /// Angle of a drive at 1 Hz whose speed wanders by so much, four times in ten turns, and a twentieth off at that.
    fn angle(time_s: f64, wander: f64, speed: f64) -> f64 {
        TAU * speed * time_s - wander / 0.4 * (TAU * 0.4 * time_s).cos()
    }

    /// Nine channels of a turn to and fro, which show its acceleration, and the rate that a standard shows.
    fn played(of_standard: impl Fn(f64) -> f64, wander: f64) -> (Vec<f64>, Vec<[f64; LIMBS]>) {
        let times = (0..SAMPLES).map(|k| k as f64 / RATE_HZ);
        let rate = |time_s: f64, angle: &dyn Fn(f64) -> f64| {
            (angle(time_s + 1e-4).sin() - angle(time_s - 1e-4).sin()) / 2e-4
        };
        let channels = times.clone().map(|t| {
            let of = |t: f64| angle(t, wander, 1.0);
            let acceleration = (rate(t + 1e-3, &of) - rate(t - 1e-3, &of)) / 2e-3;
            core::array::from_fn(|i| {
                (1.0 + 0.1 * i as f64) * acceleration + 1e-3 * (37.0 * t * i as f64).sin()
            })
        });
        let channels = channels.collect();
        (times.map(|t| rate(t, &of_standard)).collect(), channels)
    }

    #[test]
    fn inv_a_standard_goes_along_with_a_drive_that_wanders() {
        for wander in [0.0, 0.05, 0.15] {
            let (standard, channels) = played(|t| angle(t, wander, 1.0), wander);
            assert!(goes_along(&standard, &channels), "{wander}");
        }
    }

    #[test]
    fn neg_a_standard_of_another_drive_does_not() {
        for speed in [0.8, 0.94, 1.06, 1.3] {
            let (standard, channels) = played(|t| angle(t, 0.0, speed), 0.0);
            assert!(!goes_along(&standard, &channels), "{speed}");
        }
        let (standard, channels) = played(|_| 0.0, 0.1);
        assert!(!goes_along(&standard, &channels));
        assert!(!goes_along(&standard[1..], &channels));
    }
}
