//! What the programs for the board have in common: the number type, the calibration, the end in a panic.
#![no_std]

use core::panic::PanicInfo;

use cortex_m_semihosting::debug;
use sixaxis_core::{Decoupler, Result, Settings};

/// The file that `sixaxis calibrate --format rust` writes.
#[rustfmt::skip]
pub mod calibration {
    include!(env!("SIXAXIS_CALIBRATION"));
}

/// A number of the decoupler.
#[cfg(not(feature = "single"))]
pub type Number = f64;
/// A number of the decoupler.
#[cfg(feature = "single")]
pub type Number = f32;

/// A decoupler of the calibrated sensor: Heun, all nine limbs.
///
/// # Errors
/// Those of [`Decoupler::new`].
pub fn prepare(sample_rate_hz: f64) -> Result<Decoupler<Number>> {
    let settings = Settings::new(sample_rate_hz);
    #[cfg(not(feature = "single"))]
    let prepared = Decoupler::new(&calibration::SENSOR, &calibration::PARAMETERS, &settings);
    #[cfg(feature = "single")]
    let prepared = Decoupler::new_f32(&calibration::SENSOR, &calibration::PARAMETERS, &settings);
    prepared
}

#[panic_handler]
fn panic(_: &PanicInfo) -> ! {
    loop {
        debug::exit(debug::EXIT_FAILURE);
    }
}
