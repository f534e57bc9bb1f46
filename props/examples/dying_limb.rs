//! A limb that dies in mid-motion: `cargo run --release -p sixaxis-props --example dying_limb`.
//!
//! Prints the attitude's error at the end for each seed, and with `--publish` writes the first one's history, which the report
//! shows.

use std::process::ExitCode;

use rayon::prelude::*;
use sixaxis_core::redundancy::fault::Event;
use sixaxis_core::redundancy::tolerant::{FaultTolerant, ROWS_KEPT};
use sixaxis_core::{Decoupler, SixAxis};
use sixaxis_props::faults::SAMPLE_RATE_HZ;
use sixaxis_props::faults::dying::{DIES_AT_S, Played, angle_rad};
use sixaxis_props::publication::{Seeds, run};
use sixaxis_props::results::DyingLimb;

/// Seeds below were looked at.
const REPORTED_FROM: u64 = 1_000;
/// Samples that one published point stands for.
const STRIDE: usize = 20;
/// The limb, from 1.
const LIMB: usize = 7;

fn main() -> ExitCode {
    run(Seeds::alone(REPORTED_FROM, 10), study)
}

fn study(first: u64, count: u64) -> Result<DyingLimb, String> {
    let histories: Vec<DyingLimb> = (first..first + count)
        .into_par_iter()
        .map(|seed| history(seed, LIMB))
        .collect::<Result<_, String>>()?;
    for h in &histories {
        let last = |values: &[f64]| values.last().copied().unwrap_or(f64::NAN);
        println!(
            "seed {}: {}; class {} and switch {} samples after; attitude's error at the end, rad: never failed {:.3e}, watched {:.3e}, all nine {:.3e}",
            h.seed,
            h.verdict,
            h.isolated_after_samples,
            h.switched_after_samples,
            last(&h.never_failed_rad),
            last(&h.watched_rad),
            last(&h.nine_rad)
        );
    }
    histories
        .into_iter()
        .next()
        .ok_or_else(|| "no seed".to_owned())
}

fn history(seed: u64, limb: usize) -> Result<DyingLimb, String> {
    let at = |e: &dyn core::fmt::Display| format!("seed {seed}: {e}");
    let played = Played::random(seed, limb - 1).map_err(|e| at(&e))?;
    let decoupler =
        Decoupler::new(&played.sensor, &played.parameters, &played.settings).map_err(|e| at(&e))?;
    let decode = |rows: &[[f64; 9]]| -> Result<Vec<SixAxis>, String> {
        let mut decoupler = decoupler.clone();
        let mut answers = Vec::new();
        for row in rows {
            answers.extend(decoupler.push(row).map_err(|e| at(&e))?);
        }
        Ok(answers)
    };
    let sound = decode(&played.sound_v)?;
    let nine = decode(&played.failed_v)?;
    let mut stream = FaultTolerant::new(
        &played.sensor,
        &played.parameters,
        &played.settings,
        &played.watch(),
        vec![[0.0; sixaxis_core::LIMBS]; ROWS_KEPT],
    )
    .map_err(|e| at(&e))?;
    let (mut watched, mut squares) = (Vec::new(), Vec::new());
    let (mut isolated, mut switched, mut verdict) = (None, None, String::new());
    for (sample, row) in played.failed_v.iter().enumerate() {
        let z = stream.monitor().whitened(row);
        squares.push(z.iter().map(|x| x * x).sum::<f64>());
        let said = stream.push(row).map_err(|e| at(&e))?;
        watched.extend(said.answer);
        switched = switched.or(said.switched.map(|_| sample as u64));
        match said.event {
            Some(Event::Isolated(_)) => isolated = isolated.or(Some(sample as u64)),
            Some(Event::Identified(v)) => verdict = v.to_string(),
            _ => {}
        }
    }
    let mut published = DyingLimb {
        seed,
        sample_rate_hz: SAMPLE_RATE_HZ,
        limb,
        died_at_s: DIES_AT_S,
        isolated_after_samples: isolated.ok_or(at(&"never isolated"))? - played.onset,
        switched_after_samples: switched.ok_or(at(&"never switched"))? - played.onset,
        verdict,
        threshold: stream.monitor().detector().thresholds()[0],
        time_s: Vec::new(),
        statistic: Vec::new(),
        truth_m_s2: Vec::new(),
        nine_m_s2: Vec::new(),
        watched_m_s2: Vec::new(),
        never_failed_rad: Vec::new(),
        nine_rad: Vec::new(),
        watched_rad: Vec::new(),
    };
    for k in (0..sound.len()).step_by(STRIDE) {
        let sample = sound[k].sample as usize;
        let truth = &played.truth[sample];
        let round = |x: f64| (1e6 * x).round() / 1e6;
        let stretch = &squares[sample..squares.len().min(sample + STRIDE)];
        published.time_s.push(sample as f64 / SAMPLE_RATE_HZ);
        published
            .statistic
            .push(round(stretch.iter().copied().fold(0.0, f64::max)));
        published.truth_m_s2.push(round(truth.linear_ground_m_s2.x));
        published
            .nine_m_s2
            .push(round(nine[k].linear_ground_m_s2.x));
        published
            .watched_m_s2
            .push(round(watched[k].linear_ground_m_s2.x));
        let off = |answer: &SixAxis| angle_rad(truth.attitude, answer.attitude);
        published.never_failed_rad.push(off(&sound[k]));
        published.nine_rad.push(off(&nine[k]));
        published.watched_rad.push(off(&watched[k]));
    }
    Ok(published)
}
