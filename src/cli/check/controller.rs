//! The contents of a controller's file, checked alone or for a robot.

use realgap::file::Source;
use realgap::results::draw_arena;
use realgap::sensing::arena::Arena;
use realgap::simulation::{Condition, Controller, Mounted, Reads};
use realgap::text::shown;

use super::super::kit::*;
use super::{Contents, Kind, SHOWN, report};

/// The controller, checked for the robot where one is named.
fn read(source: &Source, robot: Option<&Path>) -> Result<(Controller, Option<Experiment>)> {
    let Some(robot) = robot else {
        return Ok((Controller::parse(source)?, None));
    };
    let experiment = Experiment::new(read_morphology(robot)?.assemble());
    let controller = Controller::read(source.path(), &experiment)?;
    Ok((controller, Some(experiment)))
}

pub(super) fn describe(source: &Source, robot: Option<&Path>) -> Result<Contents> {
    let (controller, experiment) = read(source, robot)?;
    let others = controller.others.iter().map(|other| other.name.clone());
    let robots: Vec<String> = std::iter::once(controller.name.clone())
        .chain(others)
        .collect();
    let mut lines = vec![format!(
        "  controller in the arena \"{}\": {} decisions a second of {}",
        shown(&controller.arena.name, SHOWN),
        controller.rate_hz,
        counted(robots.len(), "robot"),
    )];
    lines.extend(controller.sensors.iter().map(sensor));
    for (index, rule) in controller.rules.iter().enumerate() {
        let servos: Vec<&str> = rule.then.iter().map(|(name, _)| name.as_str()).collect();
        lines.push(format!(
            "  rule {:<9} {}, for {} s: {}",
            index + 1,
            condition(&rule.when, &controller, &robots),
            rule.for_s,
            shown(&servos.join(", "), SHOWN),
        ));
    }
    if let Some(radio) = &controller.radio {
        lines.push(format!(
            "  radio          every {} s, down to {} dBm",
            radio.every_s, radio.model.sensitivity_dbm
        ));
    }
    lines.push(match robot {
        Some(robot) => format!("  fits           {}", robot.display()),
        None => "  not checked for a robot: --robot ROBOT.ron checks that, too".into(),
    });
    Ok(Contents {
        kind: Kind::Controller,
        lines,
        details: report::Contents::Controller {
            arena: controller.arena.name.clone(),
            rate_hz: controller.rate_hz,
            sensors: controller.sensors.iter().map(|s| s.name.clone()).collect(),
            rules: controller.rules.len(),
            robots,
            fits: experiment.is_some(),
        },
        warnings: Vec::new(),
    })
}

fn sensor(mounted: &Mounted) -> String {
    let reads = match &mounted.reads {
        Reads::Range(model) => {
            let (low, high) = model.range;
            let unit = model.distance_unit.symbol();
            format!("{low} to {high} {unit}")
        }
        Reads::Scan { segment, .. } => format!("segment {segment} of a scanner"),
    };
    format!(
        "  sensor         \"{}\" on \"{}\": {reads}",
        shown(&mounted.name, SHOWN),
        shown(&mounted.on, SHOWN)
    )
}

fn condition(when: &Condition, controller: &Controller, robots: &[String]) -> String {
    let name = |sensor: &usize| shown(&controller.sensors[*sensor].name, SHOWN);
    match when {
        Condition::Below { sensor, distance_m } => format!("{} < {distance_m} m", name(sensor)),
        Condition::Above { sensor, distance_m } => format!("{} > {distance_m} m", name(sensor)),
        Condition::Silent { sensor } => format!("{} is silent", name(sensor)),
        Condition::Heard { from, within_m } => {
            let from = from.map_or("any".to_owned(), |from| shown(&robots[from], SHOWN));
            format!("{from} was heard within {within_m} m")
        }
        Condition::Always => "always".to_owned(),
    }
}

/// Draws its arena; with a robot also the outlines of all robots at their starts, seen from above.
pub(super) fn draw(source: &Source, robot: Option<&Path>, plot: &Path) -> Result<()> {
    let (controller, experiment) = read(source, robot)?;
    let mut arena = Arena::clone(&controller.arena);
    if let Some(experiment) = experiment {
        arena.objects.extend(controller.plans(&experiment).concat());
    }
    draw_arena(&arena, plot)
}
