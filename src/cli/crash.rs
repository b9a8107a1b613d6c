//! Handling of panics. A panic is a fault of the program, for any input, and is reported as such.
//!
//! Results stay resumable: files are written completely or not at all, tables are flushed row by
//! row, and locks and leases end with the process.

use super::exit_code::PANIC;
use super::standard_error;
use std::panic::{self, AssertUnwindSafe, PanicHookInfo};
use std::sync::atomic::{AtomicBool, Ordering};

/// Runs the work; a panic in it ends with a message and exit code 1.
pub fn guarded(work: impl FnOnce() -> u8) -> u8 {
    panic::catch_unwind(AssertUnwindSafe(work)).unwrap_or(PANIC)
}

/// Reports the first panic; later panics in other threads, which follow from it, are ignored.
pub fn announce_panics() {
    static TOLD: AtomicBool = AtomicBool::new(false);
    let trace = panic::take_hook();
    panic::set_hook(Box::new(move |panic| {
        if TOLD.swap(true, Ordering::SeqCst) {
            return;
        }
        standard_error::report(&in_words(&what(panic), &place(panic)));
        if std::env::var_os("RUST_BACKTRACE").is_some() {
            trace(panic);
        }
    }));
}

fn what(panic: &PanicHookInfo<'_>) -> String {
    let payload = panic.payload_as_str();
    payload.unwrap_or("a panic without a message").to_owned()
}

fn place(panic: &PanicHookInfo<'_>) -> String {
    let location = panic.location();
    location.map_or_else(|| "an unknown place".to_owned(), ToString::to_string)
}

fn in_words(what: &str, place: &str) -> String {
    format!(
        "error: a fault of rodlab {}, please report it with the scenario and the command: {what} (at {place})\n\
         results written so far are complete; run the same command again to resume\n",
        env!("CARGO_PKG_VERSION")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_ends_with_exit_code_1() {
        assert_eq!(guarded(|| panic!("of this test")), 1);
        assert_eq!(guarded(|| 5), 5);
    }

    #[test]
    fn a_panic_is_reported_as_a_fault_of_the_program() {
        let text = in_words("index out of bounds", "src/mechanics/scene.rs:220:31");
        assert!(text.contains("a fault of rodlab"), "{text}");
        assert!(text.contains("please report"), "{text}");
        assert!(text.contains("scene.rs:220:31"), "{text}");
        assert!(text.ends_with("again to resume\n"), "{text}");
    }
}
