//! The standard instruments on the rig, and what is known of the rig itself.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Standard accelerometer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Accelerometer {
    /// Sensitivity, mV/g: needed only where its channel is in volts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sensitivity_mv_per_g: Option<f64>,
    /// Largest error that its certificate allows, %.
    pub class_percent: f64,
    /// Largest error of its sensitivity alone, %, where the certificate says so; every value within is as likely. Left out: the
    /// class.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gain_percent: Option<f64>,
    /// First-order bandwidth, Hz, whose lag is undone. Left out: it follows at once.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bandwidth_hz: Option<f64>,
    /// Delay, ms, the same at every frequency, that is undone: of a digital filter, or what a filter of higher order does far below its
    /// corner. Left out: none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub delay_ms: Option<f64>,
}

/// Standard gyroscope.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Gyroscope {
    /// Sensitivity, mV/(deg/s): needed only where its channel is in volts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sensitivity_mv_per_deg_s: Option<f64>,
    /// Largest error that its certificate allows, %.
    pub class_percent: f64,
    /// Largest error of its sensitivity alone, %, where the certificate says so; every value within is as likely. Left out: the
    /// class.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gain_percent: Option<f64>,
    /// First-order bandwidth, Hz, whose lag is undone. Left out: it follows at once.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bandwidth_hz: Option<f64>,
    /// Delay, ms, the same at every frequency, that is undone: of a digital filter, or what a filter of higher order does far below its
    /// corner. Left out: none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub delay_ms: Option<f64>,
}

/// What is known of the rig.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Rig {
    /// Stroke of the slider, twice its amplitude, mm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stroke_mm: Option<f64>,
    /// Rotation amplitude of the pinion, degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rotation_amplitude_deg: Option<f64>,
    /// Standard deviation of each of the two angles by which a wedge misses its direction, degrees. Left out: 0.1. The joint
    /// estimator finds the angles themselves.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wedge_deg: Option<f64>,
    /// Acceleration of free fall where the rig stands, m/s^2, to 0.01 %. Left out: 9.80665, from which places differ by up to 0.3 %, so that
    /// gravity, where it turns in the sensor, says no more of the accelerometer's gain than that.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gravity_m_s2: Option<f64>,
}
