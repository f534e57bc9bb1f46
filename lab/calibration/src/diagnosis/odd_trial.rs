//! Trials that do not fit in with the others, and why.

use glam::DVec3;
use nalgebra::{Matrix3, Vector3};
use sixaxis_core::LIMBS;

use super::TrialCase;
use super::level::{cause_of, is_thousand};
use super::structure::departure;
use super::table::Table;
use crate::finding::{Cause, Finding};
use crate::response::Response;

/// Departure, relative to the trial's own size, that is noticed: a wedge half a degree off.
pub const NOTICED: f64 = 0.01;
/// Share of the departure that may be left once a cause is taken into account.
const LEFT: f64 = 0.1;
/// Angle from which a wedge is called loose, degrees; what is below is its workshop's tolerance.
const LOOSE_DEG: f64 = 0.7;
/// Times its standard error that a departure must exceed.
const SIGNIFICANT: f64 = 6.0;
/// Share of a trial's signal that its fit may leave unexplained.
const RESIDUAL: f64 = 0.02;

/// What explains a trial's departure.
struct Explanation {
    cause: Cause,
    channels: Vec<usize>,
    evidence: String,
    advice: String,
}

/// Looks at every trial by itself. Returns each one's departure from the table.
pub fn examine(
    table: &Table,
    cases: &mut [TrialCase<'_>],
    findings: &mut Vec<Finding>,
) -> Vec<Option<f64>> {
    let departures: Vec<Option<f64>> = cases.iter().map(|s| departure(table, s)).collect();
    // Trials of one cause and one direction make one finding: a wedge is loose in all of them.
    let mut told: Vec<(DVec3, Finding)> = Vec::new();
    for (case, departure) in cases.iter().zip(&departures) {
        let (Some(departure), Some(response)) = (departure, &case.response) else {
            continue;
        };
        if case.explained {
            continue;
        }
        let explanation = if *departure > NOTICED + SIGNIFICANT * noise(table, case, response) {
            explain(table, case, response, *departure)
        } else {
            unexplained_in_time(table, case, response)
        };
        let Some(explanation) = explanation else {
            continue;
        };
        let direction = case.trial.direction_ground;
        let known = told.iter_mut().find(|(d, finding)| {
            finding.cause == explanation.cause
                && finding.channels == explanation.channels
                && (explanation.cause != Cause::LooseWedge || *d == direction)
        });
        match known {
            Some((_, finding)) => finding.recordings.push(case.trial.name.clone()),
            None => told.push((
                direction,
                Finding {
                    cause: explanation.cause,
                    recordings: vec![case.trial.name.clone()],
                    channels: explanation.channels,
                    evidence: explanation.evidence,
                    advice: explanation.advice,
                },
            )),
        }
    }
    findings.extend(told.into_iter().map(|(_, finding)| finding));
    departures
}

fn explain(
    table: &Table,
    case: &TrialCase<'_>,
    response: &Response,
    departure: f64,
) -> Option<Explanation> {
    let (seen, expected) = table.compare(case, response);
    let counts: Vec<usize> = (0..LIMBS)
        .filter(|i| !case.ignored[*i] && !table.silent[*i])
        .collect();
    let size = table.size(case, response, &expected);
    let rest = |of: &dyn Fn(usize) -> f64| -> f64 {
        counts
            .iter()
            .map(|i| (seen[*i] - of(*i)).powi(2))
            .sum::<f64>()
            .sqrt()
            / size
    };
    let enough = (LEFT * departure).max(0.5 * NOTICED);
    // One factor on all channels.
    let product: f64 = counts.iter().map(|i| seen[*i] * expected[*i]).sum();
    let squares: f64 = counts.iter().map(|i| expected[*i] * expected[*i]).sum();
    let common = product / squares;
    if rest(&|i| common * expected[i]) < enough {
        return Some(Explanation {
            cause: cause_of(common),
            channels: Vec::new(),
            evidence: format!(
                "all channels are {common:.4} times what the other trials make one expect"
            ),
            advice: "check this recording's gains and units, and the sensitivity of the standard"
                .to_owned(),
        });
    }
    // One channel.
    let worst = counts
        .iter()
        .copied()
        .max_by(|a, b| {
            let off = |i: usize| (seen[i] - expected[i]).abs();
            off(*a).total_cmp(&off(*b))
        })
        .unwrap_or(0);
    if rest(&|i| if i == worst { seen[i] } else { expected[i] }) < enough {
        let factor = seen[worst] / expected[worst];
        let (cause, advice) = if (factor + 1.0).abs() < 0.1 {
            (
                Cause::InvertedChannel,
                "check the channel's polarity in this recording",
            )
        } else if is_thousand(factor) {
            (
                Cause::MillivoltMixUp,
                "check the channel's unit in this recording",
            )
        } else if factor.abs() < 0.03 {
            (
                Cause::DeadLimb,
                "check the channel's cable in this recording",
            )
        } else {
            (
                Cause::WrongScaling,
                "check the channel's gain_n_per_v in this recording against the amplifier's panel",
            )
        };
        return Some(Explanation {
            cause,
            channels: vec![worst + 1],
            evidence: format!(
                "the channel shows {factor:.4} times what the other trials make one expect, the others agree"
            ),
            advice: advice.to_owned(),
        });
    }
    // Two channels exchanged in this recording alone: the gain stays with the amplifier, the limb comes along.
    for (n, a) in counts.iter().copied().enumerate() {
        for b in counts[n + 1..].iter().copied() {
            let h = &table.mass_over_scale_kg;
            let other = |own: usize, from: usize| expected[from] * h[from] / h[own];
            let with = |i: usize| {
                if i == a {
                    other(a, b)
                } else if i == b {
                    other(b, a)
                } else {
                    expected[i]
                }
            };
            if rest(&with) < enough {
                return Some(Explanation {
                    cause: Cause::SwappedChannels,
                    channels: vec![a + 1, b + 1],
                    evidence: "exchanged in this recording, the two agree with the other trials"
                        .to_owned(),
                    advice: "check the plugs, or give this recording its own [recording.channels]"
                        .to_owned(),
                });
            }
        }
    }
    // Another direction.
    if let Some((direction, left)) = direction(table, response, &counts, &seen, size)
        && left < enough
    {
        let d = case.trial.direction_ground;
        let angle = direction.normalize().angle_between(d).to_degrees();
        if angle <= LOOSE_DEG {
            return None;
        }
        {
            let v = direction.normalize();
            return Some(Explanation {
                cause: Cause::LooseWedge,
                channels: Vec::new(),
                evidence: format!(
                    "the channels show motion along ({:.3}, {:.3}, {:.3}), {angle:.1}° from the stated direction",
                    v.x, v.y, v.z
                ),
                advice: "tighten the wedge and repeat, or check the stated direction".to_owned(),
            });
        }
    }
    if counts
        .iter()
        .filter(|i| (seen[**i] - expected[**i]).abs() > 0.5 * NOTICED * size)
        .count()
        >= 3
    {
        Some(Explanation {
            cause: Cause::ForeignTrial,
            channels: Vec::new(),
            evidence: format!(
                "the channels depart by {:.1} % from what the other trials agree on, and neither a factor, an exchange nor another direction explains it",
                100.0 * departure
            ),
            advice: "check that this recording is this sensor's, in this state".to_owned(),
        })
    } else {
        Some(Explanation {
            cause: Cause::Unexplained,
            channels: Vec::new(),
            evidence: format!(
                "departs by {:.1} % from what the other trials agree on",
                100.0 * departure
            ),
            advice: "look at the trial's curves in the report, and repeat it".to_owned(),
        })
    }
}

/// Standard error of a trial's departure.
fn noise(table: &Table, case: &TrialCase<'_>, response: &Response) -> f64 {
    let (_, expected) = table.compare(case, response);
    let squares: f64 = (0..LIMBS)
        .filter(|i| !case.ignored[*i] && !table.silent[*i])
        .map(|i| (response.channels[i].standard_error / table.mass_over_scale_kg[i]).powi(2))
        .sum();
    squares.sqrt() / table.size(case, response, &expected)
}

/// The direction, not normalised, that the channels show, and what it leaves.
fn direction(
    table: &Table,
    response: &Response,
    counts: &[usize],
    seen: &[f64; LIMBS],
    size: f64,
) -> Option<(DVec3, f64)> {
    let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for &i in counts {
        let share = Vector3::from(table.share(i, response).to_array());
        normal += share * share.transpose();
        right += share * seen[i];
    }
    let d = normal.try_inverse()? * right;
    let d = DVec3::new(d[0], d[1], d[2]);
    let left = counts
        .iter()
        .map(|&i| (seen[i] - table.share(i, response).dot(d)).powi(2))
        .sum::<f64>()
        .sqrt();
    Some((d, left / size))
}

/// A trial whose amplitudes agree but whose course does not.
fn unexplained_in_time(
    table: &Table,
    case: &TrialCase<'_>,
    response: &Response,
) -> Option<Explanation> {
    let over = |get: fn(&crate::response::ChannelResponse) -> f64| -> f64 {
        (0..LIMBS)
            .filter(|i| !case.ignored[*i] && !table.silent[*i])
            .map(|i| (get(&response.channels[i]) / table.mass_over_scale_kg[i]).powi(2))
            .sum::<f64>()
            .sqrt()
    };
    // Weight was taken off by an angle that is as good as the gyroscope; what is left of it is no news.
    let known = table.weight_left_m_s2(case, response) / RESIDUAL;
    let share = over(|c| c.residual_n) / (over(|c| c.signal_n) + known);
    (share > RESIDUAL).then(|| Explanation {
        cause: Cause::Unexplained,
        channels: Vec::new(),
        evidence: format!(
            "{:.1} % of the signal follows neither the standards nor any fault that is known",
            100.0 * share
        ),
        advice: "look at the trial's curves in the report, and repeat it".to_owned(),
    })
}
