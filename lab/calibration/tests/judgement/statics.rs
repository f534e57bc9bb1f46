//! What the limbs should carry: equilibrium, coordination, turned weight; and the jackknife.

use glam::DVec3;
use sixaxis_calibration::diagnosis::gravity::turned_gravity_m_s2;
use sixaxis_calibration::steps::jackknife;
use sixaxis_core::geometry::DIRECTIONS_SHELL;
use sixaxis_core::identify::inertia::euler_torque;
use sixaxis_core::identify::static_load_sharing::StaticLoadSharing;
use sixaxis_core::{Geometry, InertiaPerMass, LIMBS};

/// Rounding of sums of nine terms.
const ROUNDING: f64 = 1e-12;

#[test]
fn inv_shares_carry_the_wrench_and_obey_coordination() {
    let geometry = Geometry {
        limb_length_m: 0.03,
        half_edge_m: 0.013,
    };
    let inertia = InertiaPerMass::from_paper_order([240e-6, 250e-6, 260e-6, 1e-6, -2e-6, 3e-6]);
    let (a, w, dw) = (
        DVec3::new(1.0, -2.0, 3.0),
        DVec3::new(4.0, 5.0, -6.0),
        DVec3::new(-70.0, 80.0, 90.0),
    );
    let shares = StaticLoadSharing::new(&geometry).expect("three nodes hold a body");
    let euler = euler_torque(&inertia, w, dw);
    let f: [f64; LIMBS] = core::array::from_fn(|i| {
        shares.of_acceleration(i).dot(a) + shares.of_torque_per_m(i).dot(euler)
    });
    let force: DVec3 = (0..LIMBS).map(|i| DIRECTIONS_SHELL[i] * f[i]).sum();
    let hinges = geometry.mass_hinges_m();
    let torque: DVec3 = (0..LIMBS)
        .map(|i| hinges[i].cross(DIRECTIONS_SHELL[i]) * f[i])
        .sum();
    assert!((force - a).length() < ROUNDING * a.length());
    assert!((torque - euler).length() < ROUNDING * euler.length());
    for limbs in [[0, 1, 3, 4], [0, 2, 6, 8], [4, 5, 7, 8]] {
        let sum: f64 = limbs.iter().map(|i| f[*i]).sum();
        assert!(sum.abs() < ROUNDING * a.length(), "{limbs:?}: {sum}");
    }
}

#[test]
fn inv_weight_turns_against_the_sensor() {
    // A quarter turn about z brings what hung along -y to hang along -x of the shell: R^T (0, -g, 0) = (-g, 0, 0).
    let down = DVec3::new(0.0, -9.8, 0.0);
    let change = turned_gravity_m_s2(down, DVec3::Z, core::f64::consts::FRAC_PI_2);
    assert!((change - (down - DVec3::new(-9.8, 0.0, 0.0))).length() < ROUNDING * 9.8);
    assert_eq!(turned_gravity_m_s2(down, DVec3::Z, 0.0), DVec3::ZERO);
    // Along the axis nothing turns.
    assert!(turned_gravity_m_s2(down, DVec3::Y, 1.0).length() < ROUNDING * 9.8);
}

#[test]
fn inv_jackknife_of_a_mean_is_its_standard_error() {
    let values = [3.0, 1.0, 4.0, 1.0, 5.0, 9.0, 2.0, 6.0];
    let n = values.len() as f64;
    let sum: f64 = values.iter().sum();
    let left_out: Vec<f64> = values.iter().map(|v| (sum - v) / (n - 1.0)).collect();
    let mean = sum / n;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
    let found = jackknife(&left_out).expect("enough values");
    assert!((found - (variance / n).sqrt()).abs() < ROUNDING);
    assert_eq!(jackknife(&left_out[..2]), None);
}
