//! Motions of all kinds with all aids, over seeds: what the studies `hours` and `hours_mujoco` publish.

use rayon::prelude::*;
use sixaxis_core::{LIMBS, LimbSet};
use sixaxis_reference::rig::journey::Kind;
use sixaxis_reference::sensor::TrueSensor;

use super::{
    Aids, Checked, KNOWN_RAD, OPEN_S, Outcome, Played, Quality, Ride, Sample, journey, player,
    run as play,
};
use crate::evidence::Quantiles;
use crate::results::{AidedErrors, AidedRide, Halved, Hours, Steady};

/// Samples per second.
pub const RATE_HZ: f64 = 1000.0;
/// Time of a motion for which MuJoCo's step is halved, s: it has risen from rest by then.
pub const HALVED_S: f64 = 3.0;
/// A camera: once a second, 0.6 degrees.
const CAMERA: (f64, f64) = (1.0, 0.01);

/// How motions are played, and for how long.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Length<'a> {
    /// Who plays them.
    pub played: Played,
    /// How long each is, s.
    pub duration_s: f64,
    /// When errors are looked at, s; the last one is before the end, where a block of samples ends.
    pub times_s: &'a [f64],
}

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

/// Plays `count` motions of each kind, by the seeds from `first` on, and prints what came out.
pub fn study(length: &Length<'_>, first: u64, count: u64) -> Hours {
    println!("seeds {first} to {}", first + count - 1);
    // All at once: seeds alone would leave cores idle where there are few of them.
    let played: Vec<(Kind, Vec<Outcome>)> = Kind::ALL
        .into_par_iter()
        .flat_map(|kind| {
            (first..first + count).into_par_iter().map(move |seed| {
                let ride = Ride {
                    amplifier: None,
                    played: length.played,
                    kind,
                    duration_s: length.duration_s,
                    rate_hz: RATE_HZ,
                    quality: Quality::DAY,
                    smooth: false,
                    without: LimbSet::EMPTY,
                };
                (kind, play(&ride, &aids(kind), length.times_s, seed))
            })
        })
        .collect();
    let mut rides = Vec::new();
    for kind in Kind::ALL {
        let of_kind = played.iter().filter(|(played, _)| *played == kind);
        let runs: Vec<&Vec<Outcome>> = of_kind.map(|(_, outcomes)| outcomes).collect();
        for (place, aids) in aids(kind).into_iter().enumerate() {
            let runs: Vec<&Outcome> = runs.iter().map(|outcomes| &outcomes[place]).collect();
            let ride = summary(kind, aids, length.times_s, &runs);
            print(&ride);
            rides.push(ride);
        }
    }
    Hours {
        first_seed: first,
        runs: count,
        duration_s: length.duration_s,
        sample_rate_hz: RATE_HZ,
        noise_over_peak: Quality::DAY.noise_of_peak,
        known_rad: KNOWN_RAD,
        open_until_s: OPEN_S,
        rides,
    }
}

/// What MuJoCo's own step leaves open: the first [`HALVED_S`] seconds of a motion of each kind with this step and with half of it.
///
/// # Panics
/// If the step is not stable.
pub fn halved(step_s: f64, seed: u64) -> Vec<Halved> {
    let of = |kind: Kind| {
        let journey = journey(kind, seed);
        let sensor = TrueSensor::identified();
        let mut played = [step_s, 0.5 * step_s]
            .map(|step_s| player(Played::ByMujoco { step_s }, &journey, &sensor, RATE_HZ));
        let [whole, half] = played
            .each_mut()
            .map(|play| play((HALVED_S * RATE_HZ) as usize));
        let both = || whole.iter().zip(&half);
        let largest = |off: &dyn Fn(&Sample, &Sample) -> f64| {
            both().map(|(a, b)| off(a, b)).fold(0.0, f64::max)
        };
        Halved {
            kind,
            force_m_s2: largest(&|(_, a), (_, b)| {
                (0..LIMBS).map(|i| (a[i] - b[i]).abs()).fold(0.0, f64::max)
            }),
            attitude_rad: largest(&|(a, _), (b, _)| a.attitude.angle_between(b.attitude)),
        }
    };
    Kind::ALL.into_par_iter().map(of).collect()
}

fn summary(kind: Kind, aids: Aids, times_s: &[f64], runs: &[&Outcome]) -> AidedRide {
    let known = |look: &Checked| look.attitude_deviation_rad < KNOWN_RAD;
    let looks = |place: usize| {
        runs.iter()
            .filter_map(move |run| run.filtered.looks.get(place))
    };
    let at = times_s.iter().enumerate().map(|(place, time_s)| {
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
    let last: Vec<&Checked> = looks(times_s.len() - 1)
        .filter(|look| known(look))
        .collect();
    let to_the_end = |run: &&&Outcome| {
        run.filtered.unknown_from_s.is_none() && run.filtered.looks.len() == times_s.len()
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
