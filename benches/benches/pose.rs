//! Nine limb lengths to the pose of the mass in the shell, along a compound run at 5 Hz.

use std::hint::black_box;

use criterion::{Criterion, SamplingMode, Throughput, criterion_group, criterion_main};
use glam::DVec3;
use sixaxis_benches::gauss_newton::GaussNewton;
use sixaxis_benches::{MEASUREMENT_TIME, SAMPLE_SIZE, WARM_UP_TIME, validate};
use sixaxis_core::paper::pose::Pose;
use sixaxis_core::{Geometry, LIMBS};
use sixaxis_props::problem::recorded::{self as problem, Poses};

/// The core: closed form at each node, then the rotation's fit.
fn closed_form(elongation_m: &[[f64; LIMBS]], mut sink: impl FnMut(&Pose)) {
    for nine in elongation_m {
        sink(&Pose::from_elongations(&Geometry::PAPER, nine).expect("limbs that meet"));
    }
}

/// Gauss-Newton from the last sample's pose.
fn gauss_newton(
    geometry: &GaussNewton,
    elongation_m: &[[f64; LIMBS]],
    mut sink: impl FnMut(&Pose),
) {
    let mut pose = Pose::default();
    for nine in elongation_m {
        pose = geometry.pose(nine, pose);
        sink(&pose);
    }
}

fn compound(criterion: &mut Criterion) {
    let problem = Poses::play(&problem::compound_5_hz());
    let elongation_m = &problem.elongation_m;
    let geometry = GaussNewton::new(&Geometry::PAPER);

    let mut answers: Vec<(DVec3, DVec3)> = Vec::new();
    closed_form(elongation_m, |pose| {
        answers.push((pose.position_shell_m, pose.rotation_rad));
    });
    validate::require(
        "pose/compound_5hz/closed_form",
        validate::poses(&problem.truth, &answers),
    );
    answers.clear();
    gauss_newton(&geometry, elongation_m, |pose| {
        answers.push((pose.position_shell_m, pose.rotation_rad));
    });
    validate::require(
        "pose/compound_5hz/nalgebra",
        validate::poses(&problem.truth, &answers),
    );

    let mut group = criterion.benchmark_group("pose/compound_5hz");
    group.sampling_mode(SamplingMode::Flat);
    group.throughput(Throughput::Elements(elongation_m.len() as u64));
    group.bench_function("closed_form", |bencher| {
        bencher.iter(|| {
            closed_form(black_box(elongation_m), |pose| {
                black_box(pose);
            });
        });
    });
    group.bench_function("nalgebra", |bencher| {
        bencher.iter(|| {
            gauss_newton(black_box(&geometry), black_box(elongation_m), |pose| {
                black_box(pose);
            });
        });
    });
    group.finish();
}

criterion_group! {
    name = pose;
    config = Criterion::default()
        .without_plots()
        .warm_up_time(WARM_UP_TIME)
        .measurement_time(MEASUREMENT_TIME)
        .sample_size(SAMPLE_SIZE);
    targets = compound
}
criterion_main!(pose);
