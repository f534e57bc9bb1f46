//! Channels that stand still in a static record, and noise in coarse converters, which does not.

use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use sixaxis_calibration::diagnosis::still::still;
use sixaxis_calibration::finding::Cause;
use sixaxis_calibration::report::Grade;
use sixaxis_core::LIMBS;
use sixaxis_props::blind::{Cell, Naming, TUNING_SEEDS, plan, try_out};
use sixaxis_reference::laboratory::defect::{Defect, Kind, Where};
use sixaxis_reference::laboratory::plan::{DefectChoice, Engine};

const SAMPLES: usize = 12_000;
/// 16 bits of +-10 V, and the noise of 60 dB in it.
const STEP_V: f64 = 20.0 / 65_536.0;
const NOISE_V: f64 = 7e-3;

/// Noise of a memory, 0 for none, about nine zeros anywhere in a step.
fn record(seed: u64, step_v: f64, noise_v: f64, memory: f64) -> Vec<[f64; LIMBS]> {
    let mut rng = Pcg64::seed_from_u64(seed);
    let zeros: [f64; LIMBS] = core::array::from_fn(|_| step_v * rng.random::<f64>());
    let mut state = [0.0_f64; LIMBS];
    (0..SAMPLES)
        .map(|_| {
            core::array::from_fn(|i| {
                let unit: f64 = StandardNormal.sample(&mut rng);
                state[i] = memory * state[i] + (1.0 - memory * memory).sqrt() * unit;
                let u = zeros[i] + noise_v * state[i];
                match step_v > 0.0 {
                    true => (u / step_v).round() * step_v,
                    false => u,
                }
            })
        })
        .collect()
}

fn found(rows: &[[f64; LIMBS]], step_v: f64) -> Vec<usize> {
    let all = still(rows, &[step_v; LIMBS]);
    (0..LIMBS).filter(|i| all[*i].is_some()).collect()
}

#[test]
fn prop_noise_in_any_converter_is_not_accused() {
    for seed in 1..9 {
        for (step_v, memory) in [0.0, 1e-3, 0.1, 0.3, 1.0, 2.0, 4.0, 8.0, 30.0]
            .into_iter()
            .flat_map(|steps| [(steps * NOISE_V, 0.0), (steps * NOISE_V, 0.98)])
        {
            let rows = record(seed, step_v, NOISE_V, memory);
            let accused = found(&rows, step_v);
            assert!(
                accused.is_empty(),
                "{accused:?}, {seed}: {step_v} V, {memory}"
            );
        }
    }
}

#[test]
fn prop_a_channel_that_stands_still_is_found() {
    for seed in 1..9 {
        for share in [0.01, 0.1, 0.5, 0.9, 1.0] {
            for channels in [&[4][..], &[0, 4, 8]] {
                let mut rows = record(seed, STEP_V, NOISE_V, 0.0);
                for row in &mut rows[..(share * SAMPLES as f64) as usize] {
                    channels.iter().for_each(|channel| row[*channel] = 0.0);
                }
                assert_eq!(found(&rows, STEP_V), channels, "{seed}: {share}");
            }
        }
    }
}

#[test]
fn prop_an_open_input_is_found() {
    let mut rows = record(1, STEP_V, NOISE_V, 0.0);
    let last_bit = record(2, STEP_V, 0.5 * STEP_V, 0.0);
    for (row, quiet) in rows.iter_mut().zip(&last_bit) {
        row[7] = quiet[7];
    }
    assert_eq!(found(&rows, STEP_V), [7]);
}

/// From a hundredth of the record to all of it; beside it a healthy session whose converter is coarser than its noise.
#[test]
fn prop_a_session_with_a_dead_static_channel_is_not_good() {
    let seed = TUNING_SEEDS.end + 2;
    let own = |name: &str| {
        std::env::temp_dir().join(format!("sixaxis-still-{}-{name}", std::process::id()))
    };
    let cell = Cell::Defect(Kind::DeadStatic);
    for magnitude in [0.01, 1.0] {
        let mut dead = plan(cell, seed, Engine::Rigid);
        dead.defect = DefectChoice::Exactly(Defect {
            kind: Kind::DeadStatic,
            magnitude,
            place: Where::Everywhere,
            channel: 4,
            seed: 0,
        });
        let outcome = try_out(cell, &dead, "npz", &own("dead")).expect("it plays");
        assert_eq!(outcome.naming(), Naming::Right, "{outcome:?}");
        assert_ne!(outcome.grade, Some(Grade::Good));
        let harm = outcome.harm.expect("a calibration");
        assert!(harm.breaks_it_at_rest() && harm.breaks_the_promise());
    }
    let mut coarse = plan(Cell::Corner, seed, Engine::Rigid);
    coarse.chain.resolution_bits = 8;
    let outcome = try_out(Cell::Corner, &coarse, "npz", &own("coarse")).expect("it plays");
    assert_ne!(outcome.cause, Some(Cause::DeadLimb), "{outcome:?}");
    assert!(!outcome.harm.expect("a calibration").breaks_it_at_rest());
}
