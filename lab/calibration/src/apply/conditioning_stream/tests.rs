//! Streams against whole records, and a failed channel before the low-pass.

use super::*;
use sixaxis_core::LimbSet;
use sixaxis_core::dsp::delay::delayed;
use sixaxis_core::dsp::lag::undo_high_pass;

const RATE_HZ: f64 = 2000.0;

fn rows(samples: u32) -> Vec<Row> {
    (0..samples)
        .map(|k| {
            core::array::from_fn(|limb| {
                let x = core::f64::consts::TAU * 5.0 * f64::from(k) / RATE_HZ;
                1.0 + (x + limb as f64).sin() * (0.01 * x).min(1.0)
            })
        })
        .collect()
}

fn conditioned(config: &ConditioningConfig, rows: &[Row], size: usize) -> Vec<Row> {
    let mut stream = ConditioningStream::new(config, RATE_HZ).expect("prepares");
    let mut out = Voltages::default();
    for part in rows.chunks(size) {
        stream.push(&mut part.iter().collect(), &mut out);
    }
    stream.finish(&mut out).expect("finishes");
    out.rows().collect()
}

fn column(rows: &[Row], limb: usize) -> Vec<f64> {
    rows.iter().map(|row| row[limb]).collect()
}

#[test]
fn delays_as_of_a_whole_record() {
    let rows = rows(3000);
    let delays_s: Row = core::array::from_fn(|limb| 130e-6 * (limb as f64 - 3.0));
    let config = ConditioningConfig {
        delays_s: Some(delays_s),
        ..ConditioningConfig::default()
    };
    let out = conditioned(&config, &rows, 100);
    assert_eq!(out, conditioned(&config, &rows, 3000));
    assert_eq!(out.len(), rows.len());
    for limb in 0..LIMBS {
        let (whole, _) = delayed(&column(&rows, limb), -delays_s[limb], RATE_HZ).expect("shifts");
        for (k, expected) in whole.iter().enumerate().take(2990).skip(10) {
            // Spline and polynomial each: measured 2e-10 of the amplitude.
            assert!((out[k][limb] - expected).abs() < 2e-8, "limb {limb}, {k}");
        }
    }
}

#[test]
fn high_pass_as_of_a_whole_record() {
    let rows = rows(3000);
    let config = ConditioningConfig {
        amplifier_high_pass_hz: Some(0.16),
        ..ConditioningConfig::default()
    };
    let out = conditioned(&config, &rows, 100);
    assert_eq!(out, conditioned(&config, &rows, 7));
    for limb in 0..LIMBS {
        let series = column(&rows, limb);
        let rest = series[..16].iter().sum::<f64>() / 16.0;
        let change: Vec<f64> = series.iter().map(|u| u - rest).collect();
        let whole = undo_high_pass(&change, 0.16, RATE_HZ).expect("undoes");
        let expected: Vec<f64> = whole.iter().map(|change| change + rest).collect();
        assert_eq!(column(&out, limb), expected, "limb {limb}");
    }
}

#[test]
fn neg_what_a_failed_channel_shows_does_not_pass_through_the_low_pass() {
    const LIMB: usize = 3;
    let sound = rows(4000);
    let mut failed = sound.clone();
    for row in &mut failed[2000..] {
        row[LIMB] = f64::NAN;
    }
    let config = ConditioningConfig {
        low_pass_hz: Some(60.0),
        ..ConditioningConfig::default()
    };
    let mut excluded = Exclusions::default();
    excluded.from(2000, LimbSet::EMPTY.with(LIMB));
    let through = [&sound, &failed].map(|rows| {
        let stream = ConditioningStream::new(&config, RATE_HZ).expect("stages");
        let mut stream = stream.holding(&excluded);
        let mut out = Voltages::default();
        stream.push(&mut rows.iter().collect(), &mut out);
        stream.finish(&mut out).expect("long enough");
        out.rows().collect::<Vec<Row>>()
    });
    assert_eq!(through[0], through[1]);
    // Beyond the filter's reach it is the sound channel's, to what the filter has forgotten.
    let expected = conditioned(&config, &sound, 64);
    let reach = config.reach(RATE_HZ) as usize;
    let peak = column(&sound, LIMB)
        .iter()
        .fold(0.0_f64, |a, u| a.max(u.abs()));
    let off = |k: usize| (through[1][k][LIMB] - expected[k][LIMB]).abs() / peak;
    let before = (0..2000 - reach).map(off).fold(0.0, f64::max);
    assert!(
        before < 2e-5 && off(1999) > 1e-3,
        "{before:e} {}",
        off(1999)
    );
    for (found, expected) in through[1].iter().zip(&expected) {
        let others = (0..LIMBS).filter(|limb| *limb != LIMB);
        for limb in others {
            assert!((found[limb] - expected[limb]).abs() < 1e-12 * peak.max(1.0));
        }
    }
}

#[test]
fn a_causal_low_pass_delays_by_what_is_said() {
    let ramp: Vec<Row> = (0..4000).map(|k| [f64::from(k) / RATE_HZ; LIMBS]).collect();
    let config = ConditioningConfig {
        low_pass_hz: Some(20.0),
        causal: true,
        ..ConditioningConfig::default()
    };
    let out = conditioned(&config, &ramp, 64);
    let lag_s = ramp[3999][0] - out[3999][0];
    // The bilinear transform bends frequencies near the corner, not at zero.
    assert!((lag_s / causal_delay_s(20.0) - 1.0).abs() < 1e-3, "{lag_s}");
}
