//! The robots of a study of many: what holds for one that was not seen, and which of them do what was recorded.

use serde_json::Value;

use super::value::*;

/// Of a study of many robots: the misfit of each, and what the others' answer does for it.
pub(super) fn transfer(report: &Value) -> String {
    let unit = report.text("unit");
    let transfer = report.at("transfer");
    let row = |of: &Value, name: String, keys: [&str; 4]| {
        let mut row = vec![name];
        row.extend(keys.map(|key| match key {
            "" => String::new(),
            key => of.measured(key, unit),
        }));
        row.push(of.percent("closed"));
        row
    };
    let keys = ["untuned", "shared", "held_out", "own"];
    let all = ["untuned_misfit", "", "held_out_misfit", "own_misfit"];
    let robots = transfer.list("robots").iter();
    let rows = robots.map(|robot| row(robot, robot.owned("robot"), keys));
    let mean = transfer
        .is_object()
        .then(|| row(transfer, "mean".to_owned(), all));
    noted(
        "robot | untuned | shared answer | best of the others | its own best | closed by the others",
        rows.chain(mean),
        &format!(
            "The best of the others has not seen the robot. Its own best is the lowest of many points, and partly luck. {}",
            own_parameters(transfer)
        ),
    )
}

/// What became of robots' own parameters.
fn own_parameters(transfer: &Value) -> &'static str {
    match transfer.text("own_parameters") {
        "refitted" => {
            "With the others' values of what all share, a robot's own parameters are fitted to it again."
        }
        "as_they_came" => {
            "A robot's own parameters are NOT fitted to it again: no two points differ in them alone."
        }
        _ => "",
    }
}

/// Of a study of many robots: how many do at the shared answer what was recorded, by how they do it, by other metrics, and one by one.
pub(super) fn reproduction(report: &Value) -> String {
    let found = report.at("reproduction");
    if !found.is_object() {
        return String::new();
    }
    let kinds = KINDS.iter().map(|(key, name, definition)| {
        let (count, n) = (format!("{key}.count"), format!("{key}.trials"));
        let counted = format!("{} of {}", found.number(&count), found.number(&n));
        vec![
            (*name).to_owned(),
            counted,
            found.proportion(key),
            (*definition).to_owned(),
        ]
    });
    let metrics = found.list("metrics").iter().map(|of| {
        let (count, n) = (
            of.number("within_floor.count"),
            of.number("within_floor.trials"),
        );
        vec![
            of.owned("metric"),
            format!("{count} of {n}"),
            of.proportion("within_floor"),
            of.measured("median_noise_floors", ""),
        ]
    });
    let robots = found.list("robots").iter().map(|robot| {
        let likeness = robot.text("likeness");
        let kind = KINDS.iter().find(|(key, ..)| *key == likeness);
        let spread = |mean: &str, sd: &str| {
            format!(
                "{} ± {}",
                robot.measured(mean, "m"),
                robot.measured(sd, "m")
            )
        };
        vec![
            robot.owned("robot"),
            kind.map_or(likeness, |(_, name, _)| *name).to_owned(),
            robot.measured("distance_m", "m"),
            robot.measured("floor_m", "m"),
            robot.measured("alike_m", "m"),
            spread("recorded_m", "recorded_sd_m"),
            spread("simulated_m", "simulated_sd_m"),
        ]
    });
    let note = format!(
        "Every robot has {} runs at the shared answer, which has seen it: one with each equally valid setting. Distances are means of `rms` over all pairs; intervals are Wilson's, 95 %, over robots.",
        found.number("runs")
    );
    let held = match found.at("displacement_held") {
        Value::Null => String::new(),
        _ => format!(
            "The mean recorded net displacement lies among those of the runs for {} of {} robots, {}; at least {} would if recordings were further runs.",
            found.number("displacement_held.count"),
            found.number("displacement_held.trials"),
            found.proportion("displacement_held"),
            found.percent("displacement_promise")
        ),
    };
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

/// What robots do, by the names of the report, for people, and what it means.
const KINDS: [(&str, &str, &str); 4] = [
    (
        "within_floor",
        "within the noise floor",
        "as near to its recordings as these are to one another",
    ),
    (
        "alike",
        "alike",
        "nearer than half a body length, or than a quarter of the recorded way where that is more",
    ),
    (
        "goes_nowhere",
        "goes nowhere",
        "its median run ends within half a body length, or a tenth of its path, of where it began",
    ),
    ("other_path", "another way", "all others"),
];
