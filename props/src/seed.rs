//! The seed of a run.

use std::hash::{BuildHasher, Hasher, RandomState};
use std::sync::OnceLock;

/// Seed unless `SIXAXIS_SEED` says otherwise: fixed, so that a failure stays a failure.
const SEED: u64 = 20131;

/// The seed of this run, printed. `SIXAXIS_SEED=7` sets another; `SIXAXIS_SEED=random` draws one, of 32 bits so that cases
/// can be counted up from it.
///
/// # Panics
/// If `SIXAXIS_SEED` is neither a number nor `random`.
pub fn seed() -> u64 {
    static OF_THIS_RUN: OnceLock<u64> = OnceLock::new();
    let seed = *OF_THIS_RUN.get_or_init(|| match std::env::var("SIXAXIS_SEED") {
        Err(_) => SEED,
        Ok(text) if text == "random" => RandomState::new().build_hasher().finish() >> 32,
        Ok(text) => text
            .parse()
            .expect("SIXAXIS_SEED is a whole number or `random`"),
    });
    eprintln!("SIXAXIS_SEED={seed}");
    seed
}
