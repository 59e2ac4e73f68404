//! The boundary to a library that panics on some failures of a driver: a device that is lost while
//! it is waited for, a pipeline that cannot be made while the device is opened. Here such a panic
//! becomes what it said.

use std::any::Any;
use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook};
use std::sync::Once;

thread_local! {
    /// Says whether this thread is inside the boundary.
    static INSIDE: Cell<bool> = const { Cell::new(false) };
}

/// Does `work`; if it panics, nothing is printed and what the panic said is returned, in one line.
///
/// The caller must not use what `work` was using any further, except to drop it.
pub(super) fn guarded<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let usual = take_hook();
        set_hook(Box::new(move |panic| {
            if !INSIDE.get() {
                usual(panic);
            }
        }));
    });
    let outer = INSIDE.replace(true);
    let done = catch_unwind(AssertUnwindSafe(work));
    INSIDE.set(outer);
    done.map_err(|said| sentence(said.as_ref()))
}

fn sentence(said: &(dyn Any + Send)) -> String {
    let text = said.downcast_ref::<String>().map(String::as_str).or(said.downcast_ref::<&str>().copied());
    let words: Vec<&str> = text.unwrap_or("without a word").split_whitespace().collect();
    format!("the graphics library aborted: {}", words.join(" "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_becomes_what_it_said_in_one_line() {
        assert_eq!(guarded(|| 3), Ok(3));
        let lost: Result<(), String> = guarded(|| panic!("the device\n\n  was {}", "lost"));
        assert_eq!(lost, Err("the graphics library aborted: the device was lost".to_owned()));
        assert!(!INSIDE.get());
    }
}
