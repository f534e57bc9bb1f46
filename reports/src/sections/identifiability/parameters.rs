//! Each of the 25: what both estimators say of it, what bounds them, and how often the intervals hold the truth.

use serde::Serialize;
use sixaxis_calibration::page::labels::{by_kind, with_interval};
use sixaxis_campaign::statistics::{ParameterSummary, Share};
use sixaxis_core::Parameter;
use sixaxis_core::dsp::outlier;
use sixaxis_page::number::{fixed, percent, significant};
use sixaxis_page::{Cell, State, Table, Text};
use sixaxis_props::results::Campaign;
use sixaxis_reference::laboratory::instruments::{GAIN_SHARE, INSTRUMENT_CLASS};

use super::coverage::BAND;
use crate::study::results::identifiability::{Interval, Known, KnownParameter};

/// What a family of parameters is known to, by the middle one: 95 % half width, and one standard deviation of what the
/// trials leave.
#[derive(Serialize)]
struct KnownTo {
    joint: f64,
    four_steps: f64,
    joint_of_trials: f64,
    four_steps_of_trials: f64,
}

impl KnownTo {
    /// Over `scale` of each parameter among the wanted.
    fn of(known: &Known, among: fn(Parameter) -> bool, scale: fn(&KnownParameter) -> f64) -> Self {
        let median = |of: fn(&KnownParameter) -> f64| {
            let all = known.parameters.iter();
            let family = all.filter(|p| among(p.parameter));
            let mut values: Vec<f64> = family.map(|p| of(p) / scale(p)).collect();
            outlier::median(&mut values)
        };
        Self {
            joint: median(|p| half_width(&p.joint)),
            four_steps: median(|p| half_width(&p.four_steps)),
            joint_of_trials: median(|p| p.joint.of_trials),
            four_steps_of_trials: median(|p| p.four_steps.of_trials),
        }
    }
}

/// m/k, 10⁻⁹ s²: ends of the intervals, and the truth.
#[derive(Serialize)]
struct Compliance {
    joint: (f64, f64),
    four_steps: (f64, f64),
    truth: f64,
}

/// Values and table.
pub fn fill(text: Text, known: &Known, campaign: &Campaign) -> Text {
    let ends = |i: &Interval| (i.ends_95.0 * 1e9, i.ends_95.1 * 1e9);
    let compliance = known.parameters.last().map(|p| Compliance {
        joint: ends(&p.joint),
        four_steps: ends(&p.four_steps),
        truth: p.truth * 1e9,
    });
    let truth: fn(&KnownParameter) -> f64 = |p| p.truth.abs();
    let products = KnownTo::of(known, |p| matches!(p, Parameter::Inertia(3..)), |_| 1e-6);
    text.value("known", known)
        .value("gain_limit", GAIN_SHARE * INSTRUMENT_CLASS)
        .value(
            "drift_mv",
            KnownTo::of(known, |p| matches!(p, Parameter::Drift(_)), |_| 1e-3),
        )
        .value(
            "scale",
            KnownTo::of(known, |p| matches!(p, Parameter::Scale(_)), truth),
        )
        .value(
            "moments",
            KnownTo::of(known, |p| matches!(p, Parameter::Inertia(0..3)), truth),
        )
        .value("products_mm2", products)
        .value("compliance", compliance)
        .table("parameters", table(known, campaign))
}

fn table(known: &Known, campaign: &Campaign) -> Table {
    let digits = |p: &KnownParameter, si: f64| format!("{si} {}", p.unit);
    let interval = |interval: &Interval, per_si: f64| {
        let half = half_width(interval);
        with_interval(interval.estimate * per_si, half * per_si)
    };
    let estimate = |p: &KnownParameter, i: &Interval, per_si: f64| {
        Cell::from(interval(i, per_si).0).title(digits(p, i.estimate))
    };
    let width = |p: &KnownParameter, i: &Interval, per_si: f64| {
        Cell::from(interval(i, per_si).1).title(digits(p, half_width(i)))
    };
    let covered = |p: &KnownParameter, share: fn(&ParameterSummary) -> Option<Share>| {
        let mut all = campaign.parameters.iter();
        let found = all.find(|q| q.parameter == p.parameter).and_then(share);
        Cell::or_dash(found.map(coverage))
    };
    by_kind(&known.parameters, |p| p.parameter)
        .col("truth", |(p, per_si)| {
            let decimals = match p.parameter {
                Parameter::Drift(_) | Parameter::Compliance => 1,
                _ => 4,
            };
            Cell::from(fixed(p.truth * per_si, decimals)).title(digits(p, p.truth))
        })
        .under("four steps")
        .col("estimate", |(p, per_si)| {
            estimate(p, &p.four_steps, *per_si)
        })
        .col("±\u{a0}95\u{a0}%", |(p, per_si)| {
            width(p, &p.four_steps, *per_si)
        })
        .under("joint fit")
        .col("estimate", |(p, per_si)| estimate(p, &p.joint, *per_si))
        .col("±\u{a0}95\u{a0}%", |(p, per_si)| {
            width(p, &p.joint, *per_si)
        })
        .under("gain known")
        .col(("bound", "1σ"), |(p, per_si)| {
            Cell::from(significant(p.bound * per_si, 2)).title(digits(p, p.bound))
        })
        .col(("error", "σ"), |(p, _)| {
            Cell::of(p.joint_error_over_bound, |e| fixed(e, 1))
        })
        .under("coverage")
        .col(("steps", "%"), |(p, _)| {
            covered(p, |q| q.four_steps.within_stated_95)
        })
        .col(("joint", "%"), |(p, _)| {
            covered(p, |q| q.joint.as_ref()?.within_stated_95)
        })
        .under("")
        .text("limit", |(p, _)| limit(known, p))
        .into()
}

fn coverage(share: Share) -> Cell {
    let (low, high) = share.wilson_95;
    let outside = high < BAND.0 || low > BAND.1;
    Cell::from(fixed(100.0 * share.value, 1))
        .title(format!(
            "{} to {} by Wilson's 95 % interval",
            percent(low, 2),
            percent(high, 2)
        ))
        .state(if outside { State::Warn } else { State::Neutral })
}

/// What dominates the joint fit's interval.
fn limit(known: &Known, p: &KnownParameter) -> &'static str {
    if p.parameter == Parameter::Compliance && !known.compliance_is_determined {
        "not seen"
    } else if p.joint.of_certificate > p.joint.of_trials {
        "certificate"
    } else {
        "noise"
    }
}

fn half_width(interval: &Interval) -> f64 {
    0.5 * (interval.ends_95.1 - interval.ends_95.0)
}
