//! Scale factors checked in the field without a standard: how well, what a motion leaves unobservable, which limb has
//! drifted, whether limbs are equally stiff.

use anyhow::{Context, Result};
use sixaxis_page::number::{count, fixed, scientific, significant};
use sixaxis_page::{Axis, Figure, Section, Table, Text};

use sixaxis_props::blind::share::Share;
use sixaxis_props::results::{Published, SelfCalibration, TumbleLength};
use sixaxis_reference::rig::field::Pace;

/// What 95 % intervals are wanted to hold, %.
const BAND: (f64, f64) = (94.0, 96.0);

/// The section.
///
/// # Errors
/// If the published result cannot be read or the text does not fit it.
pub fn section() -> Result<Section> {
    let p = &SelfCalibration::embedded()?;
    let longest = p.lengths.iter().max_by_key(|l| l.draws);
    let longest = longest.context("no recording was evaluated")?;
    let scatter = 100.0 * (0.95 * 0.05 / longest.draws.max(1) as f64).sqrt();
    let rates = p.rates.map(|rate| significant(100.0 * rate, 1));
    let named = (p.drift.named_alone * p.drift.draws as f64).round();
    Text::new(include_str!("self_calibration.md"))
        .value("p", p)
        .value("longest", longest)
        .value("named", Share::new(named as usize, p.drift.draws))
        .value("rates_percent", &rates)
        .value("share_scatter_percent", scatter)
        .figure(errors(p))
        .figure(coverage(longest))
        .table("lengths", lengths(p))
        .table("motions", motions(p))
        .table("stiffness", stiffness(p, &rates))
        .section("self-calibration")
}

fn errors(p: &SelfCalibration) -> Figure {
    let series = |pace: Pace, of: fn(&TumbleLength) -> f64| {
        let lengths = p.lengths.iter().filter(move |l| l.pace == pace);
        lengths.map(move |l| (l.duration_s, 100.0 * of(l)))
    };
    let shaken = series(Pace::Shaken, |l| l.rms_error);
    let figure = Figure::new(
        "self-calibration-errors",
        "",
        Axis::log("length of the recording", "s"),
        Axis::log("error", "%"),
    )
    .line_points(
        "largest, brisk",
        3,
        series(Pace::Brisk, |l| l.largest_error),
    )
    .line_points("rms, brisk", 0, series(Pace::Brisk, |l| l.rms_error))
    .dashed(
        "median of the stated deviation, brisk",
        1,
        series(Pace::Brisk, |l| l.median_deviation),
    )
    .points("rms, calm", 2, series(Pace::Calm, |l| l.rms_error))
    .horizontal(100.0 * p.bar, "limit");
    match shaken.clone().next() {
        Some(_) => figure.points("rms, shaken", 4, shaken),
        None => figure,
    }
}

fn coverage(longest: &TumbleLength) -> Figure {
    let shares = longest.coverage_95_by_limb.iter().enumerate();
    let points = shares.map(|(limb, share)| (100.0 * share, limb as f64));
    Figure::new(
        "self-calibration-coverage",
        "",
        Axis::linear("share of records", "%"),
        Axis::names("limb", (1..=9).map(|limb| limb.to_string())),
    )
    .points("ratio", 0, points)
    .vertical(BAND.0, "94")
    .vertical(BAND.1, "96")
}

fn lengths(p: &SelfCalibration) -> Table {
    Table::of("tumble", &p.lengths, |l| {
        let pace = match l.pace {
            Pace::Calm => "calm",
            Pace::Brisk => "brisk",
            Pace::Shaken => "shaken",
        };
        format!("{pace}, {} s", l.duration_s)
    })
    .col("records", |l| count(l.draws))
    .col(("refused", "too poor"), |l| count(l.refused))
    .col("rms error", |l| scientific(l.rms_error, 2))
    .col(("largest", "error"), |l| scientific(l.largest_error, 2))
    .col(("limbs within limit", "%"), |l| {
        fixed(100.0 * l.share_within_bar, 1)
    })
    .col(("records within limit", "%"), |l| {
        fixed(100.0 * l.draws_within_bar, 1)
    })
    .col(("coverage of 95 %", "%"), |l| {
        fixed(100.0 * l.coverage_95, 1)
    })
    .into()
}

fn motions(p: &SelfCalibration) -> Table {
    Table::of("motion", &p.motions, |m| m.motion.clone())
        .col(("ratios told", "of 8"), |m| count(8 - m.directions))
        .text("unobservable", |m| {
            m.open.clone().unwrap_or_else(|| "nothing".to_owned())
        })
        .into()
}

fn stiffness(p: &SelfCalibration, rates_percent: &[String; 2]) -> Table {
    let [strict, loose] = rates_percent
        .each_ref()
        .map(|rate| format!("% at {rate} %"));
    Table::of("spread of k", &p.stiffness, |s| {
        format!("{} %", significant(100.0 * s.spread, 1))
    })
    .col(("records", "of 6 s"), |s| count(s.draws))
    .col(("refused", strict), |s| fixed(100.0 * s.refused_at[0], 1))
    .col(("refused", loose), |s| fixed(100.0 * s.refused_at[1], 1))
    .col(("rms error", "of ln kᵢ/kⱼ"), |s| {
        scientific(s.rms_error_of_pair, 2)
    })
    .col(("largest", "of ln kᵢ/kⱼ"), |s| {
        scientific(s.largest_error_of_pair, 2)
    })
    .col(("pairs within limit", "%"), |s| {
        fixed(100.0 * s.share_of_pairs_within_bar, 2)
    })
    .into()
}
