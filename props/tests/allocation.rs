//! Nothing is allocated between the first sample and the last, by any path.

use std::array::from_fn;
use std::hint::black_box;

use allocation_counter::measure;
use sixaxis_core::aided::{AidedDecoupler, ErrorFilter, RestFinder, Taken};
use sixaxis_core::decouple::lanes::push_lanes;
use sixaxis_core::decouple::uncertainty::{ChannelNoise, Covariance, SampleUncertainty};
use sixaxis_core::identify::inertia::InertiaIdentification;
use sixaxis_core::identify::scale::ScaleIdentification;
use sixaxis_core::kernel::simd::LANES;
use sixaxis_core::redundancy::self_calibration::{Accumulator, Limits};
use sixaxis_core::six_axis::SixAxisColumns;
use sixaxis_core::{
    Decoupler, Gains, Geometry, LIMBS, LimbSet, Parameters, Scheme, Sensor, Settings,
    StaticResponse,
};
use sixaxis_props::faults::{FALSE_ALARMS_PER_HOUR, Scene};
use sixaxis_props::manufactured::examples;
use sixaxis_props::seed::seed;
use sixaxis_props::self_calibration::Case;
use sixaxis_props::truth;

const SAMPLES: usize = 1000;
const RATE_HZ: f64 = 4000.0;

#[test]
fn inv_decoding_allocates_nothing() {
    let motion = examples::turning();
    let gains = Gains::uniform(1.0);
    let rows: Vec<[f64; LIMBS]> = (0..SAMPLES)
        .map(|i| motion.voltage_v(&gains.gain_n_per_v, &motion.at(i as f64 / RATE_HZ)))
        .collect();
    let sensor = Sensor {
        geometry: motion.geometry,
        gains,
    };
    for scheme in Scheme::ALL {
        let settings = Settings {
            scheme,
            static_response: StaticResponse::Full,
            ..Settings::new(RATE_HZ)
        };
        let fresh = Decoupler::new(&sensor, &motion.parameters, &settings).expect("sound");
        let (mut stream, mut record, mut portable) = (fresh.clone(), fresh.clone(), fresh.clone());
        let mut lanes: [Decoupler; LANES] = from_fn(|_| fresh.clone());
        let mut count = 0;
        // Finds out once what the processor can do, which may take memory.
        record
            .clone()
            .push_record(&rows[..9], &mut |_| {})
            .expect("sound");
        let allocated = measure(|| {
            for row in &rows {
                count += usize::from(stream.push(row).expect("sound").is_some());
            }
            let mut sink = |done: SixAxisColumns| count += black_box(done).len();
            record.push_record(&rows, &mut sink).expect("sound");
            portable
                .push_record_portable(&rows, &mut sink)
                .expect("sound");
            push_lanes(&mut lanes, [&rows[..]; LANES], &mut |done| {
                count += done.len()
            })
            .expect("sound");
        });
        assert_eq!(count, 4 * (SAMPLES - 2), "samples decoded");
        assert_eq!(allocated.count_total, 0, "{}", scheme.name());
    }
}

/// Alarm, isolation, switch and the decoding anew among them.
#[test]
fn inv_a_dying_limb_allocates_nothing() {
    let scene = Scene::random(1, 1.0);
    let mut stream = scene.stream(FALSE_ALARMS_PER_HOUR);
    let mut without = 0;
    let allocated = measure(|| {
        for sample in 0..SAMPLES as u64 {
            let mut u = scene.voltage_v(sample);
            if sample >= 300 {
                u[4] = scene.parameters.zero_drift_v[4];
            }
            without = stream.push(&u).expect("a row").excluded.len();
        }
    });
    assert_eq!(without, 1);
    assert_eq!(allocated.count_total, 0);
}

/// Without limbs, and from one set to another in mid-stream.
#[test]
fn inv_switching_over_allocates_nothing() {
    let motion = examples::turning();
    let gains = Gains::uniform(1.0);
    let rows: Vec<[f64; LIMBS]> = (0..SAMPLES)
        .map(|i| motion.voltage_v(&gains.gain_n_per_v, &motion.at(i as f64 / RATE_HZ)))
        .collect();
    let sensor = Sensor {
        geometry: motion.geometry,
        gains,
    };
    let settings = Settings {
        static_response: StaticResponse::Full,
        ..Settings::new(RATE_HZ)
    };
    let sets = [&[][..], &[2], &[], &[1, 9], &[1, 6, 9]]
        .map(|numbers| LimbSet::from_numbers(numbers.iter().copied()).expect("limbs"));
    let twins = LimbSet::from_numbers([3, 7]).expect("limbs");
    let mut stream = Decoupler::new(&sensor, &motion.parameters, &settings).expect("sound");
    let mut record = stream.clone();
    let mut count = 0;
    // Finds out once what the processor can do, which may take memory.
    record
        .clone()
        .push_record(&rows[..9], &mut |_| {})
        .expect("sound");
    let allocated = measure(|| {
        for (i, row) in rows.iter().enumerate() {
            stream.set_excluded(sets[i % 5]).expect("survivable");
            count += usize::from(stream.push(row).expect("sound").is_some());
            count += usize::from(stream.set_excluded(twins).is_err());
        }
        for (piece, set) in rows.chunks(SAMPLES / 5).zip(sets) {
            record.set_excluded(set).expect("survivable");
            let mut sink = |done: SixAxisColumns| count += black_box(done).len();
            record.push_record(piece, &mut sink).expect("sound");
        }
    });
    assert_eq!(count, 2 * (SAMPLES - 2) + SAMPLES, "answers");
    assert_eq!(allocated.count_total, 0);
}

#[test]
fn inv_self_calibration_allocates_nothing() {
    let case = Case::random(seed(), 1.0);
    let rows = case.voltage_v();
    let fresh = Accumulator::of_usual_blocks(&case.sensor(), &case.calibration, &case.settings())
        .expect("sound");
    let mut stream = fresh.clone();
    let allocated = measure(|| {
        for row in &rows {
            stream.push(row).expect("sound");
        }
        black_box(stream.ratios(&Limits::default())).expect("rich");
    });
    assert_eq!(stream.samples(), rows.len());
    assert_eq!(allocated.count_total, 0);
}

fn of_the_paper() -> (Parameters, Sensor) {
    let sensor = Sensor {
        geometry: Geometry::PAPER,
        gains: Gains::uniform(1.0),
    };
    (truth::identified_parameters(), sensor)
}

#[test]
fn inv_uncertainty_of_a_sample_allocates_nothing() {
    let (parameters, sensor) = of_the_paper();
    let mut covariance = Covariance::zeros();
    for (i, drift) in parameters.zero_drift_v.iter().enumerate() {
        covariance[(i, i)] = drift * drift;
    }
    let noise = ChannelNoise::white(parameters.zero_drift_v.map(f64::abs));
    let settings = Settings::new(RATE_HZ);
    let mut decoupler = Decoupler::new(&sensor, &parameters, &settings).expect("sound");
    let mut stream = SampleUncertainty::new(
        &sensor,
        &parameters,
        &settings,
        LimbSet::EMPTY,
        &covariance,
        &noise,
    )
    .expect("sound");
    let mut before = parameters.zero_drift_v;
    let mut known = 0;
    let allocated = measure(|| {
        for _ in 0..SAMPLES {
            let row = parameters.zero_drift_v;
            if let Some(sample) = decoupler.push(&row).expect("at rest") {
                let spread = stream.push(&before, &sample).expect("at rest");
                known += usize::from(spread.linear_ground_m_s2.min_element() > 0.0);
            }
            before = row;
        }
    });
    assert_eq!(known, SAMPLES - 2, "samples with a deviation");
    assert_eq!(allocated.count_total, 0);
}

#[test]
fn inv_an_aided_stream_allocates_nothing() {
    let (parameters, sensor) = of_the_paper();
    let mut covariance = Covariance::zeros();
    for (i, drift) in parameters.zero_drift_v.iter().enumerate() {
        covariance[(i, i)] = 1e-6 * drift * drift;
    }
    let noise = ChannelNoise::white([1e-3; LIMBS]);
    let settings = Settings::new(RATE_HZ);
    let decoupler = Decoupler::new(&sensor, &parameters, &settings).expect("sound");
    let filter =
        ErrorFilter::new(&sensor, &parameters, &settings, &covariance, &noise, 0.0).expect("sound");
    let mut rests = RestFinder::new(filter.model(), &noise.white_v, RATE_HZ);
    let mut stream = AidedDecoupler::new(decoupler, filter, &parameters, &settings);
    let mut taken = 0;
    let allocated = measure(|| {
        for _ in 0..10 * SAMPLES {
            stream.push(&parameters.zero_drift_v).expect("at rest");
            let rest = stream.block().and_then(|block| rests.push(block));
            taken += usize::from(rest.is_some_and(|rest| stream.aid(&rest) == Taken::Used));
        }
    });
    assert!(taken > 5, "{taken} measurements");
    assert_eq!(allocated.count_total, 0);
}

#[test]
fn inv_rows_of_least_squares_allocate_nothing() {
    let mut scale = ScaleIdentification::default();
    let mut inertia = InertiaIdentification::new(Geometry::PAPER);
    let allocated = measure(|| {
        for i in 0..SAMPLES {
            let t = i as f64;
            let force: [f64; LIMBS] = from_fn(|c| ((0.1 + 0.03 * c as f64) * t).sin());
            let v = glam::DVec3::new(t.sin(), t.cos(), (2.0 * t).sin());
            scale.push(&force, v).expect("finite");
            inertia.push(&force, v, v * 3.0).expect("finite");
        }
        black_box(scale.solve().expect("rich rows"));
        // Noise belongs to no body; refusing it allocates nothing either.
        black_box(inertia.solve().expect_err("no body"));
    });
    assert_eq!(allocated.count_total, 0);
}

/// The counter counts.
#[test]
fn regress_an_allocation_is_seen() {
    let allocated = measure(|| {
        black_box(vec![0_u8; 10]);
    });
    assert_eq!(allocated.count_total, 1);
}
