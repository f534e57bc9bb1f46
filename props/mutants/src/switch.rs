// Written into the copy of core: which mutant is on.
#![doc(hidden)]
#![allow(missing_docs)]
extern crate std;

use core::sync::atomic::{AtomicBool, AtomicU32, Ordering::Relaxed};
use std::io::Write;

const UNREAD: u32 = u32::MAX;
const TRACE: u32 = u32::MAX - 1;
static ACTIVE: AtomicU32 = AtomicU32::new(UNREAD);
static SEEN: [AtomicBool; MUTANTS] = [const { AtomicBool::new(false) }; MUTANTS];

/// Whether mutant `id` is the one that SIXAXIS_MUTANT names. With SIXAXIS_MUTANT_TRACE instead none is, and each that is asked
/// for is written to that file once.
#[inline(always)]
pub fn on(id: u32) -> bool {
    let active = ACTIVE.load(Relaxed);
    if active >= TRACE {
        return asked(id, active);
    }
    active == id
}

#[cold]
#[inline(never)]
fn asked(id: u32, active: u32) -> bool {
    if active == UNREAD {
        let named = std::env::var("SIXAXIS_MUTANT").ok();
        let trace = std::env::var_os("SIXAXIS_MUTANT_TRACE").is_some();
        let named = named.and_then(|text| text.parse().ok()).unwrap_or(0);
        ACTIVE.store(if trace { TRACE } else { named }, Relaxed);
        return on(id);
    }
    if !SEEN[id as usize].swap(true, Relaxed)
        && let Some(path) = std::env::var_os("SIXAXIS_MUTANT_TRACE")
        && let Ok(mut file) = std::fs::OpenOptions::new().append(true).create(true).open(path)
    {
        let _ = file.write_all(std::format!("{id}\n").as_bytes());
    }
    false
}
