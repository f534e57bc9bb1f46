//! What the truth costs: one Runge-Kutta step of the driven sensor beside MuJoCo's own.
//!
//! `driven` prescribes the shell's motion at each of the four stages and reads the snapshot; `mj_step` is MuJoCo's own
//! Runge-Kutta step of the same two bodies and nine limbs with nobody driving, `mj_forward` one evaluation of its
//! dynamics, of which either step takes four. The three do not do the same work; the ratio of `driven` to `mj_step` is
//! the price of the drive.

use std::hint::black_box;

use criterion::{Criterion, SamplingMode, Throughput, criterion_group, criterion_main};
use glam::DVec3;
use sixaxis_benches::free_sensor::FreeSensor;
use sixaxis_benches::{MEASUREMENT_TIME, SAMPLE_SIZE, WARM_UP_TIME, validate};
use sixaxis_props::problem::recorded::{self as problem, STEP_S};
use sixaxis_props::tolerance::{DRIVEN, FORWARD, FREE_FALL};
use sixaxis_reference::motion::Motion;
use sixaxis_reference::mujoco::simulation::{Simulation, Snapshot};
use sixaxis_reference::rig::run::Run;

/// Steps of the free fall that `mj_step` is held to.
const FALL_STEPS: u32 = 200;

/// One step of the run that repeats for ever: a run ends at rest where it began.
fn step(simulation: &mut Simulation, run: &Run, count: &mut u64, steps: u64) -> Snapshot {
    simulation.set_time_s((*count % steps) as f64 * STEP_S);
    *count += 1;
    simulation.step(run).expect("a step of a bench's problem")
}

fn sensor(criterion: &mut Criterion) {
    let run = &problem::compound_5_hz();
    let steps = (run.duration_s() / STEP_S).round() as u64;
    let mut simulation = problem::simulation(run);
    let mut count = 0;
    let (linear, angular): (Vec<(DVec3, DVec3)>, Vec<_>) = (0..steps)
        .map(|_| {
            let now = step(&mut simulation, run, &mut count, steps);
            let (a, w_dot) = run.acceleration(now.time_s);
            (
                (now.shell_acceleration_ground_m_s2, a),
                (now.shell_angular_acceleration_shell_rad_s2, w_dot),
            )
        })
        .unzip();
    for pairs in [linear, angular] {
        validate::require(
            "reference/step/driven",
            validate::accelerations(
                "acceleration of the driven shell over its peak",
                DRIVEN,
                &pairs,
            ),
        );
    }
    let mut forward = FreeSensor::new(run);
    for pair in forward.accelerations() {
        validate::require(
            "reference/step/mj_forward",
            validate::accelerations(
                "acceleration of the displaced mass, relative",
                FORWARD,
                &[pair],
            ),
        );
    }
    let mut free = FreeSensor::new(run);
    validate::require(
        "reference/step/mj_step",
        validate::accelerations(
            "fall of the centre of mass, relative",
            FREE_FALL,
            &[free.fall(FALL_STEPS)],
        ),
    );

    let mut group = criterion.benchmark_group("reference/step");
    group.sampling_mode(SamplingMode::Flat);
    group.throughput(Throughput::Elements(1));
    group.bench_function("driven", |bencher| {
        bencher.iter(|| black_box(step(&mut simulation, black_box(run), &mut count, steps)));
    });
    group.bench_function("mj_step", |bencher| {
        bencher.iter(|| black_box(&mut free).data.step());
    });
    group.bench_function("mj_forward", |bencher| {
        bencher.iter(|| black_box(&mut forward).data.forward());
    });
    group.finish();
}

criterion_group! {
    name = reference;
    config = Criterion::default()
        .without_plots()
        .warm_up_time(WARM_UP_TIME)
        .measurement_time(MEASUREMENT_TIME)
        .sample_size(SAMPLE_SIZE);
    targets = sensor
}
criterion_main!(reference);
