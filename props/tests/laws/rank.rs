//! What the rows cannot tell: refused, with the lost direction, the channel or the number of rows named.

use glam::DVec3;
use sixaxis_core::geometry::DIRECTIONS_SHELL;
use sixaxis_core::identify::inertia::{InertiaIdentification, euler_torque};
use sixaxis_core::identify::least_squares::{Accumulator, CONDITION_LIMIT};
use sixaxis_core::identify::scale::ScaleIdentification;
use sixaxis_core::{Error, Geometry, LIMBS};
use sixaxis_props::compare::{fails_clearly, largest, within};
use sixaxis_props::rigid::forces;
use sixaxis_props::tolerance;
use sixaxis_props::truth;

fn rank_deficiency<T>(result: Result<T, Error>) -> (usize, usize, f64, [f64; 9]) {
    match result {
        Err(Error::RankDeficient {
            unknowns,
            rank,
            condition,
            lost_direction,
            ..
        }) => (unknowns, rank, condition, lost_direction),
        Err(other) => panic!("refused for another reason: {other}"),
        Ok(_) => panic!("not refused"),
    }
}

#[test]
fn law_motion_along_too_few_axes_is_refused_with_the_lost_direction() {
    for axes in [&[DVec3::X][..], &[DVec3::Y, DVec3::new(1.0, 2.0, 0.0)][..]] {
        let mut step = ScaleIdentification::default();
        for i in 1..40 {
            let a = axes[i % axes.len()] * i as f64;
            step.push(&forces(a, DVec3::ZERO), a)
                .expect("rows are finite");
        }
        let (unknowns, rank, _, lost) = rank_deficiency(step.solve());
        // Each acceleration gives as many equations as it has components of force to tell apart.
        assert_eq!(unknowns, LIMBS);
        assert!(rank < LIMBS);
        let length: f64 = lost.iter().map(|x| x * x).sum();
        within(
            "length of the lost direction",
            (length - 1.0).abs(),
            tolerance::LAST_DIGITS,
        );
        for axis in axes {
            let force = forces(*axis, DVec3::ZERO);
            let seen = (0..LIMBS).fold(DVec3::ZERO, |sum, i| {
                sum + DIRECTIONS_SHELL[i] * (force[i] * lost[i])
            });
            within(
                "what the lost direction does",
                seen.length(),
                tolerance::LAST_DIGITS,
            );
        }
    }
}

#[test]
fn law_rotation_about_one_axis_is_refused_with_the_lost_direction() {
    let inertia = truth::identified_parameters().inertia_per_mass;
    let mut step = InertiaIdentification::new(Geometry::PAPER);
    for i in 1..40 {
        let (w, dw) = (DVec3::Z * f64::from(i), DVec3::Z * f64::from(i * i % 17));
        step.push(&forces(DVec3::ZERO, euler_torque(&inertia, w, dw)), w, dw)
            .expect("rows are finite");
    }
    let (unknowns, rank, condition, lost) = rank_deficiency(step.solve());
    // About z: I3, I5 and I6 are seen, I1, I2 and I4 are not.
    assert_eq!((unknowns, rank), (6, 3));
    assert!(condition >= CONDITION_LIMIT);
    let seen = largest([lost[2], lost[4], lost[5]]);
    within(
        "seen part of the lost direction",
        seen,
        tolerance::LAST_DIGITS,
    );
    fails_clearly(
        "unseen part of the lost direction",
        largest([lost[0], lost[1], lost[3]]),
        tolerance::LAST_DIGITS,
    );
}

#[test]
fn law_condition_just_within_the_limit_is_solved_and_just_beyond_refused() {
    let nearly = |condition: f64| {
        // Two unit columns at a small angle: condition 2/angle for small angles.
        let angle = 2.0 / condition;
        let mut accumulator = Accumulator::<2>::default();
        accumulator.push([1.0, angle.cos()], 1.0);
        accumulator.push([0.0, angle.sin()], 0.0);
        accumulator.push([0.0, 0.0], 0.0);
        accumulator.solve("two columns")
    };
    let found = nearly(0.9 * CONDITION_LIMIT).expect("within the limit");
    within(
        "condition",
        (found.condition / (0.9 * CONDITION_LIMIT) - 1.0).abs(),
        tolerance::NEAR_LIMIT,
    );
    let (_, rank, condition, lost) = rank_deficiency(nearly(1.1 * CONDITION_LIMIT));
    assert_eq!(rank, 1);
    within(
        "condition",
        (condition / (1.1 * CONDITION_LIMIT) - 1.0).abs(),
        tolerance::NEAR_LIMIT,
    );
    within(
        "the lost direction is the difference",
        (lost[0] + lost[1]).abs(),
        tolerance::LAST_DIGITS,
    );
}

#[test]
fn law_too_few_rows_are_refused_and_one_more_than_unknowns_is_enough() {
    let mut accumulator = Accumulator::<2>::default();
    accumulator.push([1.0, 0.0], 1.0);
    accumulator.push([0.0, 1.0], 2.0);
    assert!(matches!(
        accumulator.solve("two unknowns"),
        Err(Error::TooFewSamples {
            needed: 3,
            got: 2,
            ..
        })
    ));
    accumulator.push([1.0, 1.0], 3.0);
    let found = accumulator
        .solve("two unknowns")
        .expect("three rows are enough");
    within(
        "values",
        (found.values[0] - 1.0).hypot(found.values[1] - 2.0),
        tolerance::ROUNDING,
    );
}
#[test]
fn law_a_row_with_nan_is_refused_by_channel_and_sample() {
    let mut step = ScaleIdentification::default();
    step.push(&[1.0; LIMBS], DVec3::X).expect("a finite row");
    let mut bad = [1.0; LIMBS];
    bad[3] = f64::NAN;
    assert!(matches!(
        step.push(&bad, DVec3::X),
        Err(Error::NotFinite {
            channel: 4,
            sample: 1,
            ..
        })
    ));
    assert!(matches!(
        step.push(&[1.0; LIMBS], DVec3::new(0.0, f64::INFINITY, 0.0)),
        Err(Error::NotFinite {
            channel: 0,
            sample: 1,
            ..
        })
    ));
    let mut step = InertiaIdentification::new(Geometry::PAPER);
    step.push(&[1.0; LIMBS], DVec3::X, DVec3::Y)
        .expect("a finite row");
    assert!(matches!(
        step.push(&[1.0; LIMBS], DVec3::X, DVec3::NAN),
        Err(Error::NotFinite {
            channel: 0,
            sample: 1,
            ..
        })
    ));
    let mut accumulator = Accumulator::<2>::default();
    for _ in 0..3 {
        accumulator.push([1.0, f64::MAX], f64::MAX);
    }
    assert!(accumulator.solve("rows that overflow").is_err());
}
