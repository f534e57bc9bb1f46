//! Simulated sessions: limbs that do not give way against MuJoCo, what is written against what was played, plans against their
//! text.

use std::path::{Path, PathBuf};

use glam::DVec3;
use rand::SeedableRng;
use rand_pcg::Pcg64;
use sixaxis_calibration::trial::Trial;
use sixaxis_core::identify::inertia::euler_torque;
use sixaxis_core::{LIMBS, Parameters};
use sixaxis_props::compare::{fails_clearly, largest, within};
use sixaxis_props::problem::rig::model;
use sixaxis_props::tolerance::{self, Tolerance};
use sixaxis_props::truth;
use sixaxis_recordings::session::{Role, SessionFile};
use sixaxis_reference::laboratory::defect::{Defect, Kind, Where};
use sixaxis_reference::laboratory::plan::{
    CouplingChoice, DefectChoice, Engine, SensorChoice, SessionPlan,
};
use sixaxis_reference::laboratory::room::Room;
use sixaxis_reference::laboratory::session::simulate_session;
use sixaxis_reference::laboratory::write::{SESSION_FILE, TRUTH_FOLDER, write};
use sixaxis_reference::laboratory::{check, plan_file};
use sixaxis_reference::motion::SimulatedRun;
use sixaxis_reference::rig::run::{Mode, Mounting, Run};
use sixaxis_reference::rigid::{Load, RigidSensor};

/// Samples per second, and Runge-Kutta steps from sample to sample: 25 us.
const RATE_HZ: f64 = 1000.0;
const STEPS: usize = 40;

/// A session that is played in milliseconds.
fn small(seed: u64) -> SessionPlan {
    SessionPlan {
        seed,
        sensor: SensorChoice::Random,
        engine: Engine::Rigid,
        trials_per_step: 3,
        sample_rate_hz: 200.0,
        static_duration_s: 30.0,
        // Slow enough that a loader which does not know how long the record is does not average it.
        static_rate_hz: 10.0,
        ..SessionPlan::default()
    }
}

/// The same with a perfect chain, so that nothing but a defect tells two sessions apart.
fn silent(seed: u64, trials_per_step: usize) -> SessionPlan {
    let mut plan = SessionPlan {
        trials_per_step,
        ..small(seed)
    };
    plan.chain.signal_to_noise_db = f64::INFINITY;
    plan.chain.resolution_bits = 0;
    plan.instruments.signal_to_noise_db = f64::INFINITY;
    plan
}

/// A defect with nothing but its size.
fn exactly(kind: Kind, magnitude: f64) -> Defect {
    Defect {
        kind,
        magnitude,
        place: Where::Everywhere,
        channel: 0,
        seed: 0,
    }
}

/// Largest difference of forces over the largest force.
fn departure(ours: &[[f64; LIMBS]], truth: &[[f64; LIMBS]]) -> f64 {
    assert_eq!(ours.len(), truth.len());
    let difference = largest(
        ours.iter()
            .zip(truth)
            .flat_map(|(a, b)| (0..LIMBS).map(move |i| a[i] - b[i])),
    );
    difference / largest(truth.iter().flatten().copied())
}

#[test]
fn ref_rigid_runs_are_mujocos() {
    let parameters = truth::random_parameters(&mut Pcg64::seed_from_u64(11));
    let direction = DVec3::new(2.0, 1.0, 1.0).normalize();
    let sensor = RigidSensor::new(&truth::sensor(&parameters), &[1.0; LIMBS])
        .expect("three nodes hold a body");
    for mounting in [Mounting::AxisVertical, Mounting::AxisLevel] {
        for mode in [Mode::Linear, Mode::Angular, Mode::Compound] {
            for frequency_hz in [1.5, 5.0] {
                let run = Run {
                    rest_s: 0.01,
                    ramp_periods: 0.5,
                    steady_periods: 0.5,
                    ..Run::new(mode, frequency_hz, direction)
                };
                let limit =
                    tolerance::rigid_limbs(frequency_hz, parameters.stiffness_per_mass_per_s2);
                let model = model(&parameters, direction, mounting);
                let truth = sixaxis_reference::mujoco::simulate_run(&model, &run, RATE_HZ, STEPS)
                    .expect("a run within the rig's limits simulates");
                let gravity = mounting.gravity_ground_m_s2(direction);
                let ours = sensor.simulate(&run, gravity, RATE_HZ);
                within(
                    "forces of rigid limbs",
                    departure(
                        &ours.limb_force_per_mass_m_s2,
                        &truth.limb_force_per_mass_m_s2,
                    ),
                    limit,
                );
                assert_eq!(ours.truth.len(), truth.truth.len());
                let pairs = || ours.truth.iter().zip(&truth.truth);
                let peak = |of: &dyn Fn(usize) -> f64| {
                    largest((0..truth.truth.len()).map(of)).max(f64::MIN_POSITIVE)
                };
                let t = &truth.truth;
                for (what, error, size) in [
                    (
                        "true acceleration in closed form",
                        largest(
                            pairs().map(|(a, b)| {
                                (a.linear_ground_m_s2 - b.linear_ground_m_s2).length()
                            }),
                        ),
                        peak(&|i| t[i].linear_ground_m_s2.length()),
                    ),
                    (
                        "true angular acceleration in closed form",
                        largest(pairs().map(|(a, b)| {
                            (a.angular_ground_rad_s2 - b.angular_ground_rad_s2).length()
                        })),
                        peak(&|i| t[i].angular_ground_rad_s2.length()),
                    ),
                    (
                        "true rate in closed form",
                        largest(
                            pairs()
                                .map(|(a, b)| (a.rate_shell_rad_s - b.rate_shell_rad_s).length()),
                        ),
                        peak(&|i| t[i].rate_shell_rad_s.length()),
                    ),
                    (
                        "true attitude in closed form",
                        largest(pairs().map(|(a, b)| {
                            (a.attitude * DVec3::X - b.attitude * DVec3::X).length()
                        })),
                        1.0,
                    ),
                ] {
                    // A mode that does not turn or travel has no size to hold an error against.
                    within(what, error / size.max(1e-3), tolerance::RIGID_MOTION);
                }
                controls(&sensor, &parameters, &ours, &truth, limit);
            }
        }
    }
}

/// Broken variants of the closed form, which must not pass for MuJoCo's.
fn controls(
    sensor: &RigidSensor,
    parameters: &Parameters,
    ours: &SimulatedRun,
    truth: &SimulatedRun,
    limit: Tolerance,
) {
    let inertia = &parameters.inertia_per_mass;
    let forces = |gravity: DVec3, sign: f64| -> Vec<[f64; LIMBS]> {
        ours.truth
            .iter()
            .map(|t| {
                let back = t.attitude.inverse();
                let angular = back * t.angular_ground_rad_s2;
                let gyroscopic = euler_torque(inertia, t.rate_shell_rad_s, DVec3::ZERO);
                let torque = euler_torque(inertia, DVec3::ZERO, angular) + sign * gyroscopic;
                sensor.forces_m_s2(&Load {
                    specific_force_m_s2: back * (t.linear_ground_m_s2 - gravity),
                    torque_m2_s2: torque,
                })
            })
            .collect()
    };
    let error = |gravity, sign| departure(&forces(gravity, sign), &truth.limb_force_per_mass_m_s2);
    fails_clearly("no gravity", error(DVec3::ZERO, 1.0), limit);
    if ours.motion.mode != Mode::Linear {
        let gravity = ours.gravity_ground_m_s2;
        fails_clearly("w x Iw of the wrong sign", error(gravity, -1.0), limit);
    }
}

#[test]
fn inv_a_written_session_reads_back_as_played() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut plan = small(5);
    plan.rig.mounting = Mounting::AxisLevel;
    plan.chain.amplifier_high_pass_hz = 0.02;
    // A sample rate that no short decimal has.
    plan.defect = DefectChoice::Exactly(exactly(Kind::SampleRate, (1.0_f64 / 0.97).ln()));
    let played = simulate_session(&plan).expect("the plan can be played");
    for extension in ["csv", "csv.gz", "parquet", "tdms", "npz"] {
        let path =
            write(&played, &folder.path().join(extension), extension).expect("it can be written");
        let file = SessionFile::read(&path).expect("a session that was written can be read");
        assert_eq!(
            file.session.preprocessing.amplifier_high_pass_hz,
            Some(0.02)
        );
        assert_eq!(file.session.recording.len(), played.recordings.len());
        for (index, recording) in played.recordings.iter().enumerate() {
            let (trial, _) = Trial::read(&file, index).expect("a recording that was written loads");
            let name = &trial.name;
            assert!(trial.voltage_v == recording.voltage_v, "{name}: voltages");
            assert!(
                trial.accelerometer_m_s2 == recording.accelerometer_m_s2,
                "{name}: accelerometer"
            );
            assert!(
                trial.gyroscope_rad_s == recording.gyroscope_rad_s,
                "{name}: gyroscope"
            );
            assert_eq!(trial.role, recording.role);
            assert_eq!(trial.sample_rate_hz, recording.sample_rate_hz, "{name}");
            if let Some(gains) = &recording.entry().gain_n_per_v {
                assert_eq!(trial.gains.gain_n_per_v, gains.each(), "{name}");
            }
            if trial.role != Role::Static {
                let down = trial.gravity_ground_m_s2.normalize();
                assert!(
                    down.dot(trial.direction_ground).abs() < 1e-9,
                    "{name}: down"
                );
            }
        }
    }
}

/// Every file of a folder with its bytes.
fn bytes(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut files = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in std::fs::read_dir(next).expect("the folder can be listed") {
            let path = entry.expect("its entries can be read").path();
            if path.is_dir() {
                folders.push(path);
            } else {
                let name = path.strip_prefix(folder).expect("it is inside").to_owned();
                files.push((name, std::fs::read(&path).expect("it can be read")));
            }
        }
    }
    files.sort();
    files
}

#[test]
fn inv_one_seed_makes_one_session_bit_for_bit() {
    let folder = tempfile::tempdir().expect("a folder");
    for extension in ["csv", "csv.gz", "parquet", "tdms", "npz"] {
        let [a, b, other] = [("a", 6), ("b", 6), ("other", 7)].map(|(name, seed)| {
            let played = simulate_session(&small(seed)).expect("the plan can be played");
            let path = folder.path().join(extension).join(name);
            write(&played, &path, extension).expect("it can be written");
            bytes(&path)
        });
        assert!(a.len() > 20, "{extension}: recordings, truth, session file");
        assert!(a == b, "{extension}: the same seed writes other bytes");
        assert!(
            a != other,
            "{extension}: another seed writes the same bytes"
        );
    }
}

#[test]
fn inv_writing_that_fails_leaves_no_session_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let played = simulate_session(&small(8)).expect("the plan can be played");
    let path = write(&played, folder.path(), "npz").expect("it can be written");
    assert!(path.exists());
    // A file where the truth's folder has to be.
    std::fs::remove_dir_all(folder.path().join(TRUTH_FOLDER)).expect("it can be removed");
    std::fs::write(folder.path().join(TRUTH_FOLDER), "in the way").expect("it can be written");
    assert!(write(&played, folder.path(), "npz").is_err());
    assert!(!folder.path().join(SESSION_FILE).exists());
}

#[test]
fn inv_a_printed_plan_is_the_plan() {
    let mut plans = vec![SessionPlan::default(), small(9), silent(9, 4)];
    plans[1].chain.coupling = CouplingChoice::Ideal;
    plans[1].defect = DefectChoice::Random;
    for kind in Kind::ALL {
        let drawn = Defect::draw(*kind, &small(1), &mut Pcg64::seed_from_u64(3));
        plans.extend(
            [DefectChoice::Kind(*kind), DefectChoice::Exactly(drawn)]
                .map(|defect| SessionPlan { defect, ..small(1) }),
        );
    }
    plans.extend(Room::ALL.map(|room| room.holding(small(2))));
    for plan in plans {
        let text = plan_file::with_comments(&plan);
        let again = plan_file::parse(Path::new("plan.toml"), &text).expect("it can be parsed");
        assert_eq!(again, plan, "{text}");
        check::check(&plan).expect("it can be played");
        // Whole: as many keys as the plan has.
        let written = text
            .lines()
            .filter(|line| line.contains(" = ") && !line.starts_with('#'))
            .count();
        let value = serde_json::to_value(&plan).expect("a plan is JSON, too");
        let tables = ["rig", "limbs", "chain", "instruments"].map(|name| &value[name]);
        let keys = |value: &serde_json::Value| value.as_object().map_or(0, serde_json::Map::len);
        let there: usize = tables.into_iter().map(keys).sum();
        assert_eq!(written, keys(&value) - tables.len() + there, "{text}");
    }
}

#[test]
fn inv_a_plan_is_refused_with_its_line() {
    let path = Path::new("plan.toml");
    for (text, line) in [
        ("seed = 1\nsed = 2\n", 2),
        ("\n[rig]\nrest_s = 0.1\nrest = 1.0\n", 4),
        ("engine = \"mujoko\"\n", 1),
        ("seed = -1\n", 1),
        (
            "defect = { exactly = { kind = \"dead_limb\", magnitude = 1.0, more = 1 } }",
            1,
        ),
        ("seed =", 1),
    ] {
        let error = plan_file::parse(path, text).expect_err(text);
        assert_eq!(error.line, Some(line), "{error}");
    }
}

#[test]
fn inv_a_plan_that_cannot_be_played_is_refused() {
    let refused = |change: &dyn Fn(&mut SessionPlan)| {
        let mut plan = small(1);
        change(&mut plan);
        assert!(check::check(&plan).is_err(), "{plan:#?} is let pass");
    };
    for value in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e300, 1e-300] {
        refused(&|p| p.sample_rate_hz = value);
        refused(&|p| p.static_duration_s = value);
    }
    for value in [-1.0, f64::NAN, f64::INFINITY, 1e300] {
        refused(&|p| p.rig.slider_amplitude_m = value);
        refused(&|p| p.rig.rotation_amplitude_rad = value);
        refused(&|p| p.chain.full_scale_v = value);
        refused(&|p| p.rig.rest_s = value);
        refused(&|p| p.rig.ramp_periods = value);
        refused(&|p| p.rig.steady_periods = value);
        refused(&|p| p.rig.wedge_error_deg = value);
        refused(&|p| p.rig.high_band_hz.1 = value);
        refused(&|p| p.chain.stiffness_spread = value);
        refused(&|p| p.limbs.lateral_stiffness = value);
        refused(&|p| p.chain.amplifier_high_pass_hz = value);
        refused(&|p| p.instruments.class_percent = value);
        refused(&|p| p.instruments.gyroscope_bandwidth_hz = value);
    }
    refused(&|p| p.chain.signal_to_noise_db = f64::NAN);
    refused(&|p| p.chain.resolution_bits = u32::MAX);
    refused(&|p| p.trials_per_step = 2);
    refused(&|p| p.trials_per_step = usize::MAX);
    refused(&|p| {
        p.engine = Engine::Rigid;
        p.limbs.mass = 0.01;
    });
    for defect in [
        Defect {
            channel: LIMBS,
            ..exactly(Kind::DeadLimb, 0.5)
        },
        Defect {
            place: Where::Trial(12),
            ..exactly(Kind::DriftDuringRun, 0.1)
        },
        exactly(Kind::DeadLimb, 1.1),
        exactly(Kind::DeadLimb, -0.1),
        exactly(Kind::SampleRate, f64::NAN),
        exactly(Kind::ConnectingRod, 0.99),
        exactly(Kind::TiltedAxis, 91.0),
    ] {
        refused(&|p| p.defect = DefectChoice::Exactly(defect));
    }
}
