//! The result: serialized for scripts, and as text.

use std::fmt::Write as _;

use serde::Serialize;
use sixaxis_core::redundancy::self_calibration::{Drifted, Scales};
use sixaxis_core::significance::NORMAL_95;
use sixaxis_core::{LIMBS, LimbSet};

use super::Check;
use super::measured::Measured;

/// What it comes to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Finding {
    /// No limb has drifted.
    Nothing,
    /// Some have, and are named.
    Drifted,
    /// More than can be named have.
    TooMany,
    /// The motion leaves ratios open.
    TooPoor,
    /// The equations do not fit.
    Misfit,
}

/// Limbs that a poor motion does not tell apart.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Open {
    limbs: Vec<usize>,
    against: Vec<usize>,
}

impl From<(LimbSet, LimbSet)> for Open {
    fn from((up, down): (LimbSet, LimbSet)) -> Self {
        Self {
            limbs: up.numbers().collect(),
            against: down.numbers().collect(),
        }
    }
}

/// One limb.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Limb {
    limb: usize,
    drifted: bool,
    /// Change of its scale factor against the limbs that kept theirs, and half the width of the 95 % interval.
    change_percent: f64,
    half_width_95_percent: f64,
    /// With a known change of acceleration: its change as such.
    absolute_percent: Option<f64>,
    absolute_half_width_95_percent: Option<f64>,
}

/// Everything.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    recording: String,
    since: Option<String>,
    calibration: String,
    serial: String,
    samples: u64,
    sample_rate_hz: f64,
    block_samples: u32,
    /// What the measurement comes to.
    pub finding: Finding,
    false_alarm: f64,
    /// Whether the calibration has the limbs' stiffness ratios.
    stiffnesses_calibrated: bool,
    /// Whether its own errors are left out.
    calibration_exact: bool,
    limbs: Vec<Limb>,
    /// Another set of limbs that would explain the data.
    rival: Option<Vec<usize>>,
    chi_square_of_none: Option<f64>,
    limit_of_none: Option<f64>,
    common_percent: Option<f64>,
    common_half_width_95_percent: Option<f64>,
    pub(super) open: Vec<Open>,
    pub(super) open_in_words: Option<String>,
    /// The corrected calibration, where one was written.
    pub written: Option<String>,
    /// Where gains, rate and direction of gravity are from.
    pub notes: Vec<String>,
    /// What is wrong with the recording or contradicts the equations.
    pub warnings: Vec<String>,
}

/// A change of a logarithm in per cent.
fn percent(ln: f64) -> f64 {
    1e2 * ln.exp_m1()
}

impl Summary {
    /// Before anything is known.
    pub(super) fn new(check: &Check, measured: &Measured) -> Self {
        Self {
            recording: check.recording.display().to_string(),
            since: check.since.map(|p| p.display().to_string()),
            calibration: check.calibration_name.display().to_string(),
            serial: check.calibration.sensor.serial.clone(),
            samples: measured.samples,
            sample_rate_hz: measured.sample_rate_hz,
            block_samples: measured.block,
            finding: Finding::Nothing,
            false_alarm: check.false_alarm,
            stiffnesses_calibrated: check.calibration.limbs.is_some(),
            calibration_exact: check.calibration_exact,
            limbs: Vec::new(),
            rival: None,
            chi_square_of_none: None,
            limit_of_none: None,
            common_percent: None,
            common_half_width_95_percent: None,
            open: Vec::new(),
            open_in_words: None,
            written: None,
            notes: Vec::new(),
            warnings: measured.warnings.clone(),
        }
    }

    /// Who drifted. A misfit stays one.
    pub(super) fn put(&mut self, said: &Drifted) {
        let z = NORMAL_95;
        if self.finding == Finding::Nothing {
            self.finding = match (said.explained, said.limbs.is_empty()) {
                (true, true) => Finding::Nothing,
                (true, false) => Finding::Drifted,
                (false, _) => Finding::TooMany,
            };
        }
        let named = self.finding == Finding::Drifted;
        self.limbs = (0..LIMBS)
            .map(|i| Limb {
                limb: i + 1,
                drifted: named && said.limbs.contains(i),
                change_percent: percent(said.ln_change[i]),
                half_width_95_percent: 1e2 * z * said.deviation[i],
                absolute_percent: None,
                absolute_half_width_95_percent: None,
            })
            .collect();
        self.rival = said.rival.map(|set| set.numbers().collect());
        self.chi_square_of_none = Some(said.chi_square_of_none);
        self.limit_of_none = Some(said.limit_of_none);
    }

    /// Of no limb is it said that it has not drifted where a change as large as this, of its logarithm, would not show.
    pub(super) fn put_unknown(&mut self, said: &Drifted, largest: f64) {
        let unknown = (0..LIMBS).filter(|i| NORMAL_95 * said.deviation[*i] > largest);
        let unknown = unknown.fold(LimbSet::EMPTY, LimbSet::with);
        if self.finding == Finding::Nothing && !unknown.is_empty() {
            self.finding = Finding::TooPoor;
            self.open_in_words = Some(format!(
                "what {} {unknown} would have changed by, to more than {:.0} %",
                if unknown.len() == 1 { "limb" } else { "limbs" },
                1e2 * largest
            ));
        }
    }

    /// All nine.
    pub(super) fn put_scales(&mut self, scales: &Scales) {
        let z = NORMAL_95;
        for (i, limb) in self.limbs.iter_mut().enumerate() {
            limb.absolute_percent = Some(percent(scales.ln_scale[i]));
            limb.absolute_half_width_95_percent = Some(1e2 * z * scales.deviation[i]);
        }
        self.common_percent = Some(percent(scales.ln_common));
        self.common_half_width_95_percent = Some(1e2 * z * scales.common_deviation);
    }

    /// For people.
    pub fn text(&self) -> String {
        let mut out = String::new();
        let when = match &self.since {
            Some(since) => format!("since {since}"),
            None => "since calibration".to_owned(),
        };
        let drifted: Vec<&Limb> = self.limbs.iter().filter(|l| l.drifted).collect();
        let _ = match self.finding {
            Finding::Nothing => writeln!(out, "No limb has drifted {when}."),
            Finding::Drifted => drifted.iter().try_for_each(|l| {
                writeln!(
                    out,
                    "Limb {} has drifted by {:+.3} % {when} (interval {:+.3} to {:+.3} %).",
                    l.limb,
                    l.change_percent,
                    l.change_percent - l.half_width_95_percent,
                    l.change_percent + l.half_width_95_percent
                )
            }),
            Finding::TooMany => writeln!(
                out,
                "More than four limbs have changed against each other {when}, or limbs are not equally stiff: nobody can be named. So it looks, too, where \
                 gains or the calibration are another recording's or another sensor's."
            ),
            Finding::TooPoor => writeln!(
                out,
                "The motion is too poor: it leaves open {}. Turn the sensor about more axes, faster or longer; if it did turn so, a channel is dead, inverted, \
                 clipped, fading or plugged in elsewhere, or hums (inspect; decouple --watch), or the calibration is a poor one.",
                self.open_in_words.as_deref().unwrap_or("ratios")
            ),
            Finding::Misfit => writeln!(
                out,
                "The coordination equations do not fit this recording; nothing is said of limbs."
            ),
        };
        if let Some(rival) = &self.rival {
            let rival: Vec<String> = rival.iter().map(usize::to_string).collect();
            let _ = writeln!(
                out,
                "It may be limb {} instead: a longer recording would tell.",
                rival.join(" and ")
            );
        }
        if !self.limbs.is_empty() {
            self.table(&mut out);
        }
        if let Some(path) = &self.written {
            let _ = writeln!(out, "\nWritten\n  {path}");
        }
        out
    }

    fn table(&self, out: &mut String) {
        let nine = self.common_percent.is_some();
        let _ = writeln!(
            out,
            "\n  limb    change %  +- 95 %{}",
            if nine { "     all told %  +- 95 %" } else { "" }
        );
        for l in &self.limbs {
            let _ = write!(
                out,
                "  {:>4}  {:>+10.4}  {:>7.4}",
                l.limb, l.change_percent, l.half_width_95_percent
            );
            if let (Some(value), Some(half)) =
                (l.absolute_percent, l.absolute_half_width_95_percent)
            {
                let _ = write!(out, "  {value:>+13.4}  {half:>7.4}");
            }
            let _ = writeln!(out, "{}", if l.drifted { "  drifted" } else { "" });
        }
        let _ = writeln!(
            out,
            "  against the limbs that kept their scale; by linear theory one sensor in {:.0} is wrongly said to have drifted",
            1.0 / self.false_alarm
        );
        if self.since.is_none() {
            let stiffnesses = match (self.stiffnesses_calibrated, self.calibration_exact) {
                (true, _) => "stiffnesses are those of the joint fit",
                (false, true) => {
                    "the calibration knows no stiffnesses: they are taken to be equal, and where they are not, limbs seem to have drifted; --since does without"
                }
                (false, false) => {
                    "the calibration knows no stiffnesses: they are taken to differ by 0.5 %, and smaller drifts do not show; --since does without"
                }
            };
            let _ = writeln!(out, "  {stiffnesses}");
        }
        if let (Some(common), Some(half)) = (self.common_percent, self.common_half_width_95_percent)
        {
            let _ = writeln!(out, "  common factor {common:+.4} % +- {half:.4}");
        }
    }
}
