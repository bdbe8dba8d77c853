//! Runs the parsers of other projects in a confined place: on a thread with a large stack, with their panics caught and not printed,
//! and, where the work owns its data, with a limit of time.
//!
//! The limit of time is the last safeguard: a thread cannot be stopped from outside, so that work that never ends goes on in the
//! background until the process ends. Callers therefore check sizes, depths and counts of a file before they call a parser
//! ([`file::measure_xml`](crate::file::measure_xml), [`file::read_regular`](crate::file::read_regular)).
//!
//! ```
//! use std::time::Duration;
//! use realgap_core::confined::{Mishap, within};
//!
//! assert_eq!(within(Duration::from_secs(10), || 2 + 2), Ok(4));
//! let broken = within(Duration::from_secs(10), || -> i32 { panic!("index 7") });
//! assert_eq!(broken, Err(Mishap::Panic("index 7".to_owned())));
//! ```

use std::any::Any;
use std::cell::Cell;
use std::fmt;
use std::panic::{self, AssertUnwindSafe};
use std::sync::{Once, mpsc};
use std::thread;
use std::time::Duration;

/// The stack of a confined thread, bytes: enough for a robot of 1000 bodies of which each is nested in the one before, also in the profile
/// `dev`. The system gives memory to the part that is used only.
const STACK_BYTES: usize = 64 << 20;

/// The time that the reader of one file may take. It is far above the time that any file within the limits of size takes, so that
/// a busy machine does not change a result.
pub const PATIENCE: Duration = Duration::from_secs(10);

/// The reason why confined work has no result.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Mishap {
    /// The work panicked with this message.
    Panic(String),
    /// The work did not end within this time.
    Late(Duration),
    /// The system gave no thread, for this reason.
    NoThread(String),
}

impl fmt::Display for Mishap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Panic(message) => write!(f, "its reader failed ({message})"),
            Self::Late(limit) => {
                write!(f, "its reader did not end within {} s", limit.as_secs_f64())
            }
            Self::NoThread(reason) => write!(f, "the system gave no thread ({reason})"),
        }
    }
}

thread_local! {
    /// Whether the panics of this thread are caught and told as errors, so that nothing is printed about them.
    static IS_CONFINED: Cell<bool> = const { Cell::new(false) };
}

/// Makes the panics of confined threads silent; those of all other threads are printed as before.
fn hush() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let before = panic::take_hook();
        panic::set_hook(Box::new(move |information| {
            // A thread that is ending has no such variable any more, and is not confined.
            if !IS_CONFINED.try_with(Cell::get).unwrap_or(false) {
                before(information);
            }
        }));
    });
}

fn message(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    text.or_else(|| panic.downcast_ref::<String>().cloned())
        .unwrap_or_else(|| "without a message".to_owned())
}

fn caught<T>(work: impl FnOnce() -> T) -> Result<T, Mishap> {
    let before = IS_CONFINED.replace(true);
    // The result of work that panicked is dropped as a whole: no broken value is seen afterwards.
    let result = panic::catch_unwind(AssertUnwindSafe(work));
    IS_CONFINED.set(before);
    result.map_err(|panic| Mishap::Panic(message(&*panic)))
}

/// Runs work on this thread; its panics are caught and not printed.
///
/// # Errors
/// The panic of the work.
pub fn quietly<T>(work: impl FnOnce() -> T) -> Result<T, Mishap> {
    hush();
    caught(work)
}

/// Runs work on a thread with a large stack, and waits until it ends, however long that takes.
///
/// # Errors
/// The panic of the work; a system that gives no thread.
pub fn on_large_stack<T: Send>(work: impl FnOnce() -> T + Send) -> Result<T, Mishap> {
    hush();
    thread::scope(|scope| {
        let builder = thread::Builder::new().stack_size(STACK_BYTES);
        let worker = builder
            .spawn_scoped(scope, || caught(work))
            .map_err(|e| Mishap::NoThread(e.to_string()))?;
        worker
            .join()
            .unwrap_or_else(|panic| Err(Mishap::Panic(message(&*panic))))
    })
}

/// Runs work on a thread with a large stack, and waits for its end at most this long.
///
/// # Errors
/// The panic of the work; work that takes longer, which then goes on in the background; a system that gives no thread.
pub fn within<T: Send + 'static>(
    limit: Duration,
    work: impl FnOnce() -> T + Send + 'static,
) -> Result<T, Mishap> {
    hush();
    let (sender, receiver) = mpsc::channel();
    let builder = thread::Builder::new().stack_size(STACK_BYTES);
    builder
        .spawn(move || {
            // After the limit the caller has left, and the result is dropped.
            let _ = sender.send(caught(work));
        })
        .map_err(|e| Mishap::NoThread(e.to_string()))?;
    receiver
        .recv_timeout(limit)
        .unwrap_or(Err(Mishap::Late(limit)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn depth(levels: u64) -> u64 {
        let frame = std::hint::black_box([levels; 512]);
        match levels {
            0 => 0,
            _ => 1 + depth(frame[7] - 1),
        }
    }

    #[test]
    fn deep_work_ends_where_a_common_stack_is_too_small() {
        // 8000 frames of 4 kB are 32 MB; a common thread has 2 MB.
        assert_eq!(within(Duration::from_secs(60), || depth(8_000)), Ok(8_000));
    }

    #[test]
    fn a_panic_becomes_a_value() {
        let number: usize = std::hint::black_box(7);
        let beyond = move || [1, 2, 3][number % 8];
        let results = [quietly(beyond), within(PATIENCE, beyond)];
        for result in results {
            let told = result.unwrap_err().to_string();
            assert!(
                told.contains("reader failed") && told.contains("out of bounds"),
                "{told}"
            );
        }
        assert!(!IS_CONFINED.get());
    }

    #[test]
    fn work_that_never_ends_is_left_alone_after_its_time() {
        let limit = Duration::from_millis(50);
        let result = within(limit, || {
            loop {
                thread::sleep(Duration::from_millis(10));
            }
        });
        assert_eq!(result, Err::<(), _>(Mishap::Late(limit)));
    }
}
