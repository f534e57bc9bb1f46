//! A decoder that watches for failures undoes cross-talk itself, and of a failed channel takes nothing for cross-talk.

use sixaxis_core::redundancy::fault::Watch;
use sixaxis_core::{
    CrossTalk, Decoupler, FaultTolerant, Gains, Geometry, InertiaPerMass, LIMBS, Parameters,
    Sensor, Settings, SixAxis,
};

const SENSOR: Sensor = Sensor {
    geometry: Geometry::PAPER,
    gains: Gains::uniform(10.0),
};
const SAMPLES: usize = 600;
const FAILED_FROM: usize = 200;
/// So much noise is expected that nothing but a channel that cannot be read fails.
const NOISE_V: f64 = 10.0;

fn parameters() -> Parameters {
    Parameters {
        zero_drift_v: [0.01; LIMBS],
        scale_per_mass_per_kg: [5.0; LIMBS],
        inertia_per_mass: InertiaPerMass::from_paper_order([
            191e-6, 236e-6, 327e-6, 0.1e-6, -0.4e-6, 1.6e-6,
        ]),
        stiffness_per_mass_per_s2: 2e8,
    }
}

fn row(sample: usize) -> [f64; LIMBS] {
    core::array::from_fn(|limb| 0.01 + 0.2 * (3e-3 * sample as f64 + limb as f64).sin())
}

/// Answers to a recording of which one channel shows something that cannot be from some sample on.
fn answers(cross_talk: CrossTalk, shown_v: f64) -> Vec<Option<SixAxis>> {
    let (parameters, settings) = (parameters(), Settings::new(1e4));
    let watch = Watch::exact(1.0, [NOISE_V; LIMBS]);
    let rows = vec![[0.0; LIMBS]; 64];
    let mut stream = FaultTolerant::new(&SENSOR, &parameters, &settings, &watch, rows)
        .expect("a sound sensor")
        .with_cross_talk(Some(cross_talk));
    (0..SAMPLES)
        .map(|sample| {
            let mut shown = row(sample);
            if sample >= FAILED_FROM {
                shown[4] = shown_v;
            }
            let watched = stream.push(&shown).expect("a row");
            assert_eq!(watched.excluded.is_empty(), sample < FAILED_FROM);
            watched.answer
        })
        .collect()
}

#[test]
fn what_a_failed_channel_shows_reaches_no_other() {
    let (parameters, settings) = (parameters(), Settings::new(1e4));
    let shares =
        core::array::from_fn(|i| core::array::from_fn(|j| 2e-3 * ((i + 4 * j) as f64).cos()));
    let cross_talk =
        CrossTalk::new(&SENSOR, &parameters, &shares, [0.0; 3], 0.0).expect("small shares");
    let unreadable = answers(cross_talk, f64::NAN);
    let mut plain = Decoupler::new(&SENSOR, &parameters, &settings).expect("a sound sensor");
    for (sample, answer) in unreadable.iter().enumerate().take(FAILED_FROM) {
        let undone = cross_talk.undo(&row(sample));
        assert_ne!(undone, row(sample));
        assert_eq!(*answer, plain.push(&undone).expect("a row"));
    }
    // Beyond any strain, and 0.4 % of it in the others would be beyond any force.
    for shown_v in [f64::INFINITY, 1e9, -1e9] {
        assert_eq!(answers(cross_talk, shown_v), unreadable, "{shown_v}");
    }
}
