//! One recording to one result: what is to be done, and what is known when it is done.

use std::cell::Cell;
use std::path::Path;

use anyhow::{Context, Result, ensure};
use glam::DVec3;
use sixaxis_core::aided::AidedDecoupler;
use sixaxis_core::{Decoupler, LimbSet, Scheme, Settings};
use sixaxis_recordings::{BEGAN, Channel, Layout, Sink};

use super::aided::Aided;
use super::aids::AidChoice;
use super::attitude::{AttitudeStream, DOWN_DEG};
use super::axis_noise::sample_noise;
use super::columns::{Columns, DEVIATIONS};
use super::conditioning_stream::ConditioningStream;
use super::coordination::Coordination;
use super::decoding::Decoding;
use super::decoupled::Decoupled;
use super::ends::Ends;
use super::exclusions::{Exclusions, Watched, flags};
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
    pub(super) fn decoupler(&self, settings: &Settings) -> Result<Decoupler> {
        Decoupler::new(&self.setup.sensor, &self.setup.parameters, settings)
            .with_context(|| self.calibration_name.display().to_string())?
            .excluding(self.excluded)
            .context("--excluded")
    }

    pub(super) fn monitor(&self, settings: &Settings) -> Result<Option<FaultWatch>> {
        self.false_alarms_per_hour
            .map(|alarms| FaultWatch::new(self.setup, self.calibration, settings, alarms))
            .transpose()
    }

    /// Of a recording without these limbs; none where the monitor looks for them: its decoder undoes cross-talk itself, since it knows
    /// which channels have failed.
    pub(super) fn conditioning(
        &self,
        sample_rate_hz: f64,
        excluded: Option<Exclusions>,
    ) -> Result<ConditioningStream> {
        let stream = ConditioningStream::new(&self.setup.conditioning, sample_rate_hz)?;
        Ok(match excluded {
            Some(excluded) => stream.excluding(excluded),
            None => stream.without_cross_talk(),
        })
    }

    /// Where the monitor does not look for them.
    fn excluded(&self) -> Option<Exclusions> {
        let watches = self.false_alarms_per_hour.is_some();
        (!watches).then(|| Exclusions::throughout(self.excluded))
    }

    /// A decoding of the columns, with the attitude followed wherever its deviation is known: not where the run is corrected from rest to
    /// rest.
    fn decoding(&self, settings: &Settings, found: Option<Watched>) -> Result<Decoding> {
        let decoupler = self.decoupler(settings)?;
        let gravity = settings.gravity_ground_m_s2;
        let mut decoding = Decoding::new(decoupler.clone(), self.columns, self.picture);
        decoding.gravity_ground_m_s2 = gravity;
        if !self.rest_to_rest {
            decoding.ends = Some(self.ends(settings.sample_rate_hz));
        }
        let watched = found.map(|found| self.watched_before(found, settings));
        decoding.watched = watched.transpose()?;
        if decoding.watched.is_none() {
            decoding.watching = self.monitor(settings)?;
        }
        let watches = decoding.watching.is_some();
        let aided = !self.aids.is_empty();
        ensure!(
            gravity != DVec3::ZERO || self.aids.iter().all(|aid| aid.file().is_some()),
            "--aid rest and velocity are held against gravity, and nobody says where down is: give --down or --session"
        );
        if !self.rest_to_rest {
            let down_rad = DOWN_DEG.to_radians();
            let filter =
                self.setup
                    .error_filter(self.calibration, settings, self.excluded, down_rad);
            match filter {
                Ok((filter, noise_v)) if aided => {
                    let noise = self
                        .uncertainty
                        .then(|| sample_noise(self.setup, settings, self.excluded, &noise_v))
                        .transpose()?;
                    let parameters = &self.setup.parameters;
                    let decoder = AidedDecoupler::new(decoupler, filter, parameters, settings);
                    let decoder = if self.smooth {
                        decoder.remembering()
                    } else {
                        decoder
                    };
                    let rate_hz = settings.sample_rate_hz;
                    let aided = Aided::new(decoder, self.aids, &noise_v, rate_hz)?;
                    let aids = aided.periodic();
                    let until_deg = self.until_sd_deg;
                    let mut attitude = AttitudeStream::aided(aided, settings, until_deg, noise);
                    let excluded = self.excluded;
                    let found = decoding.watched.as_ref().map(|watched| &watched.found);
                    if found.is_none_or(|found| found.excluded.is_empty()) {
                        let bound =
                            self.setup
                                .bound(self.calibration, settings, excluded, &aids)?;
                        attitude.bounded_by(bound);
                    }
                    decoding.attitude = Some(attitude.written_to(self.columns));
                }
                Ok((filter, _)) => {
                    let until_deg = self.until_sd_deg;
                    let beside = AttitudeStream::beside(filter, settings, until_deg, !watches);
                    decoding.attitude = Some(beside.written_to(self.columns));
                }
                Err(error) if aided => return Err(error.context("--aid")),
                Err(error) => decoding.say(format!(
                    "how long the attitude is known to --until-sd is not followed: {error:#}"
                )),
            }
        }
        if self.uncertainty {
            let open_loop = || {
                let setup = self.setup;
                setup.uncertainty(self.calibration, settings, self.excluded)
            };
            decoding.deviates = true;
            decoding.uncertainty = (!aided).then(open_loop).transpose()?.map(Box::new);
        }
        Ok(decoding)
    }

    /// The same by a smoothed attitude.
    fn smoothed_decoding(&self, attitude: AttitudeStream, settings: &Settings) -> Result<Decoding> {
        let mut decoding = Decoding::new(self.decoupler(settings)?, self.columns, self.picture);
        decoding.gravity_ground_m_s2 = settings.gravity_ground_m_s2;
        decoding.ends = Some(self.ends(settings.sample_rate_hz));
        decoding.attitude = Some(attitude.written_to(self.columns));
        decoding.deviates = self.uncertainty;
        Ok(decoding)
    }

    fn ends(&self, sample_rate_hz: f64) -> Ends {
        Ends::new(self.setup, self.calibration, sample_rate_hz)
    }

    fn coordination(&self) -> Coordination {
        let mut coordination = Coordination::new(self.setup, self.calibration);
        coordination.exclude(self.excluded);
        coordination
    }

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

    fn layout(&self, sample_rate_hz: f64) -> Layout {
        let mut layout = self.columns.layout(sample_rate_hz);
        if self.uncertainty {
            let deviations = DEVIATIONS.map(|(name, unit)| Channel {
                sample_rate_hz: Some(sample_rate_hz),
                ..Channel::new(name, Some(unit))
            });
            layout.channels.extend(deviations);
        }
        if self.false_alarms_per_hour.is_some() {
            layout.channels.extend(flags(sample_rate_hz));
        }
        layout
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
        let watches_first = self.false_alarms_per_hour.is_some() && !self.aids.is_empty();
        let passes = Cell::new(if self.smooth || watches_first { 2 } else { 1 });
        let advance = |samples| advance(passes.get() * total, samples);
        let mut of_monitor = Vec::new();
        let mut excluded = self.excluded();
        let mut found = None;
        if watches_first {
            let (watched, messages) = self.watched(&mut recording, &settings, &advance)?;
            of_monitor = messages;
            excluded = Some(watched.excluded.clone());
            found = Some(watched);
            recording = open()?;
        }
        let mut conditioning = self.conditioning(rate_hz, excluded.clone())?;
        let mut decoding = self.decoding(&settings, found)?;
        let mut coordination = self.coordination();
        let mut layout = self.layout(rate_hz);
        self.describe(path, &mut layout);
        let began = recording.began.clone();
        (layout.properties).extend(began.map(|began| (BEGAN.to_owned(), began)));
        let (mut trend, mut busy, mut of_aids) = (None, None, Vec::new());
        if self.rest_to_rest {
            let (mut stamps, mut ends) = (Vec::new(), self.ends(rate_hz));
            let (rows, found) = rest_to_rest::read(
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
            .map_err(|error| with_verdict(error, &mut coordination))?;
            rest_to_rest::write(&recording, &rows, &stamps, &mut decoding, create(&layout)?)
                .map_err(|error| with_verdict(error, &mut coordination))?;
            let moving = ends.begins_in_motion().into_iter();
            for why in moving.chain(ends.ends_in_motion()) {
                decoding.say(why);
            }
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
                })?;
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
        if decoding.rows == 0 {
            warnings.push(format!(
                "{}: samples: {}; a row needs three, the result is empty",
                path.display(),
                recording.seen.samples
            ));
        }
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

    /// The result's properties: where it is from.
    fn describe(&self, recording: &Path, layout: &mut Layout) {
        let name = |path: &Path| {
            let name = path.file_name().unwrap_or_default();
            name.to_string_lossy().into_owned()
        };
        let mut put = |key: &str, value: String| layout.properties.insert(key.to_owned(), value);
        put("sixaxis_version", env!("CARGO_PKG_VERSION").to_owned());
        put("recording", name(recording));
        put("calibration", name(self.calibration_name));
        put("verdict", self.calibration.verdict.word().to_owned());
        put("first_row_sample", "1".to_owned());
        if !self.excluded.is_empty() {
            put("excluded_limbs", self.excluded.to_string());
        }
    }
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
