//! Studies of several robots: whether the answer holds for a robot that the fit has not seen, and which robots do what was
//! recorded.

use serde::Deserialize;

use crate::report::document::value::*;
use realgap_lab::calibration::{Likeness, OwnParameters, Reproduction};

/// What a page shows of the leave-one-robot-out test: how well the answer of the other robots fits each robot.
#[derive(Debug, Deserialize)]
pub(in crate::report) struct Transfer {
    untuned_misfit: Option<f64>,
    held_out_misfit: Option<f64>,
    own_misfit: Option<f64>,
    closed: Option<f64>,
    own_parameters: OwnParameters,
    robots: Vec<Robot>,
}

/// What a page shows of one robot of that test.
#[derive(Debug, Deserialize)]
struct Robot {
    robot: String,
    untuned: Option<f64>,
    shared: Option<f64>,
    held_out: Option<f64>,
    own: Option<f64>,
    closed: Option<f64>,
}

/// The misfit of each robot of a study of several, and how well the answer of the other robots fits it.
pub(in crate::report) fn transfer(transfer: &Transfer, unit: &str) -> String {
    let rows = transfer.robots.iter().map(|robot| {
        vec![
            robot.robot.clone(),
            measured(robot.untuned, unit),
            measured(robot.shared, unit),
            measured(robot.held_out, unit),
            measured(robot.own, unit),
            percent(robot.closed),
        ]
    });
    let mean = vec![
        "mean".to_owned(),
        measured(transfer.untuned_misfit, unit),
        String::new(),
        measured(transfer.held_out_misfit, unit),
        measured(transfer.own_misfit, unit),
        percent(transfer.closed),
    ];
    let own_parameters = match transfer.own_parameters {
        OwnParameters::Refitted => {
            "With the others' values of what all share, a robot's own parameters are fitted to it again."
        }
        OwnParameters::AsTheyCame => {
            "A robot's own parameters are NOT fitted to it again: no two points differ in them alone."
        }
        OwnParameters::None => "",
    };
    noted(
        "robot | untuned | shared answer | answer of the others | its own best | gap closed by the others",
        rows.chain([mean]),
        &format!(
            "The answer of the others was fitted without the robot. The robot's own best is the lowest score of many points, which is partly luck. {own_parameters}"
        ),
    )
}

/// How many robots of a study of several do what was recorded with the shared answer: by the kind of agreement, by metric, and
/// robot by robot.
pub(in crate::report) fn reproduction(found: &Reproduction) -> String {
    let kinds = KINDS.iter().map(|(kind, name, definition)| {
        let of_kind = match kind {
            Likeness::WithinFloor => &found.within_floor,
            Likeness::Alike => &found.alike,
            Likeness::GoesNowhere => &found.goes_nowhere,
            Likeness::OtherPath => &found.other_path,
        };
        let (name, definition) = ((*name).to_owned(), (*definition).to_owned());
        vec![name, counted_of(of_kind), odds(*of_kind), definition]
    });
    let metrics = found.metrics.iter().map(|of| {
        vec![
            of.metric.clone(),
            counted_of(&of.within_floor),
            odds(of.within_floor),
            measured(of.median_noise_floors, ""),
        ]
    });
    let robots = found.robots.iter().map(|robot| {
        let kind = KINDS.iter().find(|(kind, ..)| *kind == robot.likeness);
        let spread = |mean_m, sd_m| format!("{} ± {}", measured(mean_m, "m"), measured(sd_m, "m"));
        vec![
            robot.robot.clone(),
            kind.map_or("", |(_, name, _)| *name).to_owned(),
            measured(robot.distance_m, "m"),
            measured(robot.floor_m, "m"),
            measured(robot.alike_m, "m"),
            spread(robot.recorded_m, robot.recorded_sd_m),
            spread(robot.simulated_m, robot.simulated_sd_m),
        ]
    });
    let note = format!(
        "Every robot has {} runs at the shared answer, which has seen it: one with each equally valid setting. Distances are means of `rms` over all pairs; intervals are Wilson's, 95 %, over robots.",
        found.runs
    );
    let held = found.displacement_held.map_or_else(String::new, |held| {
        format!(
            "The mean recorded net displacement lies among those of the runs for {} robots, {}; at least {} would if recordings were further runs.",
            counted_of(&held),
            odds(held),
            percent(found.displacement_promise)
        )
    });
    [
        noted("at the shared answer | robots | share | that is", kinds, &note),
        titled(
            "metric | within the noise floor | share | median, in noise floors",
            metrics,
        ),
        noted(
            "robot | at the shared answer | runs to recordings | noise floor | alike below | recorded displacement | simulated",
            robots,
            &held,
        ),
    ]
    .concat()
}

/// Kinds of agreement with the recordings: name and definition.
const KINDS: [(Likeness, &str, &str); 4] = [
    (
        Likeness::WithinFloor,
        "within the noise floor",
        "as near to its recordings as these are to one another",
    ),
    (
        Likeness::Alike,
        "alike",
        "nearer than half a body length, or than a quarter of the recorded way where that is more",
    ),
    (
        Likeness::GoesNowhere,
        "goes nowhere",
        "its median run ends within half a body length, or a tenth of its path, of where it began",
    ),
    (Likeness::OtherPath, "another way", "all others"),
];
