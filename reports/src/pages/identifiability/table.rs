//! Each of the 25: what both estimators say of it, what bounds them, and what would help.

use sixaxis_reference::laboratory::instruments::{GAIN_SHARE, INSTRUMENT_CLASS};

use super::coverage::BAND;
use super::published::{Campaign, CampaignParameter, Share};
use super::tap::one;
use crate::study::results::identifiability::{Interval, Known, KnownParameter};
use sixaxis_calibration::page::labels::{symbol, with_interval};
use sixaxis_core::Parameter;
use sixaxis_page::number::{MISSING, count, fixed, percent, ppm, significant};
use sixaxis_page::{Block, Cell, Column, HeadCell, Row, State, Table};

/// Standard errors that a coverage may be outside its band by chance.
const CHANCE: f64 = 2.0;

/// Parameters that share a unit and a cause.
struct Family {
    letter: char,
    heading: &'static str,
    per_si: f64,
    /// Decimals of the truth.
    decimals: usize,
}

const FAMILIES: [Family; 4] = [
    Family {
        letter: 'd',
        heading: "Zero drift, mV",
        per_si: 1e3,
        decimals: 1,
    },
    Family {
        letter: 's',
        heading: "Scale factor over mass, kg⁻¹",
        per_si: 1.0,
        decimals: 4,
    },
    Family {
        letter: 'I',
        heading: "Inertia over mass, mm²",
        per_si: 1e6,
        decimals: 4,
    },
    Family {
        letter: 'm',
        heading: "Mass over stiffness, 10⁻⁹ s²",
        per_si: 1e9,
        decimals: 1,
    },
];

impl Family {
    fn of<'a>(&self, known: &'a Known) -> impl Iterator<Item = &'a KnownParameter> {
        let letter = self.letter;
        known
            .parameters
            .iter()
            .filter(move |p| p.parameter.symbol() == letter)
    }
}

/// Table, then a sentence for each family.
pub fn blocks(known: &Known, campaign: Option<&Campaign>) -> Vec<Block> {
    vec![
        Block::Table(table(known, campaign)),
        Block::Text(sentences(known)),
    ]
}

fn table(known: &Known, campaign: Option<&Campaign>) -> Table {
    let mut rows = Vec::new();
    for family in &FAMILIES {
        rows.push(Row::group(family.heading));
        rows.extend(family.of(known).map(|p| row(known, family, p, campaign)));
    }
    Table {
        caption: "The 25 parameters from this study's campaign with laboratory errors".to_owned(),
        stub: "parameter".to_owned(),
        head: vec![vec![
            HeadCell::new("", 1),
            HeadCell::new("four steps", 2),
            HeadCell::new("joint fit", 2),
            HeadCell::new("gain known", 2),
            HeadCell::new("coverage", 2),
            HeadCell::new("", 1),
        ]],
        columns: vec![
            Column::number("truth", ""),
            Column::number("estimate", ""),
            Column::number("±\u{a0}95\u{a0}%", ""),
            Column::number("estimate", ""),
            Column::number("±\u{a0}95\u{a0}%", ""),
            Column::number("bound", "1σ"),
            Column::number("error", "σ"),
            Column::number("steps", "%"),
            Column::number("joint", "%"),
            Column::text("limit"),
        ],
        rows,
        footnote: format!(
            "The laboratory takes its wedges to be right to 0.1° (1σ) and its standards' gains to {} at most. Of the gyroscope's gain \
             the four steps ask the trials and the certificate, in Tables 1 to 3 the trials alone. The bound is Cramér and Rao's, from \
             noise and everything else that the laboratory knows beforehand; the error beside it is that of the fit once told \
             the accelerometer's true gain, so that a right model leaves about ±1. Over all residuals the fit has {} a degree of \
             freedom, 1 for a right model. Coverage is {}; a share outside 94 to 96 % by more than chance is marked. Of the four steps it is that of the \
             intervals which `sixaxis calibrate` states, with differences between trials for what wedges do here. Limit is what dominates the joint fit's \
             interval: noise, the accelerometer's certificate, or that no trial sees the parameter. Point at a \
             number for all its digits.",
            percent(GAIN_SHARE * INSTRUMENT_CLASS, 1),
            fixed(known.joint_misfit, 3),
            campaign.map_or_else(
                || "not to be had".to_owned(),
                |c| format!("that of {} random sensors, below", count(c.cases))
            ),
        ),
    }
}

fn row(known: &Known, family: &Family, p: &KnownParameter, campaign: Option<&Campaign>) -> Row {
    let published = campaign.and_then(|c| c.parameters.iter().find(|q| q.parameter == p.parameter));
    let all = |si: f64| format!("{} {}", si, p.unit);
    let estimate = |interval: &Interval| {
        let half = half_width(interval);
        let (text, width) = with_interval(interval.estimate * family.per_si, half * family.per_si);
        [
            Cell::from(text).title(all(interval.estimate)),
            Cell::from(width).title(all(half)),
        ]
    };
    let mut cells =
        vec![Cell::from(fixed(p.truth * family.per_si, family.decimals)).title(all(p.truth))];
    cells.extend(estimate(&p.four_steps));
    cells.extend(estimate(&p.joint));
    cells.push(Cell::from(significant(p.bound * family.per_si, 2)).title(all(p.bound)));
    cells.push(
        Cell::from(fixed(p.joint_error_over_bound, 1)).title(p.joint_error_over_bound.to_string()),
    );
    let share = |of: fn(&CampaignParameter) -> Option<Share>| covered(published.and_then(of));
    cells.push(share(|q| q.four_steps.within_stated_95));
    cells.push(share(|q| q.joint.as_ref()?.within_stated_95));
    cells.push(Cell::from(limit(known, p)));
    Row::new(symbol(p.parameter), cells)
}

fn covered(share: Option<Share>) -> Cell {
    let Some(share) = share else {
        return Cell::from(MISSING);
    };
    let chance = CHANCE * share.standard_error;
    let cell = Cell::from(fixed(100.0 * share.value, 1)).title(format!(
        "± {} by chance (1σ)",
        percent(share.standard_error, 2)
    ));
    if share.value < BAND.0 - chance || share.value > BAND.1 + chance {
        cell.state(State::Warn)
    } else {
        cell
    }
}

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

/// The middle one of the numbers of those parameters that are `among` the wanted.
fn median(known: &Known, among: fn(Parameter) -> bool, of: impl Fn(&KnownParameter) -> f64) -> f64 {
    let mut all: Vec<f64> = known
        .parameters
        .iter()
        .filter(|p| among(p.parameter))
        .map(of)
        .collect();
    all.sort_by(f64::total_cmp);
    all.get(all.len() / 2).copied().unwrap_or(f64::NAN)
}

fn sentences(known: &Known) -> String {
    let millivolts = |of: fn(&KnownParameter) -> &Interval| {
        significant(
            1e3 * median(
                known,
                |p| matches!(p, Parameter::Drift(_)),
                |p| half_width(of(p)),
            ),
            2,
        )
    };
    let square_millimetres = |of: fn(&KnownParameter) -> &Interval| {
        significant(
            1e6 * median(
                known,
                |p| matches!(p, Parameter::Inertia(3..)),
                |p| of(p).of_trials,
            ),
            2,
        )
    };
    let share = |among: fn(Parameter) -> bool, of: fn(&KnownParameter) -> f64| {
        median(known, among, |p| of(p) / p.truth.abs())
    };
    let is_scale = |p| matches!(p, Parameter::Scale(_));
    let is_moment = |p| matches!(p, Parameter::Inertia(0..3));
    let stiffness = known.parameters.last().map_or_else(String::new, |p| {
        let end = |si: f64| fixed(si * 1e9, 0);
        format!(
            "the joint fit leaves m/k anywhere from {} to {} × 10⁻⁹ s², step 4 by least squares from {} to {}; the truth is {}",
            end(p.joint.ends_95.0),
            end(p.joint.ends_95.1),
            end(p.four_steps.ends_95.0),
            end(p.four_steps.ends_95.1),
            end(p.truth),
        )
    });
    let open = if known.compliance_is_determined {
        "**k/m** is determined here"
    } else {
        "**k/m cannot be had from this campaign; tap the shell**"
    };
    [
        format!(
            "- **Zero drifts** are limited by noise: ± {} mV from the record at rest, ± {} mV with what the trials add. More time at rest helps, as its root.",
            millivolts(|p| &p.four_steps),
            millivolts(|p| &p.joint),
        ),
        format!(
            "- **Scale factors** share one error that no trial shows, the accelerometer's gain: of the joint fit's ± {} nearly all is its certificate. A \
             better certificate helps, more trials do not; hung so that gravity turns in the shell, the trials weigh the gain themselves. \
             That factor apart, the joint fit has them to {} (1σ), the four steps, which take wedges for exact, to {}.",
            percent(share(is_scale, |p| half_width(&p.joint)), 2),
            ppm(share(is_scale, |p| p.joint.of_trials), 2),
            percent(share(is_scale, |p| p.four_steps.of_trials), 2),
        ),
        format!(
            "- **Inertias** carry the same factor: the joint fit has moments to ± {}. That factor apart, it has them to {} (1σ), the four \
             steps, which take wedges for exact, to {}; products to {} mm² and {} mm². What helps is the same certificate, and for the four steps wedges that \
             are measured.",
            percent(share(is_moment, |p| half_width(&p.joint)), 2),
            ppm(share(is_moment, |p| p.joint.of_trials), 2),
            percent(share(is_moment, |p| p.four_steps.of_trials), 2),
            square_millimetres(|p| &p.joint),
            square_millimetres(|p| &p.four_steps),
        ),
        format!("- {open}: {stiffness}. {}", one(&known.tap)),
    ]
    .join("\n")
}
