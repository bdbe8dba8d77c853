//! The cost of a plan, estimated from a few of its runs.

use std::fmt;

use serde::{Deserialize, Serialize};

/// Cost of a plan, from a few of its own runs on this machine.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Cost {
    /// Runs that were measured.
    pub measured: usize,
    /// CPU seconds a run, their mean.
    pub run_cpu_s: f64,
    /// Bytes a run in the store, their mean.
    pub run_bytes: f64,
    /// Runs of the whole plan; of a tuning or search the largest possible number.
    pub runs: usize,
}

impl Cost {
    /// CPU seconds of all runs.
    pub fn cpu_s(&self) -> f64 {
        self.run_cpu_s * self.runs as f64
    }

    /// Bytes on the disk at the end: of the shards' stores, and of the merged one.
    pub(crate) fn disk_bytes(&self) -> f64 {
        2.0 * self.run_bytes * self.runs as f64
    }

    /// Number of shards of about so many CPU seconds each.
    pub fn shards_of(&self, shard_cpu_s: f64) -> usize {
        ((self.cpu_s() / shard_cpu_s).ceil() as usize).max(1)
    }
}

impl fmt::Display for Cost {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} runs of {} CPU each: {} of one core, {} on the disk (from {} runs, measured here)",
            self.runs,
            time(self.run_cpu_s),
            time(self.cpu_s()),
            bytes(self.disk_bytes()),
            self.measured
        )
    }
}

/// A duration with two digits, in a suitable unit.
pub fn time(seconds: f64) -> String {
    let (value, unit) = match seconds {
        s if s < 1.0 => (1e3 * s, "ms"),
        s if s < 120.0 => (s, "s"),
        s if s < 7200.0 => (s / 60.0, "min"),
        s => (s / 3600.0, "h"),
    };
    format!("{value:.*} {unit}", usize::from(value < 10.0))
}

fn bytes(count: f64) -> String {
    let (value, unit) = match count {
        b if b < 1e6 => (b / 1e3, "kB"),
        b if b < 1e9 => (b / 1e6, "MB"),
        b => (b / 1e9, "GB"),
    };
    format!("{value:.*} {unit}", usize::from(value < 10.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_million_runs_are_shown_in_hours_and_gigabytes() {
        let cost = Cost {
            measured: 4,
            run_cpu_s: 0.25,
            run_bytes: 3000.0,
            runs: 1_000_000,
        };
        assert_eq!(
            cost.to_string(),
            "1000000 runs of 250 ms CPU each: 69 h of one core, 6.0 GB on the disk (from 4 runs, measured here)"
        );
        assert_eq!(cost.shards_of(3600.0), 70);
    }
}
