//! Step 4's curve by interpolation is the curve of one decode a candidate.

use glam::DVec3;
use sixaxis_core::identify::stiffness;
use sixaxis_core::identify::stiffness_search::{Trial, rate_norm_sums};
use sixaxis_core::{Parameters, Scheme, Sensor, Settings};
use sixaxis_props::compare::largest;
use sixaxis_props::evidence::Row;
use sixaxis_props::problem::rig;
use sixaxis_props::tolerance;
use sixaxis_props::truth;
use sixaxis_props::truth::InCore;
use sixaxis_reference::laboratory::Laboratory;
use sixaxis_reference::laboratory::recording::SimulatedRecording;
use sixaxis_reference::rig::run::{Mode, Mounting};

#[test]
fn ref_the_search_by_interpolation_is_the_search() {
    let parameters = truth::identified_parameters();
    let directions = [
        DVec3::new(1.0, 1.0, 2.0),
        DVec3::new(2.0, -1.0, 1.0),
        DVec3::Y,
    ];
    let recordings: Vec<SimulatedRecording> = directions
        .iter()
        .map(|d| {
            let run = rig::simulate(
                &parameters,
                Mode::Linear,
                d.normalize(),
                Mounting::AxisVertical,
            );
            Laboratory::noise_free(truth::sensor(&parameters)).record(&run, 0)
        })
        .collect();
    let mut wrong = parameters;
    wrong.scale_per_mass_per_kg[3] *= 1.0 + 1e-5;
    let grid: Vec<f64> = stiffness::paper_grid().collect();
    for (name, parameters) in [("true", parameters), ("scale factor in error", wrong)] {
        for count in 1..=directions.len() {
            let setup: Vec<(Sensor, Settings)> = recordings[..count]
                .iter()
                .map(|r| (r.sensor(), r.settings(Scheme::Heun)))
                .collect();
            let trials: Vec<Trial> = setup
                .iter()
                .zip(&recordings)
                .enumerate()
                .map(|(i, ((sensor, settings), r))| Trial {
                    sensor,
                    settings,
                    // Of different lengths.
                    voltage_v: &r.voltage_v[..r.voltage_v.len() - 37 * i],
                })
                .collect();
            let ours = rate_norm_sums(&parameters, &trials, &grid).expect("sound trials");
            let mut theirs = vec![0.0; grid.len()];
            let mut samples = 0;
            for (sum, &candidate) in theirs.iter_mut().zip(&grid) {
                let candidate = Parameters {
                    stiffness_per_mass_per_s2: candidate,
                    ..parameters
                };
                samples = 0;
                for t in &trials {
                    let (s, n) =
                        stiffness::rate_norm_sum(t.sensor, &candidate, t.settings, t.voltage_v)
                            .expect("a sound trial");
                    *sum += s;
                    samples += n;
                }
            }
            assert_eq!(ours.samples, samples);
            // Decoded one by one they would have each other's bits.
            assert_ne!(ours.sums, theirs, "candidates were decoded one by one");
            let top = largest(theirs.iter().copied());
            let error = largest(ours.sums.iter().zip(&theirs).map(|(a, b)| (a - b).abs())) / top;
            Row::new("sums of |w*| by interpolation", error, tolerance::SEARCH)
                .case(name)
                .judge();
            let least = |sums: &[f64]| (0..sums.len()).min_by(|&a, &b| sums[a].total_cmp(&sums[b]));
            assert_eq!(least(&ours.sums), least(&theirs), "the grid point");
        }
    }
}
