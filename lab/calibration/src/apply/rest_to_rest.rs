//! A run that ends as it began, at rest in the same place: what the open loop gathers by then is drift and is taken off.
//! That needs the whole run at once.

use anyhow::{Result, bail};
use sixaxis_core::Settings;
use sixaxis_core::decouple::rest_to_rest::{self, Trend};
use sixaxis_recordings::{Block, Sink};

use super::conditioning_stream::ConditioningStream;
use super::decoding::Decoding;
use super::recording::{Batch, Recording};
use super::setup::Setup;
use super::voltages::Voltages;
use super::{CHUNK, Row, explain};

/// Samples of the longest run that is taken: 100 s at 20 kHz, 290 MB with the copy that is made of them.
pub const LIMIT: u64 = 2_000_000;

/// Reads and conditions a whole run and takes off the trend. What is read, and what conditioning made of it so far, is `seen`.
///
/// # Errors
/// A run of more than [`LIMIT`] samples; those of reading; a run for which no trend makes it close.
pub fn read(
    recording: &mut Recording,
    mut conditioning: ConditioningStream,
    setup: &Setup,
    settings: &Settings,
    seen: &mut dyn FnMut(&Batch, &Voltages),
) -> Result<(Vec<Row>, Trend)> {
    let place = recording.path.display().to_string();
    let refuse_length = |samples: u64| -> Result<()> {
        if samples > LIMIT {
            bail!(
                "{place}: more than {LIMIT} samples; --rest-to-rest holds the whole run in the memory: cut it at its rests"
            );
        }
        Ok(())
    };
    refuse_length(recording.samples.unwrap_or(0))?;
    let mut rows = Vec::new();
    let (mut batch, mut ready) = (Batch::default(), Voltages::default());
    while recording.read(&mut batch)? {
        refuse_length(recording.seen.samples)?;
        conditioning.push(&mut batch.voltage_v, &mut ready);
        seen(&batch, &ready);
        rows.extend(ready.rows());
        ready.clear();
    }
    // What a filter held back is the run's end.
    conditioning.finish(&mut ready)?;
    batch.times_s.clear();
    seen(&batch, &ready);
    rows.extend(ready.rows());
    rest_to_rest::detrend(&setup.sensor, &setup.parameters, settings, &rows)
        .map_err(|error| explain(&error, &place, &recording.names))
}

/// Decodes rows in memory into a sink and completes it.
///
/// # Errors
/// Those of decoding and writing.
pub fn write(
    recording: &Recording,
    rows: &[Row],
    stamps: &[f64],
    decoding: &mut Decoding,
    mut sink: Box<dyn Sink>,
) -> Result<()> {
    decoding.stamps(stamps);
    let mut block = Block::default();
    for part in rows.chunks(CHUNK) {
        let voltage_v: Voltages = part.iter().collect();
        decoding
            .decode(voltage_v.all(), &mut block)
            .map_err(|error| {
                explain(
                    &error,
                    &recording.path.display().to_string(),
                    &recording.names,
                )
            })?;
        sink.write(&block)?;
    }
    Ok(sink.finish()?)
}
