//! Blocks of rows: against rotations row by row, across their edges, and with NaN, infinities and overflow anywhere inside.

use glam::DVec3;
use rand::SeedableRng;
use rand_pcg::Pcg64;
use sixaxis_core::geometry::DIRECTIONS_SHELL;
use sixaxis_core::identify::inertia::{InertiaIdentification, euler_torque, regressor};
use sixaxis_core::identify::least_squares::{Accumulator, Estimate};
use sixaxis_core::identify::scale::ScaleIdentification;
use sixaxis_core::paper::wrench::LimbWrench;
use sixaxis_core::{Error, Geometry};
use sixaxis_props::compare::within;
use sixaxis_props::rigid::forces;
use sixaxis_props::seed::seed;
use sixaxis_props::statistics::normal;
use sixaxis_props::tolerance;
use sixaxis_props::truth;

use super::apart;

/// The plainest orthogonal solver there is: row by row, Givens rotations into a triangle. Values and residual squares.
fn givens<const M: usize>(rows: &[([f64; M], f64)]) -> ([f64; M], f64) {
    let (mut r, mut q, mut squares) = ([[0.0; M]; M], [0.0; M], 0.0);
    for (row, right) in rows {
        let (mut row, mut right) = (*row, *right);
        for j in 0..M {
            if row[j] == 0.0 {
                continue;
            }
            let norm = f64::hypot(r[j][j], row[j]);
            let (c, s) = (r[j][j] / norm, row[j] / norm);
            for (upper, entry) in r[j].iter_mut().zip(&mut row).skip(j) {
                (*upper, *entry) = (c * *upper + s * *entry, c * *entry - s * *upper);
            }
            (q[j], right) = (c * q[j] + s * right, c * right - s * q[j]);
        }
        squares += right * right;
    }
    let mut x = [0.0; M];
    for j in (0..M).rev() {
        let known: f64 = (j + 1..M).map(|k| r[j][k] * x[k]).sum();
        x[j] = (q[j] - known) / r[j][j];
    }
    (x, squares)
}

fn accumulated<const M: usize>(rows: &[([f64; M], f64)]) -> Accumulator<M> {
    let mut accumulator = Accumulator::default();
    for (row, right) in rows {
        accumulator.push(*row, *right);
    }
    accumulator
}

/// Rows of nine random coefficients with a right side that they explain but for a tenth.
fn many_rows(count: usize) -> Vec<([f64; 9], f64)> {
    let mut rng = Pcg64::seed_from_u64(seed());
    let rows = (0..count).map(|_| {
        let [a, b, c] = core::array::from_fn(|_| normal(&mut rng).to_array());
        let row: [f64; 9] = core::array::from_fn(|i| [a, b, c][i / 3][i % 3]);
        let noise = 0.1 * normal(&mut rng).x;
        (
            row,
            (0..9).map(|i| row[i] / (1.0 + i as f64)).sum::<f64>() + noise,
        )
    });
    rows.collect()
}

/// Rows in the accumulator's block: tests go to both sides of it.
const BLOCK: usize = 128;
/// Numbers of rows about the edges of blocks, of groups of eight, and of the least that can be solved.
const COUNTS: [usize; 13] = [
    10,
    11,
    16,
    17,
    BLOCK - 1,
    BLOCK,
    BLOCK + 1,
    BLOCK + 8,
    2 * BLOCK - 1,
    2 * BLOCK,
    2 * BLOCK + 1,
    1000,
    5000,
];

/// Blocks against rotations row by row, wherever the rows end, whatever the sizes of the columns.
#[test]
fn ref_blocks_equal_rotations() {
    for count in COUNTS {
        for size in [1.0, 1e-3, 1e6, 1e-60, 1e40] {
            let mut rows = many_rows(count);
            for (row, _) in &mut rows {
                row[3] *= size;
                row[7] /= size;
            }
            let found = accumulated(&rows)
                .solve("rows")
                .expect("random rows have full rank");
            let (mut values, squares) = givens(&rows);
            let mut ours = found.values;
            for x in [&mut ours, &mut values] {
                x[3] *= size;
                x[7] /= size;
            }
            within(
                "blocks and rotations",
                apart(&ours, &values) / found.condition,
                tolerance::ROUNDING,
            );
            let rms = (squares / (count - 9) as f64).sqrt();
            within(
                "their residuals",
                (found.residual_rms / rms - 1.0).abs(),
                tolerance::ROUNDING,
            );
        }
    }
}

/// However a stream is cut, cloned and asked in between, its bits are the same.
#[test]
fn inv_splitting_the_stream_changes_no_bit() {
    let rows = many_rows(1000);
    let whole = accumulated(&rows);
    for cut in COUNTS.into_iter().filter(|cut| *cut <= rows.len()) {
        let mut pieces = accumulated(&rows[..cut]);
        let asked = pieces.clone();
        assert!(
            asked.solve("so far").is_ok() && asked.combined(|row| [row[0], row[8]]).rows() == cut
        );
        assert!(asked == pieces, "asking changed the answer");
        assert!(cut == rows.len() || pieces != whole);
        for (row, right) in &rows[cut..] {
            pieces.push(*row, *right);
        }
        assert!(pieces == whole, "cut at {cut}");
        assert_eq!(pieces.solve("pieces"), whole.solve("whole"));
        // Equality sees a row that still waits in its block.
        pieces.push([0.0; 9], 1.0);
        assert!(pieces != whole);
    }
}

/// Histories that differ in one part of what is kept of them: column, explained right side, residual, number, row that waits.
#[test]
fn law_other_histories_are_not_equal() {
    let unit = |j: usize, size: f64| core::array::from_fn(|k| if j == k { size } else { 0.0 });
    let history = |size: f64, explained: f64, left: f64, blocks: usize, waiting: &[f64]| {
        let mut rows = vec![([0.0; 9], 0.0); blocks * BLOCK];
        for (j, row) in rows.iter_mut().enumerate().take(9) {
            *row = (unit(j, size), explained);
        }
        rows[9].1 = left;
        rows.extend(waiting.iter().map(|right| ([0.0; 9], *right)));
        accumulated(&rows)
    };
    let histories = || {
        [
            history(1.0, 0.0, 0.0, 1, &[]),
            history(2.0, 0.0, 0.0, 1, &[]),
            history(1.0, 1.0, 0.0, 1, &[]),
            history(1.0, 0.0, 1.0, 1, &[]),
            history(1.0, 0.0, 0.0, 2, &[]),
            history(1.0, 0.0, 0.0, 1, &[1.0]),
            history(1.0, 0.0, 0.0, 1, &[2.0]),
            history(2.0, 0.0, 0.0, 1, &[1.0]),
        ]
    };
    for (i, a) in histories().iter().enumerate() {
        for (j, b) in histories().iter().enumerate() {
            assert_eq!(a == b, i == j, "{i} and {j}");
        }
    }
}

#[test]
fn law_appending_equals_pushing() {
    let rows = many_rows(1000);
    let whole = accumulated(&rows).solve("whole").expect("full rank");
    for cut in COUNTS
        .into_iter()
        .chain([1, 5])
        .filter(|cut| *cut <= rows.len())
    {
        let mut parts = accumulated(&rows[cut..]);
        parts.append(&accumulated(&rows[..cut]));
        let parts = parts.solve("parts").expect("full rank");
        assert_eq!(parts.rows, whole.rows);
        within(
            "appended values",
            apart(&parts.values, &whole.values),
            tolerance::ROUNDING,
        );
        within(
            "appended covariance",
            apart(parts.covariance.as_slice(), whole.covariance.as_slice()),
            tolerance::ROUNDING,
        );
    }
}

/// Squares of such rows vanish or overflow on the way, the rows themselves do not.
#[test]
fn law_rows_of_any_solvable_size_have_the_same_solution() {
    let rows = many_rows(300);
    let usual = accumulated(&rows).solve("rows").expect("full rank");
    for exponent in [-490, -400, -240, -230, 230, 240, 400, 490] {
        let size = 2.0_f64.powi(exponent);
        let sized: Vec<_> = rows
            .iter()
            .map(|(row, b)| (row.map(|x| x * size), b * size))
            .collect();
        let found = accumulated(&sized).solve("rows").expect("squares that fit");
        within(
            "values",
            apart(&found.values, &usual.values),
            tolerance::ROUNDING,
        );
        within(
            "residual",
            (found.residual_rms / size / usual.residual_rms - 1.0).abs(),
            tolerance::ROUNDING,
        );
    }
}

/// One number among thousands, wherever in a block and in whichever column.
#[test]
fn law_no_block_hides_a_nan() {
    for count in [BLOCK, 300] {
        for at in [0, 7, 8, BLOCK - 1, count - 1] {
            for column in 0..10 {
                for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e200, f64::MAX] {
                    let mut rows = many_rows(count);
                    let (row, right) = &mut rows[at];
                    *row.get_mut(column).unwrap_or(right) = bad;
                    let answer = accumulated(&rows).solve("rows");
                    assert!(
                        matches!(answer, Err(Error::OutOfRange { .. })),
                        "{bad} in column {column}, row {at}: {answer:?}"
                    );
                }
            }
        }
    }
}

/// Steps 2 and 3 keep smaller systems than (13) and (18), with the same answers.
#[test]
fn law_structure_changes_nothing_but_the_cost() {
    let truth = truth::identified_parameters();
    let mut rng = Pcg64::seed_from_u64(seed());
    let mut scale = ScaleIdentification::default();
    let mut inertia = InertiaIdentification::new(Geometry::PAPER);
    let (mut nine, mut six) = (Accumulator::<9>::default(), Accumulator::<6>::default());
    for (force, _) in many_rows(500) {
        let read = normal(&mut rng);
        scale.push(&force, read).expect("rows are finite");
        let (w, dw) = (normal(&mut rng) * 20.0, normal(&mut rng) * 400.0);
        let torque = euler_torque(&truth.inertia_per_mass, w, dw) + normal(&mut rng) * 1e-3;
        let limbs = forces(DVec3::ZERO, torque);
        inertia.push(&limbs, w, dw).expect("rows are finite");
        let torque = LimbWrench::at_rest(&Geometry::PAPER, &limbs).torque_shell_m2_s2;
        for (axis, row) in regressor(w, dw).iter().enumerate() {
            nine.push(
                core::array::from_fn(|i| force[i] * DIRECTIONS_SHELL[i][axis]),
                read[axis],
            );
            six.push(*row, torque[axis]);
        }
    }
    fn same<const M: usize>(a: &Estimate<M>, b: &Estimate<M>) {
        assert_eq!(a.rows, b.rows);
        within("values", apart(&a.values, &b.values), tolerance::ROUNDING);
        within(
            "covariance",
            apart(a.covariance.as_slice(), b.covariance.as_slice()),
            tolerance::ROUNDING,
        );
        within(
            "condition",
            (a.condition / b.condition - 1.0).abs(),
            tolerance::ROUNDING,
        );
    }
    same(
        &scale.solve().expect("full rank").estimate,
        &nine.solve("nine").expect("full rank"),
    );
    same(
        &inertia.solve().expect("full rank").estimate,
        &six.solve("six").expect("full rank"),
    );
}
