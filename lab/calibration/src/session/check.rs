//! What a session file cannot say, told with its line and key before any recording is opened.

use glam::DVec3;
use sixaxis_core::Gains;
use sixaxis_core::dsp::butterworth;
use sixaxis_core::dsp::differentiate::Differentiator;

use super::{Channels, Entry, PerLimb, Role, SessionFile, Stage};
use crate::error::Result;
use crate::unit;

/// Angle by which a wedge may be said to miss its direction, degrees: beyond half a right angle it is another axis' wedge.
const WEDGE_LIMIT_DEG: f64 = 45.0;

impl SessionFile {
    pub(super) fn check(&self) -> Result<()> {
        let session = &self.session;
        let positive = |key: &str, value: f64| {
            if value > 0.0 && value.is_finite() {
                Ok(())
            } else {
                Err(self.refuse(key, format!("{value} is not positive and finite")))
            }
        };
        let sensor = &session.sensor;
        for (key, value) in [
            ("sensor.limb_length_mm", sensor.limb_length_mm),
            ("sensor.half_edge_mm", sensor.half_edge_mm),
            ("sensor.full_scale_v", sensor.full_scale_v),
            (
                "accelerometer.class_percent",
                session.accelerometer.class_percent,
            ),
            ("gyroscope.class_percent", session.gyroscope.class_percent),
            (
                "limits.validation_percent",
                session.limits.validation_percent,
            ),
            ("limits.hold_out_percent", session.limits.hold_out_percent),
            ("limits.interval_percent", session.limits.interval_percent),
        ] {
            positive(key, value)?;
        }
        for (key, value) in [
            (
                "accelerometer.sensitivity_mv_per_g",
                session.accelerometer.sensitivity_mv_per_g,
            ),
            (
                "accelerometer.bandwidth_hz",
                session.accelerometer.bandwidth_hz,
            ),
            (
                "gyroscope.sensitivity_mv_per_deg_s",
                session.gyroscope.sensitivity_mv_per_deg_s,
            ),
            ("gyroscope.bandwidth_hz", session.gyroscope.bandwidth_hz),
            (
                "rig.stroke_mm",
                session.rig.as_ref().and_then(|r| r.stroke_mm),
            ),
            (
                "rig.rotation_amplitude_deg",
                session.rig.as_ref().and_then(|r| r.rotation_amplitude_deg),
            ),
            (
                "preprocessing.amplifier_high_pass_hz",
                session.preprocessing.amplifier_high_pass_hz,
            ),
        ] {
            if let Some(value) = value {
                positive(key, value)?;
            }
        }
        self.check_what_limits_the_standards()?;
        self.check_gains("sensor.gain_n_per_v", &sensor.gain_n_per_v)?;
        self.geometry()
            .validate()
            .map_err(|e| self.refuse("sensor.limb_length_mm", e.to_string()))?;
        self.design()
            .validate()
            .map_err(|e| self.refuse("sensor.design", e.to_string()))?;
        for (key, switch) in [
            (
                "preprocessing.outliers",
                matches!(session.preprocessing.outliers, Stage::Switch(true)),
            ),
            (
                "preprocessing.detrend",
                matches!(session.preprocessing.detrend, Stage::Switch(true)),
            ),
            (
                "preprocessing.low_pass",
                matches!(session.preprocessing.low_pass, Stage::Switch(true)),
            ),
        ] {
            if switch {
                return Err(self.refuse(
                    key,
                    "`true` says nothing: give its settings, or `false` to switch it off",
                ));
            }
        }
        self.check_stages()?;
        self.check_units("channels", &session.channels)?;
        if session.recording.is_empty() {
            return Err(self.refuse("recording", "no recording at all"));
        }
        for (i, entry) in session.recording.iter().enumerate() {
            self.check_entry(&format!("recording[{i}]"), entry)?;
        }
        Ok(())
    }

    /// Parts of a certificate lie within the whole; a wedge that is off by as much as it tilts is no wedge.
    fn check_what_limits_the_standards(&self) -> Result<()> {
        let (accelerometer, gyroscope) = (&self.session.accelerometer, &self.session.gyroscope);
        for (key, gain, class) in [
            (
                "accelerometer.gain_percent",
                accelerometer.gain_percent,
                accelerometer.class_percent,
            ),
            (
                "gyroscope.gain_percent",
                gyroscope.gain_percent,
                gyroscope.class_percent,
            ),
        ] {
            let Some(gain) = gain else { continue };
            if !(gain > 0.0 && gain <= class) {
                let cause = format!(
                    "{gain}: must be positive and not above class_percent, {class}, of which it is a part"
                );
                return Err(self.refuse(key, cause));
            }
        }
        if let Some(wedge) = self.session.rig.as_ref().and_then(|rig| rig.wedge_deg)
            && !(0.0..WEDGE_LIMIT_DEG).contains(&wedge)
        {
            let cause = format!("{wedge}: must be from 0 to below {WEDGE_LIMIT_DEG}");
            return Err(self.refuse("rig.wedge_deg", cause));
        }
        Ok(())
    }

    fn check_stages(&self) -> Result<()> {
        let stages = &self.session.preprocessing;
        let not_negative = |key: &str, value: f64| {
            if value >= 0.0 && value.is_finite() {
                Ok(())
            } else {
                Err(self.refuse(key, format!("{value}: must be finite and not negative")))
            }
        };
        if let Stage::On(low_pass) = &stages.low_pass {
            if !(1..=butterworth::MAX_ORDER).contains(&low_pass.order) {
                let cause = format!("{}: from 1 to {}", low_pass.order, butterworth::MAX_ORDER);
                return Err(self.refuse("preprocessing.low_pass.order", cause));
            }
            not_negative("preprocessing.low_pass.times_drive", low_pass.times_drive)?;
            not_negative("preprocessing.low_pass.plus_hz", low_pass.plus_hz)?;
            if low_pass.times_drive + low_pass.plus_hz == 0.0 {
                return Err(self.refuse(
                    "preprocessing.low_pass",
                    "a corner of 0 Hz lets nothing through",
                ));
            }
        }
        if let Stage::On(detrend) = &stages.detrend {
            not_negative("preprocessing.detrend.rest_s", detrend.rest_s)?;
        }
        if let Stage::On(outliers) = &stages.outliers {
            not_negative("preprocessing.outliers.sigmas", outliers.sigmas)?;
        }
        let settings = stages.differentiator;
        Differentiator::new(settings.half_width, settings.order, 1.0)
            .map(|_| ())
            .map_err(|e| self.refuse("preprocessing.differentiator", e.to_string()))
    }

    fn check_entry(&self, key: &str, entry: &Entry) -> Result<()> {
        for (name, vector) in [("direction", entry.direction), ("down", entry.down)] {
            if let Some(v) = vector {
                let length = DVec3::from_array(v).length();
                if !(length.is_finite() && length > 1e-6) {
                    return Err(
                        self.refuse(&format!("{key}.{name}"), format!("{v:?} has no direction"))
                    );
                }
            }
        }
        if !matches!(entry.role, Role::Static | Role::Tap) {
            for (name, missing) in [
                ("direction", entry.direction.is_none()),
                ("frequency_hz", entry.frequency_hz.is_none()),
            ] {
                if missing {
                    return Err(self.refuse(
                        &format!("{key}.{name}"),
                        format!(
                            "missing; a recording of role \"{}\" needs it",
                            entry.role.name()
                        ),
                    ));
                }
            }
        }
        for (name, value) in [
            ("frequency_hz", entry.frequency_hz),
            ("sample_rate_hz", entry.sample_rate_hz),
            ("reference_sample_rate_hz", entry.reference_sample_rate_hz),
        ] {
            if let Some(value) = value
                && !(value > 0.0 && value.is_finite())
            {
                return Err(self.refuse(
                    &format!("{key}.{name}"),
                    format!("{value} is not positive and finite"),
                ));
            }
        }
        if let Some(gains) = &entry.gain_n_per_v {
            self.check_gains(&format!("{key}.gain_n_per_v"), gains)?;
        }
        if let Some(channels) = &entry.channels {
            self.check_units(&format!("{key}.channels"), channels)?;
        }
        Ok(())
    }

    fn check_gains(&self, key: &str, gains: &PerLimb) -> Result<()> {
        Gains {
            gain_n_per_v: gains.each(),
        }
        .validate()
        .map_err(|e| self.refuse(key, e.to_string()))
    }

    fn check_units(&self, key: &str, channels: &Channels) -> Result<()> {
        for (name, unit) in [
            ("limbs_unit", &channels.limbs_unit),
            ("accelerometer_unit", &channels.accelerometer_unit),
            ("gyroscope_unit", &channels.gyroscope_unit),
        ] {
            if let Some(unit) = unit
                && unit::named(unit).is_none()
            {
                return Err(self.refuse(
                    &format!("{key}.{name}"),
                    format!("{unit:?} is not a unit that is known; known are V, mV, m/s^2, g, rad/s, deg/s"),
                ));
            }
        }
        let mut names: Vec<&String> = channels.limbs.iter().collect();
        names.sort_unstable();
        if let Some(pair) = names.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(self.refuse(
                &format!("{key}.limbs"),
                format!("{:?} stands there twice", pair[0]),
            ));
        }
        Ok(())
    }
}
