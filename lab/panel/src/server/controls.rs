//! Which browser holds the controls: the first that comes, until it goes or another takes them.

use std::sync::atomic::{AtomicU64, Ordering};

/// Who holds them; 0 for nobody.
#[derive(Debug, Default)]
pub struct Controls {
    holder: AtomicU64,
    last: AtomicU64,
}

impl Controls {
    /// A number for a browser that comes; it gets the controls if nobody has them.
    pub fn arrive(&self) -> u64 {
        let number = self.last.fetch_add(1, Ordering::SeqCst) + 1;
        let _ = self
            .holder
            .compare_exchange(0, number, Ordering::SeqCst, Ordering::SeqCst);
        number
    }

    /// Takes the controls, from whom ever.
    pub fn take(&self, number: u64) {
        self.holder.store(number, Ordering::SeqCst);
    }

    /// Gives them back, if this browser has them.
    pub fn release(&self, number: u64) {
        let _ = self
            .holder
            .compare_exchange(number, 0, Ordering::SeqCst, Ordering::SeqCst);
    }

    /// Whether this browser has them.
    pub fn held_by(&self, number: u64) -> bool {
        self.holder.load(Ordering::SeqCst) == number
    }

    /// Whether anybody has them.
    pub fn held(&self) -> bool {
        self.holder.load(Ordering::SeqCst) != 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn law_one_browser_holds_them() {
        let controls = Controls::default();
        let (a, b) = (controls.arrive(), controls.arrive());
        assert!(controls.held_by(a) && !controls.held_by(b));
        controls.release(b);
        assert!(controls.held_by(a));
        controls.take(b);
        assert!(controls.held_by(b) && !controls.held_by(a));
        controls.release(b);
        assert!(!controls.held());
        let c = controls.arrive();
        assert!(controls.held_by(c));
    }
}
