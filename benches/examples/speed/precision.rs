//! Error against time: schemes and sample rates on one motion.

use std::error::Error;
use std::hint::black_box;

use glam::DVec3;
use sixaxis_benches::validate;
use sixaxis_core::{Decoupler, Scheme, SixAxis};
use sixaxis_props::compare::largest;
use sixaxis_props::problem::recorded as problem;
use sixaxis_props::problem::recorded::{DECOUPLE_RATE_HZ, Recorded, true_parameters};
use sixaxis_props::results::{SchemeCurve, WorkPrecision, WorkPrecisionPoint};
use sixaxis_props::tolerance::DecoupledRun;
use sixaxis_props::truth;
use sixaxis_reference::laboratory::Laboratory;
use sixaxis_reference::motion::{SimulatedRun, TrueMotion};

use crate::comparison::judge_record;
use crate::timing::{
    Effort, Job, Progress, Voltages, push_all, record_all, repeated, rounded, spread, time,
};

/// Sample rate of the fine simulation, Hz, and how often it is halved.
pub const FINE_RATE_HZ: f64 = 20_000.0;

pub const HALVINGS: u32 = 5;

/// MuJoCo's steps per fine sample: 6.25 us each. Half as long ones show what error is MuJoCo's own.
pub const FINE_STEPS: usize = 8;

/// Largest error over its peak that is still a scheme's: Euler has 5 % at the lowest rate, a wrong answer about 1.
pub const WRONG: f64 = 0.2;

/// Errors of push and of the record path in the linear acceleration over its peak, and push's errors themselves.
pub fn errors(
    ready: &Decoupler,
    voltage_v: &[Voltages],
    truth: &[TrueMotion],
) -> (f64, f64, Vec<DVec3>) {
    let peak = largest(truth.iter().map(|t| t.linear_ground_m_s2.length()));
    let mut push = Vec::new();
    ready
        .clone()
        .push_all(voltage_v, |s| {
            push.push(s.linear_ground_m_s2 - truth[s.sample as usize].linear_ground_m_s2);
        })
        .expect("samples of a recorded run");
    let mut record = Vec::new();
    ready
        .clone()
        .push_record(voltage_v, &mut |answers| {
            record.extend(
                answers
                    .iter()
                    .map(|s| s.linear_ground_m_s2 - truth[s.sample as usize].linear_ground_m_s2),
            );
        })
        .expect("samples of a recorded run");
    let over_peak = |errors: &[DVec3]| largest(errors.iter().map(|e| e.length())) / peak;
    (over_peak(&push), over_peak(&record), push)
}

pub fn work_precision(
    effort: &Effort,
    progress: &Progress,
) -> Result<WorkPrecision, Box<dyn Error>> {
    let run = problem::compound_5_hz();
    let model = problem::model(&run);
    let simulate =
        |steps| sixaxis_reference::mujoco::simulate_run(&model, &run, FINE_RATE_HZ, steps);
    progress.say("simulating the compound run at 6.25 us");
    let fine = simulate(FINE_STEPS)?;
    progress.say("simulating it at half that step");
    let halved = simulate(2 * FINE_STEPS)?;
    let recorded = |run: &SimulatedRun, halving: u32| {
        let run = run.decimated(1 << halving);
        Recorded {
            recording: Laboratory::noise_free(truth::sensor(&true_parameters())).record(&run, 0),
            truth: run.truth,
        }
    };
    let problems: Vec<Recorded> = (0..=HALVINGS).map(|h| recorded(&fine, h)).collect();

    let mut reference_error = 0.0;
    let mut cases = Vec::new();
    for scheme in Scheme::ALL {
        for one in problems.iter().rev() {
            let ready = one.decoupler(scheme);
            let voltage_v = &one.recording.voltage_v;
            let rate_hz = one.recording.sample_rate_hz;
            let what = format!("{} at {rate_hz} Hz", scheme.name());
            judge_record(
                &what,
                &ready,
                std::iter::once(&voltage_v[..]),
                voltage_v.len(),
            );
            let (push, record, vectors) = errors(&ready, voltage_v, &one.truth);
            assert!(
                push <= WRONG && record <= WRONG,
                "{what} is not timed, because it is off by {push:.1e} and {record:.1e} of the peak"
            );
            if scheme == Scheme::AdamsMoulton4 && rate_hz == FINE_RATE_HZ {
                let half = recorded(&halved, 0);
                let (.., others) = errors(&ready, &half.recording.voltage_v, &half.truth);
                let peak = largest(one.truth.iter().map(|t| t.linear_ground_m_s2.length()));
                let moved = vectors.iter().zip(others).map(|(a, b)| (*a - b).length());
                reference_error = largest(moved) / peak;
            }
            cases.push((scheme, one, ready, [push, record]));
        }
    }
    let mut jobs: Vec<Job> = Vec::new();
    for (_, one, ready, _) in &cases {
        let whole = || std::iter::once(&one.recording.voltage_v[..]);
        jobs.push(repeated(move || {
            push_all(black_box(ready), black_box(whole()))
        }));
        jobs.push(repeated(move || {
            record_all(black_box(ready), black_box(whole()))
        }));
    }
    let mut times = time("work and precision", &mut jobs, effort, progress).into_iter();
    drop(jobs);
    let mut curves: Vec<SchemeCurve> = Vec::new();
    for (scheme, one, _, [push, record]) in &cases {
        let signal_s = one.truth.len() as f64 / one.recording.sample_rate_hz;
        let mut next = || spread(times.next().unwrap_or_default(), 1.0 / signal_s);
        let point = WorkPrecisionPoint {
            sample_rate_hz: one.recording.sample_rate_hz,
            push_error: rounded(*push),
            record_error: rounded(*record),
            push_s_per_s: next(),
            record_s_per_s: next(),
        };
        match curves.last_mut() {
            Some(curve) if curve.scheme == *scheme => curve.points.push(point),
            _ => curves.push(SchemeCurve {
                scheme: *scheme,
                points: vec![point],
            }),
        }
    }
    Ok(WorkPrecision {
        problem: "compound_5hz".to_owned(),
        signal_s: rounded(fine.truth.len() as f64 / fine.sample_rate_hz),
        reference_error: rounded(reference_error),
        curves,
    })
}

/// The bench's own problem, its answer within the bench's own limits.
pub fn validated(scheme: Scheme) -> Recorded {
    let recorded = Recorded::play(&problem::compound_5_hz(), DECOUPLE_RATE_HZ);
    let mut answers: Vec<SixAxis> = Vec::new();
    recorded
        .decoupler(scheme)
        .push_all(&recorded.recording.voltage_v, |s| answers.push(*s))
        .expect("a recorded run");
    let outcome = validate::decoupled(&recorded.truth, &answers, &DecoupledRun::compound(scheme));
    if let Err(refusal) = outcome {
        panic!("push is not timed, because its answer is wrong: {refusal}");
    }
    recorded
}
