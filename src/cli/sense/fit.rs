//! `realgap sense fit`: fits a model of a range sensor to a log of readings at known distances.

use realgap::results::{draw_histograms, draw_sensor};
use realgap::sensing::range::form::{FORMS, Form, form_by_name};
use realgap::sensing::range::{Characterisation, LEVEL, LogOptions, Options, ReadingLog};
use realgap::unit::LengthUnit;

use crate::cli::kit::*;

/// Fit a model of a range sensor to a log of readings: mean and spread over the distance
///
/// Use it on readings that were logged at known distances. The model can then be simulated: by `realgap sense draw`,
/// and by vehicles and controllers that name its file.
///
/// The log is a CSV file with one row per reading and the columns distance_cm (or _m, _mm) and reading_cm (or _m,
/// _mm; any other ending is the sensor's own unit). Add the columns incidence_deg, offset_deg, material, t_s and
/// session (days, mountings) where they are known. An empty reading, nan and inf count as missing readings, and so
/// does a length of 0 or below, with a warning. With three or more sessions, the spread between sessions is printed,
/// and the intervals hold for a further session.
///
/// The forms of mean and spread are chosen by how well they predict readings at distances that were left out (paper
/// 000, section 4). Pairs of forms within one standard error of the best count as equal, and of these the pair with
/// the fewest parameters wins. The command prints the parameters with intervals (--level), how often a reading was
/// missing or nonsensical, whether the form misses the mean readings (χ²), whether readings are normally distributed
/// (Anderson-Darling test), and how many readings are enough: the share of readings that lie in another bin of the
/// histogram than in an infinitely long log, by the size of the log.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  realgap sense fit log.csv -o sensor.ron --plot sensor.png")]
pub struct Fit {
    /// The log (.csv)
    log: PathBuf,
    /// Form of the mean over the distance: linear, power, exponential, table or auto
    #[arg(long, value_name = "FORM", default_value = "auto")]
    model: String,
    /// Form of the spread over the distance, as for --model
    #[arg(long, value_name = "FORM", default_value = "auto")]
    spread: String,
    /// Unit of a column `distance` whose name does not say it
    #[arg(long, value_name = "UNIT", default_value = "m")]
    unit: LengthUnit,
    /// Use only readings from this material
    #[arg(long, value_name = "NAME")]
    material: Option<String>,
    /// Column that names sessions, days or mountings, where it is not called `session`
    #[arg(long, value_name = "COLUMN")]
    session: Option<String>,
    /// Confidence level of all intervals
    #[arg(long, value_name = "SHARE", default_value_t = LEVEL)]
    level: f64,
    /// Width of a bin of the histograms, in the reading's unit [default: a fifth of the spread]
    #[arg(long, value_name = "WIDTH")]
    bin: Option<f64>,
    /// Share of the readings in a different bin below which a histogram counts as converged
    #[arg(long, value_name = "SHARE", default_value_t = 0.125)]
    tolerance: f64,
    /// Seed of the analysis of how many readings are enough
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    seed: u64,
    /// Write the model into this .ron file
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Draw mean and spread over the distance into this .png or .svg (as figure 4 of paper 000)
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    /// Draw histograms at three distances into this .png or .svg (as figure 3 of paper 000)
    #[arg(long, value_name = "FILE")]
    histograms: Option<PathBuf>,
    /// Distances of the histograms, in the log's unit [default: near both ends and in the middle]
    #[arg(long, value_name = "D", value_delimiter = ',', requires = "histograms")]
    at: Vec<f64>,
    #[command(flatten)]
    telling: Telling,
}

/// The form of this name; `None` for `auto`, which lets the data choose.
fn form(option: &str, name: &str) -> Result<Option<&'static dyn Form>> {
    if name == "auto" {
        return Ok(None);
    }
    form_by_name(name).map(Some).map_err(|e| {
        let names = FORMS.map(|form| form.name()).join(", ");
        e.field(option)
            .allowed(format!("auto, {names}"))
            .into_usage()
    })
}

impl Fit {
    pub fn run(self) -> Result<()> {
        let options = Options {
            mean: form("--model", &self.model)?,
            spread: form("--spread", &self.spread)?,
            bin: self.bin,
            tolerance: Some(self.tolerance),
            level: Some(self.level),
            seed: self.seed,
        };
        let positive = |option: &str, value: f64| {
            if value > 0.0 && value.is_finite() {
                return Ok(());
            }
            Err(Error::usage("must be above 0").field(option).found(value))
        };
        if !(self.level > 0.0 && self.level < 1.0) {
            return Err(Error::usage("not a level")
                .field("--level")
                .found(self.level)
                .allowed("above 0 and below 1, e.g. 0.9"));
        }
        positive("--tolerance", self.tolerance)?;
        self.bin.map_or(Ok(()), |bin| positive("--bin", bin))?;
        self.telling.check()?;
        output::check_pictures(self.plot.iter().chain(&self.histograms))?;
        output::check_all(&self.output)?;
        let reading = LogOptions {
            unit: self.unit,
            material: self.material.clone(),
            session: self.session.clone(),
        };
        let log = ReadingLog::read_with(&self.log, &reading)?;
        let mut found = Characterisation::new(&log, &options).map_err(|e| e.at_file(&self.log))?;
        found.model.description = format!(
            "characterised from {}",
            self.log.file_name().unwrap_or_default().display()
        );
        terminal::print_warnings(&found.warnings);
        if let Some(output) = &self.output {
            output::write_ron(output, &found.model.to_ron()?)?;
        }
        if let Some(plot) = &self.plot {
            draw_sensor(&found, plot)?;
        }
        if let Some(plot) = &self.histograms {
            draw_histograms(&found, &log, &self.at, self.bin, plot)?;
        }
        let pictures = self.plot.iter().chain(&self.histograms);
        self.telling
            .value("sensor", &self.log, &found, pictures, &[])
    }
}
