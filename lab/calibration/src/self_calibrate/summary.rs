//! The result: serialized for scripts, and as text.

use std::fmt::Write as _;

use serde::Serialize;
use sixaxis_core::redundancy::self_calibration::{Drifted, Scales};
use sixaxis_core::significance::NORMAL_95;
use sixaxis_core::{LIMBS, LimbSet};
use sixaxis_recordings::inspect::listing::brief;

use super::Check;
use super::cause::{Cause, Judged};
use super::common::Common;
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
    /// The motion, or the calibration, leaves ratios open.
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
    /// With a known change of acceleration: change of the limbs that kept their ratios against the calibration, whose own error is in the
    /// interval, and whether that is a drift.
    common_percent: Option<f64>,
    common_half_width_95_percent: Option<f64>,
    common_drifted: Option<bool>,
    pub(super) open: Vec<Open>,
    pub(super) open_in_words: Option<String>,
    /// Why they are open.
    open_because_of: Option<Cause>,
    /// What the equations leave over the noise that the calibration states, root mean squares.
    residual_over_noise: Option<f64>,
    /// The corrected calibration, where one was written.
    pub written: Option<String>,
    /// Where gains, rate and direction of gravity are from.
    pub notes: Vec<String>,
    /// What is wrong with the recording or contradicts the equations.
    pub warnings: Vec<String>,
}

/// What a channel may be that contradicts the others.
const WRONG: &str = "dead, inverted, clipped, fading, slow or plugged in elsewhere, or hums, or its zero moves (inspect; decouple --watch)";

/// Ratios that are found in spite of channels that contradict each other may be those of the wrong limbs.
pub(super) fn contradiction(judged: Judged) -> Option<String> {
    judged.contradicts().then(|| {
        format!(
            "the equations leave {:.0} times the noise that the calibration states, and limbs may be named wrongly: a channel is {WRONG}, or all are \
             noisier than in the laboratory",
            judged.over_noise
        )
    })
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
            common_drifted: None,
            open: Vec::new(),
            open_in_words: None,
            open_because_of: None,
            residual_over_noise: None,
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

    /// What is open, and why. Channels that contradict each other in a motion that would do are a misfit.
    pub(super) fn put_open(&mut self, open: String, judged: Option<Judged>) {
        let cause = judged.map(Judged::cause);
        self.finding = match cause {
            Some(Cause::Channels) => Finding::Misfit,
            _ => Finding::TooPoor,
        };
        (self.open_in_words, self.rival) = (Some(open), None);
        self.open_because_of = cause;
        self.residual_over_noise = judged.map(|judged| judged.over_noise);
    }

    /// Of no limb is it said that it has not drifted where a change as large as this, of its logarithm, would not show. `own` is
    /// the same as `said` with a calibration that is taken for exact.
    pub(super) fn put_unknown(
        &mut self,
        said: &Drifted,
        own: &Drifted,
        largest: f64,
        judged: Option<Judged>,
    ) {
        let unknown = |said: &Drifted| {
            let limbs = (0..LIMBS).filter(|i| NORMAL_95 * said.deviation[*i] > largest);
            limbs.fold(LimbSet::EMPTY, LimbSet::with)
        };
        let (all, by_itself) = (unknown(said), unknown(own));
        if self.finding == Finding::Nothing && !all.is_empty() {
            let open = format!(
                "what {all:#} would have changed by, to more than {:.0} %",
                1e2 * largest
            );
            self.put_open(open, judged);
            if by_itself.is_empty() && self.finding == Finding::TooPoor {
                self.open_because_of = Some(Cause::Calibration);
            }
        }
    }

    /// All nine. A misfit stays one, and so does what is open.
    pub(super) fn put_scales(&mut self, scales: &Scales, common: &Common) {
        let z = NORMAL_95;
        for (i, limb) in self.limbs.iter_mut().enumerate() {
            limb.absolute_percent = Some(percent(scales.ln_scale[i]));
            limb.absolute_half_width_95_percent = Some(1e2 * z * scales.deviation[i]);
        }
        self.common_percent = Some(percent(common.ln_change));
        self.common_half_width_95_percent = Some(1e2 * z * common.deviation);
        self.common_drifted = Some(common.drifted);
        if common.drifted && self.finding == Finding::Nothing {
            self.finding = Finding::Drifted;
        }
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
            Finding::Nothing => match self.would_show_percent() {
                Some(least) => writeln!(
                    out,
                    "No limb has drifted {when}; of one limb {} % would show.",
                    brief(least, 2)
                ),
                None => writeln!(out, "No limb has drifted {when}."),
            },
            Finding::Drifted => drifted
                .iter()
                .try_for_each(|l| {
                    writeln!(
                        out,
                        "Limb {} has drifted by {:+.3} % {when} (interval {:+.3} to {:+.3} %).",
                        l.limb,
                        l.change_percent,
                        l.change_percent - l.half_width_95_percent,
                        l.change_percent + l.half_width_95_percent
                    )
                })
                .and_then(|()| self.common_text(&mut out, drifted.is_empty())),
            Finding::TooMany => writeln!(
                out,
                "More than four limbs have changed against each other {when}, or limbs are not equally stiff: nobody can be named. So it looks, too, where \
                 gains or the calibration are another recording's or another sensor's."
            ),
            Finding::TooPoor => writeln!(out, "{}", self.open_text()),
            Finding::Misfit => writeln!(
                out,
                "The coordination equations do not fit this recording; nothing is said of limbs.{}",
                match self.open_because_of {
                    Some(Cause::Channels) => format!(" {}", self.channels_text()),
                    _ => String::new(),
                }
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

    /// Change of a single limb's scale that chance does not reach but as often as false alarms are allowed: of the limb that is told worst.
    fn would_show_percent(&self) -> Option<f64> {
        let halves = self.limbs.iter().map(|limb| limb.half_width_95_percent);
        let limit = self.limit_of_none?;
        Some(halves.reduce(f64::max)? / NORMAL_95 * limit.sqrt())
    }

    /// What all limbs, or all others, have drifted by together, if they have.
    fn common_text(&self, out: &mut String, all: bool) -> std::fmt::Result {
        let (Some(change), Some(half), Some(true)) = (
            self.common_percent,
            self.common_half_width_95_percent,
            self.common_drifted,
        ) else {
            return Ok(());
        };
        writeln!(
            out,
            "{} have drifted together by {change:+.3} % since calibration (interval {:+.3} to {:+.3} %).",
            if all {
                "All nine limbs"
            } else {
                "The other limbs"
            },
            change - half,
            change + half
        )
    }

    /// Why nothing is said where ratios are open and no channel is known to be wrong.
    fn open_text(&self) -> String {
        let open = self.open_in_words.as_deref().unwrap_or("ratios");
        match self.open_because_of {
            Some(Cause::Motion) => format!(
                "The motion is too poor: it leaves open {open}. Turn the sensor about more axes, faster or longer."
            ),
            Some(Cause::Calibration) => format!(
                "The calibration is too poor: the errors that it states leave open {open}. Calibrate again; --since does without it."
            ),
            Some(Cause::Channels | Cause::Either) | None => format!(
                "Either the motion is too poor or a channel is wrong, which leaves open {open}. The sensor has to be turned about all axes, fast and long; \
                 a channel may be {WRONG}{}.",
                match self.residual_over_noise {
                    Some(times) =>
                        format!(": the coordination equations leave {times:.0} times their noise"),
                    None => String::new(),
                }
            ),
        }
    }

    /// What channels that contradict each other may be.
    fn channels_text(&self) -> String {
        format!(
            "They leave {:.0} times the noise that the calibration states, in a motion that is rich enough: a channel is {WRONG}, or \
             gains or the calibration are another sensor's.",
            self.residual_over_noise.unwrap_or(f64::NAN)
        )
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
                    "the calibration knows no stiffnesses: they are taken to differ by 0.5 % (one standard deviation), which hides drifts of several times that; --since does without"
                }
            };
            let _ = writeln!(out, "  {stiffnesses}");
        }
        if let (Some(common), Some(half)) = (self.common_percent, self.common_half_width_95_percent)
        {
            let _ = writeln!(
                out,
                "  common factor {common:+.4} % +- {half:.4}, with the error that all scale factors of the calibration share"
            );
        }
    }
}
