//! Random motions of random sensors in MuJoCo, decoupled: the distribution of the error against its gate.
//!
//! `SIXAXIS_MOTIONS=1000` is the nightly setting; `SIXAXIS_SEED` draws others.

use core::f64::consts::TAU;
use std::sync::atomic::{AtomicU64, Ordering};

use rand::RngExt;
use rand_pcg::Pcg64;
use rayon::prelude::*;
use sixaxis_core::Scheme;
use sixaxis_props::compare::{fails_clearly, largest};
use sixaxis_props::evidence::{self, Quantiles, Row};
use sixaxis_props::motions::{self, Case};
use sixaxis_props::seed::seed;
use sixaxis_props::tolerance;

/// Motions of an ordinary run.
const MOTIONS: u64 = 50;
/// A line of progress after so many.
const REPORTED: u64 = 25;

fn motions() -> u64 {
    match std::env::var("SIXAXIS_MOTIONS") {
        Ok(text) => text
            .parse()
            .expect("SIXAXIS_MOTIONS is a number of motions"),
        Err(_) => MOTIONS,
    }
}

/// Motions of sensors whose limbs have mass, and random stream of how much.
const HEAVY: u64 = 12;
const ROD_MASSES: u128 = 93;

/// Limbs with mass, half of one up to 3 % of the seismic mass, are decoupled as those without. What they show of the square of the rate is more than
/// is allowed.
#[test]
fn ref_limbs_with_mass_are_decoupled() {
    let (seed, scheme) = (seed(), Scheme::AdamsMoulton4);
    let played: Vec<(Case, [f64; 3])> = (0..HEAVY)
        .into_par_iter()
        .map(|index| {
            let mut rng = Pcg64::new((u128::from(seed) << 64) | u128::from(index), ROD_MASSES);
            let case = Case {
                rod_mass: 10.0_f64.powf(rng.random_range(-3.0..-1.5)),
                ..Case::numbered(seed, index)
            };
            let over_rod_mass = |refinement, taken| {
                let decoupled = case.decoupled(case.recorded(refinement), scheme, taken);
                largest(decoupled.largest_errors()) / case.rod_mass
            };
            let [usual, refined] = [1, 2].map(|steps| over_rod_mass(steps, case.rod_mass));
            (
                case,
                [refined, (usual - refined).abs(), over_rod_mass(2, 0.0)],
            )
        })
        .collect();
    let limit = tolerance::LIMBS_WITH_MASS;
    for (index, (case, [error, by_step, _])) in played.iter().enumerate() {
        let frequency_hz = case.motion.highest_frequency_hz();
        // Limbs move with the shell in the simulation, and with the mass by what is taken off.
        let in_the_shell = (TAU * frequency_hz).powi(2) / case.parameters.stiffness_per_mass_per_s2;
        let rod_mass = 100.0 * case.rod_mass;
        Row::new("limbs with mass, over that mass", *error, limit)
            .case(format!(
                "motion {index} of seed {seed}: {frequency_hz:.1} Hz, {rod_mass:.2} %"
            ))
            .beyond(by_step + in_the_shell)
            .judge();
    }
    let alarmed = |taken: fn(&Case) -> f64| {
        let cases = played.par_iter();
        let alarmed = cases.filter(|(case, _)| case.alarms(&case.recorded(1), taken(case)));
        alarmed.count()
    };
    assert_eq!(alarmed(|case| case.rod_mass), 0);
    assert!(alarmed(|_| 0.0) > played.len() / 2);
    let left_on = largest(played.iter().map(|(_, [_, _, left_on])| *left_on));
    fails_clearly("limbs with mass, the rate's square left on", left_on, limit);
}

#[test]
fn ref_random_motions_are_decoupled() {
    let (count, done) = (motions(), AtomicU64::new(0));
    let rows = motions::compare_all(
        seed(),
        count,
        Scheme::AdamsMoulton4,
        tolerance::DECOUPLED,
        || {
            let done = 1 + done.fetch_add(1, Ordering::Relaxed);
            if done.is_multiple_of(REPORTED) {
                eprintln!("{done} of {count} motions");
            }
        },
    );
    for row in rows {
        row.recorded();
    }
    let written = evidence::written().expect("this test has just written its rows");
    for quantity in ["linear acceleration", "angular acceleration", "rate"] {
        let name = format!("{quantity}, random motion");
        let rows: Vec<_> = written.iter().filter(|row| row.quantity == name).collect();
        let errors = Quantiles::of(rows.iter().map(|row| row.error)).expect("there are rows");
        let shares = Quantiles::of(rows.iter().map(|row| row.share())).expect("there are rows");
        println!("{name}: {errors}\n  over what is allowed: {shares}");
        errors.judge(&name, tolerance::RANDOM_MOTION);
        shares.judge(&name, tolerance::RANDOM_MOTION_SHARE);
    }
}
