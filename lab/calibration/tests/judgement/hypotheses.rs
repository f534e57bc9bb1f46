//! Days in closed form, with noise, that the joint fit does not account for: the one hypothesis that does is named with its unknown,
//! and where none does nothing is.

use core::f64::consts::TAU;
use std::path::Path;

use glam::{DQuat, DVec3};
use sixaxis_calibration::conditioning::{Conditioned, Conditioning};
use sixaxis_calibration::diagnosis::trial_case::{Facts, Standard};
use sixaxis_calibration::diagnosis::{Diagnosis, examine};
use sixaxis_calibration::finding::{Cause, Finding};
use sixaxis_calibration::joint::hypotheses::{Unaccounted, explain};
use sixaxis_calibration::joint::{Knowledge, Loss, fit, start};
use sixaxis_calibration::steps::{Campaign, GyroscopeGain};
use sixaxis_calibration::trial::Trial;
use sixaxis_core::identify::inertia::euler_torque;
use sixaxis_core::identify::static_load_sharing::StaticLoadSharing;
use sixaxis_core::identify::zero_drift;
use sixaxis_core::{Gains, Geometry, LIMBS};
use sixaxis_recordings::session::{Role, Session, SessionFile};

use crate::waveform::Timing;

const SESSION: &str = concat!(
    include_str!("../../../recordings/tests/card.toml"),
    r#"
[[recording]]
file = "static.csv"
role = "static"
"#
);

const RATE_HZ: f64 = 500.0;
/// Of the trials on each wedge: more than one, for a mass that gives way is told from one that does not by how they differ.
const FREQUENCIES_HZ: [f64; 6] = [3.0, 5.0, 3.4, 4.6, 3.8, 4.2];
const TIMING: Timing = Timing {
    rest_s: 0.05,
    ramp_s: 0.35,
    run_s: 1.5,
};
const SAMPLES: usize = 750;
/// Steps of a sample in which instruments follow: the trapezoidal rule is right to a twelfth of a step's phase squared.
const FINE: usize = 16;
const TRAVEL_M: f64 = 0.02;
const TURN_RAD: f64 = 1.0;
/// Width of noise, evenly distributed, over the peak of the strongest channel, or of the standard.
const NOISE: f64 = 1e-3;
const TRIALS: usize = 12;
/// A trial amid the linear ones.
const LINEAR: usize = 4;

const DIRECTIONS: [DVec3; 6] = [
    DVec3::new(1.0, 0.3, 0.2),
    DVec3::new(-0.2, 1.0, 0.3),
    DVec3::new(0.3, -0.2, 1.0),
    DVec3::new(1.0, 1.0, 0.4),
    DVec3::new(1.0, 0.4, -1.0),
    DVec3::new(1.0, 2.0, 3.0),
];

/// What is wrong with a day.
#[derive(Clone, Copy, Default)]
struct Wrong {
    /// Time by which channels 4 to 6 are behind, s.
    late_s: f64,
    /// Time constant of the gyroscope, s.
    lag_s: f64,
    /// That of the accelerometer, s.
    accelerometer_lag_s: f64,
    /// Delays of accelerometer and gyroscope, s.
    delay_s: [f64; 2],
    /// Corner of the amplifiers, Hz.
    corner_hz: f64,
    /// Time by which the standards are late, s, and how much faster than stated they are sampled.
    clock: (f64, f64),
    /// Channels that are exchanged, and the trial from which on they are.
    exchanged: Option<(usize, usize, usize)>,
    /// How many times the gain of the channel before it each channel's is, none for equal gains, and whether gains stay with the limbs
    /// where channels are exchanged: the names were, in writing.
    ranges: Option<(f64, bool)>,
    /// A channel that is inverted, and the trial from which on it is.
    inverted: Option<(usize, usize)>,
    /// A trial of another sensor.
    foreign: Option<usize>,
    /// A trial whose standard is the other way round.
    reversed: Option<usize>,
    /// Share of its peak by which every channel bends.
    bent: f64,
    /// A trial in which the sensor stands so far off its wedge, degrees.
    off_wedge: Option<(usize, f64)>,
}

/// Noise that is the same on every machine.
struct Noise(u64);

impl Noise {
    fn on(&mut self, series: &mut [f64], peak: f64) {
        for x in series {
            self.0 = self
                .0
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            *x += NOISE * peak * ((self.0 >> 11) as f64 / (1_u64 << 53) as f64 - 0.5);
        }
    }
}

/// The recorder's samples.
fn thinned(series: &[f64]) -> Vec<f64> {
    series.iter().step_by(FINE).copied().collect()
}

fn peak(series: &[f64]) -> f64 {
    series.iter().fold(0.0, |most, x| most.max(x.abs()))
}

/// First-order response by the trapezoidal rule; a high-pass is what it leaves.
fn followed(series: &mut [f64], lag_s: f64) {
    let step = 0.5 / (RATE_HZ * FINE as f64) / lag_s;
    let (mut before, mut out) = (0.0, 0.0);
    for x in series {
        out = ((1.0 - step) * out + step * (*x + before)) / (1.0 + step);
        before = *x;
        *x = out;
    }
}

fn session() -> Session {
    // Trials here are played at a gain of 1 N/V.
    let text = SESSION.replace("gain_n_per_v = 10.0", "gain_n_per_v = 1.0");
    let file = SessionFile::parse(Path::new("session.toml"), text);
    file.expect("a session").session
}

fn played(index: usize, wrong: &Wrong, noise: &mut Noise) -> (Trial, Conditioned) {
    let session = session();
    let shares = StaticLoadSharing::new(&session.sensor.geometry()).expect("the paper's sensor");
    let design = session.sensor.design();
    let n = DIRECTIONS[index % 6].normalize();
    let frequency_hz = FREQUENCIES_HZ[index % 6];
    let omega = TAU * frequency_hz;
    let turns = index >= TRIALS / 2;
    let moves = match wrong.off_wedge {
        Some((off, deg)) if off == index => {
            DQuat::from_axis_angle(n.any_orthonormal_vector(), deg.to_radians()) * n
        }
        _ => n,
    };
    let each = |f: &dyn Fn(f64) -> f64| -> Vec<f64> {
        let fine_hz = RATE_HZ * FINE as f64;
        (0..SAMPLES * FINE).map(|i| f(i as f64 / fine_hz)).collect()
    };
    let scale = |limb: usize| {
        let own = design.scale_per_mass_per_kg[limb] * (1.0 + 0.02 * limb as f64);
        match wrong.foreign {
            Some(foreign) if foreign == index => own * (1.0 + 0.3 * (limb as f64).sin()),
            _ => own,
        }
    };
    let channel = |limb: usize, t: f64| {
        let [_, rate, acceleration] = TIMING.course(t, omega);
        let force = if turns {
            let w = moves * (rate * omega * TURN_RAD);
            let dw = moves * (acceleration * omega * omega * TURN_RAD);
            let torque = euler_torque(&design.inertia_per_mass, w, dw);
            shares.of_torque_per_m(limb).dot(torque)
        } else {
            let a = moves * (acceleration * omega * omega * TRAVEL_M);
            shares.of_acceleration(limb).dot(a)
        };
        force / scale(limb)
    };
    let mut channels: [Vec<f64>; LIMBS] = core::array::from_fn(|limb| {
        let late = if (3..6).contains(&limb) {
            wrong.late_s
        } else {
            0.0
        };
        let mut series = each(&|t| channel(limb, t - late));
        let peak = peak(&series);
        for x in &mut series {
            *x += wrong.bent * x.abs() * *x / peak;
        }
        if wrong.corner_hz > 0.0 {
            let mut low = series.clone();
            followed(&mut low, 1.0 / (TAU * wrong.corner_hz));
            series.iter_mut().zip(low).for_each(|(x, low)| *x -= low);
        }
        thinned(&series)
    });
    let strongest = channels
        .iter()
        .map(|series| peak(series))
        .fold(0.0, f64::max);
    for series in &mut channels {
        noise.on(series, strongest);
    }
    let mut gains = Gains::uniform(1.0);
    let (range, by_name) = wrong.ranges.unwrap_or((1.0, false));
    for (limb, gain) in gains.gain_n_per_v.iter_mut().enumerate() {
        *gain = range.powi(limb as i32);
    }
    // Whose amplifier a limb is plugged into.
    let mut amplifier: [usize; LIMBS] = core::array::from_fn(|limb| limb);
    let exchanged = wrong.exchanged.filter(|(.., from)| index >= *from);
    if let Some((a, b, _)) = exchanged
        && !by_name
    {
        amplifier.swap(a, b);
    }
    for (series, amplifier) in channels.iter_mut().zip(amplifier) {
        let gain = gains.gain_n_per_v[amplifier];
        series.iter_mut().for_each(|u| *u /= gain);
    }
    if let Some((a, b, _)) = exchanged {
        channels.swap(a, b);
    }
    if let Some((channel, from)) = wrong.inverted
        && index >= from
    {
        channels[channel].iter_mut().for_each(|u| *u = -*u);
    }
    let standard = |t: f64| TIMING.course((t - wrong.clock.0) / (1.0 + wrong.clock.1), omega);
    let [acceleration_late_s, rate_late_s] = wrong.delay_s;
    let turned = |t: f64| standard(t - rate_late_s);
    let mut linear = each(&|t| standard(t - acceleration_late_s)[2] * omega * omega * TRAVEL_M);
    let mut rate = each(&|t| turned(t)[1] * omega * TURN_RAD);
    let mut angular = each(&|t| turned(t)[2] * omega * omega * TURN_RAD);
    if wrong.lag_s > 0.0 {
        followed(&mut rate, wrong.lag_s);
        followed(&mut angular, wrong.lag_s);
    }
    if wrong.accelerometer_lag_s > 0.0 {
        followed(&mut linear, wrong.accelerometer_lag_s);
    }
    if turns {
        linear.fill(0.0);
    } else {
        rate.fill(0.0);
        angular.fill(0.0);
    }
    for standard in [&mut linear, &mut rate, &mut angular] {
        *standard = thinned(standard);
        if wrong.reversed == Some(index) {
            standard.iter_mut().for_each(|x| *x = -*x);
        }
    }
    for standard in [&mut linear, &mut rate] {
        let peak = peak(standard);
        noise.on(standard, peak);
    }
    let along = |series: &[f64]| series.iter().map(|x| n * *x).collect();
    let voltage_v: Vec<[f64; LIMBS]> = (0..SAMPLES)
        .map(|i| core::array::from_fn(|limb| channels[limb][i]))
        .collect();
    let conditioned = Conditioned {
        voltage_v: voltage_v.clone(),
        linear_ground_m_s2: along(&linear),
        rate_shell_rad_s: along(&rate),
        angular_shell_rad_s2: along(&angular),
        outliers: 0,
        zero_wander_v: [0.0; LIMBS],
    };
    let trial = Trial {
        name: format!("run {}", index + 1),
        role: if turns { Role::Angular } else { Role::Linear },
        sample_rate_hz: RATE_HZ,
        gains,
        full_scale_v: 10.0,
        voltage_v,
        accelerometer_m_s2: linear,
        gyroscope_rad_s: rate,
        limbs_band_hz: f64::INFINITY,
        standards_band_hz: f64::INFINITY,
        direction_ground: n,
        gravity_ground_m_s2: n * -9.80665,
        frequency_hz,
    };
    (trial, conditioned)
}

/// What is said of a day, and whether the joint fit accounts for it as it is.
fn said(wrong: &Wrong) -> (Vec<Finding>, bool) {
    said_of(wrong, |diagnosis| {
        let suspected = [diagnosis.of_the_table.clone(), diagnosis.suspected.clone()];
        (diagnosis.findings.clone(), suspected.concat())
    })
}

/// The same, where the diagnosis has left these findings as certain and those as suspected.
fn said_of(
    wrong: &Wrong,
    left: impl Fn(&Diagnosis<'_>) -> (Vec<Finding>, Vec<Finding>),
) -> (Vec<Finding>, bool) {
    let session = session();
    let mut noise = Noise(20_261_123);
    let static_voltage_v: Vec<[f64; LIMBS]> = (0..2000)
        .map(|_| {
            let mut row = [0.0; LIMBS];
            noise.on(&mut row, 1.0);
            row
        })
        .collect();
    let campaign = Campaign {
        geometry: session.sensor.geometry(),
        design: session.sensor.design(),
        static_voltage_v,
        trials: (0..TRIALS)
            .map(|index| played(index, wrong, &mut noise))
            .collect(),
    };
    let standard = Standard {
        gain_limit: 0.01,
        lag_s: 0.0,
    };
    let facts = Facts {
        geometry: Geometry::PAPER,
        design: &campaign.design,
        rig: None,
        accelerometer: standard,
        gyroscope: standard,
        gyroscope_class: 0.01,
        gyroscope_lag_undone: false,
    };
    let diagnosis = examine(&facts, None, &campaign.trials);
    let certified = GyroscopeGain::Certified { class: 0.01 };
    let knowledge = Knowledge::of(&session);
    let steps = campaign
        .identify(certified)
        .map_err(|error| error.to_string());
    let joint = steps.as_ref().map_err(String::clone).and_then(|steps| {
        fit(&campaign, steps, &knowledge, Loss::Squares).map_err(|error| error.to_string())
    });
    let drift = zero_drift::identify(&campaign.static_voltage_v).expect("a record");
    let accounts = joint.as_ref().is_ok_and(|joint| joint.accounts());
    let day = Unaccounted {
        campaign: &campaign,
        conditioning: &Conditioning::of(&session),
        drift: &drift,
        start: steps
            .as_ref()
            .map_or(campaign.design, |steps| start(&campaign, steps)),
        knowledge: &knowledge,
        cases: &diagnosis.cases,
        joint: joint.as_ref().map_err(String::as_str),
    };
    let (certain, suspected) = left(&diagnosis);
    (explain(&day, &certain, suspected), accounts)
}

/// The one finding about a day that the fit does not account for.
#[track_caller]
fn one(wrong: Wrong, cause: Cause, channels: &[usize], recordings: usize) -> Finding {
    let (said, accounts) = said(&wrong);
    assert!(!accounts, "the fit accounts for the day as it is");
    let [finding] = &said[..] else {
        panic!("{said:#?}")
    };
    assert_eq!(finding.cause, cause, "{finding:?}");
    assert_eq!(finding.channels, channels, "{finding:?}");
    assert_eq!(finding.recordings.len(), recordings, "{finding:?}");
    finding.clone()
}

/// The number before some words.
#[track_caller]
fn number(finding: &Finding, words: &str) -> f64 {
    let before = finding.evidence.split(words).next().unwrap_or_default();
    let word = before.trim_end().rsplit(' ').next().unwrap_or_default();
    word.parse().expect(&finding.evidence)
}

#[test]
fn inv_a_healthy_day_is_accounted_for() {
    assert!(said(&Wrong::default()).1);
}

/// Of two trials on a wedge that do not stand alike neither is the measure, whichever it is and whichever way it leans. That sensitivities of one
/// trial would explain a little of it is not for this to say.
#[test]
fn inv_trials_that_do_not_stand_alike_are_named_with_their_angle() {
    for (trial, deg) in [(LINEAR, 1.0), (LINEAR, -1.0), (LINEAR + TRIALS / 2, 1.0)] {
        let wrong = Wrong {
            off_wedge: Some((trial, deg)),
            ..Wrong::default()
        };
        let (said, _) = said(&wrong);
        let [found] = &said[..] else {
            panic!("{said:#?}")
        };
        assert_eq!(found.cause, Cause::LooseWedge, "{found:?}");
        assert_eq!(found.recordings, ["run 5", "run 11"], "{found:?}");
        let off_deg = number(found, "° from the middle");
        assert!((off_deg - 0.5).abs() < 0.03, "{found:?}");
    }
}

#[test]
fn inv_a_freedom_that_is_lacking_is_named_by_its_unknown() {
    let high_pass = one(
        Wrong {
            corner_hz: 0.5,
            ..Wrong::default()
        },
        Cause::HighPassMisstated,
        &[],
        0,
    );
    assert!((number(&high_pass, "Hz on every channel") - 0.5).abs() < 5e-3);
    let lag = one(
        Wrong {
            lag_s: 5e-3,
            ..Wrong::default()
        },
        Cause::GyroscopeLag,
        &[],
        0,
    );
    assert!((number(&lag, "ms behind, as") - 5.0).abs() < 0.05);
    let behind = one(
        Wrong {
            accelerometer_lag_s: 2e-3,
            ..Wrong::default()
        },
        Cause::ClockMismatch,
        &[],
        0,
    );
    assert!(behind.evidence.contains("an accelerometer that is"));
    assert!((number(&behind, "ms behind, as") - 2.0).abs() < 0.02);
    for (delay_s, cause, whose) in [
        ([20e-3, 0.0], Cause::ClockMismatch, "with the accelerometer"),
        ([0.0, 20e-3], Cause::GyroscopeLag, "with the gyroscope"),
    ] {
        let wrong = Wrong {
            delay_s,
            ..Wrong::default()
        };
        let delayed = one(wrong, cause, &[], 0);
        assert!(delayed.evidence.contains(whose), "{}", delayed.evidence);
        assert!((number(&delayed, "ms behind at every") - 20.0).abs() < 0.1);
    }
    let late = one(
        Wrong {
            late_s: 3e-3,
            ..Wrong::default()
        },
        Cause::ClockMismatch,
        &[4, 5, 6],
        0,
    );
    assert!((number(&late, "ms behind the standards") - 3.0).abs() < 0.03);
}

#[test]
fn inv_an_exchange_is_named() {
    let wrong = Wrong {
        exchanged: Some((1, 6, 0)),
        ..Wrong::default()
    };
    one(wrong, Cause::SwappedChannels, &[2, 7], 0);
    let from_the_fifth = Wrong {
        exchanged: Some((1, 6, LINEAR)),
        ..Wrong::default()
    };
    one(
        from_the_fifth,
        Cause::SwappedChannels,
        &[2, 7],
        TRIALS - LINEAR,
    );
}

#[test]
fn inv_a_standard_reversed_in_one_trial_is_named() {
    for reversed in [LINEAR, TRIALS - 1] {
        let wrong = Wrong {
            reversed: Some(reversed),
            ..Wrong::default()
        };
        let said = one(wrong, Cause::WrongScaling, &[], 1);
        assert_eq!(said.recordings, [format!("run {}", reversed + 1)]);
        let words = "with the standard of this trial reversed all trials agree";
        assert!(said.evidence.contains(words), "{}", said.evidence);
    }
}

#[test]
fn inv_exchanged_names_are_told_from_exchanged_plugs() {
    for by_name in [false, true] {
        let wrong = Wrong {
            exchanged: Some((1, 6, 0)),
            ranges: Some((1.3, by_name)),
            ..Wrong::default()
        };
        let found = one(wrong, Cause::SwappedChannels, &[2, 7], 0);
        let leaves_gains = found.advice.contains("leave gain_n_per_v as it is");
        assert_eq!(leaves_gains, by_name, "{found:?}");
    }
}

#[test]
fn inv_an_inversion_from_mid_day_is_named() {
    let wrong = Wrong {
        inverted: Some((3, LINEAR)),
        ..Wrong::default()
    };
    one(wrong, Cause::InvertedChannel, &[4], TRIALS - LINEAR);
}

#[test]
fn inv_a_clock_of_the_standards_is_named() {
    let late_and_fast = Wrong {
        clock: (2e-3, 3e-3),
        ..Wrong::default()
    };
    let clock = one(late_and_fast, Cause::ClockMismatch, &[], 0);
    assert!((number(&clock, "ms behind the channels") - 2.0).abs() < 0.02);
    assert!((number(&clock, "times their stated rate") - 1.003).abs() < 1e-5);
}

#[test]
fn inv_a_trial_apart_is_named_where_the_others_agree() {
    let wrong = Wrong {
        foreign: Some(LINEAR),
        ..Wrong::default()
    };
    let (said, accounts) = said(&wrong);
    assert!(!accounts);
    let foreign = said.iter().find(|f| f.cause == Cause::ForeignTrial);
    assert_eq!(
        foreign.map(|f| &f.recordings[..]),
        Some(&["run 5".to_owned()][..]),
        "{said:#?}"
    );
}

/// Where a trial is known to be wrong and the others agree, nothing is left to suspect another one of.
#[test]
fn neg_a_sound_trial_is_not_accused_beside_a_wrong_one() {
    let wrong = Wrong {
        foreign: Some(LINEAR),
        ..Wrong::default()
    };
    let of = |run: usize| Finding {
        cause: Cause::ForeignTrial,
        recordings: vec![format!("run {}", run + 1)],
        channels: Vec::new(),
        evidence: String::new(),
        advice: String::new(),
    };
    let (said, _) = said_of(&wrong, |_| (vec![of(LINEAR)], vec![of(LINEAR + 2)]));
    assert!(said.is_empty(), "{said:#?}");
}

#[test]
fn neg_what_nothing_accounts_for_has_no_name() {
    let bent = Wrong {
        bent: 0.1,
        ..Wrong::default()
    };
    let (said, accounts) = said(&bent);
    assert!(!accounts);
    assert!(
        said.iter()
            .all(|finding| finding.cause == Cause::Unexplained),
        "{said:#?}"
    );
}
