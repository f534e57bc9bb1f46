//! Isolation of a failure: the sequence of decisions from an alarm until the limbs and the kind are known.
//!
//! The hypotheses are a failure of one limb, of whatever course ([`super::likelihood`]), two channels exchanged ([`super::swap`]) and
//! two or three limbs dead at once ([`super::silent`]). A hypothesis is accepted if what it leaves of the rows is noise, if no other
//! leaves noise, and if its likelihood leads. Exchanged channels leave noise without any free parameter: they are accepted before a
//! limb of a course of its own, but not where a flat channel may be a dead one. As long as there is another explanation the isolation
//! waits for the motion to decide; at last the answer is that it cannot be told.

use super::calibration_errors::CalibrationErrors;
use super::class::{CLASSES, members};
use super::detector::{Alarm, Detector};
use super::history::History;
use super::kind::judge;
use super::likelihood::{likelihood, likelihood_along};
use super::misfit::Misfit;
use super::noise::{RowNoise, dot, unit};
use super::silent::{Before, may_hide, sets};
use super::step::Ring;
use super::swap::Swaps;
use super::verdict::{Event, Kind, Verdict};
use super::window::Window;
use crate::geometry::LIMBS;
use crate::limb_set::LimbSet;
use crate::redundancy::parity::ROWS;

/// ln of the odds from which a hypothesis is accepted: ten thousand to one.
pub const ACCEPTED: f64 = 9.2;
/// Times its threshold beyond which no statistic of a sound sensor comes.
const FAR_BEYOND: f64 = 2.0;
/// Cosine from which two directions are one.
const ALIKE: f64 = 1.0 - 1e-9;
/// Cosine from which the same voltage on all channels is no rival of a limb. Without limb 1, 5 or 9 its direction is nearly that of the pair
/// whose relation is left whole, and no failure of that pair would be isolated.
const TOO_NEAR: f64 = 0.95;
/// Samples from one look at the hypotheses to the next. Channels that stand still have shown it by the first.
const LOOK: u64 = 32;
/// Samples after the alarm at which the statistics begin anew if nothing is decided by then.
const ANEW: u64 = 256;
/// Samples after that from which exchanged channels are told from dead ones in slow motion.
const SWAP_LOOK: u64 = 256;
/// Samples from which a failure of which it could not be told which limbs it is may be told after all: a hum, which is of no limb,
/// looks like one for a part of its period.
const LATE_LOOK: u64 = 1024;
/// Samples after the alarm at which a verdict falls however uncertain: that many at least, and as many windows of the test that failed.
const LAST_LOOK: u64 = 2048;
const LAST_WINDOWS: u64 = 16;

/// Where a failure came from: when, and what the channels were like before.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Origin {
    pub since: (u64, u64),
    pub before: Before,
}

/// An alarm, and the statistics since.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Isolation {
    alarm: Alarm,
    origin: Origin,
    /// Likelihood of the classes by the window that raised the alarm.
    before: [f64; CLASSES],
    /// Whether that window has nothing beside a failure of the class that goes along with it.
    along_before: [bool; CLASSES],
    /// Where the same voltage on all channels shows, as hum does or a zero that moves with the temperature, and its likelihood by that window.
    common: Option<[f64; ROWS]>,
    common_before: f64,
    window: Window,
    history: History,
    swaps: Swaps,
    steps: [f64; LIMBS],
    anew: bool,
    /// Whether there was more than a false alarm.
    real: bool,
    found: Option<Found>,
}

/// The limbs of which one has failed, once they lead.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Found {
    class: usize,
    limbs: LimbSet,
    ln_odds: f64,
}

/// One sample in all its forms: whitened rows, signals in their noise, strains, and strains counted from rest.
pub(super) struct Sample<'a> {
    pub z: &'a [f64; ROWS],
    pub signal: &'a [f64; LIMBS],
    pub strain: &'a [f64; LIMBS],
    pub from_rest: &'a [f64; LIMBS],
}

impl Isolation {
    /// When it began, and the channels before that, as a later alarm of the same failure finds it.
    pub const fn origin(&self) -> Origin {
        let mut origin = self.origin;
        origin.before.long_ago = true;
        origin
    }

    /// Begins with the window that raised the alarm, or with its sample: whitened rows and strains counted from rest; `zero_sd` are errors of
    /// the zeros in the channels' noise, `common` what the same voltage on all channels makes of the whitened rows.
    pub fn new(
        alarm: Alarm,
        origin: Origin,
        detector: &Detector,
        (z, from_rest): (&[f64; ROWS], &[f64; LIMBS]),
        zero_sd: [f64; LIMBS],
        common: &[f64; ROWS],
    ) -> Self {
        let noise = detector.noise();
        let mut window = detector.window_of(alarm.test);
        if window.rows.samples() == 0 {
            window.push(z, from_rest);
        }
        let before = likelihood(noise, &window.rows);
        let common = unit(common);
        let common_before = common.map_or(0.0, |d| likelihood_along(&d, &window.rows));
        let misfit = Misfit::new(noise, &window, detector.errors());
        let along_before =
            core::array::from_fn(|class| misfit.is_all_along(noise.direction(class)));
        Self {
            alarm,
            origin,
            before,
            along_before,
            common,
            common_before,
            window: Window::default(),
            history: History::new(zero_sd),
            swaps: Swaps::default(),
            steps: [0.0; LIMBS],
            anew: false,
            real: alarm.statistic > FAR_BEYOND * alarm.threshold,
            found: None,
        }
    }

    /// Takes a sample; `strain_of` is what strain a limb's sensitivity makes of a channel's voltage.
    pub fn push(
        &mut self,
        noise: &RowNoise,
        sample: &Sample<'_>,
        strain_of: impl Fn(usize, usize) -> f64,
    ) {
        self.window.push(sample.z, sample.from_rest);
        self.history.push(noise, sample.z, sample.signal);
        if self.found.is_none() {
            self.swaps.push(noise, sample.z, sample.strain, strain_of);
        }
    }

    /// Searches the channels for steps about the alarm, once, when enough samples follow it; `per_v` is one over their noise, 1/V.
    pub fn look_for_steps(&mut self, ring: &Ring, per_v: &[f64; LIMBS]) {
        if self.window.rows.samples() == LOOK && !self.anew {
            let (from, to) = self.origin.since;
            // A step within a window may show up to a sample beside it.
            self.steps = core::array::from_fn(|limb| {
                per_v[limb] * ring.largest_step(limb, from.saturating_sub(1), to + 1)
            });
        }
    }

    /// Limbs of which one has failed, if that is known.
    pub fn found(&self) -> Option<LimbSet> {
        self.found.map(|found| found.limbs)
    }

    fn is_last_look(&self) -> bool {
        let last = (LAST_WINDOWS * self.alarm.test.samples()).max(LAST_LOOK);
        self.window.rows.samples() >= last
    }

    fn verdict(&self, sample: u64, limbs: LimbSet, kind: Kind, class_ln_odds: f64) -> Verdict {
        Verdict {
            limbs,
            kind,
            since: self.origin.since,
            said_at: sample,
            class_ln_odds,
            kind_ln_odds: 0.0,
            partner_ln_odds: if limbs.len() == 1 { f64::INFINITY } else { 0.0 },
        }
    }

    /// The event of this sample, if one is decided. Limbs in `gone` are out of the question.
    pub fn event(
        &mut self,
        noise: &RowNoise,
        errors: Option<&CalibrationErrors>,
        sample: u64,
        gone: LimbSet,
    ) -> Option<Event> {
        if !self.window.rows.samples().is_multiple_of(LOOK) {
            return None;
        }
        match self.found {
            None => self.isolate(noise, errors, sample, gone),
            Some(found) => self.identify(noise, errors, sample, found),
        }
    }

    fn isolate(
        &mut self,
        noise: &RowNoise,
        errors: Option<&CalibrationErrors>,
        sample: u64,
        gone: LimbSet,
    ) -> Option<Event> {
        let n = self.window.rows.samples();
        if self.origin.before.long_ago && n < LATE_LOOK {
            return None;
        }
        let misfit = Misfit::new(noise, &self.window, errors);
        let since = likelihood(noise, &self.window.rows);
        let scores: [f64; CLASSES] = core::array::from_fn(|i| self.before[i] + since[i]);
        let one = OneLimb::new(noise, &misfit, &scores, gone);
        let dead = sets(noise, &misfit, &self.history, &self.origin.before, gone);
        let (pair, swap, swap_lead) = self.swaps.lead(gone);
        let energy = self.window.rows.energy();
        // The window that alarmed holds no strains, so that a pair cannot be scored by it: it is given the best class's score.
        let swap_score = swap + self.before.iter().copied().fold(0.0, f64::max);
        let swap_leaves_noise = swap > ACCEPTED && misfit.is_noise(energy - 2.0 * swap);
        // Zeros that have moved, several at once, stand or creep: something must move beside, and exchanged channels explain it.
        let [mean, slope] = self.window.rows.mean_and_slope();
        let standing = 0.5 * (dot(&mean, &mean) + dot(&slope, &slope));
        let swapped = swap_leaves_noise
            && swap - standing > ACCEPTED
            && !misfit.is_noise(energy - 2.0 * standing)
            && swap_lead > ACCEPTED
            && n >= SWAP_LOOK
            && self.anew
            && noise.relations() == ROWS
            && dead.count == 0
            && !self.origin.before.long_ago
            && (!one.explains || swap_score > one.score + ACCEPTED)
            && !one.limbs.indices().any(|limb| self.history.is_flat(limb));
        if swapped {
            let limbs = pair.into_iter().fold(LimbSet::EMPTY, LimbSet::with);
            return Some(self.decided(sample, limbs, Kind::Swapped, swap_lead));
        }
        let swap_competes = swap_leaves_noise && swap_score > one.score - ACCEPTED;
        // A set with a limb that explains the rows by itself is more than is needed.
        let dead_compete = dead.count > 0 && dead.common.minus(one.limbs) == dead.common;
        // A limb that stopped when the failure began is not cleared by another that explains the rows long after.
        let stopped = self.origin.before.stopped(&self.history);
        let dead_compete = dead_compete
            || self.origin.before.long_ago && !stopped.minus(one.limbs).minus(gone).is_empty();
        let direction = noise.direction(one.class);
        let is_all = self.along_before[one.class]
            && misfit.is_all_along(direction)
            && self.history.is_white_beside(direction, &misfit);
        let common = self.common.filter(|d| dot(d, direction).abs() < TOO_NEAR);
        let common = common.map_or(f64::NEG_INFINITY, |d| {
            self.common_before + likelihood_along(&d, &self.window.rows)
        });
        let margin = one.margin.min(one.score - common);
        if one.explains && is_all && margin > ACCEPTED && !swap_competes && !dead_compete {
            self.found = Some(Found {
                class: one.class,
                limbs: one.limbs,
                ln_odds: margin,
            });
            let verdict = self.verdict(sample, one.limbs, Kind::Unknown, margin);
            return Some(Event::Isolated(verdict));
        }
        let believed = dead.believed.filter(|_| dead.count == 1);
        if let Some(limbs) = believed
            && one.limbs.is_empty()
            && !swap_leaves_noise
            && !may_hide(noise, &self.history, limbs, gone)
        {
            let at_zero = |limb| self.history.is_at_zero(limb);
            let kind = if limbs.indices().all(at_zero) {
                Kind::Dead
            } else {
                Kind::Stuck
            };
            return Some(self.decided(sample, limbs, kind, f64::INFINITY));
        }
        if n == ANEW && !self.anew {
            // What began with the alarm may have gone on to other limbs before it settled.
            self.anew = true;
            self.real |= !misfit.is_quiet_everywhere();
            self.before = [0.0; CLASSES];
            self.along_before = [true; CLASSES];
            self.common_before = 0.0;
            self.window = Window::default();
            self.history = self.history.anew();
            self.swaps = Swaps::default();
            return None;
        }
        let untold = |kind| Event::Identified(self.verdict(sample, LimbSet::EMPTY, kind, 0.0));
        self.is_last_look()
            .then(|| match (misfit.is_quiet_everywhere(), self.real) {
                (false, _) => untold(Kind::Unknown),
                // What it has done to rate and attitude stays.
                (true, true) => untold(Kind::Passed),
                (true, false) => Event::Dismissed,
            })
    }

    fn decided(&self, sample: u64, limbs: LimbSet, kind: Kind, ln_odds: f64) -> Event {
        Event::Identified(Verdict {
            kind_ln_odds: ln_odds,
            partner_ln_odds: f64::INFINITY,
            ..self.verdict(sample, limbs, kind, ln_odds)
        })
    }

    fn identify(
        &self,
        noise: &RowNoise,
        errors: Option<&CalibrationErrors>,
        sample: u64,
        found: Found,
    ) -> Option<Event> {
        let n = self.window.rows.samples();
        let over = self.is_last_look();
        if !(n.is_power_of_two() || over) {
            return None;
        }
        let misfit = Misfit::new(noise, &self.window, errors);
        if !misfit.is_quiet_beside(noise.direction(found.class)) {
            // A second failure has joined this one: the relations that are left will tell, kind and partner are lost.
            let verdict = self.verdict(sample, found.limbs, Kind::Unknown, found.ln_odds);
            return Some(Event::Identified(verdict));
        }
        let judged = judge(
            noise,
            found.class,
            found.limbs,
            &self.window.rows,
            &self.history,
            &self.steps,
        );
        if !(judged.is_firm() || over) {
            return None;
        }
        let mut verdict = self.verdict(sample, judged.limbs, judged.kind, found.ln_odds);
        verdict.kind_ln_odds = judged.kind_ln_odds;
        verdict.partner_ln_odds = judged.partner_ln_odds;
        Some(Event::Identified(verdict))
    }
}

/// The best class of limbs.
struct OneLimb {
    class: usize,
    score: f64,
    /// Limbs of all classes that leave noise.
    limbs: LimbSet,
    /// Whether the best class leaves noise, and no class of another direction does.
    explains: bool,
    /// ln of the odds against classes of another direction.
    margin: f64,
}

impl OneLimb {
    fn new(noise: &RowNoise, misfit: &Misfit<'_>, scores: &[f64; CLASSES], gone: LimbSet) -> Self {
        let shows = |class: &usize| noise.length(*class) > 0.0;
        let (mut class, mut score) = (0, f64::NEG_INFINITY);
        for (place, &value) in scores.iter().enumerate() {
            if shows(&place) && value > score {
                (class, score) = (place, value);
            }
        }
        let best = noise.direction(class);
        let (mut limbs, mut explains, mut margin) = (LimbSet::EMPTY, true, f64::INFINITY);
        for (other, &value) in scores.iter().enumerate().filter(|(c, _)| shows(c)) {
            let direction = noise.direction(other);
            // Without limbs that have failed before, two classes may show alike.
            let alike = dot(direction, best).abs() > ALIKE;
            let quiet = misfit.is_quiet_beside(direction);
            if quiet {
                limbs = limbs.union(members(other));
            }
            explains &= quiet == alike;
            if !alike {
                margin = margin.min(score - value);
            }
        }
        Self {
            class,
            score,
            limbs: limbs.minus(gone),
            explains,
            margin,
        }
    }
}
