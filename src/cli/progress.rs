//! A progress bar with rate and time left; quiet where standard error is not a terminal.

use std::fmt::Write;
use std::io::IsTerminal as _;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use realgap::Result;

use super::terminal;
use realgap::optimization::{Progress, RunOptions};
use realgap::plan::time;
use realgap::simulation::RunHooks;

/// How often the progress is printed where standard error is not a terminal.
const MINUTE: Duration = Duration::from_secs(60);

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
    let say = |progress| {
        follow(progress);
        if let Some(also) = run.progress {
            also(progress);
        }
    };
    let done = work(&RunOptions {
        progress: Some(&say),
        ..run
    });
    bar.finish_and_clear();
    done
}

/// Simulates one run of so many seconds under a bar.
///
/// # Errors
/// As the run.
pub fn during_one<T>(duration_s: f64, run: impl FnOnce(RunHooks<'_>) -> Result<T>) -> Result<T> {
    let bar = bar(duration_s.ceil() as usize, "simulating, seconds");
    let mut shown = 0;
    let mut clock = |share: f64| {
        let now = (share * duration_s) as u64;
        if now > shown {
            shown = now;
            bar.set_position(now);
        }
        Ok(())
    };
    let done = run(RunHooks {
        clock: Some(&mut clock),
        ..RunHooks::default()
    });
    bar.finish_and_clear();
    done
}

/// A callback that moves the bar with the run.
pub fn follow(bar: &ProgressBar) -> impl Fn(Progress) + Sync + '_ {
    let begun = AtomicBool::new(false);
    let last_step = Mutex::new(None);
    move |progress| {
        if let Some(what) = progress.finishing {
            let Ok(mut last) = last_step.lock() else {
                return;
            };
            let is_counted = progress.total > 0;
            if progress.done == 0 || *last != Some(what) {
                *last = Some(what);
                // A full bar would look as if the program had stopped, so a spinner stands where nothing can be counted.
                let pattern = match is_counted {
                    true => pattern(),
                    false => "{msg} {spinner} {so_far} so far",
                };
                // Whoever looks between two of these calls sees no count of the step before.
                bar.set_position(0);
                match is_counted {
                    true => bar.set_length(progress.total as u64),
                    false => bar.unset_length(),
                }
                bar.set_message(what);
                if let Some(style) = style(pattern) {
                    bar.set_style(style);
                }
                bar.reset_eta();
            }
            // Threads report out of order.
            if is_counted && progress.done as u64 > bar.position() {
                bar.set_position(progress.done as u64);
            }
            return;
        }
        bar.set_length(progress.total as u64);
        if !begun.swap(true, Ordering::Relaxed) {
            // Rate and time left are computed from here, without the steps of an earlier run.
            bar.set_position(progress.done as u64);
            bar.reset_eta();
        }
        bar.set_position(progress.done as u64);
    }
}

/// What a bar shows.
fn pattern() -> &'static str {
    let coloured = std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty());
    match coloured {
        true => "{msg} {bar:36.cyan/dim} {pos}/{len}  {pace}",
        false => "{msg} {bar:36} {pos}/{len}  {pace}",
    }
}

/// The look of a bar.
fn style(pattern: &str) -> Option<ProgressStyle> {
    let style = ProgressStyle::with_template(pattern).ok()?;
    let style = style.with_key("pace", |state: &ProgressState, out: &mut dyn Write| {
        let _ = out.write_str(&pace(state.per_sec(), state.eta(), state.elapsed()));
    });
    Some(
        style.with_key("so_far", |state: &ProgressState, out: &mut dyn Write| {
            let _ = out.write_str(&time(state.elapsed().as_secs_f64()));
        }),
    )
}

/// Steps a second and the time left; before the first step, which tells neither, the time so far.
fn pace(per_s: f64, left: Duration, so_far: Duration) -> String {
    match left.is_zero() {
        true => format!("{} so far", time(so_far.as_secs_f64())),
        false => format!("{per_s:.1}/s, {} left", time(left.as_secs_f64())),
    }
}

/// A spinner for the time in which another program works.
pub fn spinner(what: &str) -> ProgressBar {
    let spinner = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr_with_hz(8));
    if let Some(style) = style("{spinner} {msg}, {so_far}") {
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
    if let Some(style) = style(pattern()) {
        bar.set_style(style);
    }
    bar.set_message(what.to_owned());
    bar.enable_steady_tick(Duration::from_millis(250));
    if !std::io::stderr().is_terminal() {
        tell_by_the_minute(&bar);
    }
    bar
}

/// Prints the progress of an invisible bar once a minute.
fn tell_by_the_minute(bar: &ProgressBar) {
    let watched = bar.downgrade();
    let begun = Instant::now();
    std::thread::spawn(move || {
        let (mut next, mut first) = (MINUTE, None);
        while let Some(bar) = watched.upgrade().filter(|bar| !bar.is_finished()) {
            let done = bar.position();
            // Steps of an earlier run do not count for the pace.
            let first = *first.get_or_insert(done);
            let taken = begun.elapsed();
            if taken >= next {
                next += MINUTE;
                let (message, time_taken) = (bar.message(), time(taken.as_secs_f64()));
                let Some(total) = bar.length() else {
                    terminal::note(format!("{message}, after {time_taken}"));
                    continue;
                };
                let pace_s = taken.as_secs_f64() / done.saturating_sub(first).max(1) as f64;
                let left_s = pace_s * total.saturating_sub(done) as f64;
                let left = match done > first && total > done {
                    true => format!(", about {} left", time(left_s)),
                    false => String::new(),
                };
                terminal::note(format!(
                    "{message}: {done} of {total} after {time_taken}{left}"
                ));
            }
            drop(bar);
            std::thread::sleep(Duration::from_secs(1));
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_left_is_said_once_a_step_tells_it() {
        let second = Duration::from_secs(1);
        assert_eq!(pace(0.0, Duration::ZERO, second), "1.0 s so far");
        assert_eq!(pace(2.0, 3 * second, second), "2.0/s, 3.0 s left");
    }
}
