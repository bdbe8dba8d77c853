//! Signals: the first Ctrl-C asks for an orderly end, the second ends at once; whoever tells the program to end is obeyed within
//! two seconds, whatever it is doing.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

static STOP: AtomicBool = AtomicBool::new(false);
/// Whether anybody looks at the flag.
static IS_POLLED: AtomicBool = AtomicBool::new(false);

/// How long an orderly end may take where somebody told the program to end.
const GRACE: Duration = Duration::from_millis(1500);

/// What a signal wants.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Wish {
    /// Ctrl-C: a person who can press it again.
    End,
    /// From a system that kills next: SIGTERM, SIGQUIT, SIGHUP.
    EndSoon,
}

/// A flag that Ctrl-C (or a polite kill) sets.
pub fn stop_flag() -> &'static AtomicBool {
    IS_POLLED.store(true, Ordering::Relaxed);
    &STOP
}

/// Asks for an orderly end, as Ctrl-C does.
pub fn stop() {
    STOP.store(true, Ordering::Relaxed);
}

fn received(wish: Wish) {
    let was_asked = STOP.swap(true, Ordering::Relaxed);
    if !IS_POLLED.load(Ordering::Relaxed) || (was_asked && wish == Wish::End) {
        std::process::exit(130);
    }
    if wish == Wish::EndSoon {
        std::thread::spawn(|| {
            std::thread::sleep(GRACE);
            super::terminal::note(
                "error: told to end, before what was under way was finished; what was stored is safe (--resume)",
            );
            std::process::exit(130);
        });
    }
}

/// Listens from now on, on a thread of its own. To be called before any other thread begins.
#[cfg(unix)]
pub fn listen() {
    use nix::sys::signal::{SigSet, Signal};
    // A file that may not grow is an error of the write then, not the end of the program.
    let mut too_large = SigSet::empty();
    too_large.add(Signal::SIGXFSZ);
    let _as_before = too_large.thread_block();
    let mut signals = SigSet::empty();
    for signal in [Signal::SIGINT, Signal::SIGTERM, Signal::SIGQUIT] {
        signals.add(signal);
    }
    // `nohup` has a program go on when its terminal is closed.
    if !is_ignored(Signal::SIGHUP as u32) {
        signals.add(Signal::SIGHUP);
    }
    // Blocked for this thread and all that it begins, they wait for the one that asks for them.
    if signals.thread_block().is_err() {
        return;
    }
    let listener = std::thread::Builder::new().spawn(move || {
        while let Ok(signal) = signals.wait() {
            received(match signal {
                Signal::SIGINT => Wish::End,
                _ => Wish::EndSoon,
            });
        }
    });
    if listener.is_err() {
        let _as_before = signals.thread_unblock();
    }
}

/// Whether the process was started with this signal ignored.
#[cfg(unix)]
fn is_ignored(signal: u32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    mask.is_some_and(|mask| mask >> (signal - 1) & 1 == 1)
}

/// Listens from now on, on a thread of its own.
#[cfg(not(unix))]
pub fn listen() {
    // Without a listener Ctrl-C ends the program at once, which loses nothing that is stored.
    let _as_before = ctrlc::set_handler(|| received(Wish::End));
}
