//! What was promised of this study and what was measured, one line each. A bar that is missed says so.

use sixaxis_core::Scheme;

use super::results::{Bar, Compound, Gravity, ParameterSet, Results, Standard};

/// Judges a study.
#[must_use]
pub fn judge(r: &Results) -> Vec<Bar> {
    let mut bars = Vec::new();
    let mut bar = |name: &str, value: f64, limit: f64, unit: &str, note: &str| {
        bars.push(Bar {
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
    let largest = |values: &mut dyn Iterator<Item = f64>| {
        values.fold(
            0.0_f64,
            |a, b| if b.is_nan() { f64::NAN } else { a.max(b.abs()) },
        )
    };
    bar(
        "Zero drift, noise-free",
        largest(&mut (0..9).map(|i| n.found.zero_drift_v[i] - n.truth.zero_drift_v[i])),
        1e-12,
        "V",
        "largest of nine",
    );
    bar(
        "Scale/mass, noise-free",
        largest(
            &mut (0..9)
                .map(|i| n.found.scale_per_mass_per_kg[i] / n.truth.scale_per_mass_per_kg[i] - 1.0),
        ),
        5e-6,
        "",
        "largest of nine, relative; step 2 neglects relative motion",
    );
    let (found, truth) = (
        n.found.inertia_per_mass.to_paper_order(),
        n.truth.inertia_per_mass.to_paper_order(),
    );
    bar(
        "Inertia/mass, noise-free",
        largest(&mut (0..6).map(|i| found[i] - truth[i])) / largest(&mut truth.iter().copied()),
        1e-4,
        "",
        "largest of six, over the largest entry",
    );
    let true_search = r
        .searches
        .iter()
        .find(|s| s.scale_error == Some(0.0) && !s.sign_as_printed)
        .map_or(f64::NAN, |s| s.grid_minimum_per_s2);
    bar(
        "k/m with true scale factors",
        (true_search / n.truth.stiffness_per_mass_per_s2 - 1.0).abs(),
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
        bar(
            &format!("Decoupling, identified, {name}"),
            worst(
                &r.compound_noise_free,
                ParameterSet::Identified,
                scheme,
                Standard::Truth,
            ),
            1e-5,
            "",
            note,
        );
        bar(
            &format!("Decoupling, steps 2-4 repeated, {name}"),
            worst(
                &r.compound_noise_free,
                ParameterSet::Repeated,
                scheme,
                Standard::Truth,
            ),
            1e-5,
            "",
            "the limbs' compliance kept",
        );
        bar(
            &format!("Decoupling, true parameters, {name}"),
            beyond_reference(&r.compound_noise_free, scheme),
            1e-6,
            "",
            "largest error beyond the reference's own, 18 cells",
        );
        bar(
            &format!("The same, axis level, {name}"),
            beyond_reference(&r.compound_axis_level, scheme),
            1e-6,
            "",
            "gravity turns in the shell",
        );
    }
    let lab = Scheme::HeunSubstepped;
    bar(
        "Laboratory, against the standard instruments",
        worst(
            &r.compound_laboratory,
            ParameterSet::Identified,
            lab,
            Standard::Instruments,
        ),
        0.01,
        "",
        "largest of 18 cells over the whole run",
    );
    bar(
        "Laboratory, against truth",
        worst(
            &r.compound_laboratory,
            ParameterSet::Identified,
            lab,
            Standard::Truth,
        ),
        0.013,
        "",
        "the instruments' class, 1 %, plus 0.3 %",
    );
    bar(
        "MuJoCo's static elongations",
        r.reference.static_elongation_relative,
        1e-9,
        "",
        "against an independent solve, over the largest",
    );
    for set in &r.reference.modes {
        bar(
            &format!("MuJoCo's six modes, {} sensor", set.sensor),
            largest(&mut (0..6).map(|i| set.measured_hz[i] / set.predicted_hz[i] - 1.0)),
            10e-6,
            "",
            "ring-down against eigenvalues, relative",
        );
    }
    bars
}

/// Largest error of a set of runs decoupled one way.
#[must_use]
pub fn worst(runs: &[Compound], set: ParameterSet, scheme: Scheme, against: Standard) -> f64 {
    cells(runs, set, scheme, against).fold(0.0, |a, (e, _)| a.max(e))
}

/// Largest error with true parameters less the reference's own, cell by cell.
fn beyond_reference(runs: &[Compound], scheme: Scheme) -> f64 {
    cells(runs, ParameterSet::True, scheme, Standard::Truth)
        .fold(0.0, |a, (error, reference)| a.max(error - reference))
}

fn cells(
    runs: &[Compound],
    set: ParameterSet,
    scheme: Scheme,
    against: Standard,
) -> impl Iterator<Item = (f64, f64)> {
    runs.iter().flat_map(move |run| {
        run.comparisons
            .iter()
            .filter(move |c| {
                let gravity = c.gravity == Gravity::Kept || set != ParameterSet::True;
                c.parameters == set && c.scheme == scheme && c.against == against && gravity
            })
            .flat_map(move |c| c.error.into_iter().zip(run.reference_error))
    })
}
