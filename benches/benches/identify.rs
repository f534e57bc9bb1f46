//! Steps 2, 3 and 4 on noise-free recordings: rows in, parameters out, and one candidate of the k/m search.

use std::hint::black_box;

use criterion::{Criterion, SamplingMode, Throughput, criterion_group, criterion_main};
use sixaxis_benches::{MEASUREMENT_TIME, SAMPLE_SIZE, WARM_UP_TIME, pseudo_inverse, validate};
use sixaxis_core::identify::stiffness::{paper_grid, rate_norm_sum};
use sixaxis_core::identify::stiffness_search::{Trial, rate_norm_sums};
use sixaxis_core::{Parameters, Scheme};
use sixaxis_props::problem::recorded::{InertiaRows, ScaleRows, stiffness_run, true_parameters};
use sixaxis_props::tolerance::SEARCH_BY_DECODING;

/// Samples of the long problems: 300,000 rows, ten seconds at 10 kHz.
const LONG_SAMPLES: usize = 100_000;

/// The rows of a few runs over and over, until there are [`LONG_SAMPLES`] samples.
fn long<T: Clone>(rows: &[T]) -> Vec<T> {
    rows.iter().cycle().take(LONG_SAMPLES).cloned().collect()
}

/// Step 2: samples of three pure linear runs at 2 Hz.
fn scale(criterion: &mut Criterion) {
    let short = ScaleRows::play();
    let long = ScaleRows(long(&short.0));
    for (name, problem) in [
        ("identify/scale/linear_2hz", short),
        ("identify/scale/300k_rows", long),
    ] {
        validate::require(
            &format!("{name}/householder"),
            validate::scale_per_mass(&problem.solve().estimate.values),
        );
        validate::require(
            &format!("{name}/nalgebra"),
            validate::scale_per_mass(&pseudo_inverse::scale_per_mass(&problem)),
        );
        let mut group = criterion.benchmark_group(name);
        group.sampling_mode(SamplingMode::Flat);
        group.throughput(Throughput::Elements(problem.0.len() as u64));
        group.bench_function("householder", |bencher| {
            bencher.iter(|| black_box(&problem).solve());
        });
        group.bench_function("nalgebra", |bencher| {
            bencher.iter(|| pseudo_inverse::scale_per_mass(black_box(&problem)));
        });
        group.finish();
    }
}

/// Step 3: samples of three pure angular runs at 2 Hz.
fn inertia(criterion: &mut Criterion) {
    let short = InertiaRows::play();
    let long = InertiaRows(long(&short.0));
    for (name, problem) in [
        ("identify/inertia/angular_2hz", short),
        ("identify/inertia/300k_rows", long),
    ] {
        validate::require(
            &format!("{name}/householder"),
            validate::inertia_per_mass(&problem.solve().estimate.values),
        );
        validate::require(
            &format!("{name}/nalgebra"),
            validate::inertia_per_mass(&pseudo_inverse::inertia_per_mass(&problem)),
        );
        let mut group = criterion.benchmark_group(name);
        group.sampling_mode(SamplingMode::Flat);
        group.throughput(Throughput::Elements(problem.0.len() as u64));
        group.bench_function("householder", |bencher| {
            bencher.iter(|| black_box(&problem).solve());
        });
        group.bench_function("nalgebra", |bencher| {
            bencher.iter(|| pseudo_inverse::inertia_per_mass(black_box(&problem)));
        });
        group.finish();
    }
}

/// Step 4: mean |w*| of one pure linear run at 5 Hz for one candidate.
fn stiffness(criterion: &mut Criterion) {
    let problem = stiffness_run();
    let voltage_v = &problem.recording.voltage_v;
    let (sensor, settings) = (problem.sensor(), problem.settings(Scheme::Heun));
    let core = |parameters: &Parameters| {
        rate_norm_sum(&sensor, parameters, &settings, voltage_v).expect("a recorded run")
    };
    let paper = |parameters: &Parameters| problem.paper_rate_norm_sum(parameters);
    let decoupled = voltage_v.len() - 2;
    validate::require(
        "identify/stiffness/one_candidate/heun",
        validate::stiffness(decoupled, core),
    );
    validate::require(
        "identify/stiffness/one_candidate/paper",
        validate::stiffness(decoupled, paper),
    );
    let candidate = true_parameters();
    let mut group = criterion.benchmark_group("identify/stiffness/one_candidate");
    group.sampling_mode(SamplingMode::Flat);
    group.throughput(Throughput::Elements(voltage_v.len() as u64));
    group.bench_function("heun", |bencher| {
        bencher.iter(|| core(black_box(&candidate)));
    });
    group.bench_function("paper", |bencher| {
        bencher.iter(|| paper(black_box(&candidate)));
    });
    group.finish();
}

/// Step 4's whole curve, 91 candidates: a few decodes and an interpolation beside one decode each.
fn search(criterion: &mut Criterion) {
    let problem = stiffness_run();
    let voltage_v = &problem.recording.voltage_v;
    let (sensor, settings) = (problem.sensor(), problem.settings(Scheme::Heun));
    let trial = Trial {
        sensor: &sensor,
        settings: &settings,
        voltage_v,
    };
    let (parameters, grid) = (true_parameters(), paper_grid().collect::<Vec<f64>>());
    // As the search pairs them.
    let trials = [trial; 2];
    let interpolated = || {
        rate_norm_sums(&parameters, &trials, &grid)
            .expect("a recorded run")
            .sums
    };
    let decoded = || -> Vec<f64> {
        let sum = |k: &f64| {
            let mut candidate = parameters;
            candidate.stiffness_per_mass_per_s2 = *k;
            let one = |t: &Trial| rate_norm_sum(t.sensor, &candidate, t.settings, t.voltage_v);
            trials
                .iter()
                .map(|t| one(t).expect("a recorded run").0)
                .sum()
        };
        grid.iter().map(sum).collect()
    };
    let (ours, theirs) = (interpolated(), decoded());
    let least = |sums: &[f64]| (0..sums.len()).min_by(|&a, &b| sums[a].total_cmp(&sums[b]));
    assert_eq!(least(&ours), least(&theirs), "the grid point");
    let largest = theirs.iter().copied().fold(0.0, f64::max);
    let pairs = ours.iter().zip(&theirs);
    let error = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / largest;
    assert!(
        SEARCH_BY_DECODING.allows(error),
        "sums of |w*| over the largest: {error:e}"
    );

    let mut group = criterion.benchmark_group("identify/stiffness/search");
    group.sampling_mode(SamplingMode::Flat);
    group.throughput(Throughput::Elements(
        (grid.len() * trials.len() * voltage_v.len()) as u64,
    ));
    group.sample_size(10);
    group.bench_function("interpolated", |bencher| {
        bencher.iter(|| black_box(interpolated()));
    });
    group.bench_function("decoded", |bencher| {
        bencher.iter(|| black_box(decoded()));
    });
    group.finish();
}

criterion_group! {
    name = identify;
    config = Criterion::default()
        .without_plots()
        .warm_up_time(WARM_UP_TIME)
        .measurement_time(MEASUREMENT_TIME)
        .sample_size(SAMPLE_SIZE);
    targets = scale, inertia, stiffness, search
}
criterion_main!(identify);
