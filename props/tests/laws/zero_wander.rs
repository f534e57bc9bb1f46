//! Amplifiers whose high-pass is undone: what that makes of noise is in the deviations of attitude and rate, and no limb's failure.

use rand_pcg::Pcg64;
use rayon::prelude::*;
use sixaxis_core::redundancy::fault::{Event, Kind};
use sixaxis_core::{LIMBS, LimbSet};
use sixaxis_props::aided::{Aids, Checked, KNOWN_RAD, Outcome, Played, Quality, Ride, run};
use sixaxis_props::compare::within;
use sixaxis_props::faults::{SAMPLE_RATE_HZ, Scene};
use sixaxis_props::statistics::chi_square_departure;
use sixaxis_props::tolerance;
use sixaxis_props::undone::{Amplifier, UndoneNoise};
use sixaxis_reference::rig::journey::Kind as Motion;

const SEED: u64 = 3000;
const RUNS: u64 = 24;
const STREAM: u128 = 91;
/// Corners, Hz, samples of the level, of the shortest rest that is taken and of one and two seconds, and length of the run, s. What is known after 5 s of the last one is
/// the walk, mostly.
const AMPLIFIERS: [(f64, usize, f64); 3] = [(0.1, 16, 15.0), (0.5, 1000, 15.0), (0.1, 2000, 5.0)];
/// The same of recordings in which a limb fails.
const BESIDE: (f64, usize, f64) = (0.1, 1000, WATCHED_S);
/// Length of a recording that is watched, s, and when a limb fails in it.
const WATCHED_S: f64 = 30.0;
const FAILS_S: f64 = 20.0;
/// Offset of a limb that fails, in deviations of its noise.
const FAILURE: f64 = 30.0;
/// Squared errors over variances, at least, without and with aids. A ramp that an aid has told is not believed to go on: deviations are up to
/// twice too large.
const LEAST: [f64; 2] = [0.55, 0.2];

fn amplifier((corner_hz, samples_of_level, _): (f64, usize, f64), told: bool) -> Amplifier {
    Amplifier {
        corner_hz,
        samples_of_level,
        told,
    }
}

/// One look a run, while the attitude is known: of the filter the last one, of the smoother another one in each run.
fn looks(aids: Aids, amplifier: Amplifier, duration_s: f64) -> [Vec<Checked>; 2] {
    let ride = Ride {
        played: Played::InEquilibrium,
        kind: Motion::PickAndPlace,
        duration_s,
        rate_hz: 1000.0,
        quality: Quality::DAY,
        amplifier: Some(amplifier),
        smooth: true,
        without: LimbSet::EMPTY,
    };
    let times_s = [0.07, 0.14, 0.2, 0.33, 0.53, 0.75, 0.98].map(|share| share * duration_s);
    let runs: Vec<_> = (SEED..SEED + RUNS)
        .into_par_iter()
        .flat_map_iter(|seed| run(&ride, &[aids], &times_s, seed))
        .collect();
    let known = |look: &&Checked| look.attitude_deviation_rad < KNOWN_RAD;
    let filtered = |run: &Outcome| run.filtered.looks.iter().rfind(known).copied();
    let smoothed = |(number, run): (usize, &Outcome)| {
        let looks = run.smoothed.iter().flat_map(|run| &run.looks);
        let known: Vec<_> = looks.filter(known).collect();
        known.get(number % known.len().max(1)).copied().copied()
    };
    [
        runs.iter().filter_map(filtered).collect(),
        runs.iter().enumerate().filter_map(smoothed).collect(),
    ]
}

fn all_aids() -> [(&'static str, Aids); 3] {
    let open = Aids::default();
    let rests = Aids {
        rests: true,
        ..open
    };
    let attitude = Aids {
        attitude: Some((1.0, 0.01)),
        ..open
    };
    [
        ("open loop", open),
        ("rests", rests),
        ("attitudes", attitude),
    ]
}

#[test]
fn stat_errors_are_as_large_as_their_deviations_where_zeros_wander() {
    println!("seeds {SEED} to {}", SEED + RUNS - 1);
    for of in AMPLIFIERS {
        for (what, aids) in all_aids() {
            let all = looks(aids, amplifier(of, true), of.2);
            for (who, looks) in ["filter", "smoother"].into_iter().zip(all) {
                let what = format!("{what}, {} Hz, level of {}, {who}", of.0, of.1);
                let of = |of: fn(&Checked) -> f64| looks.iter().map(of).sum::<f64>();
                let n = 3 * looks.len();
                let squares = [of(|c| c.attitude), of(|c| c.rate)];
                println!(
                    "{what}: {} runs, squared errors over variances: attitude {:.2}, rate {:.2}",
                    looks.len(),
                    squares[0] / n as f64,
                    squares[1] / n as f64
                );
                for (quantity, squares) in ["attitude", "rate"].into_iter().zip(squares) {
                    let what = format!("chi-square of the {quantity}, {what}");
                    let mean = squares / n as f64;
                    assert!(
                        mean > LEAST[usize::from(aids != Aids::default())],
                        "{what}: {mean}"
                    );
                    if mean > 1.0 {
                        let departure = chi_square_departure(squares, n);
                        within(what, departure, tolerance::CHI_SQUARE);
                    }
                }
            }
        }
    }
}

#[test]
fn neg_a_filter_that_is_not_told_that_zeros_wander_states_too_small_deviations() {
    for (what, aids) in all_aids() {
        let of = AMPLIFIERS[1];
        let all = looks(aids, amplifier(of, false), of.2);
        for looks in all {
            let (squares, n) = (looks.iter().map(|c| c.attitude).sum(), 3 * looks.len());
            let departure = chi_square_departure(squares, n);
            println!(
                "{what}: squared errors over variances {:.0}",
                squares / n as f64
            );
            assert!(departure > tolerance::CHI_SQUARE.limit, "{what}");
        }
    }
}

/// The first limbs that the monitor names in a recording of a second's rest or less and 30 s of motion.
fn named(seed: u64, amplifier: Amplifier, fails: Option<usize>) -> Option<(f64, LimbSet, Kind)> {
    let scene = Scene::random(seed, 1.0);
    let mut stream = scene.stream(1.0);
    let rng = &mut Pcg64::new(u128::from(seed), STREAM);
    let mut noise = UndoneNoise::new(&amplifier, &scene.noise_v, SAMPLE_RATE_HZ, rng);
    let wander = amplifier.wander(SAMPLE_RATE_HZ);
    for sample in 0..(WATCHED_S * SAMPLE_RATE_HZ) as u64 {
        let time_s = sample as f64 / SAMPLE_RATE_HZ;
        if let Some(wander) = &wander
            && sample % 64 == 0
        {
            stream.allow_for(wander, sample);
        }
        let mut volts = scene.voltage_v(sample);
        for (limb, v) in volts.iter_mut().enumerate() {
            *v += noise.next(limb, rng);
        }
        if let Some(limb) = fails
            && time_s >= FAILS_S
        {
            volts[limb] += FAILURE * scene.noise_v[limb];
        }
        let watched = stream.push(&volts).expect("a rate that holds");
        if let Some(Event::Identified(verdict)) = watched.event {
            return Some((time_s, verdict.limbs, verdict.kind));
        }
    }
    None
}

#[test]
fn stat_a_zero_that_wanders_is_no_failure() {
    println!("seeds {SEED} to {}", SEED + RUNS - 1);
    let count = |of, told| {
        let seeds = (SEED..SEED + RUNS).into_par_iter();
        let found = seeds.filter_map(|seed| named(seed, amplifier(of, told), None));
        found.collect::<Vec<_>>()
    };
    for of in [AMPLIFIERS[0], AMPLIFIERS[1]] {
        let [told, untold] = [true, false].map(|told| count(of, told));
        println!(
            "{} Hz, level of {}: {} of {RUNS} named wrongly, {} where it is not told",
            of.0,
            of.1,
            told.len(),
            untold.len()
        );
        assert!(told.is_empty(), "{told:?}");
        assert!(untold.len() as u64 > RUNS / 2);
    }
}

/// Of limb 5, whose force counts least in the three sums, 20 deviations are an alarm here, and no limb is named.
#[test]
fn stat_a_failure_is_found_beside_zeros_that_wander() {
    let limbs = 0..LIMBS as u64;
    let found: Vec<_> = limbs
        .into_par_iter()
        .map(|limb| {
            let amplifier = amplifier(BESIDE, true);
            named(SEED + limb, amplifier, Some(limb as usize))
        })
        .collect();
    for (limb, found) in found.iter().enumerate() {
        println!("limb {}: {found:?}", limb + 1);
        assert!(found.is_some_and(|(at_s, limbs, _)| at_s >= FAILS_S && limbs.contains(limb)));
    }
}
