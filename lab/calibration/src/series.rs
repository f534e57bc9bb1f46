//! Small statistics of a series. Sums run from the first value to the last.

use sixaxis_core::LIMBS;

use crate::diagnosis::table::weighted_median;

/// The value in the middle, of an even count the lower of the two there; none of no values.
pub(crate) fn median(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let mut all: Vec<(f64, f64)> = values.into_iter().map(|value| (value, 1.0)).collect();
    weighted_median(&mut all)
}

/// The value in the middle, of an even count the upper of the two there; none of no values.
pub(crate) fn upper_median(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let mut all: Vec<f64> = values.into_iter().collect();
    let middle = all.len() / 2;
    (!all.is_empty()).then(|| *all.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// Mean of a channel over some rows; NaN of none.
pub(crate) fn mean_of(rows: &[[f64; LIMBS]], channel: usize) -> f64 {
    rows.iter().map(|row| row[channel]).sum::<f64>() / rows.len() as f64
}

/// Root mean square about the mean; NaN of no values.
pub(crate) fn deviation(series: &[f64]) -> f64 {
    let count = series.len() as f64;
    let mean = series.iter().sum::<f64>() / count;
    let squares: f64 = series.iter().map(|x| (x - mean).powi(2)).sum();
    (squares / count).sqrt()
}

/// Smallest and largest; infinite, the smallest above the largest, of no values.
pub(crate) fn extent(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
    let ends = (f64::INFINITY, f64::NEG_INFINITY);
    let of_two = |(low, high): (f64, f64), x: f64| (low.min(x), high.max(x));
    values.into_iter().fold(ends, of_two)
}
