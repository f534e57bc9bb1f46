//! What was found, drawn: the channel of the recording that a finding names, beside it a healthy neighbour, each with what the
//! standards and the other trials make one expect of it.

mod curves;

use sixaxis_core::identify::static_load_sharing::StaticLoadSharing;
use sixaxis_core::{LIMBS, Parameters};

use super::findings::capital;
use crate::calibrate::CalibratedSession;
use crate::conditioning::Conditioned;
use crate::diagnosis::table::Table;
use crate::finding::{Cause, Finding};
use crate::page::labels::largest;
use crate::series::upper_median;
use crate::trial::{Trial, same_wedge};
use curves::{Curves, View, figures, finite_extent};
use sixaxis_page::Block;
use sixaxis_recordings::session::{Role, SessionFile};

/// Findings that are drawn.
const MOST: usize = 6;

/// Times its neighbour's difference from which a channel's shows something.
const SHOWS: f64 = 1.5;

/// A picture of each of the first findings that name a recording or a channel; of those alike, of one.
pub fn blocks(file: &SessionFile, calibrated: &CalibratedSession) -> Vec<Block> {
    let sensor = &file.session.sensor;
    let Ok(shares) = StaticLoadSharing::new(&sensor.geometry()) else {
        return Vec::new();
    };
    let design = sensor.design();
    let inertia_m2 = Some(design.inertia_per_mass.matrix_mass_m2());
    let mut table = calibrated.table.clone().unwrap_or_else(|| Table {
        shares,
        mass_over_scale_kg: design.scale_per_mass_per_kg.map(f64::recip),
        inertia_m2,
        angle_error: 0.0,
        silent: [false; LIMBS],
    });
    table.inertia_m2 = table.inertia_m2.or(inertia_m2);
    let day = Day {
        design,
        table,
        calibrated,
    };
    let mut drawn: Vec<&Finding> = Vec::new();
    let mut blocks = Vec::new();
    for finding in &calibrated.findings {
        let alike =
            |other: &&Finding| (other.cause, &other.channels) == (finding.cause, &finding.channels);
        if drawn.len() == MOST || drawn.iter().any(alike) {
            continue;
        }
        let picture = day.picture(finding, drawn.len() + 1);
        if !picture.is_empty() {
            drawn.push(finding);
        }
        blocks.extend(picture);
    }
    if !blocks.is_empty() {
        blocks.insert(0, Block::Heading("How it looks".to_owned()));
    }
    blocks
}

struct Day<'a> {
    design: Parameters,
    /// What all trials agree on; where there is no such thing, the design.
    table: Table,
    calibrated: &'a CalibratedSession,
}

impl<'a> Day<'a> {
    fn picture(&self, finding: &Finding, number: usize) -> Vec<Block> {
        let subjects = self.subjects(finding);
        let Some(first) = subjects.first() else {
            return Vec::new();
        };
        let neighbour = self.neighbour(finding, first);
        let all = subjects.iter().chain(&neighbour);
        let mut curves: Vec<Curves<'_>> = all.map(|view| self.curves(finding, *view)).collect();
        // Of one recording the same moment.
        let shown = curves[0].shown.clone();
        for other in &mut curves {
            if core::ptr::eq(other.view.trial, first.trial) {
                other.shown.clone_from(&shown);
            }
        }
        let figures = figures(&curves, &format!("finding-{number}"), subjects.len());
        let beside = neighbour.map_or_else(String::new, |view| {
            format!(
                " Beside it {}, with which nothing was found wrong.",
                view.words()
            )
        });
        let at_rest = first.trial.role == Role::Static;
        let by_design = if at_rest || self.calibrated.table.is_some() {
            ""
        } else {
            " The dashed curves are the design's: there is nothing that all trials agree on."
        };
        let text = format!(
            "**{}**: {} {}.{beside}{by_design}",
            capital(finding.cause.name()),
            first.words(),
            if at_rest {
                seen_at_rest(finding.cause)
            } else if curves.last().is_some_and(|last| {
                curves.len() > subjects.len() && curves[0].largest_v() < SHOWS * last.largest_v()
            }) {
                "follows what the standards ask for no worse than its neighbour: what is wrong does not show here"
            } else {
                seen_in_motion(finding.cause)
            }
        );
        vec![Block::Text(text), Block::FigureGrid(figures)]
    }

    /// Recordings and channels that a finding names; what it leaves open is chosen so that most is seen of it.
    fn subjects(&self, finding: &Finding) -> Vec<View<'a>> {
        let recordings = self.calibrated.recordings.iter();
        let named = |name: &String| finding.recordings.contains(name);
        let mut candidates = recordings.filter(|(trial, _)| named(&trial.name));
        let channels = finding.channels.iter().filter_map(|c| c.checked_sub(1));
        let channels: Vec<usize> = channels.filter(|c| *c < LIMBS).collect();
        let of = |(trial, conditioned): &'a (Trial, Option<Conditioned>), channel| View {
            trial,
            conditioned: conditioned.as_ref(),
            channel,
        };
        let recording = match (candidates.next(), channels.first()) {
            (Some(recording), _) => recording,
            // A recording that could not be used is not in memory, and a finding of everything names nothing.
            (None, Some(channel)) if finding.recordings.is_empty() => {
                let moving = self.calibrated.recordings.iter();
                let moving = moving.filter(|(trial, _)| trial.role == Role::Linear);
                let swings = moving.map(|r| (self.swing(&of(r, *channel)), r));
                match largest(swings) {
                    Some((_, recording)) => recording,
                    None => return Vec::new(),
                }
            }
            _ => return Vec::new(),
        };
        if channels.is_empty() {
            let views = (0..LIMBS).map(|channel| of(recording, channel));
            let worst = largest(views.map(|view| (self.departure_v(finding, &view), view)));
            return worst.map(|(_, view)| view).into_iter().collect();
        }
        channels
            .iter()
            .map(|channel| of(recording, *channel))
            .collect()
    }

    /// Another channel of the recording, or the same one of another recording where the whole recording is named: one that is
    /// found no fault with and moves most.
    fn neighbour(&self, finding: &Finding, of: &View<'a>) -> Option<View<'a>> {
        let healthy = |view: &View<'_>| {
            let mut findings = self.calibrated.findings.iter();
            let specific = |f: &&Finding| !(f.recordings.is_empty() && f.channels.is_empty());
            !findings.any(|f| specific(&f) && f.concerns(&view.trial.name, view.channel + 1))
        };
        let views: Vec<View<'a>> = if finding.channels.is_empty() {
            let others = self.calibrated.recordings.iter();
            let others = others.filter(|(trial, _)| trial.role != Role::Static);
            let view = |(trial, conditioned): &'a (Trial, Option<Conditioned>)| View {
                trial,
                conditioned: conditioned.as_ref(),
                channel: of.channel,
            };
            let views: Vec<View<'a>> = others.map(view).filter(healthy).collect();
            // Most alike are those of one kind on one wedge, then those of one kind.
            let alike = |view: &View<'_>| {
                let (role, direction) = (of.trial.role, of.trial.direction_ground);
                let wedge = same_wedge(view.trial.direction_ground, direction);
                u8::from(view.trial.role == role) * (1 + u8::from(wedge))
            };
            let most = views.iter().map(alike).max();
            let views = views.into_iter();
            views.filter(|view| Some(alike(view)) == most).collect()
        } else {
            let views = (0..LIMBS).map(|channel| View { channel, ..*of });
            views.filter(healthy).collect()
        };
        largest(views.into_iter().map(|view| (self.swing(&view), view))).map(|(_, view)| view)
    }

    /// Largest expected swing of a channel, or recorded swing where nothing can be expected, V.
    fn swing(&self, view: &View<'_>) -> f64 {
        let swing = |series: &[f64]| {
            let (low, high) = finite_extent(series.iter().copied());
            high - low
        };
        match self.expected_v(view, &view.recorded_v(), false) {
            Some(expected) => swing(&expected),
            None => swing(&view.recorded_v()),
        }
    }

    fn departure_v(&self, finding: &Finding, view: &View<'_>) -> f64 {
        self.curves(finding, *view).largest_v()
    }

    /// What a channel should show: by what all trials agree on, or by the design where the channel is at fault in all of them.
    fn expected_v(&self, view: &View<'_>, recorded_v: &[f64], by_design: bool) -> Option<Vec<f64>> {
        let table = &self.table;
        let design = |channel: usize| 1.0 / self.design.scale_per_mass_per_kg[channel];
        let agreed = table.mass_over_scale_kg[view.channel];
        let mass_over_scale_kg = if by_design || table.silent[view.channel] || agreed == 0.0 {
            // Sensors differ from the design by a factor that is much the same for all limbs.
            let usual = (0..LIMBS).filter(|i| !table.silent[*i]);
            let ratio = |i: usize| (table.mass_over_scale_kg[i] / design(i)).abs();
            design(view.channel) * upper_median(usual.map(ratio))?
        } else {
            agreed
        };
        let factor = mass_over_scale_kg / view.trial.gains.gain_n_per_v[view.channel];
        let force = table.force_per_mass_m_s2(view.channel, view.trial, view.conditioned?)?;
        let moved: Vec<f64> = force.iter().map(|f| factor * f).collect();
        // The zero, from what the two have in common most of the time.
        let apart = recorded_v.iter().zip(&moved).map(|(u, e)| u - e);
        let zero_v = upper_median(apart)?;
        Some(moved.into_iter().map(|e| e + zero_v).collect())
    }

    fn curves<'v>(&self, finding: &Finding, view: View<'v>) -> Curves<'v> {
        let concerned = finding.channels.contains(&(view.channel + 1));
        let by_design = finding.recordings.is_empty() && concerned;
        let recorded_v = view.recorded_v();
        let expected_v = self.expected_v(&view, &recorded_v, by_design);
        let mut curves = Curves {
            view,
            shown: 0..recorded_v.len(),
            recorded_v,
            expected_v,
        };
        curves.shown = curves.window(finding.cause);
        curves
    }
}

/// What to look at in a recording at rest.
const fn seen_at_rest(cause: Cause) -> &'static str {
    match cause {
        Cause::DeadLimb => "shows not even noise",
        Cause::DriftDuringRun => "does not keep its zero, or not that of the runs",
        _ => "as it was recorded at rest",
    }
}

/// What to look at in a run, where the dashed curve is what the standards and the other trials make one expect.
const fn seen_in_motion(cause: Cause) -> &'static str {
    match cause {
        Cause::ClippedConverter => {
            "stands still where the dashed curve, which the motion asks for, goes on: what is missing peaks in the difference, below"
        }
        Cause::DeadLimb => {
            "shows nothing, throughout or for a while, where the dashed curve, which the motion asks for, goes up and down"
        }
        Cause::SwappedChannels => {
            "is one of those that miss their dashed curve, which the motion asks for, and follow another's"
        }
        Cause::InvertedChannel => {
            "is the mirror image of the dashed curve, which the motion asks for"
        }
        Cause::MillivoltMixUp | Cause::WrongScaling | Cause::FadingSensitivity => {
            "has another size than the dashed curve, which the motion asks for"
        }
        Cause::DriftDuringRun => {
            "does not keep its zero: what the motion does not ask for, below, ends elsewhere than it begins"
        }
        Cause::ClockMismatch | Cause::GyroscopeLag => {
            "and the dashed curve, which the standards ask for, are apart in time: the difference, below, is largest where they are steepest"
        }
        Cause::LooseWedge | Cause::ForeignTrial => {
            "answers to the motion in another proportion than in the other trials, which the dashed curve shows"
        }
        _ => {
            "does not follow the dashed curve, which the standards and the other trials ask for: the difference is below"
        }
    }
}
