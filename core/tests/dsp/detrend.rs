//! Offset and trend.

use sixaxis_core::Result;
use sixaxis_core::dsp::detrend::{constant, linear, rest_to_rest_trend};

use crate::golden;
use crate::tolerance;
use crate::{Stage, check_above, check_below, distance, peak, record, thinned};

#[test]
fn ref_scipy_detrend() -> Result<()> {
    let mut series = record(200, 1000.0);
    linear(&mut series)?;
    check_below(
        "linear",
        distance(&thinned(&series, 5), golden::DETREND_LINEAR),
        tolerance::DETREND,
    );
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
    let stages: [Stage; 3] = [
        |x| constant(x).map(|_| ()),
        |x| linear(x).map(|_| ()),
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
    let mut naive = drifted;
    linear(&mut naive)?;
    check_above(
        "motion lost to the least-squares line",
        distance(&naive, &motion),
        tolerance::LINE_THROUGH_MOTION,
    );
    Ok(())
}

#[test]
fn inv_linear_returns_the_line() -> Result<()> {
    let (start, per_sample) = (1e6, 0.25);
    let mut series: Vec<f64> = (0..777)
        .map(|k| start + per_sample * f64::from(k))
        .collect();
    let line = linear(&mut series)?;
    check_below(
        "line",
        distance(&[line.0, line.1 * start], &[start, per_sample * start]),
        tolerance::PROJECTION,
    );
    check_below("rest of it", peak(&series) / start, tolerance::PROJECTION);
    Ok(())
}
