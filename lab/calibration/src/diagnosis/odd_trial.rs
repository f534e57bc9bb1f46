//! Trials that do not fit in with the others, and why.

use glam::DVec3;
use nalgebra::{Matrix3, Vector3};
use sixaxis_core::LIMBS;

use super::level::{cause_of, of_one_channel};
use super::structure::departure;
use super::table::Table;
use super::trial_case::TrialCase;
use crate::finding::{Cause, Finding};
use crate::response::Response;
use crate::trial::Trial;

/// Departure, relative to the trial's own size, that is noticed: a wedge half a degree off.
pub const NOTICED: f64 = 0.01;
/// How near to -1 a factor on all channels is of a motion the other way.
const OPPOSITE: f64 = 0.1;
/// Share of the departure that may be left once a cause is taken into account.
const LEFT: f64 = 0.1;
/// Angle from which a wedge is called loose, degrees; what is below is its workshop's tolerance.
const LOOSE_DEG: f64 = 0.7;
/// Times its standard error that a departure must exceed.
const SIGNIFICANT: f64 = 6.0;
/// Share of a trial's signal that its fit may leave unexplained.
const RESIDUAL: f64 = 0.02;

/// Factor within which a direction that the channels show is a unit vector's: a wedge does not scale.
const LENGTH: f64 = 1.25;
/// Largest share of the trials that may be another sensor's.
const AMONG: f64 = 0.25;

/// Looks at every trial by itself. Returns each one's departure from the table.
pub fn examine(
    table: &Table,
    cases: &mut [TrialCase<'_>],
    findings: &mut Vec<Finding>,
) -> Vec<Option<f64>> {
    let departures: Vec<Option<f64>> = cases.iter().map(|s| departure(table, s)).collect();
    // Trials of one cause and one direction make one finding: a wedge is loose in all of them.
    let mut told: Vec<(DVec3, Finding)> = Vec::new();
    let all: Vec<&Trial> = cases.iter().map(|case| case.trial).collect();
    for (case, departure) in cases.iter().zip(&departures) {
        let (Some(departure), Some(response)) = (departure, &case.response) else {
            continue;
        };
        if case.explained {
            continue;
        }
        let found = if *departure > NOTICED + SIGNIFICANT * noise(table, case, response) {
            explain(table, case, response, &all, *departure)
        } else {
            unexplained_in_time(table, case, response)
        };
        let Some(finding) = found else {
            continue;
        };
        let direction = case.trial.direction_ground;
        let known = told.iter_mut().find(|(d, known)| {
            known.cause == finding.cause
                && known.channels == finding.channels
                && known.advice == finding.advice
                && (finding.cause != Cause::LooseWedge || *d == direction)
        });
        match known {
            Some((_, known)) => known.recordings.extend(finding.recordings),
            None => told.push((direction, finding)),
        }
    }
    for (_, mut finding) in told {
        // Another sensor's trial is odd among many that agree. Where many do not, the others are no measure.
        let concerned = finding.recordings.len() as f64;
        if finding.cause == Cause::ForeignTrial && concerned > AMONG * cases.len() as f64 {
            finding.cause = Cause::Unexplained;
            "look at the curves of these trials in the report".clone_into(&mut finding.advice);
        }
        findings.push(finding);
    }
    departures
}

fn explain(
    table: &Table,
    case: &TrialCase<'_>,
    response: &Response,
    all: &[&Trial],
    departure: f64,
) -> Option<Finding> {
    let odd = Odd::new(table, case, response, departure);
    // A factor on all channels leaves nothing over of their course.
    let course = unexplained_in_time(table, case, response);
    let explained = odd
        .one_factor()
        .map(|factor| course.unwrap_or(factor))
        .or_else(|| odd.one_channel())
        .or_else(|| odd.exchanged())
        .or_else(|| odd.gains_of_another(all));
    if explained.is_some() {
        return explained;
    }
    match odd.other_direction(all) {
        OtherDirection::None => odd.gains_of_none(all).or_else(|| Some(odd.nothing_else())),
        OtherDirection::WithinPlay => None,
        OtherDirection::Loose(finding) => Some(finding),
    }
}

/// A trial that departs from the others, and what it is tried against.
struct Odd<'a> {
    table: &'a Table,
    case: &'a TrialCase<'a>,
    response: &'a Response,
    departure: f64,
    seen: [f64; LIMBS],
    expected: [f64; LIMBS],
    /// Channels that count.
    counts: Vec<usize>,
    size: f64,
}

/// Whether the trial moved in a direction other than the stated one.
enum OtherDirection {
    /// Another direction explains nothing.
    None,
    /// It explains the departure and lies within a wedge's play: not reported.
    WithinPlay,
    /// It explains it and is another wedge's.
    Loose(Finding),
}

impl<'a> Odd<'a> {
    fn new(
        table: &'a Table,
        case: &'a TrialCase<'a>,
        response: &'a Response,
        departure: f64,
    ) -> Self {
        let (seen, expected) = table.compare(case, response);
        Self {
            table,
            case,
            response,
            departure,
            seen,
            expected,
            counts: (0..LIMBS)
                .filter(|i| !case.ignored[*i] && !table.silent[*i])
                .collect(),
            size: table.size(case, response, &expected),
        }
    }

    /// What a hypothesis leaves of the departure, over the trial's size.
    fn rest(&self, of: &dyn Fn(usize) -> f64) -> f64 {
        self.counts
            .iter()
            .map(|i| (self.seen[*i] - of(*i)).powi(2))
            .sum::<f64>()
            .sqrt()
            / self.size
    }

    /// What a hypothesis may leave to be taken for the explanation.
    fn enough(&self) -> f64 {
        (LEFT * self.departure).max(0.5 * NOTICED)
    }

    /// One factor on all channels.
    fn one_factor(&self) -> Option<Finding> {
        let (seen, expected) = (&self.seen, &self.expected);
        let product: f64 = self.counts.iter().map(|i| seen[*i] * expected[*i]).sum();
        let squares: f64 = self
            .counts
            .iter()
            .map(|i| expected[*i] * expected[*i])
            .sum();
        let common = product / squares;
        (self.rest(&|i| common * expected[i]) < self.enough()).then(|| Finding {
            recordings: vec![self.case.trial.name.clone()],
            cause: cause_of(common),
            channels: Vec::new(),
            evidence: format!(
                "all channels are {common:.4} times what the other trials make one expect"
            ),
            advice: if (common + 1.0).abs() < OPPOSITE {
                "turn the sign of this recording's direction in the session, or see to the polarity of the standard"
            } else {
                "check this recording's gains and units, and the sensitivity of the standard"
            }
            .to_owned(),
        })
    }

    /// One channel.
    fn one_channel(&self) -> Option<Finding> {
        let (seen, expected) = (&self.seen, &self.expected);
        let off = |i: usize| (seen[i] - expected[i]).abs();
        let worst = self
            .counts
            .iter()
            .copied()
            .max_by(|a, b| off(*a).total_cmp(&off(*b)))
            .unwrap_or(0);
        let left = self.rest(&|i| if i == worst { seen[i] } else { expected[i] });
        if left >= self.enough() || left.is_nan() {
            return None;
        }
        let factor = seen[worst] / expected[worst];
        let (cause, advice) = of_one_channel(factor);
        Some(Finding {
            recordings: vec![self.case.trial.name.clone()],
            cause,
            channels: vec![worst + 1],
            evidence: format!(
                "the channel shows {factor:.4} times what the other trials make one expect, the others agree"
            ),
            advice: advice.to_owned(),
        })
    }

    /// Two channels exchanged in this recording alone: the gain stays with the amplifier, the limb comes along.
    fn exchanged(&self) -> Option<Finding> {
        let h = &self.table.mass_over_scale_kg;
        let other = |own: usize, from: usize| self.expected[from] * h[from] / h[own];
        for (n, a) in self.counts.iter().copied().enumerate() {
            for b in self.counts[n + 1..].iter().copied() {
                let with = |i: usize| {
                    if i == a {
                        other(a, b)
                    } else if i == b {
                        other(b, a)
                    } else {
                        self.expected[i]
                    }
                };
                if self.rest(&with) < self.enough() {
                    return Some(Finding {
                        recordings: vec![self.case.trial.name.clone()],
                        cause: Cause::SwappedChannels,
                        channels: vec![a + 1, b + 1],
                        evidence:
                            "exchanged in this recording, the two agree with the other trials"
                                .to_owned(),
                        advice:
                            "check the plugs, or give this recording its own [recording.channels]"
                                .to_owned(),
                    });
                }
            }
        }
        None
    }

    /// The gains that the session states for another trial.
    fn gains_of_another(&self, all: &[&Trial]) -> Option<Finding> {
        let own = &self.case.trial.gains.gain_n_per_v;
        let left = |other: &&&Trial| {
            let factor = |i: usize| other.gains.gain_n_per_v[i] / own[i];
            let squares = self
                .counts
                .iter()
                .map(|i| (self.seen[*i] * factor(*i) - self.expected[*i]).powi(2));
            squares.sum::<f64>().sqrt() / self.size
        };
        let others = all.iter().filter(|other| other.gains.gain_n_per_v != *own);
        let other = others.min_by(|a, b| left(a).total_cmp(&left(b)))?;
        // Of a trial that is off by fifty times its size the usual share would be anything.
        if left(&other) >= self.enough().min(LEFT) {
            return None;
        }
        Some(Finding {
            recordings: vec![self.case.trial.name.clone()],
            cause: Cause::WrongScaling,
            channels: Vec::new(),
            evidence: format!(
                "with the gains that the session states for {} the channels agree with the other trials",
                other.name
            ),
            advice: format!(
                "correct this recording's gain_n_per_v, or see whether its file and that of {} are exchanged",
                other.name
            ),
        })
    }

    /// One gain for all channels, where every other recording has a range of its own for each.
    fn gains_of_none(&self, all: &[&Trial]) -> Option<Finding> {
        let is_one = |trial: &Trial| trial.gains.gain_n_per_v.windows(2).all(|g| g[0] == g[1]);
        let own = self.case.trial;
        let alone = is_one(own) && all.iter().filter(|trial| is_one(trial)).count() == 1;
        (alone && all.len() > 1).then(|| Finding {
            recordings: vec![own.name.clone()],
            cause: Cause::WrongScaling,
            channels: Vec::new(),
            evidence: format!(
                "by the session all nine gains are {} N/V here, and ranges differ in every other recording",
                own.gains.gain_n_per_v[0]
            ),
            advice: "state this recording's own gain_n_per_v".to_owned(),
        })
    }

    /// Another direction.
    fn other_direction(&self, all: &[&Trial]) -> OtherDirection {
        let found = direction(
            self.table,
            self.response,
            &self.counts,
            &self.seen,
            self.size,
        );
        let Some((direction, left)) = found else {
            return OtherDirection::None;
        };
        let one = 1.0 / LENGTH..=LENGTH;
        if left >= self.enough() || left.is_nan() || !one.contains(&direction.length()) {
            return OtherDirection::None;
        }
        let v = direction.normalize();
        let angle = v
            .angle_between(self.case.trial.direction_ground)
            .to_degrees();
        if angle <= LOOSE_DEG {
            return OtherDirection::WithinPlay;
        }
        let near = |other: &&&Trial| {
            other.role == self.case.trial.role
                && v.angle_between(other.direction_ground).to_degrees() < LOOSE_DEG
        };
        let advice = match all.iter().find(near) {
            Some(other) => format!(
                "see whether its direction or its file is that of {}: that one is stated to move so",
                other.name
            ),
            None => "tighten the wedge and repeat, or check the stated direction".to_owned(),
        };
        OtherDirection::Loose(Finding {
            recordings: vec![self.case.trial.name.clone()],
            cause: Cause::LooseWedge,
            channels: Vec::new(),
            evidence: format!(
                "the channels show motion along ({:.3}, {:.3}, {:.3}), {angle:.1}° from the stated direction",
                v.x, v.y, v.z
            ),
            advice,
        })
    }

    /// Another sensor's where many channels depart; otherwise unexplained.
    fn nothing_else(&self) -> Finding {
        let departs =
            |i: &&usize| (self.seen[**i] - self.expected[**i]).abs() > 0.5 * NOTICED * self.size;
        let percent = 100.0 * self.departure;
        let (cause, evidence, advice) = if self.counts.iter().filter(departs).count() >= 3 {
            (
                Cause::ForeignTrial,
                format!(
                    "the channels depart by {percent:.1} % from what the other trials agree on, and neither a factor, an exchange nor another direction explains it"
                ),
                "check that this recording is this sensor's, in this state",
            )
        } else {
            (
                Cause::Unexplained,
                format!("departs by {percent:.1} % from what the other trials agree on"),
                "look at the trial's curves in the report, and repeat it",
            )
        };
        Finding {
            recordings: vec![self.case.trial.name.clone()],
            cause,
            channels: Vec::new(),
            evidence,
            advice: advice.to_owned(),
        }
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
) -> Option<Finding> {
    let over = |get: fn(&crate::response::ChannelResponse) -> f64| -> f64 {
        (0..LIMBS)
            .filter(|i| !case.ignored[*i] && !table.silent[*i])
            .map(|i| (get(&response.channels[i]) / table.mass_over_scale_kg[i]).powi(2))
            .sum::<f64>()
            .sqrt()
    };
    // Weight was taken off by an angle that is as good as the gyroscope; what is left of it is expected.
    let known = table.weight_left_m_s2(case, response) / RESIDUAL;
    let share = over(|c| c.residual_n) / (over(|c| c.signal_n) + known);
    (share > RESIDUAL).then(|| Finding {
        recordings: vec![case.trial.name.clone()],
        cause: Cause::Unexplained,
        channels: Vec::new(),
        evidence: format!(
            "{:.1} % of the signal follows neither the standards nor any fault that is known",
            100.0 * share
        ),
        advice: "look at the trial's curves in the report, and repeat it".to_owned(),
    })
}
