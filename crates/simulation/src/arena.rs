//! Conversion of an arena into obstacles: its walls, boxes and circles become one fixed body of the scene.

use nalgebra::{Isometry3, Matrix3, Translation3, UnitQuaternion, Vector3};

use super::experiment::{Experiment, Start};
use super::scene::{SceneBody, SceneBox, SceneMotion};
use realgap_core::error::{Error, Result};
use realgap_sensing::arena::{Arena, Shape};

/// An arena is a two-dimensional plan. Its objects get this height above the floor, and reach this depth below it, metres.
const HEIGHT_M: f64 = 0.5;
const DEPTH_M: f64 = 0.1;
/// Coulomb friction coefficient between robot and walls: the default of bodies of a scene.
const FRICTION: f64 = 0.5;
/// Number of rotated boxes whose union represents a circle: a polygon with twice as many corners, all on the circle.
const BOXES_OF_A_CIRCLE: usize = 8;
/// Largest allowed penetration of a fixed body at the start, metres: recorded starts may touch walls, and contacts push the robot
/// out.
const TOUCH_M: f64 = 0.005;

impl SceneBody {
    /// Name of the body that represents an arena.
    pub const ARENA: &'static str = "arena";

    /// The objects of an arena as one fixed body, 0.5 m high.
    ///
    /// If `at_start` is true, the body is placed so that a robot which starts at the world's origin, facing +x, is at the arena's
    /// start pose; otherwise the world has the arena's coordinates.
    ///
    /// # Errors
    /// An arena without objects; an arena without a start pose if `at_start` is true.
    pub fn of_arena(arena: &Arena, at_start: bool) -> Result<Self> {
        let world_from_arena = match (at_start, arena.start) {
            (false, _) => Isometry3::identity(),
            (true, Some([x, y, heading])) => Isometry3::from_parts(
                Translation3::new(x, y, 0.0),
                UnitQuaternion::from_axis_angle(&Vector3::z_axis(), heading),
            )
            .inverse(),
            (true, None) => {
                return Err(Error::invalid("the arena does not say where robots start")
                    .field("start")
                    .hint("add e.g. start: (x_m: 1.0, y_m: 1.0)"));
            }
        };
        let upright = |[x, y]: [f64; 2], turn_rad: f64, [hx, hy]: [f64; 2]| SceneBox {
            sides_m: Vector3::new(2.0 * hx, 2.0 * hy, HEIGHT_M + DEPTH_M),
            body_from_box: Isometry3::from_parts(
                Translation3::new(x, y, 0.5 * (HEIGHT_M - DEPTH_M)),
                UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn_rad),
            ),
        };
        let mut boxes = Vec::new();
        for object in &arena.objects {
            match object.shape {
                Shape::Box {
                    half_m,
                    turn: [cos, sin],
                } => {
                    boxes.push(upright(object.centre_m, libm::atan2(sin, cos), half_m));
                }
                Shape::Circle { radius_m } => {
                    let corner = std::f64::consts::FRAC_PI_2 / BOXES_OF_A_CIRCLE as f64;
                    let half_m = [radius_m * libm::cos(corner), radius_m * libm::sin(corner)];
                    boxes.extend(
                        (0..BOXES_OF_A_CIRCLE)
                            .map(|k| upright(object.centre_m, 2.0 * corner * k as f64, half_m)),
                    );
                }
            }
        }
        let body = Self {
            name: Self::ARENA.to_owned(),
            boxes,
            friction: FRICTION,
            motion: SceneMotion::Fixed {
                world_from_body: world_from_arena,
            },
        };
        body.check()?;
        Ok(body)
    }

    /// Checks that no box of the robot starts in a fixed body, with joints at zero.
    ///
    /// # Errors
    /// A box of the robot starts in the body.
    pub(super) fn check_clear(&self, experiment: &Experiment) -> Result<()> {
        self.check_clear_of("a wall", experiment)
    }

    /// As [`SceneBody::check_clear`]; the error calls the body `what`.
    pub(super) fn check_clear_of(&self, what: &str, experiment: &Experiment) -> Result<()> {
        let SceneMotion::Fixed { world_from_body } = self.motion else {
            return Ok(());
        };
        let world_from_robot = world_from_robot(experiment);
        for solid in experiment.assembly.parts.iter().flat_map(|p| &p.solids) {
            if !solid.collides {
                continue;
            }
            let module = (
                world_from_robot * solid.robot_from_solid,
                solid.half_extents_m(),
            );
            for part in &self.boxes {
                let part_pose = world_from_body * part.body_from_box;
                let depth_m = overlap_m(&module, &(part_pose, 0.5 * part.sides_m));
                if depth_m > TOUCH_M {
                    let at = module.0.translation.vector;
                    return Err(Error::invalid(format!("the robot starts in {what}"))
                        .field(format!("scene.{}", self.name))
                        .found(format!(
                            "a module at ({:.3}, {:.3}, {:.3}) m, {depth_m:.3} m deep",
                            at.x, at.y, at.z
                        ))
                        .allowed(format!("at most {TOUCH_M} m"))
                        .hint(format!("move the start or {}", what.replace("a ", "the "))));
                }
            }
        }
        Ok(())
    }
}

/// Pose of the robot's frame at the start, with joints at zero.
pub(super) fn world_from_robot(experiment: &Experiment) -> Isometry3<f64> {
    let assembly = &experiment.assembly;
    match (&experiment.start, assembly.world_from_mount) {
        (_, Some(world_from_mount)) => world_from_mount,
        (Start::Settled, None) => {
            let reach = |pose: &Isometry3<f64>, half_m: &Vector3<f64>| {
                let turn = pose.rotation.to_rotation_matrix();
                pose.translation.vector.z - turn.matrix().row(2).abs().dot(&half_m.transpose())
            };
            let lowest_m = assembly
                .parts
                .iter()
                .flat_map(|part| &part.solids)
                .map(|solid| reach(&solid.robot_from_solid, &solid.half_extents_m()))
                .fold(f64::INFINITY, f64::min);
            Isometry3::translation(0.0, 0.0, experiment.floor.height_m - lowest_m)
        }
        (Start::State(recorded), None) => {
            let state = recorded.scaled(1.0 / experiment.recording_length_scale);
            let world_from_track = Isometry3::from_parts(
                state.position_world_m.into(),
                state.orientation_world_from_body,
            );
            world_from_track * assembly.robot_from_track.inverse()
        }
    }
}

/// How deep two boxes (pose, half of the sides) are in each other, metres; negative or 0 if they do not overlap.
///
/// Separating-axis test: two boxes do not overlap if one of fifteen axes separates them, the three axes of each box and the nine
/// cross products of their edges.
fn overlap_m(
    (a_pose, a_half): &(Isometry3<f64>, Vector3<f64>),
    (b_pose, b_half): &(Isometry3<f64>, Vector3<f64>),
) -> f64 {
    let axes =
        |pose: &Isometry3<f64>| -> Matrix3<f64> { *pose.rotation.to_rotation_matrix().matrix() };
    let (a, b) = (axes(a_pose), axes(b_pose));
    let offset_m = b_pose.translation.vector - a_pose.translation.vector;
    let along = |axis: Vector3<f64>| -> f64 {
        let radius = |m: &Matrix3<f64>, half: &Vector3<f64>| (m.transpose() * axis).abs().dot(half);
        radius(&a, a_half) + radius(&b, b_half) - offset_m.dot(&axis).abs()
    };
    let faces = (0..3).flat_map(|k| [a.column(k).into_owned(), b.column(k).into_owned()]);
    let edges = (0..9).filter_map(|k| a.column(k / 3).cross(&b.column(k % 3)).try_normalize(1e-6));
    faces.chain(edges).map(along).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit_box(x: f64, turn_rad: f64) -> (Isometry3<f64>, Vector3<f64>) {
        let pose = Isometry3::from_parts(
            Translation3::new(x, 0.0, 0.0),
            UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn_rad),
        );
        (pose, Vector3::repeat(0.5))
    }

    #[test]
    fn the_overlap_of_boxes_has_the_expected_depth() {
        let still = unit_box(0.0, 0.0);
        assert!((overlap_m(&still, &unit_box(0.9, 0.0)) - 0.1).abs() < 1e-12);
        assert!((overlap_m(&still, &unit_box(1.2, 0.0)) + 0.2).abs() < 1e-12);
        // A corner of a box that is turned by 45 degrees reaches 0.707 m.
        let turned = unit_box(1.25, std::f64::consts::FRAC_PI_4);
        assert!((overlap_m(&still, &turned) + 0.043).abs() < 1e-3);
        let turned = unit_box(1.15, std::f64::consts::FRAC_PI_4);
        assert!((overlap_m(&still, &turned) - 0.057).abs() < 1e-3);
    }
}
