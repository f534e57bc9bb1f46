//! The static record and the noise of the channels.

use crate::calibrate::CalibratedSession;
use crate::series::mean_of;
use crate::trial::Trial;
use sixaxis_core::LIMBS;
use sixaxis_recordings::session::Role;

use sixaxis_page::number::{MISSING, count, fixed, significant};
use sixaxis_page::{Axis, Block, Figure, Section, Table};

/// Pieces whose means show the course of the record.
const PIECES: usize = 60;

/// The section.
pub fn section(calibrated: &CalibratedSession) -> Section {
    let section = Section::new(
        "rest",
        "At rest, and noise",
        "The zero drift is the mean of the static record, so it must stand still; and noise is what one sample adds to everything.",
    );
    let at_rest = calibrated
        .recordings
        .iter()
        .map(|(trial, _)| trial)
        .find(|trial| trial.role == Role::Static);
    let section = match at_rest {
        Some(rest) if rest.voltage_v.len() >= PIECES => section.block(Block::Figure(course(rest))),
        Some(_) => section,
        None => section.block(Block::Note(
            "There is no usable static record: ten minutes at rest, with the amplifiers warm, give the zero drift.".to_owned(),
        )),
    };
    if calibrated.recordings.is_empty() {
        return section;
    }
    section.block(Block::Table(table(calibrated, at_rest)))
}

/// Means over pieces of the record less the whole mean, for each channel, with the middle of each piece, s.
fn means(rest: &Trial) -> Vec<(f64, [f64; LIMBS])> {
    let length = rest.voltage_v.len() / PIECES;
    let of_limbs = |rows: &[[f64; LIMBS]]| -> [f64; LIMBS] {
        core::array::from_fn(|limb| mean_of(rows, limb))
    };
    let whole = of_limbs(&rest.voltage_v);
    rest.voltage_v
        .chunks_exact(length)
        .enumerate()
        .map(|(piece, rows)| {
            let middle_s = (piece as f64 + 0.5) * length as f64 / rest.sample_rate_hz;
            let own = of_limbs(rows);
            (middle_s, core::array::from_fn(|i| own[i] - whole[i]))
        })
        .collect()
}

fn course(rest: &Trial) -> Figure {
    let means = means(rest);
    let largest = means
        .iter()
        .flat_map(|(_, values)| values)
        .fold(0.0_f64, |a, v| a.max(v.abs()));
    // Rows are one apart; the largest swing stays within its own.
    let row_v = round_up(2.2 * largest).max(f64::MIN_POSITIVE);
    let mut figure = Figure::new(
        "zero-course",
        "Course of the zero during the static record",
        Axis::linear("time", "s"),
        Axis::names("channel", (1..=LIMBS).map(|i| format!("channel {i}"))),
    );
    for limb in 0..LIMBS {
        figure = figure.line(
            "",
            limb,
            means
                .iter()
                .map(|(t, values)| (*t, limb as f64 - values[limb] / row_v)),
        );
    }
    let piece_s = rest.voltage_v.len() as f64 / PIECES as f64 / rest.sample_rate_hz;
    figure.caption(format!(
        "Means over {} s less the mean of the whole record. From one row to the next is {} mV. Noise looks like grass; a slope or a step \
         is drift.",
        significant(piece_s, 2),
        significant(1e3 * row_v, 2)
    ))
}

/// The next of 1, 2, 5 times a power of ten.
fn round_up(value: f64) -> f64 {
    if !(value > 0.0 && value.is_finite()) {
        return 0.0;
    }
    let power = 10f64.powf(value.log10().floor());
    [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|step| step * power)
        .find(|step| *step >= value * (1.0 - 1e-12))
        .unwrap_or(value)
}

fn table(calibrated: &CalibratedSession, at_rest: Option<&Trial>) -> Table {
    let noise = |trial: &Trial, limb: usize| trial.noise_v(limb).ok();
    // The noise of the trials, ascending.
    let channels = (0..LIMBS).map(|limb| {
        let moving = calibrated.recordings.iter().map(|(trial, _)| trial);
        let mut floors: Vec<f64> = moving
            .filter(|trial| trial.role != Role::Static)
            .filter_map(|trial| noise(trial, limb))
            .collect();
        floors.sort_by(f64::total_cmp);
        (limb, floors)
    });
    let drift = calibrated.steps.as_ref().map(|steps| steps.drift);
    let millivolts = |v: Option<f64>| v.map_or(MISSING.to_owned(), |v| significant(1e3 * v, 2));
    Table::of("channel", channels, |(limb, _)| {
        format!("channel {}", limb + 1)
    })
    .under("zero")
    .col(("mean", "mV"), |(limb, _)| {
        drift.map_or(MISSING.to_owned(), |d| fixed(1e3 * d.drift_v[*limb], 3))
    })
    .col(("standard error", "mV"), |(limb, _)| {
        millivolts(drift.map(|d| d.standard_error_v[*limb]))
    })
    .col(("end less beginning", "mV"), |(limb, _)| {
        millivolts(at_rest.and_then(|rest| change(rest, *limb)))
    })
    .under("noise of one sample")
    .col(("at rest", "mV"), |(limb, _)| {
        millivolts(at_rest.and_then(|rest| noise(rest, *limb)))
    })
    .col(("trials, median", "mV"), |(_, floors)| {
        millivolts(floors.get(floors.len() / 2).copied())
    })
    .col(("trials, largest", "mV"), |(_, floors)| {
        millivolts(floors.last().copied())
    })
    .caption("Zero and noise by channel")
    .footnote(format!(
        "End less beginning: means of the last and first tenth. Noise is the standard deviation of a sample under a smooth motion{}; \
         a channel much noisier than its neighbours has a bad contact or a wrong range.",
        at_rest.map_or(String::new(), |rest| format!(
            "; at rest from {} samples at {} Hz",
            count(rest.voltage_v.len() as u64),
            significant(rest.sample_rate_hz, 3)
        ))
    ))
    .into()
}

/// Mean of the last part of a channel less that of the first, V; none for a record too short to have them.
fn change(rest: &Trial, limb: usize) -> Option<f64> {
    let rows = &rest.voltage_v;
    let part = rows.len() / ENDS;
    let mean = |rows| mean_of(rows, limb);
    (rows.len() >= 2 * ENDS).then(|| mean(&rows[rows.len() - part..]) - mean(&rows[..part]))
}

/// One part in so many at either end of the static record.
const ENDS: usize = 10;
