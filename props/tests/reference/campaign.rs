//! A random sensor, its calibration campaign in MuJoCo, the four steps: all 25 parameters against the truth.
//!
//! The steps see voltages and the two standard instruments only, along the direction that the wedge says. Once as the
//! paper has them; then twice more with the limbs' compliance kept.

use glam::DVec3;
use proptest::prelude::*;
use sixaxis_core::dsp::differentiate::Differentiator;
use sixaxis_core::identify::compliance::CompliantRows;
use sixaxis_core::identify::inertia::InertiaIdentification;
use sixaxis_core::identify::scale::ScaleIdentification;
use sixaxis_core::identify::{stiffness, zero_drift};
use sixaxis_core::paper::signal::SignalChain;
use sixaxis_core::{Geometry, LIMBS, Parameters, Scheme};
use sixaxis_props::compare::largest;
use sixaxis_props::evidence::Row;
use sixaxis_props::problem::rig::{DIRECTIONS, simulate_trial};
use sixaxis_props::strategy::{config, parameters};
use sixaxis_props::tolerance::{self, Tolerance};
use sixaxis_props::truth;
use sixaxis_props::truth::InCore;
use sixaxis_reference::laboratory::Laboratory;
use sixaxis_reference::laboratory::recording::SimulatedRecording;
use sixaxis_reference::rig::run::Mode;

/// Smoothing differentiator for the gyroscope: samples to either side, and order.
const DIFFERENTIATOR: (usize, usize) = (3, 6);
/// Repetitions of steps 2 to 4 with the compliance kept.
const REPETITIONS: usize = 2;

/// What a laboratory has on disk.
struct Campaign {
    at_rest: SimulatedRecording,
    linear: Vec<SimulatedRecording>,
    angular: Vec<SimulatedRecording>,
    fast: Vec<SimulatedRecording>,
}

impl Campaign {
    fn record(truth: Parameters) -> Self {
        let laboratory = Laboratory::noise_free(truth::sensor(&truth));
        let record = |mode, frequency_hz, direction| {
            let run = simulate_trial(&truth, mode, frequency_hz, direction);
            laboratory.record(&run, 0)
        };
        let linear = DIRECTIONS.map(|d| record(Mode::Linear, 2.0, d)).into();
        let angular = DIRECTIONS.map(|d| record(Mode::Angular, 2.0, d)).into();
        let fast = vec![record(Mode::Linear, 5.0, DVec3::new(1.0, 1.0, 2.0))];
        Self {
            at_rest: laboratory.record_static(),
            linear,
            angular,
            fast,
        }
    }

    /// Rate of the shell and its derivative as the gyroscope on the pinion's shaft tells them.
    fn gyroscope(recording: &SimulatedRecording) -> (Vec<DVec3>, Vec<DVec3>) {
        let (half_width, order) = DIFFERENTIATOR;
        let slope = Differentiator::new(half_width, order, recording.sample_rate_hz)
            .expect("the window is longer than the order")
            .derivative(&recording.gyroscope_rad_s)
            .expect("the run is longer than the window");
        let along = |values: &[f64]| {
            values
                .iter()
                .map(|v| recording.direction_ground * *v)
                .collect()
        };
        (along(&recording.gyroscope_rad_s), along(&slope))
    }

    fn four_steps(&self) -> Parameters {
        let mut found = truth::design_parameters();
        found.zero_drift_v = zero_drift::identify(&self.at_rest.voltage_v)
            .expect("ten minutes are enough")
            .drift_v;
        let mut scale = ScaleIdentification::default();
        for r in &self.linear {
            for (voltage, a) in r.voltage_v.iter().zip(&r.accelerometer_m_s2) {
                let force = r.gains().measured_force_n(voltage, &found.zero_drift_v);
                scale
                    .push(&force, r.direction_ground * *a)
                    .expect("rows are finite");
            }
        }
        found.scale_per_mass_per_kg = scale
            .solve()
            .expect("three directions span space")
            .estimate
            .values;
        let mut inertia = InertiaIdentification::new(Geometry::PAPER);
        for r in &self.angular {
            let chain = SignalChain::new(&r.gains(), &found);
            let (rate, slope) = Self::gyroscope(r);
            for (i, voltage) in r.voltage_v.iter().enumerate() {
                let force = chain.force_per_mass_m_s2(voltage);
                inertia
                    .push(&force, rate[i], slope[i])
                    .expect("rows are finite");
            }
        }
        found.inertia_per_mass = inertia
            .solve()
            .expect("three axes excite everything")
            .inertia_per_mass;
        found.stiffness_per_mass_per_s2 = self.stiffness(&found);
        found
    }

    /// Steps 2 to 4 again, with the motion of the mass in the shell that `first` implies.
    fn repeated(&self, first: &Parameters) -> Parameters {
        let mut found = *first;
        let mut scale = ScaleIdentification::default();
        for r in &self.linear {
            let mut rows = CompliantRows::new(&r.sensor(), &found, &r.settings(Scheme::Heun))
                .expect("the parameters are sound");
            for voltage in &r.voltage_v {
                if let Some(now) = rows.push(voltage).expect("samples are finite") {
                    let a = r.direction_ground * r.accelerometer_m_s2[now.sample as usize];
                    rows.push_scale(&mut scale, &now, a)
                        .expect("rows are finite");
                }
            }
        }
        found.scale_per_mass_per_kg = scale
            .solve()
            .expect("three directions span space")
            .estimate
            .values;
        let mut inertia = InertiaIdentification::new(Geometry::PAPER);
        for r in &self.angular {
            let mut rows = CompliantRows::new(&r.sensor(), &found, &r.settings(Scheme::Heun))
                .expect("the parameters are sound");
            let (rate, slope) = Self::gyroscope(r);
            for voltage in &r.voltage_v {
                if let Some(now) = rows.push(voltage).expect("samples are finite") {
                    let i = now.sample as usize;
                    rows.push_inertia(&mut inertia, &now, rate[i], slope[i])
                        .expect("rows are finite");
                }
            }
        }
        found.inertia_per_mass = inertia
            .solve()
            .expect("three axes excite everything")
            .inertia_per_mass;
        found.stiffness_per_mass_per_s2 = self.stiffness(&found);
        found
    }

    fn stiffness(&self, found: &Parameters) -> f64 {
        let curve: Vec<(f64, f64)> = stiffness::paper_grid()
            .map(|candidate| {
                let mut parameters = *found;
                parameters.stiffness_per_mass_per_s2 = candidate;
                let mean = self.fast.iter().map(|r| {
                    let (sum, count) = stiffness::rate_norm_sum(
                        &r.sensor(),
                        &parameters,
                        &r.settings(Scheme::Heun),
                        &r.voltage_v,
                    )
                    .expect("the parameters are sound");
                    sum / f64::from(count as u32)
                });
                (candidate, mean.sum())
            })
            .collect();
        stiffness::judge(&curve)
            .expect("the curve is finite")
            .interpolated_per_s2
    }
}

fn judge(case: &str, found: &Parameters, truth: &Parameters, limits: [Tolerance; 4]) {
    let [i, j] = [found, truth].map(|p| p.inertia_per_mass.to_paper_order());
    let size = largest(j);
    let worst = |pairs: &mut dyn Iterator<Item = (f64, f64, f64)>| {
        pairs
            .map(|(ours, truth, size)| ((ours - truth).abs() / size, ours, truth))
            .fold((0.0, 0.0, 0.0), |a, b| {
                if b.0 > a.0 || b.0.is_nan() { b } else { a }
            })
    };
    let (d, s) = (0..LIMBS, 0..LIMBS);
    for ((quantity, unit, (error, ours, theirs)), limit) in [
        (
            "zero drift",
            "V",
            worst(&mut d.map(|i| (found.zero_drift_v[i], truth.zero_drift_v[i], 1.0))),
        ),
        (
            "scale over mass",
            "1/kg",
            worst(&mut s.map(|i| {
                let t = truth.scale_per_mass_per_kg[i];
                (found.scale_per_mass_per_kg[i], t, t.abs())
            })),
        ),
        (
            "inertia over mass",
            "m^2",
            worst(&mut (0..6).map(|k| (i[k], j[k], size))),
        ),
        (
            "stiffness over mass",
            "1/s^2",
            worst(&mut core::iter::once((
                found.stiffness_per_mass_per_s2,
                truth.stiffness_per_mass_per_s2,
                truth.stiffness_per_mass_per_s2,
            ))),
        ),
    ]
    .into_iter()
    .zip(limits)
    {
        Row::new(format!("{quantity}, {case}"), error, limit)
            .sides(theirs, ours, unit)
            .judge();
    }
}

proptest! {
    #![proptest_config(config(4))]

    #[test]
    fn ref_all_25_parameters_are_found(truth in parameters()) {
        let campaign = Campaign::record(truth);
        let mut found = campaign.four_steps();
        judge("four steps", &found, &truth, tolerance::FOUR_STEPS);
        for _ in 0..REPETITIONS {
            found = campaign.repeated(&found);
        }
        judge("repeated", &found, &truth, tolerance::REPEATED_STEPS);
    }
}
