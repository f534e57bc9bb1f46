//! Where a slower way stands behind a fast one, the fast one is taken. Answers alone do not tell: what a fault makes look wrong is
//! done again by the slower way, and comes out right.

use std::array::from_fn;

use sixaxis_core::decouple::lanes::{LaneSample, push_lanes, push_lanes_portable};
use sixaxis_core::decouple::record::BlockCount;
use sixaxis_core::kernel::simd::LANES;
use sixaxis_core::{Decoupler, Gains, LIMBS, LimbSet, Scheme};
use sixaxis_props::manufactured::examples;
use sixaxis_props::problem::Problem;

/// Samples before the first that a block can have, and in a block; samples in a chunk of lanes.
const START: usize = 3;
const BLOCK: usize = 128;
const CHUNK: usize = 32;

const RATE_HZ: f64 = 4000.0;
const SAMPLES: usize = START + 4 * BLOCK + CHUNK + 1;

/// Every scheme, with all limbs and without three: strains up to 3e-5, far within the series.
fn cases() -> impl Iterator<Item = (String, Vec<[f64; LIMBS]>, Decoupler)> {
    let motion = examples::turning_from_rest();
    Scheme::ALL.into_iter().flat_map(move |scheme| {
        let case = Problem::manufactured(&motion, Gains::uniform(2.0), RATE_HZ, SAMPLES, scheme);
        [&[][..], &[1, 6, 9]].map(|numbers| {
            let excluded = LimbSet::from_numbers(numbers.iter().copied()).expect("limbs");
            let decoupler = case.decoupler().excluding(excluded).expect("six remain");
            let name = format!("{}, without {excluded}", scheme.name());
            (name, case.voltage_v.clone(), decoupler)
        })
    })
}

#[test]
fn law_every_block_of_a_quiet_record_is_decoded_as_one() {
    for (name, voltage_v, decoupler) in cases() {
        let columns: [Vec<f64>; LIMBS] = from_fn(|i| voltage_v.iter().map(|row| row[i]).collect());
        let columns = columns.each_ref().map(|column| &column[..]);
        let mut each = from_fn::<_, 3, _>(|_| decoupler.clone());
        let [rows, by_column, portable] = &mut each;
        let sink = &mut |_: sixaxis_core::six_axis::SixAxisColumns| {};
        rows.push_record(&voltage_v, sink).expect("sound samples");
        by_column
            .push_columns(columns, sink)
            .expect("sound samples");
        portable
            .push_record_portable(&voltage_v, sink)
            .expect("sound samples");
        let whole = BlockCount {
            whole: ((SAMPLES - START) / BLOCK) as u64,
            ..BlockCount::default()
        };
        for (way, decoupler) in ["rows", "columns", "portable"].iter().zip(each) {
            assert_eq!(decoupler.blocks(), whole, "{way}: {name}");
        }
    }
}

/// Chunks come to the sink as they were decoded; what went stream by stream comes sample by sample.
#[test]
fn law_every_chunk_of_quiet_lanes_is_decoded_as_one() {
    for (name, voltage_v, decoupler) in cases() {
        let lengths = |portable: bool| {
            let mut lengths = Vec::new();
            let mut streams: [Decoupler; LANES] = from_fn(|_| decoupler.clone());
            let rows = [&voltage_v[..]; LANES];
            let mut sink = |chunk: &[LaneSample]| lengths.push(chunk.len());
            if portable {
                push_lanes_portable(&mut streams, rows, &mut sink).expect("sound samples");
            } else {
                push_lanes(&mut streams, rows, &mut sink).expect("sound samples");
            }
            lengths
        };
        for portable in [false, true] {
            let lengths = lengths(portable);
            let chunks = lengths.iter().filter(|length| **length == CHUNK).count();
            assert_eq!(chunks, (SAMPLES - START) / CHUNK, "{name}: {lengths:?}");
        }
    }
}
