//! The equations against differences of what they are equations of.

use alloc::vec;

use glam::DVec3;

use super::super::Known;
use super::super::ends::Elsewhere;
use super::super::harmonics::{Grid, project};
use super::super::own::{self, Kind};
use super::super::room::Room;
use super::super::unknowns::{
    ACCELEROMETER_GAIN, AMPLIFIER_CORNER, ANGLES, COMPLIANCE, DRIFT, GYROSCOPE_GAIN, INERTIA,
    MASS_CENTRE, MASS_PER_SCALE, ROD_MASS, STIFFNESS, WEDGES, Wedge,
};
use super::*;
use crate::float::{sin_cos, sqrt};
use crate::geometry::Geometry;
use crate::model::Gains;

/// Central differences over 1e-4 of an unknown's size leave this of the squares over that size.
const FINITE_DIFFERENCES: f64 = 1e-5;
/// Rounds of the trial's own Gauss-Newton; the motion alone settles in three.
const ROUNDS: usize = 60;

const GRAVITY_M_S2: DVec3 = DVec3::new(0.0, 3.0, -9.0);
/// Drive, whether gravity turns, whether the amplifiers are high-passes, whether the channels are late, whether it ends elsewhere.
type Case = (Drive, bool, bool, bool, bool);
const CASES: [Case; 10] = [
    (Drive::Linear, false, false, false, false),
    (Drive::Linear, false, true, false, false),
    (Drive::Linear, false, true, true, false),
    (Drive::Angular, false, false, false, false),
    (Drive::Angular, true, false, false, false),
    (Drive::Angular, true, true, false, false),
    (Drive::Angular, true, false, true, false),
    (Drive::Angular, false, false, false, true),
    (Drive::Angular, true, false, false, true),
    (Drive::Angular, true, true, true, true),
];

fn size_of_unknown(u: usize) -> f64 {
    match u {
        u if u < MASS_PER_SCALE => 1.0,
        u if u < INERTIA => 0.2,
        u if u < COMPLIANCE => 2e-4,
        COMPLIANCE => 1e-5,
        u if (MASS_CENTRE..ROD_MASS).contains(&u) || u >= WEDGES + ANGLES => 1e-2,
        _ => 0.1,
    }
}

fn size_of_own(kind: Kind) -> f64 {
    match kind {
        Kind::Zero(_) | Kind::Transient(_) => 1.0,
        Kind::Sensitivity(_) | Kind::Plumb(_) => 0.1,
        Kind::Centre(_) => 1e-2,
    }
}

fn trial((drive, gravity_turns, amplifier, late, elsewhere): Case) -> (Trial, Unknowns) {
    let grid = Grid {
        samples: 400,
        step_s: 2e-3,
        harmonics: 12,
    };
    let wave = |n: usize, c: usize| {
        let t = n as f64 * grid.step_s;
        let phase = c as f64;
        sin_cos(20.0 * t + phase).0 + 0.3 * sin_cos(47.0 * t - phase).1
    };
    let data = project(&grid, |n| core::array::from_fn(|c| wave(n, c)));
    let wedge = Wedge::new(DVec3::new(1.0, 2.0, 1.0).normalize());
    let delays = if late { LIMBS } else { 0 };
    let mut values = DVector::zeros(WEDGES + ANGLES + delays);
    for limb in 0..delays {
        values[WEDGES + ANGLES + limb] = 1e-3 * (limb as f64 - 3.0);
    }
    for limb in 0..LIMBS {
        values[DRIFT + limb] = 0.01 * limb as f64;
        values[MASS_PER_SCALE + limb] = 0.2 + 0.01 * limb as f64;
    }
    for (j, i) in [2.4e-4, 2.5e-4, 2.9e-4, 1e-6, -2e-6, 3e-6]
        .into_iter()
        .enumerate()
    {
        values[INERTIA + j] = i;
    }
    values[COMPLIANCE] = 1e-5;
    values[ACCELEROMETER_GAIN] = 0.01;
    values[GYROSCOPE_GAIN] = -0.02;
    values[GYROSCOPE_LAG] = 0.016;
    values[AMPLIFIER_CORNER] = 0.7;
    for (place, unknown) in (MASS_CENTRE..ROD_MASS).enumerate() {
        values[unknown] = 1e-3 * (1.0 + place as f64);
    }
    values[ROD_MASS] = 0.02;
    for (place, unknown) in (STIFFNESS..WEDGES).enumerate() {
        values[unknown] = 0.01 * sin_cos(place as f64).0;
    }
    values[WEDGES] = 1e-4;
    values[WEDGES + 1] = -2e-4;
    let mut trial = Trial {
        drive,
        elsewhere: elsewhere.then_some(Elsewhere {
            mean_rate_rad_s: Known {
                value: 0.3,
                deviation: 0.01,
            },
            step: [0.0; LIMBS + 1],
        }),
        latent: DVector::zeros(2 * grid.harmonics + usize::from(elsewhere)),
        data,
        near: None,
        louder: [1.0; LIMBS + 1],
        gains: Gains::uniform(0.5),
        wedge: 0,
        gravity_m_s2: GRAVITY_M_S2,
        gravity_turns,
        amplifier,
        accelerometer_lag_s: 1e-3,
        standard_delay_s: [2e-3, 3e-3],
        own: own::of(
            drive,
            amplifier,
            &Room::ORDINARY,
            wedge.nominal,
            GRAVITY_M_S2,
        ),
        grid,
    };
    for (place, own) in trial.own.iter_mut().enumerate() {
        own.value = 0.1 * size_of_own(own.kind) * sin_cos(place as f64).1;
        // What is far from what was expected is not what is tried here.
        own.deviation = 10.0 * size_of_own(own.kind);
    }
    trial.data.variance = core::array::from_fn(|c| 1e-2 * (1.0 + c as f64));
    let unknowns = Unknowns {
        values,
        wedges: vec![wedge],
    };
    trial.start(&unknowns);
    (trial, unknowns)
}

#[test]
fn inv_descent_is_the_gradient() {
    let shares = StaticLoadSharing::new(&Geometry::PAPER).expect("the paper's drawing");
    for case in CASES {
        let (mut trial, unknowns) = trial(case);
        // Waves that are no motion's would lead what is loosely known far away.
        for own in &mut trial.own {
            own.deviation = 1e-2 * size_of_own(own.kind);
        }
        let still = DVector::zeros(unknowns.len());
        for _ in 0..ROUNDS {
            let part = trial.contribution(&unknowns, &shares).expect("determined");
            trial.follow(&part, &still, 1.0);
        }
        // With the motion at its best, the gradient with the motion held is the whole gradient.
        let analytic = trial
            .contribution(&unknowns, &shares)
            .expect("determined")
            .descent;
        let squares = |u: usize, change: f64| {
            let mut moved = unknowns.clone();
            moved.values[u] += change;
            trial
                .contribution(&moved, &shares)
                .expect("determined")
                .squares
        };
        for u in 0..unknowns.len() {
            let size = size_of_unknown(u);
            let h = 1e-4 * size;
            let numeric = -0.5 * (squares(u, h) - squares(u, -h)) / (2.0 * h);
            let scale = trial
                .contribution(&unknowns, &shares)
                .expect("determined")
                .squares
                / size;
            assert!(
                (numeric - analytic[u]).abs() < FINITE_DIFFERENCES * scale,
                "{case:?}: unknown {u}: {numeric:e} by differences, {:e}",
                analytic[u]
            );
        }
    }
}

/// Central differences of a linear function and rounding leave this of a block's largest entry; what is quadratic in the
/// residual is not there.
const BLOCKS: f64 = 1e-6;

/// Where the data are what the model predicts, the descents' derivatives are the normal matrix and nothing else.
#[test]
fn inv_blocks_are_the_descents_derivatives() {
    let shares = StaticLoadSharing::new(&Geometry::PAPER).expect("the paper's drawing");
    for case in CASES {
        let (mut trial, unknowns) = trial(case);
        let parts = trial.parts(&unknowns, &shares).expect("held");
        for limb in 0..LIMBS {
            let sooner = trial.prediction(&unknowns, &parts, limb);
            let delay = unknowns.delay(limb).map_or(0.0, |at| unknowns.values[at]);
            trial.data.coordinates[limb] = trial.sooner(&sooner, -delay);
        }
        trial.data.coordinates[LIMBS] = trial.standard_prediction(&unknowns);
        let reading = 1.0 + unknowns.values[GYROSCOPE_GAIN];
        if let Some(ends) = &mut trial.elsewhere {
            let mean = trial.latent[2 * trial.grid.harmonics];
            ends.mean_rate_rad_s.value = reading * mean / sqrt(trial.grid.samples as f64);
        }
        let arrow = trial.arrow(&unknowns, &shares).expect("held");
        // Entries in the unknowns' own sizes, against the largest of their block: what is next to nothing drowns in rounding.
        let of_own = trial.own.iter().map(|own| size_of_own(own.kind));
        let of_unknown: Vec<f64> = (0..unknowns.len())
            .map(size_of_unknown)
            .chain(of_own)
            .collect();
        let largest = |block: &DMatrix<f64>, sizes: &[f64]| {
            block
                .column_iter()
                .zip(sizes)
                .map(|(column, size)| column.amax() * size)
                .fold(0.0, f64::max)
        };
        let of_motion = alloc::vec![trial.latent.amax(); trial.latent.len()];
        let blocks = [
            largest(&arrow.coupling, &of_unknown),
            largest(&arrow.information, &of_unknown),
            largest(&arrow.own, &of_motion),
        ];
        let compare =
            |block: usize, size: f64, differences: &DVector<f64>, column: DVector<f64>| {
                let off = (differences + column).amax() * size;
                assert!(
                    off <= BLOCKS * blocks[block],
                    "{case:?}: block {block}: {off:e} of {:e}",
                    blocks[block]
                );
            };
        let size = unknowns.len();
        for u in 0..size {
            let h = 1e-5 * size_of_unknown(u);
            let moved = |by: f64| {
                let mut moved = unknowns.clone();
                moved.values[u] += by;
                trial.arrow(&moved, &shares).expect("held")
            };
            let (up, down) = (moved(h), moved(-h));
            let by = |a: &DVector<f64>, b: &DVector<f64>| (a - b) / (2.0 * h);
            let size = size_of_unknown(u);
            let own = by(&up.own_descent, &down.own_descent);
            compare(0, size, &own, arrow.coupling.column(u).clone_owned());
            let common = by(&up.descent, &down.descent);
            compare(1, size, &common, arrow.information.column(u).clone_owned());
        }
        for place in 0..trial.own.len() {
            let size = size_of_own(trial.own[place].kind);
            let h = 1e-5 * size;
            let moved = |by: f64| {
                let mut moved = trial.clone();
                moved.own[place].value += by;
                moved.arrow(&unknowns, &shares).expect("held")
            };
            let (up, down) = (moved(h), moved(-h));
            let by = |a: &DVector<f64>, b: &DVector<f64>| (a - b) / (2.0 * h);
            let column = unknowns.len() + place;
            let own = by(&up.own_descent, &down.own_descent);
            compare(0, size, &own, arrow.coupling.column(column).clone_owned());
            let common = by(&up.descent, &down.descent);
            compare(
                1,
                size,
                &common,
                arrow.information.column(column).clone_owned(),
            );
        }
        for (j, size) in of_motion.iter().enumerate() {
            let h = 1e-5 * trial.latent.amax();
            let moved = |by: f64| {
                let mut moved = trial.clone();
                moved.latent[j] += by;
                moved.arrow(&unknowns, &shares).expect("held")
            };
            let (up, down) = (moved(h), moved(-h));
            let by = (&up.own_descent - &down.own_descent) / (2.0 * h);
            compare(2, *size, &by, arrow.own.column(j).clone_owned());
        }
    }
}

/// A step that solves the whole arrow is what elimination and going back come to.
#[test]
fn inv_elimination_solves_the_arrow() {
    let shares = StaticLoadSharing::new(&Geometry::PAPER).expect("the paper's drawing");
    for case in CASES {
        let (trial, unknowns) = trial(case);
        let arrow = trial.arrow(&unknowns, &shares).expect("held");
        let common = unknowns.len();
        let (outer, inner) = (arrow.descent.len(), arrow.own_descent.len());
        let mut arrow = arrow;
        for (place, own) in trial.own.iter().enumerate() {
            let weight = 1.0 / (own.deviation * own.deviation);
            arrow.information[(common + place, common + place)] += weight;
            arrow.descent[common + place] -= weight * own.value;
        }
        // A little of everything beforehand, as certificates give it, makes the whole regular.
        let beforehand = arrow.information.diagonal().rows(0, common).amax();
        let mut whole = DMatrix::zeros(outer + inner, outer + inner);
        whole
            .view_mut((0, 0), (outer, outer))
            .copy_from(&arrow.information);
        for u in 0..common {
            whole[(u, u)] += beforehand;
        }
        whole
            .view_mut((outer, outer), (inner, inner))
            .copy_from(&arrow.own);
        whole
            .view_mut((outer, 0), (inner, outer))
            .copy_from(&arrow.coupling);
        whole
            .view_mut((0, outer), (outer, inner))
            .copy_from(&arrow.coupling.transpose());
        let mut descent = DVector::zeros(outer + inner);
        descent.rows_mut(0, outer).copy_from(&arrow.descent);
        descent.rows_mut(outer, inner).copy_from(&arrow.own_descent);
        let step = Cholesky::new(whole).expect("regular").solve(&descent);
        let part = trial.contribution(&unknowns, &shares).expect("determined");
        let mut information = part.information.clone();
        for u in 0..common {
            information[(u, u)] += beforehand;
        }
        let head = Cholesky::new(information)
            .expect("regular")
            .solve(&part.descent);
        let mut moved = trial.clone();
        moved.follow(&part, &head, 1.0);
        let close = |a: &DVector<f64>, b: &DVector<f64>| (a - b).amax() <= BLOCKS * b.amax();
        assert!(close(&head, &step.rows(0, common).clone_owned()));
        let motion = &moved.latent - &trial.latent;
        assert!(close(&motion, &step.rows(outer, inner).clone_owned()));
        let own = DVector::from_iterator(
            trial.own.len(),
            moved
                .own
                .iter()
                .zip(&trial.own)
                .map(|(after, before)| after.value - before.value),
        );
        assert!(close(&own, &step.rows(common, own.len()).clone_owned()));
    }
}
