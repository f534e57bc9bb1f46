//! A limb that dies in mid-motion, as MuJoCo's truth sees it.

use sixaxis_page::figure::{NEUTRAL, paired};
use sixaxis_page::{Axis, Figure, Text};
use sixaxis_props::results::DyingLimb;

use super::super::DEG_PER_RAD;

/// Values and figures.
pub fn fill(text: Text, d: &DyingLimb) -> Text {
    let milliseconds = |samples: u64| 1e3 * samples as f64 / d.sample_rate_hz;
    let at_the_end = [&d.watched_rad, &d.never_failed_rad, &d.nine_rad]
        .map(|angles| angles.last().map(|rad| rad * DEG_PER_RAD));
    let excluded_s = d.died_at_s + d.switched_after_samples as f64 / d.sample_rate_hz;
    let after = d
        .time_s
        .iter()
        .zip(d.watched_m_s2.iter().zip(&d.truth_m_s2));
    let off_m_s2 = after
        .filter(|(time_s, _)| **time_s > excluded_s)
        .map(|(_, (watched, truth))| (watched - truth).abs())
        .fold(0.0, f64::max);
    let peak_m_s2 = d
        .truth_m_s2
        .iter()
        .fold(0.0, |peak: f64, a| peak.max(a.abs()));
    text.value("dying", d)
        .value("excluded_off", off_m_s2 / peak_m_s2)
        .value("off_deg", at_the_end)
        .value("isolated_ms", milliseconds(d.isolated_after_samples))
        .value("switched_ms", milliseconds(d.switched_after_samples))
        .figure(statistic(d))
        .figure(acceleration(d))
        .figure(attitude(d))
}

fn over_time(d: &DyingLimb, id: &str, y: Axis) -> Figure {
    let died = format!("limb {} dies", d.limb);
    Figure::new(id, "", Axis::linear("time", "s"), y).vertical(d.died_at_s, died)
}

fn statistic(d: &DyingLimb) -> Figure {
    let y = Axis::log("largest squared whitened residual", "");
    over_time(d, "dying-limb-statistic", y)
        .line("", 0, paired(&d.time_s, &d.statistic))
        .horizontal(d.threshold, "threshold of one sample")
}

/// The same three curves of an acceleration and of an attitude.
fn compared(
    figure: Figure,
    time_s: &[f64],
    nine: &[f64],
    watched: &[f64],
    truth: (&str, &[f64]),
) -> Figure {
    figure
        .line("all nine", 3, paired(time_s, nine))
        .line("the limb excluded", 0, paired(time_s, watched))
        .dashed(truth.0, NEUTRAL, paired(time_s, truth.1))
}

fn acceleration(d: &DyingLimb) -> Figure {
    let y = Axis::linear("acceleration", "m/s²");
    let figure = over_time(d, "dying-limb-acceleration", y);
    let truth = ("truth", &d.truth_m_s2[..]);
    compared(figure, &d.time_s, &d.nine_m_s2, &d.watched_m_s2, truth)
}

fn attitude(d: &DyingLimb) -> Figure {
    let y = Axis::log("rotation from the truth", "°").range(1e-3, 180.0);
    let figure = over_time(d, "dying-limb-attitude", y);
    let [nine, watched, never_failed] =
        [&d.nine_rad, &d.watched_rad, &d.never_failed_rad].map(|angles| {
            angles
                .iter()
                .map(|rad| rad * DEG_PER_RAD)
                .collect::<Vec<_>>()
        });
    compared(
        figure,
        &d.time_s,
        &nine,
        &watched,
        ("no failure", &never_failed),
    )
}
