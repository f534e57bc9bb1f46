//! How long a job takes beside others: rounds in which everybody takes a turn, medians and quartiles.

use std::hint::black_box;
use std::io::Write;
use std::time::Instant;

pub use sixaxis_benches::spread::{rounded, spread};
use sixaxis_core::{Decoupler, LIMBS};

pub type Voltages = [f64; LIMBS];

/// Rounds at least.
pub const ROUNDS_LEAST: usize = 3;

/// How long to measure.
pub struct Effort {
    pub rounds: usize,
    /// Least time of one measurement, s.
    pub least_s: f64,
    /// What takes long gets fewer rounds, so that all rounds of one job take about this, s.
    pub most_s: f64,
    pub streamed: &'static [usize],
    pub held: &'static [usize],
    pub streams: &'static [usize],
}

pub const FULL: Effort = Effort {
    rounds: 15,
    least_s: 1e-2,
    most_s: 6.0,
    streamed: &[1_000, 10_000, 100_000, 1_000_000, 10_000_000, 100_000_000],
    held: &[1_000, 10_000, 100_000, 1_000_000, 10_000_000],
    streams: &[1, 8, 64, 512, 4_096],
};

pub const QUICK: Effort = Effort {
    rounds: 5,
    least_s: 1e-3,
    most_s: 0.5,
    streamed: &[1_000, 10_000, 100_000, 1_000_000],
    held: &[1_000, 10_000, 100_000],
    streams: &[1, 8, 64, 512],
};

/// One line on a terminal that says how far things are.
pub struct Progress {
    pub shown: bool,
}

impl Progress {
    pub fn say(&self, text: &str) {
        if self.shown {
            eprint!("\r\x1b[K{text}");
            let _ = std::io::stderr().flush();
        }
    }
}

/// Does the same work as often as asked and says how long that took, s.
pub type Job<'a> = Box<dyn FnMut(usize) -> f64 + 'a>;

pub fn repeated<'a>(mut once: impl FnMut() + 'a) -> Job<'a> {
    Box::new(move |repeats| {
        let start = Instant::now();
        (0..repeats).for_each(|_| once());
        start.elapsed().as_secs_f64()
    })
}

/// Seconds that each job takes once: one list per job, one entry per round.
pub fn time(what: &str, jobs: &mut [Job], effort: &Effort, progress: &Progress) -> Vec<Vec<f64>> {
    let repeats: Vec<usize> = jobs
        .iter_mut()
        .map(|job| {
            job(1);
            (effort.least_s / job(1)).ceil().max(1.0) as usize
        })
        .collect();
    let (mut times, mut spent_s) = (vec![Vec::new(); jobs.len()], 0.0);
    for round in 0..effort.rounds {
        // Quartiles want a few rounds, however long they take.
        if round >= ROUNDS_LEAST && spent_s > effort.most_s * jobs.len() as f64 {
            break;
        }
        progress.say(&format!(
            "{what}: round {} of at most {}",
            round + 1,
            effort.rounds
        ));
        for turn in 0..jobs.len() {
            // There and back, so that nobody always follows the same neighbour.
            let back = jobs.len() - 1 - turn;
            let which = if round.is_multiple_of(2) { turn } else { back };
            let taken_s = jobs[which](repeats[which]);
            spent_s += taken_s;
            times[which].push(taken_s / repeats[which] as f64);
        }
    }
    times
}

/// Streams through a copy of `ready` and keeps nothing: what is timed as "push".
pub fn push_all<'a>(ready: &Decoupler, pieces: impl Iterator<Item = &'a [Voltages]>) {
    let mut decoupler = ready.clone();
    for row in pieces.flatten() {
        black_box(decoupler.push(row).expect("a sample of a recorded run"));
    }
}

/// The same by the record path.
pub fn record_all<'a>(ready: &Decoupler, pieces: impl Iterator<Item = &'a [Voltages]>) {
    let mut decoupler = ready.clone();
    for piece in pieces {
        decoupler
            .push_record(piece, &mut |rows| {
                black_box(rows);
            })
            .expect("samples of a recorded run");
    }
}
