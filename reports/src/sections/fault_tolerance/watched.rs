//! False alarms of the command on healthy laboratories.

use sixaxis_page::number::{count, fixed, percent, significant};
use sixaxis_page::{Table, Text};
use sixaxis_props::results::{Corner, Course, Watched, WatchedCorner, WatchedLaboratories};

/// Values and tables.
pub fn fill(text: Text, d: &WatchedLaboratories) -> Text {
    let total = |corner| {
        let mut corners = d.corners.iter();
        corners.find(|c| c.corner == corner).map(|c| &c.total)
    };
    let corner = |equal_limbs, true_parameters| Corner {
        equal_limbs,
        true_parameters,
    };
    let rate = |watched: Option<&Watched>| watched.map(rate);
    let equal = d.corners.iter().find(|c| c.corner == corner(true, false));
    let linear = equal.and_then(|c| c.courses.iter().find(|w| w.course == Some(Course::Linear)));
    let shipped = d.corners.first();
    let said = shipped.map_or_else(String::new, |c| said(&c.total));
    text.value("watched", d)
        .value("watched_shipped", total(corner(false, false)))
        .value("watched_rate", rate(total(corner(false, false))))
        .value("watched_exact_rate", rate(total(corner(true, true))))
        .value("watched_equal_rate", rate(total(corner(true, false))))
        .value("watched_equal_linear_rate", rate(linear))
        .value("watched_said", said)
        .table("watched-corners", corners(d))
        .table("watched-courses", courses(d))
}

/// Verdicts by what they say, the most frequent first.
fn said(watched: &Watched) -> String {
    let mut said: Vec<(&String, &u64)> = watched.said.iter().collect();
    said.sort_by_key(|(_, times)| core::cmp::Reverse(**times));
    let said: Vec<String> = said
        .into_iter()
        .map(|(words, times)| format!("“{words}” {}", count(*times)))
        .collect();
    said.join(", ")
}

/// Alarms an hour with their number and interval.
fn rate(w: &Watched) -> String {
    let (rate, alarms) = (significant(w.per_alarm_hour(), 2), count(w.alarms));
    format!("{rate} ({alarms} alarms, {})", interval(w))
}

fn interval(w: &Watched) -> String {
    let [low, high] = w.per_alarm_hour_95().map(|end| significant(end, 2));
    format!("{low} to {high}")
}

fn corners(d: &WatchedLaboratories) -> Table {
    Table::of("limbs, and what the monitor is told", &d.corners, name)
        .col("laboratories", |c| count(c.total.sessions))
        .col("with an alarm", |c| count(c.total.sessions_with_alarm))
        .col("hours", |c| fixed(c.total.hours, 1))
        .col("unflagged", |c| fixed(c.total.alarm_hours(), 1))
        .col("alarms", |c| count(c.total.alarms))
        .col("an hour unflagged", |c| {
            significant(c.total.per_alarm_hour(), 2)
        })
        .col(("95 %", "Poisson"), |c| interval(&c.total))
        .col("answers flagged", |c| percent(c.total.flagged_share, 2))
        .into()
}

fn name(c: &&WatchedCorner) -> String {
    let limbs = match c.corner.equal_limbs {
        true => "equally stiff",
        false => "unequal",
    };
    let told = match c.corner.true_parameters {
        true => "the truth, exactly",
        false => "the calibration, as shipped",
    };
    format!("{limbs}; {told}")
}

fn courses(d: &WatchedLaboratories) -> Table {
    let names = |course: Course| match course {
        Course::Rest => "rest",
        Course::Linear => "rig, linear",
        Course::Angular => "rig, angular",
        Course::Compound => "rig, compound",
        Course::Calm => "tumble, calm",
        Course::Brisk => "tumble, brisk",
        Course::Shaken => "tumble, shaken",
    };
    let shipped = d.corners.first().map_or(&[][..], |c| &c.courses);
    Table::of("motion", shipped, |w| {
        w.course.map_or("all", names).to_owned()
    })
    .col("recordings", |w| count(w.recordings))
    .col("with an alarm", |w| count(w.recordings_with_alarm))
    .col("hours", |w| fixed(w.hours, 1))
    .col("unflagged", |w| fixed(w.alarm_hours(), 1))
    .col("alarms", |w| count(w.alarms))
    .col("an hour unflagged", |w| significant(w.per_alarm_hour(), 2))
    .col(("95 %", "Poisson"), |w| interval(w))
    .col("answers flagged", |w| percent(w.flagged_share, 2))
    .into()
}
