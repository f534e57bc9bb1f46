//! What a deviation of attitude and rate is worth over minutes, with and without aids: squared errors over variances, run by run.

use rayon::prelude::*;
use sixaxis_core::LimbSet;
use sixaxis_props::aided::{Aids, Checked, Judged, KNOWN_RAD, Outcome, Played, Quality, Ride, run};
use sixaxis_props::compare::within;
use sixaxis_props::statistics::chi_square_departure;
use sixaxis_props::tolerance;
use sixaxis_reference::rig::journey::Kind;

/// First seed. Those below were looked at while the filter was written.
const SEED: u64 = 1000;
const RUNS: u64 = 24;

fn ride(kind: Kind, duration_s: f64, aids: Aids) -> (Ride, Aids) {
    let ride = Ride {
        played: Played::InEquilibrium,
        kind,
        duration_s,
        rate_hz: 1000.0,
        quality: Quality::DAY,
        amplifier: None,
        smooth: false,
        without: LimbSet::EMPTY,
    };
    (ride, aids)
}

fn play((ride, aids): &(Ride, Aids)) -> Vec<Outcome> {
    let times_s = [1.0, 2.0, 3.0, 4.0].map(|quarter| quarter * (ride.duration_s / 4.0 - 0.05));
    (SEED..SEED + RUNS)
        .into_par_iter()
        .flat_map_iter(|seed| run(ride, &[*aids], &times_s, seed))
        .collect()
}

/// One look a run, the last one at which the attitude is known: looks of one run are not independent.
fn last_known<'a>(runs: impl IntoIterator<Item = &'a Judged>) -> Vec<Checked> {
    let known = |c: &&Checked| c.attitude_deviation_rad < KNOWN_RAD;
    runs.into_iter()
        .filter_map(|run| run.looks.iter().rfind(known).copied())
        .collect()
}

/// One look a run at which the attitude is known, another one in each run: what came later counts, too.
fn any_known<'a>(runs: impl IntoIterator<Item = &'a Judged>) -> Vec<Checked> {
    let known = |c: &&Checked| c.attitude_deviation_rad < KNOWN_RAD;
    runs.into_iter()
        .enumerate()
        .filter_map(|(number, run)| {
            let known: Vec<&Checked> = run.looks.iter().filter(known).collect();
            known.get(number % known.len().max(1)).copied().copied()
        })
        .collect()
}

/// Squared errors of all runs over their variances, in half widths of the interval that chance leaves once in a million.
fn departure(looks: &[Checked], of: impl Fn(&Checked) -> f64) -> f64 {
    chi_square_departure(looks.iter().map(of).sum(), 3 * looks.len())
}

fn rides() -> Vec<(&'static str, (Ride, Aids))> {
    let velocity = |every_s, deviation| Aids {
        velocity: Some((every_s, deviation)),
        ..Aids::default()
    };
    let attitude = Aids {
        attitude: Some((1.0, 0.01)),
        ..Aids::default()
    };
    let rests = Aids {
        rests: true,
        ..Aids::default()
    };
    let open = Aids::default();
    let mut all = vec![
        ("open loop, shaken", ride(Kind::Shaken, 8.0, open)),
        (
            "open loop, a tumble",
            ride(Kind::TumbleWithRests, 4.0, open),
        ),
        (
            "velocity, shaken",
            ride(Kind::Shaken, 16.0, velocity(2.0, 0.1)),
        ),
        (
            "velocity, pick and place",
            ride(Kind::PickAndPlace, 16.0, velocity(2.0, 0.3)),
        ),
        (
            "rests, pick and place",
            ride(Kind::PickAndPlace, 60.0, rests),
        ),
        ("rests, a tumble", ride(Kind::TumbleWithRests, 20.0, rests)),
        // Long enough for what grows from one contradiction to the next.
        (
            "rests and attitudes, a tumble",
            ride(
                Kind::TumbleWithRests,
                240.0,
                Aids {
                    rests: true,
                    ..attitude
                },
            ),
        ),
    ];
    for kind in Kind::ALL {
        all.push(("attitudes", ride(kind, 40.0, attitude)));
    }
    all
}

#[test]
fn stat_errors_are_as_large_as_their_deviations_while_the_attitude_is_known() {
    println!("seeds {SEED} to {}", SEED + RUNS - 1);
    for (what, (ride, aids)) in rides() {
        let ride = Ride {
            smooth: true,
            ..ride
        };
        let runs = play(&(ride, aids));
        let what = format!("{what}, {:?}", ride.kind);
        let filtered = || runs.iter().map(|run| &run.filtered);
        let smoothed = || runs.iter().filter_map(|run| run.smoothed.as_ref());
        as_large_as_stated(
            &format!("{what}, filter"),
            &last_known(filtered()),
            filtered(),
        );
        as_large_as_stated(
            &format!("{what}, smoother"),
            &any_known(smoothed()),
            smoothed(),
        );
    }
}

/// What excluded limbs bear is made of the others' forces, with their noise and errors.
#[test]
fn stat_errors_are_as_large_as_their_deviations_without_some_limbs() {
    println!("seeds {SEED} to {}", SEED + RUNS - 1);
    for limbs in [&[5][..], &[2, 3], &[1, 6, 9]] {
        let without = LimbSet::from_numbers(limbs.iter().copied()).expect("limbs");
        for kind in [Kind::Shaken, Kind::TumbleWithRests] {
            let (ride, aids) = ride(kind, 8.0, Aids::default());
            let runs = play(&(Ride { without, ..ride }, aids));
            let filtered = || runs.iter().map(|run| &run.filtered);
            as_large_as_stated(
                &format!("without {without}, {kind:?}"),
                &last_known(filtered()),
                filtered(),
            );
        }
    }
}

/// After seconds without an aid this run's attitude is off by 2.2 of its deviations, 45 mrad, half of whose square goes with gravity into the
/// velocity that the rest tells: 25 and 42 here where that is taken for first order.
#[test]
fn regress_a_rest_takes_off_what_the_attitude_has_bent() {
    let rests = Aids {
        rests: true,
        ..Aids::default()
    };
    let (ride, aids) = ride(Kind::PickAndPlace, 10.0, rests);
    let outcome = run(&ride, &[aids], &[5.0, 9.0], 1003);
    let looks = &outcome[0].filtered.looks;
    assert_eq!(looks.len(), 2);
    for look in looks {
        // Three degrees of freedom: chance exceeds it once in a thousand looks.
        assert!(look.attitude < 16.27, "{look:?}");
    }
}

/// Rests of a second in ten: the attitude's error reaches tenths of a rad meanwhile, and turns itself on. Where channels have little noise,
/// errors are larger than stated at the first rest, and that is only printed.
#[test]
fn regress_the_first_rests_of_a_tumble_leave_an_error_as_large_as_stated() {
    let rests = Aids {
        rests: true,
        ..Aids::default()
    };
    for (of_the_day, judged) in [(1.0, true), (0.4, true), (0.1, false)] {
        let (ride, _) = ride(Kind::TumbleWithRests, 21.5, rests);
        let ride = Ride {
            quality: Quality {
                noise_of_peak: of_the_day * ride.quality.noise_of_peak,
                ..ride.quality
            },
            ..ride
        };
        let runs: Vec<Outcome> = (7000..7100u64)
            .into_par_iter()
            .flat_map_iter(|seed| run(&ride, &[rests], &[10.9, 20.9], seed))
            .collect();
        let at = |place: usize| -> Vec<Checked> {
            let look = |run: &Outcome| run.filtered.looks.get(place).copied();
            let all = runs.iter().filter_map(look);
            all.filter(|look| look.attitude_deviation_rad < KNOWN_RAD)
                .collect()
        };
        for looks in [at(0), at(1)] {
            let squares: f64 = looks.iter().map(|c| c.attitude).sum();
            println!(
                "{of_the_day} of the noise, {} of 100 runs known: {:.2}",
                looks.len(),
                squares / (3 * looks.len()) as f64
            );
        }
        if judged {
            let looks = last_known(runs.iter().map(|run| &run.filtered));
            assert!(looks.len() > 15, "{}", looks.len());
            within(
                "chi-square of the attitude, first rests of a tumble",
                departure(&looks, |c| c.attitude),
                tolerance::CHI_SQUARE,
            );
        }
    }
}

fn as_large_as_stated<'a>(what: &str, looks: &[Checked], runs: impl Iterator<Item = &'a Judged>) {
    assert!(
        looks.len() as u64 > RUNS / 2,
        "{what}: {} runs are known at all",
        looks.len()
    );
    let mean =
        |of: fn(&Checked) -> f64| looks.iter().map(of).sum::<f64>() / (3 * looks.len()) as f64;
    println!(
        "{what}: {} runs, squared errors over variances: attitude {:.2}, rate {:.2}; tilt {:.1e} rad",
        looks.len(),
        mean(|c| c.attitude),
        mean(|c| c.rate),
        3.0 * mean(|c| c.across.tilt_rad),
    );
    let judge = |quantity: &str, departure: f64| {
        let what = format!("chi-square of the {quantity}, {what}");
        within(what, departure, tolerance::CHI_SQUARE);
    };
    judge("attitude", departure(looks, |c| c.attitude));
    judge("rate", departure(looks, |c| c.rate));
    let scale: f64 = looks.iter().map(|c| c.scale).sum();
    println!("  scale {:.2}", scale / (9 * looks.len()) as f64);
    judge("scale", chi_square_departure(scale, 9 * looks.len()));
    let mut all: Vec<f64> = runs
        .flat_map(|run| run.over_deviation.iter().flatten().copied())
        .collect();
    all.sort_by(f64::total_cmp);
    let Some(&worst) = all.last() else {
        return;
    };
    let beyond = all.iter().filter(|error| **error > 3.0).count();
    println!(
        "  {beyond} of {} components of a beyond three deviations, largest {worst:.1}",
        all.len()
    );
    let what = format!("accelerations over their deviations, {what}");
    within(what, worst, tolerance::OVER_DEVIATION);
}

#[test]
fn stat_a_filter_and_a_smoother_that_are_told_half_the_errors_state_too_small_deviations() {
    let attitudes = Aids {
        attitude: Some((1.0, 0.01)),
        ..Aids::default()
    };
    let told_half = |(ride, aids): (Ride, Aids)| {
        let quality = Quality {
            told: 0.5,
            ..Quality::DAY
        };
        let ride = Ride {
            quality,
            smooth: true,
            ..ride
        };
        (ride, aids)
    };
    for ride in [
        ride(Kind::Shaken, 8.0, Aids::default()),
        ride(Kind::TumbleWithRests, 40.0, attitudes),
    ] {
        let runs = play(&told_half(ride));
        let filtered = last_known(runs.iter().map(|run| &run.filtered));
        let smoothed = any_known(runs.iter().filter_map(|run| run.smoothed.as_ref()));
        for (what, looks) in [("filter", filtered), ("smoother", smoothed)] {
            let rate = departure(&looks, |c| c.rate);
            assert!(
                rate > tolerance::CHI_SQUARE.limit,
                "{what}, {ride:?}: {rate:.2} passes"
            );
        }
    }
}

#[test]
fn stat_aids_take_errors_off_the_open_loop() {
    // One rest of a second in ten: at 50 s at most a tenth of what the open loop has.
    let rests = Aids {
        rests: true,
        ..Aids::default()
    };
    let error = |aids: Aids| {
        let runs = play(&ride(Kind::TumbleWithRests, 52.0, aids));
        let mut last: Vec<f64> = runs
            .iter()
            .filter_map(|run| run.filtered.looks.last())
            .map(|c| c.linear_error_m_s2)
            .collect();
        last.sort_by(f64::total_cmp);
        last[last.len() / 2]
    };
    let (open, rested) = (error(Aids::default()), error(rests));
    println!("median error of a after 52 s: {open:.2} m/s^2 open loop, {rested:.3} with rests");
    within(
        "error of a after 52 s, rests over open loop",
        rested / open,
        tolerance::RESTS_OF_OPEN_LOOP,
    );
}
