//! Time per sample against the number of streams.

use std::hint::black_box;
use std::sync::Barrier;
use std::thread;
use std::time::Instant;

use sixaxis_core::decouple::lanes::push_lanes;
use sixaxis_core::kernel::simd::LANES;
use sixaxis_core::{Decoupler, Scheme};
use sixaxis_props::problem::recorded::Recorded;
use sixaxis_props::results::{Streams, StreamsPoint};

use crate::comparison::{Beside, judge_record};
use crate::timing::{
    Effort, Progress, Voltages, push_all, record_all, repeated, rounded, spread, time,
};
use sixaxis_benches::machine::logical_cores;

/// Turns of mere arithmetic on each thread, long enough that starting a thread does not count.
pub const SPINS: usize = 20;

/// Samples of each stream.
pub const STREAM_SAMPLES: usize = 1_000;

/// Recordings of as many streams, each in memory of its own.
pub struct Recordings {
    pub voltage_v: Vec<Voltages>,
}

impl Recordings {
    /// Each begins somewhere else in the run.
    pub fn cut(run: &[Voltages], streams: usize) -> Self {
        const STRIDE: usize = 97;
        let starts = run.len() - STREAM_SAMPLES;
        let windows = (0..streams).map(|i| &run[i * STRIDE % starts..][..STREAM_SAMPLES]);
        Self {
            voltage_v: windows.flatten().copied().collect(),
        }
    }

    pub fn each(&self) -> impl Iterator<Item = &[Voltages]> {
        self.voltage_v.chunks_exact(STREAM_SAMPLES)
    }

    /// Eights of streams; what is left over is left out.
    pub fn eights(&self) -> Vec<[&[Voltages]; LANES]> {
        let each: Vec<_> = self.each().collect();
        let (eights, _) = each.as_chunks();
        eights.to_vec()
    }
}

pub fn lanes_all(ready: &Decoupler, eights: &[[&[Voltages]; LANES]]) {
    for rows in eights {
        let mut streams = core::array::from_fn(|_| ready.clone());
        push_lanes(&mut streams, *rows, &mut |samples| {
            black_box(samples);
        })
        .expect("samples of recorded runs");
    }
}

/// The same with the eights shared out among threads, from when all have started to when the last is done. As many
/// repetitions as are asked for lie between, so that the threads need no more than to have been started once.
pub fn lanes_on_threads(
    ready: &Decoupler,
    eights: &[[&[Voltages]; LANES]],
    threads: usize,
    repeats: usize,
) -> f64 {
    let parts: Vec<_> = eights.chunks(eights.len().div_ceil(threads)).collect();
    let together = Barrier::new(parts.len());
    let work = |part| {
        together.wait();
        let start = Instant::now();
        (0..repeats).for_each(|_| lanes_all(black_box(ready), black_box(part)));
        (start, Instant::now())
    };
    let spans: Vec<_> = thread::scope(|scope| {
        let workers: Vec<_> = parts
            .iter()
            .map(|part| scope.spawn(|| work(part)))
            .collect();
        let ended = workers.into_iter().map(|worker| worker.join());
        ended.map(|span| span.expect("a thread's end")).collect()
    });
    let first = spans.iter().map(|(start, _)| *start).min();
    let last = spans.iter().map(|(_, end)| *end).max();
    match (first, last) {
        (Some(first), Some(last)) => (last - first).as_secs_f64(),
        _ => f64::NAN,
    }
}

/// Every stream in lanes held against push.
pub fn judge_lanes(ready: &Decoupler, eights: &[[&[Voltages]; LANES]]) {
    for rows in eights {
        let mut beside = rows.map(|rows| Beside::new(ready, rows.iter()));
        let mut streams = core::array::from_fn(|_| ready.clone());
        push_lanes(&mut streams, *rows, &mut |samples| {
            for sample in samples {
                for (lane, one) in beside.iter_mut().enumerate() {
                    one.compare([core::array::from_fn(|i| sample[i].0[lane])]);
                }
            }
        })
        .expect("samples of recorded runs");
        for one in beside {
            one.judge("eight streams in lanes", STREAM_SAMPLES);
        }
    }
}

pub fn streams(
    recorded: &Recorded,
    scheme: Scheme,
    effort: &Effort,
    progress: &Progress,
) -> Streams {
    let ready = &recorded.decoupler(scheme);
    let threads = logical_cores();
    let points = effort.streams.iter().map(|&streams| {
        let what = format!("{streams} streams");
        progress.say(&format!("{what}: comparing"));
        let recordings = Recordings::cut(&recorded.recording.voltage_v, streams);
        let eights = recordings.eights();
        for one in recordings.each() {
            judge_record(&what, ready, std::iter::once(one), STREAM_SAMPLES);
        }
        judge_lanes(ready, &eights);
        let each = || recordings.each().map(|one| std::iter::once(black_box(one)));
        let mut jobs = vec![
            repeated(|| each().for_each(|one| push_all(black_box(ready), one))),
            repeated(|| each().for_each(|one| record_all(black_box(ready), one))),
        ];
        if !eights.is_empty() {
            jobs.push(repeated(|| lanes_all(black_box(ready), black_box(&eights))));
            jobs.push(Box::new(|repeats| {
                lanes_on_threads(ready, &eights, threads, repeats)
            }));
        }
        let per_sample = 1e9 / (streams * STREAM_SAMPLES) as f64;
        let times = time(&what, &mut jobs, effort, progress);
        let mut spreads = times.into_iter().map(|t| spread(t, per_sample));
        let mut next = || spreads.next();
        StreamsPoint {
            streams,
            push_ns: next().expect("push was timed"),
            record_ns: next().expect("the record path was timed"),
            lanes_ns: next(),
            lanes_threads_ns: next(),
        }
    });
    Streams {
        scheme,
        samples_per_stream: STREAM_SAMPLES,
        points: points.collect(),
        threads,
        // After the points, at the same time of day.
        cores_given: cores_given(threads, effort, progress),
    }
}

/// How many cores' worth of time so many threads really get.
pub fn cores_given(threads: usize, effort: &Effort, progress: &Progress) -> f64 {
    const STEPS: u32 = 1_000_000;
    // Each step waits for the one before, so that nothing but a core can make it faster.
    let spin = || (0..STEPS).fold(1.0_f64, |x, i| black_box(x) * 0.5 + f64::from(i));
    let all = || {
        thread::scope(|scope| {
            for _ in 0..threads {
                scope.spawn(|| {
                    (0..SPINS).for_each(|_| {
                        black_box(spin());
                    })
                });
            }
        });
    };
    let mut jobs = [
        repeated(|| {
            (0..SPINS).for_each(|_| {
                black_box(spin());
            })
        }),
        repeated(all),
    ];
    let times = time("cores", &mut jobs, effort, progress);
    let [one, all] = [&times[0], &times[1]].map(|t| spread(t.clone(), 1.0).median);
    rounded(threads as f64 * one / all)
}
