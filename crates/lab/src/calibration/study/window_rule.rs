//! Which windows of a recording are simulated.

use serde::Deserialize;

use realgap_core::file::unknown_name;
use realgap_core::{Code, Error, Result, Warning};
use realgap_path::trajectory::Recording;

/// Windows that are simulated: all, unless they begin too slowly, while something is switched off, or have a gap.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default, rename = "Windows")]
pub struct WindowRule {
    /// A window begins while the robot moves at least so fast, m/s: a robot that stands tells little.
    pub from_m_s: f64,
    /// A window begins where this column is not 0, e.g. a switch of the motors.
    pub on: Option<String>,
    /// Within a window, samples are at most so far apart, seconds.
    pub gap_s: Option<f64>,
}

impl WindowRule {
    /// What is not allowed, with the name of its field.
    pub(in crate::calibration) fn fault(&self) -> Option<(&'static str, Error)> {
        let refuse = |field, found: f64, allowed: &str| {
            Some((
                field,
                Error::invalid("no rule for windows")
                    .found(found)
                    .allowed(allowed),
            ))
        };
        if !(self.from_m_s >= 0.0 && self.from_m_s.is_finite()) {
            return refuse("from_m_s", self.from_m_s, "a speed from 0 on");
        }
        match self.gap_s {
            Some(gap_s) if !(gap_s > 0.0 && gap_s.is_finite()) => {
                refuse("gap_s", gap_s, "a time above 0")
            }
            _ => None,
        }
    }

    /// Whether a window is simulated.
    fn admits(&self, window: &Recording) -> Result<bool> {
        let motion = &window.trajectory;
        if self.from_m_s > 0.0 {
            let Some(velocities) = motion.velocities_world_m_s() else {
                return Err(Error::invalid("nothing says how fast these windows begin")
                    .at_file(&window.path)
                    .field("windows.from_m_s")
                    .found("a recording without velocities and without orientations")
                    .hint("record the orientation or the heading, or leave `from_m_s` out"));
            };
            let is_slow = velocities.first().is_none_or(|v| v.norm() < self.from_m_s);
            if is_slow {
                return Ok(false);
            }
        }
        if let Some(column) = &self.on {
            let Some(signal) = motion.signal(column) else {
                let signals = motion.signals().iter().map(|signal| signal.name.as_str());
                return Err(unknown_name("recorded column", column, signals)
                    .or_hint("name a column of numbers that the recording has")
                    .at_file(&window.path)
                    .field("windows.on"));
            };
            if signal.values.first().is_none_or(|value| *value == 0.0) {
                return Ok(false);
            }
        }
        let Some(gap_s) = self.gap_s else {
            return Ok(true);
        };
        let mut steps = motion.times_s().windows(2).map(|pair| pair[1] - pair[0]);
        Ok(steps.all(|step_s| step_s <= gap_s))
    }

    /// Whether each of the windows is simulated, and a warning where some are not.
    ///
    /// # Errors
    /// A column that a recording does not have, or no window left.
    pub(in crate::calibration) fn of(
        &self,
        windows: &[Recording],
    ) -> Result<(Vec<bool>, Option<Warning>)> {
        let admitted: Vec<bool> = windows
            .iter()
            .map(|one| self.admits(one))
            .collect::<Result<_>>()?;
        let kept = admitted.iter().filter(|is_in| **is_in).count();
        if kept == 0 {
            return Err(Error::invalid("no window is left")
                .field("windows")
                .found(format!("{self:?}"))
                .hint("lower `from_m_s`, or leave `on` or `gap_s` out"));
        }
        let left_out = windows.len() - kept;
        let warning = (left_out > 0).then(|| {
            Code::WindowsLeftOut.warning(format!(
                "{left_out} of {} windows are left out: they begin too slowly, while `{}` is 0, or have gaps (`windows` in the study)",
                windows.len(),
                self.on.as_deref().unwrap_or("-")
            ))
        });
        Ok((admitted, warning))
    }
}
