//! The acceptance limits of this study and what was measured, one line each. A limit that is missed says so.

use sixaxis_core::Scheme;

use super::results::{
    AcceptanceLimit, Compound, FOUR_STEPS, MEASURED, ParameterSet, Results, Standard, worst,
};

/// Judges a study.
#[must_use]
pub fn judge(r: &Results) -> Vec<AcceptanceLimit> {
    let mut limits = Vec::new();
    let mut limit = |name: &str, value: f64, limit: f64, unit: &str, note: &str| {
        limits.push(AcceptanceLimit {
            name: name.to_owned(),
            value,
            limit,
            unit: unit.to_owned(),
            // NaN is a miss.
            met: value <= limit,
            note: note.to_owned(),
        });
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
    let minimum = search.map_or(f64::NAN, |s| s.grid_minimum_per_s2);
    limit(
        "k/m with true scale factors",
        (minimum / n.truth.stiffness_per_mass_per_s2 - 1.0).abs(),
        1e-9,
        "",
        "distance of the grid minimum from the true grid point, relative",
    );
    for (scheme, note) in [
        (
            Scheme::Heun,
            "plain Heun at 10 kHz; see the order figure for why it cannot do better",
        ),
        (
            Scheme::HeunSubstepped,
            "Heun in 8 sub-steps per 10 kHz sample",
        ),
        (Scheme::AdamsMoulton4, "same samples, two evaluations each"),
    ] {
        let name = scheme.name();
        let noise_free = |set| worst(&r.compound_noise_free, (set, scheme, Standard::Truth));
        limit(
            &format!("Decoupling, identified, {name}"),
            noise_free(ParameterSet::Identified),
            1e-5,
            "",
            note,
        );
        limit(
            &format!("Decoupling, steps 2-4 repeated, {name}"),
            noise_free(ParameterSet::Repeated),
            1e-5,
            "",
            "the limbs' compliance kept",
        );
        limit(
            &format!("Decoupling, true parameters, {name}"),
            beyond_reference(&r.compound_noise_free, scheme),
            1e-6,
            "",
            "largest error beyond the reference's own, 18 cells",
        );
        limit(
            &format!("The same, axis level, {name}"),
            beyond_reference(&r.compound_axis_level, scheme),
            1e-6,
            "",
            "gravity turns in the shell",
        );
    }
    limit(
        "Laboratory, against the standard instruments",
        worst(&r.compound_laboratory, MEASURED),
        0.01,
        "",
        "largest of 18 cells over the whole run",
    );
    limit(
        "Laboratory, against truth",
        worst(&r.compound_laboratory, FOUR_STEPS),
        0.013,
        "",
        "the instruments' class, 1 %, plus 0.3 %",
    );
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
    limits
}

/// Largest magnitude; NaN if any value is.
fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    let larger = |a: f64, b: f64| {
        if a.is_nan() || b.is_nan() {
            f64::NAN
        } else {
            a.max(b.abs())
        }
    };
    values.into_iter().fold(0.0, larger)
}

/// Largest error with true parameters less the reference's own, cell by cell.
fn beyond_reference(runs: &[Compound], scheme: Scheme) -> f64 {
    let way = (ParameterSet::True, scheme, Standard::Truth);
    runs.iter()
        .filter_map(|run| Some((run.comparison(way)?.error, run.reference_error)))
        .flat_map(|(errors, references)| errors.into_iter().zip(references))
        .fold(0.0, |a, (error, reference)| a.max(error - reference))
}
