//! `realgap evaluate`: how well one setting predicts recordings.

use realgap::calibration::{Average, Evaluation, JointEvaluation, Overrides};
use realgap::claim::verdict_lines;
use realgap::comparison::{Joints, Pose};
use realgap::identification::StartState;
use realgap::prediction::Odds;
use realgap::simulation::parameter::ParameterSet;
use realgap::trajectory::Recording;
use realgap::unit::number;

use super::kind::read_definition;
use super::kit::*;
use super::odds::OddsOption;
use super::option::STARTS;

/// Simulate every recording of a study once with given values, and print the pose errors
///
/// Use it to check values on recordings that they were not fitted on: `--every 2 --offset 1` takes the odd-numbered
/// ones. Nothing is fitted here. The command prints the mean, median and standard error of position and rotation
/// errors, and how many runs end more than 45° off.
///
/// --odds estimates the probability of each final pose (the face that is down, and the quarter turn of every hinge)
/// and scores these probabilities: the Brier score and the log score, how far the runs are off on average, how often
/// the end lies in the 50, 80 and 90 % regions, and how often an event with a given probability happened.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  realgap evaluate sweeps/cube_toss_fit.ron \\
      --parameters sweeps/cube_toss_best.ron
  realgap evaluate sweeps/cube_toss_fit.ron --every 2 --offset 1 --rows
  realgap evaluate sweeps/cube_toss_fit.ron --odds --plot reliability.png")]
pub struct Evaluate {
    /// The study, e.g. sweeps/cube_toss_fit.ron
    study: PathBuf,
    #[command(flatten)]
    values: Values,
    #[command(flatten)]
    recordings: Recordings,
    /// Start state in place of the study's own
    #[arg(long, value_parser = choice(STARTS))]
    start: Option<StartState>,
    /// Add one row per recording
    #[arg(long)]
    rows: bool,
    #[command(flatten)]
    odds: OddsOption,
    #[command(flatten)]
    jobs: Jobs,
    #[command(flatten)]
    telling: Telling,
}

/// An evaluation, with the odds where `--odds` was given.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Evaluated {
    #[serde(flatten)]
    result: Evaluation,
    #[serde(skip_serializing_if = "Option::is_none")]
    odds: Option<Odds>,
}

impl Evaluate {
    pub fn run(self) -> Result<()> {
        self.telling.check()?;
        let mut overrides = Overrides {
            start_state: self.start,
            ..self.values.over(self.recordings.overrides()?)?
        };
        let definition = read_definition(&self.study, &overrides)?;
        let is_of_joints = definition.is_of_joints();
        let has_orientations =
            |r: &Recording| r.trajectory.orientations_world_from_body().is_some();
        if !is_of_joints
            && let Some(without) = definition.recordings.iter().find(|r| !has_orientations(r))
        {
            let study = self.study.display();
            return Err(Error::invalid(
                "errors of poses need orientations, which these recordings lack",
            )
            .at_file(&without.path)
            .hint(format!(
                "for recordings without orientations use: realgap gap {study}, realgap ensemble {study}"
            )));
        }
        // The report gives pose errors, or joint errors where only joints were recorded, whatever metric the study optimises.
        overrides.metric = Some(if is_of_joints { &Joints } else { &Pose });
        let study = read_study(&self.study, &overrides)?;
        // The study already holds all values.
        let values = ParameterSet::new();
        let (total, run) = (study.cases().len(), self.jobs.run());
        if is_of_joints {
            let mut result = progress::during(total, "evaluating", run, |run| {
                study.evaluate_joints(&values, run)
            })?;
            if definition.horizon.is_some() {
                self.add_whole_runs(&mut result, overrides)?;
            }
            return self.report_joints(result);
        }
        let mut result =
            progress::during(total, "evaluating", run, |run| study.evaluate(&values, run))?;
        terminal::print_warnings(&result.warnings);
        let mut odds = self.odds.odds(&study, &self.study, self.jobs.run())?;
        if !self.rows {
            result.rows.clear();
            if let Some(odds) = &mut odds {
                odds.rows.clear();
            }
        }
        let result = result.with_claims(odds.as_ref());
        let shown = |colour| {
            let odds = odds.as_ref().map(|odds| format!("\n{odds}"));
            words(&result, colour) + &odds.unwrap_or_default()
        };
        let (text, printed) = (shown(false), shown(terminal::stdout_wants_colour()));
        let found = Evaluated { result, odds };
        self.telling
            .write("evaluation", &self.study, &found, &text, self.odds.plot())?;
        self.telling.print.answer(&found, || printed)
    }

    /// Adds the error over whole runs to the error over windows.
    fn add_whole_runs(&self, result: &mut JointEvaluation, overrides: Overrides) -> Result<()> {
        let overrides = Overrides {
            whole_runs: true,
            ..overrides
        };
        let study = read_study(&self.study, &overrides)?;
        let (total, values) = (study.cases().len(), ParameterSet::new());
        let whole = progress::during(total, "whole runs", self.jobs.run(), |run| {
            study.evaluate_joints(&values, run)
        })?;
        result.whole_mrad = Some(whole.angle_mrad);
        Ok(())
    }

    fn report_joints(&self, mut result: JointEvaluation) -> Result<()> {
        terminal::print_warnings(&result.warnings);
        if !self.rows {
            result.rows.clear();
        }
        let text = words_of_joints(&result, false);
        self.telling
            .write("evaluation", &self.study, &result, &text, [])?;
        self.telling.print.answer(&result, || {
            words_of_joints(&result, terminal::stdout_wants_colour())
        })
    }
}

/// For people.
fn words_of_joints(result: &JointEvaluation, colour: bool) -> String {
    let mut table = TextTable::new([("recording", Side::Left), ("joints, mrad", Side::Right)]);
    for row in &result.rows {
        let value = row.angle_mrad;
        let value = value.map_or("diverged".to_owned(), |v| format!("{v:.1}"));
        table.push([row.recording.clone(), value]);
    }
    let rows = match result.rows.is_empty() {
        true => String::new(),
        false => format!("\n{}", table.render(colour).trim_end()),
    };
    let of = |joints: &Average| {
        format!(
            "{:.1} +- {:.1} mrad (median {:.1})",
            joints.mean, joints.standard_error, joints.median
        )
    };
    let whole = (result.whole_mrad.as_ref())
        .map(|whole| format!("\n  over whole recordings instead: joints {}", of(whole)));
    let channels = match result.channels.is_empty() {
        true => String::new(),
        false => format!("\n{}", channel_table(result).render(colour).trim_end()),
    };
    let joints = result.joints_mrad.iter();
    let joints: Vec<String> = joints
        .map(|(name, mrad)| format!("{name} {mrad:.1}"))
        .collect();
    format!(
        "{}{}: joints {}, {:.1} at the end (median); {:.2} CPU ms per simulated second{}\n  {}{channels}{rows}",
        verdict_lines(&result.claims),
        counted(result.recordings, "recording"),
        of(&result.angle_mrad),
        result.end_mrad_median,
        result.cpu_ms_per_s,
        whole.unwrap_or_default(),
        joints.join(", ")
    )
}

/// The residuals of scored channels.
fn channel_table(result: &JointEvaluation) -> TextTable {
    let mut table = TextTable::new([
        ("channel", Side::Left),
        ("unit", Side::Left),
        ("mean error", Side::Right),
        ("rms", Side::Right),
        ("bias", Side::Right),
        ("noise", Side::Right),
        ("in noise", Side::Right),
        ("samples", Side::Right),
        ("independent", Side::Right),
    ]);
    for channel in &result.channels {
        let stated = if channel.noise_is_stated {
            " (stated)"
        } else {
            ""
        };
        table.push([
            channel.column.clone(),
            channel.unit.clone(),
            number(channel.mean),
            number(channel.rms),
            number(channel.bias),
            format!("{}{stated}", number(channel.noise)),
            format!("{:.1}", channel.in_noise),
            channel.samples.to_string(),
            format!("{:.0}", channel.independent),
        ]);
    }
    table
}

/// For people.
fn words(result: &Evaluation, colour: bool) -> String {
    let mut table = TextTable::new([
        ("error", Side::Left),
        ("mean", Side::Right),
        ("median", Side::Right),
        ("standard error", Side::Right),
    ]);
    let rows = [
        ("position, % of body length", Some(&result.position_percent)),
        ("rotation, deg", Some(&result.rotation_deg)),
        ("joints, deg", result.hinge_deg.as_ref()),
        ("final position, %", Some(&result.final_position_percent)),
        ("final rotation, deg", Some(&result.final_rotation_deg)),
        ("final joints, deg", result.final_hinge_deg.as_ref()),
    ];
    for (name, spread) in rows.into_iter().filter_map(|(name, s)| Some((name, s?))) {
        let Average {
            mean,
            median,
            standard_error,
        } = spread;
        table.push([
            name.to_owned(),
            format!("{mean:.2}"),
            format!("{median:.2}"),
            format!("{standard_error:.2}"),
        ]);
    }
    let mut faces = TextTable::new([
        ("face down", Side::Left),
        ("real", Side::Right),
        ("simulated", Side::Right),
        ("same recording", Side::Right),
    ]);
    for odds in &result.resting_faces {
        faces.push([
            odds.face.to_owned(),
            odds.real.to_string(),
            odds.simulated.to_string(),
            odds.both.to_string(),
        ]);
    }
    let found = format!(
        "{}{}, start: {}\n{}\n{} of {} end over 45 deg off; {:.2} CPU ms per simulated second\n{}",
        verdict_lines(&result.claims),
        counted(result.recordings, "recording"),
        result.start,
        table.render(colour).trim_end(),
        result.over_45_deg,
        result.recordings,
        result.cpu_ms_per_s,
        faces.render(colour).trim_end()
    );
    if result.rows.is_empty() {
        return found;
    }
    let mut rows = TextTable::new([
        ("recording", Side::Left),
        ("position %", Side::Right),
        ("rotation deg", Side::Right),
        ("final %", Side::Right),
        ("final deg", Side::Right),
    ]);
    let text = |value: Option<f64>| value.map_or("diverged".to_owned(), |v| format!("{v:.2}"));
    for row in &result.rows {
        rows.push([
            row.recording.clone(),
            text(row.position_percent),
            text(row.rotation_deg),
            text(row.final_position_percent),
            text(row.final_rotation_deg),
        ]);
    }
    format!("{found}\n{}", rows.render(colour).trim_end())
}
