//! How the error of a prediction grows with the time since its start: until when a simulation may be trusted.

use serde::Serialize;

use crate::calibration::Horizon;
use realgap_core::statistics::quantile;
use realgap_core::unit::{Unit, counted, quantity};
use realgap_path::trajectory::{Interpolator, Recording, Trajectory};

/// Times at which errors are stated, over the length of a window.
const TIMES: usize = 12;
/// A run is trusted as long as so many of its windows are within so many body lengths.
const TRUSTED_SHARE: f64 = 0.9;
const TRUSTED_LENGTHS: f64 = 0.5;

/// Position errors of one window at twelve equally spaced times, the last at its end.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::calibration) struct WindowError {
    /// The recording of which it is a window.
    pub log: String,
    pub times_s: Vec<f64>,
    pub errors_m: Vec<f64>,
}

impl WindowError {
    /// `None` for a recording that is no window. A window begins where its name says; its run may have begun before.
    pub fn new(recording: &Recording, real: &Trajectory, run: &Trajectory) -> Option<Self> {
        let log = recording.log.as_ref()?;
        let begin_s = Horizon::begin_s(&recording.name)?;
        let lead_s = (log.times_s()[0] + begin_s - real.times_s()[0]).max(0.0);
        let length_s = real.duration_s() - lead_s;
        let is_planar = real.is_planar() || run.is_planar();
        let mut both = [Interpolator::new(real), Interpolator::new(run)];
        let times = (1..=TIMES).map(|k| length_s * k as f64 / TIMES as f64);
        let (mut times_s, mut errors_m) = (Vec::new(), Vec::new());
        for time_s in times {
            let since_start_s = lead_s + time_s;
            let [recorded, simulated] = &mut both;
            let offset = simulated.position_world_m(since_start_s)
                - recorded.position_world_m(since_start_s);
            times_s.push(time_s);
            errors_m.push(if is_planar {
                offset.xy().norm()
            } else {
                offset.norm()
            });
        }
        Some(Self {
            log: Horizon::log_of(&recording.name).to_owned(),
            times_s,
            errors_m,
        })
    }
}

/// How position errors grow over the windows of a recording.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct HorizonError {
    /// Name of the recording; `all` for all of them together.
    pub recording: String,
    /// Number of its windows.
    pub windows: usize,
    /// Times since a window's start, seconds.
    pub times_s: Vec<f64>,
    /// Median position error at each of these times, metres.
    pub median_m: Vec<f64>,
    /// Nine of ten windows have at most this position error, metres.
    pub nine_of_ten_m: Vec<f64>,
    /// Nine of ten windows stay within half a body length until then, seconds; `None` where they do not at the first time.
    pub trusted_s: Option<f64>,
}

impl HorizonError {
    /// Each recording, and all together where there are several.
    pub(in crate::calibration) fn all(windows: &[&WindowError], body_length_m: f64) -> Vec<Self> {
        let mut logs: Vec<&str> = Vec::new();
        for window in windows {
            if !logs.contains(&window.log.as_str()) {
                logs.push(&window.log);
            }
        }
        let mut all: Vec<Self> = logs
            .iter()
            .filter_map(|log| {
                let own = windows.iter().filter(|window| window.log == *log);
                Self::of(log, &own.copied().collect::<Vec<_>>(), body_length_m)
            })
            .collect();
        if logs.len() > 1 {
            all.extend(Self::of("all", windows, body_length_m));
        }
        all
    }

    fn of(name: &str, windows: &[&WindowError], body_length_m: f64) -> Option<Self> {
        let times_s = windows.first()?.times_s.clone();
        let at = |k: usize, share: f64| {
            let own: Vec<f64> = windows.iter().map(|window| window.errors_m[k]).collect();
            quantile(&own, share)
        };
        let quantiles = |share: f64| (0..times_s.len()).map(|k| at(k, share)).collect::<Vec<_>>();
        let nine_of_ten_m = quantiles(TRUSTED_SHARE);
        let is_trusted = |far_m: &&f64| **far_m <= TRUSTED_LENGTHS * body_length_m;
        let trusted = nine_of_ten_m.iter().take_while(is_trusted).count();
        Some(Self {
            recording: name.to_owned(),
            windows: windows.len(),
            median_m: quantiles(0.5),
            trusted_s: trusted.checked_sub(1).map(|last| times_s[last]),
            nine_of_ten_m,
            times_s,
        })
    }

    /// The errors at a third, two thirds and the whole of a window, as words.
    pub fn thirds(&self) -> [(f64, f64); 3] {
        [1, 2, 3].map(|third| {
            let place = third * self.times_s.len() / 3 - 1;
            (self.times_s[place], self.median_m[place])
        })
    }

    /// Until when the run may be trusted, as a sentence.
    pub fn sentence(&self) -> String {
        let windows = counted(self.windows, "window");
        match (self.trusted_s, self.times_s.last()) {
            (None, _) => format!(
                "trust no run: more than one of ten of {windows} is half a body length off before the first stated time"
            ),
            (Some(until_s), Some(end_s)) if until_s == *end_s => {
                format!(
                    "nine of ten of {windows} stay within half a body length to their end ({})",
                    quantity(*end_s, Unit::Second)
                )
            }
            (Some(until_s), _) => format!(
                "trust a run until {}: nine of ten of {windows} are within half a body length until then",
                quantity(until_s, Unit::Second)
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn window(log: &str, speed_m_s: f64) -> WindowError {
        let times_s: Vec<f64> = (1..=TIMES).map(|k| 0.125 * k as f64).collect();
        WindowError {
            log: log.to_owned(),
            errors_m: times_s.iter().map(|t| speed_m_s * t).collect(),
            times_s,
        }
    }

    #[test]
    fn a_run_is_trusted_until_one_of_ten_windows_leaves_half_a_body_length() {
        let windows: Vec<WindowError> = (1..=19)
            .map(|k| window("log", 0.01 * f64::from(k)))
            .collect();
        let found = HorizonError::all(&windows.iter().collect::<Vec<_>>(), 0.2);
        assert_eq!(found.len(), 1);
        // The median drives away at 0.1 m/s and nine of ten at up to 0.172 m/s.
        let thirds = found[0].thirds().map(|(t, m)| (t, (1e6 * m).round() / 1e6));
        assert_eq!(thirds, [(0.5, 0.05), (1.0, 0.1), (1.5, 0.15)]);
        let until_s = found[0].trusted_s.unwrap();
        assert!((until_s - 0.5).abs() < 1e-9, "{found:?}");
        assert!(
            found[0].sentence().contains("until 0.500 s"),
            "{}",
            found[0].sentence()
        );
        let fast = HorizonError::all(&[&window("a", 9.0), &window("b", 0.0)], 0.2);
        assert_eq!(
            fast.iter()
                .map(|one| one.recording.as_str())
                .collect::<Vec<_>>(),
            ["a", "b", "all"]
        );
        assert_eq!(fast[0].trusted_s, None);
        assert_eq!(fast[1].trusted_s, Some(1.5));
    }
}
