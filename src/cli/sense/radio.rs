//! `realgap sense radio`: fits and evaluates models of signal strength, and simulates messages.

use realgap::results::{draw_error_map, draw_strength_map};
use realgap::sensing::arena::{Anchor, Arena};
use realgap::sensing::radio::propagation::{PROPAGATIONS, propagation_by_name};
use realgap::sensing::radio::{
    Evaluation, Fingerprints, LogBase, Message, RadioLog, RadioLogOptions, RadioModel,
    RadioOptions, Service, ServiceOptions, ServiceReport, fit, read_anchors,
};

use crate::cli::kit::*;

commands! {
    /// Fit and evaluate models of radio signal strength, and simulate messages (paper 002, section IV)
    ///
    /// A log is a CSV file with x_m, y_m and a column of signal strengths for every anchor (anchor_1_dbm …; empty
    /// where nothing was received). Walls, with thickness and material, and the places of the anchors come from an
    /// arena; realgap counts the walls between robot and anchor.
    RadioCommand:
    Fit(Fit),
    Evaluate(Evaluate),
    Map(Map),
    Send(Send),
}

/// Where the walls and anchors are.
#[derive(Debug, Clone, Args)]
struct Place {
    /// The arena: its walls and anchors
    #[arg(long, value_name = "FILE")]
    arena: PathBuf,
    /// A CSV with the anchors' places (id, x, y, z in metres) instead of the arena's own
    #[arg(long, value_name = "FILE")]
    anchors: Option<PathBuf>,
}

impl Place {
    fn read(&self) -> Result<(Arena, Vec<Anchor>)> {
        let arena = Arena::read(&self.arena)?;
        let anchors = match &self.anchors {
            Some(path) => read_anchors(path)?,
            None => arena.anchors.clone(),
        };
        Ok((arena, anchors))
    }
}

/// Bases of logarithms.
const BASES: &[Choice<LogBase>] = &[
    ("10", LogBase::Ten, "Base 10, as usual"),
    (
        "e",
        LogBase::E,
        "Base e, which the numbers of paper 002 need",
    ),
];

/// Fit a model of radio signal strength to a log
///
/// Use it on strengths that were logged at known places; `realgap sense radio evaluate` then checks the model on
/// another log. `walls` is equation 2 of paper 002: P(d₀) − 10 n log(d/d₀) − min(nW, C) WAF; `thickness` has a loss
/// per metre of wall, `materials` a loss per class of material. `auto` chooses the model, and the number C of walls
/// that count, whose errors are smallest at places (squares of a metre) that were left out. The numbers of paper 002
/// need `--log-base e`.
///
/// The command prints the parameters with 90 % intervals, which take into account that readings near each other share
/// their errors; whether the log determines each parameter, and otherwise why not; the standard deviations that a
/// place and a reading add to a strength; and how near to the prediction 90 % of the strengths at new places lie.
/// Strengths of 0 dBm or more, or under −120 dBm, count as not received, with a warning.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  realgap sense radio fit poses.csv --arena arenas/flat.ron -o radio.ron")]
pub struct Fit {
    /// The log (.csv)
    log: PathBuf,
    #[command(flatten)]
    place: Place,
    /// Use only rows of this session (column `session`)
    #[arg(long, value_name = "NAME")]
    session: Option<String>,
    /// free-space, log-distance, walls, thickness, materials, or auto, which chooses the model that predicts left-out places best
    #[arg(long, value_name = "NAME", default_value = "auto")]
    model: String,
    /// Base of the logarithm of distances: the exponent depends on it
    #[arg(long, value_parser = choice(BASES), default_value = "10")]
    log_base: LogBase,
    /// Reference distance d₀, at which the strength is a parameter, metres
    #[arg(long, value_name = "M", default_value_t = 1.0)]
    reference_distance: f64,
    /// Height of the robot's antenna, metres
    #[arg(long, value_name = "M", default_value_t = 0.3)]
    height: f64,
    /// Write the model into this .ron file
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    #[command(flatten)]
    telling: Telling,
}

/// Evaluate a radio model on a held-out log, and compare it with baselines
///
/// Use it on a log or session that the fit has not used. The command prints the error, over all anchors and for each
/// one, the share of strengths in the 90 % interval, and the errors of the baselines: the other models of the same
/// fit, the mean strength, and the mean of the nearest readings of a log (--fingerprints).
#[derive(Debug, Args)]
#[command(
    override_usage = "realgap sense radio evaluate [OPTIONS] --arena <FILE>\n           --parameters <FILE> <LOG>"
)]
#[command(after_help = "\
Examples:
  realgap sense radio evaluate poses.csv --session 2 --arena arenas/flat.ron \\
      --parameters radio.ron --fingerprints poses.csv --fingerprint-session 0")]
pub struct Evaluate {
    /// The log (.csv)
    log: PathBuf,
    #[command(flatten)]
    place: Place,
    /// The model that `fit` wrote
    #[arg(long, value_name = "FILE")]
    parameters: PathBuf,
    /// Use only rows of this session (column `session`)
    #[arg(long, value_name = "NAME")]
    session: Option<String>,
    /// Log for the baseline of nearest places (usually the log that was fitted)
    #[arg(long, value_name = "FILE")]
    fingerprints: Option<PathBuf>,
    /// Use only rows of this session of --fingerprints
    #[arg(long, value_name = "NAME", requires = "fingerprints")]
    fingerprint_session: Option<String>,
    /// Number of nearest places in the baseline
    #[arg(
        long,
        value_name = "K",
        default_value_t = 15,
        requires = "fingerprints"
    )]
    neighbours: usize,
    /// Draw the residuals at each place into this .png or .svg
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    #[command(flatten)]
    telling: Telling,
}

/// Draw a map of the signal strength of one anchor
///
/// Use it to see where in an arena the anchor can be received.
#[derive(Debug, Args)]
#[command(
    override_usage = "realgap sense radio map [OPTIONS] --arena <FILE> --parameters <FILE>\n           --anchor <NAME> --plot <FILE>"
)]
#[command(after_help = "\
Examples:
  realgap sense radio map --arena arenas/flat.ron --parameters radio.ron \\
      --anchor 2 --plot map.png")]
pub struct Map {
    #[command(flatten)]
    place: Place,
    /// The model that `fit` wrote
    #[arg(long, value_name = "FILE")]
    parameters: PathBuf,
    /// Name of the anchor
    #[arg(long, value_name = "NAME")]
    anchor: String,
    /// Draw into this .png or .svg
    #[arg(long, value_name = "FILE")]
    plot: PathBuf,
}

/// Simulate messages between two places, and count how many arrive
///
/// Use it to see whether two robots can reach each other, and how late. A message weaker than −92 dBm does not
/// arrive; of the others, the share that --loss-half and --loss-width give is lost. Shadowing and fading are drawn at
/// random. The outcome of a message depends on its number and --seed alone.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  realgap sense radio send --arena arenas/flat.ron --parameters radio.ron \\
      --from 1,6 --to 8,5")]
pub struct Send {
    #[command(flatten)]
    place: Place,
    /// The model that `fit` wrote
    #[arg(long, value_name = "FILE")]
    parameters: PathBuf,
    /// Where the sender is, metres: X,Y or X,Y,Z
    #[arg(
        long,
        value_name = "X,Y",
        value_delimiter = ',',
        allow_hyphen_values = true
    )]
    from: Vec<f64>,
    /// Where the receiver is, metres: X,Y or X,Y,Z
    #[arg(
        long,
        value_name = "X,Y",
        value_delimiter = ',',
        allow_hyphen_values = true
    )]
    to: Vec<f64>,
    /// Number of messages
    #[arg(long, value_name = "N", default_value_t = 1000)]
    messages: u64,
    /// Strength above the sensitivity at which half of the messages are lost, dB
    #[arg(
        long,
        value_name = "DB",
        default_value_t = 0.0,
        allow_hyphen_values = true
    )]
    loss_half: f64,
    /// Decibels over which the loss falls from 73 to 27 %; 0 for a step
    #[arg(long, value_name = "DB", default_value_t = 0.0)]
    loss_width: f64,
    /// Mean time from sending to arriving, seconds
    #[arg(long, value_name = "S", default_value_t = 0.0)]
    latency: f64,
    /// Standard deviation of --latency, seconds
    #[arg(long, value_name = "S", default_value_t = 0.0)]
    latency_sd: f64,
    /// Leave out shadowing and fading
    #[arg(long)]
    no_noise: bool,
    /// Seed of shadowing, fading, losses and latencies
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    print: Print,
}

fn read_log(path: &Path, session: Option<&String>) -> Result<RadioLog> {
    let options = RadioLogOptions {
        session: session.cloned(),
    };
    RadioLog::read_with(path, &options)
}

impl Fit {
    pub fn run(self) -> Result<()> {
        self.telling.check()?;
        output::check_all(&self.output)?;
        let propagation = match self.model.as_str() {
            "auto" => None,
            name => Some(propagation_by_name(name).map_err(|e| {
                let names = PROPAGATIONS.map(|p| p.name()).join(", ");
                e.field("--model")
                    .allowed(format!("auto, {names}"))
                    .into_usage()
            })?),
        };
        let options = RadioOptions {
            propagation,
            reference_distance_m: self.reference_distance,
            log_base: self.log_base,
            robot_height_m: self.height,
        };
        let (arena, anchors) = self.place.read()?;
        let log = read_log(&self.log, self.session.as_ref())?;
        let mut found = fit(&log, &arena, &anchors, &options).map_err(|e| e.at_file(&self.log))?;
        found.model.description = format!(
            "fitted to {}",
            self.log.file_name().unwrap_or_default().display()
        );
        terminal::print_warnings(&found.warnings);
        if let Some(output) = &self.output {
            output::write_ron(output, &found.model.to_ron()?)?;
        }
        self.telling.value("radio", &self.log, &found, [], &[])
    }
}

impl Evaluate {
    pub fn run(self) -> Result<()> {
        self.telling.check()?;
        output::check_pictures(&self.plot)?;
        let model = RadioModel::read(&self.parameters)?;
        let (arena, anchors) = self.place.read()?;
        let log = read_log(&self.log, self.session.as_ref())?;
        let prints = self
            .fingerprints
            .as_ref()
            .map(|path| {
                let log = read_log(path, self.fingerprint_session.as_ref())?;
                Fingerprints::new(&log, self.neighbours)
            })
            .transpose()?;
        let found = Evaluation::new(&model, &arena, &anchors, &log, prints.as_ref())
            .map_err(|e| e.at_file(&self.log))?;
        if let Some(plot) = &self.plot {
            draw_error_map(&found, &arena, plot)?;
        }
        self.telling
            .value("radio", &self.log, &found, &self.plot, &found.warnings)
    }
}

impl Map {
    pub fn run(self) -> Result<()> {
        output::check_pictures([&self.plot])?;
        let model = RadioModel::read(&self.parameters)?;
        let (arena, anchors) = self.place.read()?;
        let anchor = anchors
            .iter()
            .find(|anchor| anchor.name == self.anchor)
            .ok_or_else(|| {
                let names: Vec<&str> = anchors.iter().map(|a| a.name.as_str()).collect();
                Error::usage("no such anchor")
                    .field("--anchor")
                    .found(&self.anchor)
                    .allowed(names.join(", "))
            })?;
        draw_strength_map(&model, &arena, anchor, &self.plot)?;
        Ok(())
    }
}

/// The place that an option gives; without Z, the height is that of the robot's antenna.
fn place(option: &str, values: &[f64], model: &RadioModel) -> Result<[f64; 3]> {
    match values {
        [x, y] if x.is_finite() && y.is_finite() => Ok(model.robot_at([*x, *y])),
        [x, y, z] if values.iter().all(|v| v.is_finite()) => Ok([*x, *y, *z]),
        _ => Err(Error::usage("not a place")
            .field(option)
            .found(format!("{values:?}"))
            .allowed("X,Y or X,Y,Z in metres")),
    }
}

impl Send {
    pub fn run(self) -> Result<()> {
        let model = RadioModel::read(&self.parameters)?;
        let (arena, _) = self.place.read()?;
        let from_m = place("--from", &self.from, &model)?;
        let to_m = place("--to", &self.to, &model)?;
        if !(1..=10_000_000).contains(&self.messages) {
            return Err(Error::usage("not a number of messages")
                .field("--messages")
                .found(self.messages)
                .allowed("1 to 10000000"));
        }
        let service = Service::new(
            &model,
            &arena,
            ServiceOptions {
                seed: self.seed,
                noise: !self.no_noise,
                loss_half_db: self.loss_half,
                loss_width_db: self.loss_width,
                latency_s: self.latency,
                latency_sd_s: self.latency_sd,
            },
        )?;
        let sent: Vec<_> = (0..self.messages)
            .map(|number| {
                let message = Message {
                    number,
                    from_m,
                    to_m,
                    at_s: 0.0,
                };
                (message, service.send(&message))
            })
            .collect();
        self.print.value(&ServiceReport::new(&sent))
    }
}
