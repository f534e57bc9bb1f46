//! One channel of one recording as it is drawn: recorded, expected, and the difference.

use core::ops::Range;

use crate::conditioning::Conditioned;
use crate::finding::Cause;
use crate::page::labels::{file_name, largest};
use crate::series::extent;
use crate::trial::Trial;
use sixaxis_page::figure::NEUTRAL;
use sixaxis_page::{Axis, Figure};

/// Periods of the drive that are shown of a run.
const PERIODS: f64 = 2.0;
/// Share of an axis that is left free on either side.
const MARGIN: f64 = 0.06;

/// One channel of one recording.
#[derive(Clone, Copy)]
pub struct View<'a> {
    pub trial: &'a Trial,
    pub conditioned: Option<&'a Conditioned>,
    /// From 0.
    pub channel: usize,
}

impl View<'_> {
    pub fn recorded_v(&self) -> Vec<f64> {
        let rows = self.trial.voltage_v.iter();
        rows.map(|row| row[self.channel]).collect()
    }

    pub fn words(&self) -> String {
        format!(
            "channel {} of {}",
            self.channel + 1,
            file_name(&self.trial.name)
        )
    }
}

/// A view with its curves, V.
pub struct Curves<'a> {
    pub view: View<'a>,
    pub recorded_v: Vec<f64>,
    pub expected_v: Option<Vec<f64>>,
    pub shown: Range<usize>,
}

impl Curves<'_> {
    /// Recorded less expected, of the samples shown.
    pub fn differences_v(&self) -> impl Iterator<Item = f64> {
        let expected = self.expected_v.as_deref().unwrap_or(&self.recorded_v);
        let both = self.recorded_v.iter().zip(expected);
        let shown = both.skip(self.shown.start).take(self.shown.len());
        shown.map(|(recorded, expected)| recorded - expected)
    }

    /// Largest size of that.
    pub fn largest_v(&self) -> f64 {
        self.differences_v().map(f64::abs).fold(0.0, f64::max)
    }

    /// Samples to show: some periods about the largest value of a clipped channel and about the largest difference of others, the whole of
    /// what drifts or rests.
    pub fn window(&self, cause: Cause) -> Range<usize> {
        let (trial, samples) = (self.view.trial, self.recorded_v.len());
        let period = trial.sample_rate_hz / trial.frequency_hz;
        if cause == Cause::DriftDuringRun || !period.is_finite() {
            return 0..samples;
        }
        let sizes: Vec<f64> = match (cause, &self.expected_v) {
            (Cause::ClippedConverter, _) | (_, None) => {
                self.recorded_v.iter().map(|u| u.abs()).collect()
            }
            _ => self.differences_v().map(f64::abs).collect(),
        };
        let at = sizes.iter().enumerate().map(|(k, size)| (*size, k));
        let middle = largest(at).map_or(0, |(_, k)| k);
        let length = ((PERIODS * period) as usize).min(samples);
        let start = middle.saturating_sub(length / 2).min(samples - length);
        start..start + length
    }

    fn figure(&self, id: String, title: String, voltage: Axis, difference: Axis) -> Figure {
        let time = |k: usize| k as f64 / self.view.trial.sample_rate_hz;
        let points = |series: &[f64]| -> Vec<(f64, f64)> {
            let shown = self.shown.clone();
            shown.map(|k| (time(k), series[k])).collect()
        };
        let figure = Figure::new(id, title, Axis::linear("time", "s"), voltage);
        let figure = figure.line("recorded", 0, points(&self.recorded_v));
        let Some(expected) = &self.expected_v else {
            return figure;
        };
        let times = self.shown.clone().map(time);
        figure
            .dashed("expected", NEUTRAL, points(expected))
            .below(difference)
            .line("recorded less expected", 1, times.zip(self.differences_v()))
    }
}

/// All of a finding on the same axes, so that what is large in one does not look large in another by itself.
pub fn figures(curves: &[Curves<'_>], id: &str, subjects: usize) -> Vec<Figure> {
    let within = |(low, high): (f64, f64)| {
        let margin = MARGIN * (high - low);
        (low < high).then_some((low - margin, high + margin))
    };
    let shown = curves.iter().flat_map(|c| {
        let both = [Some(&c.recorded_v), c.expected_v.as_ref()];
        let both = both.into_iter().flatten();
        both.flat_map(|series| series[c.shown.clone()].iter().copied())
    });
    let voltages = within(finite_extent(shown));
    let differences = within(finite_extent(curves.iter().flat_map(Curves::differences_v)));
    let axis = |name: &str, range: Option<(f64, f64)>| Axis {
        range,
        ..Axis::linear(name, "V")
    };
    let all = curves.iter().enumerate().map(|(k, curves)| {
        let role = if k < subjects {
            ""
        } else {
            ", healthy neighbour"
        };
        curves.figure(
            format!("{id}-{}", k + 1),
            format!(
                "{}, channel {}{role}",
                file_name(&curves.view.trial.name),
                curves.view.channel + 1
            ),
            axis("voltage", voltages),
            axis("recorded less expected", differences),
        )
    });
    all.collect()
}

/// Smallest and largest of the finite values.
pub fn finite_extent(values: impl Iterator<Item = f64>) -> (f64, f64) {
    extent(values.filter(|x| x.is_finite()))
}
