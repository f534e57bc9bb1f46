//! Plans that are refused, before anything is simulated.

use core::ops::RangeInclusive;

use super::defect::{Defect, Kind, Where};
use super::error::SessionError;
use super::plan::{CouplingChoice, DefectChoice, Engine, SessionPlan};
use super::schedule::{trial_count, trials};
use super::spoil::played;
use crate::geometry::LIMBS;

/// Rest before and after runs that need not make whole turns, s: many lags of a gyroscope.
const LEAST_REST_S: f64 = 0.3;
/// Samples of all trials together: what 16 GB of memory hold.
const MOST_SAMPLES: f64 = 5e7;
/// Samples of the static record.
const MOST_STATIC_SAMPLES: f64 = 1e8;
/// Fewest samples of a crank period.
const FEWEST_PER_PERIOD: f64 = 20.0;
/// Trials of a step: three directions at least.
const TRIALS_PER_STEP: RangeInclusive<usize> = 3..=1000;
/// Bits of a converter: a double has no more.
const MOST_BITS: f64 = 52.0;
/// Largest wedge error, degrees; a wedge that is further off is another wedge.
const LARGEST_WEDGE_ERROR_DEG: f64 = 20.0;
/// Largest tilt of the axis, degrees: beyond it the mounting is another one.
const LARGEST_TILT_DEG: f64 = 90.0;
/// Largest distance of the sensor's centre from the axis, mm.
const LARGEST_OFFSET_MM: f64 = 1e3;
/// Farthest that the mass's centre is from the cube's along an axis, mm: half an edge is 21.
const LARGEST_OFF_CENTRE_MM: f64 = 10.0;
/// Longest crank over its rod: a crank as long as the rod locks.
const LONGEST_CRANK: f64 = 0.95;
/// Amplitudes of the rig, m and rad, and the converter's limit, V, at most.
const LARGEST: f64 = 1e3;
/// Largest magnitude of a defect that is given exactly, over the largest that is drawn.
const LARGEST_OF_RANGE: f64 = 2.0;
/// Lateral stiffness and damping of a limb, and its mass, over the axial, critical and seismic ones at most.
const LARGEST_OF_LIMBS: f64 = 1.0;
/// Taps, at most.
const MOST_TAPS: usize = 100;
/// Periods of a run, and seconds of rest, at most.
const LONGEST: f64 = 1e6;

/// Refuses a plan that cannot be simulated.
///
/// # Errors
/// [`SessionError::Plan`] with the key.
pub fn check(plan: &SessionPlan) -> Result<(), SessionError> {
    positive(plan)?;
    rig(plan)?;
    chain(plan)?;
    limbs(plan)?;
    sizes(plan)?;
    if let DefectChoice::Exactly(defect) = &plan.defect {
        check_defect(plan, defect)?;
    }
    Ok(())
}

fn positive(plan: &SessionPlan) -> Result<(), SessionError> {
    for (key, value) in [
        ("sample_rate_hz", plan.sample_rate_hz),
        ("static_duration_s", plan.static_duration_s),
        ("static_rate_hz", plan.static_rate_hz),
        ("rig.slider_amplitude_m", plan.rig.slider_amplitude_m),
        (
            "rig.rotation_amplitude_rad",
            plan.rig.rotation_amplitude_rad,
        ),
        ("rig.low_band_hz", plan.rig.low_band_hz.0),
        ("rig.low_band_hz", plan.rig.low_band_hz.1),
        ("rig.high_band_hz", plan.rig.high_band_hz.0),
        ("rig.high_band_hz", plan.rig.high_band_hz.1),
        ("rig.ramp_periods", plan.rig.ramp_periods),
        ("chain.full_scale_v", plan.chain.full_scale_v),
        ("instruments.class_percent", plan.instruments.class_percent),
    ] {
        if !(value > 0.0 && value.is_finite()) {
            return Err(SessionError::plan(
                key,
                format!("{value} is not positive and finite"),
            ));
        }
    }
    Ok(())
}

fn within(key: &str, value: f64, range: RangeInclusive<f64>) -> Result<(), SessionError> {
    if range.contains(&value) {
        Ok(())
    } else {
        let (low, high) = range.into_inner();
        Err(SessionError::plan(
            key,
            format!("{value} is not between {low} and {high}"),
        ))
    }
}

/// A first-order corner that samples of this rate can show.
fn corner(key: &str, corner_hz: f64, sample_rate_hz: f64) -> Result<(), SessionError> {
    if corner_hz > 0.0 && corner_hz < 0.5 * sample_rate_hz {
        return Ok(());
    }
    Err(SessionError::plan(
        key,
        format!(
            "{corner_hz} is not between 0 and {}, half the sample rate of {sample_rate_hz} Hz",
            0.5 * sample_rate_hz
        ),
    ))
}

fn rig(plan: &SessionPlan) -> Result<(), SessionError> {
    let rig = &plan.rig;
    for (key, value, most) in [
        ("rig.slider_amplitude_m", rig.slider_amplitude_m, LARGEST),
        (
            "rig.rotation_amplitude_rad",
            rig.rotation_amplitude_rad,
            LARGEST,
        ),
        ("rig.rest_s", rig.rest_s, LONGEST),
        ("rig.ramp_periods", rig.ramp_periods, LONGEST),
        ("rig.steady_periods", rig.steady_periods, LONGEST),
        (
            "rig.wedge_error_deg",
            rig.wedge_error_deg,
            LARGEST_WEDGE_ERROR_DEG,
        ),
        ("rig.axis_tilt_deg", rig.axis_tilt_deg, LARGEST_TILT_DEG),
        (
            "rig.centre_offset_mm",
            rig.centre_offset_mm,
            LARGEST_OFFSET_MM,
        ),
        ("rig.crank_over_rod", rig.crank_over_rod, LONGEST_CRANK),
    ] {
        within(key, value, 0.0..=most)?;
    }
    if rig.taps > MOST_TAPS {
        let cause = format!("{} is more than {MOST_TAPS}", rig.taps);
        return Err(SessionError::plan("rig.taps", cause));
    }
    // The crank's own run has to come back to where it began, or to rest long enough that the gyroscope shows that it does not.
    let turns = rig.ramp_periods + rig.steady_periods;
    if turns.fract() != 0.0 && rig.rest_s < LEAST_REST_S {
        return Err(SessionError::plan(
            "rig.steady_periods",
            format!(
                "with rig.ramp_periods it makes {turns} turns; a run ends where it began only after whole ones, and one that ends elsewhere takes a rig.rest_s of {LEAST_REST_S} and more"
            ),
        ));
    }
    Ok(())
}

fn limbs(plan: &SessionPlan) -> Result<(), SessionError> {
    for along_mm in plan.mass_centre_mm {
        within(
            "mass_centre_mm",
            along_mm,
            -LARGEST_OFF_CENTRE_MM..=LARGEST_OFF_CENTRE_MM,
        )?;
    }
    within("rod_mass", plan.rod_mass, 0.0..=LARGEST_OF_LIMBS)?;
    for (key, value) in [
        ("limbs.lateral_stiffness", plan.limbs.lateral_stiffness),
        ("limbs.lateral_damping", plan.limbs.lateral_damping),
        ("limbs.mass", plan.limbs.mass),
    ] {
        within(key, value, 0.0..=LARGEST_OF_LIMBS)?;
        if value > 0.0 && plan.engine == Engine::Rigid {
            let cause = "limbs that do not give way have none of it; set engine = \"mujoco\"";
            return Err(SessionError::plan(key, cause));
        }
    }
    Ok(())
}

fn chain(plan: &SessionPlan) -> Result<(), SessionError> {
    let (chain, instruments) = (&plan.chain, &plan.instruments);
    for (key, value, most) in [
        (
            "chain.signal_to_noise_db",
            chain.signal_to_noise_db,
            f64::INFINITY,
        ),
        (
            "instruments.signal_to_noise_db",
            instruments.signal_to_noise_db,
            f64::INFINITY,
        ),
        ("chain.full_scale_v", chain.full_scale_v, LARGEST),
        (
            "chain.resolution_bits",
            f64::from(chain.resolution_bits),
            MOST_BITS,
        ),
        (
            "instruments.class_percent",
            instruments.class_percent,
            100.0,
        ),
        ("chain.stiffness_spread", chain.stiffness_spread, 1.0),
        ("chain.cross_talk", chain.cross_talk, 1.0),
        ("chain.hum_v", chain.hum_v, chain.full_scale_v),
        (
            "chain.zero_spread_v",
            chain.zero_spread_v,
            chain.full_scale_v,
        ),
        ("chain.sensitivity_drift", chain.sensitivity_drift, 1.0),
    ] {
        within(key, value, 0.0..=most)?;
    }
    for (key, corner_hz) in [
        (
            "instruments.gyroscope_bandwidth_hz",
            instruments.gyroscope_bandwidth_hz,
        ),
        ("chain.amplifier_high_pass_hz", chain.amplifier_high_pass_hz),
    ] {
        if corner_hz != 0.0 {
            corner(key, corner_hz, plan.sample_rate_hz)?;
        }
    }
    if chain.amplifier_high_pass_hz > 0.0 && chain.coupling == CouplingChoice::Ideal {
        return Err(SessionError::plan(
            "chain.amplifier_high_pass_hz",
            "a high-pass does not let the load at rest through; set chain.coupling = \"tared\"",
        ));
    }
    if chain.stiffness_spread > 0.0
        && let Some(limb) = plan.stiffness_ratio().iter().position(|r| *r <= 0.0)
    {
        return Err(SessionError::plan(
            "chain.stiffness_spread",
            format!(
                "with this seed it leaves limb {} no stiffness; make it smaller",
                limb + 1
            ),
        ));
    }
    Ok(())
}

fn sizes(plan: &SessionPlan) -> Result<(), SessionError> {
    if !TRIALS_PER_STEP.contains(&plan.trials_per_step) {
        return Err(SessionError::plan(
            "trials_per_step",
            format!(
                "{} is not between {} and {}",
                plan.trials_per_step,
                TRIALS_PER_STEP.start(),
                TRIALS_PER_STEP.end()
            ),
        ));
    }
    within(
        "static_duration_s",
        plan.static_duration_s * plan.static_rate_hz,
        2.0..=MOST_STATIC_SAMPLES,
    )
    .map_err(|_| {
        SessionError::plan(
            "static_duration_s",
            format!(
                "times static_rate_hz it makes {:.3e} samples; 2 to {MOST_STATIC_SAMPLES:.0e} are simulated",
                plan.static_duration_s * plan.static_rate_hz
            ),
        )
    })?;
    let mut samples = 0.0;
    for trial in trials(&plan.rig, plan.trials_per_step, None) {
        if plan.sample_rate_hz < FEWEST_PER_PERIOD * trial.run.frequency_hz {
            return Err(SessionError::plan(
                "sample_rate_hz",
                format!(
                    "{} is too slow for {} at {} Hz; at least {FEWEST_PER_PERIOD} samples a period are needed",
                    plan.sample_rate_hz, trial.name, trial.run.frequency_hz
                ),
            ));
        }
        samples += trial.run.duration_s() * plan.sample_rate_hz;
    }
    if samples > MOST_SAMPLES {
        return Err(SessionError::plan(
            "sample_rate_hz",
            format!(
                "all trials together have {samples:.3e} samples; {MOST_SAMPLES:.0e} at most are simulated"
            ),
        ));
    }
    Ok(())
}

/// A defect written down by hand, and the rig and chain that it makes.
fn check_defect(plan: &SessionPlan, defect: &Defect) -> Result<(), SessionError> {
    let below = |name: &str, index: usize, limit: usize| {
        if index < limit {
            Ok(())
        } else {
            Err(SessionError::plan(
                &format!("defect.exactly: {name}"),
                format!("{index} is not below {limit}; counting begins at 0"),
            ))
        }
    };
    let (size, key) = (defect.magnitude, "defect.exactly: magnitude");
    let facts = defect.kind.facts();
    let most = if facts.unit == "share" {
        1.0
    } else {
        LARGEST_OF_RANGE * facts.range.1
    };
    within(key, size, if facts.signed { -most } else { 0.0 }..=most)?;
    below("channel", defect.channel, LIMBS)?;
    if let Where::From(trial) | Where::Trial(trial) = defect.place {
        below("place", trial, trial_count(plan.trials_per_step))?;
    }
    let played = played(plan, Some(defect));
    // A gyroscope may be faster than its samples show: then it has no lag.
    let chain = |plan: &SessionPlan| match defect.kind {
        Kind::GyroscopeLag => Ok(()),
        _ => chain(plan),
    };
    rig(&played).and_then(|()| chain(&played)).map_err(|_| {
        SessionError::plan(
            key,
            format!("{size} makes a laboratory that cannot be played"),
        )
    })
}
