//! One recording to one result: what is to be done, and what is known when it is done.
//!
//! | file | holds |
//! |---|---|
//! | `assembly` | decoupler, stages and watchers that a job is put together from |
//! | `layout` | the result's columns, and where it is from |

mod assembly;
mod layout;

use std::cell::Cell;
use std::path::Path;

use anyhow::{Context, Result, ensure};
use sixaxis_core::{LimbSet, Scheme};
use sixaxis_recordings::{BEGAN, Layout, Sink};

use super::aids::AidChoice;
use super::columns::Columns;
use super::coordination::Coordination;
use super::decoupled::Decoupled;
use super::exclusions::Exclusions;
use super::fault_watch::FaultWatch;
use super::pipeline::{self, Nowhere};
use super::recording::Recording;
use super::rest_to_rest;
use super::setup::Setup;
use super::text_stream::TextStream;
use crate::calibration::Calibration;

/// What is to be decoupled, and how.
pub struct Job<'a> {
    /// The calibration.
    pub calibration: &'a Calibration,
    /// Its name in errors and in the result.
    pub calibration_name: &'a Path,
    /// What is known of the recording.
    pub setup: &'a Setup,
    /// Which columns are written.
    pub columns: Columns,
    /// How the rate is integrated.
    pub scheme: Scheme,
    /// Whether the run ends as it began, at rest in the same place, and is corrected to do so.
    pub rest_to_rest: bool,
    /// Whether standard deviations are written.
    pub uncertainty: bool,
    /// Expected false alarms in an hour of the fault monitor; none without it.
    pub false_alarms_per_hour: Option<f64>,
    /// Limbs whose channels are not read.
    pub excluded: LimbSet,
    /// Deviation of the attitude, degrees, up to which ground axes are given.
    pub until_sd_deg: f64,
    /// What else is known of the motion.
    pub aids: &'a [AidChoice],
    /// Whether each sample is decoupled by what was known later, too, in a second pass.
    pub smooth: bool,
    /// Whether curves are kept for a picture.
    pub picture: bool,
}

impl Job<'_> {
    /// Decouples a stream of rows of text at a known rate.
    ///
    /// # Errors
    /// Settings that do not fit the calibration or the rate.
    pub fn live(&self, sample_rate_hz: f64) -> Result<TextStream> {
        let settings = self.setup.settings(sample_rate_hz, self.scheme);
        let watched = self.false_alarms_per_hour.is_some();
        let conditioning = self.conditioning(sample_rate_hz, self.excluded())?;
        let mut decoding = self.decoding(&settings, None)?;
        decoding.coordination = Some(self.coordination());
        Ok(TextStream {
            conditioning,
            decoding,
            layout: self.layout(sample_rate_hz),
            excluded: self.excluded,
            watched,
            sample_rate_hz,
            channels: self.setup.channels.clone(),
            full_scale_v: self.setup.full_scale_v,
        })
    }

    /// Decouples a file into a sink, of which `create` is told the columns; `advance` is told of the
    /// samples that there are, 0 where it is not known, and of those that have been decoded since.
    ///
    /// # Errors
    /// Settings that do not fit the calibration or the recording; a recording that cannot be read, or has no answer; a
    /// sink that cannot be written. The result is not there then.
    pub fn run(
        &self,
        path: &Path,
        create: &dyn Fn(&Layout) -> Result<Box<dyn Sink>>,
        advance: &dyn Fn(u64, u64),
    ) -> Result<Decoupled> {
        let setup = self.setup;
        let open = || -> Result<Recording> {
            let stated_hz = setup.rate_hz;
            let (channels, limit_v) = (&setup.channels, setup.full_scale_v);
            let mut new = Recording::open(path, channels, self.excluded, stated_hz, limit_v)?;
            new.watched = self.false_alarms_per_hour.is_some();
            Ok(new)
        };
        let mut recording = open()?;
        let rate_hz = recording.sample_rate_hz;
        let settings = setup.settings(rate_hz, self.scheme);
        let total = recording.samples.unwrap_or(0);
        let filters = setup.conditioning.low_pass_hz.is_some();
        let watches_first =
            self.false_alarms_per_hour.is_some() && (filters || !self.aids.is_empty());
        let passes = Cell::new(if self.smooth || watches_first { 2 } else { 1 });
        let advance = |samples| advance(passes.get() * total, samples);
        let mut of_monitor = Vec::new();
        let mut excluded = self.excluded();
        let mut found = None;
        let mut held = Exclusions::default();
        if watches_first {
            let (watched, messages) = self.watched(&mut recording, &settings, &advance)?;
            of_monitor = messages;
            let filtered = watched.reaching(setup.conditioning.reach(rate_hz));
            held = watched.excluded;
            excluded = Some(filtered.excluded.clone());
            found = Some(filtered);
            recording = open()?;
        }
        let conditioning = self.conditioning(rate_hz, excluded.clone())?;
        let mut conditioning = conditioning.holding(&held);
        let mut decoding = self.decoding(&settings, found)?;
        if let Some(watching) = &mut decoding.watching {
            watching.limit_v = recording.limit_v();
        }
        let mut coordination = self.coordination();
        let mut layout = self.layout(rate_hz);
        self.describe(path, &mut layout);
        let began = recording.began.clone();
        (layout.properties).extend(began.map(|began| (BEGAN.to_owned(), began)));
        let (mut trend, mut busy, mut of_aids) = (None, None, Vec::new());
        if self.rest_to_rest {
            let (mut stamps, mut ends) = (Vec::new(), self.ends(rate_hz));
            let read = rest_to_rest::read(
                &mut recording,
                conditioning,
                setup,
                &settings,
                &mut |batch, rows| {
                    stamps.extend_from_slice(&batch.times_s);
                    // As it was recorded: a trend that is taken off wrong forces may drown what is wrong with them.
                    coordination.look(rows.all());
                    ends.look_to_the_end(rows.all());
                },
            )
            .map_err(|error| with_verdict(error, &mut coordination));
            let moving = ends.begins_in_motion().into_iter();
            let moving: Vec<String> = moving.chain(ends.ends_in_motion()).collect();
            let because = |error: anyhow::Error| match moving.as_slice() {
                [] => error,
                why => anyhow::anyhow!("{error:#}; {}", why.join("; ")),
            };
            let (rows, found) = read.map_err(because)?;
            rest_to_rest::write(&recording, &rows, &stamps, &mut decoding, create(&layout)?)
                .map_err(|error| because(with_verdict(error, &mut coordination)))?;
            if !found.closes && moving.is_empty() {
                decoding.say("no straight line in its torques brings this run back to rest where it began (--rest-to-rest): the result is wrong".to_owned());
            }
            moving.into_iter().for_each(|why| decoding.say(why));
            trend = Some(found);
        } else {
            if self.smooth {
                // The first pass is remembered, and nothing of it written.
                let (first, sink) = (&mut decoding, Box::new(Nowhere));
                pipeline::pass(&mut recording, conditioning, first, sink, &advance)?;
                // What the first pass has said the second says again, but for what became of the aids.
                decoding.messages();
                decoding.finish();
                of_aids = decoding.messages();
                let attitude = decoding.smoothed(self.decoupler(&settings)?, &settings);
                let attitude = attitude.context("--smooth without --aid")?;
                decoding = self.smoothed_decoding(attitude, &settings)?;
                recording = open()?;
                conditioning = self.conditioning(rate_hz, excluded)?;
            }
            decoding.coordination = Some(coordination.clone());
            decoding.is_decoded_once_more();
            let (all, sink) = (&mut decoding, create(&layout)?);
            let mut written = pipeline::pass(&mut recording, conditioning, all, sink, &advance)
                .map_err(|error| match &mut decoding.coordination {
                    Some(coordination) => with_verdict(error, coordination),
                    None => error,
                })
                .map_err(|error| after(error, &of_monitor))?;
            let failed = |watch: &mut FaultWatch| !watch.found.excluded.is_empty();
            if let Some(watch) = decoding.watching.take_if(failed) {
                // Rows between a failure and its alarm have the failed limb in them: they are not kept.
                drop(written);
                passes.set(2);
                let (found, messages) = watch.into_found();
                of_monitor = messages;
                recording = open()?;
                conditioning = self.conditioning(rate_hz, Some(found.excluded.clone()))?;
                decoding = self.decoding(&settings, Some(found))?;
                decoding.coordination = Some(coordination.clone());
                let (all, sink) = (&mut decoding, create(&layout)?);
                written = pipeline::pass(&mut recording, conditioning, all, sink, &advance)?;
            }
            ensure!(
                decoding.rows > 0,
                "{}: samples: {}; a row of the result needs three",
                path.display(),
                recording.seen.samples
            );
            busy = Some(pipeline::complete(written)?);
        }
        decoding.finish();
        let mut warnings = recording.warnings();
        warnings.append(&mut of_monitor);
        warnings.extend(decoding.messages());
        // What both passes have come to is said once.
        of_aids.retain(|said| !warnings.contains(said));
        warnings.append(&mut of_aids);
        let no_motion = decoding.no_motion(rate_hz);
        warnings.extend(no_motion.map(|why| format!("{}: {why}", path.display())));
        let broken = decoding
            .coordination
            .as_mut()
            .unwrap_or(&mut coordination)
            .verdict();
        warnings.extend(broken.map(|broken| format!("{}: {broken}", path.display())));
        Ok(Decoupled {
            samples: recording.seen.samples,
            rows: decoding.rows,
            first_row_sample: 1,
            first_row_time_s: decoding.first_s,
            sample_rate_hz: rate_hz,
            scheme: self.scheme,
            gain_n_per_v: setup.sensor.gains.gain_n_per_v,
            gravity_ground_m_s2: setup.gravity_ground_m_s2.to_array(),
            low_pass_hz: setup.conditioning.low_pass_hz,
            excluded_limbs: self.excluded.numbers().collect(),
            clipped_samples: recording.seen.clipped,
            end_rate_before_rad_s: trend.map(|t| t.end_rate_before_rad_s.to_array()),
            end_rotation_before_rad: trend.map(|t| t.end_rotation_before_rad.to_array()),
            attitude: decoding.attitude().cloned(),
            busy,
            warnings,
            curves: decoding.picture,
        })
    }
}

/// What the fault monitor has said of a recording that cannot be decoded may be why.
fn after(error: anyhow::Error, of_monitor: &[String]) -> anyhow::Error {
    if of_monitor.is_empty() || error.is::<sixaxis_recordings::Error>() {
        return error;
    }
    let said = of_monitor.join("; ");
    anyhow::anyhow!("{error:#}; before that --watch said: {said}")
}

/// A recording that cannot be decoded may be one whose limb forces do not add up: then that is the cause.
fn with_verdict(error: anyhow::Error, coordination: &mut Coordination) -> anyhow::Error {
    if error.is::<sixaxis_recordings::Error>() {
        return error;
    }
    match coordination.verdict() {
        Some(broken) => anyhow::anyhow!("{error:#}; {broken}"),
        None => error,
    }
}
