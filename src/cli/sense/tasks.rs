//! `realgap sense tasks`: compares real and simulated task times.

use realgap::results::{draw_task_curves, draw_task_times};
use realgap::sensing::task::{Goal, TaskComparison, TaskLog, time_to_reach};
use realgap::trajectory;
use realgap::unit::LengthUnit;

use crate::cli::kit::*;

commands! {
    /// Compare how long tasks take in reality and in simulation (paper 002, section V)
    ///
    /// A log is a CSV file with one row per trial: duration_s; `finished` (1 or 0) where some trials were given up;
    /// and any columns that name conditions (robot, mode, difficulty …). Columns called trial, run, subject,
    /// participant, operator, id, repeat or session only number trials.
    TasksCommand:
    Compare(Compare),
    Time(Time),
}

/// Compare real and simulated task times: medians, tests, effect sizes and the order of conditions
///
/// Use it to see whether a simulation puts conditions into the same order as reality. For every condition of both
/// logs, the command prints medians with 90 % intervals (Kaplan-Meier, since a trial that was given up took longer
/// than it lasted), their ratio, Cliff's δ with a bootstrap interval, and the Mann-Whitney test, or the log-rank test
/// where trials were given up. For every column, it prints whether both logs put its values into the same order, and
/// how often they would if trials were drawn again.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  realgap sense tasks compare real.csv simulated.csv --plot times.png")]
pub struct Compare {
    /// The real trials
    real: PathBuf,
    /// The simulated trials
    simulated: PathBuf,
    /// Draw medians and quartiles of every condition into this .png or .svg (as figure 13 of paper 002)
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    /// Draw the share of unfinished trials over time into this .png or .svg (Kaplan-Meier)
    #[arg(long, value_name = "FILE")]
    curves: Option<PathBuf>,
    /// Seed of the bootstrap
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    telling: Telling,
}

/// Print when trajectories first reach a place, as a log of task times
///
/// Use it to make a log for `realgap sense tasks compare`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  realgap sense tasks time runs/*.csv --reach 0.5,0 --condition robot=tripod")]
pub struct Time {
    /// Trajectories (.csv or .tum)
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// The place to reach, metres
    #[arg(
        long,
        value_name = "X,Y",
        value_delimiter = ',',
        allow_hyphen_values = true,
        required = true
    )]
    reach: Vec<f64>,
    /// Distance from the place that counts as reached, metres
    #[arg(long, value_name = "M", default_value_t = 0.1)]
    within: f64,
    /// Add this column to all rows: NAME=VALUE
    #[arg(long, value_name = "NAME=VALUE")]
    condition: Vec<String>,
}

impl Compare {
    pub fn run(self) -> Result<()> {
        self.telling.check()?;
        output::check_pictures(self.plot.iter().chain(&self.curves))?;
        let (real, simulated) = (TaskLog::read(&self.real)?, TaskLog::read(&self.simulated)?);
        let found = TaskComparison::new(&real, &simulated, self.seed)?;
        if let Some(plot) = &self.plot {
            draw_task_times(&found, plot)?;
        }
        if let Some(plot) = &self.curves {
            draw_task_curves(&found, plot)?;
        }
        let pictures = self.plot.iter().chain(&self.curves);
        self.telling
            .value("tasks", &self.real, &found, pictures, &found.warnings)
    }
}

impl Time {
    pub fn run(self) -> Result<()> {
        let [x, y] = self.reach[..] else {
            return Err(Error::usage("not a place")
                .field("--reach")
                .found(format!("{:?}", self.reach))
                .allowed("X,Y in metres"));
        };
        let goal = Goal {
            position_world_m: [x, y],
            within_m: self.within,
        };
        let columns = self
            .condition
            .iter()
            .map(|text| {
                text.split_once('=')
                    .filter(|(name, value)| {
                        ![*name, *value]
                            .iter()
                            .any(|s| s.is_empty() || s.contains([',', '"', '\n']))
                    })
                    .ok_or_else(|| {
                        Error::usage("not a column and its value")
                            .field("--condition")
                            .found(text)
                            .allowed("NAME=VALUE without commas and quotes")
                    })
            })
            .collect::<Result<Vec<_>>>()?;
        let mut lines = vec![
            columns
                .iter()
                .map(|(name, _)| *name)
                .chain(["run", "duration_s", "finished"])
                .collect::<Vec<_>>()
                .join(","),
        ];
        for (number, file) in self.files.iter().enumerate() {
            let motion = trajectory::read(file, LengthUnit::Metre)?;
            let duration = time_to_reach(&motion.trajectory, &goal).map_err(|e| e.at_file(file))?;
            let numbers = format!(
                "{number},{},{}",
                duration.time_s,
                u8::from(duration.finished)
            );
            let values: Vec<&str> = columns
                .iter()
                .map(|(_, value)| *value)
                .chain([numbers.as_str()])
                .collect();
            lines.push(values.join(","));
        }
        terminal::print(lines.join("\n"));
        Ok(())
    }
}
