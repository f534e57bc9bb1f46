//! Errors propagated in closed form: against campaigns drawn at random, against derivatives of the whole pipeline.
//!
//! `SIXAXIS_PROPAGATION=20000` draws so many campaigns; the example `propagation` prints and publishes them.

use sixaxis_core::parameter::{COMPLIANCE, INERTIA, PARAMETERS, SCALE};
use std::sync::LazyLock;

use glam::DVec3;
use nalgebra::SVector;
use rayon::prelude::*;
use sixaxis_calibration::propagation::{Sources, TrialNoise, propagate};
use sixaxis_calibration::steps::{Campaign, GyroscopeGain};
use sixaxis_core::decouple::uncertainty::parameters::Covariance;
use sixaxis_core::decouple::uncertainty::{ChannelNoise, SampleUncertainty};
use sixaxis_core::identify::compliance_fit::ComplianceFit;
use sixaxis_core::{Error, Geometry, LIMBS, LimbSet, Scheme};
use sixaxis_props::compare::{fails_clearly, largest, within};
use sixaxis_props::evidence::Row;
use sixaxis_props::propagation::monte_carlo::{ClosedForm, Tally, departures, of_campaign};
use sixaxis_props::propagation::{Size, World, calibrate};
use sixaxis_props::statistics::chi_square_departure;
use sixaxis_props::tolerance::{self, Tolerance};
use sixaxis_recordings::session::Role;

/// First seed of the draws; the closed form sees the campaign of this one.
const SEED: u64 = 71;
/// Campaigns drawn in the short run: a standard deviation is known to 6 % by them. One stated a third too small is told two times in three, one
/// a third too large one time in three.
const DRAWS: u64 = 150;
/// Share of the laboratory's errors at which what first order leaves out is below what the draws can tell.
const SMALL: f64 = 0.01;

static WORLD: LazyLock<World> = LazyLock::new(|| {
    World::play(Size {
        rate_hz: 125.0,
        per_step: 6,
        static_samples: 64,
    })
});

fn draws() -> u64 {
    std::env::var("SIXAXIS_PROPAGATION")
        .ok()
        .and_then(|text| text.parse().ok())
        .unwrap_or(DRAWS)
}

/// Drawn over predicted variance as a chi-square variable, in half widths of the interval that chance leaves once in a million.
fn departure(drawn_deviation: f64, predicted_deviation: f64, draws: u64) -> f64 {
    let freedom = draws as usize - 1;
    let ratio = drawn_deviation / predicted_deviation;
    chi_square_departure(freedom as f64 * ratio * ratio, freedom)
}

#[test]
fn stat_drawn_campaigns_scatter_as_the_closed_form() {
    let draws = draws();
    println!(
        "seeds {SEED} (closed form), {} to {}",
        SEED + 1,
        SEED + draws
    );
    for (what, sources) in [
        ("noise alone", WORLD.noise_alone()),
        ("noise, gains and wedges", WORLD.sources.clone()),
    ] {
        let closed = ClosedForm::of(&WORLD, &sources, SEED).propagated;
        let total = closed.total();
        let drawn = Tally::draw(&WORLD, &sources, SEED + 1, draws).covariance();
        for i in 0..PARAMETERS {
            let [drawn, predicted] = [drawn, total].map(|c| c[(i, i)].sqrt());
            within(
                format!("chi-square of parameter {i}, {what}"),
                departure(drawn, predicted, draws),
                tolerance::CHI_SQUARE,
            );
            assert!(
                departure(2.0 * drawn, predicted, draws) > tolerance::CHI_SQUARE.limit,
                "twice the deviation of parameter {i} passes"
            );
        }
    }
}

#[test]
fn law_step_3_without_step_2s_error_states_too_small_deviations() {
    // Torques carry the scale factors; the accelerometer's gain reaches the inertias in no other way.
    let closed = of_campaign(&WORLD.clean, &WORLD.conditioning, &WORLD.sources);
    let whole = closed.noise;
    let cut = closed
        .chain
        .without(&INERTIA, &SCALE)
        .covariance(&closed.own_noise);
    let lost = departures(&cut, &whole)[INERTIA]
        .iter()
        .copied()
        .fold(0.0, f64::min);
    println!(
        "noise without the cross term: the inertias' worst deviation {:.1} %",
        100.0 * lost
    );
    assert!(
        -lost > tolerance::CROSS_TERM_LOST,
        "step 2's noise in step 3 goes unnoticed: {lost:.3}"
    );
    let by_gain = closed.per_gain[0];
    let found = calibrate(&WORLD.clean);
    for i in SCALE.chain(INERTIA.start..INERTIA.start + 3) {
        within(
            "an accelerometer's gain is the scale factors' and the inertias'",
            (by_gain[i] / found[i] - 1.0).abs(),
            tolerance::ROUNDING,
        );
    }
}

/// A campaign with one raw number of one trial changed.
fn changed(
    campaign: &Campaign,
    trial: usize,
    change: impl Fn(&mut sixaxis_calibration::trial::Trial),
) -> Campaign {
    let mut campaign = campaign.clone();
    let (own, conditioned) = &mut campaign.trials[trial];
    change(own);
    *conditioned = WORLD
        .conditioning
        .condition(own)
        .expect("a changed trial cleans");
    campaign
}

fn quiet() -> Sources {
    Sources {
        zero_drift_v: [0.0; LIMBS],
        trials: vec![TrialNoise::default(); WORLD.clean.trials.len()],
        accelerometer_gain: 0.0,
        gyroscope_gain: 0.0,
        wedge_rad: 0.0,
    }
}

#[test]
fn law_influences_are_derivatives_of_the_whole_pipeline() {
    // One source after the other: unit noise of one series of one trial. Its covariance must be the sum over raw samples of
    // products of derivatives of everything that happens to a sample: conditioning, rows, four steps.
    type Change = fn(&mut sixaxis_calibration::trial::Trial, usize, f64);
    type Source = fn(&mut TrialNoise);
    let kinds: [(&str, Role, Change, Source, Tolerance); 5] = [
        (
            "channel 4, step 2",
            Role::Linear,
            |t, k, e| t.voltage_v[k][3] += e,
            |n| n.channels_v[3] = 1.0,
            tolerance::BY_CHANNEL,
        ),
        (
            "accelerometer, step 2",
            Role::Linear,
            |t, k, e| t.accelerometer_m_s2[k] += e,
            |n| n.accelerometer_m_s2 = 1.0,
            tolerance::BY_LINEAR_SERIES,
        ),
        (
            "channel 2, step 3",
            Role::Angular,
            |t, k, e| t.voltage_v[k][1] += e,
            |n| n.channels_v[1] = 1.0,
            tolerance::BY_LINEAR_SERIES,
        ),
        (
            "gyroscope, step 3",
            Role::Angular,
            |t, k, e| t.gyroscope_rad_s[k] += e,
            |n| n.gyroscope_rad_s = 1.0,
            tolerance::BY_GYROSCOPE,
        ),
        (
            "channel 7, step 4",
            Role::HighFrequencyLinear,
            |t, k, e| t.voltage_v[k][6] += e,
            |n| n.channels_v[6] = 1.0,
            tolerance::BY_CHANNEL_OF_STEP_4,
        ),
    ];
    for (what, role, change, source, limit) in kinds {
        // The last trial of a step is the shortest.
        let trial = WORLD
            .clean
            .trials
            .iter()
            .rposition(|(t, _)| t.role == role)
            .expect("the campaign has all steps");
        let mut sources = quiet();
        source(&mut sources.trials[trial]);
        let ours = of_campaign(&WORLD.clean, &WORLD.conditioning, &sources).noise;
        let samples = WORLD.clean.trials[trial].0.voltage_v.len();
        let derivatives: Vec<SVector<f64, PARAMETERS>> = (0..samples)
            .into_par_iter()
            .map(|k| {
                let moved =
                    |by: f64| calibrate(&changed(&WORLD.clean, trial, |t| change(t, k, by)));
                (moved(PROBE) - moved(-PROBE)) / (2.0 * PROBE)
            })
            .collect();
        let theirs = derivatives
            .iter()
            .fold(Covariance::zeros(), |sum, h| sum + h * h.transpose());
        let touched: Vec<usize> = (0..PARAMETERS).filter(|i| ours[(*i, *i)] > 0.0).collect();
        assert!(!touched.is_empty(), "{what} reaches nothing");
        for i in &touched {
            let (of, limit) = match *i == COMPLIANCE && role == Role::Linear {
                true => ("compliance", tolerance::COMPLIANCE_DERIVATIVE),
                false => ("a parameter", limit),
            };
            let error = ((ours[(*i, *i)] / theirs[(*i, *i)]).sqrt() - 1.0).abs();
            Row::new(format!("deviation of {of} by {what}"), error, limit)
                .case(i)
                .judge();
        }
        // What the closed form says is not reached is reached by far less than by anything that is.
        let size = |i: usize| theirs[(i, i)].sqrt() / calibrate(&WORLD.clean)[i].abs();
        let reached = touched.iter().map(|i| size(*i)).fold(0.0, f64::max);
        for i in (0..PARAMETERS).filter(|i| !touched.contains(i)) {
            let what = format!("a parameter that {what} does not reach");
            Row::new(what, size(i) / reached, tolerance::NOT_REACHED)
                .case(i)
                .judge();
        }
    }
}

/// Change of a raw number, in its unit: large against rounding, small against the signal.
const PROBE: f64 = 1e-2;

#[test]
fn law_gains_act_as_their_derivatives() {
    for gyroscope in [GyroscopeGain::Trusted, GyroscopeGain::Identified] {
        let found = |campaign: &Campaign| {
            let steps = campaign
                .identify(gyroscope)
                .expect("the steps are possible");
            SVector::<f64, 15>::from_iterator(
                steps
                    .scale
                    .estimate
                    .values
                    .into_iter()
                    .chain(steps.inertia.estimate.values),
            )
        };
        let steps = WORLD
            .clean
            .identify(gyroscope)
            .expect("the steps are possible");
        let ours = propagate(&WORLD.clean, &WORLD.conditioning, &steps, &quiet())
            .expect("the campaign is clean")
            .per_gain;
        for (standard, ours) in ours.iter().enumerate() {
            let scaled = |by: f64| {
                let mut campaign = WORLD.clean.clone();
                for (trial, conditioned) in &mut campaign.trials {
                    let series = [&mut trial.accelerometer_m_s2, &mut trial.gyroscope_rad_s];
                    series[standard].iter_mut().for_each(|x| *x *= 1.0 + by);
                    *conditioned = WORLD
                        .conditioning
                        .condition(trial)
                        .expect("a scaled trial cleans");
                }
                found(&campaign)
            };
            let theirs = (scaled(GAIN_PROBE) - scaled(-GAIN_PROBE)) / (2.0 * GAIN_PROBE);
            let nine_and_six = ours.fixed_rows::<15>(SCALE.start).into_owned();
            let size = found(&WORLD.clean);
            for (part, rows) in [("scale", 0..9), ("inertia", 9..15)] {
                let biggest = largest(rows.clone().map(|i| size[i]));
                // Where the rates enter: of the inertias, unless the gyroscope's gain is taken for known.
                let by_rates = standard == 1 || gyroscope == GyroscopeGain::Identified;
                let limit = match part == "inertia" && by_rates {
                    true => tolerance::BY_GYROSCOPE_GAIN,
                    false => tolerance::BY_ACCELEROMETER_GAIN,
                };
                within(
                    format!("{part} by standard {standard}'s gain, gyroscope {gyroscope:?}"),
                    largest(rows.map(|i| (nine_and_six[i] - theirs[i]) / biggest)),
                    limit,
                );
            }
        }
    }
}

/// Relative change of a standard's gain: gains enter once and as a ratio.
const GAIN_PROBE: f64 = 1e-4;

#[test]
fn inv_doubled_errors_double_deviations() {
    let once = of_campaign(&WORLD.clean, &WORLD.conditioning, &WORLD.sources);
    let twice = of_campaign(&WORLD.clean, &WORLD.conditioning, &WORLD.times(2.0).sources);
    for (once, twice) in [
        (once.noise, twice.noise),
        (once.standards, twice.standards),
        (once.wedges, twice.wedges),
    ] {
        for i in (0..PARAMETERS).filter(|i| once[(*i, *i)] > 0.0) {
            within(
                "deviation of doubled errors",
                (twice[(i, i)] / once[(i, i)] / 4.0 - 1.0).abs(),
                tolerance::ROUNDING,
            );
        }
    }
}

#[test]
fn stat_accelerations_scatter_as_the_stream_states() {
    // Where errors are small: the decoupler is open loop, and first order ends where the attitude is lost.
    let draws = draws();
    let world = WORLD.times(SMALL);
    let closed = ClosedForm::of(&world, &world.sources, SEED);
    let drawn = Tally::draw(&world, &world.sources, SEED + 1, draws).accelerations();
    let mut worst = 0.0_f64;
    for (ours, theirs) in closed
        .accelerations
        .iter()
        .flatten()
        .zip(drawn.iter().flatten())
    {
        for (ours, theirs) in ours.iter().zip(theirs) {
            let here = departure(*theirs, *ours, draws);
            worst = if here.is_nan() {
                f64::NAN
            } else {
                worst.max(here)
            };
            assert!(
                departure(2.0 * theirs, *ours, draws) > tolerance::CHI_SQUARE.limit,
                "twice the deviation of an acceleration passes"
            );
        }
    }
    within(
        "chi-square of an acceleration",
        worst,
        tolerance::CHI_SQUARE,
    );
}

#[test]
fn inv_draws_do_not_depend_on_threads() {
    let on = |threads: usize| {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("a pool of threads")
            .install(|| Tally::draw(&WORLD, &WORLD.sources, SEED, 3))
    };
    assert_eq!(on(1), on(3));
}

#[test]
fn ref_compliance_fit_finds_what_the_grid_finds() {
    let truth = WORLD.truth();
    let mut fit = ComplianceFit::default();
    let mut pulled = ComplianceFit::default();
    let mut wrong = *truth;
    wrong.zero_drift_v[3] += DRIFT_PROBE_V;
    for (trial, _) in WORLD
        .clean
        .trials
        .iter()
        .filter(|(t, _)| t.role == Role::HighFrequencyLinear)
    {
        let (sensor, settings) = (trial.sensor(Geometry::PAPER), trial.settings(Scheme::Heun));
        for (fit, parameters) in [(&mut fit, truth), (&mut pulled, &wrong)] {
            fit.push_trial(&sensor, parameters, &settings, &trial.voltage_v, |_| ())
                .expect("a run of the rig decouples");
        }
    }
    let error = |fit: &ComplianceFit| {
        let found = fit.solve().expect("fast motion tells the compliance");
        found * truth.stiffness_per_mass_per_s2 - 1.0
    };
    within(
        "compliance without a grid",
        error(&fit),
        tolerance::COMPLIANCE_FIT,
    );
    fails_clearly(
        "compliance with a drift in error",
        error(&pulled).abs(),
        tolerance::COMPLIANCE_FIT,
    );
    let curve = WORLD
        .clean
        .search(
            truth,
            Scheme::Heun,
            1,
            sixaxis_core::LimbLaw::CompressionShortens,
        )
        .expect("a run of the rig decouples");
    let grid = sixaxis_core::identify::stiffness::judge(&curve).expect("a whole curve");
    assert_eq!(
        grid.grid_minimum_per_s2.to_bits(),
        truth.stiffness_per_mass_per_s2.to_bits()
    );
}

/// Drift in error: a hundred-thousandth of full scale.
const DRIFT_PROBE_V: f64 = 1e-4;

#[test]
fn law_impossible_covariances_are_refused() {
    let trial = &WORLD.compound[0];
    let (sensor, settings) = (trial.sensor(Geometry::PAPER), trial.settings(Scheme::Heun));
    let start = |covariance: &Covariance, noise: &ChannelNoise| {
        SampleUncertainty::new(
            &sensor,
            WORLD.truth(),
            &settings,
            LimbSet::EMPTY,
            covariance,
            noise,
        )
    };
    let quiet = ChannelNoise::white([0.0; LIMBS]);
    assert!(start(&Covariance::zeros(), &quiet).is_ok());
    let mut impossible = Covariance::identity();
    impossible[(0, 1)] = 1.5;
    impossible[(1, 0)] = 1.5;
    let mut negative = Covariance::identity();
    negative[(3, 3)] = -1.0;
    let unknown = Covariance::from_element(f64::NAN);
    for covariance in [impossible, negative, unknown] {
        assert!(matches!(
            start(&covariance, &quiet),
            Err(Error::OutOfRange { .. })
        ));
    }
    for value in [-1.0, f64::NAN, f64::INFINITY] {
        let mut noise = quiet;
        noise.white_v[8] = value;
        assert!(matches!(
            start(&Covariance::zeros(), &noise),
            Err(Error::OutOfRange { .. })
        ));
    }
    // A stream without errors is sure of everything.
    let mut stream = start(&Covariance::zeros(), &quiet).expect("no errors are possible errors");
    for sample in World::decouple(trial, WORLD.truth()) {
        let spread = stream
            .push(&trial.voltage_v[sample.sample as usize], &sample)
            .expect("a run of the rig");
        assert_eq!(spread.linear_ground_m_s2, DVec3::ZERO);
        assert_eq!(spread.angular_ground_rad_s2, DVec3::ZERO);
    }
    // The compliance has no part in a sample.
    let mut compliance_alone = Covariance::zeros();
    compliance_alone[(COMPLIANCE, COMPLIANCE)] = 1.0;
    assert_eq!(
        start(&compliance_alone, &quiet),
        start(&Covariance::zeros(), &quiet)
    );
}
