//! Nine voltages to six accelerations: a whole compound run at 5 Hz, 10 kHz.
//!
//! `decouple/full` takes one sample at a time, `decouple/record` the run as it lies there, and
//! `decouple/lanes` eight such runs at once; throughput is in samples, of all streams together. The time of
//! the paper's decoder, which is the oracle, stands beside in the same run; `benches/peers` has other tools.

use std::array::from_fn;
use std::hint::black_box;

use criterion::measurement::WallTime;
use criterion::{
    BenchmarkGroup, Criterion, SamplingMode, Throughput, criterion_group, criterion_main,
};
use glam::DVec3;
use sixaxis_benches::{MEASUREMENT_TIME, SAMPLE_SIZE, WARM_UP_TIME, validate};
use sixaxis_core::decouple::lanes::push_lanes;
use sixaxis_core::kernel::simd::LANES;
use sixaxis_core::six_axis::{Accelerations, SixAxisColumns};
use sixaxis_core::{Decoupler, LIMBS, Scheme, SixAxis};
use sixaxis_props::problem::recorded::{self as problem, DECOUPLE_RATE_HZ, Recorded};
use sixaxis_props::tolerance::{DecoupledRun, PAPER_COMPOUND, PAPER_TUMBLE, Tolerance};

fn name(scheme: Scheme) -> &'static str {
    match scheme {
        Scheme::Euler => "euler",
        Scheme::Heun => "heun",
        Scheme::HeunSubstepped => "heun_substepped",
        Scheme::AdamsBashforth2 => "ab2",
        Scheme::AdamsMoulton4 => "am4",
        Scheme::RungeKutta4 => "rk4",
    }
}

const SOUND: &str = "samples of a recorded run";

fn core_answers(problem: &Recorded, scheme: Scheme) -> Vec<SixAxis> {
    let mut answers = Vec::new();
    let voltage_v = &problem.recording.voltage_v;
    let mut decoupler = problem.decoupler(scheme);
    let sink = |sample: &SixAxis| answers.push(*sample);
    decoupler.push_all(voltage_v, sink).expect(SOUND);
    answers
}

/// What is timed sample by sample: a whole recording through a copy of `ready`.
fn push_each(ready: &Decoupler, voltage_v: &[[f64; LIMBS]]) {
    let mut decoupler = black_box(ready).clone();
    let sink = |sample: &SixAxis| {
        black_box(sample);
    };
    decoupler.push_all(voltage_v, sink).expect(SOUND);
}

fn paper_answers(problem: &Recorded) -> Vec<SixAxis> {
    let mut answers = Vec::new();
    let voltage_v = &problem.recording.voltage_v;
    let mut decoder = problem.paper_decoder(&problem::true_parameters());
    let sink = |sample: &SixAxis| answers.push(*sample);
    decoder.push_all(voltage_v, sink).expect(SOUND);
    answers
}

/// Holds accelerations of consecutive samples, the first of which is `first`, to the truth.
fn require_accelerations(
    name: &str,
    problem: &Recorded,
    first: usize,
    answers: &[Accelerations],
    limits: [Tolerance; 2],
) {
    let truth = &problem.truth[first..];
    assert_eq!(answers.len(), truth.len() - 1, "{name}: samples");
    let [linear, angular]: [Vec<(DVec3, DVec3)>; 2] = [0, 3].map(|half| {
        let ours = answers
            .iter()
            .map(|a| DVec3::from_slice(&a[half..half + 3]));
        let pairs = ours.zip(truth);
        pairs
            .map(|(ours, t)| match half {
                0 => (ours, t.linear_ground_m_s2),
                _ => (ours, t.angular_ground_rad_s2),
            })
            .collect()
    });
    let what = [
        "linear acceleration over its peak",
        "angular acceleration over its peak",
    ];
    for ((what, limit), pairs) in what.into_iter().zip(limits).zip([linear, angular]) {
        validate::require(name, validate::accelerations(what, limit, &pairs));
    }
}

fn group<'a>(
    criterion: &'a mut Criterion,
    name: &str,
    samples: usize,
) -> BenchmarkGroup<'a, WallTime> {
    let mut group = criterion.benchmark_group(name);
    group.sampling_mode(SamplingMode::Flat);
    group.throughput(Throughput::Elements(samples as u64));
    group
}

fn full(criterion: &mut Criterion) {
    let compound = Recorded::play(&problem::compound_5_hz(), DECOUPLE_RATE_HZ);
    // Not timed: the rig's axis is fixed, and what a turning axis would show must not be wrong unseen.
    let tumble = Recorded::tumble();
    let require = |name: &str, problem: &Recorded, answers: &[SixAxis], limits: &DecoupledRun| {
        validate::require(name, validate::decoupled(&problem.truth, answers, limits));
    };
    for scheme in Scheme::ALL {
        for (run, problem, limits) in [
            ("", &compound, DecoupledRun::compound(scheme)),
            (" on the tumble", &tumble, DecoupledRun::tumble(scheme)),
        ] {
            let name = format!("decouple/full/{}{run}", name(scheme));
            require(&name, problem, &core_answers(problem, scheme), &limits);
        }
    }
    for (run, problem, limits) in [
        ("", &compound, PAPER_COMPOUND),
        (" on the tumble", &tumble, PAPER_TUMBLE),
    ] {
        let name = format!("decouple/full/paper{run}");
        require(&name, problem, &paper_answers(problem), &limits);
    }

    let voltage_v = &compound.recording.voltage_v;
    let mut group = group(criterion, "decouple/full", voltage_v.len());
    for scheme in Scheme::ALL {
        let ready = compound.decoupler(scheme);
        group.bench_function(name(scheme), |bencher| {
            bencher.iter(|| {
                push_each(&ready, black_box(voltage_v));
            });
        });
    }
    let ready = compound.paper_decoder(&problem::true_parameters());
    group.bench_function("paper", |bencher| {
        bencher.iter(|| {
            let mut decoder = black_box(&ready).clone();
            let sink = |sample: &SixAxis| {
                black_box(sample);
            };
            decoder.push_all(black_box(voltage_v), sink).expect(SOUND);
        });
    });
    group.finish();
}

fn record(criterion: &mut Criterion) {
    let problem = Recorded::play(&problem::compound_5_hz(), DECOUPLE_RATE_HZ);
    let voltage_v = &problem.recording.voltage_v;
    let ready = problem.decoupler(Scheme::Heun);
    let limits = DecoupledRun::compound(Scheme::Heun);
    let limits = [limits.linear, limits.angular];
    let dispatched = |sink: &mut dyn FnMut(SixAxisColumns)| {
        let mut decoupler = black_box(&ready).clone();
        decoupler.push_record(black_box(voltage_v), sink)
    };
    let portable = |sink: &mut dyn FnMut(SixAxisColumns)| {
        let mut decoupler = black_box(&ready).clone();
        decoupler.push_record_portable(black_box(voltage_v), sink)
    };
    type Path<'a> = &'a dyn Fn(&mut dyn FnMut(SixAxisColumns)) -> sixaxis_core::Result<()>;
    let paths: [(&str, Path); 2] = [("dispatched", &dispatched), ("portable", &portable)];
    for (name, path) in paths {
        let mut answers = Vec::new();
        path(&mut |done| answers.extend(done.iter().map(|s| s.accelerations())))
            .expect("a recorded run");
        let name = format!("decouple/record/{name}");
        require_accelerations(&name, &problem, 1, &answers, limits);
    }
    let mut group = group(criterion, "decouple/record", voltage_v.len());
    for (name, path) in paths {
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                path(&mut |done| {
                    black_box(done);
                })
            });
        });
    }
    group.bench_function("push", |bencher| {
        bencher.iter(|| {
            push_each(&ready, black_box(voltage_v));
        });
    });
    group.finish();
}

fn lanes(criterion: &mut Criterion) {
    let problem = Recorded::play(&problem::compound_5_hz(), DECOUPLE_RATE_HZ);
    let voltage_v = &problem.recording.voltage_v;
    let ready = problem.decoupler(Scheme::Heun);
    let rows = [&voltage_v[..]; LANES];
    let fresh = || -> [Decoupler; LANES] { from_fn(|_| black_box(&ready).clone()) };
    let mut answers: [Vec<Accelerations>; LANES] = from_fn(|_| Vec::new());
    push_lanes(&mut fresh(), rows, &mut |done| {
        for sample in done {
            for (lane, answers) in answers.iter_mut().enumerate() {
                answers.push(from_fn(|i| sample[i].0[lane]));
            }
        }
    })
    .expect("a recorded run");
    let limits = DecoupledRun::compound(Scheme::Heun);
    for answers in &answers {
        let limits = [limits.linear, limits.angular];
        require_accelerations("decouple/lanes", &problem, 1, answers, limits);
    }
    let mut group = group(criterion, "decouple/lanes", LANES * voltage_v.len());
    group.bench_function("eight_streams", |bencher| {
        bencher.iter(|| {
            push_lanes(&mut fresh(), black_box(rows), &mut |done| {
                black_box(done);
            })
            .expect("a recorded run");
        });
    });
    group.bench_function("push_each", |bencher| {
        bencher.iter(|| {
            for rows in black_box(rows) {
                push_each(&ready, rows);
            }
        });
    });
    group.finish();
}

criterion_group! {
    name = decouple;
    config = Criterion::default()
        .without_plots()
        .warm_up_time(WARM_UP_TIME)
        .measurement_time(MEASUREMENT_TIME)
        .sample_size(SAMPLE_SIZE);
    targets = full, record, lanes
}
criterion_main!(decouple);
