//! The propagation of errors against campaigns drawn at random: `cargo run --release -p sixaxis-props --example propagation`.
//!
//! Three sets of campaigns: noise alone; gains and wedges, too; a hundredth of all of it. Prints the 25 parameters' standard deviations,
//! closed form and drawn, and how near the accelerations of six compound runs come, sample by sample; with `--publish`
//! writes them for the report. `--count N` and `--first SEED` change the campaigns.

use std::process::ExitCode;

use sixaxis_calibration::propagation::Sources;
use sixaxis_core::Parameter;
use sixaxis_core::decouple::uncertainty::parameters::standard_deviations;
use sixaxis_props::propagation::monte_carlo::{
    AXES, ClosedForm, Tally, correlations, departures, run_departure,
};
use sixaxis_props::propagation::{Size, World, calibrate};
use sixaxis_props::publication::{Seeds, run};
use sixaxis_props::results::{
    Band, Propagation, PropagationAxis, PropagationParameter, PropagationRun, PropagationSet,
};

/// Edges of the bands, rad.
const EDGES_RAD: [f64; 6] = [0.01, 0.03, 0.1, 0.3, 1.0, 3.0];
/// Sample rate, trials a step, samples at rest.
const SIZE: Size = Size {
    rate_hz: 250.0,
    per_step: 6,
    static_samples: 256,
};
/// The share in the third set.
const SMALL: f64 = 0.01;

fn by_attitude(closed: &ClosedForm, drawn: &[Vec<[f64; AXES]>]) -> Vec<Band> {
    let mut from = 0.0;
    EDGES_RAD
        .into_iter()
        .map(|below_rad| {
            let (mut largest, mut squares, mut values) = (0.0_f64, 0.0, 0);
            let ours = closed.accelerations.iter().flatten();
            let attitudes = closed.attitude_rad.iter().flatten();
            for ((a, b), attitude) in ours.zip(drawn.iter().flatten()).zip(attitudes) {
                if (from..below_rad).contains(attitude) {
                    for axis in 0..AXES {
                        let departure = a[axis] / b[axis] - 1.0;
                        largest = largest.max(departure.abs());
                        squares += departure * departure;
                        values += 1;
                    }
                }
            }
            from = below_rad;
            Band {
                below_rad,
                values,
                largest_departure: largest,
                rms_departure: (squares / values.max(1) as f64).sqrt(),
            }
        })
        .collect()
}

/// Points of a run's curve that are published, about.
const POINTS: usize = 40;

/// As many points as a figure shows, four digits of each.
fn thinned(values: impl ExactSizeIterator<Item = f64>) -> Vec<f64> {
    let stride = values.len().div_ceil(POINTS).max(1);
    let round = |x: f64| format!("{x:.3e}").parse().unwrap_or(x);
    values.step_by(stride).map(round).collect()
}

const NAMES: [&str; AXES] = ["a_x", "a_y", "a_z", "alpha_x", "alpha_y", "alpha_z"];

fn set(world: &World, sources: &Sources, what: &str, first: u64, draws: u64) -> PropagationSet {
    let closed = ClosedForm::of(world, sources, first);
    let tally = Tally::draw(world, sources, first + 1, draws);
    let drawn = tally.covariance();
    let total = closed.propagated.total();
    let departures = departures(&total, &drawn);
    let value = calibrate(&world.clean);
    let deviations = [
        &total,
        &closed.propagated.noise,
        &closed.propagated.standards,
        &closed.propagated.wedges,
        &drawn,
    ]
    .map(standard_deviations);
    println!("\n{what}: {draws} campaigns");
    println!(
        "{:<6} {:>11} {:>11} {:>11} {:>8} {:>10} {:>10} {:>10}",
        "", "value", "closed form", "drawn", "ratio", "noise", "standards", "wedges"
    );
    let mut parameters = Vec::new();
    for parameter in Parameter::all().map(Parameter::estimated) {
        let i = parameter.place();
        let [all, noise, standards, wedges, drawn] = deviations.map(|sd| sd[i]);
        println!(
            "{:<6} {:>11.4e} {all:>11.4e} {drawn:>11.4e} {:>8.4} {noise:>10.2e} {standards:>10.2e} {wedges:>10.2e}",
            parameter.to_string(),
            value[i],
            departures[i] + 1.0
        );
        parameters.push(PropagationParameter {
            parameter,
            unit: parameter.unit().to_owned(),
            value: value[i],
            closed_form: all,
            of_noise: noise,
            of_standards: standards,
            of_wedges: wedges,
            drawn,
            ratio: departures[i] + 1.0,
        });
    }
    let largest = |values: &[f64]| values.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    let correlation = (correlations(&total) - correlations(&drawn)).abs().max();
    println!(
        "largest departure {:.2} %, of a correlation {correlation:.3}",
        100.0 * largest(&departures)
    );
    let accelerations = tally.accelerations();
    let attitude = by_attitude(&closed, &accelerations);
    for band in &attitude {
        println!(
            "attitude known to less than {:>5} rad: departure at most {:6.2} %, rms {:5.2} %, {} values",
            band.below_rad,
            100.0 * band.largest_departure,
            100.0 * band.rms_departure,
            band.values
        );
    }
    let runs = world
        .compound
        .iter()
        .zip(closed.accelerations.iter().zip(&accelerations))
        .map(|(trial, (ours, drawn))| {
            let axes: Vec<PropagationAxis> = (0..AXES)
                .map(|axis| {
                    let [largest, rms] = run_departure(ours, drawn, axis);
                    PropagationAxis {
                        name: NAMES[axis].to_owned(),
                        largest_departure: largest,
                        rms_departure: rms,
                        closed_form: thinned(ours.iter().map(|s| s[axis])),
                        drawn: thinned(drawn.iter().map(|s| s[axis])),
                    }
                })
                .collect();
            let percent = |of: fn(&PropagationAxis) -> f64| {
                axes.iter()
                    .map(|axis| format!("{:6.2}", 100.0 * of(axis)))
                    .collect::<String>()
            };
            println!(
                "{} Hz, {}: largest departure{} %, rms{} %",
                trial.frequency_hz,
                if trial.gravity_turns() {
                    "level  "
                } else {
                    "upright"
                },
                percent(|a| a.largest_departure),
                percent(|a| a.rms_departure),
            );
            PropagationRun {
                frequency_hz: trial.frequency_hz,
                gravity_turns: trial.gravity_turns(),
                samples: ours.len(),
                time_s: thinned((0..ours.len()).map(|i| (i + 1) as f64 / trial.sample_rate_hz)),
                axes,
            }
        })
        .collect();
    PropagationSet {
        sources: what.to_owned(),
        parameters,
        largest_departure: largest(&departures),
        largest_correlation_error: correlation,
        by_attitude: attitude,
        runs,
    }
}

fn main() -> ExitCode {
    let (first, count) = (1, 20_000);
    run(
        Seeds {
            first,
            count,
            sample: 50,
        },
        study,
    )
}

fn study(first: u64, draws: u64) -> Result<Propagation, String> {
    println!(
        "seeds {first} (closed form), {} to {}",
        first + 1,
        first + draws
    );
    let world = World::play(SIZE);
    let small = world.times(SMALL);
    Ok(Propagation {
        draws,
        first_seed: first,
        sample_rate_hz: SIZE.rate_hz,
        trials_per_step: SIZE.per_step,
        drawn_to: 1.0 / (2.0 * draws as f64).sqrt(),
        sets: vec![
            set(&world, &world.noise_alone(), "noise alone", first, draws),
            set(
                &world,
                &world.sources,
                "noise, gains and wedges",
                first,
                draws,
            ),
            set(
                &small,
                &small.sources,
                "a hundredth of all of it",
                first,
                draws,
            ),
        ],
    })
}
