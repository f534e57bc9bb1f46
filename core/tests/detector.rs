//! Detection where a calibration's errors count: statistics of made-up rows in closed form.
//!
//! Where all channels have one noise sigma, Q^-1 W^T W is the unit matrix over sigma^2: errors of one variance v per limb divide a
//! statistic by 1 + v/sigma^2.

use sixaxis_core::LIMBS;
use sixaxis_core::redundancy::fault::CalibrationErrors;
use sixaxis_core::redundancy::fault::detector::{Detector, Test};
use sixaxis_core::redundancy::fault::noise::RowNoise;

const NOISE: f64 = 1e-8;
/// Relative error of the scale factors, error of the zero drifts in strain.
const SCALE: f64 = 1e-3;
const DRIFT: f64 = 2e-9;
/// Rounding of a few thousand sums.
const ROUNDING: f64 = 1e-12;

/// The statistic at the last of a test's samples, of whitened rows and strains (the same of all limbs) as the sample says.
fn statistic(
    test: Test,
    errors: bool,
    row: impl Fn(f64) -> f64,
    strain: impl Fn(f64) -> f64,
) -> f64 {
    let noise = RowNoise::from_channels(&[NOISE; LIMBS]).expect("noise");
    let errors = errors.then_some(CalibrationErrors::independent(
        [SCALE; LIMBS],
        [DRIFT; LIMBS],
    ));
    let mut detector = Detector::new(noise, Detector::LARGEST_RATE, errors).expect("a rate");
    let mut last = None;
    for sample in 0..test.samples() {
        let t = sample as f64;
        let alarms = detector.push(&[0.0, row(t), 0.0], &[strain(t); LIMBS]);
        last = alarms.iter().find(|alarm| alarm.test == test);
    }
    last.expect("far beyond the threshold").statistic
}

#[test]
fn inv_errors_of_calibration_divide_the_statistics() {
    let (row, strain) = (40.0, 3e-5);
    for test in [
        Test::Sample,
        Test::Mean(8),
        Test::Mean(512),
        Test::Slope(64),
        Test::Slope(512),
    ] {
        let n = test.samples() as f64;
        let middle = (n - 1.0) / 2.0;
        let squares = n * (n * n - 1.0) / 12.0;
        let slope = matches!(test, Test::Slope(_));
        let row = |t: f64| if slope { row * (t - middle) / n } else { row };
        // A slope does not see what is constant.
        let strain = |t: f64| {
            if slope {
                strain * (1.0 + (t - middle) / n)
            } else {
                strain
            }
        };
        let (alone, variance) = match test {
            Test::Slope(_) => (
                squares * (row(1.0) - row(0.0)).powi(2),
                squares * (SCALE * (strain(1.0) - strain(0.0))).powi(2),
            ),
            _ => (
                n * row(0.0).powi(2),
                n * ((SCALE * strain(0.0)).powi(2) + DRIFT * DRIFT),
            ),
        };
        let with = alone / (1.0 + variance / (NOISE * NOISE));
        for (errors, expected) in [(false, alone), (true, with)] {
            let ours = statistic(test, errors, row, strain);
            assert!(
                (ours / expected - 1.0).abs() < ROUNDING,
                "{test:?}: {ours}, not {expected}"
            );
        }
    }
}
