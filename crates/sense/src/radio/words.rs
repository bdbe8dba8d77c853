//! Radio models, their fits and their evaluations in words.

use std::fmt;

use super::evaluation::Evaluation;
use super::fit::{FittedParameter, FittedRadio};
use super::service::ServiceReport;
use realgap_core::table::{Side, TextTable};
use realgap_core::unit::{counted, number};

impl FittedParameter {
    fn with_unit(&self, value: f64) -> String {
        match self.unit {
            "" => number(value),
            unit => format!("{} {unit}", number(value)),
        }
    }
}

impl fmt::Display for FittedRadio {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{} at {} ({} missing)\n",
            counted(self.readings, "strength"),
            counted(self.places, "place"),
            self.missing
        )?;
        let mut tried = TextTable::new([
            ("model", Side::Left),
            ("walls that count", Side::Right),
            ("error at places left out", Side::Right),
            ("", Side::Left),
        ]);
        for candidate in &self.candidates {
            tried.push([
                candidate.propagation.to_owned(),
                candidate.cap.map_or(String::new(), |cap| cap.to_string()),
                format!("{:.2} dB", candidate.left_out_rmse_db),
                if candidate.as_good {
                    "cannot be told from the best"
                } else {
                    ""
                }
                .to_owned(),
            ]);
        }
        writeln!(f, "{}", tried.render(false))?;
        writeln!(
            f,
            "{}: {}   (log to base {}, d0 = {} m{})\n",
            self.propagation,
            self.formula,
            self.log_base,
            self.reference_distance_m,
            self.cap.map_or(String::new(), |cap| format!(", C = {cap}"))
        )?;
        let mut table = TextTable::new([
            ("parameter", Side::Left),
            ("value", Side::Right),
            ("90 % interval", Side::Left),
            ("", Side::Left),
        ]);
        for parameter in &self.parameters {
            table.push([
                parameter.name.clone(),
                parameter.with_unit(parameter.value),
                format!("{} to {}", number(parameter.low), number(parameter.high)),
                match &parameter.why {
                    Some(why) => format!("not determined: {why}"),
                    None => "determined".to_owned(),
                },
            ]);
        }
        writeln!(f, "{}", table.render(false))?;
        writeln!(
            f,
            "error {:.2} dB on the log, {:.2} dB at places left out; 90 % of strengths elsewhere within {:.1} dB",
            self.rmse_db, self.left_out_rmse_db, self.interval_90_db
        )?;
        write!(
            f,
            "a place adds {:.1} dB (alike within {:.1} m), a reading {:.1} dB",
            self.shadowing_sd_db, self.shadowing_distance_m, self.fading_sd_db
        )
    }
}

impl fmt::Display for Evaluation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{}: {:.2} dB off ({:.2} to {:.2}), {:+.2} dB on average; {:.1} % of {} within {:.1} dB\n",
            self.propagation,
            self.rmse_db,
            self.rmse_low_db,
            self.rmse_high_db,
            self.bias_db,
            100.0 * self.coverage_90,
            counted(self.readings, "strength"),
            self.interval_90_db
        )?;
        let mut table = TextTable::new([
            ("anchor", Side::Left),
            ("strengths", Side::Right),
            ("error", Side::Right),
            ("on average", Side::Right),
            ("in the 90 % interval", Side::Right),
        ]);
        for anchor in &self.anchors {
            table.push([
                anchor.anchor.clone(),
                anchor.readings.to_string(),
                format!("{:.2} dB", anchor.rmse_db),
                format!("{:+.2} dB", anchor.bias_db),
                format!("{:.1} %", 100.0 * anchor.coverage_90),
            ]);
        }
        writeln!(f, "{}", table.render(false))?;
        let mut others = TextTable::new([("other guesses", Side::Left), ("error", Side::Right)]);
        for guess in &self.guesses {
            others.push([guess.name.clone(), format!("{:.2} dB", guess.rmse_db)]);
        }
        write!(f, "{}", others.render(false).trim_end())
    }
}

impl fmt::Display for ServiceReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} of {} delivered ({:.1} %), {} too weak, {} lost; {:.1} dBm on average",
            self.delivered,
            counted(self.sent, "message"),
            100.0 * self.delivered as f64 / self.sent as f64,
            self.too_weak,
            self.lost,
            self.mean_strength_dbm
        )?;
        if let (Some(median_s), Some(most_s)) = (self.median_latency_s, self.latency_95_s) {
            write!(
                f,
                "; {median_s:.4} s from sending to arriving, 95 % within {most_s:.4} s"
            )?;
        }
        Ok(())
    }
}
