//! Fig. 7: how the motion of the mass in the shell grows, and where it crosses the thresholds. MuJoCo throughout.

use glam::DVec3;
use proptest::prelude::*;
use sixaxis_core::Parameters;
use sixaxis_props::compare::{fails_clearly, within};
use sixaxis_props::problem::rig::model;
use sixaxis_props::strategy::{config, parameters, vector};
use sixaxis_props::tolerance;
use sixaxis_props::truth;
use sixaxis_reference::linear_theory::relative_acceleration;
use sixaxis_reference::mujoco::threshold::{
    SweepPoint, crossing_hz, excitation, log_slope, measure,
};
use sixaxis_reference::paper;
use sixaxis_reference::rig::run::{Mode, Mounting, Run};

/// Of the paper's sensors, and of drawn ones, whose highest mode may be half as high again.
const STEP_S: f64 = 5e-5;
const STEP_OF_ANY_S: f64 = 2.5e-5;
const MODES: [Mode; 2] = [Mode::Linear, Mode::Angular];

fn measured(parameters: &Parameters, run: &Run) -> SweepPoint {
    in_steps_of(STEP_S, parameters, run)
}

fn in_steps_of(step_s: f64, parameters: &Parameters, run: &Run) -> SweepPoint {
    let model = model(parameters, run.direction_ground, Mounting::AxisVertical);
    measure(&model, run, step_s).expect("the step is stable")
}

fn theory(parameters: &Parameters, run: &Run) -> f64 {
    relative_acceleration(&truth::sensor(parameters), run)
}

fn threshold(mode: Mode) -> f64 {
    match mode {
        Mode::Angular => paper::ANGULAR_THRESHOLD_RAD_S2,
        _ => paper::LINEAR_THRESHOLD_M_S2,
    }
}

/// Where a sweep of three points about the paper's frequency crosses the threshold, with the amplitude times `size`.
fn threshold_hz(parameters: &Parameters, mode: Mode, size: f64) -> f64 {
    let sweep = [1.8, 2.4, 3.2].map(|frequency_hz| {
        let mut run = excitation(mode, frequency_hz);
        run.slider_amplitude_m *= size;
        run.rotation_amplitude_rad *= size;
        measured(parameters, &run)
    });
    crossing_hz(&sweep, threshold(mode)).expect("the threshold lies between 1.8 and 3.2 Hz")
}

#[test]
fn paper_thresholds_are_those_of_figure_7() {
    let (linear_hz, angular_hz) = paper::THRESHOLD_FREQUENCY_HZ;
    for (mode, printed_hz) in MODES.into_iter().zip([linear_hz, angular_hz]) {
        let ours = threshold_hz(&truth::design_parameters(), mode, 1.0);
        within(
            "threshold frequency, Hz",
            (ours - printed_hz).abs(),
            tolerance::PRINTED_THRESHOLD_HZ,
        );
    }
}

#[test]
fn paper_2_hz_is_below_both_thresholds_and_4_hz_above_the_linear_one() {
    let parameters = truth::identified_parameters();
    let over = |mode, frequency_hz| {
        let run = excitation(mode, frequency_hz);
        measured(&parameters, &run).relative_acceleration / threshold(mode)
    };
    assert!(over(Mode::Linear, 2.0) < 1.0);
    assert!(over(Mode::Angular, 2.0) < 1.0);
    assert!(over(Mode::Linear, 4.0) > 1.0);
}

#[test]
fn order_relative_acceleration_grows_with_the_fourth_power_of_frequency() {
    let parameters = truth::design_parameters();
    for mode in MODES {
        let points: Vec<(f64, f64)> = [1.0, 1.7, 3.0, 5.0]
            .map(|frequency_hz| {
                let run = excitation(mode, frequency_hz);
                (
                    frequency_hz,
                    measured(&parameters, &run).relative_acceleration,
                )
            })
            .into();
        assert!(
            points.windows(2).all(|pair| pair[0].1 < pair[1].1),
            "the sweep does not rise: {points:?}"
        );
        let slope = log_slope(points);
        within(
            "slope of the sweep",
            (slope - 4.0).abs(),
            tolerance::THRESHOLD_POWER,
        );
        fails_clearly(
            "slope of three",
            (slope - 3.0).abs(),
            tolerance::THRESHOLD_POWER,
        );
    }
}

#[test]
fn order_threshold_falls_with_amplitude_and_rises_with_stiffness_by_fourth_roots() {
    let design = truth::design_parameters();
    let mut stiffer = design;
    stiffer.stiffness_per_mass_per_s2 *= 1.5;
    for mode in MODES {
        let [usual, larger, stiff] = [
            threshold_hz(&design, mode, 1.0),
            threshold_hz(&design, mode, 1.5),
            threshold_hz(&stiffer, mode, 1.0),
        ];
        let power = |ratio: f64| ratio.ln() / 1.5_f64.ln();
        within(
            "power of the amplitude",
            (power(larger / usual) + 0.25).abs(),
            tolerance::THRESHOLD_POWER,
        );
        within(
            "power of k/m",
            (power(stiff / usual) - 0.25).abs(),
            tolerance::THRESHOLD_POWER,
        );
    }
}

proptest! {
    #![proptest_config(config(6))]

    /// Any sensor, any direction: what MuJoCo shows is what the compliance matrix says.
    #[test]
    fn ref_relative_acceleration_follows_linear_theory(
        parameters in parameters(), direction in vector(1.0), angular in any::<bool>(),
    ) {
        prop_assume!(direction.length() > 0.1);
        let mode = if angular { Mode::Angular } else { Mode::Linear };
        let mut run = excitation(mode, 5.0);
        run.direction_ground = direction.normalize();
        let point = in_steps_of(STEP_OF_ANY_S, &parameters, &run);
        within(
            "relative acceleration over linear theory's",
            (point.relative_acceleration / theory(&parameters, &run) - 1.0).abs(),
            tolerance::LINEAR_THEORY,
        );
        // A direction that is not the run's own must be told apart.
        let mut other = run;
        other.direction_ground = DVec3::new(direction.y, direction.z, -direction.x).normalize();
        let (a, b) = (theory(&parameters, &run), theory(&parameters, &other));
        prop_assume!((a / b - 1.0).abs() > tolerance::TOLD_APART);
        fails_clearly(
            "theory for another direction",
            (point.relative_acceleration / b - 1.0).abs(),
            tolerance::LINEAR_THEORY,
        );
    }
}
