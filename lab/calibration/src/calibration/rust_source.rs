//! The calibration as a Rust source: constants that a firmware takes in as a module.

use std::fmt::{Display, Write as _};
use std::path::Path;

use sixaxis_core::LIMBS;
use sixaxis_recordings::draft::write_atomically;

use super::Calibration;
use crate::error::Result;

impl Calibration {
    /// Writes [`Self::rust_source`], whole or not at all.
    ///
    /// # Errors
    /// [`crate::Error::Recording`].
    pub fn write_rust(&self, path: &Path) -> Result<()> {
        Ok(write_atomically(path, self.rust_source().as_bytes())?)
    }

    /// What a decoupler is prepared with, as constants of the types of `sixaxis-core`; literals read back as the same f64. The
    /// provenance stands in comments. A NaN or infinity does not compile.
    pub fn rust_source(&self) -> String {
        let p = &self.parameters;
        let provenance = &self.provenance;
        let mut comments = format!(
            "// Calibration of the parallel six-axis accelerometer {:?}: {}.\n\
             // Written by `sixaxis calibrate --format rust`, version {}; needs the crate sixaxis-core. From the recordings\n",
            self.sensor.serial,
            self.verdict.word(),
            in_comment(&provenance.sixaxis_version),
        );
        for (name, bytes) in &provenance.recordings {
            let _ = writeln!(comments, "//   {}, {bytes} bytes", in_comment(name));
        }
        comments += "// by the session file\n";
        for line in provenance.session.lines() {
            let _ = writeln!(comments, "//   {}", in_comment(line));
        }
        format!(
            "{comments}
/// Serial number or name of the sensor.
pub const SERIAL: &str = {serial:?};

/// The judgement of the calibration: \"good\", \"good with reservations\" or \"not good\".
pub const VERDICT: &str = {verdict:?};

/// Lengths from the drawing, m, and gains c_i of the session's default amplifier ranges, N/V, in which nothing need have been recorded:
/// `sixaxis_core::Sensor {{ gains, ..SENSOR }}` has those of the range that is measured in.
pub const SENSOR: sixaxis_core::Sensor = sixaxis_core::Sensor {{
    geometry: sixaxis_core::Geometry {{
        limb_length_m: {limb_length_m:?},
        half_edge_m: {half_edge_m:?},
    }},
    gains: sixaxis_core::Gains {{
        gain_n_per_v: {gain_n_per_v},
    }},
}};

/// The 25 parameters: zero drifts d_i, V; scale factors s_i/m, 1/kg; inertias I1 to I6 over m (xx, yy, zz, xy, xz, yz), m^2;
/// stiffness k/m, 1/s^2.
pub const PARAMETERS: sixaxis_core::Parameters = sixaxis_core::Parameters {{
    zero_drift_v: {zero_drift_v},
    scale_per_mass_per_kg: {scale_per_mass_per_kg},
    inertia_per_mass: sixaxis_core::InertiaPerMass::from_paper_order({inertia_per_mass_m2}),
    stiffness_per_mass_per_s2: {stiffness_per_mass_per_s2:?},
}};

/// From the cube's centre to that of its mass, sensor axes, m; half a limb's mass over the seismic mass; and share of each limb's force
/// (column) that each channel (row) shows: what `sixaxis_core::CrossTalk` undoes before the decoupler, and `ROD_MASS` is
/// `sixaxis_core::Settings::rod_mass` besides.
pub const MASS_CENTRE_M: [f64; 3] = {mass_centre_m:?};
pub const ROD_MASS: f64 = {rod_mass:?};
pub const CROSS_TALK: [[f64; {LIMBS}]; {LIMBS}] = {cross_talk:?};

/// Stiffness of each limb over their mean: `sixaxis_core::Settings::stiffness_ratio`, by which limbs that are excluded bear their share.
pub const STIFFNESS_RATIO: [f64; {LIMBS}] = {stiffness_ratio:?};

/// Limit of the converter, V.
pub const FULL_SCALE_V: f64 = {full_scale_v:?};

/// Corner of the amplifiers' first-order high-pass, Hz, which must be undone before the decoupler; none for amplifiers that pass
/// a constant.
pub const AMPLIFIER_HIGH_PASS_HZ: Option<f64> = {amplifier_high_pass_hz:?};

/// Lag of each limb's channel, us, which must be undone before the decoupler, where there is any.
pub const LIMBS_LAG_US: Option<[f64; {LIMBS}]> = {limbs_lag_us:?};
",
            serial = self.sensor.serial,
            verdict = self.verdict.word(),
            limb_length_m = self.sensor.limb_length_m,
            half_edge_m = self.sensor.half_edge_m,
            gain_n_per_v = array(&self.sensor.gain_n_per_v),
            zero_drift_v = array(&p.zero_drift_v),
            scale_per_mass_per_kg = array(&p.scale_per_mass_per_kg),
            inertia_per_mass_m2 = array(&p.inertia_per_mass_m2),
            stiffness_per_mass_per_s2 = p.stiffness_per_mass_per_s2,
            mass_centre_m = self
                .limbs
                .as_ref()
                .map_or([0.0; 3], |limbs| limbs.mass_centre_m),
            rod_mass = self.limbs.as_ref().map_or(0.0, |limbs| limbs.rod_mass),
            cross_talk = self
                .limbs
                .as_ref()
                .map_or([[0.0; LIMBS]; LIMBS], |limbs| limbs.cross_talk),
            stiffness_ratio = self
                .limbs
                .as_ref()
                .map_or([1.0; LIMBS], |limbs| limbs.stiffness_ratio),
            full_scale_v = self.sensor.full_scale_v,
            amplifier_high_pass_hz = self.sensor.amplifier_high_pass_hz,
            limbs_lag_us = self.channels.limbs_lag_us.map(|lag| lag.each()),
        )
    }
}

/// An array literal, a number a line.
fn array(values: &[f64]) -> String {
    let lines = values.iter().map(|value| format!("        {value:?},\n"));
    format!("[\n{}    ]", lines.collect::<String>())
}

/// Text that ends no comment and turns no line around. Quotes need no escape there.
fn in_comment(text: &str) -> impl Display {
    text.chars()
        .map(|c| match c {
            '"' | '\'' | '\\' => c.to_string(),
            _ => c.escape_debug().to_string(),
        })
        .collect::<String>()
}
