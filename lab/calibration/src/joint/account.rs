//! Whether the joint fit accounts for a session, and what it says is out of the ordinary.
//!
//! A fit that leaves nothing over but noise, with every wedge, zero and sensitivity within what an ordinary laboratory is allowed,
//! leaves nothing for a fault to explain: whatever else looked odd about the recordings was the room. What the fit had to put
//! down to a wedge that stands elsewhere, to one channel of one trial or to a standard beyond its certificate is named here,
//! each by the unknown that took it up.

use sixaxis_core::LIMBS;
use sixaxis_core::identify::joint::Known;
use sixaxis_core::identify::joint::unknowns::ANGLES;

use super::JointReport;
use crate::finding::{Cause, Finding};

/// Standard deviations from which something is there and not noise.
const SIGNIFICANT: f64 = 6.0;
/// Standard deviations by which the gyroscope's gain must leave its certificate.
const BEYOND_CERTIFICATE: f64 = 4.0;
/// Most that an ordinary laboratory has: spread of the limbs' stiffnesses, relative.
const STIFFNESS: f64 = 0.04;
/// Spread of the shares that channels show of each other.
const CROSS_TALK: f64 = 5e-3;
/// Change of one channel's sensitivity in one trial, relative.
const SENSITIVITY: f64 = 0.01;
/// Angle by which a wedge misses its direction, degrees.
const WEDGE_DEG: f64 = 0.5;
/// Angle of the axis off the plumb line, or of a level axis off the level, degrees.
const PLUMB_DEG: f64 = 0.5;
/// From the axis to the sensor's centre, m.
const CENTRE_M: f64 = 5e-3;
/// Change of a zero since the static record over the converter's range.
const ZERO: f64 = 5e-3;

impl JointReport {
    /// Whether noise and an ordinary room are all that the trials show: what [`Self::extraordinary`] names apart.
    #[must_use]
    pub fn accounts(&self) -> bool {
        let spreads = &self.estimate.spreads;
        !self.misfit.contradicts()
            && spreads.stiffness <= STIFFNESS
            && spreads.cross_talk <= CROSS_TALK
            && self.odd_channels_are_single()
    }

    /// A sensitivity of its own that one channel has in one trial is that channel's there. Several in one trial, or one channel's in
    /// several, are something else's doing: an exchange, a turned polarity, a sensitivity that fades.
    fn odd_channels_are_single(&self) -> bool {
        let trials = &self.estimate.trials;
        let odd: Vec<[bool; LIMBS]> = trials
            .iter()
            .map(|trial| trial.sensitivity.map(is_odd))
            .collect();
        let count = |all: &mut dyn Iterator<Item = bool>| all.filter(|odd| *odd).count();
        odd.iter()
            .all(|trial| count(&mut trial.iter().copied()) <= 1)
            && (0..LIMBS).all(|limb| count(&mut odd.iter().map(|trial| trial[limb])) <= 1)
    }

    /// What is out of the ordinary in a fit that accounts for its trials, whose names these are.
    #[must_use]
    pub fn extraordinary(
        &self,
        names: &[&str],
        full_scale_v: f64,
        gyroscope_gain_limit: f64,
    ) -> Vec<Finding> {
        let mut findings = self.wedges(names);
        findings.extend(self.plumb(names));
        findings.extend(self.channels(names, full_scale_v));
        findings.extend(self.gyroscope(gyroscope_gain_limit));
        findings
    }

    fn wedges(&self, names: &[&str]) -> Vec<Finding> {
        let unknowns = &self.estimate.unknowns;
        let mut findings = Vec::new();
        for wedge in 0..unknowns.wedges.len() {
            let at = unknowns.angles(wedge);
            let off_deg = (0..ANGLES)
                .map(|j| unknowns.values[at + j].powi(2))
                .sum::<f64>()
                .sqrt()
                .to_degrees();
            if off_deg > WEDGE_DEG {
                let n = unknowns.direction(wedge).0;
                findings.push(Finding {
                    cause: Cause::LooseWedge,
                    recordings: self.named(names, |trial| trial == wedge),
                    channels: Vec::new(),
                    evidence: format!(
                        "the sensor moves along and about ({:.4}, {:.4}, {:.4}), {off_deg:.2}° from the stated direction",
                        n.x, n.y, n.z
                    ),
                    advice: "tighten the wedge and repeat its trials, or check the stated direction"
                        .to_owned(),
                });
            }
        }
        findings
    }

    /// Recordings of wedges.
    fn named(&self, names: &[&str], wanted: impl Fn(usize) -> bool) -> Vec<String> {
        let trials = self.estimate.trials.iter().zip(names);
        trials
            .filter(|(trial, _)| wanted(trial.wedge))
            .map(|(_, name)| (*name).to_owned())
            .collect()
    }

    /// An axis that is not where the session says, and a centre that is not on it.
    fn plumb(&self, names: &[&str]) -> Vec<Finding> {
        let (mut tilted, mut most_deg) = (Vec::new(), 0.0_f64);
        let (mut off_axis, mut most_m) = (Vec::new(), 0.0_f64);
        for (trial, name) in self.estimate.trials.iter().zip(names) {
            let size = |pair: Option<[Known; 2]>| pair.map_or(0.0, |[a, b]| a.value.hypot(b.value));
            let tilt_deg = size(trial.plumb).to_degrees();
            if tilt_deg > PLUMB_DEG {
                tilted.push((*name).to_owned());
                most_deg = most_deg.max(tilt_deg);
            }
            let centre_m = size(trial.centre_m);
            if centre_m > CENTRE_M {
                off_axis.push((*name).to_owned());
                most_m = most_m.max(centre_m);
            }
        }
        let mut findings = Vec::new();
        if !tilted.is_empty() {
            findings.push(Finding {
                cause: Cause::GravityNotHandled,
                recordings: tilted,
                channels: Vec::new(),
                evidence: format!(
                    "gravity turns in the sensor as if it stood {most_deg:.2}° from where the session says"
                ),
                advice: "plumb the axis, or state gravity as it is in the sensor at rest".to_owned(),
            });
        }
        if !off_axis.is_empty() {
            findings.push(Finding {
                cause: Cause::Unexplained,
                recordings: off_axis,
                channels: Vec::new(),
                evidence: format!(
                    "the sensor's centre is {:.1} mm off the axis, or moves as if it were",
                    1e3 * most_m
                ),
                advice: "centre the sensor on the pinion".to_owned(),
            });
        }
        findings
    }

    /// Sensitivities and zeros that are one trial's, or have moved since the static record.
    fn channels(&self, names: &[&str], full_scale_v: f64) -> Vec<Finding> {
        let mut findings = Vec::new();
        for limb in 0..LIMBS {
            let mut moved = Vec::new();
            let mut most_v = 0.0_f64;
            for (trial, name) in self.estimate.trials.iter().zip(names) {
                let own = trial.sensitivity[limb];
                if is_odd(own) {
                    findings.push(one_channel(limb, name, 1.0 + own.value));
                }
                let zero = trial.zero_v[limb];
                if zero.value.abs() > ZERO * full_scale_v + SIGNIFICANT * zero.deviation {
                    moved.push((*name).to_owned());
                    if zero.value.abs() > most_v.abs() {
                        most_v = zero.value;
                    }
                }
            }
            if !moved.is_empty() {
                findings.push(Finding {
                    cause: Cause::DriftDuringRun,
                    recordings: moved,
                    channels: vec![limb + 1],
                    evidence: format!(
                        "the zero is {:+.1} mV from that of the static record",
                        1e3 * most_v
                    ),
                    advice: "warm up, and record at rest right before the trials".to_owned(),
                });
            }
        }
        findings
    }

    fn gyroscope(&self, limit: f64) -> Option<Finding> {
        let found = self.nuisances().gyroscope_gain?;
        (found.value.abs() > limit + BEYOND_CERTIFICATE * found.deviation).then(|| Finding {
            cause: Cause::WrongScaling,
            recordings: Vec::new(),
            channels: Vec::new(),
            evidence: format!(
                "by Euler's equation the gyroscope reads {:+.2} ± {:.2} % too much, and its certificate allows {:.2} %",
                100.0 * found.value,
                100.0 * found.deviation,
                100.0 * limit
            ),
            advice: "check unit and sensitivity of the gyroscope against its certificate".to_owned(),
        })
    }
}

/// Whether a sensitivity is none that an ordinary room gives a channel.
fn is_odd(own: Known) -> bool {
    own.value.abs() > SENSITIVITY && own.value.abs() > SIGNIFICANT * own.deviation
}

/// One channel in one trial shows so many times what it shows in the others.
fn one_channel(limb: usize, name: &str, factor: f64) -> Finding {
    let (cause, advice) = if (factor + 1.0).abs() < 0.1 {
        (
            Cause::InvertedChannel,
            "check the channel's polarity in this recording",
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
    Finding {
        cause,
        recordings: vec![name.to_owned()],
        channels: vec![limb + 1],
        evidence: format!("the channel shows {factor:.4} times what it shows in the other trials"),
        advice: advice.to_owned(),
    }
}
