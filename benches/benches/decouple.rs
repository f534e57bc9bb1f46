//! Nine voltages to six accelerations: a whole compound run at 5 Hz, 10 kHz.
//!
//! `decouple/full` takes one sample at a time, `decouple/record` the run as it lies there, and
//! `decouple/lanes` eight such runs at once; throughput is in samples, of all streams together. The oracle's time stands
//! beside the core's in the same run; see [`peer`] for what else differs, and `benches/peers` for other tools.

use std::array::from_fn;
use std::hint::black_box;

use criterion::measurement::WallTime;
use criterion::{
    BenchmarkGroup, Criterion, SamplingMode, Throughput, criterion_group, criterion_main,
};
use glam::DVec3;
use sixaxis_benches::limits::{Decoupled, Limit, PEER_COMPOUND, PEER_TUMBLE};
use sixaxis_benches::peer::{self, PeerDecoupler};
use sixaxis_benches::problem::{self, Answer, DECOUPLE_RATE_HZ, Recorded};
use sixaxis_benches::{MEASUREMENT_TIME, SAMPLE_SIZE, WARM_UP_TIME, validate};
use sixaxis_core::decouple::lanes::push_lanes;
use sixaxis_core::decouple::record::Accelerations;
use sixaxis_core::kernel::simd::LANES;
use sixaxis_core::{Decoupler, Scheme};

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

fn core_answers(problem: &Recorded, scheme: Scheme) -> Vec<Answer> {
    let mut answers = Vec::new();
    let ready = problem.decoupler(scheme);
    problem::decouple(&ready, &problem.recording.voltage_v, |sample| {
        answers.push(sample.into());
    });
    answers
}

fn peer_answers(problem: &Recorded) -> Vec<Answer> {
    let mut answers = Vec::new();
    let ready = PeerDecoupler::new(problem, &problem::true_parameters());
    peer::decouple(&ready, &problem.recording.voltage_v, |sample| {
        answers.push(sample.into());
    });
    answers
}

/// Holds accelerations of consecutive samples, the first of which is `first`, to the truth.
fn require_accelerations(
    name: &str,
    problem: &Recorded,
    first: usize,
    answers: &[Accelerations],
    limits: [Limit; 2],
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
    for (limit, pairs) in limits.into_iter().zip([linear, angular]) {
        validate::require(name, validate::accelerations(limit, &pairs));
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
    let require = |name: &str, problem: &Recorded, answers: &[Answer], limits: &Decoupled| {
        validate::require(name, validate::decoupled(&problem.truth, answers, limits));
    };
    for scheme in Scheme::ALL {
        for (run, problem, limits) in [
            ("", &compound, Decoupled::compound(scheme)),
            (" on the tumble", &tumble, Decoupled::tumble(scheme)),
        ] {
            let name = format!("decouple/full/{}{run}", name(scheme));
            require(&name, problem, &core_answers(problem, scheme), &limits);
        }
    }
    for (run, problem, limits) in [
        ("", &compound, PEER_COMPOUND),
        (" on the tumble", &tumble, PEER_TUMBLE),
    ] {
        let name = format!("decouple/full/nalgebra{run}");
        require(&name, problem, &peer_answers(problem), &limits);
    }

    let voltage_v = &compound.recording.voltage_v;
    let mut group = group(criterion, "decouple/full", voltage_v.len());
    for scheme in Scheme::ALL {
        let ready = compound.decoupler(scheme);
        group.bench_function(name(scheme), |bencher| {
            bencher.iter(|| {
                problem::decouple(black_box(&ready), black_box(voltage_v), |sample| {
                    black_box(sample);
                });
            });
        });
    }
    let ready = PeerDecoupler::new(&compound, &problem::true_parameters());
    group.bench_function("nalgebra", |bencher| {
        bencher.iter(|| {
            peer::decouple(black_box(&ready), black_box(voltage_v), |sample| {
                black_box(sample);
            });
        });
    });
    group.finish();
}

fn record(criterion: &mut Criterion) {
    let problem = Recorded::play(&problem::compound_5_hz(), DECOUPLE_RATE_HZ);
    let voltage_v = &problem.recording.voltage_v;
    let ready = problem.decoupler(Scheme::Heun);
    let limits = Decoupled::compound(Scheme::Heun);
    let limits = [limits.linear, limits.angular];
    let dispatched = |sink: &mut dyn FnMut(&[Accelerations])| {
        let mut decoupler = black_box(&ready).clone();
        decoupler.push_record(black_box(voltage_v), &mut |done| sink(done))
    };
    let portable = |sink: &mut dyn FnMut(&[Accelerations])| {
        let mut decoupler = black_box(&ready).clone();
        decoupler.push_record_portable(black_box(voltage_v), &mut |done| sink(done))
    };
    type Path<'a> = &'a dyn Fn(&mut dyn FnMut(&[Accelerations])) -> sixaxis_core::Result<()>;
    let paths: [(&str, Path); 2] = [("dispatched", &dispatched), ("portable", &portable)];
    for (name, path) in paths {
        let mut answers = Vec::new();
        path(&mut |done| answers.extend_from_slice(done)).expect("a recorded run");
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
            problem::decouple(black_box(&ready), black_box(voltage_v), |sample| {
                black_box(sample);
            });
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
    let limits = Decoupled::compound(Scheme::Heun);
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
                problem::decouple(black_box(&ready), rows, |sample| {
                    black_box(sample);
                });
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
