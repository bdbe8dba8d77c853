//! Comparisons of task times in words.

use std::fmt;

use super::comparison::{SideReport, TaskComparison};
use realgap_core::table::{Side, TextTable};

fn seconds(value: Option<f64>) -> String {
    value.map_or("?".to_owned(), |v| format!("{v:.1}"))
}

impl SideReport {
    /// `12.3 s (10.1 to 15.0)`.
    fn median(&self) -> String {
        match self.median_s {
            Some(median) => format!(
                "{median:.1} s ({} to {})",
                seconds(self.median_low_s),
                seconds(self.median_high_s)
            ),
            None => "not half finished".to_owned(),
        }
    }
}

impl fmt::Display for TaskComparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut table = TextTable::new([
            ("condition", Side::Left),
            ("finished", Side::Right),
            ("real median", Side::Right),
            ("finished", Side::Right),
            ("simulated median", Side::Right),
            ("ratio", Side::Right),
            ("effect", Side::Right),
            ("p", Side::Right),
            ("test", Side::Left),
        ]);
        for c in &self.conditions {
            table.push([
                c.condition.clone(),
                format!("{} of {}", c.real.finished, c.real.trials),
                c.real.median(),
                format!("{} of {}", c.simulated.finished, c.simulated.trials),
                c.simulated.median(),
                c.median_ratio.map_or(String::new(), |r| format!("{r:.2}")),
                format!(
                    "{:+.2} ({:+.2} to {:+.2})",
                    c.effect, c.effect_low, c.effect_high
                ),
                c.p.map_or("?".to_owned(), |p| format!("{p:.3}")),
                c.test.to_owned(),
            ]);
        }
        write!(f, "{}", table.render(false))?;
        for factor in &self.factors {
            let order = if factor.same_order {
                "the same order"
            } else {
                "another order"
            };
            write!(
                f,
                "\n{}: real {}, simulated {}: {order} ({:.0} % of resamples agree)",
                factor.factor,
                factor.real.join(" < "),
                factor.simulated.join(" < "),
                100.0 * factor.same_order_share
            )?;
        }
        if let (Some(rho), Some(p)) = (self.spearman, self.spearman_p) {
            write!(
                f,
                "\nranks of the conditions' medians: {rho:+.2} (Spearman, p = {p:.3})"
            )?;
        }
        Ok(())
    }
}
