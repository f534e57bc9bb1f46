//! Statistics of cases whose errors are known, against the same numbers by the book.

mod common;

use std::path::PathBuf;

use common::{made_up, provenance};
use sixaxis_campaign::error::Error;
use sixaxis_campaign::part;
use sixaxis_campaign::row::{Group, Row};
use sixaxis_campaign::statistics::{Summary, summarise};
use tempfile::TempDir;

/// Enough for the coverage of an honest interval to be known to half a per cent.
const CASES: u64 = 2000;
/// Standard errors by which a share of known size may be off: once in 16,000, and the seeds are fixed.
const SIGMAS: f64 = 4.0;
/// Standard errors stated half as large as they are cover 67 % instead of 95.
const DISHONEST: f64 = 2.0;
/// Welford's recursion against two passes: rounding of 2000 sums.
const ROUNDING: f64 = 2000.0 * f64::EPSILON;

/// Writes cases into parts of the given length.
fn write(
    folder: &TempDir,
    name: &str,
    seeds: core::ops::Range<u64>,
    cut: u64,
    honesty: f64,
) -> PathBuf {
    let path = folder.path().join(name);
    let asked = provenance(1..CASES + 1);
    let mut from = seeds.start;
    while from < seeds.end {
        let to = (from + cut).min(seeds.end);
        let rows: Vec<Row> = (from..to).map(|seed| made_up(seed, honesty)).collect();
        part::write(&path, &asked, &rows).expect("it is written");
        from = to;
    }
    path
}

fn all(folders: &[PathBuf]) -> Summary {
    summarise(folders).expect("they can be summed up")
}

#[test]
fn prop_honest_intervals_cover_and_dishonest_do_not() {
    let folder = tempfile::tempdir().expect("a folder");
    let honest = all(&[write(&folder, "honest", 1..CASES + 1, 64, 1.0)]);
    let dishonest = all(&[write(&folder, "dishonest", 1..CASES + 1, 64, DISHONEST)]);
    let nominal = 0.95;
    for (good, bad) in honest.parameters.iter().zip(&dishonest.parameters) {
        let n = good.four_steps.cases as f64;
        assert_eq!(good.four_steps.cases + good.four_steps.failures, CASES);
        let standard_error = (nominal * (1.0 - nominal) / n).sqrt();
        let off = |share: Option<sixaxis_campaign::statistics::Share>| {
            let share = share.expect("there are standard errors");
            (share.value - nominal).abs() / standard_error
        };
        assert!(off(good.four_steps.within_noise_95) < SIGMAS, "{good:?}");
        assert!(off(bad.four_steps.within_noise_95) > SIGMAS, "{bad:?}");
        let joint = good.joint.as_ref().expect("there is a joint fit");
        assert!(off(joint.within_noise_95) < SIGMAS, "{joint:?}");
        assert!(off(joint.within_stated_95) < SIGMAS, "{joint:?}");
        let ratio = |e: &sixaxis_campaign::statistics::Estimator| {
            e.attained_over_stated.expect("there are standard errors")
        };
        // Of a mixture of deviations the ratio scatters more than the 1/root(2n) of one: twice is ample.
        let scatter = SIGMAS * 2.0 / (2.0 * n).sqrt();
        assert!((ratio(&good.four_steps) - 1.0).abs() < scatter, "{good:?}");
        assert!(
            (ratio(&bad.four_steps) - DISHONEST).abs() < DISHONEST * scatter,
            "{bad:?}"
        );
        let squares = |e: &sixaxis_campaign::statistics::Estimator| {
            e.variance_over_stated.expect("there are standard errors")
        };
        let scatter_of_squares = SIGMAS * (2.0 / n).sqrt();
        for (e, expected) in [(good, 1.0), (bad, DISHONEST * DISHONEST)] {
            let off = squares(&e.four_steps) / expected - 1.0;
            assert!(off.abs() < scatter_of_squares, "{e:?}");
        }
        let bound = good.joint_gain_known.as_ref().expect("there is a bound");
        assert!((ratio(bound) - 1.0).abs() < scatter, "{bound:?}");
        let bias = good.four_steps.bias_in_sd.expect("there are errors");
        assert!(bias.abs() < SIGMAS / n.sqrt(), "{good:?}");
    }
}

#[test]
fn ref_moments_are_those_of_two_passes() {
    let folder = tempfile::tempdir().expect("a folder");
    let summary = all(&[write(&folder, "parts", 1..CASES + 1, 64, 1.0)]);
    let rows: Vec<Row> = (1..=CASES).map(|seed| made_up(seed, 1.0)).collect();
    for (i, parameter) in summary.parameters.iter().enumerate() {
        let errors: Vec<f64> = rows
            .iter()
            .filter_map(|row| Some(row.group(Group::FourSteps)[i]? - row.group(Group::Truth)[i]?))
            .collect();
        let n = errors.len() as f64;
        let mean = errors.iter().sum::<f64>() / n;
        let squares: f64 = errors.iter().map(|e| (e - mean) * (e - mean)).sum();
        let sd = (squares / (n - 1.0)).sqrt();
        let e = &parameter.four_steps;
        assert_eq!(e.cases, errors.len() as u64);
        let close = |a: Option<f64>, b: f64| (a.expect("it is there") - b).abs() <= ROUNDING * sd;
        assert!(close(e.bias, mean), "{parameter:?}");
        assert!(close(e.attained_sd, sd), "{parameter:?}");
    }
}

#[test]
fn inv_shards_in_any_order_and_split_give_the_same_bits() {
    let folder = tempfile::tempdir().expect("a folder");
    let whole = all(&[write(&folder, "whole", 1..CASES + 1, 64, 1.0)]);
    let a = write(&folder, "a", 1..701, 64, 1.0);
    let b = write(&folder, "b", 701..1305, 37, 1.0);
    let c = write(&folder, "c", 1305..CASES + 1, 500, 1.0);
    for order in [[&a, &b, &c], [&c, &a, &b], [&b, &c, &a]] {
        let merged = all(&order.map(Clone::clone));
        // Rust prints as many digits as tell two f64 apart.
        assert_eq!(format!("{merged:?}"), format!("{whole:?}"));
    }
    // Sums in another order do differ in their last bits: that the above is no matter of course.
    let errors = |backwards: bool| {
        let mut seeds: Vec<u64> = (1..=CASES).collect();
        if backwards {
            seeds.reverse();
        }
        seeds
            .into_iter()
            .filter_map(|seed| {
                let row = made_up(seed, 1.0);
                Some(row.group(Group::FourSteps)[0]? - row.group(Group::Truth)[0]?)
            })
            .sum::<f64>()
    };
    assert_ne!(errors(true).to_bits(), errors(false).to_bits());
}

#[test]
fn prop_missing_cases_are_listed() {
    let folder = tempfile::tempdir().expect("a folder");
    let a = write(&folder, "a", 3..101, 64, 1.0);
    let b = write(&folder, "b", 201..CASES, 500, 1.0);
    let summary = all(&[b, a]);
    assert_eq!(summary.missing_seeds, [(1, 2), (101, 200), (CASES, CASES)]);
    assert_eq!(summary.missing + summary.cases, CASES);
}

#[test]
fn prop_a_case_in_two_parts_is_an_error_that_names_both() {
    let folder = tempfile::tempdir().expect("a folder");
    let a = write(&folder, "a", 1..101, 64, 1.0);
    let b = write(&folder, "b", 100..201, 64, 1.0);
    match summarise(&[a, b]) {
        Err(Error::Duplicate {
            seed,
            first,
            second,
        }) => {
            assert_eq!(seed, 100);
            let names = [first, second].map(|p| p.display().to_string());
            assert_ne!(names[0], names[1]);
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn prop_parts_of_two_plans_or_versions_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = write(&folder, "parts", 1..65, 64, 1.0);
    let rows: Vec<Row> = (65..71).map(|seed| made_up(seed, 1.0)).collect();
    let ours = provenance(1..CASES + 1);
    for (key, other) in [
        (
            "trials_per_step",
            sixaxis_campaign::part::Provenance {
                plan: ours
                    .plan
                    .replace("trials_per_step = 3", "trials_per_step = 4"),
                ..ours.clone()
            },
        ),
        (
            "version",
            sixaxis_campaign::part::Provenance {
                version: "0.0.1".to_owned(),
                ..ours.clone()
            },
        ),
    ] {
        part::write(&path, &other, &rows).expect("it is written");
        match summarise(std::slice::from_ref(&path)) {
            Err(Error::OtherCampaign { differences, .. }) => {
                assert_eq!(differences.len(), 1, "{differences:?}");
                assert!(differences[0].starts_with(key), "{differences:?}");
            }
            result => panic!("{key}: {result:?}"),
        }
    }
}
