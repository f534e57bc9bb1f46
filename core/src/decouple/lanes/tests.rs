//! Eight streams in registers of four, which a processor with wider ones never takes, beside the same streams one by one.

use super::*;
use crate::fixture::{decoupler, row};

/// Every part of the registers starts from the streams' own counts: a multi-step scheme knows no earlier sample at first.
#[test]
fn every_part_starts_where_the_streams_are() {
    const SAMPLES: usize = 3 + 2 * CHUNK + 5;
    let rows: [[[f64; LIMBS]; SAMPLES]; LANES] =
        core::array::from_fn(|lane| core::array::from_fn(|sample| row(sample, lane)));
    for scheme in Scheme::ALL {
        let mut streams: [Decoupler; LANES] = core::array::from_fn(|_| decoupler(scheme));
        let mut answers = [[[0.0; 9]; SAMPLES]; LANES];
        let mut count = 0;
        let given = rows.each_ref().map(|rows| &rows[..]);
        push_lanes_portable(&mut streams, given, &mut |samples: &[LaneSample]| {
            for sample in samples {
                for (lane, answers) in answers.iter_mut().enumerate() {
                    answers[count] = sample.each_ref().map(|row| row.0[lane]);
                }
                count += 1;
            }
        })
        .expect("sound samples");
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
