//! Nine voltages to six accelerations: a whole compound run at 5 Hz, 10 kHz, one sample at a time.
//!
//! One group, so that the peer's time stands beside the core's in the same run. See [`peer`] for what else differs.

use std::hint::black_box;

use criterion::{Criterion, SamplingMode, Throughput, criterion_group, criterion_main};
use sixaxis_benches::limits::{Decoupled, PEER_COMPOUND, PEER_TUMBLE};
use sixaxis_benches::peer::{self, PeerDecoupler};
use sixaxis_benches::problem::{self, Answer, DECOUPLE_RATE_HZ, Recorded};
use sixaxis_benches::{MEASUREMENT_TIME, SAMPLE_SIZE, WARM_UP_TIME, validate};
use sixaxis_core::Scheme;

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
    let mut group = criterion.benchmark_group("decouple/full");
    group.sampling_mode(SamplingMode::Flat);
    group.throughput(Throughput::Elements(voltage_v.len() as u64));
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

criterion_group! {
    name = decouple;
    config = Criterion::default()
        .without_plots()
        .warm_up_time(WARM_UP_TIME)
        .measurement_time(MEASUREMENT_TIME)
        .sample_size(SAMPLE_SIZE);
    targets = full
}
criterion_main!(decouple);
