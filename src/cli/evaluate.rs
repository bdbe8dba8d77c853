//! `realgap evaluate`: how well one setting predicts recordings.

use realgap::calibration::{
    Average, Definition, Evaluation, HorizonError, JointEvaluation, Overrides,
};
use realgap::claim::verdict_lines;
use realgap::comparison::{Joints, Metric, Pose};
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
        let study = self.study.display();
        let others = format!("realgap gap {study}, realgap ensemble {study}");
        overrides.metric = Some(metric_of(&definition, &others)?);
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
        let print = self.telling.print;
        print.answer_above(&found.result.warnings, &found, || printed)
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
        if !self.rows {
            result.rows.clear();
        }
        let text = words_of_joints(&result, false);
        self.telling
            .write("evaluation", &self.study, &result, &text, [])?;
        let print = self.telling.print;
        print.answer_above(&result.warnings, &result, || {
            words_of_joints(&result, terminal::stdout_wants_colour())
        })
    }
}

/// The metric of which an evaluation reports the errors, whatever metric the study optimises: poses, or joints where only these
/// were recorded. `others` are the commands for recordings without orientations.
///
/// # Errors
/// Recordings without orientations.
pub fn metric_of(definition: &Definition, others: &str) -> Result<&'static dyn Metric> {
    if definition.is_of_joints() {
        let mut recordings = definition.recordings.iter();
        return match recordings.find(|r| r.trajectory.joints().is_empty()) {
            None => Ok(&Joints),
            Some(without) => Err(Error::invalid(
                "errors of joints need joints, and this recording has channels alone",
            )
            .at_file(&without.path)
            .allowed("columns NAME_rad")
            .hint("`realgap gap` compares channels")),
        };
    }
    let has_orientations = |r: &Recording| r.trajectory.orientations_world_from_body().is_some();
    let mut recordings = definition.recordings.iter();
    match recordings.find(|r| !has_orientations(r)) {
        None => Ok(&Pose),
        Some(without) => Err(Error::invalid(
            "errors of poses need orientations, which these recordings lack",
        )
        .at_file(&without.path)
        .hint(format!("for recordings without orientations use: {others}"))),
    }
}

/// For people.
pub fn words_of_joints(result: &JointEvaluation, colour: bool) -> String {
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

/// How errors grow over the windows of each recording.
fn horizon_table(all: &[HorizonError], colour: bool) -> String {
    let thirds = all[0]
        .thirds()
        .map(|(time_s, _)| format!("after {} s", number(time_s)));
    let [first, second, last] = &thirds;
    let mut table = TextTable::new([
        ("median position error, mm", Side::Left),
        ("windows", Side::Right),
        (first, Side::Right),
        (second, Side::Right),
        (last, Side::Right),
    ]);
    for one in all {
        let [first, second, last] = one.thirds().map(|(_, m)| format!("{:.0}", 1e3 * m));
        let windows = one.windows.to_string();
        table.push([one.recording.clone(), windows, first, second, last]);
    }
    let whole = all.last().map(HorizonError::sentence).unwrap_or_default();
    format!("{}\n{whole}\n", table.render(colour).trim_end())
}

/// For people.
pub fn words(result: &Evaluation, colour: bool) -> String {
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
    let horizon = match result.over_horizon.is_empty() {
        true => String::new(),
        false => horizon_table(&result.over_horizon, colour),
    };
    let found = format!(
        "{}{}, start: {}\n{}\n{horizon}{} of {} end over 45 deg off; {:.2} CPU ms per simulated second\n{}",
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

#[cfg(test)]
mod tests {
    use super::*;
    use realgap::calibration::StartUsed;
    use realgap::claim::verdict;
    use realgap::report::{ReportTree, SingleReport};
    use realgap::trajectory::Source;

    /// A number from 0 to 1 (SplitMix64).
    fn share(state: &mut u64) -> f64 {
        *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = *state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// An evaluation whose numbers are drawn at random.
    fn drawn(seed: u64) -> Evaluation {
        let mut state = seed;
        let mut average = || Average {
            mean: 100.0 * share(&mut state),
            median: 100.0 * share(&mut state),
            standard_error: share(&mut state),
        };
        let (position_percent, rotation_deg) = (average(), average());
        let (final_position_percent, final_rotation_deg) = (average(), average());
        let recordings = 1 + (60.0 * share(&mut state)) as usize;
        let seen = share(&mut state);
        let found = Evaluation {
            recordings,
            position_percent,
            rotation_deg,
            hinge_deg: None,
            final_position_percent,
            final_rotation_deg,
            final_hinge_deg: None,
            over_45_deg: (share(&mut state) * recordings as f64) as usize,
            over_horizon: Vec::new(),
            resting_faces: Vec::new(),
            cpu_ms_per_s: 1.0,
            start: StartUsed::Settled,
            parameters: [("floor.friction".to_owned(), share(&mut state))].into(),
            provenance: Default::default(),
            claims: Vec::new(),
            warnings: Vec::new(),
            rows: Vec::new(),
            source: Source::Real,
            seen_by_fit: match seen {
                seen if seen < 0.3 => None,
                seen if seen < 0.6 => Some(0),
                _ => Some(recordings),
            },
        };
        found.with_claims(None)
    }

    #[test]
    fn terminal_page_and_json_of_an_evaluation_begin_with_one_verdict() {
        for seed in 0..120 {
            let found = drawn(seed);
            let text = words(&found, false);
            let report = ReportTree::of(&found).unwrap();
            let page = SingleReport {
                kind: "evaluation",
                name: "drawn",
                text: &text,
                report: &report,
                pictures: &[],
                command: "realgap evaluate drawn.ron",
            };
            let page = page.page().unwrap();
            let json = serde_json::to_value(&found).unwrap();
            let parts = verdict(&found.claims);
            let names: Vec<&str> = parts.iter().map(|(name, _)| *name).collect();
            assert_eq!(names, ["gap", "parameters", "trust"]);
            for (index, (name, claim)) in parts.into_iter().enumerate() {
                let line = format!("{name}: {claim}");
                assert_eq!(text.lines().nth(index), Some(line.as_str()), "seed {seed}");
                assert_eq!(json["claims"][index]["text"], claim.text.as_str());
                let escaped = claim.text.replace('&', "&amp;").replace('<', "&lt;");
                let times = page.matches(&escaped).count();
                assert_eq!(
                    times, 1,
                    "seed {seed}: the page says {times} times: {escaped}"
                );
            }
            // The numbers of the first claim are those of the table below it.
            let gap = &found.claims[0];
            let shown = number(found.position_percent.mean);
            assert!(gap.text.contains(&shown), "{shown}: {gap}");
            let mean = format!("{:.2}", found.position_percent.mean);
            assert!(
                text.contains(&mean) && page.contains(&mean),
                "{mean}: {text}"
            );
        }
    }
}
