//! A pass over a recording of which nothing is written: what the monitor finds in it.

use anyhow::Result;
use sixaxis_core::{LimbSet, Settings};

use super::attitude::DOWN_DEG;
use super::axis_noise::SampleNoise;
use super::conditioning_stream::ConditioningStream;
use super::decoding::Decoding;
use super::exclusions::{Watched, WatchedBefore};
use super::fault_watch::FaultWatch;
use super::job::Job;
use super::pipeline::{self, Nowhere};
use super::recording::Recording;

impl Job<'_> {
    /// What the monitor says of a recording, before it is decoded with aids or filtered: only then is it known from which sample on a
    /// limb has failed. The rows that it sees are not filtered.
    pub(super) fn watched(
        &self,
        recording: &mut Recording,
        settings: &Settings,
        advance: &dyn Fn(u64),
    ) -> Result<(Watched, Vec<String>)> {
        let mut decoding = Decoding::new(self.decoupler(settings)?, self.columns, false);
        decoding.watching = self.monitor(settings)?;
        decoding.is_decoded_once_more();
        let (config, rate_hz) = (&self.setup.conditioning, settings.sample_rate_hz);
        if let Some(watching) = &mut decoding.watching {
            watching.reach = config.reach(rate_hz);
            watching.limit_v = recording.limit_v();
        }
        let unfiltered = ConditioningStream::new(&config.unfiltered(), rate_hz)?;
        let conditioning = unfiltered.without_cross_talk();
        let sink = Box::new(Nowhere);
        pipeline::pass(recording, conditioning, &mut decoding, sink, advance)?;
        let watch = decoding.watching.map(FaultWatch::into_found);
        Ok(watch.unwrap_or_default())
    }

    /// What is said of these limbs, and the noise of each sample without them.
    pub(super) fn watched_before(
        &self,
        found: Watched,
        settings: &Settings,
    ) -> Result<WatchedBefore> {
        let noise = |(from, limbs): (u64, LimbSet)| {
            let (_, channels) = (self.setup).error_filter(
                self.calibration,
                settings,
                limbs,
                DOWN_DEG.to_radians(),
            )?;
            Ok((
                from,
                SampleNoise::new(self.setup, settings, limbs, &channels)?,
            ))
        };
        let changes = found.excluded.changes().filter(|_| self.uncertainty);
        Ok(WatchedBefore {
            noise: changes.map(noise).collect::<Result<_>>()?,
            found,
        })
    }
}
