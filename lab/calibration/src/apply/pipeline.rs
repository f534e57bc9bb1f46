//! From file to file: one thread reads, one decodes, one writes.

use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::{Builder, ScopedJoinHandle};
use std::time::{Duration, Instant};

use anyhow::{Result, anyhow};
use sixaxis_core::LIMBS;
use sixaxis_core::decouple::uncertainty::ZeroWander;
use sixaxis_recordings::{Block, Sink};

use super::conditioning_stream::ConditioningStream;
use super::decoding::Decoding;
use super::recording::{Batch, Recording};
use super::voltages::Voltages;
use super::{CHUNK, explain};

/// Blocks that may wait between two threads.
const WAITING: usize = 3;

/// Time that each thread worked, without waiting for the others.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize)]
pub struct Busy {
    /// Reading and converting to volts.
    pub read_s: f64,
    /// Conditioning and decoding.
    pub decode_s: f64,
    /// Writing, without the last flush to disk.
    pub write_s: f64,
    /// Completing the file: flush to disk, renaming.
    pub finish_s: f64,
}

/// Takes what a first pass decodes and nobody wants.
pub(super) struct Nowhere;

impl Sink for Nowhere {
    fn write(&mut self, _: &Block) -> sixaxis_recordings::Result<()> {
        Ok(())
    }

    fn finish(self: Box<Self>) -> sixaxis_recordings::Result<()> {
        Ok(())
    }
}

/// Decouples a recording into a sink, which is still to be completed.
///
/// `advance` is told of samples that have been decoded.
///
/// # Errors
/// Those of reading, of a sample that cannot be decoded, and of writing; the sink is then dropped unfinished.
pub fn pass(
    recording: &mut Recording,
    mut conditioning: ConditioningStream,
    decoding: &mut Decoding,
    sink: Box<dyn Sink>,
    advance: &dyn Fn(u64),
) -> Result<(Box<dyn Sink>, Busy)> {
    let place = recording.path.display().to_string();
    let names = recording.names.clone();
    let mut busy = Busy::default();
    let sink = std::thread::scope(|scope| -> Result<Box<dyn Sink>> {
        let (to_decode, batches) = sync_channel(WAITING);
        let (empty_batches, used_batches) = sync_channel(2 * WAITING);
        let (to_write, blocks) = sync_channel(WAITING);
        let (empty_blocks, used_blocks) = sync_channel(2 * WAITING);
        let named = |name: &str| Builder::new().name(name.to_owned());
        let reader =
            named("read").spawn_scoped(scope, || read(recording, to_decode, used_batches))?;
        let writer = named("write").spawn_scoped(scope, || write(sink, blocks, empty_blocks))?;
        let mut decode_time = Duration::ZERO;
        let mut decode = |wander: Option<ZeroWander>,
                          voltage_v: [&[f64]; LIMBS],
                          stamps: &mut Vec<f64>|
         -> Result<bool> {
            let mut block: Block = used_blocks.try_recv().unwrap_or_default();
            let started = Instant::now();
            // A filter may hold samples back; their stamps wait with the decoder.
            decoding.stamps(stamps);
            stamps.clear();
            decoding.allow_for(wander);
            let decoded = decoding.decode(voltage_v, &mut block);
            // Wrong attitudes may be what nothing can be decoded with.
            decoding.check_attitudes(decoded.is_err())?;
            decoded.map_err(|error| explain(&error, &place, &names))?;
            decode_time += started.elapsed();
            advance(voltage_v[0].len() as u64);
            Ok(to_write.send(block).is_ok())
        };
        let mut stamps = Vec::new();
        let mut pending = Voltages::default();
        let mut conditioning_time = Duration::ZERO;
        let mut listened_to = true;
        while listened_to && let Ok(mut batch) = batches.recv() {
            let started = Instant::now();
            stamps.extend_from_slice(&batch.times_s);
            conditioning.push(&mut batch.voltage_v, &mut pending);
            conditioning_time += started.elapsed();
            let _ = empty_batches.try_send(batch);
            let chunks = pending.samples() / CHUNK;
            for chunk in 0..chunks {
                let samples = chunk * CHUNK..(chunk + 1) * CHUNK;
                listened_to &= decode(
                    conditioning.zero_wander(),
                    pending.part(samples),
                    &mut stamps,
                )?;
            }
            pending.remove_first(chunks * CHUNK);
        }
        // The reader stops when nobody takes its batches.
        drop(batches);
        let read_time = join(reader)?;
        if listened_to {
            conditioning.finish(&mut pending)?;
            let samples = pending.samples();
            for first in (0..samples).step_by(CHUNK) {
                let part = pending.part(first..samples.min(first + CHUNK));
                decode(conditioning.zero_wander(), part, &mut stamps)?;
            }
        }
        decoding.check_attitudes(true)?;
        drop(to_write);
        let (sink, write_time) = join(writer)?;
        busy.read_s = read_time.as_secs_f64();
        busy.decode_s = (decode_time + conditioning_time).as_secs_f64();
        busy.write_s = write_time.as_secs_f64();
        Ok(sink)
    })?;
    Ok((sink, busy))
}

/// Completes what a pass has written.
///
/// # Errors
/// Those of writing.
pub fn complete((sink, mut busy): (Box<dyn Sink>, Busy)) -> Result<Busy> {
    let started = Instant::now();
    sink.finish()?;
    busy.finish_s = started.elapsed().as_secs_f64();
    Ok(busy)
}

fn read(
    recording: &mut Recording,
    to_decode: SyncSender<Batch>,
    used: Receiver<Batch>,
) -> Result<Duration> {
    let mut time = Duration::ZERO;
    loop {
        let mut batch = used.try_recv().unwrap_or_default();
        let started = Instant::now();
        let more = recording.read(&mut batch)?;
        time += started.elapsed();
        // Where nobody listens any more, the one who stopped says why.
        if !more || to_decode.send(batch).is_err() {
            return Ok(time);
        }
    }
}

fn write(
    mut sink: Box<dyn Sink>,
    blocks: Receiver<Block>,
    empty: SyncSender<Block>,
) -> Result<(Box<dyn Sink>, Duration)> {
    let mut time = Duration::ZERO;
    for block in blocks {
        let started = Instant::now();
        sink.write(&block)?;
        time += started.elapsed();
        let _ = empty.try_send(block);
    }
    Ok((sink, time))
}

fn join<T>(thread: ScopedJoinHandle<'_, Result<T>>) -> Result<T> {
    thread
        .join()
        .unwrap_or_else(|_| Err(anyhow!("a thread stopped without saying why")))
}
