//! What accounts for trials that the joint fit does not account for.
//!
//! Hypotheses compete. Each is one thing that the session does not state and that the recordings may have; the trials are fitted
//! again with it, and it is believed if that leaves nothing over but noise, if its unknown, where it has one with a deviation, is told beyond doubt, and if no
//! other hypothesis does as much; a freedom also if noise that is not white is left, and next to none of the contradiction. Where none explains all trials, those that stand out are left aside: what was suspected of them is
//! believed if the others agree to the noise. Where neither succeeds the cause is unknown, and that is what is said.
//!
//! | file | hypothesis |
//! |---|---|
//! | [`freedoms`] | the model has one freedom more or less: an amplifier's high-pass, a standard's lag, channels that are late |
//! | [`mounts`] | a trial does not stand where the others on its wedge do |
//! | [`clock`] | the standards have a clock of their own |
//! | [`plugs`] | two channels, or their names, are exchanged, or one is inverted, from one trial on or up to one; inverted in a single one |
//! | [`one_kind`] | a channel or two show more or less in all trials of one kind |
//! | [`stated`] | the sensor is turned on its flange, a standard is the other way round, directions are stated in other axes, gains in V/N, down is up |
//! | [`apart`] | a few trials are wrong and the others are not |

pub mod apart;
pub mod clock;
pub mod freedoms;
pub mod mounts;
pub mod one_kind;
pub mod plugs;
pub mod stated;

use sixaxis_core::identify::joint::AtRest;
use sixaxis_core::identify::static_load_sharing::StaticLoadSharing;
use sixaxis_core::identify::zero_drift::ZeroDrift;
use sixaxis_core::{InertiaPerMass, LIMBS, Parameters};

use super::{JointReport, Knowledge, Loss, at_rest, fit_trials};
use crate::conditioning::Conditioning;
use crate::diagnosis::odd_trial::OTHER_RANGES;
use crate::diagnosis::table::Table;
use crate::diagnosis::trial_case::TrialCase;
use crate::finding::{Cause, Finding};
use crate::steps::Campaign;
use crate::trial::Trial;

/// Departure of a channel, relative to its trial, beyond which more makes no difference to who belongs where.
const COST_CAP: f64 = 0.2;

/// A day that the joint fit does not account for, or, for [`one_kind`], one of which it may have taken a channel's change for cross-talk.
#[derive(Debug, Clone, Copy)]
pub struct Unaccounted<'a> {
    /// Its trials.
    pub campaign: &'a Campaign,
    /// What is done to its trials before they are compared.
    pub conditioning: &'a Conditioning,
    /// What step 1 makes of the static record.
    pub drift: &'a ZeroDrift,
    /// Where the fits start.
    pub start: Parameters,
    /// What the session says.
    pub knowledge: &'a Knowledge,
    /// The trials with what each channel shows of them, in the campaign's order.
    pub cases: &'a [TrialCase<'a>],
    /// The fit, or why there is none.
    pub joint: core::result::Result<&'a JointReport, &'a str>,
}

impl Unaccounted<'_> {
    /// The fit of these trials with what is known of them, if it accounts for them.
    fn accounting(
        &self,
        trials: &[&Trial],
        rest: &AtRest,
        start: &Parameters,
        knowledge: &Knowledge,
    ) -> Option<JointReport> {
        let joint = self.fit(trials, rest, start, knowledge);
        joint.filter(JointReport::accounts)
    }

    fn fit(
        &self,
        trials: &[&Trial],
        rest: &AtRest,
        start: &Parameters,
        knowledge: &Knowledge,
    ) -> Option<JointReport> {
        let geometry = &self.campaign.geometry;
        let knowledge = match self.joint {
            Ok(_) => *knowledge,
            // A day without a fit may also have limbs with mass, or a mass that is far off the middle.
            Err(_) => knowledge.with_heavy_limbs(),
        };
        fit_trials(geometry, trials, rest, start, &knowledge, Loss::Squares).ok()
    }

    /// The fit of all trials, each put right. It starts from what their responses then agree on.
    fn fit_put_right(&self, table: &Table, put_right: impl Fn(&mut Trial)) -> Option<JointReport> {
        let trials = self.campaign.trials.iter();
        let right: Vec<Trial> = trials
            .map(|(trial, _)| {
                let mut right = trial.clone();
                put_right(&mut right);
                right
            })
            .collect();
        let rest = at_rest(self.drift);
        let start = start(table, &rest, &self.campaign.design);
        let borrowed: Vec<&Trial> = right.iter().collect();
        self.fit(&borrowed, &rest, &start, self.knowledge)
    }
}

/// How far trials are from agreeing, and on what.
fn agreement(shares: &StaticLoadSharing, cases: &[TrialCase<'_>]) -> Option<(f64, Table)> {
    let table = Table::linear(shares, cases, &[false; LIMBS])?.fitted(cases);
    Some((table.cost(cases, COST_CAP), table))
}

/// Where a fit starts: as the responses have it, and as designed where they leave something open.
fn start(table: &Table, rest: &AtRest, design: &Parameters) -> Parameters {
    let inertia = table.inertia_m2.map(|i| InertiaPerMass {
        xx_m2: i.x_axis.x,
        yy_m2: i.y_axis.y,
        zz_m2: i.z_axis.z,
        xy_m2: i.x_axis.y,
        xz_m2: i.x_axis.z,
        yz_m2: i.y_axis.z,
    });
    Parameters {
        zero_drift_v: rest.drift_v,
        scale_per_mass_per_kg: table.mass_over_scale_kg.map(|h| 1.0 / h),
        inertia_per_mass: inertia.unwrap_or(design.inertia_per_mass),
        ..*design
    }
}

/// That the trials agree with something put right, in words.
fn agreeing(with: &str, joint: &JointReport) -> String {
    format!(
        "with {with} all trials agree to the noise (misfit {:.2}), and as they are they do not",
        joint.misfit.per_degree
    )
}

/// What is wrong with such a day, beside what is `certain`. What was `suspected` by holding its trials against each other is taken up
/// only as far as a fit bears it out. Empty if nothing is to be said.
pub fn explain(
    day: &Unaccounted<'_>,
    certain: &[Finding],
    suspected: Vec<Finding>,
) -> Vec<Finding> {
    let (freed, (clock, plugs)) = rayon::join(
        || freedoms::Fits::of(day),
        || rayon::join(|| clock::tried(day), || plugs::tried(day)),
    );
    let mut accounting = freed.accounting(day);
    accounting.extend(clock.into_iter().chain(plugs));
    if accounting.is_empty() {
        accounting.extend(stated::turned_on_the_flange(day));
    }
    if accounting.is_empty() {
        accounting.extend(one_kind::tried(day, None));
    }
    if accounting.is_empty() {
        accounting.extend(mounts::tried(day));
    }
    if accounting.is_empty() {
        accounting.extend(freed.but_for_coloured_noise(day));
    }
    // The first one of its cause is the narrowest.
    accounting.dedup_by_key(|finding| finding.cause);
    // A sensor looks alike from some sides: many channels in another order may be directions in other axes.
    let many = |f: &Finding| f.cause == Cause::SwappedChannels && f.channels.len() > 2;
    if accounting.iter().all(many) {
        accounting.extend(stated::tried(day));
    }
    match &accounting[..] {
        [_] => return accounting,
        [first, second, ..] => {
            let evidence = format!(
                "either of two things accounts for all trials: {}; or {}",
                first.evidence, second.evidence
            );
            let advice = format!("either {}; or {}", first.advice, second.advice);
            return vec![Finding::new(Cause::Unexplained, evidence, advice)];
        }
        [] => {}
    }
    if suspected.is_empty() {
        return suspected;
    }
    let suspicion = suspected.first().map_or(String::new(), Finding::placed);
    let of_gains = gains_apart(day, &suspected);
    if let Some(borne_out) = apart::tried(day, certain, suspected) {
        return borne_out;
    }
    if !certain.is_empty() {
        return Vec::new();
    }
    vec![of_gains.unwrap_or_else(|| {
        unknown(format!(
            "{}, and no one cause that was tried accounts for that; to look at: {suspicion}",
            contradiction(day.joint)
        ))
    })]
}

/// Recordings whose gains are off by steps of an amplifier's range from those of the others, as many of them as there may be: that no
/// measure says which are right is no reason to doubt that they do not go together.
fn gains_apart(day: &Unaccounted<'_>, suspected: &[Finding]) -> Option<Finding> {
    let found = suspected.iter().find(|f| f.advice == OTHER_RANGES)?;
    // Which gains would agree with the others is no help where the others may be as wrong.
    let of_one = found.evidence.split(": with gains of ").next();
    let gains = || day.cases.iter().map(|case| &case.trial.gains);
    let alike = gains().zip(gains().skip(1)).all(|(a, b)| a == b);
    (found.recordings.len() > 1).then(|| Finding {
        evidence: format!(
            "the gains do not go together: held against the others, in the first of these {}",
            of_one.unwrap_or_default()
        ),
        advice: if alike {
            "state the gains of each recording, by the amplifiers' panel: all have the same gain_n_per_v".to_owned()
        } else {
            "compare gain_n_per_v of every recording with the amplifiers' panel".to_owned()
        },
        ..found.clone()
    })
}

/// How far a day is from being accounted for, in words.
pub(crate) fn contradiction(joint: core::result::Result<&JointReport, &str>) -> String {
    match joint {
        Ok(joint) if !joint.misfit.contradicts() => format!(
            "the trials agree only as those of a sensor beyond the ordinary: {}",
            joint.beyond_the_ordinary()
        ),
        Ok(joint) => format!(
            "the trials contradict each other{} (misfit {:.2}, noise alone leaves at most {:.2})",
            joint
                .most_of_the_misfit()
                .map_or(String::new(), |name| format!(", {name} most")),
            joint.misfit.per_degree,
            joint.misfit.limit()
        ),
        Err(refusal) => format!("no fit to all trials can be made ({refusal})"),
    }
}

/// What is advised where nothing says what is wrong.
const LOOK: &str = "look at the table of trials in the report";

/// Something is wrong, and nothing says what.
pub(crate) fn unknown(evidence: String) -> Finding {
    Finding::new(Cause::Unexplained, evidence, LOOK)
}

/// Whether it is [`unknown`] what is wrong.
pub(crate) fn is_unknown(finding: &Finding) -> bool {
    finding.cause == Cause::Unexplained && finding.advice == LOOK
}
