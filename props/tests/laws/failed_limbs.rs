//! Decoupling without up to three limbs: which sets leave six axes, how exact what is left is, and the change from one set to
//! another in mid-stream.

use std::array::from_fn;

use glam::DVec3;
use nalgebra::{DMatrix, DVector, SMatrix};
use sixaxis_core::LimbSet;
use sixaxis_core::decouple::lanes::{LaneSample, push_lanes, push_lanes_portable};
use sixaxis_core::geometry::{DIRECTIONS_SHELL, LIMBS_PER_NODE, NODE_DIRECTIONS_MASS};
use sixaxis_core::kernel::simd::LANES;
use sixaxis_core::redundancy::reconstruction::MOST_EXCLUDED;
use sixaxis_core::redundancy::reconstruction::Reconstruction;
use sixaxis_core::six_axis::Accelerations;
use sixaxis_core::{Decoupler, Error, Gains, LIMBS, Scheme, SixAxis};
use sixaxis_props::compare::{fails_clearly, largest, within};
use sixaxis_props::manufactured::examples;
use sixaxis_props::problem::{Problem, accelerations, rig};
use sixaxis_props::tolerance;
use sixaxis_props::truth;
use sixaxis_reference::laboratory::Laboratory;
use sixaxis_reference::rig::run::{Mode, Mounting};

const RATE_HZ: f64 = 4000.0;
const SAMPLES: usize = 600;

/// Every set of up to three limbs, the empty one not among them.
fn sets() -> impl Iterator<Item = LimbSet> {
    (1..=MOST_EXCLUDED).flat_map(LimbSet::of_size)
}

fn survivable() -> impl Iterator<Item = LimbSet> {
    sets().filter(|set| Reconstruction::new(*set).is_ok())
}

/// Force and moment over the half edge of each limb, rows of J.
fn jacobian() -> SMatrix<f64, LIMBS, 6> {
    SMatrix::from_fn(|limb, axis| {
        let e = DIRECTIONS_SHELL[limb];
        let m = NODE_DIRECTIONS_MASS[limb / LIMBS_PER_NODE].cross(e);
        [e.x, e.y, e.z, m.x, m.y, m.z][axis]
    })
}

/// The decomposition of what is left of J knows nothing of parity rows or whole numbers.
#[test]
fn law_93_of_129_sets_leave_six_axes() {
    let j = jacobian();
    let mut lost = Vec::new();
    for set in sets() {
        let left: Vec<usize> = (0..LIMBS).filter(|limb| !set.contains(*limb)).collect();
        let rows = DMatrix::from_fn(left.len(), 6, |i, axis| j[(left[i], axis)]);
        let svd = rows.clone().svd(false, true);
        let rank = svd.rank(1e-9);
        match Reconstruction::new(set) {
            Ok(_) => assert_eq!(rank, 6, "{set}"),
            Err(Error::LostLoad {
                excluded: failed,
                load,
            }) => {
                assert_eq!(rank, 5, "{set}");
                assert_eq!(failed, set);
                // What no limb but failed ones feels is the motion along which the others do not change their lengths.
                let named = DVector::from_iterator(
                    6,
                    load.force_shell
                        .into_iter()
                        .chain(load.torque_over_half_edge_shell)
                        .map(f64::from),
                );
                let motion = (j.transpose() * j).try_inverse().expect("nine limbs") * named;
                within(
                    "length that the others change under a lost load, over the motion",
                    (rows * motion).norm() / motion.norm(),
                    tolerance::ROUNDING,
                );
                let v = svd.v_t.expect("asked for");
                let idle = v.row(svd.singular_values.imin()).transpose();
                within(
                    "the lost load's motion against the singular vector",
                    (1.0 - (idle.dot(&motion) / motion.norm()).abs()).abs(),
                    tolerance::LAST_DIGITS,
                );
                lost.push(set);
            }
            Err(error) => panic!("{set}: {error}"),
        }
    }
    let count = |size: usize| lost.iter().filter(|set| set.len() == size).count();
    assert_eq!([1, 2, 3].map(count), [0, 3, 33]);
    assert_eq!(sets().count() - lost.len(), 93);
    let four = LimbSet::from_numbers([1, 2, 3, 6]).expect("limbs");
    assert!(matches!(
        Reconstruction::new(four),
        Err(Error::OutOfRange { .. })
    ));
}

/// All six axes at once, strains up to 3e-5.
fn moving(scheme: Scheme) -> Problem {
    let motion = examples::turning_from_rest();
    Problem::manufactured(&motion, Gains::uniform(2.0), RATE_HZ, SAMPLES, scheme)
}

/// Half a second of the rig at 5 Hz, from MuJoCo.
fn on_the_rig() -> Problem {
    let parameters = truth::identified_parameters();
    let direction = DVec3::new(2.0, 1.0, 1.0).normalize();
    let run = rig::simulate(
        &parameters,
        Mode::Compound,
        direction,
        Mounting::AxisVertical,
    );
    let recording = Laboratory::noise_free(truth::sensor(&parameters)).record(&run, 0);
    Problem::recorded(&recording, &parameters, Scheme::Heun)
}

fn excluding(problem: &Problem, set: LimbSet) -> Decoupler {
    let reduced = problem.decoupler().excluding(set);
    reduced.expect("a survivable set")
}

/// The rows with what a broken channel may deliver.
fn spoilt(problem: &Problem, set: LimbSet) -> Vec<[f64; LIMBS]> {
    let broken = [f64::NAN, f64::INFINITY, 1e300];
    let spoil = |(i, row): (usize, &[f64; LIMBS])| {
        from_fn(|c| match set.contains(c) {
            true => broken[(i + c) % broken.len()],
            false => row[c],
        })
    };
    problem.voltage_v.iter().enumerate().map(spoil).collect()
}

fn stream(problem: &Problem, set: LimbSet, voltage_v: &[[f64; LIMBS]]) -> Vec<SixAxis> {
    let mut decoupler = excluding(problem, set);
    let push = |row| decoupler.push(row).expect("a sound sample");
    voltage_v.iter().filter_map(push).collect()
}

/// Largest difference on any of six axes over full scale, the peak of the vector.
fn beyond(ours: &[Accelerations], healthy: &[Accelerations]) -> f64 {
    assert_eq!(ours.len(), healthy.len(), "samples");
    largest([0, 3].map(|first| {
        let vector = |row: &Accelerations| DVec3::from_slice(&row[first..first + 3]);
        let peak = largest(healthy.iter().map(|row| vector(row).length()));
        let off = |(a, b): (_, _)| (vector(a) - vector(b)).abs().max_element();
        largest(ours.iter().zip(healthy).map(off)) / peak
    }))
}

#[test]
fn ref_without_limbs_as_with_them() {
    let rig = on_the_rig();
    let manufactured = moving(Scheme::Heun);
    for (what, case, limit) in [
        ("six axes", &manufactured, tolerance::WITHOUT_LIMBS),
        ("rig", &rig, tolerance::WITHOUT_LIMBS_RIG),
    ] {
        let healthy = accelerations(&stream(case, LimbSet::EMPTY, &case.voltage_v));
        let worst = survivable().map(|set| {
            let ours = stream(case, set, &spoilt(case, set));
            beyond(&accelerations(&ours), &healthy)
        });
        within(
            format!("accelerations without limbs beyond those with all, noise-free, {what}"),
            largest(worst),
            limit,
        );
    }
    // A limb given a strain of zero instead of its own.
    let set = LimbSet::from_numbers([2]).expect("a limb");
    let healthy = accelerations(&stream(
        &manufactured,
        LimbSet::EMPTY,
        &manufactured.voltage_v,
    ));
    let drift = manufactured.parameters.zero_drift_v[1];
    let zeroed: Vec<_> = manufactured
        .voltage_v
        .iter()
        .map(|row| from_fn(|c| if set.contains(c) { drift } else { row[c] }))
        .collect();
    let ours = accelerations(&stream(&manufactured, LimbSet::EMPTY, &zeroed));
    fails_clearly(
        "a zero for the failed limb",
        beyond(&ours, &healthy),
        tolerance::WITHOUT_LIMBS,
    );
}

#[test]
fn inv_every_path_does_without_limbs_alike() {
    let case = moving(Scheme::Heun);
    let every_path = survivable().chain([LimbSet::EMPTY]);
    let sets: Vec<LimbSet> = every_path.collect();
    let mut answers: Vec<Vec<Accelerations>> = Vec::new();
    for set in &sets {
        let rows = spoilt(&case, *set);
        let stream = accelerations(&stream(&case, *set, &rows));
        let mut record = Vec::new();
        let mut portable = Vec::new();
        let mut decoupler = excluding(&case, *set);
        decoupler
            .push_record(&rows, &mut |done| record.extend(done.iter()))
            .expect("sound samples");
        excluding(&case, *set)
            .push_record_portable(&rows, &mut |done| portable.extend(done.iter()))
            .expect("sound samples");
        within(
            "record without limbs",
            beyond(&accelerations(&record), &stream),
            tolerance::PATHS,
        );
        within(
            "portable record without limbs",
            beyond(&accelerations(&portable), &stream),
            tolerance::PATHS,
        );
        answers.push(stream);
    }
    // Eight streams with different limbs missing, a whole one among them.
    for (sets, answers) in sets
        .chunks_exact(LANES)
        .zip(answers.chunks_exact(LANES))
        .chain([(
            &sets[sets.len() - LANES..],
            &answers[answers.len() - LANES..],
        )])
    {
        let rows: [Vec<_>; LANES] = from_fn(|lane| spoilt(&case, sets[lane]));
        for (what, portable) in [
            ("lanes without limbs", false),
            ("portable lanes without limbs", true),
        ] {
            let mut streams: [Decoupler; LANES] = from_fn(|lane| excluding(&case, sets[lane]));
            let mut lanes: [Vec<Accelerations>; LANES] = from_fn(|_| Vec::new());
            let mut sink = |chunk: &[LaneSample]| {
                for sample in chunk {
                    for (lane, answers) in lanes.iter_mut().enumerate() {
                        answers.push(from_fn(|i| sample[i].0[lane]));
                    }
                }
            };
            let rows = from_fn(|lane| &rows[lane][..]);
            let pushed = if portable {
                push_lanes_portable(&mut streams, rows, &mut sink)
            } else {
                push_lanes(&mut streams, rows, &mut sink)
            };
            pushed.expect("sound samples");
            for (ours, stream) in lanes.iter().zip(answers) {
                within(what, beyond(ours, stream), tolerance::PATHS);
            }
        }
    }
}

#[test]
fn inv_single_precision_does_without_limbs() {
    let case = moving(Scheme::Heun);
    let single = |set: LimbSet| -> Vec<Accelerations> {
        let mut decoupler = Decoupler::new_f32(&case.sensor, &case.parameters, &case.settings)
            .and_then(|decoupler| decoupler.excluding(set))
            .expect("sound");
        let rows = spoilt(&case, set);
        let push = |row: &[f64; LIMBS]| decoupler.push(&row.map(|u| u as f32)).expect("sound");
        rows.iter()
            .filter_map(push)
            .map(|s| {
                let numbers = [s.linear_ground_m_s2, s.angular_ground_rad_s2].map(|v| v.to_array());
                from_fn(|i| f64::from(numbers[i / 3][i % 3]))
            })
            .collect()
    };
    let healthy = accelerations(&stream(&case, LimbSet::EMPTY, &case.voltage_v));
    let own = beyond(&single(LimbSet::EMPTY), &healthy);
    let worst = largest(survivable().map(|set| beyond(&single(set), &healthy)));
    within(
        "f32 without limbs over f32 with all",
        worst / own,
        tolerance::WITHOUT_LIMBS_F32,
    );
}

/// Largest differences of rate over its peak, and of attitude, rad.
fn jump(ours: &[SixAxis], others: &[SixAxis]) -> [f64; 2] {
    assert_eq!(ours.len(), others.len(), "samples");
    let pairs = || ours.iter().zip(others);
    let peak = largest(others.iter().map(|s| s.rate_shell_rad_s.length()));
    let rate = pairs().map(|(a, b)| (a.rate_shell_rad_s - b.rate_shell_rad_s).length() / peak);
    let turn = pairs().map(|(a, b)| 2.0 * (a.attitude.inverse() * b.attitude).xyz().length());
    [largest(rate), largest(turn)]
}

#[test]
fn inv_switching_over_leaves_no_jump() {
    let set = LimbSet::from_numbers([1, 6, 9]).expect("limbs");
    for scheme in Scheme::ALL {
        let case = moving(scheme);
        for times in [
            (1, 7),
            (2, 90),
            (3, 200),
            (300, 301),
            (301, 450),
            (450, 599),
        ] {
            switched(&case, scheme, set, times);
        }
    }
    let case = moving(Scheme::Heun);
    for set in survivable() {
        switched(&case, Scheme::Heun, set, (301, 450));
    }
}

/// The channels of a set break at a sample that has been received already when it is noticed, and are sound again later.
fn switched(case: &Problem, scheme: Scheme, set: LimbSet, (breaks, sound): (usize, usize)) {
    let healthy = stream(case, LimbSet::EMPTY, &case.voltage_v);
    let mut rows = case.voltage_v.clone();
    for row in &mut rows[breaks..sound - 1] {
        for limb in set.indices() {
            // At the converter's limit.
            row[limb] = 10.0;
        }
    }
    let run = |switches: bool| -> Vec<SixAxis> {
        let mut decoupler = excluding(case, LimbSet::EMPTY);
        let mut samples = Vec::new();
        for (i, row) in rows.iter().enumerate() {
            samples.extend(decoupler.push(row).expect("finite"));
            if switches && i == breaks {
                decoupler.set_excluded(set).expect("survivable");
                assert_eq!(decoupler.excluded(), set);
            }
            if switches && i == sound.max(breaks + 2) {
                decoupler.set_excluded(LimbSet::EMPTY).expect("all nine");
            }
        }
        samples
    };
    let ours = run(true);
    assert_eq!(ours, run(true), "the same bits");
    // The answer to the sample before the broken one is out when the break is noticed.
    let out = breaks.saturating_sub(2);
    let after = |samples: &[SixAxis]| {
        let mut kept = samples.to_vec();
        if out < kept.len() && breaks >= 2 {
            kept.remove(out);
        }
        kept
    };
    let [rate, turn] = jump(&after(&ours), &after(&healthy));
    within(
        format!("rate after switching over, {}", scheme.name()),
        rate,
        tolerance::SWITCH_OVER_RATE,
    );
    within(
        format!("attitude after switching over, {}", scheme.name()),
        turn,
        tolerance::SWITCH_OVER,
    );
    if sound - breaks > 20 {
        let [rate, turn] = jump(&after(&run(false)), &after(&healthy));
        fails_clearly(
            "rate with a broken channel",
            rate,
            tolerance::SWITCH_OVER_RATE,
        );
        fails_clearly(
            "attitude with a broken channel",
            turn,
            tolerance::SWITCH_OVER,
        );
    }
}

#[test]
fn inv_a_refused_switch_changes_nothing() {
    let case = moving(Scheme::Heun);
    let mut decoupler = excluding(&case, LimbSet::EMPTY);
    for row in &case.voltage_v[..20] {
        decoupler.push(row).expect("sound");
    }
    let before = decoupler.clone();
    let twins = LimbSet::from_numbers([2, 4]).expect("limbs");
    assert!(matches!(
        decoupler.set_excluded(twins),
        Err(Error::LostLoad { .. })
    ));
    assert_eq!(decoupler, before);
    // A limb that is taken back must be sound.
    let one = LimbSet::from_numbers([5]).expect("a limb");
    decoupler.set_excluded(one).expect("survivable");
    let mut row = case.voltage_v[20];
    row[4] = f64::NAN;
    decoupler.push(&row).expect("channel 5 is not listened to");
    let error = decoupler.set_excluded(LimbSet::EMPTY).expect_err("NaN");
    assert!(
        matches!(
            error,
            Error::NotFinite {
                channel: 5,
                sample: 20,
                ..
            }
        ),
        "{error}"
    );
    assert_eq!(decoupler.excluded(), one);
    // The others are still watched.
    row[6] = f64::INFINITY;
    let error = decoupler.push(&row).expect_err("infinity");
    assert!(
        matches!(
            error,
            Error::NotFinite {
                channel: 7,
                sample: 21,
                ..
            }
        ),
        "{error}"
    );
}
