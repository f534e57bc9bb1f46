//! Gaps, jitter, and rates that stamps contradict.

use super::*;

fn clock(stamps_s: &[f64], rate_hz: Option<f64>) -> Clock {
    let time = Column {
        index: 0,
        name: "time".to_owned(),
        size_si: 1.0,
    };
    let mut clock = Clock::new(&time, rate_hz);
    clock.extend(stamps_s);
    clock.settle();
    clock
}

fn stamps(stamps_s: &[f64], rate_hz: Option<f64>) -> Stamps {
    clock(stamps_s, rate_hz).finish()
}

fn fault(stamps_s: &[f64]) -> Option<StampFault> {
    clock(stamps_s, None).fault()
}

#[test]
fn stamps_in_days_are_no_seconds() {
    let days: Vec<f64> = (0..50)
        .map(|k| 45_443.5 + f64::from(k) / 86_400e3)
        .collect();
    let refused = fault(&days).expect("no converter is as fast");
    assert!(
        refused.cause.contains("if they are days"),
        "{}",
        refused.cause
    );
    let fast: Vec<f64> = (0..50).map(|k| f64::from(k) * 1e-6).collect();
    assert_eq!(fault(&fast), None);
}

#[test]
fn one_missing_sample_is_a_gap_and_jitter_is_none() {
    let even: Vec<f64> = (0..50).map(|k| 5.0 + 0.1 * f64::from(k)).collect();
    assert_eq!(fault(&even), None);
    let found = stamps(&even, Some(10.0));
    assert!(!found.uneven(10.0));
    assert!((found.mean_rate_hz.expect("a rate") - 10.0).abs() < 1e-9);
    let mut jitter = even.clone();
    jitter[7] += 0.04;
    assert_eq!(fault(&jitter), None);
    let found = stamps(&jitter, Some(10.0));
    assert!(found.uneven(10.0));
    assert!((found.largest_departure_s - 0.04).abs() < 1e-12);
    let mut gap = even.clone();
    gap.remove(20);
    let missing = fault(&gap).expect("a sample is missing");
    assert_eq!(missing.sample, 20);
    assert!(missing.cause.contains("gap of 0.2"), "{}", missing.cause);
    for broken in [even[10], even[9], f64::NAN] {
        let mut stamps_s = even.clone();
        stamps_s[11] = broken;
        let found = fault(&stamps_s).expect("a broken stamp");
        assert_eq!(found.sample, 11, "{broken}");
    }
}

#[test]
fn stamps_rounded_too_far_are_no_missing_samples() {
    let rounded: Vec<f64> = (0..600)
        .map(|k| (f64::from(k) / 0.75).round() * 1e-3)
        .collect();
    let refused = fault(&rounded).expect("no even clock");
    assert!(refused.cause.contains("rounded"), "{}", refused.cause);
}

#[test]
fn another_rate_contradicts_the_stamps() {
    let stamps_s: Vec<f64> = (0..1200).map(|k| f64::from(k) * 1.002e-3).collect();
    let found = stamps(&stamps_s, None);
    assert!(found.check_rate(1000.0).is_err());
    assert!(found.check_rate(1.0 / 1.002e-3).is_ok());
    // A wrong rate is no gap.
    assert_eq!(fault(&stamps_s), None);
}
