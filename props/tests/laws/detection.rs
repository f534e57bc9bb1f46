//! Failed limbs: false alarms, detection, isolation and naming against failures that were injected.

use sixaxis_core::redundancy::fault::CalibrationErrors;
use sixaxis_core::redundancy::fault::class::{CLASS_OF, CLASSES, members};
use sixaxis_core::redundancy::fault::detector::{Alarm, Detector, TESTS, Test};
use sixaxis_core::redundancy::fault::noise::RowNoise;
use sixaxis_core::redundancy::fault::{Event, Kind};
use sixaxis_core::redundancy::parity::ROWS;
use sixaxis_core::redundancy::residual;
use sixaxis_core::significance::chi_square_limit;
use sixaxis_core::{Error, Geometry, LIMBS};
use sixaxis_props::compare::{all_finite, fails_clearly, largest, within};
use sixaxis_props::faults::null::{curve, false_alarms, noncentral_survival};
use sixaxis_props::faults::tally::{Tally, limb_named, of_classes, play, tally};
use sixaxis_props::faults::{FALSE_ALARMS_PER_HOUR, Name, Scene};
use sixaxis_props::seed::seed;
use sixaxis_props::statistics::least_share;
use sixaxis_props::tolerance;

/// Rates per sample and stretches of 2^20 samples that count their alarms to some 3 %.
const RATES: [(f64, u64); 2] = [(1e-3, 2), (1e-4, 12)];
/// Channels' noise, largest over smallest.
const UNEQUAL: [f64; 2] = [1.0, 5.0];
/// Standard deviations of a failure.
const SIGMAS: f64 = 5.0;
/// Trials of each limb.
const EACH: u64 = 12;
const DRAWS: u64 = 20_000;

#[test]
fn stat_false_alarms_are_as_many_as_asked_for() {
    for ((rate, stretches), unequal) in RATES.into_iter().zip(UNEQUAL) {
        let counted = false_alarms(rate, unequal, 1.0, stretches, seed());
        within(
            format!("false alarms at {rate} a sample, over those asked for, less one"),
            (counted.attained() - 1.0).abs(),
            tolerance::FALSE_ALARMS,
        );
    }
    let louder = false_alarms(RATES[1].0, 1.0, tolerance::FALSE_ALARM_NOISE, 1, seed());
    fails_clearly(
        "false alarms of a sensor noisier than told",
        (louder.attained() - 1.0).abs(),
        tolerance::FALSE_ALARMS,
    );
}

#[test]
fn stat_detection_is_noncentral_chi_square() {
    for (window, sigmas) in [(1, SIGMAS), (64, 0.5)] {
        for limb in [4, 5] {
            let drawn = curve(window, limb, sigmas, DRAWS, seed());
            let departure = |theory: &[f64]| {
                largest(drawn.detected.iter().zip(theory).map(|(&found, &p)| {
                    // A probability of 0 or 1 has no standard error: one draw stands for it.
                    let spread = (p * (1.0 - p) * DRAWS as f64).sqrt().max(1.0);
                    (found - p) * DRAWS as f64 / spread
                }))
            };
            within(
                format!("detection of limb {} by {window} samples", limb + 1),
                departure(&drawn.theory),
                tolerance::DETECTION_Z,
            );
        }
    }
}

#[test]
fn stat_failures_of_five_sigma_are_isolated() {
    for kind in [
        Name::Dead,
        Name::Stuck,
        Name::ScaleJump,
        Name::Offset,
        Name::Drift,
        Name::NoiseBurst,
        Name::Swapped,
    ] {
        let trials = play(kind, SIGMAS, seed(), EACH);
        let counted = tally(kind, None, &trials);
        let missed = |counted: &Tally| {
            let of = &counted.isolated;
            least_share(of.all() - of.right, of.all())
        };
        within(
            format!("{kind:?}: least share of trials whose class is not named"),
            missed(&counted),
            tolerance::NOT_ISOLATED,
        );
        // Judged by what failed in another class, none is right.
        let moved: Vec<_> = trials
            .iter()
            .map(|&(mut fault, outcome)| {
                let next = (1..LIMBS).map(|k| (fault.limb + k) % LIMBS);
                fault.limb = next
                    .into_iter()
                    .find(|&l| CLASS_OF[l] != CLASS_OF[fault.limb] && l != fault.other)
                    .expect("six classes");
                (fault, outcome)
            })
            .collect();
        fails_clearly(
            format!("{kind:?}, another class"),
            tally(kind, None, &moved).isolated.missed(),
            tolerance::NOT_ISOLATED,
        );
        let wrong = trials
            .iter()
            .filter(|(fault, _)| kind != Name::Swapped && members(CLASS_OF[fault.limb]).len() == 2)
            .map(|(fault, outcome)| limb_named(fault, outcome));
        let (twins, wrong) = wrong.fold((0, 0), |(all, wrong), named| {
            (all + 1, wrong + usize::from(named == Some(false)))
        });
        within(
            format!("{kind:?}: least share of twins named wrongly"),
            least_share(wrong, twins),
            tolerance::TWIN_WRONG,
        );
        assert!(of_classes(&trials).iter().all(|c| c.isolated.all() > 0));
        if kind == Name::Drift {
            let drifting = trials
                .iter()
                .filter_map(|(_, outcome)| outcome.identified)
                .filter(|(v, _)| v.kind == Kind::Drift && v.limbs.len() == 1)
                .all(|(v, _)| v.limb().is_some_and(|l| members(CLASS_OF[l]).len() == 1));
            assert!(drifting, "nothing tells a drifting twin");
            assert!(counted.twins.open > 0);
        }
    }
}

/// What nine channels show of a failure e of one twin is what they show of e in the other, under another load: taken off either,
/// the rows are quiet.
#[test]
fn inv_twins_explain_each_other() {
    let scene = Scene::random(seed(), 1.0);
    let monitor = scene.monitor(FALSE_ALARMS_PER_HOUR);
    let nu = Geometry::PAPER.half_edge_m / Geometry::PAPER.limb_length_m;
    let left = |strain: &[f64; LIMBS]| largest(residual(strain, nu));
    for (sample, [a, b]) in [(0, [1, 3]), (100, [2, 6]), (200, [5, 7])] {
        let sound = monitor.strains(&scene.voltage_v(sample));
        let size = largest(sound);
        let mut failed = sound;
        failed[a] += size;
        let mut mended = failed;
        mended[b] -= size;
        within(
            "rows of a failure taken off the other twin, over the failure",
            left(&mended) / size,
            tolerance::TWIN_TRACE,
        );
        fails_clearly(
            "the failure itself",
            left(&failed) / size,
            tolerance::TWIN_TRACE,
        );
    }
}

#[test]
fn law_a_nan_is_a_failed_limb_at_once() {
    let scene = Scene::random(seed(), 1.0);
    for bad in [f64::NAN, f64::INFINITY, 1e9] {
        let mut monitor = scene.monitor(FALSE_ALARMS_PER_HOUR);
        for sample in 0..100 {
            let mut u = scene.voltage_v(sample);
            if sample >= 50 {
                u[6] = bad;
            }
            let event = monitor.push(&u);
            if sample == 50 {
                let Some(Event::Identified(verdict)) = event else {
                    panic!("{bad}: {event:?}");
                };
                assert_eq!(verdict.limb(), Some(6));
                assert_eq!((verdict.kind, verdict.since), (Kind::Unreadable, (50, 50)));
            } else {
                assert!(event.is_none(), "{bad}, sample {sample}: {event:?}");
            }
        }
        // The stream goes on without it, and without a second; of twins it says that they are lost.
        let mut stream = scene.stream(FALSE_ALARMS_PER_HOUR);
        for sample in 0..100 {
            let mut u = scene.voltage_v(sample);
            for (limb, from) in [(6, 50), (4, 60), (2, 70)] {
                if sample >= from {
                    u[limb] = bad;
                }
            }
            let said = stream.push(&u);
            if sample < 70 {
                let said = said.expect("a row");
                let expected = usize::from(sample >= 50) + usize::from(sample >= 60);
                assert_eq!(said.excluded.len(), expected, "{bad}, sample {sample}");
                assert!(said.answer.is_none_or(|a| all_finite(&a)));
            } else {
                let refused = matches!(
                    said,
                    Err(Error::NotFinite { .. } | Error::Overstrained { .. })
                );
                assert!(refused, "{bad}, sample {sample}: {said:?}");
            }
        }
    }
}

#[test]
fn law_settings_without_meaning_are_refused() {
    use sixaxis_core::redundancy::fault::{CalibrationErrors, Detector, RowNoise};
    let noise = RowNoise::from_channels(&[1.0; LIMBS]).expect("noise");
    for rate in [0.0, -1.0, f64::NAN, 0.1] {
        let refused = Detector::new(noise, rate, None);
        assert!(matches!(refused, Err(Error::OutOfRange { .. })), "{rate}");
    }
    let mut scale = [0.0; LIMBS];
    scale[3] = f64::NAN;
    let errors = CalibrationErrors::independent(scale, [0.0; LIMBS]);
    assert!(Detector::new(noise, 1e-6, Some(errors)).is_err());
}

#[test]
fn law_a_failure_that_is_over_is_dropped_after_quiet_samples() {
    use rand_pcg::Pcg64;
    use sixaxis_core::redundancy::fault::monitor::QUIET;
    use sixaxis_props::faults::noisy;
    let scene = Scene::random(seed(), 1.0);
    let mut monitor = scene.monitor(FALSE_ALARMS_PER_HOUR);
    let mut rng = Pcg64::new(u128::from(seed()), 75);
    let (from, to) = (3000, 6000);
    let mut events = Vec::new();
    for sample in 0..to + 2 * QUIET {
        let mut u = noisy(&scene, scene.voltage_v(sample), &mut rng);
        if (from..to).contains(&sample) {
            u[4] = scene.parameters.zero_drift_v[4];
        }
        events.extend(monitor.push(&u).map(|event| (sample, event)));
    }
    let identified = events.iter().find_map(|(_, e)| match e {
        Event::Identified(v) => Some(v),
        _ => None,
    });
    assert_eq!(identified.and_then(|v| v.limb()), Some(4), "{events:?}");
    let (when, last) = events.last().expect("events");
    assert_eq!(*last, Event::Quiet, "{events:?}");
    assert!(*when >= to + QUIET - 1, "{when}");
}

/// A contact that is lost for some samples, while the other limb of the pair may happen to rest: no sound limb is named.
#[test]
fn neg_a_contact_that_fails_for_moments_is_not_the_other_limb_s() {
    use rand_distr::{Distribution, StandardUniform};
    use rand_pcg::Pcg64;
    use sixaxis_props::faults::noisy;
    const SEEDS: u64 = 200;
    let (mut named, mut pairs, mut wrong) = (0, 0, Vec::new());
    for k in 0..SEEDS {
        let scene = Scene::random(seed() + k, 1.0);
        for limb in (0..LIMBS).filter(|limb| members(CLASS_OF[*limb]).len() == 2) {
            let mut rng = Pcg64::new(u128::from(seed() + k), 76 + limb as u128);
            let mut uniform = || -> f64 { StandardUniform.sample(&mut rng) };
            let from = 3000 + (1000.0 * uniform()) as u64;
            let gone = 8 + (100.0 * uniform()) as u64;
            let mut monitor = scene.monitor(FALSE_ALARMS_PER_HOUR);
            for sample in 0..from + 4000 {
                let mut u = noisy(&scene, scene.voltage_v(sample), &mut rng);
                if (from..from + gone).contains(&sample) {
                    u[limb] = 0.0;
                }
                if let Some(Event::Identified(verdict)) = monitor.push(&u) {
                    match verdict.limb() {
                        Some(found) if found == limb => named += 1,
                        Some(_) => wrong.push((k, limb, gone, verdict)),
                        None => pairs += 1,
                    }
                    break;
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:?}");
    assert!(named > 100 * pairs, "{named} named, {pairs} pairs");
}

/// Zeros of all channels that have moved since the calibration, by half a sample's noise, are no exchanged channels while the sensor rests.
#[test]
fn neg_zeros_that_have_moved_are_no_exchange() {
    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64;
    use sixaxis_props::faults::noisy;
    for k in 0..60 {
        let scene = Scene::random(seed() + k, 1.0);
        let mut rng = Pcg64::new(u128::from(seed() + k), 77);
        let moved: [f64; LIMBS] = core::array::from_fn(|limb| {
            let unit: f64 = StandardNormal.sample(&mut rng);
            0.5 * scene.noise_v[limb] * unit
        });
        let mut monitor = scene.monitor(FALSE_ALARMS_PER_HOUR);
        for _ in 0..20_000 {
            // At rest: the zeros and noise.
            let u = noisy(&scene, scene.parameters.zero_drift_v, &mut rng);
            let event = monitor.push(&core::array::from_fn(|limb| u[limb] + moved[limb]));
            if let Some(Event::Identified(verdict)) = event {
                assert_ne!(verdict.kind, Kind::Swapped, "seed {k}: {verdict}");
            }
        }
    }
}

/// Noncentral chi-square of no noncentrality is central, and grows with it.
#[test]
fn inv_noncentral_is_central_at_zero() {
    let at = |lambda| noncentral_survival(16.25, ROWS, lambda);
    let central =
        sixaxis_core::significance::chi_square_tail(16.25, ROWS).expect("three degrees of freedom");
    within(
        "noncentral over central, less one",
        (at(0.0) / central - 1.0).abs(),
        tolerance::ROUNDING,
    );
    assert!(at(1.0) > at(0.0) && at(25.0) > at(1.0));
}

/// A limb dies in mid-motion: from the verdict on, every answer is bit by bit that of a decoupler that was told to do without the
/// limb before it died, and the attitude is that of a sensor that never failed but for noise.
#[test]
fn ref_after_the_verdict_no_trace_is_left() {
    use sixaxis_core::limb_set::LimbSet;
    use sixaxis_core::redundancy::tolerant::ROWS_KEPT;
    use sixaxis_core::{Decoupler, FaultTolerant, SixAxis};
    use sixaxis_props::faults::dying::{Played, angle_rad};
    // The torque of limbs 1, 5 and 9 is none: only of the others does the attitude depend.
    for limb in [1, 6] {
        let played = Played::random(seed(), limb).expect("the simulation");
        let (sensor, parameters) = (&played.sensor, &played.parameters);
        let stream = || {
            let rows = vec![[0.0; LIMBS]; ROWS_KEPT];
            FaultTolerant::new(sensor, parameters, &played.settings, &played.watch(), rows)
                .expect("sound")
        };
        let mut watched = stream();
        let mut answers = Vec::new();
        let mut switch = None;
        for (sample, row) in played.failed_v.iter().enumerate() {
            let said = watched.push(row).expect("a row");
            switch = switch.or(said.switched.map(|s| (sample, s)));
            answers.push(said.answer);
            assert!(said.suspected.is_empty() || said.switched.is_none());
        }
        let (when, switch) = switch.expect("it switches");
        assert_eq!(watched.excluded(), LimbSet::EMPTY.with(limb));
        assert!(switch.reaches_onset && switch.from_sample <= played.onset);
        // Told in time: sound rows until the switch's first, then without the limb.
        let mut told = stream();
        for (sample, row) in played.sound_v.iter().enumerate() {
            if sample as u64 == switch.from_sample {
                told.set_excluded(LimbSet::EMPTY.with(limb))
                    .expect("one limb");
            }
            let row = if told.excluded().is_empty() {
                row
            } else {
                &played.failed_v[sample]
            };
            let expected = told.push(row).expect("a row").answer;
            if sample >= when {
                assert_eq!(answers[sample], expected, "sample {sample}");
            }
        }
        let mut decoupler = Decoupler::new(sensor, parameters, &played.settings).expect("sound");
        let (mut sound, mut nine) = (None, None);
        let mut blind = decoupler.clone();
        for (sound_row, failed_row) in played.sound_v.iter().zip(&played.failed_v) {
            sound = decoupler.push(sound_row).expect("a row");
            nine = blind.push(failed_row).expect("a row");
        }
        let attitude = |answer: Option<SixAxis>| answer.expect("an answer").attitude;
        let never = attitude(sound);
        let apart = |answer: Option<SixAxis>| angle_rad(never, attitude(answer));
        let last = answers.last().copied().flatten();
        within(
            format!("attitude after limb {} died", limb + 1),
            apart(last),
            tolerance::SURVIVED_RAD,
        );
        assert!(apart(nine) > tolerance::DEAD_LIMB_RAD, "{}", apart(nine));
        let truth = played.truth[last.expect("an answer").sample as usize].attitude;
        within(
            format!("attitude after limb {} died, from the truth", limb + 1),
            angle_rad(truth, attitude(last)),
            tolerance::NOISY_ATTITUDE_RAD,
        );
    }
}

/// The test that fails at the last of so many samples of rows along the first, when all of them and all strains are these numbers
/// times the sign of +, -, -, +, ...: that has neither mean nor slope over four samples.
fn alarm_of(detector: &mut Detector, test: Test, row: f64, strain: f64) -> Option<Alarm> {
    let mut last = None;
    for sample in 0..test.samples() {
        let sign = if matches!(sample % 4, 0 | 3) {
            1.0
        } else {
            -1.0
        };
        let alarms = detector.push(&[sign * row, 0.0, 0.0], &[sign * strain; LIMBS]);
        last = alarms.iter().find(|alarm| alarm.test == test);
    }
    last
}

/// Errors of the scale factors add 3 sum of x^2 e^2/sigma^2 to the energy of a window where all limbs have one noise sigma, one
/// strain x, one error e: Q^-1 W^T W is the unit matrix over sigma^2. They are the same in all samples, so that the energy is
/// allowed as many times that as chi-square with one degree of freedom exceeds one as often as the test may fail.
#[test]
fn law_calibrations_errors_take_their_share_of_the_energy() {
    const NOISE: f64 = 1e-8;
    let noise = RowNoise::from_channels(&[NOISE; LIMBS]).expect("noise");
    let test = Test::Energy(64);
    let (row, strain, scale) = (100.0, 3e-5, 1e-3);
    let errors = CalibrationErrors::independent([scale; LIMBS], [0.0; LIMBS]);
    let statistic = |errors: Option<CalibrationErrors>| {
        let mut detector = Detector::new(noise, RATES[0].0, errors).expect("a rate");
        let alarm = alarm_of(&mut detector, test, row, strain).expect("far beyond the noise");
        assert_eq!(alarm.sample, test.samples() - 1);
        alarm.statistic
    };
    let energy = 64.0 * row * row;
    within(
        "energy of a window",
        (statistic(None) / energy - 1.0).abs(),
        tolerance::ROUNDING,
    );
    let probability = RATES[0].0 / TESTS.len() as f64 * test.samples() as f64;
    let margin = chi_square_limit(probability, 1).expect("a probability");
    let share = margin * 3.0 * 64.0 * (strain * scale / NOISE).powi(2) / test.freedom() as f64;
    within(
        "energy that calibration's errors explain in part",
        (statistic(Some(errors)) * (1.0 + share) / energy - 1.0).abs(),
        tolerance::ROUNDING,
    );
}

#[test]
fn law_beyond_the_classes_stands_the_first() {
    let noise = RowNoise::from_channels(&core::array::from_fn(|i| 1e-8 * (1.0 + i as f64)));
    let noise = noise.expect("noise");
    let (first, direction) = (noise.length(0), noise.direction(0));
    assert!((1..CLASSES).all(|class| noise.length(class) != first));
    assert_eq!(noise.length(CLASSES), first);
    assert_eq!(noise.direction(CLASSES), direction);
}
