//! What the acquisition leaves for browsers: the history, the newest pose, and texts of which each browser reads the newest.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use crate::history::History;

/// Kinds of text. A new one replaces the old.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Post {
    /// What the instrument is.
    Hello,
    /// Numbers that change all the time.
    Status,
    /// Spectra.
    Spectrum,
    /// The calibration day.
    Day,
}

/// Number of kinds.
pub const POSTS: usize = 4;

/// The newest pose.
#[derive(Debug, Clone, Copy, Default)]
pub struct Live {
    /// Shell axes to ground axes, w first.
    pub attitude: [f64; 4],
    /// The true one, in a simulated laboratory.
    pub true_attitude: Option<[f64; 4]>,
    /// Where the mass is in its shell, m.
    pub position_m: [f64; 3],
    /// How it is turned there, rad.
    pub rotation_rad: [f64; 3],
    /// When the newest sample came.
    pub arrived: Option<Instant>,
}

/// What a lock guards, also after a thread has died with it.
pub fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A text with its number.
type Posted = (u64, Arc<str>);

/// The board.
pub struct Board {
    /// All columns.
    pub history: Mutex<History>,
    /// The newest pose.
    pub live: Mutex<Live>,
    posts: Mutex<[Posted; POSTS]>,
    source: AtomicU64,
    over: AtomicBool,
}

impl Default for Board {
    fn default() -> Self {
        Self {
            history: Mutex::new(History::new(1000.0)),
            live: Mutex::new(Live::default()),
            posts: Mutex::new(core::array::from_fn(|_| (0, Arc::from("")))),
            source: AtomicU64::new(0),
            over: AtomicBool::new(false),
        }
    }
}

impl Board {
    /// Puts up a text.
    pub fn post(&self, kind: Post, text: String) {
        let mut posts = locked(&self.posts);
        let posted = &mut posts[kind as usize];
        *posted = (posted.0 + 1, text.into());
    }

    /// Texts that are newer than those of these numbers, which are brought up to date.
    pub fn news(&self, seen: &mut [u64; POSTS]) -> Vec<Arc<str>> {
        let posts = locked(&self.posts);
        let newer = posts
            .iter()
            .zip(seen)
            .filter(|(posted, seen)| posted.0 > **seen);
        newer
            .map(|(posted, seen)| {
                *seen = posted.0;
                Arc::clone(&posted.1)
            })
            .collect()
    }

    /// Another source: times begin anew.
    pub fn next_source(&self) {
        self.source.fetch_add(1, Ordering::Relaxed);
    }

    /// Number of the source.
    pub fn source(&self) -> u64 {
        self.source.load(Ordering::Relaxed)
    }

    /// The instrument is shut down.
    pub fn end(&self) {
        self.over.store(true, Ordering::Relaxed);
    }

    /// Whether it is.
    pub fn is_over(&self) -> bool {
        self.over.load(Ordering::Relaxed)
    }
}
