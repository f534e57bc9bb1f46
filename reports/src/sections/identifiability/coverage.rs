//! Whether the stated intervals hold what they say, and how near the joint fit comes to the bound.

use sixaxis_calibration::page::labels::symbol;
use sixaxis_campaign::statistics::{Estimator, ParameterSummary};
use sixaxis_page::{Axis, Figure, Text};

use sixaxis_props::blind::share::Share;
use sixaxis_props::results::{Campaign, MujocoCampaign, Published, RoomIntervals, Rooms};
use sixaxis_reference::laboratory::room::Room;

/// What 95 % intervals are wanted to hold.
pub const BAND: (f64, f64) = (0.94, 0.96);
/// The same of sessions in ordinary rooms.
const ROOM_BAND: (f64, f64) = (0.93, 0.97);
/// Standard deviations of a ratio of variances that are drawn as its scatter.
const SCATTER: f64 = 2.0;

/// Values and figures.
pub fn fill(text: Text, campaign: &Campaign, played: &MujocoCampaign, rooms: &Rooms) -> Text {
    let all = campaign.parameters.iter();
    let fitted: Vec<&ParameterSummary> = all.filter(|p| p.joint.is_some()).collect();
    let determined = played.summary.step_4.get("determined").copied();
    let determined = determined.unwrap_or(0);
    let stiffness = played.summary.parameters.last();
    let stiffness = stiffness.and_then(|p| p.joint.as_ref());
    let shares = fitted
        .iter()
        .filter_map(|p| p.joint.as_ref()?.within_stated_95);
    let told = fitted.iter().filter_map(|p| p.joint_gain_known.as_ref());
    let cases = told.map(|joint| joint.cases).min().unwrap_or(0);
    let played_fitted = played.summary.parameters.iter();
    let played_fitted: Vec<_> = played_fitted.filter(|p| p.joint.is_some()).collect();
    let held = |p: &&ParameterSummary| Some((symbol(p.parameter), p.four_steps.within_stated_95?));
    let mut lowest: Vec<_> = played_fitted.iter().filter_map(held).collect();
    lowest.sort_by(|a, b| a.1.value.total_cmp(&b.1.value));
    let lowest = lowest.first();
    // Variance of a mean of n squares of a normal variable.
    let scatter = (2.0_f64 / cases.max(1) as f64).sqrt();
    text.value("campaign", campaign)
        .value("campaign_make", Campaign::MAKE)
        .value("played", played)
        .value("played_make", MujocoCampaign::MAKE)
        .value(
            "played_lowest",
            lowest.map(|(name, share)| (name, share.value)),
        )
        .value(
            "played_scatter",
            (0.95_f64 * 0.05 / played.summary.cases.max(1) as f64).sqrt(),
        )
        .figure(coverage("coverage-by-parameter-mujoco", &played_fitted))
        .value("stiffness_fitted", stiffness.map_or(0, |joint| joint.cases))
        .value(
            "step_4",
            Share::new(determined as usize, played.summary.cases as usize),
        )
        .value(
            "coverage_scatter",
            shares.map(|share| share.standard_error).fold(0.0, f64::max),
        )
        .value("variance_scatter", scatter)
        .value("variance_cases", cases)
        .figure(coverage("coverage-by-parameter", &fitted))
        .value("rooms", rooms)
        .value("rooms_make", Rooms::MAKE)
        .value("room_scatter", {
            let sessions = rooms.rooms.iter().map(|room| room.by_joint_fit).min();
            (0.95_f64 * 0.05 / sessions.unwrap_or(0).max(1) as f64).sqrt()
        })
        .figure(in_rooms(rooms))
        .figure(variance(&fitted, SCATTER * scatter))
}

/// A row for each parameter.
fn by_parameter(id: &str, x: Axis, fitted: &[&ParameterSummary]) -> Figure {
    let names = fitted.iter().map(|p| symbol(p.parameter));
    Figure::new(id, "", x, Axis::names("parameter", names))
}

fn coverage(id: &str, fitted: &[&ParameterSummary]) -> Figure {
    let points = |of: fn(&ParameterSummary) -> Option<&Estimator>| {
        let shares = fitted.iter().enumerate();
        shares.filter_map(move |(i, p)| Some((100.0 * of(p)?.within_stated_95?.value, i as f64)))
    };
    let x = Axis::linear("share of cases", "%");
    by_parameter(id, x, fitted)
        .points("joint fit", 0, points(|p| p.joint.as_ref()))
        .points("four steps", 3, points(|p| Some(&p.four_steps)))
        .vertical(100.0 * BAND.0, "94")
        .vertical(100.0 * BAND.1, "96")
}

/// The joint fit's intervals of what it determines in each room.
fn in_rooms(rooms: &Rooms) -> Figure {
    let stated = |parameter: &&RoomIntervals| parameter.held.of > 0;
    let names = rooms
        .rooms
        .first()
        .into_iter()
        .flat_map(|room| &room.intervals);
    let names = names.filter(stated).map(|p| symbol(p.parameter));
    let x = Axis::linear("share of sessions", "%");
    let figure = Figure::new("coverage-in-rooms", "", x, Axis::names("parameter", names));
    let figure = rooms.rooms.iter().fold(figure, |figure, room| {
        let (name, hue) = match room.room {
            Room::Gentle => ("gentle room", 0),
            Room::Usual => ("usual room", 3),
        };
        let shares = room.intervals.iter().filter(stated).enumerate();
        let points = shares.map(|(i, p)| (100.0 * p.held.value(), i as f64));
        figure.points(name, hue, points)
    });
    figure
        .vertical(100.0 * ROOM_BAND.0, "93")
        .vertical(100.0 * ROOM_BAND.1, "97")
}

fn variance(fitted: &[&ParameterSummary], scatter: f64) -> Figure {
    let ratio = |p: &ParameterSummary| p.joint_gain_known.as_ref()?.variance_over_stated;
    let ratios = fitted.iter().enumerate();
    let ratios = ratios.filter_map(|(i, p)| Some((ratio(p)?, i as f64)));
    let x = Axis::linear("variance over stated", "");
    by_parameter("variance-over-bound", x, fitted)
        .points("joint fit, told the accelerometer's gain", 0, ratios)
        .vertical(1.0 - scatter, "−2σ")
        .vertical(1.0, "")
        .vertical(1.0 + scatter, "+2σ")
}
