//! What is done with whole runs: steps 2 and 3 with the compliance kept, and closing a run from rest to rest.

use glam::DVec3;
use rand_distr::{Distribution, StandardNormal};
use sixaxis_core::decouple::rest_to_rest;
use sixaxis_core::decouple::stream::Decoupler;
use sixaxis_core::identify::compliance::CompliantRows;
use sixaxis_core::identify::inertia::InertiaIdentification;
use sixaxis_core::identify::scale::ScaleIdentification;
use sixaxis_core::{Geometry, LIMBS, Sensor, Settings, SixAxis};
use sixaxis_props::compare::{fails_clearly, largest, within};
use sixaxis_props::problem::rig;
use sixaxis_props::tolerance;
use sixaxis_props::truth;
use sixaxis_props::truth::InCore;
use sixaxis_reference::laboratory::Laboratory;
use sixaxis_reference::laboratory::recording::SimulatedRecording;
use sixaxis_reference::motion::SimulatedRun;
use sixaxis_reference::mujoco::simulate_run;
use sixaxis_reference::rig::run::{Mode, Mounting, Run};

const RATE_HZ: f64 = 10_000.0;
const STEPS: usize = 4;
const DIRECTIONS: [DVec3; 3] = [
    DVec3::new(1.0, 0.2, 0.1),
    DVec3::new(-0.1, 1.0, 0.3),
    DVec3::new(0.2, -0.2, 1.0),
];

fn simulate(mode: Mode, direction: DVec3) -> (SimulatedRun, SimulatedRecording) {
    let run = Run {
        rest_s: 0.01,
        ramp_periods: 0.5,
        steady_periods: 0.5,
        ..Run::new(mode, 5.0, direction)
    };
    simulated(&run, direction)
}

fn simulated(run: &Run, direction: DVec3) -> (SimulatedRun, SimulatedRecording) {
    let parameters = truth::identified_parameters();
    let model = rig::model(&parameters, direction, Mounting::AxisVertical);
    let run =
        simulate_run(&model, run, RATE_HZ, STEPS).expect("a run within the rig's limits simulates");
    let recording = Laboratory::noise_free(truth::sensor(&parameters)).record(&run, 0);
    (run, recording)
}

fn set_up(recording: &SimulatedRecording) -> (Sensor, Settings) {
    let sensor = Sensor {
        geometry: Geometry::PAPER,
        gains: recording.gains(),
    };
    let settings = Settings {
        gravity_ground_m_s2: recording.gravity_ground_m_s2,
        ..Settings::new(recording.sample_rate_hz)
    };
    (sensor, settings)
}

#[test]
fn ref_scale_factors_are_exact_once_compliance_is_kept() {
    let truth = truth::identified_parameters();
    let (mut plain, mut kept) = (
        ScaleIdentification::default(),
        ScaleIdentification::default(),
    );
    for direction in DIRECTIONS {
        let (run, recording) = simulate(Mode::Linear, direction);
        let (sensor, settings) = set_up(&recording);
        let mut rows =
            CompliantRows::new(&sensor, &truth, &settings).expect("parameters are sound");
        for voltage in &recording.voltage_v {
            if let Some(now) = rows.push(voltage).expect("samples are finite") {
                let sample = now.sample as usize;
                let a = run.truth[sample].linear_ground_m_s2;
                rows.push_scale(&mut kept, &now, a)
                    .expect("rows are finite");
                let force = recording
                    .gains()
                    .measured_force_n(&recording.voltage_v[sample], &truth.zero_drift_v);
                plain.push(&force, a).expect("rows are finite");
            }
        }
    }
    let error = |step: &ScaleIdentification| {
        let found = step
            .solve()
            .expect("three directions span space")
            .estimate
            .values;
        largest((0..LIMBS).map(|i| found[i] / truth.scale_per_mass_per_kg[i] - 1.0))
    };
    within(
        "scale factors, compliance kept",
        error(&kept),
        tolerance::COMPLIANT,
    );
    fails_clearly(
        "scale factors, compliance neglected",
        error(&plain),
        tolerance::COMPLIANT,
    );
}

#[test]
fn ref_inertia_is_exact_once_compliance_is_kept() {
    let truth = truth::identified_parameters();
    let mut plain = InertiaIdentification::new(Geometry::PAPER);
    let mut kept = plain.clone();
    for direction in DIRECTIONS {
        let (run, recording) = simulate(Mode::Angular, direction);
        let (sensor, settings) = set_up(&recording);
        let mut rows =
            CompliantRows::new(&sensor, &truth, &settings).expect("parameters are sound");
        for voltage in &recording.voltage_v {
            if let Some(now) = rows.push(voltage).expect("samples are finite") {
                let t = &run.truth[now.sample as usize];
                let slope = t.attitude.inverse() * t.angular_ground_rad_s2;
                rows.push_inertia(&mut kept, &now, t.rate_shell_rad_s, slope)
                    .expect("rows are finite");
                plain
                    .push(&now.sensed_m_s2, t.rate_shell_rad_s, slope)
                    .expect("rows are finite");
            }
        }
    }
    let entries = truth.inertia_per_mass.to_paper_order();
    let error = |step: &InertiaIdentification| {
        let found = step.solve().expect("three axes excite everything");
        let found = found.inertia_per_mass.to_paper_order();
        largest((0..6).map(|i| found[i] - entries[i])) / largest(entries)
    };
    within(
        "inertia, compliance kept",
        error(&kept),
        tolerance::COMPLIANT,
    );
    fails_clearly(
        "inertia, compliance neglected",
        error(&plain),
        tolerance::COMPLIANT,
    );
}

#[test]
fn ref_a_drifting_run_is_closed_from_rest_to_rest() {
    let truth = truth::identified_parameters();
    let (run, recording) = simulate(Mode::Compound, DVec3::new(1.0, 1.0, 2.0));
    let (sensor, settings) = set_up(&recording);
    // A straight drift of some millivolts in every channel, different in each.
    let samples = recording.voltage_v.len() as f64;
    let mut drifting = recording.voltage_v.clone();
    for (sample, row) in drifting.iter_mut().enumerate() {
        for (channel, u) in row.iter_mut().enumerate() {
            let (start, slope) = (1e-3 * (channel as f64 - 4.0), 5e-4 * (channel % 3) as f64);
            *u += start + slope * sample as f64 / samples;
        }
    }
    let decouple = |rows: &[[f64; LIMBS]]| -> Vec<SixAxis> {
        let mut decoupler =
            Decoupler::new(&sensor, &truth, &settings).expect("parameters are sound");
        rows.iter()
            .filter_map(|row| decoupler.push(row).expect("samples are finite"))
            .collect()
    };
    let rate_error =
        |samples: &[SixAxis]| {
            largest(samples.iter().map(|s| {
                (s.rate_shell_rad_s - run.truth[s.sample as usize].rate_shell_rad_s).length()
            }))
        };
    let (closed, trend) = rest_to_rest::detrend(&sensor, &truth, &settings, &drifting)
        .expect("the run is long enough");
    let closed = decouple(&closed);
    let last = closed.last().expect("the run is long enough");
    within(
        "rate at the end",
        last.rate_shell_rad_s.length(),
        tolerance::CLOSED,
    );
    within(
        "rotation at the end",
        last.attitude.to_scaled_axis().length(),
        tolerance::CLOSED,
    );
    assert!(
        trend.end_rate_before_rad_s.length()
            > tolerance::NEGATIVE_CONTROL * tolerance::CLOSED.limit
    );
    let (before, after) = (rate_error(&decouple(&drifting)), rate_error(&closed));
    // What the line cannot know is drift in the six sums that carry no torque; it does not touch the rate.
    assert!(
        tolerance::NEGATIVE_CONTROL * after < before,
        "closing a drifting run brought the rate's error from {before:.3e} to {after:.3e} rad/s"
    );
}

/// Zeros that moved by so much that the open loop ends some turns away: a line that closes the run with a turn too many is none of theirs.
#[test]
fn law_zeros_that_moved_far_are_closed_without_a_turn_too_many() {
    let truth = truth::identified_parameters();
    let direction = DVec3::new(1.0, 1.0, 2.0);
    let run = Run {
        rest_s: 0.5,
        steady_periods: 8.0,
        ..Run::new(Mode::Compound, 5.0, direction)
    };
    let (run, recording) = simulated(&run, direction);
    let (sensor, settings) = set_up(&recording);
    let rate = run.truth.iter().map(|s| s.rate_shell_rad_s.length());
    let peak = largest(rate);
    for moved_v in [1e-3, 4e-3, 1e-2] {
        let mut rows = recording.voltage_v.clone();
        for (limb, u) in rows.iter_mut().flat_map(|row| row.iter_mut().enumerate()) {
            *u += moved_v * (2.0 + limb as f64).sin();
        }
        let (closed, trend) =
            rest_to_rest::detrend(&sensor, &truth, &settings, &rows).expect("it closes");
        let mut decoupler = Decoupler::new(&sensor, &truth, &settings).expect("sound");
        let off = closed.iter().filter_map(|row| {
            let shown = decoupler.push(row).expect("finite")?;
            let right = &run.truth[shown.sample as usize];
            Some((shown.rate_shell_rad_s - right.rate_shell_rad_s).length())
        });
        let off = largest(off);
        let before = trend.end_rate_before_rad_s.length();
        assert!(
            off < 0.01 * peak,
            "{moved_v} V: rates up to {off:.3} rad/s off, of {peak:.1}; before {before:.1} rad/s at the end"
        );
    }
}

/// What a recorder took before and after the motion is no part of what is integrated.
#[test]
fn law_a_long_rest_costs_a_closed_run_nothing() {
    let truth = truth::identified_parameters();
    let (run, recording) = simulate(Mode::Compound, DVec3::new(1.0, 1.0, 2.0));
    let (sensor, settings) = set_up(&recording);
    let mut rng = rand_pcg::Pcg64::new(7, 91);
    let rest = (10.0 * settings.sample_rate_hz) as usize;
    let samples = recording.voltage_v.len();
    let mut rate_error = |rest: usize| {
        let rows: Vec<[f64; LIMBS]> = (0..samples + 2 * rest)
            .map(|sample| {
                let row = &recording.voltage_v[sample.saturating_sub(rest).min(samples - 1)];
                row.map(|u| {
                    let unit: f64 = StandardNormal.sample(&mut rng);
                    u + 1e-2 * unit
                })
            })
            .collect();
        let (rows, _) = rest_to_rest::detrend(&sensor, &truth, &settings, &rows).expect("closes");
        let mut decoupler = Decoupler::new(&sensor, &truth, &settings).expect("sound");
        let mut error = 0.0_f64;
        for row in &rows {
            let Some(out) = decoupler.push(row).expect("finite") else {
                continue;
            };
            if let Some(at) = (out.sample as usize).checked_sub(rest)
                && let Some(truth) = run.truth.get(at)
            {
                error = error.max((out.rate_shell_rad_s - truth.rate_shell_rad_s).length());
            }
        }
        error
    };
    let [none, long] = [0, rest].map(&mut rate_error);
    assert!(long < 3.0 * none, "{none} rad/s without rests, {long} with");
}
