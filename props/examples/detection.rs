//! Failed limbs by the thousand: `cargo run --release -p sixaxis-props --example detection`.
//!
//! Prints false alarms, detection, isolation and naming, and with `--publish` writes what README and the report show.

use std::process::ExitCode;

use sixaxis_props::faults::null::{curve, false_alarms};
use sixaxis_props::faults::tally::{WITHIN, of_classes, play, tally};
use sixaxis_props::faults::{FALSE_ALARMS_PER_HOUR, Name, SAMPLE_RATE_HZ};
use sixaxis_props::publication::{Seeds, run};
use sixaxis_props::results::Detection;

/// Seeds below were looked at while limits were chosen.
const REPORTED_FROM: u64 = 10_000_000;
/// Trials of a kind and size.
const COUNT: u64 = 160;
/// Rates of false alarms per sample and stretches of 2^20 samples that count them to 3 %, with [`COUNT`] trials.
const RATES: [(f64, u64); 2] = [(1e-3, 4), (1e-4, 16)];
/// Channels' noise, largest over smallest.
const UNEQUAL: [f64; 2] = [1.0, 5.0];
/// Sizes in standard deviations where the motion does not give them.
const SIZES: [f64; 3] = [2.0, 5.0, 10.0];
/// Size of the table of classes.
const CLASS_SIGMAS: f64 = 5.0;
/// Operating curves: window, sizes.
const CURVES: [(u64, [f64; 3]); 2] = [(1, [3.0, 5.0, 8.0]), (64, [0.3, 0.5, 1.0])];
/// Draws of a point of them, a trial.
const DRAWS: u64 = 250;

fn main() -> ExitCode {
    run(Seeds::alone(REPORTED_FROM, COUNT), study)
}

fn study(first: u64, each: u64) -> Result<Detection, String> {
    let mut alarms = Vec::new();
    for unequal in UNEQUAL {
        for (rate, stretches) in RATES {
            let counted = false_alarms(
                rate,
                unequal,
                1.0,
                (stretches * each).div_ceil(COUNT),
                first,
            );
            println!(
                "{rate:.0e} a sample, noise up to {unequal} to 1: {} alarms in {} samples, {:.3} of those asked for",
                counted.alarms,
                counted.samples,
                counted.attained()
            );
            alarms.push(counted);
        }
    }
    let mut kinds = Vec::new();
    let mut at_five = Vec::new();
    for kind in Name::ALL {
        let given = matches!(kind, Name::Dead | Name::Stuck | Name::Swapped);
        for sigmas in SIZES {
            if given && sigmas != CLASS_SIGMAS {
                continue;
            }
            let trials = play(kind, sigmas, first, each);
            let counted = tally(kind, (!given).then_some(sigmas), &trials);
            println!(
                "{:<10} {:>4} detected {:?} isolated {:?} after {:?} named {:?} twins {:?}, {} alarms before",
                format!("{kind:?}"),
                counted.sigmas.map_or(String::new(), |s| s.to_string()),
                counted.detected_within.map(|s| (1e4 * s).round() / 1e4),
                counted.isolated,
                counted.isolated_after,
                counted.named,
                counted.twins,
                counted.alarmed_before
            );
            kinds.push(counted);
            if sigmas == CLASS_SIGMAS && kind != Name::Swapped {
                at_five.extend(trials);
            }
        }
    }
    let classes = of_classes(&at_five);
    for class in &classes {
        println!(
            "class {:?}: {:?} after {:?}",
            class.limbs, class.isolated, class.isolated_after
        );
    }
    let curves = CURVES
        .iter()
        .flat_map(|&(window, sizes)| {
            sizes.map(|sigmas| curve(window, 4, sigmas, DRAWS * each, first))
        })
        .collect();
    Ok(Detection {
        first_seed: first,
        sample_rate_hz: SAMPLE_RATE_HZ,
        false_alarms_per_hour: FALSE_ALARMS_PER_HOUR,
        within_samples: WITHIN,
        false_alarms: alarms,
        kinds,
        class_sigmas: CLASS_SIGMAS,
        classes,
        curves,
    })
}
