//! Ctrl-C: the first asks for an orderly end, the second ends at once.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

use realgap::{Error, Result};

static STOP: AtomicBool = AtomicBool::new(false);
static INSTALLED: OnceLock<bool> = OnceLock::new();

/// A flag that Ctrl-C (or a polite kill) sets.
pub fn stop_flag() -> Result<&'static AtomicBool> {
    let installed = INSTALLED.get_or_init(|| {
        ctrlc::set_handler(|| {
            if STOP.swap(true, Ordering::Relaxed) {
                std::process::exit(130);
            }
        })
        .is_ok()
    });
    if *installed {
        Ok(&STOP)
    } else {
        Err(Error::conflict("cannot listen for Ctrl-C"))
    }
}
