//! `realgap study parameters`: lists the registry of parameters.

use realgap::simulation::parameter::{self, Nudge, Scale};

use super::kit::*;

/// List every parameter that can be set, swept or tuned, with unit, bounds, default and meaning
///
/// Use it to find names for `--set` and for the `parameters` of a study.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  realgap study parameters")]
pub struct Parameters {
    #[command(flatten)]
    print: Print,
}

/// The step by which `realgap study sensitivity` changes a parameter.
fn step(nudge: Nudge) -> String {
    match nudge {
        Nudge::Share(share) => format!("{:.0} %", 100.0 * share),
        Nudge::Absolute(step) => step.to_string(),
    }
}

/// A parameter.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ParameterRow {
    /// Its name.
    name: &'static str,
    /// Its unit; `1` for a plain number.
    unit: &'static str,
    /// Lowest value.
    low: f64,
    /// Highest value.
    high: f64,
    /// The value that it has by default, where the robot does not say.
    default: Option<f64>,
    /// Whether it is a whole number.
    whole: bool,
    /// The step by which `realgap study sensitivity` changes it.
    small_step: String,
    /// Whether it is searched on a logarithmic scale.
    log: bool,
    /// What it means.
    doc: &'static str,
}

impl ParameterRow {
    fn new(p: &parameter::Parameter) -> Self {
        Self {
            name: p.name,
            unit: p.unit.label(),
            low: p.bounds.0,
            high: p.bounds.1,
            default: p.default_value(),
            whole: p.whole,
            small_step: step(p.nudge),
            log: p.scale == Scale::Log,
            doc: p.doc,
        }
    }
}

impl Parameters {
    pub fn run(self) -> Result<()> {
        if self.print.is_json() {
            let rows: Vec<_> = parameter::all()
                .chain(parameter::families())
                .map(ParameterRow::new)
                .collect();
            terminal::print_answers(&rows)?;
            return Ok(());
        }
        let mut table = TextTable::new([
            ("parameter", Side::Left),
            ("unit", Side::Left),
            ("low", Side::Right),
            ("high", Side::Right),
            ("default", Side::Right),
            ("small step", Side::Right),
            ("meaning", Side::Left),
        ]);
        for p in parameter::all().chain(parameter::families()) {
            let default = p.default_value().map_or("robot".to_owned(), |value| {
                format!("{value:.6}")
                    .trim_end_matches('0')
                    .trim_end_matches('.')
                    .to_owned()
            });
            table.push([
                p.name.to_owned(),
                p.unit.symbol().to_owned(),
                p.bounds.0.to_string(),
                p.bounds.1.to_string(),
                default,
                step(p.nudge),
                p.doc.to_owned(),
            ]);
        }
        terminal::print(terminal::table(&table));
        Ok(())
    }
}
