//! Whether the joint fit accounts for a session, and what it says is out of the ordinary.
//!
//! A fit that leaves nothing over but noise, with every wedge, zero and sensitivity within what an ordinary laboratory is allowed,
//! leaves nothing for a fault to explain: whatever else looked odd about the recordings was the room. One thing it can take for cross-talk, a channel that
//! is another in all trials of one kind ([`super::hypotheses::one_kind`]). What the fit had to put
//! down to a wedge that stands elsewhere, to one channel of one trial or to a standard beyond its certificate is named here,
//! each by the unknown that took it up.

use glam::{DMat3, DQuat, DVec3};
use nalgebra::{Matrix3, Vector3};
use sixaxis_core::LIMBS;
use sixaxis_core::identify::joint::Known;
use sixaxis_core::identify::joint::estimate::TrialEstimate;

use super::JointReport;
use super::knowledge::TIME_CONSTANT;
use super::misfit::Misfit;
use crate::diagnosis::rig;
use crate::finding::{Cause, Finding};

/// Standard deviations from which something is there and not noise.
pub(super) const SIGNIFICANT: f64 = 6.0;
/// Share of a certificate's limit by which a gain that the fit finds may be beyond it: the fit's deviation knows of noise, and a level axis, above
/// all, has more that the model leaves out.
const AT_THE_LIMIT: f64 = 0.02;
/// Standard deviations by which the gyroscope's gain must leave its certificate.
const BEYOND_CERTIFICATE: f64 = 4.0;
/// Squares per degree of freedom that noise of another colour may leave, and their excess over that of trials without the cause.
const COLOURED: f64 = 1.5;
const LITTLE: f64 = 0.01;
/// Most that an ordinary laboratory has: spread of the limbs' stiffnesses, relative.
const STIFFNESS: f64 = 0.04;
/// Root mean square of the shares that channels show of each other.
const CROSS_TALK: f64 = 5e-3;
/// Angle by which a wedge misses its direction, degrees.
const WEDGE_DEG: f64 = 0.5;
/// What to do about a sensor that is turned on its flange.
pub(super) const STRAIGHT_ON_ITS_FLANGE: &str =
    "set the sensor straight on its flange, or state the directions as they are in its axes";
/// Share of a rotation of all wedges by which each may be off it.
const ALIKE: f64 = 0.2;
/// Share of the largest singular value of all directions' products that the second one has at least where they are not one line.
const OPEN: f64 = 1e-3;
/// Angle of the axis off the plumb line, or of a level axis off the level, degrees.
const PLUMB_DEG: f64 = 0.5;
/// Angle up to which it is its sine, degrees.
const LINEAR_DEG: f64 = 20.0;
/// From the axis to the sensor's centre, m.
const CENTRE_M: f64 = 5e-3;
/// Channels of one trial whose zeros may well have drifted together.
const DRIFT_TOGETHER: usize = 2;
/// Share of the largest change from which a channel's zero has moved along with it.
const TOGETHER: f64 = 0.3;
/// Change of a zero since the static record over the converter's range.
const ZERO: f64 = 5e-3;

impl JointReport {
    /// Whether noise and an ordinary room are all that the trials show: what [`Self::extraordinary`] names apart.
    pub fn accounts(&self) -> bool {
        !self.misfit.contradicts() && self.is_ordinary()
    }

    /// Whether it leaves next to nothing of what another fit's trials contradict each other by: noise that is not white, as resampling
    /// and filters leave it, contradicts a little whatever the cause of the rest.
    pub(super) fn leaves_little_of(&self, contradiction: &Misfit) -> bool {
        let (left, before) = (self.misfit.per_degree, contradiction.per_degree);
        left < COLOURED && left - 1.0 < LITTLE * (before - 1.0) && self.is_ordinary()
    }

    /// Whether it contradicts the trials by so little that noise of another colour, or an effect of a few hundredths of a percent, may be all:
    /// its parameters are nearer to the truth than the four steps', with intervals that are made as wide as the contradiction asks.
    pub fn nearly_accounts(&self) -> bool {
        self.misfit.per_degree < COLOURED && self.is_ordinary()
    }

    fn is_ordinary(&self) -> bool {
        let spreads = &self.estimate.spreads;
        spreads.stiffness <= STIFFNESS
            && spreads.cross_talk() <= CROSS_TALK
            && self.odd_channels_are_single()
    }

    /// The recording of one trial that leaves over more than all others together.
    pub fn most_of_the_misfit(&self) -> Option<&str> {
        let excess = |trial: &TrialEstimate| trial.excess.max(0.0);
        let whole: f64 = self.estimate.trials.iter().map(excess).sum();
        let mut named = self.estimate.trials.iter().zip(&self.recordings);
        let most = named.find(|(trial, _)| excess(trial) > 0.5 * whole);
        most.map(|(_, name)| name.as_str())
    }

    /// Where it accounts for nothing although it does not contradict the trials: what of the sensor it describes is beyond the ordinary.
    pub fn beyond_the_ordinary(&self) -> String {
        let spreads = &self.estimate.spreads;
        let percent = |share: f64| 100.0 * share;
        let mut all = Vec::new();
        if spreads.stiffness > STIFFNESS {
            all.push(format!(
                "stiffnesses that differ by {:.2} %",
                percent(spreads.stiffness)
            ));
        }
        if spreads.cross_talk() > CROSS_TALK {
            all.push(format!(
                "cross-talk of {:.2} %",
                percent(spreads.cross_talk())
            ));
        }
        if let Some((limb, by)) = self.most_odd().filter(|_| !self.odd_channels_are_single()) {
            all.push(format!(
                "several sensitivities that are others in single trials, that of channel {} by {:+.2} %",
                limb + 1,
                percent(by)
            ));
        }
        all.join(", ")
    }

    /// What is out of the ordinary in a fit that accounts for its trials. By the rig's rotation the drive turns so much faster than stated,
    /// and by its stroke the standard accelerometer changes by so much over the day, relative, where the session states the rig.
    pub fn extraordinary(
        &self,
        full_scale_v: f64,
        gyroscope_gain_limit: f64,
        gyroscope_bandwidth_hz: Option<f64>,
        drive_faster: Option<f64>,
        accelerometer_changes: Option<f64>,
    ) -> Vec<Finding> {
        let mut findings = self.wedges();
        findings.extend(self.plumb());
        findings.extend(self.sensitivities(accelerometer_changes));
        findings.extend(self.zeros(full_scale_v));
        findings.extend(self.gyroscope(gyroscope_gain_limit, drive_faster));
        findings.extend(self.gyroscope_lag(gyroscope_bandwidth_hz));
        findings
    }

    /// Wedges that stand elsewhere, or the sensor on its flange if they all do by one rotation.
    fn wedges(&self) -> Vec<Finding> {
        let unknowns = &self.estimate.unknowns;
        let pairs: Vec<(DVec3, DVec3)> = (unknowns.wedges.iter().enumerate())
            .map(|(wedge, stated)| (stated.nominal, unknowns.direction(wedge).0))
            .collect();
        let off_deg = |(from, to): &(DVec3, DVec3)| from.angle_between(*to).to_degrees();
        let flange = rotation(&pairs).filter(|turned| {
            let left_over = |(from, to): &(DVec3, DVec3)| off_deg(&(*turned * *from, *to));
            let most_deg = pairs.iter().map(left_over).fold(0.0, f64::max);
            turned.to_axis_angle().1.to_degrees() > WEDGE_DEG.max(most_deg / ALIKE)
        });
        if let Some(turned) = flange {
            let evidence = format!("all directions are {}", turned_alike(turned));
            let finding = Finding::new(Cause::LooseWedge, evidence, STRAIGHT_ON_ITS_FLANGE);
            return vec![finding];
        }
        let loose = pairs
            .iter()
            .enumerate()
            .filter(|(_, pair)| off_deg(pair) > WEDGE_DEG);
        loose
            .map(|(wedge, pair)| {
                let n = pair.1;
                let evidence = format!(
                    "the sensor moves along and about ({:.4}, {:.4}, {:.4}), {:.2}° from the stated direction",
                    n.x,
                    n.y,
                    n.z,
                    off_deg(pair)
                );
                let advice = "tighten the wedge and repeat its trials, or check the stated direction";
                let finding = Finding::new(Cause::LooseWedge, evidence, advice);
                finding.in_recordings(self.named(|trial| trial == wedge))
            })
            .collect()
    }

    /// Recordings of wedges.
    fn named(&self, wanted: impl Fn(usize) -> bool) -> Vec<String> {
        let trials = self.estimate.trials.iter().zip(&self.recordings);
        trials
            .filter(|(trial, _)| wanted(trial.wedge))
            .map(|(_, name)| (*name).to_owned())
            .collect()
    }

    /// An axis that is not where the session says, and a centre that is not on it.
    fn plumb(&self) -> Vec<Finding> {
        let (mut tilted, mut most_deg) = (Vec::new(), 0.0_f64);
        let (mut off_axis, mut most_m) = (Vec::new(), 0.0_f64);
        for (trial, name) in self.estimate.trials.iter().zip(&self.recordings) {
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
            // The fit takes an angle for its sine.
            let evidence = if most_deg < LINEAR_DEG {
                format!(
                    "gravity turns in the sensor as if it stood {most_deg:.2}° from where the session says"
                )
            } else {
                format!(
                    "gravity turns in the sensor as if it stood more than {LINEAR_DEG}° from where the session says"
                )
            };
            let advice = "plumb the axis, or state gravity as it is in the sensor at rest";
            let finding = Finding::new(Cause::GravityNotHandled, evidence, advice);
            findings.push(finding.in_recordings(tilted));
        }
        if !off_axis.is_empty() {
            let evidence = format!(
                "the sensor's centre is {:.1} mm off the axis, or moves as if it were",
                1e3 * most_m
            );
            let advice = "centre the sensor on the pinion";
            let finding = Finding::new(Cause::Unexplained, evidence, advice);
            findings.push(finding.in_recordings(off_axis));
        }
        findings
    }

    /// Zeros that have moved since the static record.
    fn zeros(&self, full_scale_v: f64) -> Vec<Finding> {
        let trials: Vec<(&TrialEstimate, &str)> = self
            .estimate
            .trials
            .iter()
            .zip(self.recordings.iter().map(String::as_str))
            .collect();
        let moved =
            |zero: Known| zero.value.abs() > ZERO * full_scale_v + SIGNIFICANT * zero.deviation;
        // Many channels of one trial have not drifted together: the trial is not whole, or does not end where it began, and each
        // channel's mean has its part of the motion then.
        let torn = |trial: &TrialEstimate| {
            let moved = trial.zero_v.iter().filter(|zero| moved(**zero));
            let most_v = moved.map(|zero| zero.value.abs()).fold(0.0, f64::max);
            let along =
                |zero: &&Known| zero.value.abs() > TOGETHER * most_v + SIGNIFICANT * zero.deviation;
            most_v > 0.0 && trial.zero_v.iter().filter(along).count() > DRIFT_TOGETHER
        };
        let names_of = |wanted: &dyn Fn(&TrialEstimate) -> bool| -> Vec<String> {
            let all = trials.iter().filter(|(trial, _)| wanted(trial));
            all.map(|(_, name)| (*name).to_owned()).collect()
        };
        let mut findings = Vec::new();
        let all_torn = names_of(&torn);
        let torn_alone = all_torn.len() < trials.len();
        if torn_alone && !all_torn.is_empty() {
            let evidence = format!(
                "the means of more than {DRIFT_TOGETHER} channels stand elsewhere than in the other trials, as if samples were missing"
            );
            let advice = "look for a gap in the recording, and repeat the trial";
            let finding = Finding::new(Cause::Unexplained, evidence, advice);
            findings.push(finding.in_recordings(all_torn));
        }
        for limb in 0..LIMBS {
            let drifted =
                |trial: &TrialEstimate| moved(trial.zero_v[limb]) && !(torn_alone && torn(trial));
            let recordings = names_of(&drifted);
            let most_v = trials
                .iter()
                .filter(|(trial, _)| drifted(trial))
                .map(|(trial, _)| trial.zero_v[limb].value)
                .max_by(|a, b| a.abs().total_cmp(&b.abs()));
            findings.extend(most_v.map(|volts| {
                let evidence = format!(
                    "the zero is {:+.1} mV from that of the static record",
                    1e3 * volts
                );
                let advice = "warm up, and record at rest right before the trials";
                let finding = Finding::new(Cause::DriftDuringRun, evidence, advice);
                finding.in_recordings(recordings).on_channels([limb])
            }));
        }
        findings
    }

    /// A gain beyond the certificate; where the drive turns otherwise by the recordings' clock than the session says, and the gyroscope does
    /// not by a clock by which it does not, that clock.
    fn gyroscope(&self, limit: f64, drive_faster: Option<f64>) -> Option<Finding> {
        let found = self.nuisances().gyroscope_gain?;
        if found.value.abs() <= (1.0 + AT_THE_LIMIT) * limit + BEYOND_CERTIFICATE * found.deviation
        {
            return None;
        }
        let reads = format!(
            "by Euler's equation the gyroscope reads {:+.2} ± {:.2} % too much",
            100.0 * found.value,
            100.0 * found.deviation
        );
        let advice = "check unit and sensitivity of the gyroscope against its certificate";
        // Turning is to angular acceleration as a rate is to its derivative by the clock.
        let by_its_clock = |faster: f64| (1.0 + found.value) * (1.0 + faster) - 1.0;
        let explains = |faster: &f64| by_its_clock(*faster).abs() <= limit;
        if let Some(faster) = drive_faster.filter(explains) {
            let sign = format!(
                "{reads}; by a clock by which the drive turns as stated it reads {:+.2} %, and its certificate allows {:.2} %",
                100.0 * by_its_clock(faster),
                100.0 * limit
            );
            return Some(rig::of_a_clock(faster, &sign, Some(advice)));
        }
        let evidence = format!("{reads}, and its certificate allows {:.2} %", 100.0 * limit);
        Some(Finding::new(Cause::WrongScaling, evidence, advice))
    }

    /// A lag that is not the stated bandwidth's: the fit finds its own.
    fn gyroscope_lag(&self, stated_hz: Option<f64>) -> Option<Finding> {
        let (found, stated_hz) = (self.nuisances().gyroscope_lag_s?, stated_hz?);
        let stated_s = 1.0 / (core::f64::consts::TAU * stated_hz);
        let off_s = (found.value - stated_s).abs();
        let evidence = format!(
            "by Euler's equation the gyroscope is {:.2} ms behind, and by the stated bandwidth of {stated_hz} Hz it is {:.2} ms",
            1e3 * found.value,
            1e3 * stated_s
        );
        let advice = "correct the gyroscope's bandwidth_hz by its certificate";
        (off_s > BEYOND_CERTIFICATE * (TIME_CONSTANT * stated_s).hypot(found.deviation))
            .then(|| Finding::new(Cause::GyroscopeLag, evidence, advice))
    }
}

/// By how much and about what all directions are turned, in words.
pub(super) fn turned_alike(turned: DQuat) -> String {
    let (axis, angle_rad) = turned.to_axis_angle();
    // Zero has no sign in a sentence.
    let [x, y, z] = axis.to_array().map(|c| (100.0 * c).round() / 100.0 + 0.0);
    format!(
        "turned alike, by {:.2}° about ({x:.2}, {y:.2}, {z:.2}), as those of a sensor are that is turned on its flange",
        angle_rad.to_degrees()
    )
}

/// The rotation that takes the first of each pair of unit vectors as near the second as one rotation can; none of fewer than three
/// pairs, and of such as leave it open.
pub(super) fn rotation(pairs: &[(DVec3, DVec3)]) -> Option<DQuat> {
    if pairs.len() < 3 {
        return None;
    }
    let column = |v: DVec3| Vector3::from(v.to_array());
    let sum: Matrix3<f64> = pairs
        .iter()
        .map(|(from, to)| column(*to) * column(*from).transpose())
        .sum();
    let svd = sum.svd(true, true);
    let (u, v_t) = (svd.u?, svd.v_t?);
    let right_handed = Vector3::new(1.0, 1.0, (u * v_t).determinant().signum());
    let turned = u * Matrix3::from_diagonal(&right_handed) * v_t;
    let open = svd.singular_values[1] < OPEN * svd.singular_values[0];
    (!open).then(|| DQuat::from_mat3(&DMat3::from_cols_slice(turned.as_slice())))
}
