//! The joint estimate as it is reported: intervals, covariances, k/m and instruments of a fit whose numbers are made up, so that
//! every answer has a closed form.

use glam::DVec3;
use nalgebra::{DMatrix, DVector, SMatrix};
use sixaxis_calibration::finding::Cause;
use sixaxis_calibration::joint::JointReport;
use sixaxis_calibration::report::ParameterReport;
use sixaxis_core::LIMBS;
use sixaxis_core::identify::joint::Known;
use sixaxis_core::identify::joint::estimate::{JointEstimate, TrialEstimate};
use sixaxis_core::identify::joint::room::Spreads;
use sixaxis_core::identify::joint::unknowns::{
    ACCELEROMETER_GAIN, AMPLIFIER_CORNER, ANGLES, COMPLIANCE, GYROSCOPE_GAIN, GYROSCOPE_LAG,
    INERTIA, MASS_CENTRE, MASS_PER_SCALE, Unknowns, WEDGES, Wedge,
};
use sixaxis_core::parameter::{PARAMETERS, Parameter};
use sixaxis_core::significance::NORMAL_95;

/// Rounding of products of a few numbers.
const ROUNDING: f64 = 1e-12;
/// Midpoints of 256 parts of an even spread, and a quantile between two of them.
const QUADRATURE: f64 = 5e-3;
/// The certificate's limit.
const LIMIT: f64 = 0.01;
/// Relative standard deviation of every unknown.
const SHARE: f64 = 1e-3;
/// Deviation of what all sensitivities change by together from one kind of trials to the other.
const TOGETHER: f64 = 1.1547e-3;
/// Correlation of any two.
const CORRELATION: f64 = 0.2;
const DEGREES: usize = 20_000;
const TRIALS: usize = 3;

/// A fit without contradiction whose scale factors, and nothing else, go with the accelerometer's gain.
fn estimate() -> JointEstimate {
    let mut values = DVector::from_element(WEDGES + ANGLES, 1e-3);
    for i in 0..9 {
        values[MASS_PER_SCALE + i] = 2.0 + 0.25 * i as f64;
    }
    for j in 0..6 {
        values[INERTIA + j] = 1e-4 * (j + 1) as f64;
    }
    values[COMPLIANCE] = 4e-9;
    values[ACCELEROMETER_GAIN] = 0.0;
    values[GYROSCOPE_GAIN] = 2e-3;
    values[GYROSCOPE_LAG] = 1e-4;
    values[AMPLIFIER_CORNER] = core::f64::consts::TAU * 0.5;
    let n = values.len();
    let covariance = DMatrix::from_fn(n, n, |a, b| {
        let correlation = if a == b { 1.0 } else { CORRELATION };
        correlation * SHARE * SHARE * values[a] * values[b]
    });
    let mut by_accelerometer_gain = DVector::zeros(n);
    for i in 0..9 {
        by_accelerometer_gain[MASS_PER_SCALE + i] = -values[MASS_PER_SCALE + i];
    }
    JointEstimate {
        unknowns: Unknowns {
            values,
            wedges: vec![Wedge {
                nominal: DVec3::Z,
                sideways: [DVec3::X, DVec3::Y],
            }],
        },
        covariance,
        by_accelerometer_gain,
        accelerometer_gain_seen: 0.0,
        accelerometer_gain_information: 0.0,
        compliance_from_elsewhere: false,
        squares: DEGREES as f64,
        degrees_of_freedom: DEGREES,
        iterations: 4,
        spreads: Spreads {
            stiffness: 5e-3,
            cross_talk_beside: 2e-3,
            cross_talk_apart: 1e-5,
            sensitivity: 0.0,
            wedge_rad: 1e-3,
        },
        trials: vec![quiet(); TRIALS],
    }
}

/// To what a trial's zeros are known, V.
const ZERO_DEVIATION_V: f64 = 1e-4;

/// A trial that has nothing of its own.
fn quiet() -> TrialEstimate {
    TrialEstimate {
        wedge: 0,
        excess: 0.0,
        zero_v: [Known::about_zero(ZERO_DEVIATION_V); LIMBS],
        sensitivity: [Known::about_zero(1e-4); LIMBS],
        centre_m: Some([Known::about_zero(1e-6); 2]),
        plumb: Some([Known::about_zero(1e-5); 2]),
    }
}

/// What the four steps say of all 25: determined, and other than anything here.
fn four_steps() -> Vec<ParameterReport> {
    Parameter::all()
        .map(|parameter| ParameterReport {
            parameter,
            unit: parameter.unit().to_owned(),
            estimate: 77.0,
            design: 88.0,
            half_width_95: Some(1.0),
            from_noise: None,
            from_trials: None,
            from_standards: None,
            dominated_by: "four steps".to_owned(),
            determined: true,
            remark: "four steps".to_owned(),
        })
        .collect()
}

fn close(what: &str, ours: f64, expected: f64, tolerance: f64) {
    let off = (ours - expected).abs();
    assert!(
        off <= tolerance * expected.abs(),
        "{what}: {ours}, not {expected}"
    );
}

#[test]
fn inv_noise_and_gain_make_the_deviations() {
    let report = report_of(estimate());
    let (noise, gain) = (report.noise_covariance(), report.gain_covariance());
    for a in 0..PARAMETERS {
        let together = noise[(a, a)] + gain[(a, a)];
        close("variance", together, report.deviations[a].powi(2), ROUNDING);
        for b in 0..PARAMETERS {
            let root = (noise[(a, a)] * noise[(b, b)]).sqrt();
            let sign = if (9..18).contains(&a) == (9..18).contains(&b) {
                1.0
            } else {
                -1.0
            };
            let expected = if a == b { 1.0 } else { sign * CORRELATION };
            close(
                "correlation by noise",
                noise[(a, b)] / root,
                expected,
                ROUNDING,
            );
            // All scale factors move together with the gain, and by their own size.
            let relative = gain[(a, b)] / (report.values[a] * report.values[b]);
            let scales = (9..18).contains(&a) && (9..18).contains(&b);
            let expected = if scales { LIMIT * LIMIT / 3.0 } else { 0.0 };
            close(
                "relative covariance by the gain",
                relative,
                expected,
                QUADRATURE,
            );
        }
        // A reciprocal has the same relative deviation.
        close(
            "relative deviation",
            noise[(a, a)].sqrt(),
            SHARE * report.values[a],
            ROUNDING,
        );
    }
}

/// Before and after a day sensitivities are twice their scatter away from their mean, and zeros elsewhere.
#[test]
fn inv_what_moves_between_recordings_widens_scale_factors_and_zeros() {
    const SPREAD: f64 = 1e-2;
    const ZERO_V: f64 = 2e-3;
    let still = report_of(estimate());
    let mut moving = estimate();
    moving.spreads.sensitivity = SPREAD;
    for trial in &mut moving.trials {
        trial.zero_v[4].value = ZERO_V;
    }
    let moving = report_of(moving);
    let noise = still.noise_covariance();
    assert_eq!(noise, moving.noise_covariance());
    let next = moving.covariance_of_next_recording();
    for a in 0..PARAMETERS {
        for b in 0..PARAMETERS {
            let moved = if a == b && (9..18).contains(&a) {
                4.0 * (SPREAD * moving.values[a]).powi(2)
            } else {
                0.0
            };
            let zero = if (a, b) == (4, 4) {
                ZERO_V.powi(2) - ZERO_DEVIATION_V.powi(2)
            } else {
                0.0
            };
            let expected = noise[(a, b)] + moved + zero;
            close("covariance of the next", next[(a, b)], expected, ROUNDING);
            let gain = moving.gain_covariance()[(a, b)];
            if a == b {
                let stated = moving.deviations[a].powi(2);
                close("variance", stated, noise[(a, a)] + moved + gain, ROUNDING);
            }
        }
    }
    let ours = moving.parameter_reports(&four_steps());
    for (p, own) in ours.iter().enumerate().skip(MASS_PER_SCALE) {
        let expected = if p < 18 {
            let moved = NORMAL_95 * 2.0 * SPREAD * own.estimate;
            close(
                "moved",
                own.from_trials.expect("a scale factor"),
                moved,
                ROUNDING,
            );
            "sensitivities that move over the day"
        } else {
            assert_eq!(own.from_trials, None);
            "noise"
        };
        assert_eq!(own.dominated_by, expected);
    }
    let strains = |report: &JointReport| SMatrix::from(report.limbs().strain_covariance);
    let moved = SMatrix::<f64, LIMBS, LIMBS>::identity() * (4.0 * SPREAD * SPREAD);
    let off = (strains(&moving) - strains(&still) - moved).amax();
    assert!(off <= ROUNDING * moved.amax(), "strains: {off}");
}

/// Twelve squares in excess for each of the fifteen parameters that forces tell, and twice as many that hide: 1 + 2 x 12 is the
/// square of five. Among two hundred degrees of freedom they contradict; among twenty thousand they are noise.
#[test]
fn inv_a_contradiction_widens_all_but_a_compliance_from_elsewhere() {
    let own = report_of(estimate()).noise_covariance();
    for (degrees, wider) in [(200, 5.0), (DEGREES, 1.0)] {
        for compliance_from_elsewhere in [false, true] {
            let wide = report_of(JointEstimate {
                squares: (12 * 15 + degrees) as f64,
                degrees_of_freedom: degrees,
                compliance_from_elsewhere,
                ..estimate()
            });
            assert_eq!(wide.misfit.contradicts(), wider > 1.0);
            let given = |p: usize| compliance_from_elsewhere && p == PARAMETERS - 1;
            let width = |p: usize| if given(p) { 1.0 } else { wider };
            let noise = wide.noise_covariance();
            for a in 0..PARAMETERS {
                for b in 0..PARAMETERS {
                    let expected = width(a) * width(b) * own[(a, b)];
                    close("covariance", noise[(a, b)], expected, ROUNDING);
                }
            }
        }
    }
}

/// What the trials tell of the gain is information that a contradiction takes back, too.
#[test]
fn inv_trials_tell_the_gain_where_they_narrow_its_certificate() {
    let spread = LIMIT / 3.0_f64.sqrt();
    let told = |share: f64, wider: f64| {
        let squares = (wider * wider - 1.0) / 2.0 * 15.0 + 200.0;
        let report = report_of(JointEstimate {
            accelerometer_gain_seen: 0.2 * LIMIT,
            accelerometer_gain_information: (wider / (share * spread)).powi(2),
            squares,
            degrees_of_freedom: 200,
            ..estimate()
        });
        (report.gain_is_told(), report)
    };
    for wider in [1.0, 5.0] {
        let (yes, report) = told(0.3, wider);
        assert!(yes);
        close("mean", report.gain.mean(), 0.2 * LIMIT, QUADRATURE);
        close(
            "deviation",
            report.gain.deviation(),
            (0.3 * spread).hypot(TOGETHER),
            QUADRATURE,
        );
        assert!(!told(0.6, wider).0);
    }
    let report = report_of(estimate());
    assert!(!report.gain_is_told());
    close("even spread", report.gain.deviation(), spread, QUADRATURE);
}

#[test]
fn inv_reports_carry_noise_and_certificate() {
    let report = report_of(estimate());
    let ours = report.parameter_reports(&four_steps());
    assert_eq!(ours.len(), PARAMETERS);
    // Of the static record both estimators know the same.
    assert_eq!(ours[..MASS_PER_SCALE], four_steps()[..MASS_PER_SCALE]);
    for (p, own) in ours.iter().enumerate().skip(MASS_PER_SCALE) {
        assert_eq!(own.parameter.place(), p);
        assert!(own.determined);
        // A scale factor's slope over itself is one: 95 % of an even spread.
        let certificate = if (9..18).contains(&p) {
            0.95 * LIMIT
        } else {
            0.0
        };
        let size = own.estimate;
        let noise = own.from_noise.expect("noise");
        let gain = own.from_standards.expect("gain");
        let half = own.half_width_95.expect("determined");
        close("noise", noise / size, NORMAL_95 * SHARE, ROUNDING);
        close("certificate", gain / size, certificate, QUADRATURE);
        let at_least = noise.max(gain) / size;
        let at_most = (noise + gain) / size;
        assert!(
            half / size > at_least * (1.0 - QUADRATURE)
                && half / size < at_most * (1.0 + QUADRATURE)
        );
        let expected = if certificate > 0.0 {
            "certificate of the accelerometer"
        } else {
            "noise"
        };
        assert_eq!(own.dominated_by, expected);
    }
    let stiffness = &ours[PARAMETERS - 1];
    close("k/m", stiffness.estimate, 1.0 / 4e-9, ROUNDING);
    assert_eq!(stiffness.remark, "from all trials");
    // An interval as wide as the value.
    let mut vague = estimate();
    vague.covariance *= 1e6;
    vague.covariance[(COMPLIANCE, COMPLIANCE)] *= 1e-6;
    let ours = report_of(vague).parameter_reports(&four_steps());
    for (p, own) in ours.iter().enumerate() {
        assert_eq!(
            own.determined,
            !own.parameter.has_size() || p == PARAMETERS - 1
        );
    }
}

#[test]
fn inv_a_compliance_that_is_open_leaves_the_design() {
    let with = |share: f64| {
        let mut fit = estimate();
        let place = (COMPLIANCE, COMPLIANCE);
        fit.covariance[place] = (share * fit.unknowns.values[COMPLIANCE]).powi(2);
        report_of(fit)
    };
    assert!(with(0.09).compliance_is_determined);
    close(
        "k/m",
        with(0.09).parameters(5.0).stiffness_per_mass_per_s2,
        1.0 / 4e-9,
        ROUNDING,
    );
    let open = with(0.11);
    assert!(!open.compliance_is_determined);
    close(
        "k/m",
        open.parameters(5.0).stiffness_per_mass_per_s2,
        5.0,
        ROUNDING,
    );
    let last = |four: &[ParameterReport]| open.parameter_reports(four)[PARAMETERS - 1].clone();
    // Taps have determined it.
    let mut four = four_steps();
    assert_eq!(last(&four), four[PARAMETERS - 1]);
    for (determined, half_width_95) in [(false, Some(1.0)), (true, None)] {
        four[PARAMETERS - 1].determined = determined;
        four[PARAMETERS - 1].half_width_95 = half_width_95;
        let left = last(&four);
        assert!(!left.determined && left.half_width_95.is_none());
        close("design", left.estimate, 88.0, ROUNDING);
    }
    let mut negative = estimate();
    negative.unknowns.values[COMPLIANCE] *= -1.0;
    assert!(!report_of(negative).compliance_is_determined);
}

/// Where the mass's centre is, and where it is held.
#[test]
fn inv_the_mass_s_centre_is_told_and_kept() {
    let mut fit = estimate();
    let place = [3e-4, -2e-4, 1e-4];
    for (axis, along_m) in place.into_iter().enumerate() {
        fit.unknowns.values[MASS_CENTRE + axis] = along_m;
        fit.covariance[(MASS_CENTRE + axis, MASS_CENTRE + axis)] = 4e-12;
    }
    let report = report_of(fit.clone());
    assert_eq!(report.limbs().mass_centre_m, place);
    let told = report.nuisances().room.mass_centre_m.expect("free");
    close("along y", told[1].value, -2e-4, ROUNDING);
    close("its deviation", told[1].deviation, 2e-6, ROUNDING);
    // Ordinary, with something that it does not explain, and farther than anyone misses the middle.
    assert_eq!(report.odd_mass_centre(), None);
    let odd = |change: &dyn Fn(&mut JointEstimate)| {
        let mut fit = fit.clone();
        change(&mut fit);
        report_of(fit).odd_mass_centre().unwrap_or_default()
    };
    let left = odd(&|fit| fit.spreads.cross_talk_apart = 3e-4);
    assert!(
        left.contains("0.37 mm") && left.contains("0.030 %"),
        "{left}"
    );
    let far = odd(&|fit| fit.unknowns.values[MASS_CENTRE] = 1.2e-3);
    assert!(far.contains("more than a workshop"), "{far}");
    fit.covariance[(MASS_CENTRE, MASS_CENTRE)] = 0.0;
    assert_eq!(report_of(fit).nuisances().room.mass_centre_m, None);
}

/// Gravity tells the gain no better than it is known itself: a level rig at the equator was 16 half widths off. Nor better than sensitivities
/// stay from the trials that travel to those that turn: where all of them grew by 0.2 %, scale factors were ten half widths off.
#[test]
fn inv_a_gain_is_told_no_better_than_gravity_is_known() {
    let told = |gravity_deviation: f64| {
        let fit = JointEstimate {
            accelerometer_gain_information: 1e8,
            ..estimate()
        };
        let report = JointReport::new(fit, vec!["a".to_owned()], LIMIT, gravity_deviation);
        report.gain.deviation()
    };
    close("as stated", told(0.0), TOGETHER.hypot(1e-4), QUADRATURE);
    let uncertain = TOGETHER.hypot(1e-3).hypot(1e-4);
    close("to 0.1 %", told(1e-3), uncertain, QUADRATURE);
}

#[test]
fn inv_instruments_are_told_in_their_own_units() {
    let mut fit = estimate();
    fit.accelerometer_gain_seen = 4e-3;
    fit.accelerometer_gain_information = 1e10;
    fit.by_accelerometer_gain[GYROSCOPE_GAIN] = 0.5;
    let angle = WEDGES;
    fit.unknowns.values[angle] = 0.0;
    let lag = (GYROSCOPE_LAG, GYROSCOPE_LAG);
    fit.covariance[lag] = 0.0;
    let found = report_of(fit).nuisances();
    close(
        "accelerometer",
        found.accelerometer_gain.value,
        4e-3,
        QUADRATURE,
    );
    assert!(found.accelerometer_gain_is_told);
    // The fit was made at a gain of nothing.
    let gyroscope = found.gyroscope_gain.expect("free");
    close("gyroscope", gyroscope.value, 2e-3 + 0.5 * 4e-3, QUADRATURE);
    let expected = (SHARE * 2e-3_f64).hypot(0.5 * TOGETHER);
    close("its deviation", gyroscope.deviation, expected, QUADRATURE);
    assert_eq!(found.gyroscope_lag_s, None);
    let corner = found.amplifier_corner_hz.expect("free");
    close("corner", corner.value, 0.5, ROUNDING);
    close("its deviation", corner.deviation, SHARE * 0.5, ROUNDING);
    let [wedge] = &found.wedges[..] else {
        panic!("one wedge")
    };
    close("direction", wedge.direction[1], 1e-3, 1e-6);
    let [_, along_y] = wedge.angles_deg.expect("free");
    close(
        "angle",
        along_y.value,
        1e-3 * 180.0 / core::f64::consts::PI,
        ROUNDING,
    );
}

/// What a fit to recordings a, b, c and so on comes to.
fn report_of(fit: JointEstimate) -> JointReport {
    let names = ('a'..='z').take(fit.trials.len()).map(String::from);
    let names = names.collect();
    JointReport::new(fit, names, LIMIT, 0.0)
}

/// Cause, recordings and channels of a finding.
type Short = (Cause, Vec<String>, Vec<usize>);

/// Findings of a fit after a change; none where it does not account for its trials.
fn found(change: impl FnOnce(&mut JointEstimate)) -> Option<Vec<Short>> {
    let mut fit = estimate();
    fit.unknowns.values.rows_mut(WEDGES, ANGLES).fill(0.0);
    change(&mut fit);
    let report = report_of(fit);
    report.accounts().then(|| {
        let findings = report.extraordinary(10.0, LIMIT, None, None, None);
        let short = findings.into_iter();
        short.map(|f| (f.cause, f.recordings, f.channels)).collect()
    })
}

#[test]
fn inv_an_ordinary_room_is_nothing_to_find() {
    assert_eq!(found(|_| {}), Some(Vec::new()));
    // A little of everything, all of it certain.
    let ordinary = |fit: &mut JointEstimate| {
        fit.unknowns.values[WEDGES] = 0.2_f64.to_radians();
        for trial in &mut fit.trials {
            trial.sensitivity[3].value = 2e-3;
            trial.zero_v[4].value = 5e-3;
            trial.centre_m.as_mut().expect("turns")[0].value = 1e-3;
            trial.plumb.as_mut().expect("turns")[1].value = 3e-3;
        }
    };
    assert_eq!(found(ordinary), Some(Vec::new()));
}

#[test]
fn inv_what_is_out_of_the_ordinary_is_named_by_the_unknown_that_took_it_up() {
    let all = || vec!["a".to_owned(), "b".to_owned(), "c".to_owned()];
    let one = |name: &str| vec![name.to_owned()];
    let first = |change: &dyn Fn(&mut JointEstimate)| {
        let mut found = found(change).expect("accounted for");
        assert_eq!(found.len(), 1, "{found:?}");
        found.remove(0)
    };
    assert_eq!(
        first(&|fit| fit.unknowns.values[WEDGES + 1] = 1.0_f64.to_radians()),
        (Cause::LooseWedge, all(), vec![])
    );
    for (factor, cause) in [
        (1.1, Cause::WrongScaling),
        (-1.0, Cause::InvertedChannel),
        (0.0, Cause::DeadLimb),
    ] {
        assert_eq!(
            first(&|fit| fit.trials[1].sensitivity[4].value = factor - 1.0),
            (cause, one("b"), vec![5])
        );
    }
    let torn = |fit: &mut JointEstimate| {
        for zero in &mut fit.trials[1].zero_v[2..6] {
            zero.value = 0.1;
        }
    };
    assert_eq!(first(&torn), (Cause::Unexplained, one("b"), vec![]));
    // The means of a run that does not end where it began have each its part of the motion, and may be short of what is noticed alone.
    let torn_a_little = |fit: &mut JointEstimate| {
        for (limb, zero) in fit.trials[1].zero_v.iter_mut().enumerate() {
            zero.value = if limb == 3 { 0.06 } else { -0.03 };
        }
    };
    assert_eq!(
        first(&torn_a_little),
        (Cause::Unexplained, one("b"), vec![])
    );
    // The smaller one leaves no trial by as much as one channel of one trial would have to.
    for values in [[-0.02, 0.001, 0.02], [-0.007, 0.0, 0.007]] {
        let fading = |fit: &mut JointEstimate| {
            for (trial, value) in fit.trials.iter_mut().zip(values) {
                trial.sensitivity[4].value = value;
            }
        };
        assert_eq!(first(&fading), (Cause::FadingSensitivity, vec![], vec![5]));
    }
    assert_eq!(
        first(&|fit| {
            fit.trials[2].zero_v = fit.trials[2].zero_v.map(|zero| Known {
                value: 0.02,
                ..zero
            });
            fit.trials[2].zero_v[0].value = 0.1;
        }),
        (Cause::DriftDuringRun, one("c"), vec![1])
    );
    assert_eq!(
        first(&|fit| fit.trials[0].plumb.as_mut().expect("turns")[0].value = 0.02),
        (Cause::GravityNotHandled, one("a"), vec![])
    );
    assert_eq!(
        first(&|fit| fit.trials[0].centre_m.as_mut().expect("turns")[1].value = 0.01),
        (Cause::Unexplained, one("a"), vec![])
    );
    assert_eq!(
        first(&|fit| fit.unknowns.values[GYROSCOPE_GAIN] = 0.03),
        (Cause::WrongScaling, vec![], vec![])
    );
}

#[test]
fn inv_one_channel_that_steps_is_named_and_several_are_not() {
    // Eight trials, of which these channels show so much more from the fifth on.
    let stepped = |channels: &'static [usize], by: f64| {
        move |fit: &mut JointEstimate| {
            fit.trials = vec![quiet(); 8];
            for trial in &mut fit.trials[4..] {
                channels
                    .iter()
                    .for_each(|limb| trial.sensitivity[*limb].value = by);
            }
        }
    };
    for by in [0.015, -0.1] {
        let mut fit = estimate();
        fit.unknowns.values.rows_mut(WEDGES, ANGLES).fill(0.0);
        stepped(&[4], by)(&mut fit);
        let report = report_of(fit);
        assert!(report.accounts(), "{by}");
        let found = report.extraordinary(10.0, LIMIT, None, None, None);
        assert_eq!(found.len(), 1, "{found:?}");
        assert_eq!(
            (found[0].cause, &found[0].channels[..]),
            (Cause::FadingSensitivity, &[5][..])
        );
        assert!(found[0].evidence.contains("before e"), "{found:?}");
    }
    // Trials that turn, every other one here, and those that do not.
    let turning = |fit: &mut JointEstimate| {
        fit.trials = vec![quiet(); 8];
        for trial in fit.trials.iter_mut().step_by(2) {
            trial.sensitivity[4].value = 0.02;
        }
        for trial in fit.trials.iter_mut().skip(1).step_by(2) {
            (trial.centre_m, trial.plumb) = (None, None);
        }
    };
    let named = vec![(Cause::FadingSensitivity, vec![], vec![5])];
    assert_eq!(found(turning), Some(named));
    // Less than an ordinary room's is nothing; plugs that are exchanged, and a gain's step, are no sensor's doing.
    assert_eq!(found(stepped(&[4], 0.005)), Some(Vec::new()));
    assert_eq!(found(stepped(&[4, 7], 0.1)), None);
    assert_eq!(found(stepped(&[4], 1.0)), None);
}

/// Eight trials over which these channels' sensitivities fall by so much along a line, with a scatter of their own, and channel 2's by twice
/// as much where it is not among them.
fn falling(channels: core::ops::Range<usize>, by: f64) -> JointEstimate {
    let mut fit = estimate();
    fit.unknowns.values.rows_mut(WEDGES, ANGLES).fill(0.0);
    fit.trials = vec![quiet(); 8];
    for (index, trial) in fit.trials.iter_mut().enumerate() {
        let place = index as f64 / 7.0 - 0.5;
        for (limb, own) in trial.sensitivity.iter_mut().enumerate() {
            let scatter = 0.2 * by * ((3 * index + 5 * limb) as f64).sin();
            if channels.contains(&limb) {
                own.value = scatter - by * place;
            } else if limb == 1 {
                own.value = -2.0 * by * place;
            }
        }
    }
    fit
}

#[test]
fn inv_what_most_channels_do_alike_over_the_day_is_one_finding() {
    let found = |channels, by, accelerometer_changes| {
        let report = report_of(falling(channels, by));
        assert!(report.accounts());
        report.extraordinary(10.0, LIMIT, None, None, accelerometer_changes)
    };
    for (accelerometer_changes, words) in [
        (None, "as they do where the standard accelerometer's"),
        (
            Some(0.018),
            "it is the standard accelerometer, which changes by +1.80 %",
        ),
        (Some(0.001), "as the sensor's do with its temperature"),
        (
            Some(-0.018),
            "as they do where the standard accelerometer's",
        ),
    ] {
        let all = found(0..9, 0.016, accelerometer_changes);
        let [one] = &all[..] else { panic!("{all:#?}") };
        assert_eq!(one.cause, Cause::FadingSensitivity);
        assert!(
            one.channels.is_empty() && one.recordings.is_empty(),
            "{one:?}"
        );
        assert!(one.evidence.contains("all channels"), "{one:?}");
        assert!(one.evidence.contains(words), "{one:?}");
    }
    // One that changes otherwise is named beside it.
    let beside = found(2..9, 0.016, None);
    let channels: Vec<&[usize]> = beside.iter().map(|f| &f.channels[..]).collect();
    assert_eq!(channels, [&[][..], &[2]], "{beside:#?}");
    // Few are not all, and less than an ordinary room's is nothing.
    let few = report_of(falling(4..9, 0.016));
    assert_eq!(few.common_change(), None);
    assert!(found(0..9, 0.008, None).is_empty());
}

/// A gain that the certificate does not allow, and that a clock makes of one that it allows: by as much as no motor is off it is the clock, by
/// less it is one of two things, and where the clock does not make it, or nothing is known of it, it is the gain.
#[test]
fn inv_a_clock_that_makes_the_gyroscopes_gain_is_named() {
    let of = |gain: f64, drive_faster| {
        let mut fit = estimate();
        fit.unknowns.values.rows_mut(WEDGES, ANGLES).fill(0.0);
        fit.unknowns.values[GYROSCOPE_GAIN] = gain;
        let found = report_of(fit).extraordinary(10.0, LIMIT, None, drive_faster, None);
        found.into_iter().map(|f| f.cause).collect::<Vec<_>>()
    };
    for (gain, drive_faster, cause) in [
        (-0.013, Some(0.006), Some(Cause::ClockMismatch)),
        (-0.0115, Some(0.0025), Some(Cause::Unexplained)),
        (0.0115, Some(-0.0025), Some(Cause::Unexplained)),
        (-0.013, Some(-0.006), Some(Cause::WrongScaling)),
        (-0.03, Some(0.006), Some(Cause::WrongScaling)),
        (-0.013, None, Some(Cause::WrongScaling)),
        (-0.005, Some(0.006), None),
    ] {
        assert_eq!(
            of(gain, drive_faster),
            Vec::from_iter(cause),
            "{gain} {drive_faster:?}"
        );
    }
}

#[test]
fn inv_the_trial_that_leaves_most_over_is_named() {
    let mut fit = estimate();
    fit.trials[1].excess = 300.0;
    fit.trials[0].excess = -50.0;
    fit.trials[2].excess = 200.0;
    assert_eq!(report_of(fit.clone()).most_of_the_misfit(), Some("b"));
    fit.trials[0].excess = 150.0;
    assert_eq!(report_of(fit).most_of_the_misfit(), None);
}

#[test]
fn neg_what_no_room_explains_is_not_accounted_for() {
    let changes: [&dyn Fn(&mut JointEstimate); 5] = [
        &|fit| fit.squares *= 1.1,
        &|fit| fit.spreads.stiffness = 0.1,
        &|fit| fit.spreads.cross_talk_beside = 0.02,
        // An exchange of plugs in one trial, a channel that is another in two of three.
        &|fit| {
            fit.trials[1].sensitivity[4].value = 0.5;
            fit.trials[1].sensitivity[7].value = -0.3;
        },
        &|fit| {
            fit.trials[0].sensitivity[4].value = 0.04;
            fit.trials[2].sensitivity[4].value = 0.04;
        },
    ];
    for change in changes {
        assert_eq!(found(change), None);
    }
}
