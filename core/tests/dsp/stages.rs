//! Stages over a stream: the same samples however the stream is cut, and those of the whole record.

use sixaxis_core::Result;
use sixaxis_core::dsp::butterworth::{Section, low_pass};
use sixaxis_core::dsp::causal::Causal;
use sixaxis_core::dsp::continued::{self, ContinuedZeroPhase};
use sixaxis_core::dsp::delay::{Delay, delayed};
use sixaxis_core::dsp::lag::{UndoHighPass, undo_high_pass};
use sixaxis_core::dsp::outlier::{Hampel, hampel};
use sixaxis_core::dsp::spectrum::{Welch, welch};
use sixaxis_core::dsp::stage::Stage;
use sixaxis_core::dsp::zero_phase::{ZeroPhase, padding, settling_samples, zero_phase};

use crate::tolerance;
use crate::{check_above, check_below, distance, record};

const RATE_HZ: f64 = 1000.0;

/// The stream in parts of a size.
fn streamed(mut stage: impl Stage, series: &[f64], size: usize) -> Result<Vec<f64>> {
    let mut out = Vec::new();
    for part in series.chunks(size) {
        stage.push(part, &mut out);
    }
    stage.finish(&mut out)?;
    assert_eq!(out.len(), series.len());
    Ok(out)
}

#[test]
fn inv_a_stream_equals_the_whole() -> Result<()> {
    let mut series = record(300, RATE_HZ);
    series[40] += 6.0;
    series[299] -= 5.0;
    for size in [1, 7, 300] {
        let mut whole = series.clone();
        let found = hampel(&mut whole, 5, 4.0)?;
        assert!(found.contains(&40) && found.contains(&299));
        assert_eq!(streamed(Hampel::new(5, 4.0)?, &series, size)?, whole);
        for samples in [0.0, 0.3, -0.3, 12.0, -12.0, 40.7, -40.7, 298.5, -298.5] {
            let (whole, _) = delayed(&series, samples / 1024.0, 1024.0)?;
            assert_eq!(streamed(Delay::new(samples)?, &series, size)?, whole);
        }
        assert_eq!(
            streamed(UndoHighPass::new(2.0, RATE_HZ)?, &series, size)?,
            undo_high_pass(&series, 2.0, RATE_HZ)?
        );
        let sections = low_pass(4, 50.0, RATE_HZ)?;
        assert_eq!(
            streamed(Causal::new(sections.clone()), &series, size)?,
            streamed(Causal::new(sections), &series, 300)?
        );
    }
    Ok(())
}

#[test]
fn inv_a_zero_phase_stream_equals_the_whole() -> Result<()> {
    for (order, corner_hz, samples) in [(4, 6.0, 60_000), (1, 200.0, 40_000), (2, 15.0, 17)] {
        let sections = low_pass(order, corner_hz, RATE_HZ)?;
        let series = record(samples, RATE_HZ);
        let mut whole = series.clone();
        zero_phase(&sections, &mut whole)?;
        let mut continued = series.clone();
        continued::zero_phase(&sections, &mut continued)?;
        for size in [1, 777, 100_000] {
            let ours = streamed(ZeroPhase::new(&sections)?, &series, size)?;
            check_below(
                "stream against the whole",
                distance(&ours, &whole),
                tolerance::ZERO_PHASE_STREAM,
            );
            let ours = streamed(ContinuedZeroPhase::new(&sections)?, &series, size)?;
            check_below(
                "continued stream against the whole",
                distance(&ours, &continued),
                tolerance::ZERO_PHASE_STREAM,
            );
        }
        // Control: forwards only.
        let causal = streamed(Causal::new(sections), &series, samples)?;
        check_above(
            "causal",
            distance(&causal, &whole),
            1e6 * tolerance::ZERO_PHASE_STREAM,
        );
    }
    Ok(())
}

/// A section with two real poles, the farther of which is far beyond the root of their product, and a gain of one.
fn real_poles(far: f64, near: f64) -> Section {
    Section {
        b: [(1.0 - far) * (1.0 - near), 0.0, 0.0],
        a: [-(far + near), far * near],
    }
}

#[test]
fn inv_the_farther_pole_says_how_long_a_filter_rings() -> Result<()> {
    let sections = [real_poles(0.999, 0.001)];
    let settled = settling_samples(&sections);
    assert!(0.999_f64.powi(settled as i32) < tolerance::FORGOTTEN);
    assert_eq!(settling_samples(&[real_poles(2.0, 0.1)]), usize::MAX);
    assert_eq!(settling_samples(&[real_poles(0.1, -1.0)]), usize::MAX);
    let series = record(200_000, RATE_HZ);
    let mut whole = series.clone();
    zero_phase(&sections, &mut whole)?;
    let ours = streamed(ZeroPhase::new(&sections)?, &series, 777)?;
    let away = distance(&ours, &whole);
    check_below("real poles", away, tolerance::ZERO_PHASE_STREAM);
    // Three times the filter's length as SciPy counts it: without a b_2 and without an a_2, whichever are fewer.
    let first = Section {
        b: [0.5, 0.5, 0.0],
        a: [-0.2, 0.0],
    };
    let extensions = [
        vec![first; 2],
        sections.to_vec(),
        low_pass(3, 50.0, RATE_HZ)?,
    ];
    assert_eq!(extensions.map(|sections| padding(&sections)), [9, 9, 12]);
    Ok(())
}

#[test]
fn inv_a_record_too_short_for_the_extension_is_refused() -> Result<()> {
    let sections = low_pass(4, 12.0, RATE_HZ)?;
    assert!(streamed(ZeroPhase::new(&sections)?, &record(15, RATE_HZ), 4).is_err());
    assert!(streamed(Hampel::new(5, 3.0)?, &record(10, RATE_HZ), 4).is_err());
    Ok(())
}

#[test]
fn inv_a_streamed_spectrum_is_that_of_the_whole() -> Result<()> {
    let series = record(1000, RATE_HZ);
    let whole = welch(&series, 64, RATE_HZ)?;
    for size in [1, 7, 1000] {
        let mut stream = Welch::new(64)?;
        for part in series.chunks(size) {
            stream.push(part);
        }
        assert_eq!(stream.spectrum(RATE_HZ), Some(whole.clone()));
    }
    // A gap costs the segments that it lies in.
    let mut gap = series;
    gap[500] = f64::NAN;
    let mut stream = Welch::new(64)?;
    stream.push(&gap);
    assert_eq!(stream.left_out(), 2);
    Ok(())
}

#[test]
fn inv_without_a_segment_there_is_no_spectrum() -> Result<()> {
    let mut stream = Welch::new(64)?;
    stream.push(&record(63, RATE_HZ));
    assert_eq!(stream.spectrum(RATE_HZ), None);
    stream.push(&[0.0]);
    assert!(stream.spectrum(RATE_HZ).is_some());
    Ok(())
}

#[test]
fn neg_a_stream_too_short_to_continue_is_refused() -> Result<()> {
    let sections = low_pass(4, 6.0, RATE_HZ)?;
    let least = padding(&sections) + 1;
    let series = record(least, RATE_HZ);
    for samples in [0, 1, least - 1, least] {
        let mut stage = ContinuedZeroPhase::new(&sections)?;
        let mut out = Vec::new();
        stage.push(&series[..samples], &mut out);
        assert_eq!(
            stage.finish(&mut out).is_ok(),
            samples == least,
            "{samples}"
        );
    }
    Ok(())
}

/// Largest answer to an impulse so many samples after it, of the largest at all.
fn rings_on(sections: &[Section], samples: usize) -> Result<f64> {
    let mut series = vec![0.0; 3 * samples + 100];
    // A cascade begins in the steady state of its first sample.
    series[1] = 1.0;
    let answer = streamed(Causal::new(sections.to_vec()), &series, 1000)?;
    Ok(crate::peak(&answer[1 + samples..]) / crate::peak(&answer))
}

#[test]
fn inv_a_cascade_forgets_within_its_settling() -> Result<()> {
    for corner_hz in [2.0, 30.0, 300.0] {
        for (order, copies) in [(1, 1), (1, 8), (2, 1), (2, 8), (5, 1), (8, 3)] {
            let sections = low_pass(order, corner_hz, RATE_HZ)?.repeat(copies);
            let samples = settling_samples(&sections);
            check_below(
                "what a cascade has not forgotten",
                rings_on(&sections, samples)?,
                tolerance::FORGOTTEN,
            );
            // Control: a third of it is not enough, and so it is no needless wait.
            check_above(
                "a third of the settling",
                rings_on(&sections, samples / 3)?,
                tolerance::FORGOTTEN,
            );
        }
    }
    // Without a pole an impulse is answered for as long as the numerator is.
    let average = Section {
        b: [0.25, 0.5, 0.25],
        a: [0.0, 0.0],
    };
    let samples = settling_samples(&[average]);
    check_below(
        "what a mean has not forgotten",
        rings_on(&[average], samples)?,
        tolerance::FORGOTTEN,
    );
    let mut unstable = low_pass(2, 30.0, RATE_HZ)?;
    unstable[0].a[1] = 1.0;
    assert_eq!(settling_samples(&unstable), usize::MAX);
    Ok(())
}
