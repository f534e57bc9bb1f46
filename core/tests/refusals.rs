//! What is refused is named: channel, sample, how many are needed.

use sixaxis_core::dsp::delay::Delay;
use sixaxis_core::dsp::outlier::hampel;
use sixaxis_core::dsp::resample::CubicSpline;
use sixaxis_core::dsp::stage::Stage;
use sixaxis_core::dsp::{detrend, each_channel};
use sixaxis_core::identify::compliance_fit::ComplianceFit;
use sixaxis_core::identify::joint::room::Room;
use sixaxis_core::identify::joint::unknowns::Wedges;
use sixaxis_core::identify::joint::{AtRest, Certificates, Joint};
use sixaxis_core::paper::limb_stream::LimbStream;
use sixaxis_core::{
    Error, Gains, Geometry, InertiaPerMass, LIMBS, Model, Parameters, Scheme, Sensor, Settings,
};

const SENSOR: Sensor = Sensor {
    geometry: Geometry::PAPER,
    gains: Gains {
        gain_n_per_v: [1.0; LIMBS],
    },
};

fn parameters() -> Parameters {
    Parameters {
        zero_drift_v: [0.0; LIMBS],
        scale_per_mass_per_kg: [5.0; LIMBS],
        inertia_per_mass: InertiaPerMass::from_paper_order([2e-4, 2.5e-4, 3e-4, 0.0, 0.0, 0.0]),
        stiffness_per_mass_per_s2: 3e8,
    }
}

fn settings() -> Settings {
    Settings {
        scheme: Scheme::Heun,
        ..Settings::new(1000.0)
    }
}

const CERTIFICATES: Certificates = Certificates {
    gyroscope_gain_deviation: 0.01,
    gyroscope_lag_s: None,
    channel_delay_s: 0.0,
    accelerometer_lag_s: 0.0,
    standard_delay_s: [0.0; 2],
    amplifier_corner_rad_s: None,
    wedge_deviation_rad: 1e-3,
    wedges: Wedges::Shared,
    compliance_s2: None,
    room: Room::NONE,
};

#[test]
fn inv_nothing_is_too_few() {
    let quiet = AtRest {
        drift_v: [0.0; LIMBS],
        deviation_v: [1e-6; LIMBS],
    };
    let joint = Joint::new(&Geometry::PAPER, CERTIFICATES, quiet).expect("sound");
    let error = joint.fit(&parameters()).expect_err("no trial");
    assert!(
        matches!(
            error,
            Error::TooFewSamples {
                needed: 1,
                got: 0,
                ..
            }
        ),
        "{error}"
    );
    let error = ComplianceFit::default().solve().expect_err("no sample");
    assert!(
        matches!(
            error,
            Error::TooFewSamples {
                needed: 3,
                got: 0,
                ..
            }
        ),
        "{error}"
    );
    // A window of three to either side and the sample itself.
    for (samples, enough) in [(6, false), (7, true)] {
        let found = hampel(&mut vec![1.0; samples], 3, 4.0);
        assert_eq!(found.is_ok(), enough);
        if let Err(error) = found {
            assert!(
                matches!(
                    error,
                    Error::TooFewSamples {
                        needed: 7,
                        got: 6,
                        ..
                    }
                ),
                "{error}"
            );
        }
    }
}

#[test]
fn inv_the_channel_and_the_sample_are_named() {
    for limb in 0..LIMBS {
        let mut drift_v = [0.0; LIMBS];
        drift_v[limb] = f64::NAN;
        let rest = AtRest {
            drift_v,
            deviation_v: [1e-6; LIMBS],
        };
        let error = Joint::new(&Geometry::PAPER, CERTIFICATES, rest).expect_err("no number");
        assert!(
            matches!(error, Error::NotFinite { channel, sample: 0, .. } if channel == limb + 1),
            "{error}"
        );

        let model = Model::new(&SENSOR, &parameters(), &settings()).expect("a sensor");
        let mut stream = LimbStream::new(&model).expect("no preload");
        for _ in 0..4 {
            stream.push(&[0.0; LIMBS]).expect("rest");
        }
        let mut row = [0.0; LIMBS];
        row[limb] = f64::INFINITY;
        let error = stream.push(&row).expect_err("no number");
        assert!(
            matches!(error, Error::NotFinite { channel, .. } if channel == limb + 1),
            "{error}"
        );

        let mut rows = vec![[1.0; LIMBS]; 50];
        rows[20][limb] = f64::NAN;
        let error = each_channel(&mut rows, |x| detrend::constant(x).map(|_| ()));
        assert!(
            matches!(error, Err(Error::NotFinite { channel, sample: 20, .. }) if channel == limb + 1)
        );
        rows[20][limb] = 1.0;
        for (n, row) in rows.iter_mut().enumerate() {
            row[limb] = if n.is_multiple_of(2) {
                f64::MAX
            } else {
                f64::MAX / 2.0
            };
        }
        let error = each_channel(&mut rows, |x| detrend::constant(x).map(|_| ()));
        assert!(
            matches!(error, Err(Error::Overflow { channel, .. }) if channel == limb + 1),
            "{error:?}"
        );
    }
}

/// Also the last pair of stamps is looked at.
#[test]
fn inv_the_stamp_that_does_not_advance_is_named() {
    let times_s: Vec<f64> = (0..20).map(f64::from).collect();
    let values = vec![0.0; times_s.len()];
    assert!(CubicSpline::through(&times_s, &values).is_ok());
    for at in 1..times_s.len() {
        let mut stuck = times_s.clone();
        stuck[at] = stuck[at - 1];
        let error = CubicSpline::through(&stuck, &values);
        assert!(
            matches!(error, Err(Error::IrregularTime { sample, .. }) if sample == at),
            "{error:?}"
        );
    }
}

/// A delay by so many samples reads as many before the record's first, and holds that.
#[test]
fn inv_a_delay_counts_what_it_holds() {
    for (samples, held) in [(0.0, 0), (3.0, 3), (-5.0, 5)] {
        let mut stage = Delay::new(samples).expect("finite");
        let mut out = Vec::new();
        stage.push(&[1.0; 100], &mut out);
        stage.finish(&mut out).expect("long enough");
        assert_eq!(stage.held(), held, "{samples}");
    }
}
