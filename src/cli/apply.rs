//! `realgap apply`: the values of a fit in the user's own robot file, as draws, and on a card.

use realgap::file::Source;
use realgap::file::read_limited;
use realgap::plot::number;
use realgap::results::FittedStudy;
use realgap::robot::import::Options;
use realgap::simulation::export::{Calibrated, Fate, calibrate};

use super::import::{MOST_BYTES, package};
use super::kit::*;

/// Put fitted values into your own URDF, MJCF or RON, and hand on what they leave open
///
/// Use it to take the answer of a sweep or a tuning to your own simulator. In the robot's file only the fitted numbers
/// change, or appear where the file left a default; comments, order, blanks and included files stay, so that `diff` shows
/// nothing else. A comment before each changed element, or line of RON, says value, interval and study. What the file
/// cannot say is listed, with the reason. The file is read back, and must say what was fitted. A value that was fitted in
/// one engine is a value of that engine: friction and contact are not carried to another.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  realgap apply results/go2_fit go2.xml -o go2_calibrated.xml
  realgap apply results/arm_fit arm.ron -o arm_calibrated.ron
  realgap apply results/go2_fit --ranges draws.json --card go2.md
  realgap apply results/go2_fit go2.xml -o go2_calibrated.xml --format json")]
pub struct Apply {
    /// A folder that sweep or tune has written
    results: PathBuf,
    /// The robot's URDF, MJCF or RON, from which the study's robot was read
    model: Option<PathBuf>,
    /// Write the robot's file with the fitted values here, in the folder of the original where that names other files
    #[arg(short, long, value_name = "FILE", requires = "model")]
    output: Option<PathBuf>,
    /// Write draws of the posterior for domain randomisation: FILE.json with the range of each parameter beside them, or
    /// FILE.csv with one draw a row
    #[arg(long, value_name = "FILE")]
    ranges: Option<PathBuf>,
    /// Write a card of one page: values, intervals, verdict, errors, data, versions
    #[arg(long, value_name = "FILE.md")]
    card: Option<PathBuf>,
    /// Folder of a package: package://NAME/... is read from DIR/... (repeatable)
    #[arg(long, value_name = "NAME=DIR", value_parser = package)]
    package: Vec<(String, PathBuf)>,
    #[command(flatten)]
    print: Print,
}

/// What `realgap apply --format json` prints.
#[derive(Debug, Default, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Applied {
    /// The robot's file with the fitted values; absent where none was written.
    output: Option<PathBuf>,
    /// Every fitted value, and what became of it in this file; empty where none was written.
    values: Vec<AppliedValue>,
    /// The largest relative difference between a number that was to be written and the same number read back.
    largest_difference: Option<f64>,
    /// The file of draws; absent where none was written.
    ranges: Option<PathBuf>,
    /// Number of draws in it.
    draws: usize,
    /// The card; absent where none was written.
    card: Option<PathBuf>,
}

/// A fitted value in the robot's file.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct AppliedValue {
    /// The parameter.
    parameter: &'static str,
    /// Its value, in the parameter's unit.
    value: f64,
    /// The numbers that were written for it; several parameters may share one. Empty where the file says it already, or cannot.
    numbers: Vec<AppliedNumber>,
    /// Why the file cannot say it; absent where it does.
    unsaid: Option<String>,
}

/// A number that was written.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct AppliedNumber {
    /// Line in the file as it was, from 1.
    line: usize,
    /// The element, e.g. `joint elbow`.
    element: String,
    /// The attribute.
    attribute: String,
    /// Its text before; absent where the file left it to a default.
    before: Option<String>,
    /// Its text now.
    now: String,
}

impl Applied {
    /// Adds what became of the values in the robot's file.
    fn add(&mut self, output: &Path, calibrated: &Calibrated) {
        self.output = Some(output.to_path_buf());
        self.largest_difference = Some(calibrated.largest_difference);
        let values = calibrated.values.iter().map(|(value, fate)| AppliedValue {
            parameter: value.parameter.name,
            value: value.value,
            numbers: match fate {
                Fate::Written(written) => written
                    .iter()
                    .map(|one| AppliedNumber {
                        line: one.line,
                        element: one.element.clone(),
                        attribute: one.attribute.clone(),
                        before: one.before.clone(),
                        now: one.now.clone(),
                    })
                    .collect(),
                Fate::Unchanged | Fate::Unsaid(_) => Vec::new(),
            },
            unsaid: match fate {
                Fate::Unsaid(why) => Some(why.clone()),
                Fate::Written(_) | Fate::Unchanged => None,
            },
        });
        self.values = values.collect();
    }
}

impl Apply {
    pub fn run(self) -> Result<()> {
        if self.model.is_none() && self.ranges.is_none() && self.card.is_none() {
            return Err(Error::usage("nothing to write")
                .allowed("a robot's file, --ranges FILE, --card FILE.md"));
        }
        if self.print.is_json() && self.model.is_some() && self.output.is_none() {
            return Err(Error::usage(
                "--format json prints the report, and the robot needs a file",
            )
            .hint("add -o calibrated.xml"));
        }
        let mut applied = Applied::default();
        let files = [&self.output, &self.ranges, &self.card];
        output::check_all(files.into_iter().flatten())?;
        let ranges_are_csv = match &self.ranges {
            None => false,
            Some(path) => is_csv(path)?,
        };
        let fitted = FittedStudy::read(&self.results)?;
        if let Some(model) = &self.model {
            self.write_model(&fitted, model, &mut applied)?;
        }
        if let Some(path) = &self.ranges {
            let text = match ranges_are_csv {
                true => fitted.ranges_csv()?,
                false => fitted.ranges_json()?,
            };
            output::write(path, text.as_bytes())?;
            applied.draws = fitted.draws().len();
            applied.ranges = Some(path.clone());
            let count = counted(applied.draws, "draw");
            terminal::note(format!("{}: {count}", path.display()));
        }
        if let Some(path) = &self.card {
            let text = format!(
                "<!-- Written by realgap {}. -->\n",
                env!("CARGO_PKG_VERSION")
            );
            output::write(path, (text + &fitted.card()).as_bytes())?;
            applied.card = Some(path.clone());
            terminal::note(format!("{}: the parameters on one page", path.display()));
        }
        match self.print.is_json() {
            true => terminal::print_answer(&applied),
            false => Ok(()),
        }
    }

    fn write_model(&self, fitted: &FittedStudy, model: &Path, applied: &mut Applied) -> Result<()> {
        let bytes = read_limited(model, MOST_BYTES, "robot")?;
        let text = String::from_utf8(bytes).map_err(|_| {
            Error::invalid("the file is not UTF-8, so that its other bytes could not be kept")
                .at_file(model)
                .hint("save it as UTF-8")
        })?;
        let body = text.trim_start_matches('\u{feff}');
        let mark = &text[..text.len() - body.len()];
        let options = Options {
            packages: self.package.clone(),
            ..Options::default()
        };
        let source = Source::new(model, body);
        let calibrated = calibrate(&source, &options, fitted.values(), |value| {
            fitted.remark(value)
        })?;
        let text = format!("{mark}{}", calibrated.text);
        match &self.output {
            None => terminal::print(text.trim_end()),
            Some(path) => {
                output::write(path, text.as_bytes())?;
                if !self.print.is_json() {
                    terminal::print(report(path, &calibrated));
                }
                applied.add(path, &calibrated);
                note_moved(model, path, body);
            }
        }
        unsaid(&calibrated);
        Ok(())
    }
}

/// Whether draws are written as CSV, and not as JSON.
fn is_csv(path: &Path) -> Result<bool> {
    let ending = path.extension().map(|ending| ending.to_string_lossy());
    match ending.as_deref() {
        Some("csv") => Ok(true),
        Some("json") => Ok(false),
        _ => Err(Error::usage("draws are JSON or CSV")
            .at_file(path)
            .allowed("a name that ends in .json or .csv")),
    }
}

/// What was written, a row a number.
fn report(path: &Path, calibrated: &Calibrated) -> String {
    let left = |name| (name, Side::Left);
    let header = [
        left("line"),
        left("element"),
        left("attribute"),
        left("before"),
        left("now"),
    ];
    let mut table = TextTable::new(header);
    let mut values = 0;
    let mut rows: Vec<[String; 5]> = Vec::new();
    for (_, fate) in &calibrated.values {
        let Fate::Written(written) = fate else {
            continue;
        };
        values += 1;
        for one in written {
            let row = [
                one.line.to_string(),
                one.element.clone(),
                one.attribute.clone(),
                one.before.clone().unwrap_or_else(|| "default".to_owned()),
                one.now.clone(),
            ];
            if !rows.contains(&row) {
                rows.push(row);
            }
        }
    }
    let count = rows.len();
    rows.into_iter().for_each(|row| table.push(row));
    format!(
        "{}{}: {values} of {} in {}; read back, they differ from the fit by at most {} of their size",
        match count {
            0 => String::new(),
            _ => format!("{}\n", terminal::table(&table)),
        },
        path.display(),
        counted(calibrated.values.len(), "fitted value"),
        counted(count, "number"),
        number(calibrated.largest_difference),
    )
}

/// Lists what the file does not say.
fn unsaid(calibrated: &Calibrated) {
    for (value, fate) in &calibrated.values {
        match fate {
            Fate::Written(_) => {}
            Fate::Unchanged => terminal::note(format!("{value}: the file says so already")),
            Fate::Unsaid(why) => terminal::note(format!("not in the file: {value}: {why}")),
        }
    }
}

/// Says so where a file that names others was written into another folder.
fn note_moved(model: &Path, path: &Path, text: &str) {
    let folder = |path: &Path| {
        let parent = path
            .parent()
            .filter(|parent| !parent.as_os_str().is_empty());
        parent.unwrap_or(Path::new(".")).canonicalize().ok()
    };
    let names_files = ["file=", "filename=", "meshdir="]
        .iter()
        .any(|name| text.contains(name));
    if names_files && folder(model) != folder(path) {
        terminal::note(format!(
            "{} names other files from its own folder: put it beside {}",
            path.display(),
            model.display()
        ));
    }
}
