//! Printed claims that a page of arithmetic decides, and no campaign shows.

use core::f64::consts::TAU;

use glam::DVec3;
use nalgebra::{DMatrix, SVector};
use serde::Serialize;
use sixaxis_core::geometry::DIRECTIONS_SHELL;
use sixaxis_core::identify::inertia;
use sixaxis_core::identify::static_load_sharing::StaticLoadSharing;
use sixaxis_core::{Geometry, LIMBS};
use sixaxis_reference::linear_theory::relative_acceleration;
use sixaxis_reference::paper::{
    ANGULAR_THRESHOLD_RAD_S2, COMPOUND_TABLES, CompoundTable, LINEAR_THRESHOLD_M_S2,
};
use sixaxis_reference::rig::run::{Mode, ROTATION_AMPLITUDE_RAD, Run, SLIDER_AMPLITUDE_M};
use sixaxis_reference::sensor::TrueSensor;

/// Directions over which a threshold's range is sought: an even spread over half the sphere.
const DIRECTIONS: u32 = 4000;
/// Instants of a turn.
const INSTANTS: u32 = 360;
/// A singular value below this share of the largest is none.
const RANK: f64 = 1e-9;
/// Length of the connecting rod over the crank's for which the ledger states an example.
const ROD_OVER_CRANK: f64 = 5.0;
/// Distance of the sensor's centre from the pinion's axis for which the ledger states an example, m.
const OFF_AXIS_M: f64 = 1e-3;
/// The rig's highest frequency, Hz.
const HIGHEST_HZ: f64 = 5.0;
/// Frequency up to which section 4.3 takes relative motion for nothing, Hz.
const NEGLECTED_TO_HZ: f64 = 2.0;

/// The arithmetic.
#[derive(Debug, Clone, Serialize)]
pub struct Arithmetic {
    /// Rank of step 2's regressor (13) for two accelerations and for three that span space, those of the paper's wedges.
    pub scale_rank: [usize; 2],
    /// Condition number of the latter, columns scaled.
    pub scale_condition: f64,
    /// Rank of step 3's regressor (18) for turns about two axes, three axes of one plane, three axes that span space.
    pub inertia_rank: [usize; 3],
    /// The same for two instants whose rate and angular acceleration point anywhere.
    pub inertia_rank_free: usize,
    /// Frequencies at which the design sensor crosses the paper's thresholds, over all directions.
    pub thresholds: Thresholds,
    /// Largest relative linear acceleration of the identified sensor at 2 Hz over all directions, m/s^2: with half the slider's stroke
    /// as amplitude, with the whole.
    pub linear_at_2_hz_m_s2: [f64; 2],
    /// A slider's acceleration at twice the crank's frequency over that at the crank's, for a rod of `rod_over_crank`.
    pub rod_harmonic: f64,
    /// Length of that rod over the crank's.
    pub rod_over_crank: f64,
    /// Largest linear acceleration of a centre `off_axis_mm` off the axis in angular motion at 5 Hz, m/s^2.
    pub off_axis_m_s2: f64,
    /// Distance from the axis, mm.
    pub off_axis_mm: f64,
    /// Errors before identification with the drift taken off: Tables 4 to 6, as printed and by the parameters of Tables 1 to 3.
    pub before_without_drift: [BeforeWithoutDrift; 3],
    /// Largest difference of the two.
    pub before_departs: f64,
    /// Error before over error after identification as printed: in the cell of the largest error before, smallest, largest of all.
    pub printed_improvement: [f64; 3],
}

/// Six errors of a compound run before identification, over the amplitudes.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct BeforeWithoutDrift {
    /// Drive, Hz.
    pub frequency_hz: f64,
    /// As printed.
    pub printed: [f64; 6],
    /// Decoded in sensor axes, at the true rate, with the design's s/m and I/m.
    pub by_parameters: [f64; 6],
}

/// Smallest and largest threshold frequency over all directions, Hz, by linear theory.
#[derive(Debug, Clone, Serialize)]
pub struct Thresholds {
    /// Amplitude: half the slider's stroke, its true one.
    pub linear_half_stroke: (f64, f64),
    /// Amplitude: the slider's whole stroke, as the paper says.
    pub linear_stroke: (f64, f64),
    /// Amplitude: the pinion's true one.
    pub angular_single: (f64, f64),
    /// Twice that, as the slider's is doubled.
    pub angular_double: (f64, f64),
    /// The identified sensor at the rig's own amplitudes, in the direction of each that crosses first: linear, angular.
    pub identified_first: [f64; 2],
}

/// All of it.
pub fn study() -> Arithmetic {
    let before_without_drift = COMPOUND_TABLES.map(before_without_drift);
    let [x, y, z] = DVec3::AXES;
    let plane = [x, y, (x + y).normalize()];
    let anywhere = [
        (DVec3::new(1.0, 2.0, -1.0), DVec3::new(0.5, -1.0, 3.0)),
        (DVec3::new(-2.0, 1.0, 0.5), DVec3::new(1.0, 1.0, -2.0)),
    ];
    let wedges = [(1.0, 1.0, 2.0), (1.0, 2.0, 1.0), (2.0, 1.0, 1.0)].map(DVec3::from);
    Arithmetic {
        scale_rank: [&wedges[..2], &wedges[..]].map(|all| rank(&scale_regressor(all))),
        scale_condition: condition(&scale_regressor(&wedges)),
        linear_at_2_hz_m_s2: [1.0, 2.0].map(linear_at_2_hz_m_s2),
        inertia_rank: [&[x, y][..], &plane, &[x, y, z]]
            .map(|axes| rank(&inertia_regressor(turns(axes)))),
        inertia_rank_free: rank(&inertia_regressor(anywhere)),
        thresholds: thresholds(),
        rod_harmonic: rod_harmonic(),
        rod_over_crank: ROD_OVER_CRANK,
        off_axis_m_s2: off_axis_m_s2(),
        off_axis_mm: 1e3 * OFF_AXIS_M,
        before_departs: before_without_drift
            .iter()
            .flat_map(|run| run.printed.into_iter().zip(run.by_parameters))
            .fold(0.0, |largest: f64, (printed, found)| {
                largest.max((printed - found).abs())
            }),
        before_without_drift,
        printed_improvement: printed_improvement(),
    }
}

/// At the drive frequency. Travel and rotation point one way in the sensor, so that the mass bears w^2 (x d, I/m phi d) there; the
/// limbs' forces are read too large by s design over s identified each, and summed up again.
fn before_without_drift(table: CompoundTable) -> BeforeWithoutDrift {
    let (design, identified) = (TrueSensor::design(), TrueSensor::identified());
    let direction = table.direction.normalize();
    let (linear, angular) = (
        direction * SLIDER_AMPLITUDE_M,
        direction * ROTATION_AMPLITUDE_RAD,
    );
    let torque = identified.inertia_per_mass.tensor_m2() * angular;
    let forces = StaticLoadSharing::new(&Geometry::PAPER)
        .map_or([f64::NAN; LIMBS], |shares| shares.of_wrench(linear, torque));
    let read = SVector::<f64, LIMBS>::from_fn(|i, _| {
        forces[i] * design.scale_per_mass_per_kg[i] / identified.scale_per_mass_per_kg[i]
    });
    let wrench = Geometry::PAPER.limb_jacobian().transpose() * read;
    let [found_linear, torque] =
        [0, 3].map(|i| DVec3::new(wrench[i], wrench[i + 1], wrench[i + 2]));
    let found_angular = design.inertia_per_mass.tensor_m2().inverse() * torque;
    let errors = [(found_linear, linear), (found_angular, angular)]
        .map(|(found, true_)| ((found - true_) / true_).abs().to_array());
    BeforeWithoutDrift {
        frequency_hz: table.frequency_hz,
        printed: table.error_before_percent.map(|percent| percent / 100.0),
        by_parameters: core::array::from_fn(|i| errors[i / 3][i % 3]),
    }
}

/// Rate and angular acceleration of a rig that swings about each axis in turn, at many instants.
fn turns(axes: &[DVec3]) -> impl Iterator<Item = (DVec3, DVec3)> {
    axes.iter().flat_map(|&axis| {
        (0..INSTANTS).map(move |i| {
            let (sin, cos) = (TAU * f64::from(i) / f64::from(INSTANTS)).sin_cos();
            (axis * cos, axis * -sin)
        })
    })
}

/// The regressor (18) of these samples.
fn inertia_regressor(samples: impl IntoIterator<Item = (DVec3, DVec3)>) -> DMatrix<f64> {
    let rows: Vec<f64> = samples
        .into_iter()
        .flat_map(|(rate, derivative)| inertia::regressor(rate, derivative))
        .flatten()
        .collect();
    DMatrix::from_row_slice(rows.len() / 6, 6, &rows)
}

/// The regressor (13) of the forces by which nine equal limbs bear these accelerations, columns scaled.
fn scale_regressor(accelerations: &[DVec3]) -> DMatrix<f64> {
    let Ok(shares) = StaticLoadSharing::new(&Geometry::PAPER) else {
        return DMatrix::zeros(0, 0);
    };
    let rows = 3 * accelerations.len();
    let mut regressor = DMatrix::from_fn(rows, DIRECTIONS_SHELL.len(), |row, limb| {
        let force = shares.of_acceleration(limb).dot(accelerations[row / 3]);
        (force * DIRECTIONS_SHELL[limb])[row % 3]
    });
    for mut column in regressor.column_iter_mut() {
        let length = column.norm();
        column /= length;
    }
    regressor
}

fn rank(regressor: &DMatrix<f64>) -> usize {
    let values = regressor.singular_values();
    values.iter().filter(|v| **v > RANK * values.max()).count()
}

fn condition(regressor: &DMatrix<f64>) -> f64 {
    let values = regressor.singular_values();
    values.max() / values.min()
}

/// Of the identified sensor, with so many times half the slider's stroke as amplitude.
fn linear_at_2_hz_m_s2(times: f64) -> f64 {
    (0..DIRECTIONS)
        .map(|i| {
            let mut run = Run::new(Mode::Linear, NEGLECTED_TO_HZ, direction(i));
            run.slider_amplitude_m *= times;
            relative_acceleration(&TrueSensor::identified(), &run)
        })
        .fold(0.0, f64::max)
}

fn thresholds() -> Thresholds {
    let (design, identified) = (TrueSensor::design(), TrueSensor::identified());
    let over_directions = |sensor, mode, times| {
        (0..DIRECTIONS)
            .map(|i| threshold_hz(sensor, mode, times, direction(i)))
            .fold((f64::INFINITY, 0.0_f64), |(low, high), hz| {
                (low.min(hz), high.max(hz))
            })
    };
    let range = |mode, times| over_directions(&design, mode, times);
    Thresholds {
        linear_half_stroke: range(Mode::Linear, 1.0),
        linear_stroke: range(Mode::Linear, 2.0),
        angular_single: range(Mode::Angular, 1.0),
        angular_double: range(Mode::Angular, 2.0),
        identified_first: [Mode::Linear, Mode::Angular]
            .map(|mode| over_directions(&identified, mode, 1.0).0),
    }
}

/// Where the relative acceleration, which grows as the fourth power of the frequency, reaches the paper's threshold, Hz.
fn threshold_hz(sensor: &TrueSensor, mode: Mode, times: f64, direction: DVec3) -> f64 {
    let mut run = Run::new(mode, 1.0, direction);
    run.slider_amplitude_m *= times;
    run.rotation_amplitude_rad *= times;
    let threshold = match mode {
        Mode::Angular => ANGULAR_THRESHOLD_RAD_S2,
        _ => LINEAR_THRESHOLD_M_S2,
    };
    (threshold / relative_acceleration(sensor, &run)).powf(0.25)
}

/// One of [`DIRECTIONS`], on a spiral of golden angles.
fn direction(i: u32) -> DVec3 {
    let z = (f64::from(i) + 0.5) / f64::from(DIRECTIONS);
    let golden = TAU * (3.0 - 5.0_f64.sqrt()) / 2.0;
    let (sin, cos) = (golden * f64::from(i)).sin_cos();
    let radius = (1.0 - z * z).sqrt();
    DVec3::new(radius * cos, radius * sin, z)
}

/// From the slider's place r cos q + sqrt(l^2 - (r sin q)^2), turn by turn: amplitudes of its first two harmonics, times their order
/// squared.
fn rod_harmonic() -> f64 {
    let amplitude = |order: f64| {
        let sum: f64 = (0..INSTANTS)
            .map(|i| {
                let q = TAU * f64::from(i) / f64::from(INSTANTS);
                let place = q.cos() + (ROD_OVER_CRANK.powi(2) - q.sin().powi(2)).sqrt();
                place * (order * q).cos()
            })
            .sum();
        2.0 * sum / f64::from(INSTANTS) * order * order
    };
    amplitude(2.0) / amplitude(1.0)
}

fn printed_improvement() -> [f64; 3] {
    let cells = COMPOUND_TABLES.iter().flat_map(|table| {
        let after = table.error_after_percent;
        table.error_before_percent.into_iter().zip(after)
    });
    let (mut worst, mut found) = (0.0, [0.0, f64::INFINITY, 0.0_f64]);
    for (before, after) in cells {
        let times = before / after;
        if before > worst {
            (worst, found[0]) = (before, times);
        }
        found = [found[0], found[1].min(times), found[2].max(times)];
    }
    found
}

fn off_axis_m_s2() -> f64 {
    let w = TAU * HIGHEST_HZ;
    (0..INSTANTS)
        .map(|i| {
            let (sin, cos) = (TAU * f64::from(i) / f64::from(INSTANTS)).sin_cos();
            let rate = ROTATION_AMPLITUDE_RAD * w * cos;
            let derivative = ROTATION_AMPLITUDE_RAD * w * w * sin;
            OFF_AXIS_M * derivative.hypot(rate * rate)
        })
        .fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Figures that another program found.
    #[test]
    fn what_arithmetic_decides() {
        let c = study();
        assert_eq!(c.scale_rank, [6, 9]);
        assert_eq!(c.inertia_rank, [5, 5, 6]);
        assert_eq!(c.inertia_rank_free, 6);
        let near = |found: (f64, f64), known: (f64, f64)| {
            assert!(
                (found.0 - known.0).abs() < 2e-3 && (found.1 - known.1).abs() < 2e-3,
                "{found:?} {known:?}"
            );
        };
        near(c.thresholds.linear_half_stroke, (2.380, 2.830));
        near(c.thresholds.linear_stroke, (2.001, 2.380));
        near(c.thresholds.angular_single, (2.431, 2.902));
        near(c.thresholds.angular_double, (2.044, 2.440));
        // Crank over rod, to first order.
        assert!((c.rod_harmonic - 0.2).abs() < 0.01, "{}", c.rod_harmonic);
        assert!(
            (c.off_axis_m_s2 - 3.009).abs() < 1e-3,
            "{}",
            c.off_axis_m_s2
        );
    }
}
