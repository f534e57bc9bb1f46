//! What the laboratory does to a recording before the four steps see it.

use glam::DVec3;
use sixaxis_core::preprocess::butterworth::{self, Section};
use sixaxis_core::preprocess::differentiate::Differentiator;
use sixaxis_core::preprocess::lag::undo_low_pass;
use sixaxis_core::preprocess::zero_phase::zero_phase;
use sixaxis_core::recording::check_channels;
use sixaxis_core::{LIMBS, Result};
use sixaxis_reference::instruments::GYROSCOPE_BANDWIDTH_HZ;
use sixaxis_reference::recording::Recording;

/// Order of the low-pass; run forwards and backwards it attenuates like twice that.
const FILTER_ORDER: usize = 4;
/// Window and order of the differentiator: an error of 2e-9 at 5 Hz and 10 kHz, and no smoothing to speak of below the
/// low-pass.
const DIFFERENTIATOR_HALF_WIDTH: usize = 3;
const DIFFERENTIATOR_ORDER: usize = 4;

/// How recordings are cleaned.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cleaning {
    /// Corner of the zero-phase low-pass on all channels and instruments: so many times the crank's frequency plus a
    /// constant in Hz. None: no filter.
    pub corner: Option<(f64, f64)>,
    /// Undo the gyroscope's lag.
    pub undo_lag: bool,
}

impl Cleaning {
    /// For recordings without errors: leave them alone.
    pub const NONE: Self = Self {
        corner: None,
        undo_lag: false,
    };
    /// For identification: 12 Hz at 1 Hz. The second harmonic, where w x I w is, loses less than 2e-5, so that step 3
    /// can tell it from the first.
    pub const IDENTIFICATION: Self = Self {
        corner: Some((4.0, 8.0)),
        undo_lag: true,
    };
    /// For comparison with the standards: their second derivative of noise, which undoing the gyroscope's lag
    /// amplifies, must stay out. The drive loses 7e-6, the same on both sides.
    pub const COMPARISON: Self = Self {
        corner: Some((4.4, 0.0)),
        undo_lag: true,
    };
}

/// A recording ready for identification and decoupling.
#[derive(Debug, Clone)]
pub struct Cleaned {
    /// Nine voltages per sample, V.
    pub voltage_v: Vec<[f64; LIMBS]>,
    /// Standard linear acceleration, ground axes, m/s^2.
    pub linear_ground_m_s2: Vec<DVec3>,
    /// Standard rate, shell axes, rad/s.
    pub rate_shell_rad_s: Vec<DVec3>,
    /// Its derivative, rad/s^2.
    pub angular_shell_rad_s2: Vec<DVec3>,
}

impl Cleaning {
    /// Cleans one recording. Everything passes through the same low-pass, so that what little it takes off is the same
    /// on both sides of every equation.
    ///
    /// # Errors
    /// A recording that cannot be worked with: too short, a sample that is not finite, a channel dead or clipped.
    pub fn clean(&self, recording: &Recording) -> Result<Cleaned> {
        check_channels(&recording.voltage_v, recording.full_scale_v)?;
        let sections: Option<Vec<Section>> = self
            .corner
            .map(|(over_drive, base_hz)| {
                butterworth::low_pass(
                    FILTER_ORDER,
                    over_drive * recording.frequency_hz + base_hz,
                    recording.sample_rate_hz,
                )
            })
            .transpose()?;
        let filter = |series: &mut Vec<f64>| -> Result<()> {
            match &sections {
                Some(sections) => zero_phase(sections, series),
                None => Ok(()),
            }
        };

        let mut voltage_v = recording.voltage_v.clone();
        for channel in 0..LIMBS {
            let mut series: Vec<f64> = voltage_v.iter().map(|row| row[channel]).collect();
            filter(&mut series)?;
            for (row, value) in voltage_v.iter_mut().zip(series) {
                row[channel] = value;
            }
        }
        let mut acceleration = recording.accelerometer_m_s2.clone();
        filter(&mut acceleration)?;
        let mut rate = recording.gyroscope_rad_s.clone();
        filter(&mut rate)?;
        let differentiator = Differentiator::new(
            DIFFERENTIATOR_HALF_WIDTH,
            DIFFERENTIATOR_ORDER,
            recording.sample_rate_hz,
        )?;
        if self.undo_lag {
            rate = undo_low_pass(&rate, GYROSCOPE_BANDWIDTH_HZ, &differentiator)?;
        }
        let slope = differentiator.derivative(&rate)?;
        let direction = recording.direction_ground;
        let along = |series: Vec<f64>| series.into_iter().map(|x| direction * x).collect();
        Ok(Cleaned {
            voltage_v,
            linear_ground_m_s2: along(acceleration),
            // The pinion turns about a direction that is the same in ground and shell axes.
            rate_shell_rad_s: along(rate),
            angular_shell_rad_s2: along(slope),
        })
    }
}
