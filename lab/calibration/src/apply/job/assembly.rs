//! What a job is put together from: the decoupler, the stages before it, what runs beside it and what watches it.

use anyhow::{Context, Result, ensure};
use glam::DVec3;
use sixaxis_core::aided::AidedDecoupler;
use sixaxis_core::{Decoupler, Settings};

use super::Job;
use crate::apply::aided::Aided;
use crate::apply::attitude::{AttitudeStream, DOWN_DEG};
use crate::apply::axis_noise::SampleNoise;
use crate::apply::conditioning_stream::ConditioningStream;
use crate::apply::coordination::Coordination;
use crate::apply::decoding::Decoding;
use crate::apply::ends::Ends;
use crate::apply::exclusions::{Exclusions, Watched};
use crate::apply::fault_watch::FaultWatch;
use crate::apply::noise_level::NoiseLevel;

impl Job<'_> {
    pub(in crate::apply) fn decoupler(&self, settings: &Settings) -> Result<Decoupler> {
        Decoupler::new(&self.setup.sensor, &self.setup.parameters, settings)
            .with_context(|| self.calibration_name.display().to_string())?
            .excluding(self.excluded)
            .context("--excluded")
    }

    pub(in crate::apply) fn monitor(&self, settings: &Settings) -> Result<Option<FaultWatch>> {
        self.false_alarms_per_hour
            .map(|alarms| FaultWatch::new(self.setup, self.calibration, settings, alarms))
            .transpose()
    }

    /// Of a recording without these limbs; none where the monitor looks for them: its decoder undoes cross-talk itself, since it knows
    /// which channels have failed.
    pub(in crate::apply) fn conditioning(
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
    pub(super) fn excluded(&self) -> Option<Exclusions> {
        let watches = self.false_alarms_per_hour.is_some();
        (!watches).then(|| Exclusions::throughout(self.excluded))
    }

    /// A decoding of the columns, with the attitude followed wherever its deviation is known: not where the run is corrected from rest to
    /// rest.
    pub(super) fn decoding(&self, settings: &Settings, found: Option<Watched>) -> Result<Decoding> {
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
        if !watches && decoding.watched.is_none() && !self.rest_to_rest {
            decoding.noise_level = NoiseLevel::new(self.setup, self.calibration, self.excluded);
        }
        // How zeros wander is in the deviations of the error filter alone.
        let wanders =
            self.setup.conditioning.amplifier_high_pass_hz.is_some() && !self.rest_to_rest;
        let aided = !self.aids.is_empty() || self.uncertainty && wanders;
        let option = if self.aids.is_empty() {
            "--uncertainty"
        } else {
            "--aid"
        };
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
                Ok((filter, channels)) if aided => {
                    let noise = self
                        .uncertainty
                        .then(|| SampleNoise::new(self.setup, settings, self.excluded, &channels))
                        .transpose()?;
                    let parameters = &self.setup.parameters;
                    let decoder = AidedDecoupler::new(decoupler, filter, parameters, settings);
                    let decoder = if self.smooth {
                        decoder.remembering()
                    } else {
                        decoder
                    };
                    let rate_hz = settings.sample_rate_hz;
                    let aided = Aided::new(decoder, self.aids, &channels.white_v, rate_hz)?;
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
                Err(error) if aided => return Err(error.context(option)),
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
    pub(super) fn smoothed_decoding(
        &self,
        attitude: AttitudeStream,
        settings: &Settings,
    ) -> Result<Decoding> {
        let mut decoding = Decoding::new(self.decoupler(settings)?, self.columns, self.picture);
        decoding.gravity_ground_m_s2 = settings.gravity_ground_m_s2;
        decoding.ends = Some(self.ends(settings.sample_rate_hz));
        decoding.attitude = Some(attitude.written_to(self.columns));
        decoding.deviates = self.uncertainty;
        Ok(decoding)
    }

    pub(super) fn ends(&self, sample_rate_hz: f64) -> Ends {
        Ends::new(self.setup, self.calibration, sample_rate_hz)
    }

    pub(super) fn coordination(&self) -> Coordination {
        let mut coordination = Coordination::new(self.setup, self.calibration);
        coordination.exclude(self.excluded);
        coordination
    }
}
