//! What aids leave open just before the next of them comes, when it is most: the steady state of the Riccati equation, for a sensor that
//! stands still. Right after one less is open: of the tilt next to nothing less where an aid tells little against what the
//! rest before told, nearly all where it tells much.

use glam::DVec3;

use super::aid::Aid;
use super::block::Block;
use super::filter::ErrorFilter;
use crate::decouple::uncertainty::{ChannelNoise, Covariance};
use crate::error::Result;
use crate::limb_set::LimbSet;
use crate::model::{Parameters, Sensor, Settings};
use crate::six_axis::SixAxis;

/// Blocks from one aid to the next, and the longest of them, s.
const BLOCKS: f64 = 4.0;
const LONGEST_S: f64 = 0.05;
/// Error of down that it begins with, rad: where it ends does not depend on it.
const BEGIN_RAD: f64 = 0.01;
/// Change over a time as long as all before it, relative, from which on the state is steady.
const STEADY: f64 = 0.01;
/// First time at which it may be steady, and blocks after which it is not.
const FIRST_S: f64 = 4.0;
const MOST: u32 = 100_000;

/// Standard deviations that are left, each the root of the sum over the two directions across the plumb line: what turns about it
/// shows in fixes of the attitude alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bound {
    /// Of down in the sensor, rad.
    pub tilt_rad: f64,
    /// Of the rate across the plumb line, rad/s.
    pub rate_rad_s: f64,
}

impl Bound {
    /// What a filter has now, the sensor's attitude being this one's.
    #[must_use]
    pub fn now(filter: &ErrorFilter, sample: &SixAxis, down_ground: DVec3) -> Self {
        Self {
            tilt_rad: filter.tilt_rad(down_ground),
            rate_rad_s: filter.rate_across_rad_s(sample.attitude.inverse() * down_ground),
        }
    }
}

/// Steady state under aids, each with the time from one to the next, s: the calibration exact, its channels' noise white, those of the
/// excluded limbs not read. Nothing where
/// the deviations grow for ever: without an aid, without gravity, or with the velocity of a sensor without weight.
///
/// # Errors
/// Those of [`ErrorFilter::new`] and [`ErrorFilter::set_excluded`].
pub fn steady(
    sensor: &Sensor,
    parameters: &Parameters,
    settings: &Settings,
    noise: &ChannelNoise,
    excluded: LimbSet,
    aids: &[(Aid, f64)],
) -> Result<Option<Bound>> {
    let down = settings.gravity_ground_m_s2.normalize_or_zero();
    let shortest = aids
        .iter()
        .map(|(_, every_s)| *every_s)
        .fold(f64::INFINITY, f64::min);
    if down == DVec3::ZERO || !(shortest > 0.0 && shortest.is_finite()) {
        return Ok(None);
    }
    let exact = Covariance::zeros();
    let mut filter = ErrorFilter::new(sensor, parameters, settings, &exact, noise, BEGIN_RAD)?;
    filter.set_excluded(excluded)?;
    let step_s = (shortest / BLOCKS).min(LONGEST_S);
    let still = SixAxis::still(settings.initial_attitude);
    let block = Block {
        duration_s: step_s,
        voltage_v: parameters.zero_drift_v,
        rate_shell_rad_s: DVec3::ZERO,
        angular_ground_rad_s2: DVec3::ZERO,
        attitude: settings.initial_attitude,
    };
    let (mut before, mut looked_s) = (Bound::now(&filter, &still, down), 0.5 * FIRST_S);
    for number in 1..=MOST {
        filter.advance(&block);
        let time_s = f64::from(number) * step_s;
        let now = Bound::now(&filter, &still, down);
        for (aid, every_s) in aids {
            // Due where a multiple of its time has gone by.
            if (time_s / every_s) as u64 == ((time_s - step_s) / every_s) as u64 {
                continue;
            }
            let nothing_new = aid.against(&still, DVec3::ZERO, down).into_iter().flatten();
            for mut measurement in nothing_new {
                measurement.decoded_less_measured.fill(0.0);
                filter.take(&measurement);
            }
        }
        if time_s >= 2.0 * looked_s {
            let near = |a: f64, b: f64| (a - b).abs() <= STEADY * b;
            if near(now.tilt_rad, before.tilt_rad) && near(now.rate_rad_s, before.rate_rad_s) {
                return Ok(Some(now));
            }
            (before, looked_s) = (now, time_s);
        }
    }
    Ok(None)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{SENSOR, parameters};
    use crate::float::sqrt;
    use crate::geometry::LIMBS;
    use crate::paper::signal::SignalChain;

    /// Rate, tilt and velocity are three integrators in a row. Driven by white noise and seen at their end in white noise, they have
    /// Butterworth's three poles, w0^6 = drive / noise, and variances 2 w0^5, 3 w0^3, 2 w0 times that noise.
    #[test]
    fn inv_the_steady_state_is_butterworths() {
        let (sensor, parameters) = (SENSOR, parameters());
        let g = 9.81;
        let settings = Settings {
            gravity_ground_m_s2: DVec3::new(0.0, 0.0, -g),
            ..Settings::new(1000.0)
        };
        let white_v = 1e-3;
        let noise = ChannelNoise::white([white_v; LIMBS]);
        // Fixes close to one another are white noise of this density.
        let (every_s, deviation_m_s) = (0.01, 0.5);
        let aid = Aid::Velocity { deviation_m_s };
        let none = LimbSet::EMPTY;
        let found = steady(
            &sensor,
            &parameters,
            &settings,
            &noise,
            none,
            &[(aid, every_s)],
        )
        .expect("a sound sensor")
        .expect("a steady state");
        let chain = SignalChain::new(&sensor.gains, &parameters);
        let inverse = parameters.inertia_per_mass.matrix_mass_m2().inverse();
        let arms = sensor.geometry.arms_m();
        let [mut about_x, mut about_y] = [0.0; 2];
        for (limb, s) in chain.sensitivity_m_s2_per_v().iter().enumerate() {
            let alpha = inverse * arms[limb] * *s * white_v;
            about_x += alpha.x * alpha.x / settings.sample_rate_hz;
            about_y += alpha.y * alpha.y / settings.sample_rate_hz;
        }
        let seen = deviation_m_s * deviation_m_s * every_s;
        let of = |drive: f64| {
            let w0 = (g * g * drive / seen).powf(1.0 / 6.0);
            [
                2.0 * w0.powi(5) * seen / (g * g),
                3.0 * w0.powi(3) * seen / (g * g),
            ]
        };
        let [x, y] = [of(about_x), of(about_y)];
        let (rate, tilt) = (sqrt(x[0] + y[0]), sqrt(x[1] + y[1]));
        assert!(
            (found.rate_rad_s / rate - 1.0).abs() < 0.03,
            "{found:?} {rate}"
        );
        assert!(
            (found.tilt_rad / tilt - 1.0).abs() < 0.03,
            "{found:?} {tilt}"
        );
    }

    #[test]
    fn inv_nothing_holds_without_aids_or_weight() {
        let (sensor, parameters) = (SENSOR, parameters());
        let noise = ChannelNoise::white([1e-3; LIMBS]);
        let aid = Aid::Velocity { deviation_m_s: 0.1 };
        let of = |gravity: DVec3, aids: &[(Aid, f64)]| {
            let settings = Settings {
                gravity_ground_m_s2: gravity,
                ..Settings::new(1000.0)
            };
            let none = LimbSet::EMPTY;
            steady(&sensor, &parameters, &settings, &noise, none, aids).expect("a sound sensor")
        };
        assert_eq!(of(DVec3::NEG_Z * 9.81, &[]), None);
        assert_eq!(of(DVec3::ZERO, &[(aid, 1.0)]), None);
    }
}
