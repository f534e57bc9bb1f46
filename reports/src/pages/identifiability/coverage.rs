//! Whether the stated intervals hold what they say, and how near the joint fit comes to the bound.

use super::published::{Campaign, CampaignParameter, Estimator, MAKE_CAMPAIGN};
use sixaxis_calibration::page::labels::symbol;
use sixaxis_page::number::{count, percent};
use sixaxis_page::{Axis, Block, Figure, Mark, Series};

/// What 95 % intervals are wanted to hold.
pub const BAND: (f64, f64) = (0.94, 0.96);
/// Standard deviations of a ratio of variances that are drawn as its scatter.
const SCATTER: f64 = 2.0;

/// What step 4 says where it has a minimum.
const DETERMINED: &str = "determined";

/// Cases of which the joint fit has k/m.
fn stiffness_fitted(campaign: &Campaign) -> u64 {
    campaign
        .parameters
        .last()
        .and_then(|p| p.joint.as_ref())
        .map_or(0, |joint| joint.cases)
}

/// Text and figures.
pub fn blocks(campaign: &Campaign) -> Vec<Block> {
    let known: Vec<&CampaignParameter> = campaign
        .parameters
        .iter()
        .filter(|p| p.joint.is_some())
        .collect();
    vec![
        Block::Heading("Do the intervals keep their word?".to_owned()),
        Block::Text(format!(
            "{} calibrations of random sensors with random standards, wedges and noise, seeds {} to {}: {MAKE_CAMPAIGN}. The four \
             steps' intervals are those that `sixaxis calibrate` states: class of the standards, and differences between trials, \
             of which there are few. k/m is determined by step 4 in {} of the cases, by the joint fit in {}.",
            count(campaign.cases),
            count(campaign.first_seed),
            count(campaign.last_seed),
            count(campaign.step_4.get(DETERMINED).copied().unwrap_or(0)),
            count(stiffness_fitted(campaign)),
        )),
        Block::FigureGrid(vec![coverage(&known), variance(&known)]),
    ]
}

/// Place on an axis of names.
pub fn place(index: usize) -> f64 {
    index as f64
}

fn names(known: &[&CampaignParameter]) -> Axis {
    Axis::names("parameter", known.iter().map(|p| symbol(p.parameter)))
}

fn coverage(known: &[&CampaignParameter]) -> Figure {
    let points = |of: fn(&CampaignParameter) -> Option<&Estimator>| {
        known
            .iter()
            .enumerate()
            .filter_map(|(i, p)| Some((100.0 * of(p)?.within_stated_95?.value, place(i))))
            .collect::<Vec<_>>()
    };
    Figure::new(
        "coverage-by-parameter",
        "Truths within the stated 95 % intervals",
        Axis::linear("share of cases", "%"),
        names(known),
    )
    .series(Series::points("joint fit", 0, points(|p| p.joint.as_ref())))
    .series(Series::points(
        "four steps",
        3,
        points(|p| Some(&p.four_steps)),
    ))
    .mark(Mark::vertical(100.0 * BAND.0, "94"))
    .mark(Mark::vertical(100.0 * BAND.1, "96"))
    .caption(format!(
        "Wanted: between the lines. With so many cases a share scatters by up to {} of all.",
        percent(largest_error(known), 2)
    ))
}

fn largest_error(known: &[&CampaignParameter]) -> f64 {
    known
        .iter()
        .filter_map(|p| Some(p.joint.as_ref()?.within_stated_95?.standard_error))
        .fold(0.0, f64::max)
}

fn variance(known: &[&CampaignParameter]) -> Figure {
    let ratios = known
        .iter()
        .enumerate()
        .filter_map(|(i, p)| Some((p.joint_gain_known.as_ref()?.variance_over_stated?, place(i))));
    let cases = known
        .iter()
        .filter_map(|p| Some(p.joint_gain_known.as_ref()?.cases))
        .min()
        .unwrap_or(0);
    // Variance of a mean of n squares of a normal variable.
    let scatter = SCATTER * (2.0 / cases.max(1) as f64).sqrt();
    Figure::new(
        "variance-over-bound",
        "Variance of the joint fit over the Cramér-Rao bound",
        Axis::linear("variance over bound", ""),
        names(known),
    )
    .series(Series::points(
        "joint fit, told the accelerometer's gain",
        0,
        ratios,
    ))
    .mark(Mark::vertical(1.0 - scatter, "−2σ"))
    .mark(Mark::vertical(1.0, ""))
    .mark(Mark::vertical(1.0 + scatter, "+2σ"))
    .caption(format!(
        "Mean of squared errors, each over its own bound. Of normal errors at the bound it scatters about 1 by {} with {} cases; \
         the outer lines are twice that. The bound counts gains and wedges as normal, which they are not.",
        percent(scatter / SCATTER, 2),
        count(cases),
    ))
}
