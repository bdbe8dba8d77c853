//! The contents of files of sensors and their surroundings.

use realgap::file::Source;
use realgap::sensing::arena::{Arena, Boundary, Ground};
use realgap::sensing::graph::Sensorgraph;
use realgap::sensing::radio::RadioModel;
use realgap::sensing::range::RangeModel;
use realgap::simulation::Vehicle;
use realgap::text::shown;
use realgap::unit::number;

use super::super::kit::*;
use super::{Contents, Kind, SHOWN, report};

pub(super) fn arena(source: &Source) -> Result<Contents> {
    let arena = Arena::parse(source)?;
    let [x, y] = arena.size_m;
    let edge = match arena.boundary {
        Boundary::Solid => "walls all round",
        Boundary::Open => "open on all sides",
    };
    let start = match arena.start {
        Some([x, y, heading]) => format!(
            "  robots start at ({x}, {y}) m, heading {:.1} deg",
            heading.to_degrees()
        ),
        None => "  no start for robots".to_owned(),
    };
    let anchors = match arena.anchors.len() {
        0 => String::new(),
        count => format!(", {}", counted(count, "radio anchor")),
    };
    Ok(Contents {
        kind: Kind::Arena,
        lines: vec![
            format!(
                "  arena \"{}\": {x} x {y} m, {edge}, {}",
                shown(&arena.name, SHOWN),
                counted(arena.objects.len(), "object")
            ) + &anchors,
            start,
        ]
        .into_iter()
        .chain(ground(&arena.ground))
        .collect(),
        details: report::Contents::Arena {
            size_m: arena.size_m,
            objects: arena.objects.len(),
            anchors: arena.anchors.iter().map(|a| a.name.clone()).collect(),
            start: arena.start,
            regions: arena
                .ground
                .regions
                .iter()
                .map(|r| r.name.clone())
                .collect(),
            steps: arena.ground.steps.iter().map(|s| s.name.clone()).collect(),
            height_field: arena
                .ground
                .heights
                .as_ref()
                .map(|field| field.file.clone()),
            name: arena.name,
        },
        warnings: Vec::new(),
    })
}

/// A line for each region, step and height field.
fn ground(ground: &Ground) -> Vec<String> {
    let regions = ground.regions.iter().map(|region| {
        format!(
            "  region `{}`: friction {} (floor.{0}.friction)",
            region.name, region.friction
        )
    });
    let steps = ground.steps.iter().map(|step| {
        format!(
            "  step `{}`: {} m high, friction {} (floor.{0}.height_m, floor.{0}.friction)",
            step.name, step.height_m, step.friction
        )
    });
    let field = ground.heights.iter().map(|field| {
        let (low_m, high_m) = field.range_m();
        format!(
            "  height field {}: {} x {} heights over {} x {} m, from {} to {} m",
            shown(&field.file, SHOWN),
            field.rows(),
            field.columns(),
            field.size_m[0],
            field.size_m[1],
            number(low_m),
            number(high_m)
        )
    });
    regions.chain(steps).chain(field).collect()
}

pub(super) fn sensor(source: &Source) -> Result<Contents> {
    let sensor = RangeModel::parse(source)?;
    let (low, high) = sensor.range;
    Ok(Contents {
        kind: Kind::Sensor,
        lines: vec![
            format!(
                "  range sensor: {low} to {high} {}, {}",
                sensor.distance_unit.symbol(),
                shown(&sensor.description, SHOWN)
            ),
            format!(
                "  mean {}, spread {}",
                sensor.mean.form.name(),
                sensor.spread.form.name()
            ),
        ],
        details: report::Contents::Sensor {
            range: sensor.range,
            distance_unit: sensor.distance_unit,
            mean: sensor.mean.form.name(),
            spread: sensor.spread.form.name(),
        },
        warnings: Vec::new(),
    })
}

pub(super) fn vehicle(path: &Path) -> Result<Contents> {
    let vehicle = Vehicle::read(path, None)?;
    Ok(Contents {
        kind: Kind::Vehicle,
        lines: vec![format!(
            "  vehicle \"{}\": radius {} m, in the arena \"{}\"",
            shown(&vehicle.name, SHOWN),
            vehicle.radius_m,
            shown(&vehicle.arena.name, SHOWN)
        )],
        details: report::Contents::Vehicle {
            radius_m: vehicle.radius_m,
            arena: vehicle.arena.name.clone(),
            name: vehicle.name,
        },
        warnings: Vec::new(),
    })
}

pub(super) fn radio(source: &Source) -> Result<Contents> {
    let model = RadioModel::parse(source)?;
    let parameters: Vec<String> = model
        .parameters()
        .iter()
        .zip(&model.values)
        .map(|(parameter, value)| {
            format!("{} {} {}", parameter.name, number(*value), parameter.unit)
        })
        .collect();
    Ok(Contents {
        kind: Kind::Radio,
        lines: vec![
            format!(
                "  radio model \"{}\": {}, {}",
                model.propagation.name(),
                model.propagation.formula(),
                shown(&model.description, SHOWN)
            ),
            format!("  {}", parameters.join(", ")),
        ],
        details: report::Contents::Radio {
            propagation: model.propagation.name(),
            values: model.values,
            log_base: model.log_base.name(),
        },
        warnings: Vec::new(),
    })
}

pub(super) fn sensorgraph(path: &Path) -> Result<Contents> {
    let graph = Sensorgraph::read(path)?;
    let terms: usize = graph.polynomials.iter().map(|p| p.terms.len()).sum();
    Ok(Contents {
        kind: Kind::Sensorgraph,
        lines: vec![format!(
            "  sensorgraph in the {} frame: {} of {} deg, {} with {}, {}",
            format!("{:?}", graph.frame).to_lowercase(),
            counted(graph.segments_deg.len(), "segment"),
            graph.width_deg,
            counted(graph.polynomials.len(), "polynomial"),
            counted(terms, "term"),
            counted(graph.log.len(), "logged pose")
        )],
        details: report::Contents::Sensorgraph {
            segments: graph.segments_deg.len(),
            polynomials: graph.polynomials.len(),
            terms,
            logged_poses: graph.log.len(),
        },
        warnings: Vec::new(),
    })
}
