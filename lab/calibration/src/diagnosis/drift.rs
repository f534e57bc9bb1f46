//! Rests that are not where they were: a run begins and ends at rest, so that whatever differs between its ends is drift.

use sixaxis_core::LIMBS;
use sixaxis_core::identify::zero_drift::ZeroDrift;

use super::odd_trial;
use super::structure::departure;
use super::table::Table;
use super::trial_case::TrialCase;
use crate::conditioning::Conditioned;
use crate::finding::{Cause, Finding};
use crate::response::Response;
use crate::series::{mean_of, median};
use crate::trial::Trial;

/// Drift, relative to the largest force of any channel in the trial, that is noticed.
const NOTICED: f64 = 4e-3;
/// Drift of a static record, relative to the converter's range, that is noticed.
const NOTICED_AT_REST: f64 = 1e-4;
/// Times its standard error that a drift must exceed.
const SIGNIFICANT: f64 = 8.0;
/// Standard deviations by which noise moves a zero where a high-pass is undone.
pub(crate) const WANDERS: f64 = 5.0;
/// Residuals of the fit by which a mean over a short rest may be off.
const CONTRADICTS: f64 = 4.0;
/// Share of their peak below which the standards say that nothing moves.
const AT_REST: f64 = 0.01;
/// Samples from which a rest is one.
const FEWEST_AT_REST: usize = 8;
/// Pieces of a static record whose means are compared.
const PIECES: usize = 16;

/// Parts of a static record, one of which somebody may have touched.
const PARTS: usize = 64;
/// Parts at either end in which a drift is highest.
const ENDS: usize = 3;
/// Times the parts' median distance from their median that a part must be off: a drift along a line has twice at its ends.
const HIGH: f64 = 20.0;

/// Looks at the course of the static record.
pub fn examine_static(rest: &Trial, findings: &mut Vec<Finding>) {
    let dead: [bool; LIMBS] = core::array::from_fn(|channel| {
        findings.iter().any(|finding| {
            finding.cause == Cause::DeadLimb && finding.concerns(&rest.name, channel + 1)
        })
    });
    let alive = (0..LIMBS).filter(|channel| !dead[*channel]);
    let bumps = alive.filter_map(|channel| Some((channel, bump(rest, channel)?)));
    let bumps: Vec<(usize, Bump)> = bumps.collect();
    let highest = bumps
        .iter()
        .max_by(|(_, a), (_, b)| a.height_v.abs().total_cmp(&b.height_v.abs()));
    if let Some((_, highest)) = highest {
        let evidence = format!(
            "about {:.0} s after its beginning the static record stands {:+.1} mV off the rest of it for a while",
            highest.from_s,
            1e3 * highest.height_v
        );
        let advice = "nobody must touch the sensor while it is at rest: record at rest again";
        let finding = Finding::new(Cause::Unreadable, evidence, advice).in_trial(rest);
        findings.push(if bumps.len() > LIMBS / 2 {
            finding
        } else {
            finding.on_channels(bumps.iter().map(|(channel, _)| *channel))
        });
        return;
    }
    let alive = (0..LIMBS).filter(|channel| !dead[*channel]);
    let wanders = alive.filter_map(|channel| Some((channel, course(rest, channel)?)));
    let (channels, changes_v): (Vec<usize>, Vec<f64>) = wanders.unzip();
    let most = changes_v
        .into_iter()
        .max_by(|a, b| a.abs().total_cmp(&b.abs()));
    if let Some(most_v) = most {
        let what = match channels.len() {
            1 => "the zero wanders by",
            _ => "the zeros wander by up to",
        };
        let evidence = format!("{what} {:.2} mV during the static record", 1e3 * most_v);
        let advice = "let sensor and amplifiers warm up, then record at rest again";
        let finding = Finding::new(Cause::DriftDuringRun, evidence, advice);
        findings.push(finding.in_trial(rest).on_channels(channels));
    }
}

/// Looks at the ends of all runs.
pub fn examine(
    drift: Option<&ZeroDrift>,
    table: Option<&Table>,
    cases: &mut [TrialCase<'_>],
    findings: &mut Vec<Finding>,
) {
    // A zero that the static record has not, or not throughout, is off in every run.
    let of_the_record: Vec<usize> = findings
        .iter()
        .filter(|finding| finding.cause == Cause::DriftDuringRun)
        .flat_map(|finding| finding.channels.clone())
        .collect();
    // A record at rest that is none, or another sensor's, says nothing of the zeros before a run.
    let is_of_a_case = |name: &String| cases.iter().any(|case| case.trial.name == *name);
    let is_of_the_record = |f: &Finding| {
        let whole = f.cause == Cause::Unreadable && f.channels.is_empty();
        whole && !f.recordings.is_empty() && !f.recordings.iter().any(is_of_a_case)
    };
    let drift = drift.filter(|_| !findings.iter().any(is_of_the_record));
    for case in cases.iter_mut() {
        let Some(response) = &case.response else {
            continue;
        };
        if case.explained {
            continue;
        }
        // In a trial of another scale or another sensor the zero is another, too, and that is not the news.
        let fits_in = table
            .and_then(|table| departure(table, case))
            .is_some_and(|departure| departure < odd_trial::NOTICED);
        let largest = response
            .channels
            .iter()
            .map(|c| c.response.abs() * response.peak)
            .fold(0.0, f64::max)
            .max(weight_left_n(case, response, table) / NOTICED);
        for channel in 0..LIMBS {
            if case.ignored[channel] {
                continue;
            }
            let own = &response.channels[channel];
            let gain = case.trial.gains.gain_n_per_v[channel];
            let limit = NOTICED * largest;
            let ends = ends_n(case, channel);
            let wander_n = WANDERS * case.conditioned.zero_wander_v[channel] * gain.abs();
            let by_fit = own.drift_n.abs() > limit + SIGNIFICANT * own.drift_error_n + wander_n;
            // In a trial that fits in with the others the fit's word is enough. In one that does not, what looks like drift may be
            // what makes it odd: then the ends have to say so, too.
            let by_ends = fits_in
                || ends
                    .is_some_and(|(_, change)| change.abs() > limit && change * own.drift_n > 0.0);
            let by_level = drift.is_some()
                && !of_the_record.contains(&(channel + 1))
                && fits_in
                && ends.is_some_and(|(level, _)| {
                    level.abs() > 2.0 * limit + CONTRADICTS * own.residual_n
                });
            if (by_fit && by_ends) || by_level {
                let (level, _) = ends.unwrap_or((0.0, 0.0));
                let (what, size) = if by_fit && by_ends {
                    ("during the run", own.drift_n)
                } else {
                    ("between the static record and the run", level)
                };
                let evidence = format!(
                    "the zero moves by {:.1} mV {what}, {:.1} % of the largest signal",
                    1e3 * size / gain,
                    100.0 * size.abs() / largest
                );
                let advice = "warm up and repeat the trial, and record at rest right before it";
                let finding = Finding::new(Cause::DriftDuringRun, evidence, advice);
                findings.push(finding.in_trial(case.trial).on_channels([channel]));
                case.ignored[channel] = true;
            }
        }
    }
}

/// What the error of the angle leaves of turning weight in a channel's force, N.
fn weight_left_n(case: &TrialCase<'_>, response: &Response, table: Option<&Table>) -> f64 {
    let Some(table) = table else {
        return 0.0;
    };
    let heaviest = (0..LIMBS)
        .map(|i| table.mass_over_scale_kg[i].abs())
        .fold(0.0, f64::max);
    heaviest * table.weight_left_m_s2(case, response)
}

/// Level at the beginning of the run and its change until the end, N; none for a recording that does not begin and end at rest.
fn ends_n(case: &TrialCase<'_>, channel: usize) -> Option<(f64, f64)> {
    let (first, last) = rests(case.conditioned)?;
    let before = mean_of(&case.force_n[..first], channel);
    let after = mean_of(&case.force_n[case.force_n.len() - last..], channel);
    Some((before, after - before))
}

/// Samples at the beginning and at the end of a run in which the standards say that nothing moves; none for a recording that does not begin
/// and end at rest.
pub(crate) fn rests(conditioned: &Conditioned) -> Option<(usize, usize)> {
    let peak = |series: &[glam::DVec3]| series.iter().map(|v| v.length()).fold(0.0, f64::max);
    let limits = [
        AT_REST * peak(&conditioned.linear_ground_m_s2),
        AT_REST * peak(&conditioned.rate_shell_rad_s),
    ];
    let rests = |row: &usize| {
        conditioned.linear_ground_m_s2[*row].length() <= limits[0]
            && conditioned.rate_shell_rad_s[*row].length() <= limits[1]
    };
    let samples = conditioned.voltage_v.len();
    let first = (0..samples).take_while(rests).count();
    let last = (0..samples).rev().take_while(rests).count();
    (first.min(last) >= FEWEST_AT_REST && first < samples).then_some((first, last))
}

/// Samples of each of so many pieces of a static channel, and the pieces' means, V; none of a record that is too short.
fn means(rest: &Trial, channel: usize, pieces: usize) -> Option<(usize, Vec<f64>)> {
    let per_piece = rest.voltage_v.len() / pieces;
    (per_piece > 1).then(|| {
        let all = rest.voltage_v.chunks_exact(per_piece).take(pieces);
        let means = all.map(|piece| mean_of(piece, channel));
        (per_piece, means.collect())
    })
}

/// A part of a static channel that stands elsewhere.
struct Bump {
    from_s: f64,
    height_v: f64,
}

/// The highest of a channel, if it exceeds what the other parts scatter by.
fn bump(rest: &Trial, channel: usize) -> Option<Bump> {
    let (per_piece, means) = means(rest, channel, PARTS)?;
    let middle = median(means.iter().copied())?;
    let away: Vec<f64> = means.iter().map(|mean| (mean - middle).abs()).collect();
    let usual = median(away.iter().copied())?;
    let highest = (0..means.len()).max_by(|a, b| away[*a].total_cmp(&away[*b]))?;
    // What is high at an end drifts.
    let inside = (ENDS..means.len().saturating_sub(ENDS)).contains(&highest);
    (inside && away[highest] > HIGH * usual && away[highest] > NOTICED_AT_REST * rest.full_scale_v)
        .then(|| Bump {
            from_s: (highest * per_piece) as f64 / rest.sample_rate_hz,
            height_v: means[highest] - middle,
        })
}

/// Change of a static channel along the line through its pieces' means, V, if it exceeds their noise.
fn course(rest: &Trial, channel: usize) -> Option<f64> {
    let (_, means) = means(rest, channel, PIECES)?;
    // Line through the pieces' means, judged by what neighbours differ by: a warm-up is no line, and its bend no noise.
    let n = PIECES as f64;
    let middle = (n - 1.0) / 2.0;
    let squares = n * (n * n - 1.0) / 12.0;
    let slope = means
        .iter()
        .enumerate()
        .map(|(i, m)| (i as f64 - middle) * m)
        .sum::<f64>()
        / squares;
    let scatter = means
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).powi(2))
        .sum::<f64>()
        / (2.0 * (n - 1.0));
    let change = slope * (n - 1.0);
    let error = (scatter / squares).sqrt() * (n - 1.0);
    (change.abs() > SIGNIFICANT * error && change.abs() > NOTICED_AT_REST * rest.full_scale_v)
        .then_some(change)
}
