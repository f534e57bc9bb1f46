//! Offset and trend.

use sixaxis_core::Result;
use sixaxis_core::dsp::detrend::{constant, rest_to_rest_trend};

use crate::golden;
use crate::tolerance;
use crate::{Stage, check_above, check_below, distance, peak, record, thinned};

#[test]
fn ref_scipy_detrend() -> Result<()> {
    let mut series = record(200, 1000.0);
    constant(&mut series)?;
    check_below(
        "constant",
        distance(&thinned(&series, 5), golden::DETREND_CONSTANT),
        tolerance::DETREND,
    );
    Ok(())
}

#[test]
fn inv_detrending_is_a_projection() -> Result<()> {
    let stages: [Stage; 2] = [
        |x| constant(x).map(|_| ()),
        |x| rest_to_rest_trend(x, 20).map(|_| ()),
    ];
    for stage in stages {
        let original = record(500, 1000.0);
        let mut once = original.clone();
        stage(&mut once)?;
        let mut twice = once.clone();
        stage(&mut twice)?;
        let change = distance(&twice, &once) * peak(&once) / peak(&original);
        check_below("twice against once", change, tolerance::PROJECTION);
    }
    Ok(())
}

/// One-sided motion between two rests of `REST` samples, 0 at rest, and a line under it.
const REST: usize = 100;

fn motion() -> Vec<f64> {
    (0..1000)
        .map(|k| match k {
            REST..900 => (core::f64::consts::PI * (k - REST) as f64 / 800.0)
                .sin()
                .powi(2),
            _ => 0.0,
        })
        .collect()
}

#[test]
fn inv_between_rests_leaves_the_motion() -> Result<()> {
    let motion = motion();
    let (start, per_sample) = (2.0, -3e-4);
    let drifted: Vec<f64> = motion
        .iter()
        .enumerate()
        .map(|(k, x)| x + start + per_sample * k as f64)
        .collect();
    let mut ours = drifted.clone();
    let line = rest_to_rest_trend(&mut ours, REST)?;
    check_below(
        "motion",
        distance(&ours, &motion),
        tolerance::LINE_BETWEEN_RESTS,
    );
    check_below(
        "line",
        distance(&[line.0, line.1 * 1000.0], &[start, per_sample * 1000.0]),
        tolerance::LINE_BETWEEN_RESTS,
    );
    // Control: the least-squares line takes part of the motion for drift.
    let naive = without_least_squares_line(&drifted);
    check_above(
        "motion lost to the least-squares line",
        distance(&naive, &motion),
        tolerance::LINE_THROUGH_MOTION,
    );
    Ok(())
}

/// A record less its least-squares line.
fn without_least_squares_line(series: &[f64]) -> Vec<f64> {
    let n = series.len() as f64;
    let mean = series.iter().sum::<f64>() / n;
    let place = |k: usize| k as f64 - 0.5 * (n - 1.0);
    let moment: f64 = series.iter().enumerate().map(|(k, x)| place(k) * x).sum();
    let slope = moment / (n * (n * n - 1.0) / 12.0);
    let less_line = |(k, x): (usize, &f64)| x - mean - slope * place(k);
    series.iter().enumerate().map(less_line).collect()
}
