//! Compound runs in closed form that fail for one reason: that reason is named, and no other.

use core::f64::consts::TAU;

use glam::DVec3;
use sixaxis_core::Gains;

use super::*;
use crate::calibrate::evidence;
use crate::diagnosis::trial_case::TrialCase;
use crate::grade::tests::session;
use crate::progress::NoProgress;

#[path = "../../../tests/judgement/waveform.rs"]
mod waveform;

use waveform::Timing;

const RATE_HZ: f64 = 1000.0;
const FREQUENCY_HZ: f64 = 5.0;
const TIMING: Timing = Timing {
    rest_s: 0.3,
    ramp_s: 0.4,
    run_s: 2.0,
};
const SAMPLES: usize = 2000;
/// Rest before the motion that is not recorded, s: with all of it the zeros that it shows close the run.
const LATE_S: f64 = 0.27;
/// Amplitudes of travel and rotation: with these the open loop loses a run that hardly rests and whose zeros are off by a hundredth of its signal.
const TRAVEL_M: f64 = 0.09;
const TURN_RAD: f64 = 1.7;
const GAIN_N_PER_V: f64 = 10.0;
/// Width of the channels' noise where there is little of it, V.
const QUIET_V: f64 = 2e-3;

/// What a run is said to fail by; none where it does not, or cannot be decoupled at all. Its channels have noise of such a width, V, and
/// show what `wrong` makes of it, as channel, from 0, sample and voltage say.
fn said(noise_v: f64, wrong: impl Fn(usize, usize, f64) -> f64) -> Option<Finding> {
    let session = session();
    let parameters = session.sensor.design();
    let n = DVec3::new(2.0, 1.0, 1.0).normalize();
    let omega = TAU * FREQUENCY_HZ;
    let course = |sample: usize| TIMING.course(LATE_S + sample as f64 / RATE_HZ, omega);
    let each = |of: &dyn Fn([f64; 3]) -> f64| -> Vec<f64> {
        (0..SAMPLES).map(|sample| of(course(sample))).collect()
    };
    let accelerometer_m_s2 = each(&|[_, _, a]| a * omega * omega * TRAVEL_M);
    let gyroscope_rad_s = each(&|[_, w, _]| w * omega * TURN_RAD);
    let angular = each(&|[_, _, a]| a * omega * omega * TURN_RAD);
    let along = |series: &[f64]| series.iter().map(|x| n * *x).collect();
    let standards = Conditioned {
        voltage_v: Vec::new(),
        linear_ground_m_s2: along(&accelerometer_m_s2),
        rate_shell_rad_s: along(&gyroscope_rad_s),
        angular_shell_rad_s2: along(&angular),
        outliers: 0,
        zero_wander_v: [0.0; LIMBS],
    };
    let mut run = Trial {
        name: "compound".to_owned(),
        role: Role::Validation,
        sample_rate_hz: RATE_HZ,
        gains: Gains::uniform(GAIN_N_PER_V),
        full_scale_v: 10.0,
        voltage_v: Vec::new(),
        accelerometer_m_s2,
        gyroscope_rad_s,
        limbs_band_hz: f64::INFINITY,
        standards_band_hz: f64::INFINITY,
        direction_ground: n,
        gravity_ground_m_s2: n * -9.80665,
        frequency_hz: FREQUENCY_HZ,
    };
    let decoding = Decoding {
        parameters: &parameters,
        limbs: None,
    };
    let mut numbers = Pcg64::seed_from_u64(2);
    let mut noise = || noise_v * (numbers.random::<f64>() - 0.5);
    let campaign = PreparedSession::of(&session, Vec::new(), &NoProgress).campaign;
    let clean = following(&campaign, &decoding, &run, &standards).expect("the paper's sensor");
    run.voltage_v = (clean.voltage_v.iter().enumerate())
        .map(|(sample, row)| core::array::from_fn(|i| wrong(i, sample, row[i]) + noise()))
        .collect();
    let rest = Trial {
        name: "static".to_owned(),
        role: Role::Static,
        voltage_v: (0..4000)
            .map(|_| core::array::from_fn(|_| noise()))
            .collect(),
        ..run.clone()
    };
    let prepared = PreparedSession::of(&session, vec![rest, run], &NoProgress);
    let [(trial, conditioned)] = &prepared.campaign.trials[..] else {
        panic!("{:?}", prepared.findings)
    };
    let case = TrialCase {
        trial,
        conditioned,
        force_n: Vec::new(),
        response: None,
        ignored: [false; LIMBS],
        explained: false,
    };
    let mut report = evidence::trial_report(&case, None);
    let run = compare(&prepared.campaign, trial, conditioned, &decoding).ok()?;
    report.validation = Some(errors(&run, arm_m(&parameters)));
    let off = worst(&report.validation.unwrap_or_default());
    if !fails(off, session.limits.validation_percent) {
        return None;
    }
    let mut failure = Finding::new(Cause::Unexplained, "it departs", "").in_trial(trial);
    explain(
        &mut failure,
        &[],
        &prepared,
        Some(&decoding),
        &[report],
        &session.limits,
    );
    Some(failure)
}

/// The smallest size from this one on, each twice the one before, with which a run fails, and what it is said to fail by.
fn first(size: f64, said: impl Fn(f64) -> Option<Finding>) -> (f64, Finding) {
    let mut sizes = (0..10).map(|doublings| size * f64::from(1 << doublings));
    let found = sizes.find_map(|size| Some((size, said(size)?)));
    found.expect("a run that fails")
}

#[test]
fn inv_noise_is_named_by_what_it_does_to_a_run_that_follows_the_standards() {
    let (noise_v, found) = first(QUIET_V, |noise_v| said(noise_v, |_, _, u| u));
    assert!(noise_v > QUIET_V);
    assert_eq!(found.cause, Cause::Noisy, "{found:?}");
}

/// The open loop magnifies what such a run departs by, and as much noise again takes it somewhere else: that is not the noise's doing.
#[test]
fn inv_zeros_that_moved_are_told_from_noise() {
    for (sizes, channels) in [
        ([0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], vec![3]),
        (
            [1.0, -0.8, 0.0, 0.0, 0.0, 0.6, 0.0, 0.0, 0.1],
            vec![1, 2, 6],
        ),
    ] {
        let (moved_v, found) = first(QUIET_V, |moved_v| {
            said(QUIET_V, |i, _, u| u + moved_v * sizes[i])
        });
        assert_eq!(found.cause, Cause::DriftDuringRun, "{found:?}");
        assert_eq!(found.channels, channels, "{found:?}");
        let words = found.evidence.split(" mV since").next();
        let told = words.and_then(|words| words.rsplit(' ').next());
        let told_mv: f64 = told.and_then(|word| word.parse().ok()).expect("a number");
        assert!(
            (1e-3 * told_mv - moved_v).abs() < 0.1 * moved_v,
            "{found:?}"
        );
    }
}

/// A gain that is another's leaves zeros where they are, and so does what happens amid a run.
#[test]
fn neg_what_is_neither_noise_nor_a_zero_has_no_cause() {
    let gain = |by: f64| said(QUIET_V, move |i, _, u| if i == 2 { u + by * u } else { u });
    let amid = |by_v: f64| {
        said(QUIET_V, move |i, sample, u| match sample {
            900..1100 if i == 2 => u + by_v,
            _ => u,
        })
    };
    for (_, found) in [first(0.01, gain), first(QUIET_V, amid)] {
        assert_eq!(found.cause, Cause::Unexplained, "{found:?}");
        assert!(found.channels.is_empty(), "{found:?}");
    }
}
