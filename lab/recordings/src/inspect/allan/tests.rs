use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

use super::{Allan, Coefficient, Stability};

const RATE_HZ: f64 = 200.0;
/// Standard errors by which one of a hundred draws may be off.
const SIGMAS: f64 = 4.5;

/// A record of white noise of a one-sided density, unit/root(Hz), on a random walk, unit/root(s), about a large mean.
fn record(seed: u64, samples: usize, density: f64, walk: f64) -> Vec<f64> {
    let mut rng = Pcg64::seed_from_u64(seed);
    let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
    let (white, step) = (density * (0.5 * RATE_HZ).sqrt(), walk / RATE_HZ.sqrt());
    let mut mean = 1e3;
    let sample = |_| {
        mean += step * normal();
        mean + white * normal()
    };
    (0..samples).map(sample).collect()
}

fn stability(record: &[f64]) -> Stability {
    let mut allan = Allan::default();
    // However the samples come.
    for block in record.chunks(1001) {
        allan.extend(block);
    }
    allan
        .finish(record.len() as u64, RATE_HZ)
        .expect("long enough")
}

/// Stated errors by which a coefficient is off, in logarithms: its stated error is a share of itself.
fn off(found: Option<Coefficient>, truth: f64) -> f64 {
    let found = found.expect("it stands out");
    (found.value / truth).ln() / (found.standard_error / found.value)
}

#[test]
fn law_the_deviations_are_those_of_the_definition() {
    let record = record(1, 4000, 0.01, 0.02);
    for point in &stability(&record).deviations {
        let m = (point.averaging_s * RATE_HZ).round() as usize;
        let mean = |from: usize| record[from..from + m].iter().sum::<f64>() / m as f64;
        let stride = (m / 4).max(1);
        let starts = (0..)
            .map(|k| k * stride)
            .take_while(|from| from + 2 * m <= record.len());
        let squares: Vec<f64> = starts
            .map(|from| (mean(from + m) - mean(from)).powi(2))
            .collect();
        let expected = (0.5 * squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
        assert!(
            (point.deviation / expected - 1.0).abs() < 1e-9,
            "{m}: {point:?} {expected}"
        );
    }
}

#[test]
fn stat_known_densities_are_found_within_what_is_stated() {
    let (density, walk) = (2e-3, 1e-3);
    let (mut white, mut walks) = (Vec::new(), Vec::new());
    for seed in 1..=60 {
        // White noise and walk cross at some 3 s.
        let found = stability(&record(seed, 200_000, density, walk));
        white.push(off(found.noise_density, density));
        walks.push(off(found.random_walk, walk));
        let (instability, at_s) = found.bias_instability.expect("it rises again");
        // The lowest deviation of both together is the root of 2 N K / root(3).
        let lowest = (density / 2.0_f64.sqrt() * walk * 2.0 / 3.0_f64.sqrt()).sqrt() / 0.664;
        assert!(
            (instability.value / lowest - 1.0).abs() < 0.3 && (0.5..20.0).contains(&at_s),
            "{seed}: {instability:?} at {at_s} s, {lowest}"
        );
    }
    for off in [white, walks] {
        let rms = (off.iter().map(|x| x * x).sum::<f64>() / off.len() as f64).sqrt();
        assert!(off.iter().all(|x| x.abs() < SIGMAS), "{off:?}");
        // Neither too sure nor too modest.
        assert!((0.5..1.5).contains(&rms), "{rms}");
    }
}

#[test]
fn neg_what_a_record_does_not_show_is_not_stated() {
    let mut claimed = 0;
    for seed in 1..=60 {
        let white = stability(&record(seed, 20_000, 2e-3, 0.0));
        assert!(off(white.noise_density, 2e-3).abs() < SIGMAS);
        claimed += usize::from(white.random_walk.is_some())
            + usize::from(white.bias_instability.is_some());
        if white.random_walk.is_none() {
            assert!(white.absent["random_walk"].contains("record too short"));
        }
    }
    assert!(claimed <= 3, "{claimed}");
    // A walk hidden in a minute shows in an hour.
    assert!(
        stability(&record(1, 12_000, 2e-3, 2e-4))
            .random_walk
            .is_none()
    );
    let hour = stability(&record(1, 720_000, 2e-3, 2e-4));
    assert!(off(hour.random_walk, 2e-4).abs() < SIGMAS);
    // Motion is no noise.
    let mut moving = record(1, 20_000, 2e-3, 0.0);
    for (k, x) in moving.iter_mut().enumerate() {
        *x += (k as f64 / RATE_HZ * 6.0).sin();
    }
    let moving = stability(&moving);
    assert!(moving.noise_density.is_none() && moving.absent["noise_density"].contains("motion"));
    assert_eq!(
        stability(&[2.5; 100]).absent["noise_density"],
        "the channel stands still"
    );
    assert!(Allan::default().finish(0, RATE_HZ).is_none());
}

#[test]
fn inv_no_difference_reaches_over_a_gap() {
    // Two halves, a thousand apart: with the gap between them it does not show.
    let mut record = record(1, 20_000, 2e-3, 0.0);
    let whole = stability(&record);
    record[10_000..].iter_mut().for_each(|x| *x += 1000.0);
    record[10_000] = f64::NAN;
    let gap = stability(&record);
    for (a, b) in whole.deviations.iter().zip(&gap.deviations) {
        assert!((a.deviation / b.deviation - 1.0).abs() < 0.5, "{a:?} {b:?}");
    }
}
