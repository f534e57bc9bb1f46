//! What was done to the recordings before anything was computed from them, shown on one trial.

use crate::cleaning::{Cleaned, Cleaning};
use crate::trial::Trial;
use crate::verdict::{Judgement, VALIDATION_CORNER};
use sixaxis_core::LIMBS;
use sixaxis_core::dsp::differentiate::Differentiator;
use sixaxis_recordings::session::{Preprocessing, Role, SessionFile, Stage};

use super::NEUTRAL;
use crate::page::labels::{file_name, largest};
use sixaxis_page::number::{count, fixed, percent, significant};
use sixaxis_page::{Axis, Block, Cell, Column, Figure, Panel, Row, Section, Series, Table};

/// Curves are drawn with at most so many points; the drawing keeps what peaks are among them.
const DRAWN: usize = 8000;

/// The section.
pub fn section(file: &SessionFile, judgement: &Judgement) -> Section {
    let section = Section::new(
        "preprocessing",
        "Preprocessing",
        "All channels and the standards pass through the same stages, in this order, so that what a filter takes off is the same on \
         both sides of every equation.",
    );
    // Validation runs are filtered differently.
    let Some((trial, _)) = worst_of(judgement, |role| role != Role::Validation) else {
        return section;
    };
    let cleaning = Cleaning::of(&file.session);
    let limb = limb(judgement, trial);
    let mut section = section.block(Block::Table(table(file, judgement, &cleaning, trial)));
    let mut figures = Vec::new();
    let mut before = column(&trial.voltage_v, limb);
    let mut stages = nothing(&cleaning);
    for (stage, (id, title)) in STAGES.iter().enumerate() {
        if !switch_on(&mut stages, &cleaning, stage) {
            continue;
        }
        let Ok(after) = stages.clean(trial) else {
            continue;
        };
        let after = column(&after.voltage_v, limb);
        figures.push(figure(
            format!("stage-{id}"),
            format!("{title}, channel {}", limb + 1),
            trial.sample_rate_hz,
            ("voltage", "V", "taken off"),
            &before,
            &after,
        ));
        before = after;
    }
    // Rotation is needed to see a gyroscope's lag.
    if cleaning.gyroscope_bandwidth_hz.is_some()
        && let Some((trial, cleaned)) = worst_of(judgement, |role| role == Role::Angular)
        && let Ok(lagging) = (Cleaning {
            gyroscope_bandwidth_hz: None,
            ..cleaning.clone()
        })
        .clean(trial)
    {
        figures.push(figure(
            "stage-gyroscope-lag".to_owned(),
            format!("Gyroscope's lag undone, {}", file_name(&trial.name)),
            trial.sample_rate_hz,
            ("rate", "rad/s", "change"),
            &along(&lagging, trial),
            &along(cleaned, trial),
        ));
    }
    if figures.is_empty() {
        section = section.block(Block::Note(
            "All stages that change a recording are switched off in the session file.".to_owned(),
        ));
    } else {
        section = section
            .block(Block::Heading(format!(
                "Before and after, {}",
                file_name(&trial.name)
            )))
            .block(Block::Text(
                "The trial that departs most from the others, and of it the channel that was found fault with or else swings most. \
                 Below each pair stands what the stage took off: noise, if all is well. A shape that follows the motion is signal that \
                 was lost."
                    .to_owned(),
            ))
            .block(Block::FigureGrid(figures));
    }
    section
}

/// The trial with the largest departure, or the first, of some roles.
fn worst_of(judgement: &Judgement, wanted: impl Fn(Role) -> bool) -> Option<(&Trial, &Cleaned)> {
    let candidates: Vec<(&Trial, &Cleaned)> = judgement
        .recordings
        .iter()
        .filter(|(trial, _)| wanted(trial.role))
        .filter_map(|(trial, cleaned)| Some((trial, cleaned.as_ref()?)))
        .collect();
    let departure = |trial: &Trial| {
        judgement
            .trials
            .iter()
            .find(|report| report.name == trial.name)
            .and_then(|report| report.departure)
    };
    let worst = largest(
        candidates
            .iter()
            .filter_map(|(trial, cleaned)| Some((departure(trial)?, (*trial, *cleaned)))),
    );
    worst
        .map(|(_, candidate)| candidate)
        .or_else(|| candidates.first().copied())
}

/// The limb to show, from 0.
fn limb(judgement: &Judgement, trial: &Trial) -> usize {
    let found = judgement
        .findings
        .iter()
        .filter(|f| f.recordings.is_empty() || f.recordings.contains(&trial.name))
        .find_map(|f| f.channels.first());
    if let Some(channel) = found {
        return channel.saturating_sub(1).min(LIMBS - 1);
    }
    let swing = |limb: usize| {
        let series = trial.voltage_v.iter().map(|row| row[limb]);
        series.clone().fold(f64::NEG_INFINITY, f64::max) - series.fold(f64::INFINITY, f64::min)
    };
    largest((0..LIMBS).map(|limb| (swing(limb), limb))).map_or(0, |(_, limb)| limb)
}

fn column(rows: &[[f64; LIMBS]], limb: usize) -> Vec<f64> {
    rows.iter().map(|row| row[limb]).collect()
}

fn along(cleaned: &Cleaned, trial: &Trial) -> Vec<f64> {
    cleaned
        .rate_shell_rad_s
        .iter()
        .map(|rate| rate.dot(trial.direction_ground))
        .collect()
}

/// Stages that change a limb's voltage, in their order.
const STAGES: [(&str, &str); 4] = [
    ("high-pass", "Amplifier's high-pass undone"),
    ("outliers", "Outliers replaced"),
    ("detrend", "Trend between the rests"),
    ("low-pass", "Low-pass"),
];

/// The same with every stage of [`STAGES`] off.
fn nothing(cleaning: &Cleaning) -> Cleaning {
    Cleaning {
        stages: Preprocessing {
            outliers: Stage::Switch(false),
            amplifier_high_pass_hz: None,
            detrend: Stage::Switch(false),
            low_pass: Stage::Switch(false),
            differentiator: cleaning.stages.differentiator,
        },
        ..cleaning.clone()
    }
}

/// Switches one of [`STAGES`] on if `wanted` has it on.
fn switch_on(stages: &mut Cleaning, wanted: &Cleaning, stage: usize) -> bool {
    let (on, wanted) = (&mut stages.stages, &wanted.stages);
    match stage {
        0 => {
            on.amplifier_high_pass_hz = wanted.amplifier_high_pass_hz;
            on.amplifier_high_pass_hz.is_some()
        }
        1 => {
            on.outliers = wanted.outliers;
            on.outliers.settings().is_some()
        }
        2 => {
            on.detrend = wanted.detrend;
            on.detrend.settings().is_some()
        }
        _ => {
            on.low_pass = wanted.low_pass;
            on.low_pass.settings().is_some()
        }
    }
}

fn figure(
    id: String,
    title: String,
    sample_rate_hz: f64,
    (quantity, unit, difference): (&str, &str, &str),
    before: &[f64],
    after: &[f64],
) -> Figure {
    let stride = after.len().div_ceil(DRAWN).max(1);
    let curve = |get: &dyn Fn(usize) -> f64| -> Vec<(f64, f64)> {
        (0..after.len().min(before.len()))
            .step_by(stride)
            .map(|i| (i as f64 / sample_rate_hz, get(i)))
            .collect()
    };
    Figure::new(
        id,
        title,
        Axis::linear("time", "s"),
        Axis::linear(quantity, unit),
    )
    .series(Series::line("before", NEUTRAL, curve(&|i| before[i])))
    .series(Series::line("after", 0, curve(&|i| after[i])))
    .below(Panel {
        y: Axis::linear(difference, unit),
        series: vec![Series::line("", 1, curve(&|i| before[i] - after[i]))],
        marks: Vec::new(),
    })
}

fn table(file: &SessionFile, judgement: &Judgement, cleaning: &Cleaning, trial: &Trial) -> Table {
    let stages = &cleaning.stages;
    let off = || ("off".to_owned(), String::new());
    let replaced: usize = judgement.trials.iter().map(|t| t.outliers).sum();
    let values: usize = judgement
        .trials
        .iter()
        .map(|t| t.samples * (LIMBS + 2))
        .sum();
    let high_pass = stages.amplifier_high_pass_hz.map_or_else(off, |corner| {
        (
            format!("first order, {} Hz", significant(corner, 3)),
            "slow motion gets back what the amplifier took off".to_owned(),
        )
    });
    let outliers = stages.outliers.settings().map_or_else(off, |test| {
        (
            format!(
                "Hampel, {} samples on either side, {} robust standard deviations",
                test.half_width,
                significant(test.sigmas, 2)
            ),
            format!(
                "{} of {} values replaced",
                count(replaced as u64),
                count(values as u64)
            ),
        )
    });
    let detrend = stages.detrend.settings().map_or_else(off, |line| {
        (
            format!("line through rests of {} s", line.rest_s),
            "the change of the zero during a run is taken off".to_owned(),
        )
    });
    let low_pass = stages.low_pass.settings().map_or_else(off, |low_pass| {
        let corner = cleaning.corner_hz(trial).unwrap_or(f64::NAN);
        (
            format!(
                "Butterworth of order {}, forwards and backwards; corner {} × drive + {} Hz",
                low_pass.order,
                low_pass.times_drive,
                low_pass.plus_hz
            ),
            format!(
                "corner {} Hz in {}; no phase; {} × drive in validation runs, where noise weighs twice differentiated",
                significant(corner, 3),
                file_name(&trial.name),
                low_pass.times_drive.min(VALIDATION_CORNER)
            ),
        )
    });
    let lag = |bandwidth: Option<f64>| {
        bandwidth.map_or_else(off, |hz| {
            (
                format!("first order, {} Hz", significant(hz, 3)),
                format!(
                    "moved forward by {} ms",
                    fixed(1e3 / (core::f64::consts::TAU * hz), 1)
                ),
            )
        })
    };
    let settings = stages.differentiator;
    let differentiator = (
        format!(
            "Savitzky and Golay, {} samples, polynomial of order {}",
            2 * settings.half_width + 1,
            settings.order
        ),
        Differentiator::new(settings.half_width, settings.order, trial.sample_rate_hz).map_or_else(
            |error| error.to_string(),
            |d| {
                format!(
                    "right to {} up to {} Hz, half power at {} Hz, at {} Hz sampling",
                    percent(GAIN_ERROR, 1),
                    significant(frequency_of_gain(&d, trial, 1.0 - GAIN_ERROR), 3),
                    significant(frequency_of_gain(&d, trial, 0.5_f64.sqrt()), 3),
                    significant(trial.sample_rate_hz, 4)
                )
            },
        ),
    );
    let delays = match file.session.channels.limbs_lag_us {
        None => off(),
        Some(_) => (
            "each limb by its own, as the session says".to_owned(),
            "all channels on one clock".to_owned(),
        ),
    };
    let rows = [
        ("channel delays", delays),
        ("amplifier's high-pass", high_pass),
        ("outliers", outliers),
        ("trend", detrend),
        ("low-pass", low_pass),
        (
            "accelerometer's lag",
            lag(cleaning.accelerometer_bandwidth_hz),
        ),
        ("gyroscope's lag", lag(cleaning.gyroscope_bandwidth_hz)),
        ("differentiator of the gyroscope", differentiator),
    ];
    Table {
        caption: "Stages".to_owned(),
        stub: "stage".to_owned(),
        columns: vec![Column::text("settings"), Column::text("effect")],
        rows: rows
            .into_iter()
            .map(|(name, (settings, effect))| {
                Row::new(name, [Cell::from(settings), Cell::from(effect)])
            })
            .collect(),
        ..Table::default()
    }
}

/// Error of the differentiator's gain up to which its band is said to reach.
const GAIN_ERROR: f64 = 0.01;
/// Steps of the search for a gain, over half the sample rate.
const STEPS: usize = 4096;

/// Lowest frequency at which the differentiator's gain has fallen to `gain`, Hz.
fn frequency_of_gain(differentiator: &Differentiator, trial: &Trial, gain: f64) -> f64 {
    let nyquist = 0.5 * trial.sample_rate_hz;
    (1..=STEPS)
        .map(|step| nyquist * step as f64 / STEPS as f64)
        .find(|f| differentiator.relative_gain(*f) <= gain)
        .unwrap_or(nyquist)
}
