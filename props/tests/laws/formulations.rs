//! One sensor by three derivations that share no equation of motion.

use glam::DVec3;
use proptest::prelude::*;
use sixaxis_props::compare::{fails_clearly, largest, within};
use sixaxis_props::manufactured::examples;
use sixaxis_props::manufactured::formulations::{Canonical, Mass, Shell, ShellMotion, solve};
use sixaxis_props::manufactured::motion::Manufactured;
use sixaxis_props::strategy::{config, manufactured};
use sixaxis_props::tolerance;

const SAMPLES_PER_PERIOD: f64 = 100.0;
const SAMPLES: usize = 250;
/// Runge-Kutta steps from sample to sample: converged, see `order_formulations_converge_with_the_fourth_power`.
const STEPS: usize = 32;
/// Classical Runge-Kutta.
const ORDER_OF_INTEGRATION: f64 = 4.0;

/// Largest difference over the largest value.
fn apart(a: &[ShellMotion], b: &[ShellMotion], get: Get) -> f64 {
    let peak = largest(a.iter().map(|t| get(t).length()));
    largest(a.iter().zip(b).map(|(a, b)| (get(a) - get(b)).length())) / peak
}

/// What is read of a shell's motion.
type Get = fn(&ShellMotion) -> DVec3;
/// What is broken in a sensor.
type Change = fn(&mut Manufactured);

const QUANTITIES: [(&str, Get); 3] = [
    ("linear acceleration", |t| t.linear_ground_m_s2),
    ("angular acceleration", |t| t.angular_ground_rad_s2),
    ("rate", |t| t.rate_shell_rad_s),
];

fn all(sensor: &Manufactured, steps: usize) -> [(&'static str, Vec<ShellMotion>); 3] {
    let rate_hz = sensor.highest_frequency_hz() * SAMPLES_PER_PERIOD;
    [
        ("shell", solve::<Shell>(sensor, rate_hz, SAMPLES, steps)),
        ("mass", solve::<Mass>(sensor, rate_hz, SAMPLES, steps)),
        (
            "canonical",
            solve::<Canonical>(sensor, rate_hz, SAMPLES, steps),
        ),
    ]
}

/// Steps from sample to sample that resolve the fastest thing there is: the vibration or the turning of the shell.
fn steps(sensor: &Manufactured) -> usize {
    let rate_hz = sensor.highest_frequency_hz() * SAMPLES_PER_PERIOD;
    let turning = largest(
        solve::<Mass>(sensor, rate_hz, SAMPLES, 1)
            .iter()
            .map(|t| t.rate_shell_rad_s.length()),
    );
    let vibration = core::f64::consts::TAU * sensor.highest_frequency_hz();
    STEPS.max((0.5 * STEPS as f64 * (1.0 + turning / vibration)) as usize)
}

proptest! {
    #![proptest_config(config(24))]

    #[test]
    fn prop_three_derivations_agree(sensor in manufactured()) {
        let solutions = all(&sensor, steps(&sensor));
        for (i, (name, a)) in solutions.iter().enumerate() {
            for (other, b) in &solutions[i + 1..] {
                for (quantity, get) in QUANTITIES {
                    let what = format!("{quantity}: {name} against {other}");
                    let limit = match *other {
                        "canonical" => tolerance::CANONICAL,
                        _ => tolerance::FORMULATIONS,
                    };
                    within(&what, apart(a, b, get), limit);
                }
            }
        }
    }
}

/// Each derivation against itself at half the step: what is left is the integrator's alone.
#[test]
fn order_formulations_converge_with_the_fourth_power() {
    let sensor = examples::turning();
    let levels = [1, 2, 4].map(|steps| all(&sensor, steps));
    for (index, (name, _)) in levels[0].iter().enumerate() {
        let [coarse, half, quarter] = [0, 1, 2].map(|level| &levels[level][index].1);
        let get = QUANTITIES[2].1;
        let order = (apart(coarse, half, get) / apart(half, quarter, get)).log2();
        within(
            format!("order of the {name} formulation's integration"),
            (order - ORDER_OF_INTEGRATION).abs(),
            tolerance::CONVERGENCE,
        );
    }
}

/// A wrong derivation must be seen: the same solution with one ingredient changed.
#[test]
fn law_a_wrong_ingredient_sets_the_derivations_apart() {
    let sensor = examples::turning();
    let [(_, sound), ..] = all(&sensor, STEPS);
    let rate_hz = sensor.highest_frequency_hz() * SAMPLES_PER_PERIOD;
    let changes: [(&str, Change); 4] = [
        ("I1 off by a millionth", |s| {
            s.parameters.inertia_per_mass.xx_m2 *= 1.0 + 1e-6
        }),
        ("I5 of the wrong sign", |s| {
            s.parameters.inertia_per_mass.xz_m2 *= -1.0
        }),
        ("k/m off by a millionth", |s| {
            s.parameters.stiffness_per_mass_per_s2 *= 1.0 + 1e-6
        }),
        ("limbs a tenth of a millimetre longer", |s| {
            s.geometry.limb_length_m += 1e-4
        }),
    ];
    for (what, change) in changes {
        let mut wrong = sensor;
        change(&mut wrong);
        let broken = solve::<Mass>(&wrong, rate_hz, SAMPLES, STEPS);
        let seen = largest(QUANTITIES.map(|(_, get)| apart(&sound, &broken, get)));
        fails_clearly(what, seen, tolerance::CANONICAL);
    }
}
