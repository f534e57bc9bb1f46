//! Hours of motion, open loop and with aids: `cargo run --release -p sixaxis-props --example hours`.
//!
//! With `--publish` it writes what the report shows.

use std::process::ExitCode;

use rayon::prelude::*;
use sixaxis_core::LimbSet;
use sixaxis_props::aided::{Aids, Checked, KNOWN_RAD, OPEN_S, Outcome, Quality, Ride, run as play};
use sixaxis_props::evidence::Quantiles;
use sixaxis_props::publication::{Seeds, run};
use sixaxis_props::results::{AidedErrors, AidedRide, Hours, Steady};
use sixaxis_reference::rig::journey::Kind;

/// Seeds below were looked at while the filter was written.
const REPORTED_FROM: u64 = 30_000;
const RATE_HZ: f64 = 1000.0;
const DURATION_S: f64 = 3600.0;
/// Ends 0.1 s before the motion does: a look is taken where a block ends.
const TIMES_S: [f64; 11] = [
    1.0, 3.0, 10.0, 20.0, 60.0, 120.0, 300.0, 600.0, 1200.0, 2400.0, 3599.9,
];
/// A camera: once a second, 0.6 degrees.
const CAMERA: (f64, f64) = (1.0, 0.01);

/// What can be known of a motion of a kind: nothing, what the motion itself has, a camera's attitudes, both.
fn aids(kind: Kind) -> Vec<Aids> {
    let open = Aids::default();
    // Velocities as those that the kinds have.
    let own = match kind {
        Kind::Still => Some(Aids {
            velocity: Some((2.0, 0.01)),
            ..open
        }),
        Kind::Shaken => Some(Aids {
            velocity: Some((2.0, 0.1)),
            ..open
        }),
        Kind::TumbleWithRests | Kind::PickAndPlace => Some(Aids {
            rests: true,
            ..open
        }),
        Kind::Vehicle => None,
    };
    let camera = Aids {
        attitude: Some(CAMERA),
        ..open
    };
    let both = own.map(|own| Aids {
        attitude: Some(CAMERA),
        ..own
    });
    [Some(open), own, Some(camera), both]
        .into_iter()
        .flatten()
        .collect()
}

fn main() -> ExitCode {
    run(
        Seeds {
            first: REPORTED_FROM,
            count: 32,
            sample: 1,
        },
        study,
    )
}

fn study(first: u64, count: u64) -> Result<Hours, String> {
    println!("seeds {first} to {}", first + count - 1);
    // All at once: seeds alone would leave cores idle where there are few of them.
    let played: Vec<(Kind, Vec<Outcome>)> = Kind::ALL
        .into_par_iter()
        .flat_map(|kind| {
            (first..first + count).into_par_iter().map(move |seed| {
                let ride = Ride {
                    kind,
                    duration_s: DURATION_S,
                    rate_hz: RATE_HZ,
                    quality: Quality::DAY,
                    smooth: false,
                    without: LimbSet::EMPTY,
                };
                (kind, play(&ride, &aids(kind), &TIMES_S, seed))
            })
        })
        .collect();
    let mut rides = Vec::new();
    for kind in Kind::ALL {
        let of_kind = played.iter().filter(|(played, _)| *played == kind);
        let runs: Vec<&Vec<Outcome>> = of_kind.map(|(_, outcomes)| outcomes).collect();
        for (place, aids) in aids(kind).into_iter().enumerate() {
            let runs: Vec<&Outcome> = runs.iter().map(|outcomes| &outcomes[place]).collect();
            let ride = summary(kind, aids, &runs);
            print(&ride);
            rides.push(ride);
        }
    }
    Ok(Hours {
        first_seed: first,
        runs: count,
        duration_s: DURATION_S,
        sample_rate_hz: RATE_HZ,
        noise_over_peak: Quality::DAY.noise_of_peak,
        known_rad: KNOWN_RAD,
        open_until_s: OPEN_S,
        rides,
    })
}

fn summary(kind: Kind, aids: Aids, runs: &[&Outcome]) -> AidedRide {
    let known = |look: &Checked| look.attitude_deviation_rad < KNOWN_RAD;
    let looks = |place: usize| {
        runs.iter()
            .filter_map(move |run| run.filtered.looks.get(place))
    };
    let at = TIMES_S.iter().enumerate().map(|(place, time_s)| {
        let known: Vec<&Checked> = looks(place).filter(|look| known(look)).collect();
        let mean = |of: fn(&Checked) -> f64| {
            known.iter().map(|look| of(look)).sum::<f64>() / (3 * known.len()) as f64
        };
        AidedErrors {
            time_s: *time_s,
            known: known.len() as u64,
            linear_m_s2: Quantiles::of(looks(place).map(|look| look.linear_error_m_s2)),
            over_variance: (!known.is_empty()).then(|| [mean(|c| c.attitude), mean(|c| c.rate)]),
        }
    });
    let all = || {
        runs.iter()
            .flat_map(|run| run.filtered.over_deviation.iter().flatten())
    };
    let last: Vec<&Checked> = looks(TIMES_S.len() - 1)
        .filter(|look| known(look))
        .collect();
    let to_the_end = |run: &&&Outcome| {
        run.filtered.unknown_from_s.is_none() && run.filtered.looks.len() == TIMES_S.len()
    };
    let of_last = |of: fn(&Checked) -> f64| Quantiles::of(last.iter().map(|look| of(look)));
    let root_mean_square = |of: fn(&Checked) -> f64| {
        (last.iter().map(|look| of(look).powi(2)).sum::<f64>() / last.len() as f64).sqrt()
    };
    AidedRide {
        kind,
        aids,
        at: at.collect(),
        components: all().count() as u64,
        beyond_three: all().filter(|error| **error > 3.0).count() as u64,
        largest: all().copied().max_by(f64::total_cmp),
        known_to_the_end: runs.iter().filter(to_the_end).count() as u64,
        unknown_from_s: Quantiles::of(runs.iter().filter_map(|run| run.filtered.unknown_from_s))
            .map(|times| times.median),
        bound: runs[0].bound.map(|bound| Steady {
            tilt_rad: bound.tilt_rad,
            rate_rad_s: bound.rate_rad_s,
        }),
        stated: of_last(|look| look.across.tilt_rad)
            .zip(of_last(|look| look.across.rate_rad_s))
            .map(|(tilt, rate)| Steady {
                tilt_rad: tilt.median,
                rate_rad_s: rate.median,
            }),
        attained: (!last.is_empty()).then(|| Steady {
            tilt_rad: root_mean_square(|look| look.tilt_error_rad),
            rate_rad_s: root_mean_square(|look| look.rate_across_error_rad_s),
        }),
    }
}

fn print(ride: &AidedRide) {
    println!("{:?}, {:?}", ride.kind, ride.aids);
    println!(
        "  {} of {} components beyond three deviations, largest {:.1?}, {} runs known to the end, others for {:.1?} s",
        ride.beyond_three,
        ride.components,
        ride.largest,
        ride.known_to_the_end,
        ride.unknown_from_s
    );
    println!(
        "  bound {:?}\n  stated {:?}\n  attained {:?}",
        ride.bound, ride.stated, ride.attained
    );
    for at in &ride.at {
        let linear = at.linear_m_s2.map_or_else(String::new, |q| q.to_string());
        println!(
            "  {:>7.1} s: {:>3} known, m/s^2: {linear}; squared errors over variances {:.2?}",
            at.time_s, at.known, at.over_variance
        );
    }
}
