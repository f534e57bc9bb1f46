//! The 25 parameters: what they are, how well they are known, and what limits that.

use crate::calibrate::CalibratedSession;
use crate::report::{Estimator, ParameterReport};
use sixaxis_recordings::session::SessionFile;

use crate::page::labels::{by_kind, share, share_beside, stated, symbol, with_interval};
use sixaxis_core::Parameter;
use sixaxis_page::number::{MISSING, fixed, scientific};
use sixaxis_page::{Axis, Block, Cell, Figure, Section, Table};

/// The section.
pub fn section(file: &SessionFile, calibrated: &CalibratedSession) -> Section {
    let limit = file.session.limits.interval_percent / 100.0;
    let mut section = Section::new(
        "parameters",
        "The 25 parameters",
        "Estimate and half width of the 95 % interval: noise, what differs between trials, and the class of the standard \
         instruments together. Digits that the interval does not support are not printed.",
    );
    let parameters = &calibrated.parameters;
    if parameters.is_empty() {
        return section.block(Block::Note(format!(
            "There are none, because the four steps could not be done with these recordings{}. What stands under “What to do next” \
             comes first.",
            calibrated
                .obstacle
                .as_ref()
                .map_or(String::new(), |reason| format!(": {reason}"))
        )));
    }
    section = section.block(Block::Table(table(parameters, limit)));
    for parameter in parameters.iter().filter(|p| !p.remark.is_empty()) {
        section = section.block(Block::Note(format!(
            "{} is {}.",
            symbol(parameter.parameter),
            parameter.remark
        )));
    }
    section.block(Block::FigureGrid(vec![
        differences(parameters),
        limits(parameters, limit, calibrated.estimator),
    ]))
}

fn table(parameters: &[ParameterReport], limit: f64) -> Table {
    let all = |si: f64, p: &ParameterReport| format!("{si} {}", p.unit);
    by_kind(parameters, |p| p.parameter)
        .col("estimate", |(p, per_si)| {
            Cell::from(with_half_width(p, *per_si).0).title(all(p.estimate, p))
        })
        .col("±\u{a0}95\u{a0}%", |(p, per_si)| {
            let title = p.half_width_95.map_or(String::new(), |half| all(half, p));
            Cell::from(with_half_width(p, *per_si).1).title(title)
        })
        .col("±\u{a0}relative", |(p, _)| relative(p, limit))
        .col("design", |(p, per_si)| {
            Cell::from(design_and_difference(p, *per_si).0).title(all(p.design, p))
        })
        .col("difference", |(p, per_si)| {
            design_and_difference(p, *per_si).1
        })
        .text("limited by", |(p, _)| p.dominated_by.as_str())
        .text("determined", |(p, _)| {
            if p.determined { "yes" } else { "no, see below" }
        })
        .caption("Estimates, intervals and design values")
        .footnote(format!(
            "± relative above {} is marked. Differences of scale factors and moments of inertia (I₁ to I₃) are relative to the \
             design; those of the products of inertia (I₄ to I₆), which may be zero, are in mm². Point at a number for all its digits.",
            stated(limit)
        ))
        .into()
}

/// Estimate and half width in the paper's unit, with the digits that the interval supports.
pub(super) fn with_half_width(p: &ParameterReport, per_si: f64) -> (String, String) {
    match p.half_width_95 {
        Some(half_width) => with_interval(p.estimate * per_si, half_width * per_si),
        None => (scientific(p.estimate * per_si, 3), MISSING.to_owned()),
    }
}

fn relative(p: &ParameterReport, limit: f64) -> Cell {
    match p.half_width_95 {
        Some(half_width) if p.parameter == Parameter::Stiffness => {
            share(Some(half_width / p.estimate)).into()
        }
        Some(half_width) if p.parameter.has_size() => {
            let ratio = half_width / p.estimate.abs();
            Cell::from(share_beside(Some(ratio), limit)).warn_unless(ratio <= limit)
        }
        _ => Cell::from(MISSING),
    }
}

fn design_and_difference(p: &ParameterReport, per_si: f64) -> (String, String) {
    let percent = || signed(100.0 * (p.estimate / p.design - 1.0), 1) + "\u{a0}%";
    match p.parameter {
        // A design drifts by nothing.
        Parameter::Drift(_) => ("0".to_owned(), MISSING.to_owned()),
        Parameter::Scale(_) => (fixed(p.design, 3), percent()),
        Parameter::Inertia(_) if p.parameter.has_size() => (fixed(p.design * per_si, 2), percent()),
        Parameter::Inertia(_) => {
            let digits = p.half_width_95.map_or(2, |h| {
                let (text, _) = with_interval(0.0, h * per_si);
                text.split_once('.')
                    .map_or(0, |(_, decimals)| decimals.len())
            });
            let difference = signed((p.estimate - p.design) * per_si, digits) + "\u{a0}mm²";
            (fixed(p.design * per_si, 2), difference)
        }
        Parameter::Stiffness | Parameter::Compliance => {
            // A k/m that is not determined is the design's.
            let difference = if p.determined {
                percent()
            } else {
                MISSING.to_owned()
            };
            (scientific(p.design, 3), difference)
        }
    }
}

fn signed(value: f64, decimals: usize) -> String {
    let text = fixed(value, decimals);
    if value > 0.0 && text.bytes().any(|b| (b'1'..=b'9').contains(&b)) {
        format!("+{text}")
    } else {
        text
    }
}

/// Scale factors and inertias with what their differences are taken relative to: themselves as designed, or, for a product of
/// inertia, the largest moment as designed.
fn scaled(parameters: &[ParameterReport]) -> Vec<(&ParameterReport, f64)> {
    let largest = parameters
        .iter()
        .filter(|p| matches!(p.parameter, Parameter::Inertia(_)))
        .fold(0.0_f64, |a, p| a.max(p.design.abs()));
    parameters
        .iter()
        .filter(|p| matches!(p.parameter, Parameter::Scale(_) | Parameter::Inertia(_)))
        .map(|p| {
            (
                p,
                if p.parameter.has_size() {
                    p.design.abs()
                } else {
                    largest
                },
            )
        })
        .collect()
}

fn differences(parameters: &[ParameterReport]) -> Figure {
    let scaled = scaled(parameters);
    let mut intervals = Vec::new();
    let mut points = Vec::new();
    for (row, (p, size)) in scaled.iter().enumerate() {
        let (y, middle) = (row as f64, 100.0 * (p.estimate - p.design) / size);
        let half = 100.0 * p.half_width_95.unwrap_or(0.0) / size;
        points.push((middle, y));
        intervals.extend([(middle - half, y), (middle + half, y), (f64::NAN, y)]);
    }
    Figure::new(
        "difference-from-design",
        "Difference from the design",
        Axis::linear("difference from the design", "%"),
        Axis::names("parameter", scaled.iter().map(|(p, _)| symbol(p.parameter))),
    )
    .line("95 % interval", 0, intervals)
    .points("estimate", 0, points)
    .vertical(0.0, "design")
    .caption("Products of inertia ($I$₄ to $I$₆) relative to the largest moment. A sensor differs from its design by tens of percent; an interval that is wide beside the others is what to work on.")
}

fn limits(parameters: &[ParameterReport], limit: f64, estimator: Estimator) -> Figure {
    let between_trials = match estimator {
        Estimator::FourSteps => "differences between trials",
        Estimator::Joint | Estimator::JointRobust => "sensitivities that move over the day",
    };
    let scaled = scaled(parameters);
    let series = |get: fn(&ParameterReport) -> Option<f64>| -> Vec<(f64, f64)> {
        scaled
            .iter()
            .enumerate()
            .filter_map(|(row, (p, size))| Some((100.0 * get(p)? / size, row as f64)))
            .collect()
    };
    Figure::new(
        "what-limits",
        "What the intervals consist of",
        Axis::log("half width, 95 %", "%"),
        Axis::names("parameter", scaled.iter().map(|(p, _)| symbol(p.parameter))),
    )
    .points("noise", 5, series(|p| p.from_noise))
    .points(between_trials, 1, series(|p| p.from_trials))
    .points(
        "class of the standards",
        2,
        series(|p| p.from_standards),
    )
    .vertical(100.0 * limit, "acceptance limit")
    .caption("Over the design, products of inertia over the largest moment. More trials help against noise and what differs between trials at random; against the standards' class only better standards do.")
}
