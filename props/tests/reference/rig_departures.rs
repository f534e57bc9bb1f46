//! A rig that departs from the paper's: its connecting rod, a centre off the axis and an axis off the plumb line, each against a
//! closed form, and all together in both engines.

use core::f64::consts::TAU;

use glam::DVec3;
use rand::SeedableRng;
use rand_pcg::Pcg64;
use sixaxis_core::LIMBS;
use sixaxis_props::compare::{fails_clearly, largest, within};
use sixaxis_props::problem::rig::{RATE_HZ, STEPS, model, short_run};
use sixaxis_props::{tolerance, truth};
use sixaxis_recordings::session::Role;
use sixaxis_reference::geometry::Geometry;
use sixaxis_reference::laboratory::plan::{Engine, RigPlan, SessionPlan};
use sixaxis_reference::laboratory::recording::SimulatedRecording;
use sixaxis_reference::laboratory::session::{SimulatedSession, simulate_session};
use sixaxis_reference::mujoco::simulate_run;
use sixaxis_reference::paper::GRAVITY_M_S2;
use sixaxis_reference::rig::run::{Mode, Mounting, Run};
use sixaxis_reference::rigid::RigidSensor;

const DIRECTION: DVec3 = DVec3::new(2.0, 1.0, 1.0);
const CRANK_OVER_ROD: f64 = 0.3;
const OFFSET_M: DVec3 = DVec3::new(3e-4, -5e-4, 8e-4);

/// Instants of one turn at full speed.
const INSTANTS: usize = 256;

fn turn(run: &Run) -> impl Iterator<Item = (f64, f64)> {
    let (start, end) = run.steady_span_s();
    let ramp_turns = 0.5 * run.ramp_periods;
    (0..INSTANTS).map(move |i| {
        let share = i as f64 / INSTANTS as f64;
        let phase = TAU * (ramp_turns + share);
        (start + share * (end - start), phase)
    })
}

#[test]
fn prop_the_connecting_rod_closes_the_crank_slider() {
    let c = CRANK_OVER_ROD;
    let run = Run {
        crank_over_rod: c,
        ..Run::new(Mode::Linear, 2.0, DIRECTION)
    };
    // The slider's joint is a rod's length from the crank's pin, wherever the crank stands.
    let middle = (c.powi(-2) - 1.0).sqrt();
    let gap = |rod: f64| {
        largest(turn(&run).map(|(time_s, phase)| {
            let [place, ..] = run.stroke_share(time_s);
            let (sin, cos) = phase.sin_cos();
            (middle + place - sin).hypot(cos) * rod - 1.0
        }))
    };
    within("rod's length", gap(c), tolerance::LAST_DIGITS);
    fails_clearly("another rod", gap(1.01 * c), tolerance::ROUNDING);
    // Harmonics of the crank in the place: sqrt(1 - c^2 cos^2) / c as a series, to c^9.
    let harmonic = |order: f64| {
        let sum: f64 = turn(&run)
            .map(|(time_s, phase)| run.stroke_share(time_s)[0] * (order * phase).cos())
            .sum();
        2.0 * sum / INSTANTS as f64
    };
    let second =
        -(c / 4.0 + c.powi(3) / 16.0 + 15.0 * c.powi(5) / 512.0 + 35.0 * c.powi(7) / 2048.0);
    within(
        "second harmonic of the rod",
        (harmonic(2.0) - second).abs(),
        tolerance::rod_harmonic(c),
    );
    fails_clearly(
        "an endless rod's second harmonic",
        harmonic(2.0).abs(),
        tolerance::rod_harmonic(c),
    );
    // Speed and acceleration are the place's derivatives.
    let step_s = 1e-4;
    for (what, order) in [("speed of the slider", 1), ("its acceleration", 2)] {
        let at = |time_s: f64| run.stroke_share(time_s);
        let error = largest(turn(&run).map(|(time_s, _)| {
            let slope =
                (at(time_s + step_s)[order - 1] - at(time_s - step_s)[order - 1]) / (2.0 * step_s);
            at(time_s)[order] - slope
        }));
        let size = largest(turn(&run).map(|(time_s, _)| at(time_s)[order]));
        within(what, error / size, tolerance::rod_slope(TAU * 2.0 * step_s));
    }
}

#[test]
fn ref_a_departing_rig_is_the_same_in_both_engines() {
    let parameters = truth::random_parameters(&mut Pcg64::seed_from_u64(12));
    let direction = DIRECTION.normalize();
    let sensor = RigidSensor::new(&truth::sensor(&parameters), &[1.0; LIMBS])
        .expect("three nodes hold a body");
    for mode in [Mode::Angular, Mode::Compound] {
        let run = Run {
            crank_over_rod: CRANK_OVER_ROD,
            centre_offset_shell_m: OFFSET_M,
            ..short_run(mode, direction)
        };
        let gravity = Mounting::AxisLevel.gravity_ground_m_s2(direction);
        let model = model(&parameters, direction, Mounting::AxisLevel);
        let truth = simulate_run(&model, &run, RATE_HZ, STEPS).expect("the run simulates");
        let motion_error = |run: &Run| {
            let ours = sensor.simulate(run, gravity, RATE_HZ);
            let pairs = || ours.truth.iter().zip(&truth.truth);
            let peak = largest(truth.truth.iter().map(|t| t.linear_ground_m_s2.length()));
            let linear =
                pairs().map(|(a, b)| (a.linear_ground_m_s2 - b.linear_ground_m_s2).length());
            largest(linear) / peak
        };
        within(
            "acceleration of a centre off the axis",
            motion_error(&run),
            tolerance::RIGID_MOTION,
        );
        for (what, broken) in [
            (
                "an endless rod",
                Run {
                    crank_over_rod: 0.0,
                    ..run
                },
            ),
            (
                "a centre on the axis",
                Run {
                    centre_offset_shell_m: DVec3::ZERO,
                    ..run
                },
            ),
        ] {
            fails_clearly(what, motion_error(&broken), tolerance::RIGID_MOTION);
        }
        let ours = sensor.simulate(&run, gravity, RATE_HZ);
        let forces = ours.limb_force_per_mass_m_s2.iter();
        let size = largest(truth.limb_force_per_mass_m_s2.iter().flatten().copied());
        let difference = largest(
            forces
                .zip(&truth.limb_force_per_mass_m_s2)
                .flat_map(|(a, b)| (0..LIMBS).map(move |i| a[i] - b[i])),
        );
        within(
            "forces on a departing rig",
            difference / size,
            tolerance::rigid_limbs(
                run.frequency_hz * (1.0 + CRANK_OVER_ROD),
                parameters.stiffness_per_mass_per_s2,
            ),
        );
        // In shell axes, about a fixed axis: alpha x o + w (w . o) - o w^2 on top of the travel.
        let swing = largest(truth.truth.iter().map(|t| {
            let back = t.attitude.inverse();
            let (w, alpha) = (t.rate_shell_rad_s, back * t.angular_ground_rad_s2);
            let expected =
                alpha.cross(OFFSET_M) + w * w.dot(OFFSET_M) - OFFSET_M * w.length_squared();
            let seen = back * t.linear_ground_m_s2;
            let across = seen - direction * seen.dot(direction);
            (across - expected).length()
        }));
        let peak = largest(truth.truth.iter().map(|t| t.linear_ground_m_s2.length()));
        within(
            "tangential and centripetal acceleration",
            swing / peak,
            tolerance::RIGID_MOTION,
        );
    }
}

/// A day without noise on such a rig.
fn day(rig: RigPlan) -> SimulatedSession {
    let mut plan = SessionPlan {
        seed: 3,
        engine: Engine::Rigid,
        trials_per_step: 6,
        sample_rate_hz: 500.0,
        static_duration_s: 1.0,
        rig,
        ..SessionPlan::default()
    };
    plan.chain.signal_to_noise_db = f64::INFINITY;
    plan.chain.resolution_bits = 0;
    simulate_session(&plan).expect("the plan can be played")
}

/// Net force per mass that the limbs' voltages say, shell axes, m/s^2.
fn net_force(played: &SimulatedSession, recording: &SimulatedRecording) -> Vec<DVec3> {
    let sensor = &played.truth.parameters;
    let wrenches = Geometry::PAPER.limb_wrenches();
    let rows = recording.voltage_v.iter();
    rows.map(|u| {
        let force = |i: usize| {
            (u[i] - sensor.zero_drift_v[i])
                * recording.gain_n_per_v[i]
                * sensor.scale_per_mass_per_kg[i]
        };
        let along = |axis: usize| (0..LIMBS).map(|i| wrenches[(i, axis)] * force(i)).sum();
        DVec3::new(along(0), along(1), along(2))
    })
    .collect()
}

#[test]
fn prop_gravity_turns_about_a_tilted_axis() {
    let tilt_deg = 0.5;
    let played = day(RigPlan {
        axis_tilt_deg: tilt_deg,
        ..RigPlan::default()
    });
    let plumb = day(RigPlan::default());
    let swing = 2.0 * GRAVITY_M_S2 * f64::to_radians(tilt_deg).sin();
    // What turns by theta about the axis departs from where it was by twice its distance from the axis times sin(theta/2).
    let error = |played: &SimulatedSession| {
        largest(
            played
                .recordings
                .iter()
                .filter(|r| r.role == Role::Angular)
                .flat_map(|r| net_force(played, r).into_iter().zip(&r.truth))
                .map(|(force, truth)| {
                    let q = truth.attitude;
                    let sin_half = DVec3::new(q.x, q.y, q.z).length();
                    force.length() / swing - sin_half
                }),
        )
    };
    within(
        "gravity about a tilted axis",
        error(&played),
        tolerance::WRENCH_SUM,
    );
    fails_clearly("a plumb axis", error(&plumb), tolerance::WRENCH_SUM);
}

#[test]
fn prop_a_centre_off_the_axis_feels_its_swing() {
    let offset_mm = 0.3;
    let played = day(RigPlan {
        centre_offset_mm: offset_mm,
        ..RigPlan::default()
    });
    let mut arms = Vec::new();
    for recording in played.recordings.iter().filter(|r| r.role == Role::Angular) {
        let forces = net_force(&played, recording);
        let swings = || {
            recording.truth.iter().map(|t| {
                let square = t.rate_shell_rad_s.length_squared();
                t.angular_ground_rad_s2.length().hypot(square)
            })
        };
        // By least squares the one arm that explains the whole trial, and what it leaves.
        let power: f64 = swings().map(|s| s * s).sum();
        let arm_m = forces
            .iter()
            .zip(swings())
            .map(|(f, s)| f.length() * s)
            .sum::<f64>()
            / power;
        let size = arm_m * largest(swings());
        let left = largest(
            forces
                .iter()
                .zip(swings())
                .map(|(f, s)| f.length() - arm_m * s),
        );
        within(
            "swing of a centre off the axis",
            left / size,
            tolerance::WRENCH_SUM,
        );
        arms.push(1e3 * arm_m / offset_mm);
    }
    // A part of the offset lies along the axis, where it has no effect; each wedge has its own.
    assert!(
        arms.iter()
            .all(|arm| (0.0..=1.0 + tolerance::WRENCH_SUM.limit).contains(arm)),
        "{arms:?}"
    );
    assert!(arms.windows(2).any(|pair| pair[0] != pair[1]), "{arms:?}");
}
