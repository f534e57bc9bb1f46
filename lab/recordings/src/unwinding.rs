//! Libraries that panic on hostile files: a panic becomes an error of the file, and nothing is printed of it.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook};
use std::sync::Once;

thread_local! {
    static CAUGHT: Cell<bool> = const { Cell::new(false) };
}

/// What `work` returns; none if it panics.
pub fn caught<T>(work: impl FnOnce() -> T) -> Option<T> {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let before = take_hook();
        set_hook(Box::new(move |panic| {
            if !CAUGHT.get() {
                before(panic);
            }
        }));
    });
    let outer = CAUGHT.replace(true);
    let done = catch_unwind(AssertUnwindSafe(work));
    CAUGHT.set(outer);
    done.ok()
}

#[cfg(test)]
mod tests {
    use super::caught;

    #[test]
    fn regress_a_panic_is_caught_also_within_another() {
        assert_eq!(caught(|| 1), Some(1));
        let inner = caught(|| {
            let none: Option<u8> = caught(|| panic!("hostile"));
            none.is_none()
        });
        assert_eq!(inner, Some(true));
    }
}
