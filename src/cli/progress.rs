//! A progress bar with rate and time left; quiet where standard error is not a terminal.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use realgap::Result;
use realgap::optimization::{Progress, RunOptions};

/// Does some work under a bar of `total` steps.
///
/// # Errors
/// As the work.
pub fn during<T>(
    total: usize,
    what: &str,
    run: RunOptions<'_>,
    work: impl FnOnce(&RunOptions<'_>) -> Result<T>,
) -> Result<T> {
    let bar = bar(total, what);
    let follow = follow(&bar);
    let done = work(&RunOptions {
        progress: Some(&follow),
        ..run
    });
    bar.finish_and_clear();
    done
}

/// What keeps a bar where the run is.
pub fn follow(bar: &ProgressBar) -> impl Fn(Progress) + Sync + '_ {
    let begun = AtomicBool::new(false);
    move |progress| {
        if let Some(what) = progress.finishing {
            // A full bar would stand there as if nothing happened any more.
            if let Ok(style) = ProgressStyle::with_template("{msg} {spinner} {elapsed}") {
                bar.set_style(style);
            }
            bar.set_message(what);
            return;
        }
        bar.set_length(progress.total as u64);
        if !begun.swap(true, Ordering::Relaxed) {
            // Rate and time left count from here, not from what an earlier run did.
            bar.set_position(progress.done as u64);
            bar.reset_eta();
        }
        bar.set_position(progress.done as u64);
    }
}

/// Something that turns while another program works.
pub fn spinner(what: &str) -> ProgressBar {
    let spinner = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr_with_hz(8));
    if let Ok(style) = ProgressStyle::with_template("{spinner} {msg}, {elapsed}") {
        spinner.set_style(style);
    }
    spinner.set_message(what.to_owned());
    spinner.enable_steady_tick(Duration::from_millis(250));
    spinner
}

/// A bar of `total` steps. It draws nothing in the first instants, so short work stays quiet.
pub fn bar(total: usize, what: &str) -> ProgressBar {
    // indicatif hides the bar by itself where standard error is not a terminal.
    let bar =
        ProgressBar::with_draw_target(Some(total as u64), ProgressDrawTarget::stderr_with_hz(8));
    let coloured = std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty());
    let pattern = if coloured {
        "{msg} {bar:36.cyan/dim} {pos}/{len}  {per_sec}, {eta} left"
    } else {
        "{msg} {bar:36} {pos}/{len}  {per_sec}, {eta} left"
    };
    if let Ok(style) = ProgressStyle::with_template(pattern) {
        bar.set_style(style);
    }
    bar.set_message(what.to_owned());
    bar.enable_steady_tick(Duration::from_millis(250));
    bar
}
