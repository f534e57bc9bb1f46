//! Random motions of random sensors in MuJoCo, decoupled: the distribution of the error against its gate.
//!
//! `SIXAXIS_MOTIONS=1000` is the nightly setting; `SIXAXIS_SEED` draws others.

use std::sync::atomic::{AtomicU64, Ordering};

use sixaxis_core::Scheme;
use sixaxis_props::evidence::{self, Quantiles};
use sixaxis_props::motions;
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
