//! Signals. The first Ctrl-C asks for an orderly end, the second ends the program at once. After SIGTERM, SIGQUIT or SIGHUP, the
//! program ends within two seconds.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

static STOP: AtomicBool = AtomicBool::new(false);
/// Whether a run checks the flag.
static IS_POLLED: AtomicBool = AtomicBool::new(false);

/// How long an orderly end may take after SIGTERM, SIGQUIT or SIGHUP.
const GRACE: Duration = Duration::from_millis(1500);

/// The kind of end that a signal asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Wish {
    /// Ctrl-C: there is no deadline, because the user can press it again.
    End,
    /// SIGTERM, SIGQUIT or SIGHUP: the system kills the process next.
    EndSoon,
}

/// The flag that Ctrl-C or SIGTERM sets.
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
                "error: a signal ended the program before the run was finished; stored results are safe (continue with --resume)",
            );
            std::process::exit(130);
        });
    }
}

/// Starts a thread that listens for signals. It must be called before any other thread starts.
#[cfg(unix)]
pub fn listen() {
    use nix::sys::signal::{SigSet, Signal};
    // With SIGXFSZ blocked, a file beyond the allowed size is an error of the write and does not end the program.
    let mut too_large = SigSet::empty();
    too_large.add(Signal::SIGXFSZ);
    let _as_before = too_large.thread_block();
    let mut signals = SigSet::empty();
    for signal in [Signal::SIGINT, Signal::SIGTERM, Signal::SIGQUIT] {
        signals.add(signal);
    }
    // Under `nohup` a program must continue when its terminal is closed.
    if !is_ignored(Signal::SIGHUP as u32) {
        signals.add(Signal::SIGHUP);
    }
    // The signals are blocked for this thread and for all threads that it starts, so that only the listener receives them.
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

/// Starts a thread that listens for Ctrl-C.
#[cfg(not(unix))]
pub fn listen() {
    // Without a listener Ctrl-C ends the program at once, which loses nothing that is stored.
    let _as_before = ctrlc::set_handler(|| received(Wish::End));
}
