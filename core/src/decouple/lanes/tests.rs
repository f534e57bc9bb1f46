//! Eight streams in registers of four, which a processor with wider ones never takes, beside the same streams one by one.

use ::wide::f64x4;

use super::*;
use crate::model::{Gains, Parameters, Sensor, Settings};
use crate::{Geometry, InertiaPerMass};

fn decoupler(scheme: Scheme) -> Decoupler {
    let sensor = Sensor {
        geometry: Geometry::PAPER,
        gains: Gains::uniform(10.0),
    };
    let parameters = Parameters {
        zero_drift_v: [0.01; LIMBS],
        scale_per_mass_per_kg: [5.0; LIMBS],
        inertia_per_mass: InertiaPerMass::from_paper_order([2e-4, 2.3e-4, 3e-4, 0.0, 0.0, 1e-6]),
        stiffness_per_mass_per_s2: 2e8,
    };
    let settings = Settings {
        scheme,
        ..Settings::new(1e4)
    };
    Decoupler::new(&sensor, &parameters, &settings).expect("a sound sensor")
}

/// Every part of the registers starts from the streams' own counts: a multi-step scheme knows no earlier sample at first.
#[test]
fn every_part_starts_where_the_streams_are() {
    const SAMPLES: usize = 3 + 2 * CHUNK + 5;
    let rows: [[[f64; LIMBS]; SAMPLES]; LANES] = core::array::from_fn(|lane| {
        core::array::from_fn(|i| {
            core::array::from_fn(|limb| 0.01 + 0.2 * (3e-3 * i as f64 + (lane + limb) as f64).sin())
        })
    });
    for scheme in Scheme::ALL {
        let mut streams: [Decoupler; LANES] = core::array::from_fn(|_| decoupler(scheme));
        let mut answers = [[[0.0; 9]; SAMPLES]; LANES];
        let mut count = 0;
        let job = Push::<_, false> {
            streams: &mut streams,
            voltage_v: rows.each_ref().map(|rows| &rows[..]),
            sink: &mut |samples: &[LaneSample]| {
                for sample in samples {
                    for (lane, answers) in answers.iter_mut().enumerate() {
                        answers[count] = sample.each_ref().map(|row| row.0[lane]);
                    }
                    count += 1;
                }
            },
        };
        push::<f64x4, false>((), job).expect("sound samples");
        assert_eq!(count, SAMPLES - 2);
        for (rows, answers) in rows.iter().zip(&answers) {
            let mut alone = decoupler(scheme);
            let mut expected = answers.iter();
            for row in rows {
                let Some(sample) = alone.push(row).expect("a sound sample") else {
                    continue;
                };
                let vectors = [
                    sample.linear_ground_m_s2,
                    sample.angular_ground_rad_s2,
                    sample.rate_shell_rad_s,
                ];
                let lanes = expected.next().expect("as many answers");
                let numbers = vectors.iter().flat_map(|v| v.to_array());
                for (ours, other) in lanes.iter().zip(numbers) {
                    // Rounding of products fused or not, over 70 samples.
                    let off = (ours - other).abs();
                    assert!(
                        off <= 1e-11 * (1.0 + other.abs()),
                        "{scheme:?}: {ours} {other}"
                    );
                }
            }
        }
    }
}
