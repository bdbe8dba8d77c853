//! Beliefs in words.

use std::fmt;

use super::experiment::BeliefReport;
use realgap_core::table::{Side, TextTable};

impl fmt::Display for BeliefReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "beliefs after {} readings, in {}",
            self.readings, self.unit
        )?;
        let mut table = TextTable::new([
            ("  distance", Side::Right),
            ("readings of", Side::Left),
            ("trials", Side::Right),
            ("sd of the belief", Side::Right),
            ("mean - distance", Side::Right),
            ("90 % interval holds it", Side::Right),
            ("overlap", Side::Right),
            ("sd of a Kalman filter", Side::Right),
        ]);
        for side in &self.distances {
            let rows = [
                ("model", Some(&side.simulated)),
                ("log", side.real.as_ref()),
            ];
            for (whose, set) in rows {
                let Some(set) = set else {
                    continue;
                };
                let is_log = whose == "log";
                table.push([
                    format!("{:.4}", side.distance)
                        .trim_end_matches('0')
                        .trim_end_matches('.')
                        .to_owned(),
                    whose.to_owned(),
                    set.trials.to_string(),
                    format!("{:.3}", set.belief_sd),
                    format!("{:+.3}", set.bias),
                    format!("{:.1} %", 100.0 * set.held),
                    side.overlap
                        .filter(|_| is_log)
                        .map_or(String::new(), |o| format!("{:.1} %", 100.0 * o)),
                    side.kalman_sd
                        .filter(|_| !is_log)
                        .map_or(String::new(), |sd| format!("{sd:.3}")),
                ]);
            }
        }
        f.write_str(table.render(false).trim_end())
    }
}
