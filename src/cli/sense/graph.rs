//! `realgap sense graph`: polynomials that predict a scanner's readings from its pose.

use realgap::results::{draw_segment, draw_visits, draw_way};
use realgap::sensing::arena::Arena;
use realgap::sensing::graph::regression::Stop;
use realgap::sensing::graph::{
    Evaluation, Frame, GraphOptions, Language, Logger, ScanLog, Sensorgraph, fit, functions,
};
use realgap::sensing::range::find_sensor;

use crate::cli::kit::*;

commands! {
    /// Fit polynomials that predict a scanner's readings from its pose, and evaluate them (paper 001)
    ///
    /// A log is a CSV file with t_s, x_m, y_m, heading_rad and a column for every beam (range_000_m, range_002_m … in
    /// degrees counter-clockwise from straight ahead), or a CARMEN log with FLASER lines.
    SensorgraphCommand:
    Log(Log),
    Fit(Fit),
    Evaluate(Evaluate),
    Print(PrintOut),
}

/// The part of a log that is used, and the source of its poses.
#[derive(Debug, Clone, Args)]
struct Part {
    /// File with the poses over time (TUM text, or a trajectory's CSV), in place of the log's columns
    #[arg(long, value_name = "FILE")]
    poses: Option<PathBuf>,
    /// Begin after this share of the path, 0 to 1
    #[arg(long, value_name = "SHARE", default_value_t = 0.0)]
    from: f64,
    /// End after this share of the path
    #[arg(long, value_name = "SHARE", default_value_t = 1.0)]
    to: f64,
    /// Use the pose that is this many seconds before each scan, for logs whose clocks differ
    #[arg(
        long,
        value_name = "S",
        default_value_t = 0.0,
        allow_negative_numbers = true
    )]
    lag: f64,
}

impl Part {
    fn read(&self, path: &Path) -> Result<ScanLog> {
        let log = match &self.poses {
            Some(poses) => {
                let (log, warning) = ScanLog::read_with_poses(path, poses)?;
                terminal::print_warnings(warning.as_slice());
                log
            }
            None => ScanLog::read(path)?,
        };
        if !(0.0 <= self.from && self.from < self.to && self.to <= 1.0) {
            return Err(Error::usage("not a part of the path")
                .field("--from, --to")
                .found(format!("{} to {}", self.from, self.to))
                .allowed("two increasing shares, 0 to 1"));
        }
        if !self.lag.is_finite() {
            return Err(Error::usage("not a time").field("--lag").found(self.lag));
        }
        let log = if self.lag == 0.0 {
            log
        } else {
            log.with_lag(self.lag)
        };
        let part = log.part(self.from, self.to);
        if part.scans.is_empty() {
            return Err(Error::usage("no scan lies in this part of the path").field("--from, --to"));
        }
        Ok(part)
    }
}

/// A frame, or `None` if the fit chooses the frame. The type has a name because clap treats `Option` as an option that may be missing.
type FrameChoice = Option<Frame>;

/// Frames of the prediction.
const FRAMES: &[Choice<FrameChoice>] = &[
    (
        "auto",
        None,
        "The frame that predicts held-out parts of the path better",
    ),
    (
        "robot",
        Some(Frame::Robot),
        "A polynomial for every range of headings and every segment",
    ),
    (
        "world",
        Some(Frame::World),
        "A polynomial for every direction of the world",
    ),
    (
        "nearest",
        Some(Frame::Nearest),
        "No polynomials: the scan at the nearest logged pose",
    ),
    (
        "turned",
        Some(Frame::Turned),
        "No polynomials: the scan at the nearest logged place, turned to the heading",
    ),
];

/// A rule that the options `--ratio` and `--terms` complete.
type StopChoice = fn(f64, usize) -> Stop;

/// Rules that end the adding of terms.
const STOPS: &[Choice<StopChoice>] = &[
    (
        "validation",
        |_, _| Stop::Validation,
        "At the smallest error on held-out parts of the path (chooses the degree, too)",
    ),
    ("aic", |_, _| Stop::Aic, "Akaike's information criterion"),
    (
        "bic",
        |_, _| Stop::Bic,
        "The Bayesian information criterion",
    ),
    (
        "err",
        |ratio, _| Stop::Err(ratio),
        "Once the share --ratio of the sum of squares is explained",
    ),
    (
        "terms",
        |_, terms| Stop::Terms(terms),
        "At the number --terms",
    ),
];

/// Simulate a robot that logs scans in an arena: a stand-in for a real log, with known walls
///
/// Use it to test `realgap sense graph fit` where the truth is known. The robot walks at random from the start pose
/// of the arena, turning away from near obstacles and by a random angle every 8 s; with `--way` it follows this path
/// and turns on the spot. It takes one scan a second, where paper 001 has four, because 1400 scans then see the whole
/// arena.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  realgap sense graph log arenas/cartons.ron -o walk.csv
  realgap sense graph log arenas/cartons.ron --way 1,1:4.6,2.8:6,9 -o way.csv")]
pub struct Log {
    /// The arena
    arena: PathBuf,
    /// The log to write (.csv)
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Number of scans of the random walk
    #[arg(long, value_name = "N", default_value_t = 1400, conflicts_with = "way")]
    samples: usize,
    /// Go along straight lines between these places, metres
    #[arg(long, value_name = "X,Y:X,Y…", value_parser = way, allow_hyphen_values = true)]
    way: Option<Way>,
    /// Range sensor of the robot: a shipped sensor or a model's .ron file whose readings are lengths
    #[arg(long, value_name = "SENSOR", default_value = "laser")]
    sensor: String,
    /// Number of beams of a scan
    #[arg(long, value_name = "N", default_value_t = Logger::default().beams)]
    beams: usize,
    /// Angle from the rightmost to the leftmost beam, degrees
    #[arg(long, value_name = "DEG", default_value_t = Logger::default().view_deg)]
    view: f64,
    /// Time from one scan to the next, seconds
    #[arg(long, value_name = "S", default_value_t = Logger::default().interval_s)]
    interval: f64,
    /// Speed of the robot, m/s
    #[arg(long, value_name = "M_S", default_value_t = Logger::default().speed_m_s)]
    speed: f64,
    /// Radius of the robot, metres
    #[arg(long, value_name = "M", default_value_t = Logger::default().radius_m)]
    radius: f64,
    /// Seed of the walk and of the readings
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    seed: u64,
}

/// The places of a path, metres.
#[derive(Debug, Clone)]
struct Way(Vec<[f64; 2]>);

fn way(text: &str) -> std::result::Result<Way, String> {
    let place = |text: &str| -> Option<[f64; 2]> {
        let (x, y) = text.split_once(',')?;
        let number = |text: &str| text.trim().parse().ok().filter(|v: &f64| v.is_finite());
        Some([number(x)?, number(y)?])
    };
    text.split(':')
        .map(|part| place(part).ok_or_else(|| format!("`{part}` is not a place such as 1.5,2")))
        .collect::<std::result::Result<_, _>>()
        .map(Way)
}

/// Fit polynomials that predict the scan at a pose to a log of scans
///
/// Use it to get a model of a scanner in one place; `realgap sense graph evaluate` then checks the model on another
/// part of the log. The beams of each segment (--width) are replaced by their median. `--frame robot` fits a
/// polynomial in (x, y) for every range of headings and every segment, as paper 001; `--frame world` fits one for
/// each direction of the world, from all headings, and interpolates a segment between the two directions next to its
/// middle. Terms are added in the order in which they explain most (error reduction ratio), until --stop ends it.
/// Predictions are limited to the shortest and the longest range of the fitted data.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  realgap sense graph fit scans.csv --to 0.7 -o model.ron")]
pub struct Fit {
    /// The log (.csv, or a CARMEN log)
    log: PathBuf,
    /// Write the model into this .ron file
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Largest degree of the polynomials
    #[arg(long, value_name = "N", default_value_t = 4)]
    degree: u32,
    /// Number of ranges of headings, or of directions of the world
    #[arg(long, value_name = "N", default_value_t = 12)]
    headings: usize,
    /// Width of a segment, degrees
    #[arg(long, value_name = "DEG", default_value_t = 30.0)]
    width: f64,
    /// Rule that ends the adding of terms
    #[arg(long, value_parser = choice(STOPS), default_value = "validation")]
    stop: StopChoice,
    /// With `--stop err`: share of the sum of squares to explain
    #[arg(long, value_name = "SHARE", default_value_t = 0.99)]
    ratio: f64,
    /// With `--stop terms`: number of terms
    #[arg(long, value_name = "N", default_value_t = 5)]
    terms: usize,
    /// Frame of the prediction
    #[arg(long, value_parser = choice(FRAMES), default_value = "auto")]
    frame: FrameChoice,
    #[command(flatten)]
    part: Part,
    /// Draw where the scans were taken into this .png or .svg (as figures 4, 8 and 9 of paper 001)
    #[arg(long, value_name = "FILE")]
    way: Option<PathBuf>,
    /// Draw how often each place and heading was visited into this .png or .svg (as figures 5 to 7 of paper 001)
    #[arg(long, value_name = "FILE")]
    visits: Option<PathBuf>,
    #[command(flatten)]
    telling: Telling,
}

/// Evaluate a model of a scanner on a held-out log, and compare it with baselines
///
/// Use it on a part of the log that the fit has not used (--from, --to). The command prints the mean absolute error
/// of the model and of the baselines: each segment's mean, the nearest logged pose (a radian counts as a metre), the
/// nearest logged place with its scan turned to the heading, ideal beams in an arena (--arena), and random numbers.
/// It also prints Spearman's rank correlation with its p value, and the Mann-Whitney test against the random
/// baseline.
///
/// Neighbouring scans see nearly the same, so a path counts for fewer scans than it has. The standard error of the
/// whole is computed from ten parts of the path, that of a segment is widened by the autocorrelation of its errors.
/// The p value of a rank correlation uses the effective number of pairs of the two series (Bartlett 1935), and the
/// test against the random baseline takes one scan in `every`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  realgap sense graph evaluate scans.csv --from 0.7 --parameters model.ron")]
pub struct Evaluate {
    /// The log (.csv, or a CARMEN log)
    log: PathBuf,
    /// The model that `fit` wrote
    #[arg(long, value_name = "FILE")]
    parameters: PathBuf,
    /// Arena for the baseline of ideal beams
    #[arg(long, value_name = "FILE")]
    arena: Option<PathBuf>,
    #[command(flatten)]
    part: Part,
    /// Seed of the random baseline
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    seed: u64,
    /// Draw predicted and actual ranges of one segment along the way into this .png or .svg (as figures 12 to 15 of paper 001)
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    /// Number of the segment to draw, from 0
    #[arg(long, value_name = "K", default_value_t = 0, requires = "plot")]
    segment: usize,
    #[command(flatten)]
    telling: Telling,
}

/// Print the polynomials of a model, or generate a function from them in another language
///
/// Use it to read a model, or to run it on a robot without realgap.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  realgap sense graph print model.ron --language c")]
pub struct PrintOut {
    /// The model that `fit` wrote
    model: PathBuf,
    /// Generate a function in this language: c, python or rust
    #[arg(long, value_name = "NAME")]
    language: Option<String>,
}

impl Log {
    pub fn run(self) -> Result<()> {
        output::check(&self.output)?;
        let arena = Arena::read(&self.arena)?;
        let sensor = find_sensor(&self.sensor)?;
        let logger = Logger {
            beams: self.beams,
            view_deg: self.view,
            interval_s: self.interval,
            speed_m_s: self.speed,
            radius_m: self.radius,
            ..Logger::default()
        };
        let scans = if self.way.is_some() { 1 } else { self.samples };
        logger.check(&sensor, scans).map_err(Error::into_usage)?;
        let log = match &self.way {
            Some(Way(places)) => logger.follow(&arena, &sensor, places, self.seed),
            None => logger.walk(&arena, &sensor, self.samples, self.seed),
        };
        let log = log.map_err(|e| e.at_file(&self.arena))?;
        output::write(&self.output, log.to_csv().as_bytes())?;
        terminal::print(format!(
            "{} in {}",
            counted(log.scans.len(), "scan"),
            self.output.display()
        ));
        Ok(())
    }
}

impl Fit {
    pub fn run(self) -> Result<()> {
        self.telling.check()?;
        output::check_pictures(self.way.iter().chain(&self.visits))?;
        output::check_all(&self.output)?;
        let options = GraphOptions {
            degree: self.degree,
            headings: self.headings,
            width_deg: self.width,
            stop: (self.stop)(self.ratio, self.terms),
            frame: self.frame,
        };
        let log = self.part.read(&self.log)?;
        let found = fit(&log, &options).map_err(|e| e.at_file(&self.log))?;
        terminal::print_warnings(&found.warnings);
        if let Some(plot) = &self.way {
            draw_way(&log, plot)?;
        }
        if let Some(plot) = &self.visits {
            draw_visits(&log, plot)?;
        }
        if let Some(output) = &self.output {
            output::write_ron(output, &found.model.to_ron()?)?;
        }
        let pictures = self.way.iter().chain(&self.visits);
        self.telling
            .value("sensorgraph", &self.log, &found, pictures, &[])
    }
}

impl Evaluate {
    pub fn run(self) -> Result<()> {
        self.telling.check()?;
        output::check_pictures(&self.plot)?;
        let model = Sensorgraph::read(&self.parameters)?;
        let log = self.part.read(&self.log)?;
        let arena = self.arena.as_ref().map(Arena::read).transpose()?;
        let found = Evaluation::new(&model, &log, arena.as_ref(), self.seed)
            .map_err(|e| e.at_file(&self.log))?;
        if let Some(plot) = &self.plot {
            draw_segment(&model, &log, self.segment, plot)?;
        }
        self.telling.value(
            "sensorgraph",
            &self.log,
            &found,
            &self.plot,
            &found.warnings,
        )
    }
}

impl PrintOut {
    pub fn run(self) -> Result<()> {
        let language = self
            .language
            .as_deref()
            .map(Language::by_name)
            .transpose()
            .map_err(Error::into_usage)?;
        let model = Sensorgraph::read(&self.model)?;
        let text = match language {
            Some(language) => functions(&model, language).map_err(|e| e.at_file(&self.model))?,
            None => model.to_string(),
        };
        terminal::print(text.trim_end());
        Ok(())
    }
}
