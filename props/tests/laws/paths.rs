//! Every way through the kernel gives the same answer: sample by sample, as a record, in lanes, in single precision; and
//! that answer is the printed formulas'.

use std::array::from_fn;

use glam::DVec3;
use proptest::prelude::*;
use sixaxis_core::decouple::lanes::{LaneSample, push_lanes, push_lanes_portable};
use sixaxis_core::decouple::record::BlockCount;
use sixaxis_core::kernel::constants::Constants;
use sixaxis_core::kernel::order::to_kernel_order;
use sixaxis_core::kernel::placement::{self, LimbLoad};
use sixaxis_core::kernel::simd::LANES;
use sixaxis_core::kernel::vec3::Vec3;
use sixaxis_core::paper::RateVariable;
use sixaxis_core::six_axis::{NUMBERS, SixAxisColumns};
use sixaxis_core::{
    Decoupler, Error, Gains, Geometry, LIMBS, Model, Scheme, Sensor, Settings, SixAxis,
};
use sixaxis_props::compare::largest;
use sixaxis_props::evidence::Row;
use sixaxis_props::manufactured::motion::Manufactured;
use sixaxis_props::problem::{Problem, rig};
use sixaxis_props::strategy::{config, manufactured, parameters};
use sixaxis_props::tolerance::{self, Tolerance};
use sixaxis_props::truth;
use sixaxis_reference::laboratory::Laboratory;
use sixaxis_reference::rig::run::{Mounting, Run};

/// A manufactured motion from its start, with the shell at rest at first.
fn moving(motion: &Manufactured, rate_hz: f64, samples: usize, scheme: Scheme) -> Problem {
    Problem::manufactured(motion, Gains::uniform(2.0), rate_hz, samples, scheme)
}

/// The paper's compound run at 5 Hz from MuJoCo, 10 kHz.
fn on_the_rig(scheme: Scheme) -> Problem {
    let parameters = truth::identified_parameters();
    let long = Run {
        steady_periods: 4.0,
        ..rig::compound_run()
    };
    let model = rig::model(&parameters, long.direction_ground, Mounting::AxisVertical);
    let run = sixaxis_reference::mujoco::simulate_run(&model, &long, rig::RATE_HZ, rig::STEPS)
        .expect("a run of the campaign simulates");
    let recording = Laboratory::noise_free(truth::sensor(&parameters)).record(&run, 0);
    Problem::recorded(&recording, &parameters, scheme)
}

/// The first numbers of answers.
fn numbers<'a, const N: usize>(answers: impl IntoIterator<Item = &'a SixAxis>) -> Vec<[f64; N]> {
    let first = |answer: &SixAxis| {
        let numbers = answer.numbers();
        from_fn(|i| numbers[i])
    };
    answers.into_iter().map(first).collect()
}

fn stream<const N: usize>(problem: &Problem) -> Vec<[f64; N]> {
    numbers(&problem.decouple())
}

/// How a record is handed over.
#[derive(Clone, Copy)]
enum Given {
    Rows,
    Columns,
    Portable,
}

/// As a record in two pieces.
fn record<const N: usize>(problem: &Problem, split: usize, given: Given) -> Vec<[f64; N]> {
    let mut decoupler = problem.decoupler();
    let mut answers = Vec::new();
    let (head, tail) = problem.voltage_v.split_at(split);
    for piece in [head, tail] {
        let sink = &mut |done: SixAxisColumns| answers.extend(done.iter());
        let pushed = match given {
            Given::Rows => decoupler.push_record(piece, sink),
            Given::Columns => {
                let columns: [Vec<f64>; LIMBS] =
                    from_fn(|i| piece.iter().map(|row| row[i]).collect());
                decoupler.push_columns(columns.each_ref().map(|column| &column[..]), sink)
            }
            Given::Portable => decoupler.push_record_portable(piece, sink),
        };
        pushed.expect("sound samples");
    }
    let samples: Vec<u64> = answers
        .iter()
        .map(|answer: &SixAxis| answer.sample)
        .collect();
    let expected: Vec<u64> = (1..).take(samples.len()).collect();
    assert_eq!(samples, expected, "samples in order");
    numbers(&answers)
}

/// Largest difference over the larger peak, of accelerations, rate and attitude as far as they are given.
fn difference<const N: usize>(ours: &[[f64; N]], theirs: &[[f64; N]]) -> f64 {
    assert_eq!(ours.len(), theirs.len(), "samples");
    let vectors = [0..3, 3..6, 6..9, 9..NUMBERS].into_iter();
    largest(vectors.take_while(|axes| axes.end <= N).map(|axes| {
        let peak = largest(
            theirs
                .iter()
                .flat_map(|row| row[axes.clone()].iter().map(|x| x.abs())),
        );
        let error = ours
            .iter()
            .zip(theirs)
            .flat_map(|(a, b)| axes.clone().map(move |i| (a[i] - b[i]).abs()));
        // One answer to the sample of a start from rest may be nothing at all.
        largest(error) / peak.max(f64::MIN_POSITIVE)
    }))
}

fn judge(what: &str, case: impl std::fmt::Display, error: f64, tolerance: Tolerance) {
    Row::new(what, error, tolerance).case(case).judge();
}

proptest! {
    #![proptest_config(config(48))]

    #[test]
    fn inv_a_record_and_lanes_are_the_stream(
        motions in prop::collection::vec(manufactured(), LANES),
        scheme in prop::sample::select(&Scheme::ALL[..]),
        samples in 3_usize..1200,
        split in 0.0..1.0_f64,
        per_period in 100.0..400.0_f64,
    ) {
        let cases: Vec<Problem> = motions
            .iter()
            .map(|m| moving(m, m.highest_frequency_hz() * per_period, samples, scheme))
            .collect();
        let case = &cases[0];
        let streamed = stream::<NUMBERS>(case);
        let split = (split * samples as f64) as usize;
        for (what, given) in [("record", Given::Rows), ("record, portable", Given::Portable)] {
            let error = difference(&record(case, split, given), &streamed);
            judge(what, scheme.name(), error, tolerance::PATHS);
        }
        prop_assert_eq!(
            record::<NUMBERS>(case, split, Given::Columns),
            record(case, split, Given::Rows)
        );
        for (what, portable) in [("lanes", false), ("lanes, portable", true)] {
            let mut decouplers: [Decoupler; LANES] = from_fn(|lane| cases[lane].decoupler());
            let mut lanes: [Vec<[f64; 9]>; LANES] = from_fn(|_| Vec::new());
            for piece in [0..split, split..samples] {
                let rows = from_fn(|lane| &cases[lane].voltage_v[piece.clone()]);
                let mut sink = |chunk: &[LaneSample]| {
                    for sample in chunk {
                        for (lane, answers) in lanes.iter_mut().enumerate() {
                            answers.push(from_fn(|i| sample[i].0[lane]));
                        }
                    }
                };
                let pushed = if portable {
                    push_lanes_portable(&mut decouplers, rows, &mut sink)
                } else {
                    push_lanes(&mut decouplers, rows, &mut sink)
                };
                pushed.expect("sound samples");
            }
            for (answers, case) in lanes.iter().zip(&cases) {
                let error = difference(answers, &stream(case));
                judge(what, scheme.name(), error, tolerance::PATHS);
            }
        }
    }

    #[test]
    fn ref_the_series_are_the_closed_form(
        parameters in parameters(),
        strain in prop::array::uniform9(-1.0..1.0_f64),
        log_size in -3.0..-2.0_f64,
    ) {
        let sensor = Sensor { geometry: Geometry::PAPER, gains: Gains::uniform(1.0) };
        let constants = Model::new(&sensor, &parameters, &Settings::new(1e4))
            .and_then(|model| Constants::new(&model))
            .expect("sound");
        let norm = strain.iter().map(|x| x * x).sum::<f64>().sqrt();
        prop_assume!(norm > 0.1);
        let size = 10.0_f64.powf(log_size) / norm;
        let voltage: [f64; LIMBS] = from_fn(|i| {
            let at_zero = constants.strain(i, 0.0);
            (size * strain[i] - at_zero) / (constants.strain(i, 1.0) - at_zero)
        });
        let series = placement::by_series(&constants, to_kernel_order(voltage));
        let exact = placement::exactly(&constants, &voltage, 0).expect("limbs that meet");
        // Forces of unit strain are one, torques over the moments are not.
        let torque = largest(constants.torque.iter().map(|row| row.dot(*row).sqrt()));
        let numbers = |p: &LimbLoad<f64>| {
            [p.position_thrice, p.rotation, p.force, p.torque.times(1.0 / torque)]
        };
        let names = ["three times the position", "rotation", "force", "torque"];
        for ((name, a), b) in names.into_iter().zip(numbers(&series)).zip(numbers(&exact)) {
            let d: Vec3<f64> = a - b;
            // Beyond the limit of use, where what is dropped stands far above rounding.
            let dropped = d.dot(d).sqrt() / exact.strain_squares.powi(2);
            judge("terms that the strain series drop, over strain^4", name, dropped, tolerance::STRAIN_SERIES);
        }
    }

    /// Wherever in a record the bad sample is, everything before it comes out, and its error is the stream's.
    #[test]
    fn prop_a_bad_sample_is_found_in_any_path(
        motion in manufactured(),
        at in 0_usize..400,
        channel in 0..LIMBS,
        bad in prop::sample::select(&[f64::NAN, f64::INFINITY, 1e12, 2e3][..]),
    ) {
        let rate = motion.highest_frequency_hz() * 200.0;
        let mut case = moving(&motion, rate, 400, Scheme::Heun);
        case.voltage_v[at][channel] = bad;
        let mut stream = case.decoupler();
        let mut wanted = Vec::new();
        let refused = case.voltage_v.iter().find_map(|row| match stream.push(row) {
            Ok(answer) => {
                wanted.extend(answer);
                None
            }
            Err(error) => Some(error),
        });
        let mut record = case.decoupler();
        let mut got = Vec::new();
        let answer = record.push_record(&case.voltage_v, &mut |done| got.extend(done.iter()));
        // NaN is not equal to itself.
        prop_assert_eq!(format!("{:?}", answer.err()), format!("{:?}", &refused));
        prop_assert_eq!(record.received(), stream.received());
        prop_assert_eq!(got.len(), wanted.len());
        // A voltage that is accepted though it is a thousand times too large turns the sensor so fast that rounding grows to the size of
        // the answer: what comes after it is no measure.
        let before = at.min(wanted.len());
        if before > 1 {
            let error = difference(&numbers::<NUMBERS>(&got[..before]), &numbers(&wanted[..before]));
            judge("record up to a bad sample", bad, error, tolerance::PATHS);
        }
        let mut decouplers: [Decoupler; LANES] = from_fn(|_| case.decoupler());
        let mut sound = case.voltage_v.clone();
        sound[at] = sound[(at + 399) % 400];
        let rows = from_fn(|lane| if lane == 5 { &case.voltage_v[..] } else { &sound[..] });
        let mut count = 0;
        let lanes = push_lanes(&mut decouplers, rows, &mut |chunk| count += chunk.len());
        match (lanes, refused) {
            (Ok(()), None) => prop_assert_eq!(count, 398),
            (Err(lane), Some(error)) => {
                prop_assert_eq!(lane.lane, 5);
                prop_assert_eq!(format!("{:?}", lane.error), format!("{error:?}"));
                prop_assert_eq!(count, wanted.len());
            }
            (lanes, refused) => prop_assert!(false, "{lanes:?} beside {refused:?}"),
        }
    }
}

/// Ten thousand samples of the rig, every path, against the printed formulas in the same discretisation.
#[test]
fn ref_the_paths_are_the_printed_formulas() {
    let case = &on_the_rig(Scheme::Heun);
    assert!(case.voltage_v.len() > 10_000, "a long run");
    let model = Model::new(&case.sensor, &case.parameters, &case.settings).expect("sound");
    let printed = sixaxis_core::paper::decouple(&model, RateVariable::Mass, &case.voltage_v)
        .expect("sound samples");
    let printed = numbers::<6>(&printed);
    for (what, answers) in [
        ("stream", stream(case)),
        ("record", record(case, 0, Given::Rows)),
        ("record, portable", record(case, 777, Given::Portable)),
    ] {
        judge(
            "accelerations against the printed formulas",
            what,
            difference(&answers, &printed),
            tolerance::PRINTED_FORMULAS,
        );
    }
}

/// Which way blocks go: from rest, across the rate at which the polynomials end, and beyond it, where the bits are the stream's.
#[test]
fn law_blocks_go_sample_by_sample_where_the_shell_turns_far() {
    // Half a turn's angle of 0.05 from one sample to the next is 1000 rad/s at the rig's 10 kHz.
    let direction = DVec3::new(2.0, 1.0, 2.0) / 3.0;
    let ways = |rate_rad_s: f64| {
        let mut case = on_the_rig(Scheme::Heun);
        case.settings.initial_rate_shell_rad_s = direction * rate_rad_s;
        let mut decoupler = case.decoupler();
        let mut answers = Vec::new();
        decoupler
            .push_record(&case.voltage_v, &mut |done| answers.extend(done.iter()))
            .expect("sound samples");
        let blocks = decoupler.blocks();
        let all = blocks.whole + blocks.again + blocks.singly;
        assert_eq!(all as usize, (case.voltage_v.len() - 3) / 128, "{blocks:?}");
        let same_bits = numbers::<NUMBERS>(&answers) == stream(&case);
        (blocks, all, same_bits)
    };
    let (slow, all, _) = ways(0.0);
    let whole = BlockCount {
        whole: all,
        ..BlockCount::default()
    };
    assert_eq!(slow, whole);
    let (fast, all, same_bits) = ways(2000.0);
    let singly = BlockCount {
        singly: all,
        ..BlockCount::default()
    };
    assert_eq!(fast, singly);
    assert!(same_bits, "sample by sample is the stream");
    let (across, ..) = ways(1000.0);
    assert!(
        across.whole > 0 && across.again > 0 && across.singly > 0,
        "{across:?}"
    );
}

#[test]
fn ref_single_precision_holds_its_budget() {
    let case = &on_the_rig(Scheme::Heun);
    let double = stream::<6>(case);
    let mut decoupler =
        Decoupler::new_f32(&case.sensor, &case.parameters, &case.settings).expect("a sound sensor");
    let single: Vec<[f64; 6]> = case
        .voltage_v
        .iter()
        .filter_map(|row| {
            let row = row.map(|u| u as f32);
            decoupler.push(&row).expect("a sound sample")
        })
        .map(|s| {
            let (a, w) = (s.linear_ground_m_s2, s.angular_ground_rad_s2);
            [a.x, a.y, a.z, w.x, w.y, w.z].map(f64::from)
        })
        .collect();
    let error = difference(&single, &double);
    judge(
        "single precision",
        "rig, 5 Hz",
        error,
        tolerance::SINGLE_PRECISION,
    );
    assert!(error > 1e-9, "single precision was not single");
}

#[test]
fn regress_a_strained_limb_is_named() {
    let parameters = truth::identified_parameters();
    let sensor = Sensor {
        geometry: Geometry::PAPER,
        gains: Gains::uniform(1.0),
    };
    let mut decoupler = Decoupler::new(&sensor, &parameters, &Settings::new(1e4)).expect("sound");
    let mut row = parameters.zero_drift_v;
    row[6] = -1e7;
    let refused = decoupler.push(&row).expect_err("a limb twice as long");
    assert!(
        matches!(
            refused,
            Error::Overstrained {
                channel: 7,
                sample: 0,
                ..
            }
        ),
        "{refused}"
    );
}
