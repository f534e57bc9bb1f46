//! Pushes samples into a decoupler that somebody else has prepared: linked for its size, not run.
#![no_std]
#![no_main]

use core::hint::black_box;
use core::mem::MaybeUninit;
use core::ptr::addr_of_mut;

use cortex_m_rt::entry;
use sixaxis_core::{Decoupler, LIMBS};
use sixaxis_microcontroller::Number;

static mut DECOUPLER: MaybeUninit<Decoupler<Number>> = MaybeUninit::zeroed();

#[entry]
fn main() -> ! {
    // SAFETY: all zeros is a decoupler of no sensor.
    let decoupler = unsafe { &mut *black_box(addr_of_mut!(DECOUPLER)).cast::<Decoupler<Number>>() };
    loop {
        black_box(decoupler.push(&black_box([0.0; LIMBS]))).ok();
    }
}
