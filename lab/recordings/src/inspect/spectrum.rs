//! Lines that stand out of a spectrum: the highest one, and those of the mains.

use sixaxis_core::dsp::spectrum::MIN_SEGMENT;

use super::facts::Line;

/// Longest segment.
const LONGEST_SEGMENT: usize = 1 << 16;
/// Longest where the recording's length is not known before it is read.
const LONGEST_BLIND: usize = 1 << 14;
/// Shortest of a long recording.
const SHORTEST: usize = 1 << 12;
/// A line stands out from so many times the median density: the highest of 32,768 lines of white noise in one segment reaches 15.
const STANDS_OUT: f64 = 30.0;
/// Lowest lines, which offset and drift smear into.
const LOWEST: usize = 2;
/// Mains frequencies, Hz, and how far they stray.
const MAINS_HZ: [f64; 2] = [50.0, 60.0];
const STRAYS_HZ: f64 = 0.5;
/// Width of the neighbourhood that a mains line is held against, Hz.
const AROUND_HZ: f64 = 8.0;
/// Harmonics looked for once the first is there.
const HARMONICS: usize = 5;

/// Segment for a recording: half of one of `rows` samples that ends early; otherwise so long that lines are a quarter of a
/// hertz apart, within bounds. None for one that is too short.
pub fn segment(
    rows: u64,
    complete: bool,
    samples: Option<u64>,
    rate_hz: Option<f64>,
) -> Option<usize> {
    let half = |n: u64| {
        let n = usize::try_from(n / 2).unwrap_or(LONGEST_SEGMENT);
        (n >= MIN_SEGMENT).then(|| 1 << n.ilog2())
    };
    let most = match (complete, samples) {
        (true, _) => half(rows)?,
        (false, Some(samples)) => half(samples)?,
        (false, None) => LONGEST_BLIND,
    };
    let wanted = match rate_hz {
        Some(rate) if rate.is_finite() => {
            let fine = (4.0 * rate).clamp(SHORTEST as f64, LONGEST_SEGMENT as f64);
            (fine as usize).next_power_of_two()
        }
        _ => SHORTEST,
    };
    Some(wanted.min(most).min(LONGEST_SEGMENT))
}

/// The highest line, if it stands out of the median density, is higher than its neighbours and not among the lowest.
pub fn dominant(densities: &[f64], distance: f64) -> Option<Line> {
    let inner = densities.get(LOWEST..densities.len().checked_sub(1)?)?;
    let (at, &peak) = inner
        .iter()
        .enumerate()
        .max_by(|a, b| a.1.total_cmp(b.1))
        .map(|(k, d)| (k + LOWEST, d))?;
    let floor = median(inner)?;
    let higher = peak >= densities[at - 1] && peak >= densities[at + 1];
    (peak > STANDS_OUT * floor && higher && peak.is_finite())
        .then(|| line(densities, distance, at, floor))
}

/// Lines of the mains and their harmonics, the first of which stands out of its neighbourhood.
pub fn mains(densities: &[f64], distance_hz: f64) -> Vec<Line> {
    MAINS_HZ
        .iter()
        .flat_map(|mains| {
            (1..=HARMONICS)
                .map_while(|harmonic| {
                    let stray = STRAYS_HZ * harmonic as f64;
                    // A missing second harmonic does not end the search; a missing first does.
                    match standing_out(densities, distance_hz, mains * harmonic as f64, stray) {
                        None if harmonic == 1 => None,
                        found => Some(found),
                    }
                })
                .flatten()
                .collect::<Vec<Line>>()
        })
        .collect()
}

/// A line within `stray` of `frequency` that is the highest around and stands out.
fn standing_out(densities: &[f64], distance: f64, frequency: f64, stray: f64) -> Option<Line> {
    let around = AROUND_HZ.max(16.0 * distance);
    let at = |f: f64| (f / distance).round().max(0.0) as usize;
    let (from, to) = (at(frequency - around), at(frequency + around));
    // Lines too far apart, or the rate too low, to tell the mains from anything else.
    if distance > 4.0 * STRAYS_HZ
        || from < LOWEST
        || at(frequency + stray).saturating_add(2) >= densities.len()
    {
        return None;
    }
    let window = &densities[from..to.min(densities.len() - 1)];
    let (peak_at, &peak) = window
        .iter()
        .enumerate()
        .max_by(|a, b| a.1.total_cmp(b.1))
        .map(|(k, d)| (k + from, d))?;
    let near = (peak_at as f64 * distance - frequency).abs() <= stray.max(distance);
    let floor = median(window)?;
    (near && peak > STANDS_OUT * floor && peak.is_finite())
        .then(|| line(densities, distance, peak_at, floor))
}

/// Frequency between the lines and amplitude of a sine that stands at line `at` (and, through the window, its neighbours).
fn line(densities: &[f64], distance: f64, at: usize, floor: f64) -> Line {
    // Hann's lobe: two lines on either side of one between them.
    let lobe = at.saturating_sub(2)..(at + 3).min(densities.len());
    let (mut power, mut moment) = (0.0, 0.0);
    for k in lobe {
        let above = (densities[k] - floor).max(0.0);
        power += above;
        moment += above * k as f64;
    }
    Line {
        frequency: moment / power * distance,
        amplitude: (2.0 * power * distance).sqrt(),
    }
}

/// Median; of an even number of values the upper of the middle two.
pub(super) fn median(values: &[f64]) -> Option<f64> {
    let mut sorted = values.to_vec();
    let middle = sorted.len() / 2;
    (!sorted.is_empty()).then(|| *sorted.select_nth_unstable_by(middle, f64::total_cmp).1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use sixaxis_core::dsp::spectrum::welch;

    /// A reproducible stream of uniform numbers in [-0.5, 0.5).
    fn noise() -> impl Iterator<Item = f64> {
        let mut state = 1u64;
        std::iter::repeat_with(move || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        })
    }

    #[test]
    fn lines_that_stand_at_one_place_have_no_hum() {
        // A rate that no recorder has, as a damaged file may state it: 50 Hz is beyond any number of lines.
        assert_eq!(mains(&[1.0; 65], f64::MIN_POSITIVE), []);
    }

    #[test]
    fn hum_is_found_with_its_amplitude_and_noise_has_none() {
        let rate = 1000.0;
        let series = |hum: f64| -> Vec<f64> {
            noise()
                .take(60_000)
                .enumerate()
                .map(|(k, x)| {
                    let t = k as f64 / rate;
                    x + 8.0 * (std::f64::consts::TAU * 3.1 * t).sin()
                        + hum * (std::f64::consts::TAU * 50.02 * t).sin()
                })
                .collect()
        };
        let lines = |hum: f64| {
            let densities = welch(&series(hum), 4096, rate)
                .expect("long enough")
                .densities;
            let distance = rate / 4096.0;
            (
                mains(&densities, distance),
                dominant(&densities, distance).expect("3.1 Hz"),
            )
        };
        let (none, dominant) = lines(0.0);
        assert_eq!(none, []);
        assert!((dominant.frequency - 3.1).abs() < 0.01 && (dominant.amplitude - 8.0).abs() < 0.1);
        let (found, _) = lines(0.1);
        assert_eq!(found.len(), 1);
        assert!((found[0].frequency - 50.02).abs() < 0.05, "{found:?}");
        assert!((found[0].amplitude - 0.1).abs() < 0.01, "{found:?}");
    }
}
