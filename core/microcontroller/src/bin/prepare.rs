//! Prepares a decoupler and pushes samples into it: linked for its size, not run.
#![no_std]
#![no_main]

use core::hint::black_box;

use cortex_m_rt::entry;
use sixaxis_core::LIMBS;
use sixaxis_microcontroller::prepare;

#[entry]
fn main() -> ! {
    let mut prepared = prepare(black_box(1e4));
    loop {
        if let Ok(decoupler) = &mut prepared {
            black_box(decoupler.push(&black_box([0.0; LIMBS]))).ok();
        }
    }
}
