//! A forecast in words.

use std::fmt;

use super::{Forecast, Reality};
use realgap_core::statistics::Proportion;
use realgap_core::table::{Side, TextTable};
use realgap_core::unit::{Unit, decimals, percent_range, quantity};

/// `62 % (sampling error, 95 %: 55 to 68 %)`.
pub fn percent(p: &Proportion) -> String {
    let interval = percent_range(p.low, p.high);
    format!(
        "{:.0} % (sampling error, 95 %: {interval})",
        100.0 * p.share
    )
}

impl fmt::Display for Forecast {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} repeats of {} s{}\n{}",
            self.repeats,
            self.duration_s,
            self.numbers(),
            self.behaviour_table(None, None)
        )
    }
}

impl Forecast {
    /// Displacement, heading and divergence, each line begun with a line feed.
    pub fn numbers(&self) -> String {
        let metres = |m: f64| quantity(m, Unit::Metre);
        let mut text = String::new();
        if let Some(spread) = &self.displacement_m {
            let [q05, q25, q50, q75, q95] =
                [spread.q05, spread.q25, spread.q50, spread.q75, spread.q95].map(metres);
            text += &format!(
                "\n  net displacement  mean {}, standard deviation {}\
                 \n    quantiles       5 %: {q05}, 25 %: {q25}, 50 %: {q50}, 75 %: {q75}, 95 %: {q95}",
                metres(spread.mean),
                metres(spread.standard_deviation),
            );
        }
        if let Some(m) = self.noise_free_displacement_m {
            text += &format!("\n    without noise   {}", metres(m));
        }
        if let Some(turned) = &self.turned_rad {
            let [mean, sd] = [turned.mean, turned.standard_deviation].map(f64::to_degrees);
            text += &format!(
                "\n  turned            {} deg, standard deviation {sd:.0} deg",
                decimals(mean, 0)
            );
        }
        if self.diverged.count > 0 {
            text += &format!("\n  diverged          {}", percent(&self.diverged));
        }
        text
    }

    /// The behaviours with their probabilities, what these are over other models (lowest and highest share), and, beside
    /// recordings, how many of these showed each.
    pub fn behaviour_table(
        &self,
        reality: Option<&Reality>,
        over_models: Option<&[(f64, f64)]>,
    ) -> String {
        let mut columns = vec![
            ("behaviour", Side::Left),
            ("share", Side::Right),
            ("sampling, 95 %", Side::Right),
            ("net displacement", Side::Right),
            ("repeat", Side::Right),
        ];
        if over_models.is_some() {
            columns.push(("other models", Side::Right));
        }
        if reality.is_some() {
            columns.push(("real runs", Side::Right));
        }
        let mut table = TextTable::new(columns);
        for (index, behaviour) in self.behaviours.list.iter().enumerate() {
            let p = &behaviour.probability;
            let mut row = vec![
                behaviour.name.clone(),
                format!("{:.1} %", 100.0 * p.share),
                percent_range(p.low, p.high),
                quantity(behaviour.mean_displacement_m, Unit::Metre),
                behaviour
                    .representative
                    .map_or("-".to_owned(), |n| n.to_string()),
            ];
            if let Some((low, high)) = over_models.and_then(|ranges| ranges.get(index)) {
                row.push(percent_range(*low, *high));
            }
            if let Some(reality) = reality {
                row.push(reality.showing(Some(&behaviour.name)).to_string());
            }
            table.push(row);
        }
        if let Some(reality) = reality {
            let unlike = reality.showing(None);
            if unlike > 0 {
                let mut row = vec!["not predicted".to_owned()];
                let empty = 4 + usize::from(over_models.is_some());
                row.extend(std::iter::repeat_n("-".to_owned(), empty));
                row.push(unlike.to_string());
                table.push(row);
            }
        }
        table.render(false).trim_end().to_owned()
    }
}

impl fmt::Display for Reality {
    /// Coverage of the central regions, and the energy score.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut table = TextTable::new([
            ("region of", Side::Left),
            ("real runs, over time", Side::Right),
            ("at the end", Side::Right),
            ("95 % interval", Side::Right),
            ("recordings say", Side::Left),
            ("whole paths in band", Side::Right),
        ]);
        for coverage in &self.coverage {
            let end = &coverage.at_end;
            table.push([
                format!("{:.0} %", 100.0 * coverage.level),
                format!("{:.0} %", 100.0 * coverage.over_time),
                format!("{} of {}", end.count, end.trials),
                percent_range(end.low, end.high),
                coverage.claim().word,
                coverage.whole_path.map_or("-".to_owned(), |held| {
                    format!("{} of {}", held.count, held.trials)
                }),
            ]);
        }
        write!(
            f,
            "{}  energy score {} (if reality were one more repeat: {})",
            table.render(false),
            quantity(self.energy_score_m, Unit::Metre),
            quantity(self.expected_energy_score_m, Unit::Metre)
        )
    }
}
