//! Steps and height fields in MJCF, and what of the ground it cannot express.

use super::mjcf::{rubbing, turning_of_floor};
use super::robot::{Robot, quaternion};
use super::xml::{Element, numbers, vector};
use crate::scene::SceneMotion;
use realgap_core::warning::{Code, Warning};

/// Name of the height field, and how far it reaches below its lowest point, metres.
const NAME: &str = "heights";
const BELOW_M: f64 = 0.1;

/// The height field as an asset; MuJoCo keeps heights as shares of their range, the first row at the largest y.
pub(super) fn heights_asset(robot: &Robot<'_>) -> Option<Element> {
    let field = robot.ground.heights.as_ref()?;
    let (low_m, high_m) = field.range_m();
    let range_m = (high_m - low_m).max(f64::MIN_POSITIVE);
    let points = (0..field.rows()).flat_map(|row| (0..field.columns()).map(move |c| (row, c)));
    let shares = points.map(|(row, column)| (field.at(row, column) - low_m) / range_m);
    let size = [
        0.5 * field.size_m[0],
        0.5 * field.size_m[1],
        // MuJoCo refuses a field without height.
        (robot.heights.0 * (high_m - low_m)).max(1e-9),
        BELOW_M,
    ];
    Some(
        Element::new("hfield")
            .with("name", NAME)
            .with("nrow", field.rows().to_string())
            .with("ncol", field.columns().to_string())
            .with("size", numbers(size))
            .with("elevation", numbers(shares)),
    )
}

/// The geoms of steps and of the height field, each with the friction that robots have on it.
pub(super) fn geoms(robot: &Robot<'_>) -> Vec<Element> {
    let turning = turning_of_floor(robot);
    let mut all = Vec::new();
    for step in &robot.steps {
        let SceneMotion::Fixed { world_from_body } = &step.motion else {
            continue;
        };
        for (number, part) in step.boxes.iter().enumerate() {
            let pose = world_from_body * part.body_from_box;
            let name = match number {
                0 => format!("step.{}", step.name),
                _ => format!("step.{}.{number}", step.name),
            };
            let geom = Element::new("geom")
                .with("name", name)
                .with("type", "box")
                .with("size", vector(&(0.5 * part.sides_m)))
                .with("pos", vector(&pose.translation.vector))
                .with("quat", numbers(quaternion(&pose.rotation)))
                .with("priority", "1");
            all.push(rubbing(geom, step.friction, &turning));
        }
    }
    if let Some(field) = &robot.ground.heights {
        let (scale, world_from_heights) = robot.heights;
        let lowest = nalgebra::Point3::new(0.0, 0.0, scale * field.range_m().0);
        let geom = Element::new("geom")
            .with("name", NAME)
            .with("type", "hfield")
            .with("hfield", NAME)
            .with("pos", vector(&(world_from_heights * lowest).coords))
            .with("quat", numbers(quaternion(&world_from_heights.rotation)))
            .with("priority", "1");
        all.push(rubbing(geom, robot.floor.friction, &turning));
    }
    all
}

/// What of the ground the file does not say.
pub(super) fn not_carried(robot: &Robot<'_>) -> Vec<Warning> {
    let mut warnings = Vec::new();
    let regions = robot.ground.regions.iter();
    let names: Vec<&str> = regions.map(|region| region.name.as_str()).collect();
    if !names.is_empty() {
        warnings.push(Code::FloorNotExported.warning(format!(
            "the friction of regions of the floor ({}): it is that of the floor everywhere",
            names.join(", ")
        )));
    }
    let lowest_m = robot.ground.heights.as_ref().map(|field| field.range_m().0);
    if lowest_m.is_some_and(|low_m| robot.heights.0 * low_m < 0.0) {
        warnings.push(Code::FloorNotExported.warning(
            "hollows of the height field below the flat floor: MuJoCo's floor goes on above them",
        ));
    }
    warnings
}
