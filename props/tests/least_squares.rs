//! Least squares itself: against an independent solver, under every change that must not matter, and under noise.

use glam::DVec3;
use nalgebra::{DMatrix, DVector, SMatrix, SVector};
use proptest::prelude::*;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use sixaxis_core::geometry::DIRECTIONS_SHELL;
use sixaxis_core::identify::inertia::{InertiaIdentification, euler_torque, regressor};
use sixaxis_core::identify::least_squares::{Accumulator, CONDITION_LIMIT, Estimate};
use sixaxis_core::identify::scale::ScaleIdentification;
use sixaxis_core::identify::{Reason, Verdict};
use sixaxis_core::{Error, Geometry, InertiaPerMass, LIMBS};
use sixaxis_props::compare::{fails_clearly, largest, within};
use sixaxis_props::statistics::chi_square_departure;
use sixaxis_props::strategy::{config, parameters, seed, vector};
use sixaxis_props::tolerance;
use sixaxis_reference::mjcf::limb_jacobian;
use sixaxis_reference::paper;

const N: usize = 4;
type Rows = Vec<([f64; N], f64)>;

fn rows() -> impl Strategy<Value = Rows> {
    prop::collection::vec(
        (prop::array::uniform4(-1.0..1.0_f64), -1.0..1.0_f64),
        12..40,
    )
}

fn solved(rows: &Rows) -> Estimate<N> {
    let mut accumulator = Accumulator::<N>::default();
    for (row, right) in rows {
        accumulator.push(*row, *right);
    }
    assert_eq!(accumulator.rows(), rows.len());
    accumulator
        .solve("random rows")
        .expect("random rows have full rank")
}

/// The same by nalgebra on the tall matrix: values, covariance, residual and condition of the scaled columns.
fn oracle(rows: &Rows) -> (DVector<f64>, DMatrix<f64>, f64, f64) {
    let tall = DMatrix::from_fn(rows.len(), N, |i, j| rows[i].0[j]);
    let right = DVector::from_fn(rows.len(), |i, _| rows[i].1);
    let values = tall
        .clone()
        .pseudo_inverse(0.0)
        .expect("a tolerance of zero")
        * &right;
    let freedom = (rows.len() - N) as f64;
    let variance = (&tall * &values - right).norm_squared() / freedom;
    let covariance = (tall.transpose() * &tall).try_inverse().expect("full rank") * variance;
    let mut scaled = tall;
    for mut column in scaled.column_iter_mut() {
        column.normalize_mut();
    }
    let singular = scaled.singular_values();
    (
        values,
        covariance,
        variance.sqrt(),
        singular.max() / singular.min(),
    )
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    largest(a.iter().zip(b).map(|(a, b)| a - b)) / largest(b.iter().copied())
}

proptest! {
    #![proptest_config(config(64))]

    #[test]
    fn ref_streaming_equals_the_tall_matrix(rows in rows()) {
        let ours = solved(&rows);
        let (values, covariance, residual, condition) = oracle(&rows);
        let care = ours.condition.powi(2);
        within("values", apart(&ours.values, values.as_slice()) / care, tolerance::LEAST_SQUARES);
        within("covariance", apart(ours.covariance.as_slice(), covariance.as_slice()) / care, tolerance::LEAST_SQUARES);
        within("residual", (ours.residual_rms / residual - 1.0).abs(), tolerance::ROUNDING);
        within("condition", (ours.condition / condition - 1.0).abs(), tolerance::ROUNDING);
        let errors = ours.standard_error();
        let diagonal: Vec<f64> = (0..N).map(|i| covariance[(i, i)].sqrt()).collect();
        within("standard errors", apart(&errors, &diagonal) / care, tolerance::LEAST_SQUARES);
        prop_assert_eq!(ours.rows, rows.len());
    }

    #[test]
    fn inv_residual_is_orthogonal_to_every_column(rows in rows()) {
        let found = solved(&rows);
        let slope = (0..N).map(|j| {
            rows.iter()
                .map(|(row, right)| {
                    let left: f64 = (0..N).map(|k| row[k] * found.values[k]).sum();
                    (left - right) * row[j]
                })
                .sum::<f64>()
        });
        within(
            "normal equations",
            largest(slope) / (found.condition * rows.len() as f64),
            tolerance::ROUNDING,
        );
    }

    #[test]
    fn inv_order_of_rows_does_not_matter(rows in rows()) {
        let forward = solved(&rows);
        let backward = solved(&rows.iter().rev().copied().collect());
        within(
            "values from reversed rows",
            apart(&forward.values, &backward.values) / forward.condition.powi(2),
            tolerance::LEAST_SQUARES,
        );
    }

    /// Unknown j in other units, and the right side in another: values and covariance follow, the condition does not.
    #[test]
    fn inv_units_do_not_matter(rows in rows(), units in prop::array::uniform4(1e-6..1e6_f64), unit in 1e-6..1e6_f64) {
        let usual = solved(&rows);
        let other = solved(&rows.iter().map(|(row, b)| {
            (core::array::from_fn(|j| row[j] * units[j]), b * unit)
        }).collect());
        let back: [f64; N] = core::array::from_fn(|j| other.values[j] * units[j] / unit);
        let care = usual.condition.powi(2);
        within("values in other units", apart(&back, &usual.values) / care, tolerance::LEAST_SQUARES);
        let error: [f64; N] = core::array::from_fn(|j| other.standard_error()[j] * units[j] / unit);
        within("standard errors in other units", apart(&error, &usual.standard_error()) / care, tolerance::LEAST_SQUARES);
        within("condition in other units", (other.condition / usual.condition - 1.0).abs() / care, tolerance::LEAST_SQUARES);
    }

    #[test]
    fn inv_relabelling_the_unknowns_relabels_the_answer(rows in rows()) {
        const TO: [usize; N] = [2, 0, 3, 1];
        let usual = solved(&rows);
        let other = solved(&rows.iter().map(|(row, b)| (core::array::from_fn(|j| row[TO[j]]), *b)).collect());
        let moved: [f64; N] = core::array::from_fn(|j| usual.values[TO[j]]);
        let care = usual.condition.powi(2);
        within("relabelled values", apart(&other.values, &moved) / care, tolerance::LEAST_SQUARES);
        let covariance = SMatrix::<f64, N, N>::from_fn(|i, j| usual.covariance[(TO[i], TO[j])]);
        within("relabelled covariance", apart(other.covariance.as_slice(), covariance.as_slice()) / care, tolerance::LEAST_SQUARES);
    }

    /// Every row twice: the same values from what looks like twice as much data.
    #[test]
    fn inv_duplicated_rows_change_the_covariance_only(rows in rows()) {
        let once = solved(&rows);
        let twice = solved(&rows.iter().chain(&rows).copied().collect());
        let care = once.condition.powi(2);
        within("values of duplicated rows", apart(&twice.values, &once.values) / care, tolerance::LEAST_SQUARES);
        within("condition of duplicated rows", (twice.condition / once.condition - 1.0).abs() / care, tolerance::LEAST_SQUARES);
        let n = rows.len() as f64;
        let expected = (n - N as f64) / (2.0 * n - N as f64);
        let ratio: Vec<f64> = once.covariance.iter().map(|c| c * expected).collect();
        within("covariance of duplicated rows", apart(twice.covariance.as_slice(), &ratio) / care, tolerance::LEAST_SQUARES);
    }

    /// Unknowns tied together after the fact: as if the rows had been pushed tied.
    #[test]
    fn inv_combining_after_equals_combining_before(rows in rows(), tie in prop::array::uniform2(-2.0..2.0_f64)) {
        let combine = |row: &[f64; N]| [row[0] + tie[0] * row[2], row[1] + tie[1] * row[3]];
        let mut whole = Accumulator::<N>::default();
        let mut tied = Accumulator::<2>::default();
        for (row, b) in &rows {
            whole.push(*row, *b);
            tied.push(combine(row), *b);
        }
        let (a, b) = (whole.combined(combine).solve("tied after"), tied.solve("tied before"));
        let (a, b) = (a.expect("random rows"), b.expect("random rows"));
        let care = b.condition.powi(2);
        within("values tied after", apart(&a.values, &b.values) / care, tolerance::LEAST_SQUARES);
        within("residual tied after", (a.residual_rms / b.residual_rms - 1.0).abs(), tolerance::ROUNDING);
        prop_assert_eq!(a.rows, b.rows);
    }

    /// W of (18) by finite differences of (15) in each entry of the tensor: exact, since (15) is linear in them.
    #[test]
    fn prop_regressor_is_the_derivative_of_the_torque(p in parameters(), w in vector(50.0), dw in vector(2000.0)) {
        let i = p.inertia_per_mass.to_paper_order();
        let step = largest(i);
        let analytic = regressor(w, dw);
        for k in 0..6 {
            let (mut up, mut down) = (i, i);
            up[k] += step;
            down[k] -= step;
            let torque = |i: [f64; 6]| euler_torque(&InertiaPerMass::from_paper_order(i), w, dw);
            let slope = (torque(up) - torque(down)) / (2.0 * step);
            let column = DVec3::from_array(analytic.map(|row| row[k]));
            within(
                "column of the regressor",
                (slope - column).length() / (dw.length() + w.length_squared()),
                tolerance::ROUNDING,
            );
        }
    }
}

fn jacobian_inverse() -> (SMatrix<f64, 9, 6>, SMatrix<f64, 6, 6>) {
    let jacobian = limb_jacobian(&Geometry::PAPER);
    let normal = (jacobian.transpose() * jacobian)
        .try_inverse()
        .expect("three nodes hold a body");
    (jacobian, normal)
}

/// Limb forces per mass of a rigid sensor.
fn forces(acceleration: DVec3, torque: DVec3) -> [f64; LIMBS] {
    let (jacobian, normal) = jacobian_inverse();
    let (a, m) = (acceleration, torque);
    (jacobian * normal * SVector::<f64, 6>::from([a.x, a.y, a.z, m.x, m.y, m.z])).into()
}

/// (13)(14) and (18)(19) against the pseudo-inverse of the matrices written out.
#[test]
fn ref_closed_forms_are_the_pseudo_inverse() {
    let truth = paper::identified_parameters();
    let mut rng = Pcg64::seed_from_u64(seed());
    let (mut scale, mut inertia) = (
        ScaleIdentification::default(),
        InertiaIdentification::new(Geometry::PAPER),
    );
    let (mut a, mut a_right) = (Vec::new(), Vec::new());
    let (mut w, mut w_right) = (Vec::new(), Vec::new());
    for _ in 0..30 {
        let wanted = random(&mut rng) * 40.0;
        let clean = forces(wanted, DVec3::ZERO);
        let measured: [f64; LIMBS] =
            core::array::from_fn(|i| clean[i] / truth.scale_per_mass_per_kg[i]);
        let read = wanted + random(&mut rng);
        scale.push(&measured, read).expect("rows are finite");
        for axis in 0..3 {
            a.push(
                (0..LIMBS)
                    .map(|i| measured[i] * DIRECTIONS_SHELL[i][axis])
                    .collect::<Vec<_>>(),
            );
            a_right.push(read[axis]);
        }
        let (rate, slope) = (random(&mut rng) * 20.0, random(&mut rng) * 400.0);
        let noise = random(&mut rng) * 1e-3;
        let force = forces(
            DVec3::ZERO,
            euler_torque(&truth.inertia_per_mass, rate, slope) + noise,
        );
        inertia.push(&force, rate, slope).expect("rows are finite");
        let n = Geometry::PAPER.half_edge_m;
        w_right.extend(
            [
                force[3] - force[1],
                force[2] - force[6],
                force[7] - force[5],
            ]
            .map(|f| f * n),
        );
        w.extend(regressor(rate, slope).map(Vec::from));
    }
    let solve = |rows: &[Vec<f64>], right: &[f64]| {
        let tall = DMatrix::from_fn(rows.len(), rows[0].len(), |i, j| rows[i][j]);
        tall.pseudo_inverse(0.0).expect("a tolerance of zero") * DVector::from_column_slice(right)
    };
    let found = scale.solve().expect("random accelerations span space");
    let by_hand = solve(&a, &a_right);
    within(
        "(14)",
        apart(&found.estimate.values, by_hand.as_slice()),
        tolerance::CLOSED_FORM,
    );
    let found = inertia.solve().expect("random motions excite everything");
    let by_hand = solve(&w, &w_right);
    within(
        "(19)",
        apart(&found.estimate.values, by_hand.as_slice()),
        tolerance::CLOSED_FORM,
    );
}

fn random(rng: &mut Pcg64) -> DVec3 {
    DVec3::from_array(core::array::from_fn(|_| StandardNormal.sample(rng)))
}

/// Squared error in units of the predicted covariance; chi-square with N degrees of freedom if that is right.
fn whitened<const M: usize>(estimate: &Estimate<M>, truth: &[f64; M], sigma: f64) -> f64 {
    let unit = estimate.covariance / estimate.residual_rms.powi(2) * sigma * sigma;
    let error = SVector::<f64, M>::from_fn(|i, _| estimate.values[i] - truth[i]);
    let unit = DMatrix::from_column_slice(M, M, unit.as_slice());
    let solved = unit
        .lu()
        .solve(&DVector::from_column_slice(error.as_slice()));
    solved
        .expect("a covariance is regular")
        .dot(&DVector::from_column_slice(error.as_slice()))
}

const TRIALS: usize = 200;

#[test]
fn prop_predicted_covariance_is_what_noise_does() {
    let mut rng = Pcg64::seed_from_u64(seed());
    let truth = paper::identified_parameters();
    let motions: Vec<[DVec3; 3]> = (0..40)
        .map(|_| {
            [
                random(&mut rng) * 30.0,
                random(&mut rng) * 20.0,
                random(&mut rng) * 400.0,
            ]
        })
        .collect();
    let (sigma_a, sigma_f) = (0.05, 0.02);
    let sigma_torque = core::f64::consts::SQRT_2 * Geometry::PAPER.half_edge_m * sigma_f;
    let gain = 1.01;
    let (mut scale, mut inertia, mut noise, mut gyroscope) = (0.0, 0.0, 0.0, 0.0);
    for _ in 0..TRIALS {
        let mut two = ScaleIdentification::default();
        let mut three = InertiaIdentification::new(Geometry::PAPER);
        let mut misread = three.clone();
        for [a, w, dw] in &motions {
            let clean = forces(*a, DVec3::ZERO);
            let measured = core::array::from_fn(|i| clean[i] / truth.scale_per_mass_per_kg[i]);
            two.push(&measured, *a + random(&mut rng) * sigma_a)
                .expect("rows are finite");
            let clean = forces(DVec3::ZERO, euler_torque(&truth.inertia_per_mass, *w, *dw));
            let noisy = clean.map(|f| {
                let unit: f64 = StandardNormal.sample(&mut rng);
                f + sigma_f * unit
            });
            three.push(&noisy, *w, *dw).expect("rows are finite");
            misread
                .push(&noisy, *w / gain, *dw / gain)
                .expect("rows are finite");
        }
        let found = two
            .solve()
            .expect("random accelerations span space")
            .estimate;
        scale += whitened(&found, &truth.scale_per_mass_per_kg, sigma_a);
        let freedom = (found.rows - LIMBS) as f64;
        noise += freedom * (found.residual_rms / sigma_a).powi(2);
        let found = three
            .solve()
            .expect("random motions excite everything")
            .estimate;
        inertia += whitened(
            &found,
            &truth.inertia_per_mass.to_paper_order(),
            sigma_torque,
        );
        let found = misread
            .solve_with_gain()
            .expect("random motions excite everything");
        gyroscope += ((found.rate_over_reading - gain) / found.standard_error).powi(2);
    }
    let rows = 3 * motions.len();
    for (what, value, freedom) in [
        ("nine scale factors", scale, LIMBS * TRIALS),
        ("six inertias", inertia, 6 * TRIALS),
        ("residual of step 2", noise, (rows - LIMBS) * TRIALS),
        ("gain of the gyroscope", gyroscope, TRIALS),
    ] {
        within(
            &format!("chi-square of the {what}"),
            chi_square_departure(value, freedom),
            tolerance::CHI_SQUARE,
        );
        // A covariance off by the root of two would be noticed.
        assert!(
            chi_square_departure(2.0 * value, freedom) > 1.0,
            "the gate on the {what} lets twice the covariance pass"
        );
    }
}

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
fn prop_motion_along_too_few_axes_is_refused_with_the_lost_direction() {
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
            tolerance::ROUNDING,
        );
        for axis in axes {
            let force = forces(*axis, DVec3::ZERO);
            let seen = (0..LIMBS).fold(DVec3::ZERO, |sum, i| {
                sum + DIRECTIONS_SHELL[i] * (force[i] * lost[i])
            });
            within(
                "what the lost direction does",
                seen.length(),
                tolerance::EXACT_ROWS,
            );
        }
    }
}

#[test]
fn prop_rotation_about_one_axis_is_refused_with_the_lost_direction() {
    let inertia = paper::identified_parameters().inertia_per_mass;
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
        tolerance::EXACT_ROWS,
    );
    fails_clearly(
        "unseen part of the lost direction",
        largest([lost[0], lost[1], lost[3]]),
        tolerance::EXACT_ROWS,
    );
}

#[test]
fn prop_condition_just_within_the_limit_is_solved_and_just_beyond_refused() {
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
        tolerance::NEAR_LIMIT,
    );
}

#[test]
fn prop_too_few_rows_are_refused_and_one_more_than_unknowns_is_enough() {
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
        apart(&found.values, &[1.0, 2.0]),
        tolerance::ROUNDING,
    );
}

#[test]
fn prop_verdicts_name_the_unknown_that_noise_drowns() {
    let truth = paper::identified_parameters();
    // Channel 6 has next to no part in the motion: its factor is lost in the noise of the accelerometer.
    let mut factors = truth.scale_per_mass_per_kg;
    factors[5] = 1e-4;
    let mut step = ScaleIdentification::default();
    let mut rng = Pcg64::seed_from_u64(seed());
    for _ in 0..200 {
        let measured: [f64; LIMBS] = core::array::from_fn(|_| StandardNormal.sample(&mut rng));
        let a = (0..LIMBS).fold(random(&mut rng) * 0.01, |sum, i| {
            sum + DIRECTIONS_SHELL[i] * (measured[i] * factors[i])
        });
        step.push(&measured, a).expect("rows are finite");
    }
    let found = step.solve().expect("the rows have full rank");
    let Verdict::Undetermined {
        reason: Reason::Noise {
            unknown,
            relative_standard_error,
        },
    } = found.verdict
    else {
        panic!("a silent limb is called determined");
    };
    assert_eq!(unknown, 6);
    let own = found.estimate.standard_error()[5] / found.estimate.values[5].abs();
    within(
        "its standard error",
        (relative_standard_error / own - 1.0).abs(),
        tolerance::ROUNDING,
    );

    // Inertia is judged against its largest entry: small products of inertia are no fault.
    let mut step = InertiaIdentification::new(Geometry::PAPER);
    for _ in 0..40 {
        let (w, dw) = (random(&mut rng) * 20.0, random(&mut rng) * 400.0);
        let torque = euler_torque(&truth.inertia_per_mass, w, dw) + random(&mut rng) * 1e-4;
        step.push(&forces(DVec3::ZERO, torque), w, dw)
            .expect("rows are finite");
    }
    let found = step.solve().expect("random motions excite everything");
    assert!(found.verdict.is_determined());
    // With a torque of pure noise at ten times the size, the worst entry is named by its error over the largest entry.
    for _ in 0..400 {
        let noise = random(&mut rng) * 3.0;
        let (w, dw) = (random(&mut rng) * 20.0, random(&mut rng) * 400.0);
        let torque = euler_torque(&truth.inertia_per_mass, w, dw) + noise;
        step.push(&forces(DVec3::ZERO, torque), w, dw)
            .expect("rows are finite");
    }
    match step.solve() {
        Ok(found) => {
            let Verdict::Undetermined {
                reason:
                    Reason::Noise {
                        unknown,
                        relative_standard_error,
                    },
            } = found.verdict
            else {
                panic!("a drowned tensor is called determined");
            };
            let errors = found.estimate.standard_error();
            let own = errors[unknown - 1] / largest(found.estimate.values);
            within(
                "standard error over the largest entry",
                (relative_standard_error / own - 1.0).abs(),
                tolerance::ROUNDING,
            );
            within(
                "the worst entry is named",
                largest(errors) / errors[unknown - 1] - 1.0,
                tolerance::ROUNDING,
            );
        }
        // Noise may as well leave a tensor that no body has.
        Err(error) => assert!(matches!(error, Error::ImpossibleInertia { .. })),
    }
}

#[test]
fn prop_a_row_that_is_no_number_is_refused_by_channel_and_sample() {
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
