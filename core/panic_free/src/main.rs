//! Links only if no panic can be reached from the streaming decouplers.
//!
//! The panic handler calls a function that exists nowhere. If any path from `_start` to a panic is left after
//! optimisation, the handler is part of the program and the linker reports `a_panic_can_be_reached`; if none is, the
//! handler is thrown away, and the call with it. Built by `.ci/panic-free`, which also tries a decoupler that does panic.
#![no_std]
#![no_main]

use core::hint::black_box;
use core::panic::PanicInfo;
use core::ptr::addr_of_mut;

use sixaxis_core::redundancy::self_calibration::Accumulator;
use sixaxis_core::{Decoupler, LimbSet};

unsafe extern "C" {
    fn a_panic_can_be_reached() -> !;
}

#[panic_handler]
fn panic(_: &PanicInfo) -> ! {
    // SAFETY: never linked; see above.
    unsafe { a_panic_can_be_reached() }
}

/// Copies of whole decouplers are calls of it, and there is no C library to have it from.
///
/// # Safety
/// As in C.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn memcpy(to: *mut u8, from: *const u8, bytes: usize) -> *mut u8 {
    // SAFETY: the caller's promise.
    unsafe {
        core::arch::asm!(
            "rep movsb",
            inout("rcx") bytes => _, inout("rdi") to => _, inout("rsi") from => _,
            options(nostack, preserves_flags)
        );
    }
    to
}

/// Somebody else has prepared the decouplers and left them here; preparing may refuse, but that is not at stake.
#[repr(align(64))]
struct Memory(#[expect(dead_code, reason = "read as what lies there")] [u8; 1 << 16]);
static mut MEMORY: Memory = Memory([0; 1 << 16]);

/// The entry point.
#[unsafe(no_mangle)]
pub extern "C" fn _start() -> ! {
    let start = black_box(addr_of_mut!(MEMORY)).cast::<u8>();
    loop {
        // SAFETY: all zeros is a decoupler of no sensor, aligned and in bounds; the program is linked, not run.
        unsafe {
            let double = &mut *start.cast::<Decoupler>();
            let single = &mut *start.add(1 << 14).cast::<Decoupler<f32>>();
            let accumulator = &mut *start.add(7 << 13).cast::<Accumulator>();
            let (row, row_single) = black_box(([0.0; 9], [0.0; 9]));
            black_box(double.push(&row)).ok();
            black_box(single.push(&row_single)).ok();
            let excluded = black_box(LimbSet::EMPTY);
            black_box(double.set_excluded(excluded)).ok();
            black_box(single.set_excluded(excluded)).ok();
            black_box(accumulator.push(&row)).ok();
            if cfg!(feature = "panicking") {
                assert!(black_box(row[0]) == 0.0, "the check must see this");
            }
        }
    }
}
