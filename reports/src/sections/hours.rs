//! How long ground axes stay true: hours of motion, open loop and with what else is known of them.

use anyhow::Result;
use sixaxis_core::significance::chi_square_limit;
use sixaxis_page::number::{count, fixed, significant};
use sixaxis_page::{Axis, Figure, Section, Table, Text};
use sixaxis_props::results::{AidedRide, Aids, Halved, Hours, MujocoHours, Published, Steady};
use sixaxis_reference::rig::journey::Kind;

use super::DEG_PER_RAD;

/// The section.
///
/// # Errors
/// If the published result cannot be read or the text does not fit it.
pub fn section() -> Result<Section> {
    let p = &Hours::embedded()?;
    let m = &MujocoHours::embedded()?;
    let halved = |of: fn(&Halved) -> f64| m.halved.iter().map(of).fold(0.0, f64::max);
    let freedom = 3 * p.runs as usize;
    let limit = |tail| chi_square_limit(tail, freedom).map(|limit| limit / freedom as f64);
    let text = Text::new(include_str!("hours.md"))
        .value("p", p)
        .value("known_deg", p.known_rad * DEG_PER_RAD)
        .value("chance", [limit(0.975)?, limit(0.025)?])
        .value("last_seed", p.first_seed + p.runs - 1)
        .value("lost", lost(p))
        .value("m", m)
        .value("m_last_seed", m.hours.first_seed + m.hours.runs - 1)
        .value("force", halved(|kind| kind.force_m_s2))
        .value("attitude", halved(|kind| kind.attitude_rad));
    let kinds = p.rides.chunk_by(|a, b| a.kind == b.kind);
    kinds
        .fold(text, |text, rides| text.figure(errors(rides, p.runs)))
        .table("hours-deviations", deviations(p))
        .table("hours-bounds", bounds(p))
        .table("hours-mujoco", deviations(&m.hours))
        .section("hours")
}

/// Which rides lost runs that ended on an error, in words: how many were left when the first were missing, and at the end.
fn lost(p: &Hours) -> Vec<String> {
    let words = |ride: &AidedRide| {
        let followed = ride.at.iter();
        let followed = followed.filter_map(|at| Some((at.time_s, at.linear_m_s2?.count as u64)));
        let fewer: Vec<_> = followed.filter(|(_, left)| *left < p.runs).collect();
        let ((first_s, left), (last_s, at_last)) = (fewer.first()?, fewer.last()?);
        Some(format!(
            "of {} runs “{}” {left} at {} s, {at_last} at {} s",
            p.runs,
            name(ride),
            fixed(*first_s, 0),
            fixed(*last_s, 0),
        ))
    };
    p.rides.iter().filter_map(words).collect()
}

/// Medians of all runs: where some are missing they would be of those that went well.
fn errors(rides: &[AidedRide], runs: u64) -> Figure {
    let figure = Figure::new(
        format!("hours-{}", id(rides[0].kind)),
        "",
        Axis::log("time", "s"),
        Axis::log("error of a", "m/s²"),
    );
    rides.iter().fold(figure, |figure, ride| {
        let medians = ride.at.iter().filter_map(|at| {
            let errors = at.linear_m_s2.filter(|e| e.count as u64 == runs)?;
            Some((at.time_s, errors.median))
        });
        // The same colour for the same aid in every figure.
        let own = ride.aids.rests || ride.aids.velocity.is_some();
        let colour = usize::from(own) + 2 * usize::from(ride.aids.attitude.is_some());
        figure.line_points(aids(&ride.aids), colour, medians)
    })
}

fn deviations(p: &Hours) -> Table {
    Table::of("motion, aids", &p.rides, |r| name(r))
        .col(("known to the end", "runs"), |r| count(r.known_to_the_end))
        .col(("others known for", "s"), |r| {
            r.unknown_from_s
                .map_or_else(|| "—".to_owned(), |time_s| significant(time_s, 2))
        })
        .col("components", |r| count(r.components))
        .col(("beyond three", "%"), |r| {
            fixed(
                100.0 * r.beyond_three as f64 / r.components.max(1) as f64,
                2,
            )
        })
        .col(("largest", "deviations"), |r| optional(r.largest, 1))
        .col(("attitude²", "over variance"), |r| over_variance(r, 0))
        .col(("rate²", "over variance"), |r| over_variance(r, 1))
        .into()
}

fn bounds(p: &Hours) -> Table {
    let bounded = p.rides.iter().filter(|r| r.stated.is_some());
    let tilt = |of: Option<Steady>| optional(of.map(|s| s.tilt_rad * DEG_PER_RAD), 2);
    let rate = |of: Option<Steady>| optional(of.map(|s| 1e3 * s.rate_rad_s), 2);
    Table::of("motion, aids", bounded, |r| name(r))
        .col(("tilt: bound", "°"), move |r| tilt(r.bound))
        .col(("stated", "°"), move |r| tilt(r.stated))
        .col(("attained", "°"), move |r| tilt(r.attained))
        .col(("rate: bound", "mrad/s"), move |r| rate(r.bound))
        .col(("stated", "mrad/s"), move |r| rate(r.stated))
        .col(("attained", "mrad/s"), move |r| rate(r.attained))
        .into()
}

fn name(ride: &AidedRide) -> String {
    let kind = match ride.kind {
        Kind::Still => "still",
        Kind::TumbleWithRests => "tumble",
        Kind::Shaken => "shaken",
        Kind::Vehicle => "vehicle",
        Kind::PickAndPlace => "pick and place",
    };
    format!("{kind}, {}", aids(&ride.aids))
}

const fn id(kind: Kind) -> &'static str {
    match kind {
        Kind::Still => "still",
        Kind::TumbleWithRests => "tumble",
        Kind::Shaken => "shaken",
        Kind::Vehicle => "vehicle",
        Kind::PickAndPlace => "pick-and-place",
    }
}

fn aids(aids: &Aids) -> String {
    let named = [
        (aids.rests, "rests"),
        (aids.velocity.is_some(), "velocity"),
        (aids.attitude.is_some(), "camera"),
    ];
    let used: Vec<&str> = named
        .into_iter()
        .filter_map(|(used, name)| used.then_some(name))
        .collect();
    if used.is_empty() {
        "open loop".to_owned()
    } else {
        used.join(" and ")
    }
}

fn over_variance(ride: &AidedRide, which: usize) -> String {
    let last = ride.at.last().and_then(|at| at.over_variance);
    optional(last.map(|both| both[which]), 2)
}

fn optional(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(|| "—".to_owned(), |value| fixed(value, digits))
}
