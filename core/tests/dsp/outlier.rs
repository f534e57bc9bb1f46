//! Wild values.

use sixaxis_core::Result;
use sixaxis_core::dsp::outlier::hampel;

use crate::golden;
use crate::tolerance;
use crate::{check_below, distance, record};

const SPIKES: [(usize, f64); 6] = [
    (0, 4.0),
    (1, -3.0),
    (40, 6.0),
    (41, 6.0),
    (90, -2.0),
    (149, 5.0),
];

fn spiky() -> Vec<f64> {
    let mut series = record(150, 1000.0);
    for (index, height) in SPIKES {
        series[index] += height;
    }
    series
}

#[test]
fn ref_numpy_hampel() -> Result<()> {
    let mut series = spiky();
    let found = hampel(&mut series, 5, 3.0)?;
    assert_eq!(found, golden::HAMPEL_INDICES);
    assert_eq!(found, SPIKES.map(|(index, _)| index));
    check_below(
        "replaced",
        distance(&series, golden::HAMPEL),
        tolerance::HAMPEL,
    );
    // Control: a threshold above the spikes finds none.
    assert!(hampel(&mut spiky(), 5, 1e3)?.is_empty());
    Ok(())
}

#[test]
fn inv_constant_series_has_no_outlier_and_its_spike_is_one() -> Result<()> {
    for at in [0, 1, 25, 48, 49] {
        let mut series = vec![2.5; 50];
        assert!(hampel(&mut series, 3, 3.0)?.is_empty());
        series[at] += f64::EPSILON * 2.0;
        assert_eq!(hampel(&mut series, 3, 3.0)?, [at]);
        assert_eq!(series, vec![2.5; 50]);
    }
    Ok(())
}

#[test]
fn inv_straight_line_is_untouched() -> Result<()> {
    let line: Vec<f64> = (0..60).map(|k| f64::from(k) * 8.0).collect();
    for half_width in 1..20 {
        let mut series = line.clone();
        assert!(hampel(&mut series, half_width, tolerance::HAMPEL_LINE_SIGMAS)?.is_empty());
        assert_eq!(series, line);
    }
    // Control: just below it the ends go.
    let mut series = line;
    assert!(!hampel(&mut series, 4, tolerance::HAMPEL_LINE_SIGMAS - 0.01)?.is_empty());
    Ok(())
}

#[test]
fn inv_wild_samples_do_not_hide_each_other() -> Result<()> {
    let half_width = 6;
    let run = 40..40 + half_width;
    let mut series = record(100, 1000.0);
    for x in &mut series[run.clone()] {
        *x += 50.0;
    }
    let found = hampel(&mut series, half_width, 3.0)?;
    assert!(run.clone().all(|i| found.contains(&i)), "{found:?}");
    // Control: one more is the majority of some window, and its middle passes for sound.
    let mut series = record(100, 1000.0);
    for x in &mut series[40..=40 + half_width] {
        *x += 50.0;
    }
    let found = hampel(&mut series, half_width, 3.0)?;
    assert!(
        !(40..=40 + half_width).all(|i| found.contains(&i)),
        "{found:?}"
    );
    Ok(())
}
