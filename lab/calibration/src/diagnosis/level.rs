//! Factors that all trials share, or all channels of one: units, sensitivities, gains.
//!
//! A piezo's scale factor is known to a factor of two before it is calibrated; an inertia follows from the drawing. Whatever is further off than those is no sensor but a mistake in writing.

use sixaxis_core::LIMBS;

use super::table::Table;
use super::trial_case::{Facts, TrialCase};
use crate::finding::{Cause, Finding};
use crate::series::median;
use sixaxis_recordings::unit::STANDARD_GRAVITY_M_S2;

/// Largest factor by which all scale factors together may differ from the design's.
const COMMON: f64 = 2.2;
/// Largest factor by which one may differ from what the others make of the design.
const SINGLE: f64 = 3.5;
/// Largest relative departure of the inertias, all together, from the design's.
const INERTIA: f64 = 0.35;

/// Factor about a thousand that is still one: sensors of a kind differ by a third.
const THOUSAND: f64 = 1.4;

/// Whether a factor is a thousand, within what a sensor may differ.
pub fn is_thousand(factor: f64) -> bool {
    let size = factor.abs();
    (1e3 / THOUSAND..=1e3 * THOUSAND).contains(&size.max(1.0 / size))
}

/// The factor in words.
pub(super) fn factor_in_words(factor: f64) -> String {
    if factor.abs() >= 1.0 {
        format!("{factor:.3} times")
    } else {
        format!("1/{:.3} of", 1.0 / factor)
    }
}

/// What a factor is a sign of.
pub fn cause_of(factor: f64) -> Cause {
    if is_thousand(factor) {
        Cause::MillivoltMixUp
    } else {
        Cause::WrongScaling
    }
}

/// What a factor on one channel of one recording is a sign of, and what to check there.
pub fn of_one_channel(factor: f64) -> (Cause, &'static str) {
    if (factor + 1.0).abs() < 0.1 {
        (
            Cause::InvertedChannel,
            "check the channel's polarity in this recording",
        )
    } else if is_thousand(factor) {
        (
            Cause::MillivoltMixUp,
            "check the channel's unit in this recording",
        )
    } else if factor.abs() < 0.03 {
        (
            Cause::DeadLimb,
            "check the channel's cable in this recording",
        )
    } else {
        (
            Cause::WrongScaling,
            "check the channel's gain_n_per_v in this recording against the amplifier's panel",
        )
    }
}

/// Factors that two ways of writing one thing are apart, and what these are.
const KNOWN: [(f64, &str); 6] = [
    (57.29578, "degrees and radians are that far apart"),
    (10.0, "a decade of an amplifier's range, or a lost digit"),
    (100.0, "a decade of an amplifier's range, or a lost digit"),
    (2.0, "a step of an amplifier's range"),
    (2.5, "a step of an amplifier's range"),
    (5.0, "a step of an amplifier's range"),
];
const OF_ACCELERATIONS: (f64, &str) = (
    STANDARD_GRAVITY_M_S2,
    "g and m/s² are that far apart, or a digit is lost",
);
const OF_RATES: (f64, &str) = (9.549_297, "rad/s and turns a minute are that far apart");

/// What a factor of this size usually is.
pub(super) fn reason(factor: f64) -> &'static str {
    nearest(factor, OF_ACCELERATIONS)
}

/// The same of a gyroscope's.
pub(super) fn reason_of_a_rate(factor: f64) -> &'static str {
    nearest(factor, OF_RATES)
}

/// The nearest of what is known, if it is within what standards and sensors differ.
fn nearest(factor: f64, own: (f64, &'static str)) -> &'static str {
    if is_thousand(factor) {
        return "volts and millivolts are that far apart";
    }
    let away = |known: f64| (factor.abs().ln().abs() - known.ln()).abs();
    let all = KNOWN.into_iter().chain([own]);
    let near = all.filter(|(known, _)| away(*known) < 0.08);
    near.min_by(|a, b| away(a.0).total_cmp(&away(b.0))).map_or(
        "check gains, sensitivities and units against the certificates and the amplifier's panel",
        |(_, words)| words,
    )
}

/// What one channel's factor is a sign of. A voltage of the usual size says that the written gain is wrong. A channel of little voltage
/// has lost its signal in the limb, in its cable or by the amplifier's range: which of these, no recording says.
fn of_a_channel(factor: f64, over_usual_gain: f64) -> Cause {
    if factor > 1.0 && factor * over_usual_gain > SINGLE {
        Cause::Unexplained
    } else {
        cause_of(factor)
    }
}

/// The channels' gains over the usual one of the day, which is their median.
fn over_usual_gain(cases: &[TrialCase<'_>]) -> [f64; LIMBS] {
    let over = |case: &TrialCase<'_>, channel: usize| {
        let gains = case.trial.gains.gain_n_per_v.map(f64::abs);
        gains[channel] / median(gains).unwrap_or(1.0)
    };
    core::array::from_fn(|channel| {
        median(cases.iter().map(|case| over(case, channel))).unwrap_or(1.0)
    })
}

/// Looks at all factors.
pub fn examine(
    table: &Table,
    facts: &Facts<'_>,
    cases: &[TrialCase<'_>],
    findings: &mut Vec<Finding>,
) {
    let silent = &table.silent;
    // A wrong clock makes wrong accelerations, and so does a wrong standard.
    let mut found = findings.iter().any(|finding| {
        matches!(
            finding.cause,
            Cause::ClockMismatch | Cause::WrongScaling | Cause::MillivoltMixUp
        )
    });
    let design = &facts.design.scale_per_mass_per_kg;
    let ratio: [f64; LIMBS] =
        core::array::from_fn(|channel| 1.0 / (table.mass_over_scale_kg[channel] * design[channel]));
    let heard = (0..LIMBS).filter(|i| !silent[*i]);
    let common = median(heard.map(|i| ratio[i].abs())).unwrap_or(1.0);
    if !found && !(1.0 / COMMON..=COMMON).contains(&common) {
        found = true;
        let evidence = format!(
            "all scale factors come out at {} the design's; {}",
            factor_in_words(common),
            reason(common)
        );
        let advice = "check the unit of the limbs' channels, gain_n_per_v, the accelerometer's sensitivity and scale_per_mass_per_kg in [sensor.design]";
        findings.push(Finding::new(cause_of(common), evidence, advice));
    }
    let over_usual_gain = over_usual_gain(cases);
    for channel in 0..LIMBS {
        let own = ratio[channel].abs() / common;
        if silent[channel] || (1.0 / SINGLE..=SINGLE).contains(&own) {
            continue;
        }
        found = true;
        let cause = of_a_channel(own, over_usual_gain[channel]);
        let evidence = format!(
            "its scale factor comes out at {} what the other channels make of the design; {}",
            factor_in_words(own),
            reason(own)
        );
        let advice = format!(
            "check unit, gain, cable and piezo of channel {}",
            channel + 1
        );
        findings.push(Finding::new(cause, evidence, advice).on_channels([channel]));
    }
    if let Some(inertia) = table.inertia_m2
        && !found
    {
        let trace = inertia.x_axis.x + inertia.y_axis.y + inertia.z_axis.z;
        let design = facts.design.inertia_per_mass;
        let expected = design.xx_m2 + design.yy_m2 + design.zz_m2;
        let off = trace / expected;
        if off < 0.0 {
            findings.push(Finding::new(
                Cause::InvertedChannel,
                "the inertias come out negative: the standard gyroscope turns the other way than the angular trials' directions say",
                "turn the gyroscope round, or the sign of its column in the files; if it is right, turn the directions of the angular \
                 trials round",
            ));
        } else if (off - 1.0).abs() > INERTIA {
            // Nothing has been found of either standard: where the rig was there to tell, both are right.
            let rig = facts.rig;
            let by_the_rig = rig.and_then(|rig| rig.stroke_mm.zip(rig.rotation_amplitude_deg));
            let (cause, why, advice) = match by_the_rig {
                Some(_) => (
                    Cause::Unexplained,
                    "by the rig's stroke and rotation both standards are right",
                    "compare all channels' gain_n_per_v in the angular trials with those in the linear ones and with the amplifier's ranges, then half_edge_mm, limb_length_mm and the design's inertia_per_mass_mm2 with the sensor's drawing",
                ),
                None => (
                    cause_of(off),
                    reason(off),
                    "check unit and sensitivity of accelerometer and gyroscope, and of the sensor half_edge_mm and the design's inertia_per_mass_mm2",
                ),
            };
            let evidence = format!(
                "the inertias come out at {} the design's, which the drawing fixes far better; {why}",
                factor_in_words(off)
            );
            findings.push(Finding::new(cause, evidence, advice));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inv_a_thousand_is_not_any_large_factor() {
        for factor in [1000.0, -1e-3, 750.0, 1.0 / 1350.0] {
            assert_eq!(cause_of(factor), Cause::MillivoltMixUp, "{factor}");
        }
        for factor in [573.0, 1.0 / 1673.0, 98.0665, 1e4, 1.0, 0.0, f64::NAN] {
            assert_eq!(cause_of(factor), Cause::WrongScaling, "{factor}");
        }
    }
}
