//! The acceptance limits of this study and what was measured, one line each. A limit that is missed says so.
//!
//! A scheme is held to its own order: p means that half the sample rate has 2^p times the error. What the paper's four steps
//! leave, and what instruments of a class do in one laboratory, are findings and not faults of this code: aims.

use sixaxis_core::Scheme;
use sixaxis_props::compare::worse;
use sixaxis_reference::rig::run::Mounting;

use super::compound::SCHEMES;
use super::results::{
    AcceptanceLimit, Compound, Correction, LimitKind, ParameterSet, Results, Standard, Way,
    substepped, worst,
};

/// Largest error of a scheme beyond the reference's own, over the peak, that needs no order to be allowed.
const SCHEME: f64 = 1e-6;
/// How far above the half rate's error over 2^p an error may lie: terms of higher order.
const ABOVE_ORDER: f64 = 1.25;
/// Largest error of the four steps, over the peak, where the limbs' compliance is kept.
const STEPS: f64 = 1e-5;

/// Judges a study.
pub fn judge(r: &Results) -> Vec<AcceptanceLimit> {
    let mut limits = Vec::new();
    let mut judged = |kind, name: &str, value: f64, limit: f64, unit: &str, note: &str| {
        limits.push(AcceptanceLimit {
            kind,
            name: name.to_owned(),
            value,
            limit,
            unit: unit.to_owned(),
            // NaN is a miss.
            met: value <= limit,
            note: note.to_owned(),
        });
    };
    let mut limit = |name: &str, value: f64, limit: f64, unit: &str, note: &str| {
        judged(LimitKind::Required, name, value, limit, unit, note);
    };
    let n = &r.noise_free;
    let (found_s, true_s) = (n.found.scale_per_mass_per_kg, n.truth.scale_per_mass_per_kg);
    let (found_inertia, true_inertia) = (
        n.found.inertia_per_mass.to_paper_order(),
        n.truth.inertia_per_mass.to_paper_order(),
    );
    limit(
        "Zero drift, noise-free",
        largest((0..9).map(|i| n.found.zero_drift_v[i] - n.truth.zero_drift_v[i])),
        1e-12,
        "V",
        "largest of nine",
    );
    limit(
        "Scale/mass, noise-free",
        largest((0..9).map(|i| found_s[i] / true_s[i] - 1.0)),
        5e-6,
        "",
        "largest of nine, relative; step 2 neglects relative motion",
    );
    limit(
        "Inertia/mass, noise-free",
        largest((0..6).map(|i| found_inertia[i] - true_inertia[i])) / largest(true_inertia),
        1e-4,
        "",
        "largest of six, over the largest entry",
    );
    let mut searches = r.searches.iter();
    let search = searches.find(|s| s.scale_error == Some(0.0) && !s.sign_as_printed);
    let minimum = search.map_or(f64::NAN, |s| s.interpolated_per_s2);
    limit(
        "k/m with true scale factors",
        (minimum / n.truth.stiffness_per_mass_per_s2 - 1.0).abs(),
        1e-4,
        "",
        "distance of the minimum, between candidates that are 5 % apart, from the truth, relative",
    );
    for scheme in SCHEMES {
        let name = scheme.name();
        let mountings = [
            (Mounting::AxisVertical, "vertical", &r.compound_noise_free),
            (Mounting::AxisLevel, "level", &r.compound_axis_level),
        ];
        let mut of_order = SCHEME;
        for (mounting, axis, runs) in mountings {
            let half_rate: Vec<Compound> = (r.compound_half_rate.iter())
                .filter(|run| run.mounting == mounting)
                .cloned()
                .collect();
            let half_rate = beyond_reference(&half_rate, scheme);
            let scaled = ABOVE_ORDER * half_rate / 2.0_f64.powi(scheme.order() as i32);
            of_order = of_order.max(scaled);
            limit(
                &format!("Decoupling, true parameters, axis {axis}, {name}"),
                beyond_reference(runs, scheme),
                SCHEME.max(scaled),
                "",
                &format!(
                    "largest of 18 cells beyond the reference's own; a scheme of order {}",
                    scheme.order()
                ),
            );
        }
        let way = of_scheme(ParameterSet::Repeated, scheme);
        limit(
            &format!("Decoupling, steps 2-4 repeated, {name}"),
            worst(&r.compound_noise_free, way),
            STEPS.max(SCHEME + of_order),
            "",
            "the limbs' compliance kept",
        );
    }
    limit(
        "MuJoCo's static elongations",
        r.reference.static_elongation_relative,
        1e-9,
        "",
        "against an independent solve, over the largest",
    );
    for set in &r.reference.modes {
        limit(
            &format!("MuJoCo's six modes, {} sensor", set.sensor),
            largest((0..6).map(|i| set.measured_hz[i] / set.predicted_hz[i] - 1.0)),
            10e-6,
            "",
            "ring-down against eigenvalues, relative",
        );
    }
    let mut aim = |name: &str, value, limit, note| {
        judged(LimitKind::Aim, name, value, limit, "", note);
    };
    for scheme in SCHEMES {
        let way = of_scheme(ParameterSet::Identified, scheme);
        aim(
            &format!("Decoupling, four steps as printed, {}", scheme.name()),
            worst(&r.compound_noise_free, way),
            STEPS,
            "step 2 treats the limbs as rigid; the scheme adds its own",
        );
    }
    for (correction, treated, note) in [
        (
            Correction::OpenLoop,
            "open loop",
            "largest of 18 cells over the whole run; this seed's instruments and noise",
        ),
        (
            Correction::RestToRest,
            "corrected",
            "the same, from rest to rest; the correction is no part of the paper's method",
        ),
    ] {
        // The instruments' class; against truth 0.3 % more.
        for (standard, against, limit) in [
            (
                Standard::Instruments,
                "against the standard instruments",
                0.01,
            ),
            (Standard::Truth, "against truth", 0.013),
        ] {
            let way = substepped(ParameterSet::Identified, correction, standard);
            let name = format!("This laboratory, {treated}, {against}");
            aim(&name, worst(&r.compound_laboratory, way), limit, note);
        }
    }
    limits
}

/// Largest magnitude; NaN of nothing, and if any value is.
pub(super) fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    let magnitudes = values.into_iter().map(f64::abs);
    magnitudes.reduce(worse).unwrap_or(f64::NAN)
}

/// Noise-free, open loop, against truth.
fn of_scheme(parameters: ParameterSet, scheme: Scheme) -> Way {
    (parameters, scheme, Correction::OpenLoop, Standard::Truth)
}

/// Largest error with true parameters less the reference's own, cell by cell; NaN where one was not compared.
fn beyond_reference(runs: &[Compound], scheme: Scheme) -> f64 {
    let way = of_scheme(ParameterSet::True, scheme);
    let beyond = |(error, reference): (f64, f64)| match error - reference {
        within if within < 0.0 => 0.0,
        beyond => beyond,
    };
    largest(runs.iter().flat_map(|run| {
        let cells = run.error(way).into_iter().zip(run.reference_error);
        cells.map(beyond)
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::results::{Comparison, Gravity};

    fn compared(error: f64, reference_error: f64, parameters: &[ParameterSet]) -> Compound {
        let (_, scheme, correction, against) = of_scheme(ParameterSet::True, Scheme::Heun);
        Compound {
            table: 4,
            frequency_hz: 2.0,
            mounting: Mounting::AxisVertical,
            sample_rate_hz: 1000.0,
            peak: [1.0; 6],
            amplitude: [1.0; 6],
            comparisons: parameters
                .iter()
                .map(|parameters| Comparison {
                    parameters: *parameters,
                    scheme,
                    gravity: Gravity::Kept,
                    correction,
                    against,
                    error: [error; 6],
                })
                .collect(),
            reference_error: [reference_error; 6],
        }
    }

    #[test]
    fn what_nobody_compared_meets_no_limit() {
        let way = of_scheme(ParameterSet::True, Scheme::Heun);
        let there = compared(3e-6, 1e-6, &[ParameterSet::True]);
        let missing = compared(3e-6, 1e-6, &[ParameterSet::Identified]);
        let unknown = compared(3e-6, f64::NAN, &[ParameterSet::True]);
        let both = [there.clone(), missing.clone()];
        assert_eq!(worst(core::slice::from_ref(&there), way), 3e-6);
        assert_eq!(beyond_reference(&[there], Scheme::Heun), 3e-6 - 1e-6);
        for runs in [&both[..], &[missing], &[]] {
            assert!(worst(runs, way).is_nan());
            assert!(beyond_reference(runs, Scheme::Heun).is_nan());
        }
        assert!(beyond_reference(&[unknown], Scheme::Heun).is_nan());
        // Less than the reference's own error is none.
        let within = compared(1e-7, 1e-6, &[ParameterSet::True]);
        assert_eq!(beyond_reference(&[within], Scheme::Heun), 0.0);
    }
}
