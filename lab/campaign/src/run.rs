//! Seeds that no part has yet, worked off by all cores.
//!
//! Threads take case after case, not part after part: what is not yet a part is then never more than about a part for all of
//! them together, the last ones finish together, and memory does not depend on how many cases there are.

mod queue;

use core::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use rayon::ThreadPoolBuilder;

use self::queue::Queue;
use crate::case::calibrate;
use crate::error::{Error, Result};
use crate::folder::{self, Named};
use crate::part::{self, Provenance};
use crate::plan::{CampaignPlan, Shard};
use crate::row::Status;

/// What the caller is told while it works.
pub trait Watch: Sync {
    /// Work begins: cases to do, and cases that were found done.
    fn begins(&self, cases: u64, done: u64);
    /// A case is done; from any thread.
    fn case(&self);
    /// A part could not be used, lies under another name now, and its cases are done again.
    fn set_aside(&self, part: &Path, now: &Path, cause: &str);
}

/// What is to be done.
#[derive(Debug, Clone, Copy)]
pub struct Order<'a> {
    /// The campaign.
    pub plan: &'a CampaignPlan,
    /// Which shard of it.
    pub shard: Shard,
    /// Where the parts go; shards may share it.
    pub folder: &'a Path,
    /// Threads; 0 for one for each core.
    pub threads: usize,
}

/// What was done.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Done {
    /// Cases of this run.
    pub cases: u64,
    /// Those of them without parameters.
    pub failed: u64,
    /// Cases that earlier runs had done.
    pub found: u64,
}

/// Version of this program, as it stands in parts.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Does what is left of a shard to be done, and nothing twice: an interrupted run goes on, a finished one does nothing.
///
/// A part that is damaged is set aside and done again. The parts are the same whatever the number of threads, and the same
/// after any number of interruptions.
///
/// # Errors
/// [`Error::OtherCampaign`] if the folder has parts of another plan or version; [`Error::File`], [`Error::Threads`].
pub fn run(order: &Order, watch: &dyn Watch) -> Result<Done> {
    let provenance = Provenance {
        version: VERSION.to_owned(),
        plan: order.plan.text(),
        asked: order.plan.seeds(),
    };
    folder::claim(order.folder, &provenance.plan)?;
    let wanted = order.plan.shard(order.shard);
    let found = finished(order.folder, &wanted, &provenance, watch)?;
    let todo = left(&wanted, &found);
    let cases = todo.iter().map(|part| part.end - part.start).sum();
    let found = (wanted.end - wanted.start) - cases;
    watch.begins(cases, found);
    let threads = match order.threads {
        0 => std::thread::available_parallelism().map_or(1, usize::from),
        n => n,
    };
    let queue = Mutex::new(Queue::new(todo));
    let first_error = Mutex::new(None);
    let work = || {
        let outcome = worker(order, &provenance, &queue, watch);
        if let Err(error) = outcome {
            lock(&queue).close();
            lock(&first_error).get_or_insert(error);
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(work);
        }
    });
    if let Some(error) = first_error
        .into_inner()
        .unwrap_or_else(PoisonError::into_inner)
    {
        return Err(error);
    }
    let failed = lock(&queue).failed();
    Ok(Done {
        cases,
        failed,
        found,
    })
}

/// What a thread that panicked leaves behind is still whole: entries are made in one go.
fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// One thread's work until nothing is left.
fn worker(
    order: &Order,
    provenance: &Provenance,
    queue: &Mutex<Queue>,
    watch: &dyn Watch,
) -> Result<()> {
    // A case is parallel inside. In a pool of its own it stays on one thread, and no thread that waits for a part of one case
    // begins another on top of it, which would be a second session in memory.
    let alone = ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .map_err(|error| Error::Threads(error.to_string()))?;
    loop {
        let taken = lock(queue).take();
        let Some(task) = taken else {
            return Ok(());
        };
        let row = alone.install(|| calibrate(order.plan.session(), task.seed));
        let failed = row.status() != Some(Status::Calibrated);
        let complete = lock(queue).done(task, row, failed);
        if let Some(rows) = complete {
            part::write(order.folder, provenance, &rows)?;
        }
        watch.case();
    }
}

/// Seeds of parts that are there and whole, of those that are wanted.
fn finished(
    folder: &Path,
    wanted: &Range<u64>,
    provenance: &Provenance,
    watch: &dyn Watch,
) -> Result<Vec<Range<u64>>> {
    let mut found = Vec::new();
    for Named { first, end, path } in folder::parts(folder)? {
        if first >= wanted.end || end <= wanted.start {
            continue;
        }
        match part::read(&path) {
            Ok(read) => {
                folder::same_campaign(&path, &read.provenance, provenance)?;
                found.push(first..end);
            }
            Err(Error::Damaged { cause, .. }) => {
                let now: PathBuf = folder::set_aside(&path)?;
                watch.set_aside(&path, &now, &cause);
            }
            Err(other) => return Err(other),
        }
    }
    Ok(found)
}

/// Parts to be done: what is wanted without what is found, cut where an undisturbed run would cut.
fn left(wanted: &Range<u64>, found: &[Range<u64>]) -> Vec<Range<u64>> {
    let mut gaps = Vec::new();
    let mut from = wanted.start;
    // Ascending by their first seed, as `folder::parts` has them.
    for part in found {
        if part.start > from {
            gaps.push(from..part.start);
        }
        from = from.max(part.end);
    }
    if from < wanted.end {
        gaps.push(from..wanted.end);
    }
    let mut parts = Vec::new();
    for gap in gaps {
        let mut from = gap.start;
        while from < gap.end {
            let next_cut = from + part::CASES - (from - wanted.start) % part::CASES;
            let to = next_cut.min(gap.end);
            parts.push(from..to);
            from = to;
        }
    }
    parts
}
