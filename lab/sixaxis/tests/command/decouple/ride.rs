//! A motion by hand in closed form, recorded without noise, and its truth.

use std::path::PathBuf;

use rand::SeedableRng;
use rand_pcg::Pcg64;
use sixaxis_reference::compliant::compliant_forces_m_s2;
use sixaxis_reference::laboratory::chain::Chain;
use sixaxis_reference::motion::TrueMotion;
use sixaxis_reference::rig::journey::{Journey, Kind};
use sixaxis_reference::sensor::TrueSensor;

use super::session::{LIMBS, write};
use crate::program::Folder;

/// The recording, `ride.csv` in its folder, its gains with commas, and what moved.
pub struct Ride {
    pub folder: Folder,
    pub gains: String,
    pub truth: Vec<TrueMotion>,
}

impl Ride {
    pub fn path(&self) -> PathBuf {
        self.folder.join("ride.csv")
    }

    /// Of the paper's sensor.
    pub fn recorded(name: &str, kind: Kind, seed: u64, rate_hz: f64, duration_s: f64) -> Self {
        let folder = Folder::new(name);
        let sensor = TrueSensor::identified();
        let rng = &mut Pcg64::seed_from_u64(seed);
        let journey = Journey::random(kind, rng);
        let samples = (duration_s * rate_hz) as usize;
        let truth: Vec<TrueMotion> = journey.play(rate_hz).take(samples).collect();
        let gravity = journey.gravity_ground_m_s2();
        let forces = compliant_forces_m_s2(&sensor, gravity, &truth).expect("limbs that hold");
        let chain = Chain::noise_free();
        let gains = chain.amplifier_ranges(&forces, &sensor);
        let volts = chain.record(&forces, &sensor, &gains, rate_hz, rng);
        let columns: Vec<Vec<f64>> = (0..LIMBS.len())
            .map(|limb| volts.iter().map(|row| row[limb]).collect())
            .collect();
        write(&folder.join("ride.csv"), &LIMBS, "V", &columns, rate_hz);
        let gains: Vec<String> = gains.iter().map(f64::to_string).collect();
        Self {
            folder,
            gains: gains.join(","),
            truth,
        }
    }
}
