//! Adversarial input: finite numbers of any size, NaN and the infinities, records and sensors spoiled with them; and the
//! counter-examples that were found.

use glam::{DQuat, DVec3};
use proptest::prelude::*;
use proptest::test_runner::{Config, FileFailurePersistence};
use sixaxis_core::{Gains, Geometry, InertiaPerMass, Parameters, Sensor, Settings};
use sixaxis_props::truth;

use sixaxis_props::strategy::{any_f64_edge, config};

/// [`config`] that also runs the counter-examples kept for a suite in `proptest-regressions` and adds those it finds: the file
/// is committed, and without it, or without leave to write, only the memory is lost.
pub fn remembering(cases: u32, suite: &str) -> Config {
    let file = format!(
        "{}/proptest-regressions/{suite}.txt",
        env!("CARGO_MANIFEST_DIR")
    );
    // Proptest wants a path that lives as long as the program.
    let file = String::leak(file);
    Config {
        failure_persistence: Some(Box::new(FileFailurePersistence::Direct(file))),
        ..config(cases)
    }
}

/// A finite number of any size, the ends of the range often.
pub fn extreme() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => (-330.0..308.5_f64, prop::bool::ANY).prop_map(|(exponent, negative)| {
            let size = 10.0_f64.powf(exponent).min(f64::MAX);
            if negative { -size } else { size }
        }),
        1 => prop::sample::select(vec![0.0, -0.0, f64::MAX, f64::MIN, f64::MIN_POSITIVE, 1e-300, 1e300, 1e154]),
        2 => -10.0..10.0_f64,
    ]
}

/// An edge of f64, or a finite number of any size.
pub fn adversarial_f64() -> impl Strategy<Value = f64> {
    prop_oneof![any_f64_edge(), extreme()]
}

/// `sound` with up to three of its numbers replaced by adversarial ones, and which.
pub fn spoiled<const N: usize>(sound: [f64; N]) -> impl Strategy<Value = ([f64; N], Vec<usize>)> {
    prop::collection::vec((0..N, adversarial_f64()), 0..=3).prop_map(move |changes| {
        let mut numbers = sound;
        for &(i, value) in &changes {
            numbers[i] = value;
        }
        (numbers, changes.into_iter().map(|(i, _)| i).collect())
    })
}

/// N channels of up to `longest` samples, none and one among them: sound, all of one wild size, or with adversarial
/// numbers strewn in.
pub fn record<const N: usize>(longest: usize) -> impl Strategy<Value = Vec<[f64; N]>> {
    let sample = prop::collection::vec(-1.0..1.0_f64, N);
    let rows = prop::collection::vec(sample, 0..=longest);
    let strewn = prop::collection::vec((any::<usize>(), adversarial_f64()), 0..4);
    let size = prop_oneof![2 => Just(1.0), 1 => extreme()];
    (rows, size, strewn).prop_map(|(rows, size, strewn)| {
        let mut flat: Vec<f64> = rows.into_iter().flatten().map(|x| x * size).collect();
        for (place, value) in strewn {
            if !flat.is_empty() {
                let i = place % flat.len();
                flat[i] = value;
            }
        }
        flat.chunks_exact(N)
            .map(|row| core::array::from_fn(|i| row[i]))
            .collect()
    })
}

/// Names of the six entries; as a whole they go by `inertia_per_mass`.
pub const INERTIA: [&str; 6] = ["xx_m2", "yy_m2", "zz_m2", "xy_m2", "xz_m2", "yz_m2"];

/// The paper's sensor under gravity as one row of numbers, group by group, with the name that an error gives to each.
fn sound_setup() -> [(&'static str, f64); 47] {
    let sound = truth::identified_parameters();
    let vector = |name, v: [f64; 3]| v.map(|x| (name, x)).to_vec();
    let groups = [
        sound.zero_drift_v.map(|d| ("zero_drift_v", d)).to_vec(),
        sound
            .scale_per_mass_per_kg
            .map(|s| ("scale_per_mass_per_kg", s))
            .to_vec(),
        vec![("gain_n_per_v", 1.0); 9],
        INERTIA
            .into_iter()
            .zip(sound.inertia_per_mass.to_paper_order())
            .collect(),
        vec![("stiffness_per_mass_per_s2", sound.stiffness_per_mass_per_s2)],
        vec![("limb_length_m", Geometry::PAPER.limb_length_m)],
        vec![("half_edge_m", Geometry::PAPER.half_edge_m)],
        vec![("sample_rate_hz", 1e4)],
        vector("gravity_ground_m_s2", [0.0, 0.0, -9.81]),
        vector("initial_rate_shell_rad_s", [0.0; 3]),
        [0.0, 0.0, 0.0, 1.0]
            .map(|q| ("initial_attitude", q))
            .to_vec(),
    ];
    let all: Vec<_> = groups.into_iter().flatten().collect();
    core::array::from_fn(|i| all[i])
}

/// A sensor with up to three of all its numbers adversarial, and the names of those.
pub fn adversarial_setup()
-> impl Strategy<Value = ((Sensor, Parameters, Settings), Vec<&'static str>)> {
    let sound = sound_setup();
    spoiled(sound.map(|(_, value)| value)).prop_map(move |(x, places)| {
        let nine = |from: usize| core::array::from_fn(|i| x[from + i]);
        let three = |from: usize| DVec3::new(x[from], x[from + 1], x[from + 2]);
        let sensor = Sensor {
            geometry: Geometry {
                limb_length_m: x[34],
                half_edge_m: x[35],
            },
            gains: Gains {
                gain_n_per_v: nine(18),
            },
        };
        let parameters = Parameters {
            zero_drift_v: nine(0),
            scale_per_mass_per_kg: nine(9),
            inertia_per_mass: InertiaPerMass::from_paper_order(core::array::from_fn(|i| x[27 + i])),
            stiffness_per_mass_per_s2: x[33],
        };
        let settings = Settings {
            gravity_ground_m_s2: three(37),
            initial_rate_shell_rad_s: three(40),
            initial_attitude: DQuat::from_xyzw(x[43], x[44], x[45], x[46]),
            ..Settings::new(x[36])
        };
        let names = places.iter().map(|&i| sound[i].0).collect();
        ((sensor, parameters, settings), names)
    })
}
