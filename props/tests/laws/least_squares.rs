//! Least squares itself: against an independent solver, and under every change that must not matter.

use glam::DVec3;
use nalgebra::{DMatrix, DVector, SMatrix};
use proptest::prelude::*;
use rand::SeedableRng;
use rand_pcg::Pcg64;
use sixaxis_core::geometry::DIRECTIONS_SHELL;
use sixaxis_core::identify::inertia::{InertiaIdentification, euler_torque, regressor};
use sixaxis_core::identify::least_squares::{Accumulator, Estimate};
use sixaxis_core::identify::scale::ScaleIdentification;
use sixaxis_core::{Geometry, InertiaPerMass, LIMBS};
use sixaxis_props::compare::{largest, within};
use sixaxis_props::rigid::forces;
use sixaxis_props::seed::seed;
use sixaxis_props::statistics::normal;
use sixaxis_props::strategy::{config, parameters, vector};
use sixaxis_props::tolerance;
use sixaxis_props::truth;

mod blocks;

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
        within("covariance", apart(ours.covariance.as_slice(), covariance.as_slice()) / care, tolerance::SAME_ROWS);
        within("residual", (ours.residual_rms / residual - 1.0).abs(), tolerance::ROUNDING);
        within("condition", (ours.condition / condition - 1.0).abs(), tolerance::ROUNDING);
        let errors = ours.standard_error();
        let diagonal: Vec<f64> = (0..N).map(|i| covariance[(i, i)].sqrt()).collect();
        within("standard errors", apart(&errors, &diagonal) / care, tolerance::SAME_ROWS);
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
            tolerance::LAST_DIGITS,
        );
    }

    #[test]
    fn inv_order_of_rows_does_not_matter(rows in rows()) {
        let forward = solved(&rows);
        let backward = solved(&rows.iter().rev().copied().collect());
        within(
            "values from reversed rows",
            apart(&forward.values, &backward.values) / forward.condition.powi(2),
            tolerance::SAME_ROWS,
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
        within("values in other units", apart(&back, &usual.values) / care, tolerance::SAME_ROWS);
        let error: [f64; N] = core::array::from_fn(|j| other.standard_error()[j] * units[j] / unit);
        within("standard errors in other units", apart(&error, &usual.standard_error()) / care, tolerance::SAME_ROWS);
        within("condition in other units", (other.condition / usual.condition - 1.0).abs() / care, tolerance::SAME_ROWS);
    }

    #[test]
    fn inv_relabelling_the_unknowns_relabels_the_answer(rows in rows()) {
        const TO: [usize; N] = [2, 0, 3, 1];
        let usual = solved(&rows);
        let other = solved(&rows.iter().map(|(row, b)| (core::array::from_fn(|j| row[TO[j]]), *b)).collect());
        let moved: [f64; N] = core::array::from_fn(|j| usual.values[TO[j]]);
        let care = usual.condition.powi(2);
        within("relabelled values", apart(&other.values, &moved) / care, tolerance::SAME_ROWS);
        let covariance = SMatrix::<f64, N, N>::from_fn(|i, j| usual.covariance[(TO[i], TO[j])]);
        within("relabelled covariance", apart(other.covariance.as_slice(), covariance.as_slice()) / care, tolerance::SAME_ROWS);
    }

    /// Every row twice: the same values from what looks like twice as much data.
    #[test]
    fn inv_duplicated_rows_change_the_covariance_only(rows in rows()) {
        let once = solved(&rows);
        let twice = solved(&rows.iter().chain(&rows).copied().collect());
        let care = once.condition.powi(2);
        within("values of duplicated rows", apart(&twice.values, &once.values) / care, tolerance::SAME_ROWS);
        within("condition of duplicated rows", (twice.condition / once.condition - 1.0).abs() / care, tolerance::SAME_ROWS);
        let n = rows.len() as f64;
        let expected = (n - N as f64) / (2.0 * n - N as f64);
        let ratio: Vec<f64> = once.covariance.iter().map(|c| c * expected).collect();
        within("covariance of duplicated rows", apart(twice.covariance.as_slice(), &ratio) / care, tolerance::SAME_ROWS);
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
        within("values tied after", apart(&a.values, &b.values) / care, tolerance::TIED);
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
/// (13)(14) and (18)(19) against the pseudo-inverse of the matrices written out.
#[test]
fn ref_closed_forms_are_the_pseudo_inverse() {
    let truth = truth::identified_parameters();
    let mut rng = Pcg64::seed_from_u64(seed());
    let (mut scale, mut inertia) = (
        ScaleIdentification::default(),
        InertiaIdentification::new(Geometry::PAPER),
    );
    let (mut a, mut a_right) = (Vec::new(), Vec::new());
    let (mut w, mut w_right) = (Vec::new(), Vec::new());
    for _ in 0..30 {
        let wanted = normal(&mut rng) * 40.0;
        let clean = forces(wanted, DVec3::ZERO);
        let measured: [f64; LIMBS] =
            core::array::from_fn(|i| clean[i] / truth.scale_per_mass_per_kg[i]);
        let read = wanted + normal(&mut rng);
        scale.push(&measured, read).expect("rows are finite");
        for axis in 0..3 {
            a.push(
                (0..LIMBS)
                    .map(|i| measured[i] * DIRECTIONS_SHELL[i][axis])
                    .collect::<Vec<_>>(),
            );
            a_right.push(read[axis]);
        }
        let (rate, slope) = (normal(&mut rng) * 20.0, normal(&mut rng) * 400.0);
        let noise = normal(&mut rng) * 1e-3;
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
