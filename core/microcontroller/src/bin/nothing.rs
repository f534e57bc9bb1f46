//! Starts, and that is all: what the other programs' sizes are counted from.
#![no_std]
#![no_main]

use cortex_m_rt::entry;
use sixaxis_microcontroller as _;

#[entry]
fn main() -> ! {
    loop {
        cortex_m::asm::wfi();
    }
}
