//! Who says what another engine would do: MuJoCo where it answers, the table of other robots where it does not, and the answer
//! names it. A script of the shell stands for a Python with MuJoCo.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]
#![allow(clippy::print_stdout, reason = "a table is printed")]

use std::path::Path;
use std::time::Duration;

use crate::common::{project, python_with};

use realgap_core::statistics::mean;
use realgap_lab::prediction::ensemble::{self, Ensemble, Forecast};
use realgap_lab::prediction::{
    Judged, ModelError, ModelOptions, Mujoco, OpinionSource, OtherEngine, OwnEngines, Teller,
    ThirdOpinion,
};
use realgap_optimization::RunOptions;
use realgap_robot::morphology::Morphology;
use realgap_simulation::parameter::{Assignment, ParameterSet};
use realgap_simulation::{Experiment, Noise, Start};

/// Own engines that know of no error: what is left is the spread of MuJoCo's runs.
const CERTAIN: OwnEngines = OwnEngines {
    own_m: 0.0,
    second_m: Some(0.0),
    relaxed_m: Some(0.0),
    spread_m: 0.0,
    sensitivity_m: 0.0,
    body_length_m: 0.058,
};
const HELLO: &str = r#"{"realgap":1,"name":"MuJoCo","version":"0.0.1"}"#;

/// A script that says who it is, and answers each further `$line` with the number `$id` by this command.
fn answering(command: &str) -> String {
    format!(
        "read -r line; echo '{HELLO}'
while read -r line; do id=${{line#*\\\"id\\\":}}; id=${{id%%,*}}; {command}; done"
    )
}

/// A command in place of Python.
fn python(folder: &Path, text: &str) -> String {
    use std::os::unix::fs::PermissionsExt as _;
    let path = folder.join("python");
    std::fs::write(&path, format!("#!/bin/sh\n{text}\n")).unwrap();
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
    path.display().to_string()
}

/// The robot of two modules for one second, with eight repeats.
struct Walk {
    experiment: Experiment,
    repeats: Ensemble,
    forecast: Forecast,
}

impl Walk {
    fn new() -> Self {
        let robot = Morphology::read(project().join("morphologies/two_module.ron")).unwrap();
        let mut experiment = Experiment::new(robot.assemble());
        experiment.duration_s = 1.0;
        let floor = Assignment::new("floor.friction", 0.4).unwrap();
        let experiment = ParameterSet::new().with(floor).apply(&experiment);
        let noise = Noise::unmeasured_robot();
        let repeats = ensemble::run(&experiment, &noise, 3, 8, &RunOptions::default()).unwrap();
        let forecast = Forecast::new(&repeats).unwrap();
        Self {
            experiment,
            repeats,
            forecast,
        }
    }

    fn judged(&self, third_opinion: ThirdOpinion, jobs: usize) -> realgap_core::Result<ModelError> {
        let options = ModelOptions {
            third_opinion,
            ..ModelOptions::default()
        };
        let run = RunOptions {
            jobs,
            ..RunOptions::default()
        };
        let judged = ModelError::new(
            &self.experiment,
            &self.repeats,
            &self.forecast,
            &options,
            &run,
        )?;
        Ok(judged.unwrap())
    }

    /// The judgement with this script in place of Python.
    fn by_script(&self, text: &str) -> ModelError {
        let folder = tempfile::tempdir().unwrap();
        let mut mujoco = Mujoco::new(python(folder.path(), text));
        mujoco.limit = Duration::from_secs(2);
        self.judged(ThirdOpinion::Mujoco(mujoco), 2).unwrap()
    }
}

fn source(judged: &ModelError) -> &OpinionSource {
    judged.third_opinion.as_ref().unwrap()
}

#[test]
fn what_mujoco_says_is_the_range_of_another_engine_and_is_named() {
    let walk = Walk::new();
    let judged = walk.by_script(&answering(
        r#"echo "{\"id\":$id,\"net_displacement_m\":0.2$id}""#,
    ));
    let said = source(&judged);
    assert_eq!(said.by, Teller::Mujoco);
    assert_eq!(said.mujoco_version.as_deref(), Some("0.0.1"));
    let expected_m: Vec<f64> = (0..8).map(|id| 0.2 + 0.01 * f64::from(id)).collect();
    let off_m = said
        .runs_m
        .iter()
        .zip(&expected_m)
        .map(|(a, b)| (a - b).abs());
    assert!(said.runs_m.len() == 8 && off_m.fold(0.0, f64::max) < 1e-12);
    let range = judged.further_run_m.unwrap();
    // Without the clamp at 0 the range is symmetric, and it is wider than that of these runs alone.
    let middle_m = mean(&expected_m);
    let (below_m, above_m) = (middle_m - range.low, range.high - middle_m);
    assert!(
        range.low == 0.0 || (below_m - above_m).abs() < 1e-3,
        "{range:?}"
    );
    let alone = OtherEngine::asked(&CERTAIN, &said.runs_m).central(0.9);
    assert!(
        alone.low < 0.2 && alone.high > 0.27,
        "eight runs do not show the ends: {alone:?}"
    );
    assert!(
        range.low < alone.low && range.high > alone.high,
        "{range:?} {alone:?}"
    );
    let text = judged.to_string();
    assert!(
        text.contains("(asked MuJoCo 0.0.1: 8 runs of 20.0 cm to 27.0 cm)"),
        "{text}"
    );
    // One run that MuJoCo cannot complete is left out.
    let judged = walk.by_script(&answering(
        r#"case $id in 3) echo "{\"id\":3,\"failed\":\"diverged\"}";; *) echo "{\"id\":$id,\"net_displacement_m\":0.2$id}";; esac"#,
    ));
    assert_eq!(source(&judged).runs_m.len(), 7);
}

#[test]
fn where_mujoco_does_not_answer_the_table_does_and_the_answer_says_why() {
    let walk = Walk::new();
    let table = walk.judged(ThirdOpinion::Table, 2).unwrap();
    assert!(
        table
            .to_string()
            .contains("(learned from 391 other robots in MuJoCo)")
    );
    let missing =
        "echo 'Traceback' >&2; echo \"ModuleNotFoundError: No module named 'mujoco'\" >&2; exit 1";
    let named = [
        (missing.to_owned(), "has no package mujoco"),
        (
            "echo 'no licence' >&2; exit 3".to_owned(),
            "ended (exit status: 3): no licence",
        ),
        ("sleep 30".to_owned(), "no answer within 2 s"),
        ("echo '{ bad'; sleep 30".to_owned(), "answered no JSON"),
        (answering("sleep 30"), "did not run this within 2 s"),
        (answering("echo out of memory >&2; exit 1"), "out of memory"),
        (
            answering(r#"echo "{\"id\":$id,\"failed\":\"XML Error\"}""#),
            "XML Error",
        ),
        (
            answering(r#"echo "{\"id\":$id,\"net_displacement_m\":-1}""#),
            "answered no displacement",
        ),
        (
            answering(r#"echo "{\"id\":$id,\"net_displacement_m\":NaN}""#),
            "answered NaN",
        ),
    ];
    for (script, why) in named {
        let judged = walk.by_script(&script);
        let said = source(&judged);
        assert_eq!((said.by, said.runs_m.len()), (Teller::Table, 0));
        let not_asked = said.not_asked.clone().unwrap();
        assert!(not_asked.contains(why), "{why}: {not_asked}");
        assert!(
            !not_asked.contains("class Robot"),
            "the script stands in: {not_asked}"
        );
        assert!(judged.to_string().contains(&not_asked));
        assert_eq!(judged.further_run_m, table.further_run_m);
    }
    let nowhere = ThirdOpinion::Mujoco(Mujoco::new("/nowhere/python3"));
    let judged = walk.judged(nowhere, 2).unwrap();
    let why = source(&judged).not_asked.as_deref().unwrap();
    assert!(
        why.starts_with("MuJoCo was not asked: `/nowhere/python3` cannot be started: "),
        "{why}"
    );
    // Who demands MuJoCo gets no table.
    let nowhere = ThirdOpinion::OnlyMujoco(Mujoco::new("/nowhere/python3"));
    let refused = walk.judged(nowhere, 2).unwrap_err().to_string();
    assert!(refused.contains("/nowhere/python3") && refused.contains("pip install mujoco"));
}

#[test]
fn mujoco_is_not_asked_about_a_run_that_it_cannot_be_told() {
    let mut walk = Walk::new();
    walk.experiment.hinge_adjustments = vec![Default::default(); 1];
    walk.experiment.hinge_adjustments[0].backlash_rad = 0.02;
    let judged = walk.by_script("exit 1");
    let why = source(&judged).not_asked.as_deref().unwrap();
    assert!(
        why.contains("cannot be told this run") && why.contains("backlash"),
        "{why}"
    );
    assert!(matches!(walk.experiment.start, Start::Settled));
}

/// Needs a Python with `mujoco` (`REALGAP_PYTHON`, else `python3`).
#[test]
fn mujoco_itself_runs_the_draws_of_the_first_repeats_with_the_same_bits_on_any_number_of_threads() {
    let Some(python) = python_with("mujoco") else {
        return;
    };
    let walk = Walk::new();
    let asked = |jobs| {
        let mujoco = ThirdOpinion::OnlyMujoco(Mujoco::new(&python));
        walk.judged(mujoco, jobs).unwrap()
    };
    let judged = asked(2);
    assert_eq!(
        judged,
        asked(1),
        "the result depends on the number of threads"
    );
    let said = source(&judged);
    assert_eq!((said.by, said.runs_m.len()), (Teller::Mujoco, 8));
    // The engines agree about this robot within a third, and every draw is a run of its own.
    let own_m = walk.forecast.displacement_m.as_ref().unwrap().mean;
    assert!(
        (mean(&said.runs_m) / own_m - 1.0).abs() < 0.33,
        "{own_m} m here, {said:?}"
    );
    assert!(
        said.runs_m.windows(2).all(|pair| pair[0] != pair[1]),
        "{said:?}"
    );
}

/// How a way to predict another engine does against one engine: ranges that held its runs, and the score of success.
#[derive(Default)]
struct Tally {
    runs: usize,
    held: [usize; 2],
    score: f64,
    /// Distance between the runs and the middle of the prediction, metres, summed.
    off_m: f64,
}

/// The weight of what MuJoCo cannot know about other engines was chosen on this many robots, which are not judged.
const CHOSEN: usize = 12;

/// The robots of `engines_asked.csv` (tools/engine_opinions.py), judged by what MuJoCo's runs say, by these runs alone, and by the
/// table, which was learned from none of them.
#[test]
fn asked_and_learned_ranges_hold_fresh_robots_as_documented() {
    let read = |name: &str| {
        let path = project().join(format!("crates/lab/tests/golden/{name}.csv"));
        std::fs::read_to_string(path).unwrap()
    };
    let (judged, asked) = (read("engines_judged"), read("engines_asked"));
    let columns: Vec<&str> = asked.lines().next().unwrap().split(',').skip(2).collect();
    let mut engines = vec!["mujoco_m"];
    engines.extend(columns);
    let mut tallies: Vec<[Tally; 3]> = engines.iter().map(|_| Default::default()).collect();
    let mut widths: [Vec<f64>; 3] = Default::default();
    let rows: Vec<&str> = asked.lines().skip(1 + CHOSEN).collect();
    for row in &rows {
        let cells: Vec<&str> = row.split(',').collect();
        let line = judged
            .lines()
            .find(|line| line.split(',').next() == Some(cells[0]));
        let robot = Judged::table(line.unwrap()).next().unwrap();
        let numbers = |cell: &str| -> Vec<f64> {
            cell.split_whitespace()
                .map(|m| m.parse().unwrap())
                .collect()
        };
        let ways = [
            OtherEngine::asked(&robot.known, &numbers(cells[1])),
            OtherEngine::asked(&CERTAIN, &numbers(cells[1])),
            OtherEngine::new(&robot.known),
        ];
        let mut truths = vec![robot.theirs_m.clone()];
        truths.extend(cells[2..].iter().map(|cell| numbers(cell)));
        let least_m = 0.5 * robot.known.own_m;
        for (way, other) in ways.iter().enumerate() {
            let middle_m = other.central(0.0).low;
            let ranges = [0.9, 0.5].map(|level| other.central(level));
            widths[way].push((ranges[0].high - ranges[0].low) / robot.known.own_m);
            for (truth, tally) in truths.iter().zip(&mut tallies) {
                let tally = &mut tally[way];
                for m in truth {
                    tally.runs += 1;
                    tally.off_m += (m - middle_m).abs();
                    for (held, range) in tally.held.iter_mut().zip(&ranges) {
                        *held += usize::from(range.contains(*m));
                    }
                    let happened = f64::from(u8::from(*m >= least_m));
                    tally.score += (other.reaches(least_m) - happened).powi(2);
                }
            }
        }
    }
    let mut held = Vec::new();
    for (way, name) in ["asked", "its runs alone", "learned"]
        .into_iter()
        .enumerate()
    {
        let width = realgap_core::statistics::median(&widths[way]);
        println!(
            "{name}: {} robots, median width of 90 % {width:.2} of the displacement",
            rows.len()
        );
        for (engine, tally) in engines.iter().zip(&tallies) {
            let Tally {
                runs,
                held: [most, half],
                score,
                off_m,
            } = tally[way];
            println!(
                "  {engine:<12} {runs} runs: 90 % ranges hold {most}, 50 % {half}; off by {:.1} cm in the mean, Brier score of success {:.3}",
                100.0 * off_m / runs as f64,
                score / runs as f64
            );
            held.push([most, half, runs]);
        }
    }
    assert_eq!(held, DOCUMENTED, "as docs/validation/ensembles.md says");
}

/// Runs that the ranges of 90 and of 50 % hold, of so many: asked, by its runs alone, learned, each in the order of the engines.
const DOCUMENTED: [[usize; 3]; 15] = [
    [136, 132, 136],
    [119, 75, 136],
    [89, 47, 136],
    [93, 56, 136],
    [122, 70, 136],
    [127, 82, 136],
    [46, 23, 136],
    [27, 12, 136],
    [33, 15, 136],
    [45, 27, 136],
    [127, 72, 136],
    [93, 32, 136],
    [63, 21, 136],
    [71, 29, 136],
    [94, 36, 136],
];
