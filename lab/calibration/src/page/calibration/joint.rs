//! The joint fit beside the four steps, and what it found of instruments and wedges.

use crate::calibrate::CalibratedSession;
use crate::calibrate::contradiction;
use crate::joint::JointReport;
use crate::joint::nuisances::Found;
use crate::report::Estimator;
use crate::report::ParameterReport;

use super::parameters::FAMILIES;
use crate::page::labels::{direction, symbol, with_interval};
use sixaxis_page::number::{MISSING, fixed, percent, scientific};
use sixaxis_page::{Block, Cell, Column, Row, Section, State, Table};

/// An angle that the fit has moved from 0 by less than this share of its deviation is one that no trial tells.
const UNMOVED: f64 = 1e-6;

/// The section; empty where the four steps could not be done.
pub fn section(calibrated: &CalibratedSession) -> Section {
    let section = Section::new(
        "joint",
        "All trials at once",
        "The joint fit: maximum likelihood over all 25 parameters together with the motions, the gyroscope, the amplifiers and the \
         wedges, where the four steps take the standards and the wedges for right. It takes limbs for equally stiff and noise for white.",
    );
    match &calibrated.joint {
        None => section,
        Some(Err(cause)) => section.block(Block::Note(format!("It cannot be had: {cause}."))),
        Some(Ok(joint)) => fitted(section, calibrated, joint),
    }
}

fn fitted(mut section: Section, calibrated: &CalibratedSession, joint: &JointReport) -> Section {
    let misfit = &joint.misfit;
    section = section.block(Block::Note(match contradiction(misfit) {
        Some(words) => format!("Against it: {words}."),
        None => format!(
            "Nothing contradicts it: its squares per degree of freedom are {}, where noise alone leaves at most {}.",
            fixed(misfit.per_degree, 3),
            fixed(misfit.limit(), 3)
        ),
    }));
    section
        .block(Block::Table(beside(calibrated, joint)))
        .block(Block::Table(nuisances(joint)))
}

fn beside(calibrated: &CalibratedSession, joint: &JointReport) -> Table {
    let reports = joint.parameter_reports(&calibrated.four_steps);
    let mut rows = Vec::new();
    for (letter, heading, per_si) in FAMILIES {
        rows.push(Row::group(heading));
        rows.extend(
            reports
                .iter()
                .zip(&calibrated.four_steps)
                .filter(|(joint, _)| joint.parameter.symbol() == letter)
                .map(|(joint, steps)| row(joint, steps, per_si)),
        );
    }
    let whose = if calibrated.calibration.is_none() {
        "No calibration was written."
    } else if calibrated.estimator == Estimator::FourSteps {
        "The calibration has the four steps' parameters; with `--estimator joint` it has these."
    } else {
        "The calibration has the joint fit's parameters."
    };
    Table {
        caption: "The joint fit beside the four steps".to_owned(),
        stub: "parameter".to_owned(),
        columns: vec![
            Column::number("joint fit", ""),
            Column::number("±\u{a0}95\u{a0}%", ""),
            Column::number("four steps", ""),
            Column::number("±\u{a0}95\u{a0}%", ""),
            Column::number("apart", ""),
            Column::text("joint fit limited by"),
        ],
        rows,
        footnote: format!(
            "Apart: the difference over the wider half width; above 1 is marked. What both owe to the accelerometer's gain does not \
             part them. {whose}"
        ),
        ..Table::default()
    }
}

fn row(joint: &ParameterReport, steps: &ParameterReport, per_si: f64) -> Row {
    let cells = |p: &ParameterReport| match p.half_width_95 {
        Some(half) => with_interval(p.estimate * per_si, half * per_si),
        None => (scientific(p.estimate * per_si, 3), MISSING.to_owned()),
    };
    let all = |p: &ParameterReport| format!("{} {}", p.estimate, p.unit);
    let (a, a_half) = cells(joint);
    let (b, b_half) = cells(steps);
    let apart = match (joint.half_width_95, steps.half_width_95) {
        (Some(x), Some(y)) => {
            let apart = (joint.estimate - steps.estimate).abs() / x.max(y);
            let cell = Cell::from(fixed(apart, 2));
            if apart > 1.0 {
                cell.state(State::Warn)
            } else {
                cell
            }
        }
        _ => Cell::from(MISSING),
    };
    Row::new(
        symbol(joint.parameter),
        [
            Cell::from(a).title(all(joint)),
            Cell::from(a_half),
            Cell::from(b).title(all(steps)),
            Cell::from(b_half),
            apart,
            Cell::from(joint.dominated_by.as_str()),
        ],
    )
}

fn nuisances(joint: &JointReport) -> Table {
    let found = joint.nuisances();
    let in_percent = |f: Found| {
        let f = (100.0 * f.value, 100.0 * f.deviation);
        let (value, deviation) = with_interval(f.0, f.1);
        (format!("{value}\u{a0}%"), format!("{deviation}\u{a0}%"))
    };
    let in_unit = |f: Found, factor: f64, unit: &str| {
        let (value, deviation) = with_interval(factor * f.value, factor * f.deviation);
        (
            format!("{value}\u{a0}{unit}"),
            format!("{deviation}\u{a0}{unit}"),
        )
    };
    let row = |name: &str, (value, deviation): (String, String), remark: String| {
        Row::new(
            name,
            [Cell::from(value), Cell::from(deviation), Cell::from(remark)],
        )
    };
    let mut rows = vec![Row::group("Instruments")];
    let limit = percent(joint.gain.limit, 2);
    rows.push(row(
        "accelerometer reads too much by",
        in_percent(found.accelerometer_gain),
        if found.accelerometer_gain_is_told {
            "told by gravity that turns".to_owned()
        } else {
            format!("its certificate, ±\u{a0}{limit}, is all that is known")
        },
    ));
    if let Some(gain) = found.gyroscope_gain {
        rows.push(row(
            "gyroscope reads too much by",
            in_percent(gain),
            String::new(),
        ));
    }
    if let Some(lag) = found.gyroscope_lag_s {
        let hz = 1.0 / (core::f64::consts::TAU * lag.value);
        rows.push(row(
            "gyroscope lags by",
            in_unit(lag, 1e3, "ms"),
            format!("a bandwidth of {}\u{a0}Hz", fixed(hz, 2)),
        ));
    }
    if let Some(corner) = found.amplifier_corner_hz {
        rows.push(row(
            "corner of the amplifiers",
            in_unit(corner, 1.0, "Hz"),
            String::new(),
        ));
    }
    rows.push(Row::group("Wedges: angles by which they miss"));
    for wedge in &found.wedges {
        let name = direction(wedge.nominal);
        let Some([a, b, about]) = wedge.angles_deg else {
            rows.push(Row::new(
                name,
                [
                    Cell::from(MISSING),
                    Cell::from(MISSING),
                    Cell::from("the session says that it is right"),
                ],
            ));
            continue;
        };
        let written = [a, b].map(|f| with_interval(f.value, f.deviation));
        let spin = if about.value.abs() < UNMOVED * about.deviation {
            "about itself: nothing tells".to_owned()
        } else {
            let (angle, deviation) = with_interval(about.value, about.deviation);
            format!("about itself {angle}° ± {deviation}°")
        };
        rows.push(Row::new(
            name,
            [
                Cell::from(format!("{}°, {}°", written[0].0, written[1].0)),
                Cell::from(format!("{}°, {}°", written[0].1, written[1].1)),
                Cell::from(spin),
            ],
        ));
    }
    Table {
        caption: "What the instruments and wedges turned out to be".to_owned(),
        stub: "instrument or wedge".to_owned(),
        columns: vec![
            Column::number("found", ""),
            Column::number("±\u{a0}one s.d.", ""),
            Column::text("remark"),
        ],
        rows,
        footnote: "Certificates and the workshop's tolerance are part of what is known here; where trials say nothing, they stand as \
                   they were. A wedge's two angles lead along two directions square to its own; the one about itself is told only by \
                   gravity that turns."
            .to_owned(),
        ..Table::default()
    }
}
