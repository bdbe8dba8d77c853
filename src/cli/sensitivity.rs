//! `realgap study sensitivity`: which parameters change the score.

use realgap::calibration::{Overrides, Sensitivity as Effects, Study};
use realgap::plot::{Bar, BarChart, Caption, draw_bars, number};

use super::kit::*;
use super::option::metric_option;

/// Change every parameter a little, one at a time, and print how the score changes
///
/// Use it before a sweep: a parameter without effect on the score cannot be fitted. The changes start from the
/// study's values, or from those of --parameters best.ron. Each parameter moves by a step that a user would call
/// small (`realgap study parameters` lists it). A change below the score's own standard deviation, over starts 1 mm
/// and 1° off, is chance.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  realgap study sensitivity sweeps/tripod_floor.ron --plot bars.png")]
pub struct Sensitivity {
    /// The study
    study: PathBuf,
    #[command(flatten)]
    values: Values,
    #[command(flatten)]
    recordings: Recordings,
    /// Metric in place of the study's own
    #[arg(long, value_name = "NAME")]
    metric: Option<String>,
    /// Draw a bar chart into this .png or .svg
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    #[command(flatten)]
    jobs: Jobs,
    #[command(flatten)]
    print: Print,
}

impl Sensitivity {
    pub fn run(self) -> Result<()> {
        output::check_pictures(&self.plot)?;
        let overrides = Overrides {
            set: self.values.parameter_set()?,
            metric: metric_option(self.metric.as_deref())?,
            ..self.recordings.overrides()?
        };
        let study = read_study(&self.study, &overrides)?;
        let result = progress::during(0, "changing parameters", self.jobs.run(), |run| {
            study.sensitivity(run)
        })?;
        terminal::print_warnings(&result.warnings);
        if let Some(path) = &self.plot {
            draw_bars(&chart(&study, &result), path)?;
        }
        self.print.answer(&result, || words(&study, &result))
    }
}

fn moves(value: f64, lower: Option<f64>, higher: Option<f64>) -> String {
    let end = |end: Option<f64>| end.map_or("-".to_owned(), number);
    format!("{} | {} | {}", end(lower), number(value), end(higher))
}

fn chart(study: &Study, result: &Effects) -> BarChart {
    let definition = study.definition();
    let bars = result.effects.iter().map(|effect| Bar {
        name: effect.parameter.to_owned(),
        lower: effect.lower_change,
        higher: effect.higher_change,
    });
    BarChart {
        caption: Caption::new(
            format!(
                "{}: what a small change of each parameter does",
                definition.name
            ),
            format!(
                "{}, {} {}; score at the point {}",
                definition.morphology.name(),
                definition.recordings.len(),
                definition.source().recordings_label(),
                quantity(result.score, definition.metric.unit())
            ),
        ),
        label: format!("change of the {} discrepancy", result.metric),
        unit: definition.metric.unit(),
        bars: bars.collect(),
        noise: result.start_sd,
    }
}

fn words(study: &Study, result: &Effects) -> String {
    let unit = study.definition().metric.unit();
    let mut table = TextTable::new([
        ("parameter", Side::Left),
        ("unit", Side::Left),
        ("smaller | value | larger", Side::Right),
        ("change if smaller", Side::Right),
        ("change if larger", Side::Right),
    ]);
    let change = |change: Option<f64>| change.map_or("-".to_owned(), |c| quantity(c, unit));
    for effect in &result.effects {
        table.push([
            effect.parameter.to_owned(),
            effect.unit.to_owned(),
            moves(effect.value, effect.lower, effect.higher),
            change(effect.lower_change),
            change(effect.higher_change),
        ]);
    }
    let chance = match result.start_sd {
        Some(sd) => format!(
            "; a start 1 mm and 1 deg off changes it by {} (sd), so smaller changes are chance",
            quantity(sd, unit)
        ),
        None => String::new(),
    };
    format!(
        "{} at the point: {}{chance}\n{}",
        result.metric,
        quantity(result.score, unit),
        terminal::table(&table)
    )
}
