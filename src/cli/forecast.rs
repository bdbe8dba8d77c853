//! Printing what an ensemble says: shared by `ensemble` and `predict`.

use realgap::plot::{Side, TextTable, quantity};
use realgap::prediction::ensemble::{Forecast, Quantiles, Reality};
use realgap::statistics::Proportion;
use realgap::unit::Unit;

/// Most repeats: the distances of all pairs are held in memory.
pub const MOST_REPEATS: i64 = 5000;

/// `62 % (95 %: 55 to 68 %)`.
pub fn percent(p: &Proportion) -> String {
    format!(
        "{:.0} % (95 %: {:.0} to {:.0} %)",
        100.0 * p.share,
        100.0 * p.low,
        100.0 * p.high
    )
}

/// Lines about displacement, heading and divergence.
pub fn lines(summary: &Forecast) -> Vec<String> {
    let metres = |m: f64| quantity(m, Unit::Metre);
    let mut lines = Vec::new();
    if let Some(Quantiles {
        mean,
        standard_deviation,
        q05,
        q25,
        q50,
        q75,
        q95,
    }) = &summary.displacement_m
    {
        lines.push(format!(
            "  net displacement  mean {}, standard deviation {}",
            metres(*mean),
            metres(*standard_deviation)
        ));
        lines.push(format!(
            "    quantiles       5 %: {}, 25 %: {}, 50 %: {}, 75 %: {}, 95 %: {}",
            metres(*q05),
            metres(*q25),
            metres(*q50),
            metres(*q75),
            metres(*q95)
        ));
    }
    if let Some(m) = summary.noise_free_displacement_m {
        lines.push(format!("    without noise   {}", metres(m)));
    }
    if let Some(turned) = &summary.turned_rad {
        lines.push(format!(
            "  turned            {:.0} deg, standard deviation {:.0} deg",
            turned.mean.to_degrees(),
            turned.standard_deviation.to_degrees()
        ));
    }
    if summary.diverged.count > 0 {
        lines.push(format!(
            "  diverged          {}",
            percent(&summary.diverged)
        ));
    }
    lines
}

/// The behaviours, with what reality showed.
pub fn behaviours(summary: &Forecast, reality: Option<&Reality>, colour: bool) -> String {
    let mut columns = vec![
        ("behaviour", Side::Left),
        ("probability", Side::Right),
        ("95 % interval", Side::Right),
        ("net displacement", Side::Right),
        ("repeat", Side::Right),
    ];
    if reality.is_some() {
        columns.push(("real runs", Side::Right));
    }
    let mut table = TextTable::new(columns);
    for behaviour in &summary.behaviours.list {
        let p = &behaviour.probability;
        let mut row = vec![
            behaviour.name.clone(),
            format!("{:.1} %", 100.0 * p.share),
            format!("{:.1} to {:.1} %", 100.0 * p.low, 100.0 * p.high),
            quantity(behaviour.mean_displacement_m, Unit::Metre),
            behaviour
                .representative
                .map_or("-".to_owned(), |n| n.to_string()),
        ];
        if let Some(reality) = reality {
            row.push(reality.showing(Some(&behaviour.name)).to_string());
        }
        table.push(row);
    }
    if let Some(reality) = reality {
        let unlike = reality.showing(None);
        if unlike > 0 {
            let mut row = vec!["not predicted".to_owned()];
            row.extend(std::iter::repeat_n("-".to_owned(), 4));
            row.push(unlike.to_string());
            table.push(row);
        }
    }
    table.render(colour).trim_end().to_owned()
}
