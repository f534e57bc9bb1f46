//! Noise: what it does to the unknowns is what the covariance says, and the verdict says when it drowns them.

use glam::DVec3;
use nalgebra::{DMatrix, DVector, SVector};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use sixaxis_core::geometry::DIRECTIONS_SHELL;
use sixaxis_core::identify::inertia::{InertiaIdentification, euler_torque};
use sixaxis_core::identify::least_squares::Estimate;
use sixaxis_core::identify::scale::ScaleIdentification;
use sixaxis_core::identify::{Reason, Verdict};
use sixaxis_core::{Error, Geometry, LIMBS};
use sixaxis_props::compare::{largest, within};
use sixaxis_props::rigid::forces;
use sixaxis_props::seed::seed;
use sixaxis_props::statistics::{chi_square_departure, normal};
use sixaxis_props::tolerance;
use sixaxis_props::truth;

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
fn stat_errors_scatter_as_the_covariance_predicts() {
    let mut rng = Pcg64::seed_from_u64(seed());
    let truth = truth::identified_parameters();
    let motions: Vec<[DVec3; 3]> = (0..40)
        .map(|_| {
            [
                normal(&mut rng) * 30.0,
                normal(&mut rng) * 20.0,
                normal(&mut rng) * 400.0,
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
            two.push(&measured, *a + normal(&mut rng) * sigma_a)
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
            format!("chi-square of the {what}"),
            chi_square_departure(value, freedom),
            tolerance::CHI_SQUARE,
        );
        // A covariance off by two would be noticed.
        assert!(
            chi_square_departure(2.0 * value, freedom) > 1.0,
            "the gate on the {what} lets twice the covariance pass"
        );
    }
}
#[test]
fn law_verdicts_name_the_unknown_that_noise_drowns() {
    let truth = truth::identified_parameters();
    // Channel 6 has next to no part in the motion: its factor is lost in the noise of the accelerometer.
    let mut factors = truth.scale_per_mass_per_kg;
    factors[5] = 1e-4;
    let mut step = ScaleIdentification::default();
    let mut rng = Pcg64::seed_from_u64(seed());
    for _ in 0..200 {
        let measured: [f64; LIMBS] = core::array::from_fn(|_| StandardNormal.sample(&mut rng));
        let a = (0..LIMBS).fold(normal(&mut rng) * 0.01, |sum, i| {
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
        let (w, dw) = (normal(&mut rng) * 20.0, normal(&mut rng) * 400.0);
        let torque = euler_torque(&truth.inertia_per_mass, w, dw) + normal(&mut rng) * 1e-4;
        step.push(&forces(DVec3::ZERO, torque), w, dw)
            .expect("rows are finite");
    }
    let found = step.solve().expect("random motions excite everything");
    assert!(found.verdict.is_determined());
    // With a torque of pure noise at ten times the size, the worst entry is named by its error over the largest entry.
    for _ in 0..400 {
        let noise = normal(&mut rng) * 3.0;
        let (w, dw) = (normal(&mut rng) * 20.0, normal(&mut rng) * 400.0);
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
