//! The stages that condition the recordings, as a table, and what each does to one trial.

use crate::calibrate::CalibratedSession;
use crate::conditioning::{Channels, Conditioned, Conditioning, Stage};
use crate::prepare::VALIDATION_CORNER;
use crate::series::extent;
use crate::trial::Trial;
use sixaxis_core::LIMBS;
use sixaxis_core::dsp::differentiate::Differentiator;
use sixaxis_recordings::session::{Role, Session, SessionFile};

use crate::page::labels::{file_name, largest};
use sixaxis_page::figure::NEUTRAL;
use sixaxis_page::number::{count, fixed, percent, significant};
use sixaxis_page::{Axis, Block, Figure, Section, Table};

/// The section.
pub fn section(file: &SessionFile, calibrated: &CalibratedSession) -> Section {
    let section = Section::new(
        "preprocessing",
        "Preprocessing",
        "Recordings pass through these stages in this order. Limbs and standards share the low-pass, so that what it takes off is \
         the same on both sides of every equation.",
    );
    // Validation runs are filtered differently.
    let Some((trial, _)) = worst_of(calibrated, |role| role != Role::Validation) else {
        return section;
    };
    let conditioning = Conditioning::of(&file.session);
    let limb = limb(calibrated, trial);
    let mut section = section.block(Block::Table(table(file, calibrated, &conditioning, trial)));
    let rotating = worst_of(calibrated, |role| role == Role::Angular).map(|(trial, _)| trial);
    let figures: Vec<Figure> = Stage::ORDER
        .into_iter()
        .filter(|stage| conditioning.has(*stage))
        .filter_map(|stage| stage_figure(&conditioning, stage, trial, rotating, limb))
        .collect();
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
                 Each pair shows the channel as it enters and leaves one stage; below it stands what the stage took off: noise, if all \
                 is well. A shape that follows the motion is signal that was lost."
                    .to_owned(),
            ))
            .block(Block::FigureGrid(figures));
    }
    section
}

/// A channel before and after one stage, where the stage changes one that is shown: a limb's voltage or, in a trial that
/// rotates, the gyroscope's rate.
fn stage_figure(
    conditioning: &Conditioning,
    stage: Stage,
    trial: &Trial,
    rotating: Option<&Trial>,
    limb: usize,
) -> Option<Figure> {
    let (id, title) = match stage {
        Stage::Outliers => ("outliers", "Outliers replaced"),
        Stage::HighPass => ("high-pass", "Amplifier's high-pass undone"),
        Stage::Trend => ("detrend", "Trend between the rests"),
        Stage::LowPass => ("low-pass", "Low-pass"),
        Stage::GyroscopeLag => {
            let trial = rotating?;
            let (before, after) =
                before_after(conditioning, stage, trial, |c| c.gyroscope_rad_s.clone())?;
            return Some(figure(
                "stage-gyroscope-lag".to_owned(),
                format!("Gyroscope's lag undone, {}", file_name(&trial.name)),
                trial.sample_rate_hz,
                ("rate", "rad/s", "change"),
                &before,
                &after,
            ));
        }
        Stage::Delays | Stage::AccelerometerLag | Stage::Derivative => return None,
    };
    let (before, after) = before_after(conditioning, stage, trial, |c| column(&c.voltage_v, limb))?;
    Some(figure(
        format!("stage-{id}"),
        format!("{title}, channel {}", limb + 1),
        trial.sample_rate_hz,
        ("voltage", "V", "taken off"),
        &before,
        &after,
    ))
}

/// A channel as it enters and as it leaves a stage; none where a stage refuses the trial.
fn before_after(
    conditioning: &Conditioning,
    stage: Stage,
    trial: &Trial,
    channel: impl Fn(&Channels) -> Vec<f64>,
) -> Option<(Vec<f64>, Vec<f64>)> {
    let mut channels = Channels::of(trial);
    for earlier in Stage::ORDER.into_iter().take_while(|s| *s != stage) {
        conditioning.run(earlier, trial, &mut channels).ok()?;
    }
    let before = channel(&channels);
    conditioning.run(stage, trial, &mut channels).ok()?;
    Some((before, channel(&channels)))
}

/// The trial with the largest departure, or the first, of some roles.
fn worst_of(
    calibrated: &CalibratedSession,
    wanted: impl Fn(Role) -> bool,
) -> Option<(&Trial, &Conditioned)> {
    let candidates: Vec<(&Trial, &Conditioned)> = calibrated
        .recordings
        .iter()
        .filter(|(trial, _)| wanted(trial.role))
        .filter_map(|(trial, conditioned)| Some((trial, conditioned.as_ref()?)))
        .collect();
    let departure = |trial: &Trial| calibrated.trial(&trial.name)?.departure;
    let worst = largest(
        candidates
            .iter()
            .filter_map(|(trial, conditioned)| Some((departure(trial)?, (*trial, *conditioned)))),
    );
    worst
        .map(|(_, candidate)| candidate)
        .or_else(|| candidates.first().copied())
}

/// The limb to show, from 0.
fn limb(calibrated: &CalibratedSession, trial: &Trial) -> usize {
    let found = calibrated
        .findings
        .iter()
        .filter(|f| f.recordings.is_empty() || f.recordings.contains(&trial.name))
        .find_map(|f| f.channels.first());
    if let Some(channel) = found {
        return channel.saturating_sub(1).min(LIMBS - 1);
    }
    let swing = |limb: usize| {
        let (low, high) = extent(trial.voltage_v.iter().map(|row| row[limb]));
        high - low
    };
    largest((0..LIMBS).map(|limb| (swing(limb), limb))).map_or(0, |(_, limb)| limb)
}

fn column(rows: &[[f64; LIMBS]], limb: usize) -> Vec<f64> {
    rows.iter().map(|row| row[limb]).collect()
}

fn figure(
    id: String,
    title: String,
    sample_rate_hz: f64,
    (quantity, unit, difference): (&str, &str, &str),
    before: &[f64],
    after: &[f64],
) -> Figure {
    let curve = |get: &dyn Fn(usize) -> f64| -> Vec<(f64, f64)> {
        (0..after.len().min(before.len()))
            .map(|i| (i as f64 / sample_rate_hz, get(i)))
            .collect()
    };
    Figure::new(
        id,
        title,
        Axis::linear("time", "s"),
        Axis::linear(quantity, unit),
    )
    .line("before", NEUTRAL, curve(&|i| before[i]))
    .line("after", 0, curve(&|i| after[i]))
    .below(Axis::linear(difference, unit))
    .line("", 1, curve(&|i| before[i] - after[i]))
}

fn table(
    file: &SessionFile,
    calibrated: &CalibratedSession,
    conditioning: &Conditioning,
    trial: &Trial,
) -> Table {
    let told = |stage: &Stage| {
        settings_and_effect(*stage, file, calibrated, conditioning, trial)
            .unwrap_or_else(|| ("off".to_owned(), String::new()))
    };
    Table::of("stage", Stage::ORDER, |stage| stage.name().to_owned())
        .text("channels", |stage| stage.channels())
        .text("settings", |stage| told(stage).0)
        .text("effect", |stage| told(stage).1)
        .caption("Stages in their order")
        .into()
}

/// Settings and effect of a stage; none where the session has it off.
fn settings_and_effect(
    stage: Stage,
    file: &SessionFile,
    calibrated: &CalibratedSession,
    conditioning: &Conditioning,
    trial: &Trial,
) -> Option<(String, String)> {
    let stages = &conditioning.stages;
    let lag = |bandwidth_hz: f64| {
        (
            format!("first order, {} Hz", significant(bandwidth_hz, 3)),
            format!(
                "moved forward by {} ms",
                fixed(1e3 / (core::f64::consts::TAU * bandwidth_hz), 1)
            ),
        )
    };
    match stage {
        Stage::Delays => delays(&file.session).map(|whose| {
            (
                format!("{whose}, as the session says"),
                "all channels on one clock".to_owned(),
            )
        }),
        Stage::Outliers => stages.outliers.settings().map(|test| {
            let replaced: usize = calibrated.trials.iter().map(|t| t.outliers).sum();
            let values: usize = calibrated
                .trials
                .iter()
                .map(|t| t.samples * (LIMBS + 2))
                .sum();
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
        }),
        Stage::HighPass => stages.amplifier_high_pass_hz.map(|corner| {
            (
                format!("first order, {} Hz", significant(corner, 3)),
                "slow motion gets back what the amplifier took off".to_owned(),
            )
        }),
        Stage::Trend => stages.detrend.settings().map(|line| {
            (
                format!("line through rests of {} s", line.rest_s),
                "the change of the zero during a run is taken off".to_owned(),
            )
        }),
        Stage::LowPass => stages.low_pass.settings().map(|low_pass| {
            let corner = conditioning.corner_hz(trial).unwrap_or(f64::NAN);
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
                    VALIDATION_CORNER
                ),
            )
        }),
        Stage::AccelerometerLag => conditioning.accelerometer_bandwidth_hz.map(lag),
        Stage::GyroscopeLag => conditioning.gyroscope_bandwidth_hz.map(lag),
        Stage::Derivative => Some(differentiator(conditioning, trial)),
    }
}

/// Whose delays are undone as recordings are read.
fn delays(session: &Session) -> Option<&'static str> {
    let limbs = session.channels.limbs_lag_us.is_some();
    let standards =
        session.accelerometer.delay_ms.is_some() || session.gyroscope.delay_ms.is_some();
    match (limbs, standards) {
        (true, true) => Some("each limb and each standard by its own"),
        (true, false) => Some("each limb by its own"),
        (false, true) => Some("each standard by its own"),
        (false, false) => None,
    }
}

fn differentiator(conditioning: &Conditioning, trial: &Trial) -> (String, String) {
    let settings = conditioning.stages.differentiator;
    let rate_hz = trial.sample_rate_hz;
    (
        format!(
            "Savitzky and Golay, {} samples, polynomial of order {}",
            2 * settings.half_width + 1,
            settings.order
        ),
        Differentiator::new(settings.half_width, settings.order, rate_hz).map_or_else(
            |error| error.to_string(),
            |d| {
                format!(
                    "right to {} up to {} Hz, half power at {} Hz, at {} Hz sampling",
                    percent(GAIN_ERROR, 1),
                    significant(frequency_of_gain(&d, trial, 1.0 - GAIN_ERROR), 3),
                    significant(frequency_of_gain(&d, trial, 0.5_f64.sqrt()), 3),
                    significant(rate_hz, 4)
                )
            },
        ),
    )
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
