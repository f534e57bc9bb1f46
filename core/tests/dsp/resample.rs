//! The cubic spline, and a channel's delay.

use core::f64::consts::TAU;

use sixaxis_core::dsp::resample::{CubicSpline, MIN_SAMPLES};
use sixaxis_core::{Error, Result};

use crate::golden;
use crate::tolerance;
use crate::{Noise, check_above, check_below, distance, record, sine};

/// Time stamps off the even ones by up to `share` of half a step: `jittered` in `dsp.py`.
fn jittered(samples: usize, rate_hz: f64, share: f64) -> Vec<f64> {
    let mut noise = Noise(golden::SEED + 1);
    (0..samples)
        .map(|k| (k as f64 + share * noise.next()) / rate_hz)
        .collect()
}

fn even(samples: usize, rate_hz: f64) -> Vec<f64> {
    (0..samples).map(|k| k as f64 / rate_hz).collect()
}

/// Steps from 0.5 to 64 000.
fn growing() -> Vec<f64> {
    (0..30).map(|k| 1.5_f64.powi(k)).collect()
}

/// Times from the first to the last stamp, evenly: `spread` in `dsp.py`.
fn spread(times: &[f64], wanted: usize) -> Vec<f64> {
    let (first, last) = (times[0], times[times.len() - 1]);
    (0..=wanted)
        .map(|k| (first + (last - first) * (k as f64 / wanted as f64)).min(last))
        .collect()
}

#[test]
fn ref_scipy_spline() -> Result<()> {
    let shrinking = growing().iter().rev().map(|t| -t).collect();
    let cases: [(&str, Vec<f64>, usize, &[f64]); 6] = [
        ("even", even(200, 1000.0), 67, golden::SPLINE_EVEN),
        (
            "jittered",
            jittered(200, 1000.0, 0.9),
            67,
            golden::SPLINE_JITTERED,
        ),
        ("growing steps", growing(), 40, golden::SPLINE_GROWING),
        ("shrinking steps", shrinking, 40, golden::SPLINE_SHRINKING),
        ("4 samples", jittered(4, 1000.0, 0.9), 12, golden::SPLINE_4),
        ("5 samples", jittered(5, 1000.0, 0.9), 12, golden::SPLINE_5),
    ];
    for (what, times, wanted, expected) in cases {
        let values = record(times.len(), 1000.0);
        let wanted = spread(&times, wanted);
        let ours = CubicSpline::through(&times, &values)?.at_each(&wanted)?;
        check_below(what, distance(&ours, expected), tolerance::SPLINE);
        // Control: the second and the last but one stamp off by a hundredth of their step.
        let mut off = times.clone();
        let n = off.len();
        off[1] += 0.01 * (off[2] - off[1]);
        off[n - 2] += 0.01 * (off[n - 1] - off[n - 2]);
        let ours = CubicSpline::through(&off, &values)?.at_each(&wanted)?;
        check_above(what, distance(&ours, expected), tolerance::SPLINE_STAMP_OFF);
        if what == "even" {
            let ours = CubicSpline::even(&values, 1000.0)?.at_each(&wanted)?;
            check_below(
                "even, without stamps",
                distance(&ours, expected),
                tolerance::SPLINE,
            );
        }
    }
    Ok(())
}

/// A sine read halfway between its samples, away from the ends, against its true values there.
fn halfway_error(share: f64) -> Result<f64> {
    let samples = 400;
    let spline = CubicSpline::even(&sine(samples, share, 1.0), 1.0)?;
    let halfway: Vec<f64> = (50..samples - 50).map(|k| k as f64 - 0.5).collect();
    let truth: Vec<f64> = halfway.iter().map(|t| (TAU * share * t).sin()).collect();
    Ok(distance(&spline.at_each(&halfway)?, &truth))
}

#[test]
fn order_spline() -> Result<()> {
    for share in [0.05, 0.02, 0.01] {
        let phase = TAU * share;
        // What the spline of exp(i phase k) is halfway, from its recursion in closed form.
        let (whole, half) = (phase.cos(), (phase / 2.0).cos());
        let gain = half * (1.0 + 0.75 * (1.0 - whole) / (2.0 + whole));
        let error = halfway_error(share)?;
        check_below(
            "halfway error over the closed form, less 1",
            (error / (1.0 - gain) - 1.0).abs(),
            tolerance::SPLINE_GAIN,
        );
        check_below(
            "the same over (2 pi f/F)^4/384",
            (error / (phase.powi(4) / 384.0) - 1.0).abs(),
            tolerance::SPLINE_LEADING_TERM * phase * phase,
        );
        let order = (error / halfway_error(share / 2.0)?).log2();
        check_below(
            "order against 4",
            (order - 4.0).abs(),
            tolerance::SPLINE_ORDER,
        );
    }
    Ok(())
}

/// Largest error of a sine of any phase: in the first few steps, and half a record in.
fn sine_errors(share: f64) -> Result<([f64; 4], f64)> {
    let (mut ends, mut interior) = ([0.0_f64; 4], 0.0_f64);
    for turn in 0..24 {
        let phase = TAU * f64::from(turn) / 24.0;
        let truth = |t: f64| (TAU * share * t + phase).sin();
        let samples: Vec<f64> = (0..200).map(|k| truth(f64::from(k))).collect();
        let spline = CubicSpline::even(&samples, 1.0)?;
        let error = |t: f64| -> Result<f64> { Ok((spline.at(t)? - truth(t)).abs()) };
        for part in 1..20 {
            let part = f64::from(part) / 20.0;
            for (step, end) in ends.iter_mut().enumerate() {
                let t = step as f64 + part;
                *end = end.max(error(t)?).max(error(199.0 - t)?);
            }
            for step in 80..120 {
                interior = interior.max(error(f64::from(step) + part)?);
            }
        }
    }
    Ok((ends, interior))
}

#[test]
fn inv_sine_read_between_samples() -> Result<()> {
    for (share, between, at_ends) in tolerance::SINE_READ {
        let (ends, interior) = sine_errors(share)?;
        println!("at {share} of the sample rate, steps from an end: {ends:?}");
        check_below("between samples", interior, between);
        check_below("in the first step", ends[0], at_ends);
        // Controls: the table in the documentation is not far above what is true.
        check_above(
            "between samples",
            interior,
            tolerance::TABLE_IS_TIGHT * between,
        );
        check_above(
            "in the first step",
            ends[0],
            tolerance::TABLE_IS_TIGHT * at_ends,
        );
    }
    Ok(())
}

/// What one sample does to the spline, from step to step away from it.
#[test]
fn inv_influence_of_a_sample_falls_by_two_plus_root_three() -> Result<()> {
    for wild in [0, 1, 20] {
        let mut values = vec![0.0; 60];
        values[wild] = 1.0;
        let spline = CubicSpline::even(&values, 1.0)?;
        for step in wild + 3..wild + 15 {
            let (near, far) = (spline.at(step as f64 + 0.5)?, spline.at(step as f64 + 1.5)?);
            check_below(
                "fall over (2 + sqrt 3), less 1",
                (-near / far / (2.0 + 3.0_f64.sqrt()) - 1.0).abs(),
                tolerance::SPLINE_FALL,
            );
        }
    }
    Ok(())
}

#[test]
fn inv_cubic_is_read_exactly() -> Result<()> {
    let times = jittered(50, 10.0, 0.9);
    let power = |degree: i32| move |t: &f64| (t - 2.0).powi(degree) - 0.5 * (t - 1.0);
    let away = |degree: i32| -> Result<f64> {
        let values: Vec<f64> = times.iter().map(power(degree)).collect();
        let wanted = spread(&times, 333);
        let truth: Vec<f64> = wanted.iter().map(power(degree)).collect();
        let ours = CubicSpline::through(&times, &values)?.at_each(&wanted)?;
        Ok(distance(&ours, &truth))
    };
    for degree in 0..=3 {
        check_below(
            &format!("degree {degree}"),
            away(degree)?,
            tolerance::CUBIC_READ,
        );
    }
    check_above("degree 4", away(4)?, tolerance::QUARTIC_READ);
    Ok(())
}

#[test]
fn inv_samples_come_back() -> Result<()> {
    let values = record(300, 1000.0);
    for times in [even(300, 1000.0), jittered(300, 1000.0, 0.9)] {
        assert_eq!(
            CubicSpline::through(&times, &values)?.at_each(&times)?,
            values
        );
    }
    // The last sample's time comes rounded, at some rates beyond the end.
    let mut beyond = 0;
    for rate in 1..1000 {
        let rate_hz = f64::from(rate);
        let spline = CubicSpline::even(&values, rate_hz)?;
        for last_s in [299.0 / rate_hz, 299.0 * (1.0 / rate_hz)] {
            beyond += usize::from(last_s * rate_hz > 299.0);
            let away = (spline.at(last_s)? - values[299]).abs();
            assert!(away < tolerance::SAMPLE_READ, "{rate} Hz: {away:e}");
        }
    }
    assert!(beyond > 0);
    for rate_hz in [1000.0, 3.0, 44_100.0, 1.0 / 3.0, 7e-5] {
        let step_s = 1.0 / rate_hz;
        let spline = CubicSpline::even(&values, rate_hz)?;
        for times in [
            even(300, rate_hz),
            (0..300).map(|k| f64::from(k) * step_s).collect(),
        ] {
            let away = distance(&spline.at_each(&times)?, &values);
            check_below("even samples", away, tolerance::SAMPLE_READ);
        }
    }
    Ok(())
}

#[test]
fn inv_spline_is_linear_and_knows_no_unit_of_time() -> Result<()> {
    let times = jittered(80, 1000.0, 0.9);
    let wanted = spread(&times, 200);
    let (a, b) = (record(80, 1000.0), record(80, 300.0));
    let sum: Vec<f64> = a.iter().zip(&b).map(|(x, y)| 3.0 * x - 0.7 * y).collect();
    let read = |values: &[f64]| CubicSpline::through(&times, values)?.at_each(&wanted);
    let together: Vec<f64> = read(&a)?
        .iter()
        .zip(read(&b)?)
        .map(|(x, y)| 3.0 * x - 0.7 * y)
        .collect();
    check_below(
        "sum",
        distance(&read(&sum)?, &together),
        tolerance::SPLINE_SUM,
    );
    // Powers of two, so that the stamps are the same ones: nothing may change, even where squares of steps underflow.
    for unit in [2.0_f64.powi(-600), 2.0_f64.powi(10), 2.0_f64.powi(600)] {
        let scaled = |times: &[f64]| times.iter().map(|t| t * unit).collect::<Vec<_>>();
        let ours = CubicSpline::through(&scaled(&times), &a)?.at_each(&scaled(&wanted))?;
        assert_eq!(ours, read(&a)?, "unit {unit:e}");
    }
    Ok(())
}

#[test]
fn inv_time_outside_the_record_is_refused() -> Result<()> {
    let values = record(50, 1000.0);
    let outside = |result| matches!(result, Err(Error::OutOfRange { name: "time_s", .. }));
    let spline = CubicSpline::even(&values, 1000.0)?;
    for time_s in [
        -1e-9,
        0.049 + 1e-9,
        f64::NAN,
        f64::INFINITY,
        -1e300,
        f64::MAX,
    ] {
        assert!(outside(spline.at(time_s)), "{time_s}");
        assert!(outside(spline.at_each(&[0.01, time_s]).map(|_| 0.0)));
    }
    let times = jittered(50, 1000.0, 0.9);
    let (first, last) = (times[0], times[49]);
    let spline = CubicSpline::through(&times, &values)?;
    assert_eq!(spline.at(first)?, values[0]);
    assert_eq!(spline.at(last)?, values[49]);
    for time_s in [
        first.next_down(),
        last.next_up(),
        f64::NAN,
        f64::NEG_INFINITY,
    ] {
        assert!(outside(spline.at(time_s)), "{time_s}");
    }
    Ok(())
}

#[test]
fn inv_stamps_that_do_not_advance_are_named() {
    let values = record(20, 1000.0);
    for (stamp, sample) in [
        (0.010, 11),
        (0.0101, 11),
        (0.0, 10),
        (f64::NAN, 10),
        (f64::INFINITY, 10),
        (f64::NEG_INFINITY, 10),
    ] {
        let mut times = even(20, 1000.0);
        times[10] = stamp;
        // The same stamp twice, and one that goes back, are the fault of the later one.
        if sample == 11 {
            times[11] = 0.010;
        }
        assert!(
            matches!(
                CubicSpline::through(&times, &values),
                Err(Error::IrregularTime { sample: s, .. }) if s == sample
            ),
            "{stamp}"
        );
    }
    let refused = |times: &[f64]| CubicSpline::through(times, &values[..times.len()]).err();
    assert_eq!(
        refused(&[1.0, 2.0, 3.0, 2.5, 5.0]),
        Some(Error::IrregularTime {
            sample: 3,
            time_s: 2.5,
            previous_s: 3.0,
            expected_step_s: 1.0,
        })
    );
    // Increasing and finite, but not their difference.
    assert!(matches!(
        refused(&[-2.0, -1.0, 0.0, -f64::MAX, f64::MAX]),
        Some(Error::IrregularTime { sample: 3, .. })
    ));
    assert!(matches!(
        refused(&[-f64::MAX, f64::MAX, f64::INFINITY, f64::INFINITY]),
        Some(Error::IrregularTime { sample: 1, .. })
    ));
    let mut times = even(20, 1000.0);
    times[0] = f64::NAN;
    assert!(matches!(
        CubicSpline::through(&times, &values),
        Err(Error::IrregularTime { sample: 1, .. })
    ));
    assert!(matches!(
        CubicSpline::through(&even(19, 1000.0), &values),
        Err(Error::LengthMismatch {
            expected: 20,
            got: 19,
            ..
        })
    ));
}

#[test]
fn inv_what_no_spline_goes_through_is_refused() -> Result<()> {
    for n in 0..MIN_SAMPLES {
        let (times, values) = (even(n, 1000.0), record(n, 1000.0));
        let short = |result: Result<()>| matches!(result, Err(Error::TooFewSamples { got, .. }) if got == n);
        assert!(short(CubicSpline::even(&values, 1000.0).map(|_| ())));
        assert!(short(CubicSpline::through(&times, &values).map(|_| ())));
    }
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut values = record(50, 1000.0);
        values[31] = bad;
        let named = |result: Result<()>| matches!(result, Err(Error::NotFinite { sample: 31, .. }));
        assert!(named(CubicSpline::even(&values, 1000.0).map(|_| ())));
        assert!(named(
            CubicSpline::through(&even(50, 1000.0), &values).map(|_| ())
        ));
    }
    let values = record(50, 1000.0);
    let refused = |result: Result<()>| matches!(result, Err(Error::OutOfRange { .. }));
    for rate_hz in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(refused(CubicSpline::even(&values, rate_hz).map(|_| ())));
    }
    let huge: Vec<f64> = (0..50)
        .map(|k| if k % 2 == 0 { f64::MAX } else { -f64::MAX })
        .collect();
    let overflow = |result: Result<()>| matches!(result, Err(Error::Overflow { .. }));
    assert!(overflow(CubicSpline::even(&huge, 1000.0).map(|_| ())));
    let mut times = even(50, 1000.0);
    times[1] = f64::MIN_POSITIVE;
    times[2] = 2.0 * f64::MIN_POSITIVE;
    assert!(overflow(
        CubicSpline::through(&times, &record(50, 1000.0)).map(|_| ())
    ));
    Ok(())
}

/// Any increasing stamps, any values: an answer between samples that is finite and bounded, or a typed refusal.
#[test]
fn prop_any_stamps_give_an_answer_or_a_refusal() {
    let mut noise = Noise(golden::SEED + 2);
    let mut answers = 0;
    for round in 0..2000 {
        let n = MIN_SAMPLES + round % 9;
        let mut t = 0.0;
        let times: Vec<f64> = (0..n)
            .map(|_| {
                t += 10.0_f64.powf(40.0 * noise.next());
                t
            })
            .collect();
        let values: Vec<f64> = (0..n).map(|_| noise.next()).collect();
        let Ok(spline) = CubicSpline::through(&times, &values) else {
            continue;
        };
        for pair in times.windows(2) {
            let t = pair[0] + (pair[1] - pair[0]) * (noise.next() + 0.5);
            if let Ok(value) = spline.at(t) {
                assert!(value.is_finite());
                answers += 1;
            }
        }
        assert_eq!(spline.at_each(&times), Ok(values));
    }
    assert!(answers > 1000, "{answers}");
}
