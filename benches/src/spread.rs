//! Medians and quartiles of measured times.

use sixaxis_props::results::Spread;

/// Median and quartiles of scaled values, at least one, to four digits: more are noise.
///
/// # Panics
/// If there is no value.
pub fn spread(mut values: Vec<f64>, scale: f64) -> Spread {
    values.sort_by(f64::total_cmp);
    let at = |share: f64| {
        let place = share * (values.len() - 1) as f64;
        let (low, high) = (
            values[place.floor() as usize],
            values[place.ceil() as usize],
        );
        rounded(scale * (low + place.fract() * (high - low)))
    };
    Spread {
        median: at(0.5),
        q1: at(0.25),
        q3: at(0.75),
    }
}

/// A number with four digits.
pub fn rounded(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}
