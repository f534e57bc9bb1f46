//! Limbs that are not ideal: MuJoCo against statics, the energy of bent hinges and rods integrated point by point.

use core::f64::consts::TAU;

use glam::DVec3;
use nalgebra::{Matrix3x6, Matrix6, SMatrix, SymmetricEigen, Vector3, Vector6};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use sixaxis_core::redundancy::fault::Watch;
use sixaxis_core::redundancy::reconstruction::MOST_EXCLUDED;
use sixaxis_core::redundancy::tolerant::{FaultTolerant, ROWS_KEPT};
use sixaxis_core::{Decoupler, LIMBS, LimbSet, Parameters, Scheme, Settings, SixAxis};
use sixaxis_props::compare::{fails_clearly, largest, within};
use sixaxis_props::problem::rig::{RATE_HZ, STEPS, model, short_run};
use sixaxis_props::tolerance::{self, Tolerance};
use sixaxis_props::truth::{self, InCore};
use sixaxis_reference::compliant::compliant_forces_m_s2;
use sixaxis_reference::geometry::Geometry;
use sixaxis_reference::laboratory::Laboratory;
use sixaxis_reference::laboratory::recording::SimulatedRecording;
use sixaxis_reference::limbs::Limbs;
use sixaxis_reference::motion::SimulatedRun;
use sixaxis_reference::mujoco::model::SensorModel;
use sixaxis_reference::mujoco::ring_down;
use sixaxis_reference::mujoco::simulate_run;
use sixaxis_reference::mujoco::simulation::Simulation;
use sixaxis_reference::rig::run::{Mode, Mounting, Run};
use sixaxis_reference::rigid::{RigidSensor, torque_per_mass};
use sixaxis_reference::sensor::TrueSensor;

const DIRECTION: DVec3 = DVec3::new(2.0, 1.0, 1.0);
/// Limbs that bend: a twentieth of the axial stiffness, both flexures together.
const BENDING: Limbs = Limbs {
    lateral_stiffness: 0.05,
    ..Limbs::IDEAL
};
/// Limbs of a fiftieth of the seismic mass each.
const MASSIVE: Limbs = Limbs {
    mass: 0.02,
    ..Limbs::IDEAL
};

fn sensor(limbs: Limbs) -> SensorModel {
    let parameters = truth::identified_parameters();
    SensorModel {
        limbs,
        ..model(&parameters, DIRECTION, Mounting::AxisVertical)
    }
}

fn played(limbs: Limbs, mode: Mode) -> SimulatedRun {
    let run = short_run(mode, DIRECTION);
    simulate_run(&sensor(limbs), &run, RATE_HZ, STEPS).expect("the step is stable")
}

fn departure(ours: &[[f64; LIMBS]], truth: &[[f64; LIMBS]]) -> f64 {
    assert_eq!(ours.len(), truth.len());
    let pairs = ours.iter().zip(truth);
    let apart = pairs.flat_map(|(a, b)| (0..LIMBS).map(move |i| a[i] - b[i]));
    largest(apart) / largest(truth.iter().flatten().copied())
}

/// Over their mean.
const UNEQUAL: [f64; LIMBS] = [1.05, 0.93, 1.0, 0.98, 1.1, 0.9, 1.02, 0.97, 1.05];

#[test]
fn ref_unequal_limbs_share_loads_by_their_stiffness() {
    let stiffness_ratio = UNEQUAL;
    let limbs = Limbs {
        stiffness_ratio,
        ..Limbs::IDEAL
    };
    let parameters = truth::identified_parameters();
    let limit = tolerance::rigid_limbs(5.0, parameters.stiffness_per_mass_per_s2);
    for mode in [Mode::Linear, Mode::Compound] {
        let played = played(limbs, mode);
        let rigid = |ratio| {
            RigidSensor::new(&truth::sensor(&parameters), ratio)
                .expect("three nodes hold a body")
                .simulate(&played.motion, played.gravity_ground_m_s2, RATE_HZ)
                .limb_force_per_mass_m_s2
        };
        let off = |ratio| departure(&played.limb_force_per_mass_m_s2, &rigid(ratio));
        within("forces of unequal limbs", off(&stiffness_ratio), limit);
        fails_clearly("as if they were equal", off(&[1.0; LIMBS]), limit);
    }
}

/// Three engines of a mass whose centre is not the cube's: MuJoCo, closed form, and statics at each instant.
#[test]
fn ref_a_mass_off_the_middle_is_mujocos() {
    let middle = truth::sensor(&truth::identified_parameters());
    let off = TrueSensor {
        mass_centre_m: [4e-4, -3e-4, 2e-4],
        ..middle
    };
    let limit = tolerance::rigid_limbs(5.0, middle.stiffness_per_mass_per_s2);
    for mode in [Mode::Linear, Mode::Angular, Mode::Compound] {
        for mounting in [Mounting::AxisVertical, Mounting::AxisLevel] {
            let gravity_ground_m_s2 = mounting.gravity_ground_m_s2(DIRECTION);
            let run = short_run(mode, DIRECTION);
            let model = SensorModel::new(&off, gravity_ground_m_s2);
            let played = simulate_run(&model, &run, RATE_HZ, STEPS).expect("the step is stable");
            let rigid = |sensor| {
                RigidSensor::new(sensor, &[1.0; LIMBS])
                    .expect("three nodes hold a body")
                    .simulate(&run, gravity_ground_m_s2, RATE_HZ)
            };
            let compliant = compliant_forces_m_s2(&off, gravity_ground_m_s2, &rigid(&off).truth);
            let compliant = compliant.expect("limbs that hold the mass");
            let departure = |forces: &[_]| departure(forces, &played.limb_force_per_mass_m_s2);
            let ours = rigid(&off).limb_force_per_mass_m_s2;
            within(
                "rigid limbs of a mass off the middle",
                departure(&ours),
                limit,
            );
            within("compliant ones", departure(&compliant), limit);
            let held = rigid(&middle).limb_force_per_mass_m_s2;
            fails_clearly("a mass in the middle", departure(&held), limit);
        }
    }
}

/// Every set that can be excluded, of limbs a tenth apart, and as if they were equal.
#[test]
fn ref_excluded_limbs_bear_what_their_stiffness_says() {
    let limbs = Limbs {
        stiffness_ratio: UNEQUAL,
        ..Limbs::IDEAL
    };
    let parameters = truth::identified_parameters();
    let run = short_run(Mode::Compound, DIRECTION);
    let play = |model: &SensorModel| {
        let played = simulate_run(model, &run, RATE_HZ, STEPS).expect("the step is stable");
        Laboratory::noise_free(truth::sensor(&parameters)).record(&played, 0)
    };
    let damped = sensor(limbs);
    let undamped = SensorModel {
        damping_ratio: 0.0,
        ..damped
    };
    for (recording, limit) in [
        (play(&undamped), tolerance::WITHOUT_UNEQUAL_LIMBS),
        (play(&damped), tolerance::WITHOUT_UNEQUAL_DAMPED_LIMBS),
    ] {
        without_unequal_limbs(&recording, &parameters, limit);
    }
}

fn without_unequal_limbs(
    recording: &SimulatedRecording,
    parameters: &Parameters,
    limit: Tolerance,
) {
    let decoupler = |set: LimbSet, stiffness_ratio| {
        let settings = Settings {
            stiffness_ratio,
            ..recording.settings(Scheme::Heun)
        };
        let decoupler = Decoupler::new(&recording.sensor(), parameters, &settings);
        decoupler.and_then(|decoupler| decoupler.excluding(set))
    };
    let decoupled = |mut decoupler: Decoupler| -> Vec<SixAxis> {
        let rows = recording.voltage_v.iter();
        let push = |row| decoupler.push(row).expect("a sound sample");
        rows.filter_map(push).collect()
    };
    let all = decoupled(decoupler(LimbSet::EMPTY, UNEQUAL).expect("nine limbs"));
    let beyond = |ours: &[SixAxis]| {
        let off = |of: fn(&SixAxis) -> DVec3| {
            let pairs = ours.iter().zip(&all);
            largest(pairs.map(|(a, b)| (of(a) - of(b)).length()))
                / largest(all.iter().map(|b| of(b).length()))
        };
        let linear = off(|six| six.linear_ground_m_s2);
        linear.max(off(|six| six.angular_ground_rad_s2))
    };
    let sets = || (1..=MOST_EXCLUDED).flat_map(LimbSet::of_size);
    let worst = |ratio: [f64; LIMBS]| {
        let without = sets().filter_map(|set| decoupler(set, ratio).ok());
        largest(without.map(|decoupler| beyond(&decoupled(decoupler))))
    };
    within(
        "accelerations without limbs, unequal ones",
        worst(UNEQUAL),
        limit,
    );
    fails_clearly("as if they were equal", worst([1.0; LIMBS]), limit);
    // The block's way is another code.
    let set = LimbSet::from_numbers([3, 8]).expect("limbs");
    let mut by_record = decoupler(set, UNEQUAL).expect("a survivable set");
    let mut found = Vec::new();
    by_record
        .push_record(&recording.voltage_v, &mut |done| {
            found.extend(done.iter().map(|six| six.accelerations()))
        })
        .expect("sound samples");
    let one_by_one = decoupled(decoupler(set, UNEQUAL).expect("a survivable set"));
    assert_eq!(found.len(), one_by_one.len());
    let one_by_one: Vec<[f64; 6]> = one_by_one.iter().map(SixAxis::accelerations).collect();
    let columns = (0..6).map(|i| {
        let apart = largest(found.iter().zip(&one_by_one).map(|(a, b)| a[i] - b[i]));
        apart / largest(one_by_one.iter().map(|b| b[i]))
    });
    let apart = largest(columns);
    within("by record and sample by sample", apart, tolerance::PATHS);
}

/// Unequal limbs that are known to be so fail no more than equal ones, weight and all.
#[test]
fn neg_unequal_limbs_are_no_failed_ones() {
    let limbs = Limbs {
        stiffness_ratio: UNEQUAL,
        ..Limbs::IDEAL
    };
    let parameters = truth::identified_parameters();
    let recording = Laboratory::noise_free(truth::sensor(&parameters))
        .record(&played(limbs, Mode::Compound), 0);
    let noise_v = 1e-3 * largest(recording.voltage_v.iter().flatten().copied());
    let failed = |stiffness_ratio| {
        let settings = Settings {
            stiffness_ratio,
            ..recording.settings(Scheme::Heun)
        };
        let watch = Watch::exact(1.0, [noise_v; LIMBS]);
        let rows = vec![[0.0; LIMBS]; ROWS_KEPT];
        let mut stream =
            FaultTolerant::new(&recording.sensor(), &parameters, &settings, &watch, rows)
                .expect("a sound sensor");
        let rng = &mut Pcg64::new(1, 1);
        let mut events = 0;
        for row in &recording.voltage_v {
            let noisy = row.map(|u| {
                let unit: f64 = StandardNormal.sample(rng);
                u + noise_v * unit
            });
            events += usize::from(stream.push(&noisy).expect("finite").event.is_some());
        }
        events
    };
    assert_eq!(failed(UNEQUAL), 0);
    assert!(failed([1.0; LIMBS]) > 0, "as if they were equal");
}

/// The rotation vectors of both hinges of a limb, rad, for each unit of the mass's displacement and rotation, m and rad.
fn hinge_angles(limb: usize) -> [Matrix3x6<f64>; 2] {
    let geometry = Geometry::PAPER;
    let along = Geometry::directions_shell()[limb];
    let end = geometry.mass_hinges_m()[limb];
    let columns = [0, 1, 2, 3, 4, 5].map(|i| {
        let mut unit = [0.0; 6];
        unit[i] = 1.0;
        let (moved, turned) = (DVec3::from_slice(&unit[..3]), DVec3::from_slice(&unit[3..]));
        let tilt = along.cross(moved + turned.cross(end)) / geometry.limb_length_m;
        let bent = tilt - (turned - along * along.dot(turned));
        [tilt, bent].map(|angle| Vector3::from(angle.to_array()))
    });
    [0, 1].map(|hinge| Matrix3x6::from_columns(&columns.map(|column| column[hinge])))
}

/// What hinges of one unit of bending stiffness, N m/rad, make of the stiffness of the mass's six degrees of freedom.
fn bending() -> Matrix6<f64> {
    let hinges = (0..LIMBS).flat_map(hinge_angles);
    hinges.map(|angles| angles.transpose() * angles).sum()
}

/// Axial stiffness over k of the mass's six degrees of freedom, and the limbs' wrenches.
fn axial() -> (Matrix6<f64>, SMatrix<f64, LIMBS, 6>) {
    let wrenches = Geometry::PAPER.limb_wrenches();
    (wrenches.transpose() * wrenches, wrenches)
}

/// Bending stiffness of one hinge over k, m^2, that makes a limb as stiff square to its axis as stated.
fn hinge_over_k(lateral: f64) -> f64 {
    0.5 * lateral * Geometry::PAPER.limb_length_m.powi(2)
}

/// Six frequencies by the eigenproblem of K and M over the mass, ascending, Hz.
fn frequencies_hz(stiffness: Matrix6<f64>, mass: Matrix6<f64>) -> Vec<f64> {
    let lower = mass.cholesky().expect("a mass matrix").l();
    let inverse = lower.try_inverse().expect("a triangle");
    let eigen = SymmetricEigen::new(inverse * stiffness * inverse.transpose());
    let mut found: Vec<f64> = eigen
        .eigenvalues
        .iter()
        .map(|square| square.sqrt() / TAU)
        .collect();
    found.sort_by(f64::total_cmp);
    found
}

fn mass_alone() -> Matrix6<f64> {
    let tensor = sensor(Limbs::IDEAL).inertia_per_mass.tensor_m2();
    Matrix6::from_fn(|row, column| match (row, column) {
        (3.., 3..) => tensor.col(column - 3)[row - 3],
        _ => f64::from(u8::from(row == column)),
    })
}

fn ring_against(what: &str, limbs: Limbs, stiffness: Matrix6<f64>, mass: Matrix6<f64>) {
    let k = sensor(limbs).stiffness_per_mass_per_s2;
    let rung = ring_down::measure(&sensor(limbs)).expect("the step is stable");
    let off = |mass: Matrix6<f64>, stiffness: Matrix6<f64>| {
        let predicted = frequencies_hz(stiffness * k, mass);
        let pairs = rung.iter().zip(predicted);
        largest(pairs.map(|(mode, hz)| mode.measured_hz / hz - 1.0))
    };
    within(
        format!("modes, {what}"),
        off(mass, stiffness),
        tolerance::LIMB_MODES,
    );
    fails_clearly(
        format!("modes as without: {what}"),
        off(mass_alone(), axial().0),
        tolerance::LIMB_MODES,
    );
}

#[test]
fn ref_flexures_that_bend_raise_the_modes() {
    let stiffness = axial().0 + bending() * hinge_over_k(BENDING.lateral_stiffness);
    ring_against("flexures that bend", BENDING, stiffness, mass_alone());
}

#[test]
fn ref_flexures_that_bend_carry_part_of_the_weight() {
    let (axial, wrenches) = axial();
    for direction in [DVec3::X, DVec3::Y, DVec3::new(1.0, 2.0, -1.0)] {
        let gravity = Mounting::AxisVertical.gravity_ground_m_s2(direction);
        let model = SensorModel {
            gravity_ground_m_s2: gravity,
            ..sensor(BENDING)
        };
        let mut simulation = Simulation::new(&model, 1e-5).expect("the step is stable");
        let held = Run::new(Mode::Rest, 1.0, direction);
        let measured = simulation.snapshot(&held).limb_force_per_mass_m_s2;
        let weight = Vector6::new(gravity.x, gravity.y, gravity.z, 0.0, 0.0, 0.0);
        let off = |lateral: f64| {
            let stiffness = axial + bending() * hinge_over_k(lateral);
            let moved = stiffness.cholesky().expect("it holds").solve(&weight);
            let force = wrenches * -moved;
            largest((0..LIMBS).map(|i| measured[i] - force[i])) / largest(measured)
        };
        let lateral = BENDING.lateral_stiffness;
        within("forces at rest", off(lateral), tolerance::BENT_AT_REST);
        fails_clearly(
            "a tenth softer",
            off(0.9 * lateral),
            tolerance::BENT_AT_REST,
        );
    }
}

/// Points of a Gauss rule along a rod, from the shell to the mass, and their weights: exact for cubics.
fn rod() -> [(f64, f64); 2] {
    let offset = 0.5 / 3.0_f64.sqrt();
    [(0.5 - offset, 0.5), (0.5 + offset, 0.5)]
}

/// What rods add to the mass matrix if their ends on the shell stand still.
fn rods_at_rest(mass: f64) -> Matrix6<f64> {
    let ends = Geometry::PAPER.mass_hinges_m();
    let mut sum = Matrix6::zeros();
    for end in ends {
        let t = Vector3::from(end.to_array());
        let mut velocity = Matrix3x6::zeros();
        velocity.fixed_columns_mut::<3>(0).fill_with_identity();
        velocity
            .fixed_columns_mut::<3>(3)
            .copy_from(&-t.cross_matrix());
        for (share, weight) in rod() {
            sum += velocity.transpose() * velocity * (mass * weight * share * share);
        }
    }
    sum
}

#[test]
fn ref_a_third_of_a_limb_moves_with_the_mass() {
    let mass = mass_alone() + rods_at_rest(MASSIVE.mass);
    ring_against("limbs with mass", MASSIVE, axial().0, mass);
}

/// Forces of limbs that do not give way under the mass's inertia and that of rods, each point of which presses on the rod's ends as
/// on the supports of a beam. `ends_only` lumps half of each rod at its end instead.
fn beam_forces(run: &SimulatedRun, mass: f64, ends_only: bool) -> Vec<[f64; LIMBS]> {
    let geometry = Geometry::PAPER;
    let (axial, wrenches) = axial();
    let sharing = wrenches * axial.try_inverse().expect("three nodes hold a body");
    let inertia = sensor(MASSIVE).inertia_per_mass;
    let hinges: Vec<_> = geometry
        .shell_hinges_m()
        .into_iter()
        .zip(geometry.mass_hinges_m())
        .collect();
    let points = match ends_only {
        true => [(1.0, 0.25), (1.0, 0.25)],
        false => rod(),
    };
    run.truth
        .iter()
        .map(|truth| {
            let back = truth.attitude.inverse();
            let rate = truth.rate_shell_rad_s;
            let angular = back * truth.angular_ground_rad_s2;
            let specific = back * (truth.linear_ground_m_s2 - run.gravity_ground_m_s2);
            let mut force = specific;
            let mut torque = torque_per_mass(&inertia, rate, angular);
            for (from, to) in &hinges {
                for (share, weight) in points {
                    let place = from.lerp(*to, share);
                    let field = angular.cross(place) + rate.cross(rate.cross(place));
                    let pressed = (specific + field) * (mass * weight * share);
                    force += pressed;
                    torque += to.cross(pressed);
                }
            }
            let load = Vector6::new(force.x, force.y, force.z, torque.x, torque.y, torque.z);
            (sharing * load).into()
        })
        .collect()
}

#[test]
fn ref_limbs_with_mass_press_as_beams_do() {
    let k = sensor(MASSIVE).stiffness_per_mass_per_s2;
    let limit = tolerance::rigid_limbs(5.0, k);
    for mode in [Mode::Linear, Mode::Angular, Mode::Compound] {
        let played = played(MASSIVE, mode);
        let off = |mass, ends_only| {
            let forces = beam_forces(&played, mass, ends_only);
            departure(&played.limb_force_per_mass_m_s2, &forces)
        };
        within("forces of limbs with mass", off(MASSIVE.mass, false), limit);
        fails_clearly("as without mass", off(0.0, false), limit);
        if mode != Mode::Linear {
            fails_clearly("half of it at the end", off(MASSIVE.mass, true), limit);
        }
    }
}

/// Damping that Runge-Kutta's step would blow up is refused, not simulated.
#[test]
fn inv_damping_beyond_the_step_is_refused() {
    let damped = |lateral_damping| {
        let limbs = Limbs {
            lateral_damping,
            ..Limbs::IDEAL
        };
        Simulation::new(&sensor(limbs), 1.0 / (RATE_HZ * STEPS as f64))
    };
    assert!(damped(0.02).is_ok());
    assert!(damped(0.2).is_err(), "it grows from rounding");
}

#[test]
fn ref_flexures_that_damp_take_their_share() {
    const DAMPED: Limbs = Limbs {
        lateral_damping: 0.02,
        ..Limbs::IDEAL
    };
    let (axial, wrenches) = axial();
    let compliance = axial.try_inverse().expect("three nodes hold a body");
    let free = played(Limbs::IDEAL, Mode::Compound);
    let damped = played(DAMPED, Mode::Compound);
    let k = sensor(DAMPED).stiffness_per_mass_per_s2;
    // Damping over stiffness, s, as a lateral stiffness over k would be.
    let share = bending() * hinge_over_k(2.0 * DAMPED.lateral_damping / k.sqrt());
    let forces = &free.limb_force_per_mass_m_s2;
    let effect = |sign: f64| {
        let apart = (1..forces.len() - 1).flat_map(|now| {
            let slope: SMatrix<f64, LIMBS, 1> = core::array::from_fn::<f64, LIMBS, _>(|i| {
                0.5 * RATE_HZ * (forces[now + 1][i] - forces[now - 1][i])
            })
            .into();
            // The mass moves by the compliance times the load, and what damps the motion is not felt by the limbs.
            let load = wrenches.transpose() * slope;
            let lost = wrenches * (compliance * (share * (compliance * load)));
            let seen = damped.limb_force_per_mass_m_s2[now];
            (0..LIMBS).map(move |i| (seen[i] - forces[now][i], -sign * lost[i]))
        });
        let pairs: Vec<(f64, f64)> = apart.collect();
        let size = largest(pairs.iter().map(|(seen, _)| *seen));
        largest(pairs.iter().map(|(seen, said)| seen - said)) / size
    };
    within(
        "what damping takes",
        effect(1.0),
        tolerance::LATERAL_DAMPING,
    );
    fails_clearly("given", effect(-1.0), tolerance::LATERAL_DAMPING);
}
