//! The ground of an experiment: where regions, steps and a height field of an arena lie, and which of them is below a point.

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

use super::experiment::{Experiment, Floor};
use super::kinematics::lowest_m;
use super::scene::{SceneBody, SceneBox, SceneMotion};
use realgap_core::error::{Error, Result};
use realgap_core::file::Source;
use realgap_core::warning::{Code, Warning};
use realgap_robot::morphology::Assembly;
use realgap_sensing::arena::{Arena, Ground, HeightField, Step};

/// How far steps reach below the floor, metres, so that no gap is left between them.
const DEPTH_M: f64 = 0.1;
/// Thickness of what marks a region in pictures, its width, and the thickness of a piece of a height field, metres.
const MARK_M: [f64; 2] = [0.001, 0.006];
const CRUST_M: f64 = 0.004;
/// The largest number of pieces along each side with which a height field is drawn.
const MOST_PIECES: usize = 16;

impl Floor {
    /// The floor's own frame in the world: z along its normal, the origin where the world's z axis meets it. Regions, steps and
    /// height fields lie in this frame, so that they rise and tilt with the floor.
    pub fn world_from_floor(&self) -> Isometry3<f64> {
        Isometry3::from_parts(
            Translation3::new(0.0, 0.0, self.height_m),
            UnitQuaternion::from_axis_angle(&Vector3::y_axis(), self.slope_rad),
        )
    }
}

/// What an arena puts around a robot: its walls, boxes and circles as one body, if it has any, and its ground.
///
/// If `at_start` is true, everything is placed so that a robot which starts at the world's origin, facing +x, is at the arena's
/// start pose; otherwise the world has the arena's coordinates.
///
/// # Errors
/// Text that is not an arena; an arena without anything around the robot; one without a start pose if `at_start` is true.
pub fn read_arena(source: &Source, at_start: bool) -> Result<(Vec<SceneBody>, Ground)> {
    let arena = Arena::parse(source)?;
    // An arena that has a ground needs no walls.
    let walls = match arena.objects.is_empty() && !arena.ground.is_plain() {
        true => Ok(Vec::new()),
        false => SceneBody::of_arena(&arena, at_start).map(|body| vec![body]),
    };
    let both = walls.and_then(|walls| Ok((walls, ground_of(&arena, at_start)?)));
    both.map_err(|e| source.at("start", e))
}

/// The ground of an arena, in the floor's frame.
///
/// # Errors
/// An arena without a start pose if `at_start` is true.
pub(super) fn ground_of(arena: &Arena, at_start: bool) -> Result<Ground> {
    let mut ground = arena.ground.clone();
    if !at_start || ground.is_plain() {
        return Ok(ground);
    }
    let Some([x, y, heading]) = arena.start else {
        return Err(Error::invalid("the arena does not say where robots start")
            .field("start")
            .hint("add e.g. start: (x_m: 1.0, y_m: 1.0)"));
    };
    let (sin, cos) = heading.sin_cos();
    let seen = |[px, py]: [f64; 2]| {
        let (dx, dy) = (px - x, py - y);
        [cos * dx + sin * dy, cos * dy - sin * dx]
    };
    for region in &mut ground.regions {
        for corner in &mut region.corners_m {
            *corner = seen(*corner);
        }
    }
    for step in &mut ground.steps {
        step.centre_m = seen(step.centre_m);
        step.turn_deg -= heading.to_degrees();
    }
    if let Some(field) = &mut ground.heights {
        *field = field.moved(seen([0.0; 2]), -heading).into();
    }
    Ok(ground)
}

/// Looks up what lies at a point of the floor or of a height field.
#[derive(Debug, Clone)]
pub(crate) struct GroundMap {
    floor_from_world: Isometry3<f64>,
    ground: Ground,
}

impl GroundMap {
    /// The map of an experiment; `None` where the floor is the same everywhere.
    pub fn of(experiment: &Experiment) -> Option<Self> {
        let ground = &experiment.ground;
        let is_same = ground.regions.is_empty() && ground.heights.is_none();
        (!is_same).then(|| Self {
            floor_from_world: experiment.floor.world_from_floor().inverse(),
            ground: ground.clone(),
        })
    }

    fn place_m(&self, point_world_m: &Vector3<f64>) -> [f64; 2] {
        let place = self.floor_from_world * nalgebra::Point3::from(*point_world_m);
        [place.x, place.y]
    }

    /// The region that a point of the surface belongs to.
    pub fn region_at(&self, point_world_m: &Vector3<f64>) -> Option<usize> {
        self.ground.region_at(self.place_m(point_world_m))
    }

    /// Whether a height field takes the place of the flat floor at a point.
    pub fn is_hole(&self, point_world_m: &Vector3<f64>) -> bool {
        let place_m = self.place_m(point_world_m);
        (self.ground.heights.as_ref()).is_some_and(|field| field.covers(place_m))
    }
}

impl Experiment {
    /// Puts the robot at the start pose of an arena, among its walls and on its ground.
    ///
    /// # Errors
    /// As [`read_arena`].
    pub fn enter_arena(&mut self, source: &Source) -> Result<()> {
        let (walls, ground) = read_arena(source, true)?;
        self.scene.extend(walls);
        self.ground = ground;
        Ok(())
    }

    /// The steps of the ground as fixed bodies, at the floor's present height and slope.
    pub(crate) fn steps(&self) -> Vec<SceneBody> {
        self.steps_down_to(DEPTH_M)
    }

    /// The same, reaching so far below the floor.
    fn steps_down_to(&self, depth_m: f64) -> Vec<SceneBody> {
        let world_from_floor = self.floor.world_from_floor();
        let body = |step: &Step| SceneBody {
            name: step.name.clone(),
            boxes: vec![SceneBox {
                sides_m: Vector3::new(
                    2.0 * step.half_m[0],
                    2.0 * step.half_m[1],
                    step.height_m + depth_m,
                ),
                body_from_box: Isometry3::translation(0.0, 0.0, 0.5 * (step.height_m - depth_m)),
            }],
            friction: step.friction,
            motion: SceneMotion::Fixed {
                world_from_body: world_from_floor * flat(step.centre_m, step.turn_deg.to_radians()),
            },
        };
        self.ground.steps.iter().map(body).collect()
    }

    /// Pose of the middle of the height field in the world: x along its rows, z up.
    pub(crate) fn world_from_heights(&self, field: &HeightField) -> Isometry3<f64> {
        self.floor.world_from_floor() * flat(field.centre_m, field.turn_rad)
    }

    /// Everything of the scene that pictures show: the bodies beside the robot, and the ground as fixed bodies.
    pub fn shown_scene(&self) -> Vec<SceneBody> {
        let mut shown = self.scene.clone();
        // What is below the floor is not seen.
        shown.extend(self.steps_down_to(0.0));
        let world_from_floor = self.floor.world_from_floor();
        for region in &self.ground.regions {
            let [thick_m, wide_m] = MARK_M;
            let boxes = region.edges().map(|[a, b]| {
                let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
                let middle = [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
                let height_m = self.height_above_floor_m(middle) + 0.5 * thick_m;
                SceneBox {
                    sides_m: Vector3::new(dx.hypot(dy).max(wide_m), wide_m, thick_m),
                    body_from_box: Translation3::new(0.0, 0.0, height_m)
                        * flat(middle, libm::atan2(dy, dx)),
                }
            });
            shown.push(drawn(&region.name, boxes.collect(), world_from_floor));
        }
        if let Some(field) = &self.ground.heights {
            let world_from_field = self.world_from_heights(field);
            shown.push(drawn(
                "heights",
                pieces(field, self.heights_scale),
                world_from_field,
            ));
        }
        shown
    }

    /// Height of the ground above the flat floor at a place of the floor's frame, without steps, metres.
    fn height_above_floor_m(&self, place_m: [f64; 2]) -> f64 {
        let field = self.ground.heights.as_ref();
        let height_m = field.and_then(|field| field.height_m(place_m));
        height_m.map_or(0.0, |height_m| self.heights_scale * height_m)
    }

    /// How far a robot that would just touch the flat floor at a place has to be lifted along the floor's normal so that it is not
    /// inside of a height field, metres; below 0 in a hollow.
    pub(crate) fn lift_m(
        &self,
        assembly: &Assembly,
        robot_from_parts: &[Isometry3<f64>],
        place_m: [f64; 2],
    ) -> f64 {
        let Some(field) = &self.ground.heights else {
            return 0.0;
        };
        let sides = [Vector3::x(), -Vector3::x(), Vector3::y(), -Vector3::y()];
        let reach = |side: &Vector3<f64>| -lowest_m(assembly, robot_from_parts, side);
        let reach_m = sides.iter().map(reach).fold(0.0, f64::max);
        let Some(highest_m) = field.highest_m(place_m, reach_m) else {
            return 0.0;
        };
        let highest_m = self.heights_scale * highest_m;
        let corners = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]]
            .map(|[x, y]| [place_m[0] + x * reach_m, place_m[1] + y * reach_m]);
        // Beside the field is the flat floor.
        match corners.iter().all(|corner| field.covers(*corner)) {
            true => highest_m,
            false => highest_m.max(0.0),
        }
    }

    /// Checks the ground, and that what is simulated touches it.
    ///
    /// # Errors
    /// As [`Ground::check`]; a robot that starts in a step; a two-wheel robot, which moves without contacts.
    pub(super) fn check_ground(&self) -> Result<()> {
        let of_vehicle = self.vehicle.as_ref().map(|vehicle| &vehicle.arena.ground);
        if self.vehicle.is_some()
            && !(self.ground.is_plain() && of_vehicle.is_none_or(Ground::is_plain))
        {
            return Err(Error::invalid(
                "a two-wheel robot moves without contacts, on a flat floor",
            )
            .field("ground")
            .found("an arena with `regions`, `steps` or a `ground`")
            .allowed("an arena without them, or a morphology in place of the vehicle"));
        }
        self.ground.check()?;
        for step in self.steps() {
            step.check()?;
            step.check_clear_of("a step", self)?;
        }
        Ok(())
    }

    /// Warnings about regions that no contact touched, by region, so that nothing of them has an effect on the run.
    pub(crate) fn untouched(&self, touched: &[bool]) -> Vec<Warning> {
        let regions = self.ground.regions.iter().zip(touched);
        let bare = regions.filter(|(_, is_touched)| !**is_touched);
        bare.map(|(region, _)| region_untouched(&region.name))
            .collect()
    }
}

/// The warning about a region of this name that no contact of a run touched.
pub fn region_untouched(name: &str) -> Warning {
    Code::RegionUntouched.warning(format!(
        "nothing ever touched the region `{name}` of the floor: floor.{name}.friction changes nothing"
    ))
}

/// A pose on the floor, in its frame.
fn flat([x, y]: [f64; 2], turn_rad: f64) -> Isometry3<f64> {
    Isometry3::from_parts(
        Translation3::new(x, y, 0.0),
        UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn_rad),
    )
}

/// A fixed body that is only drawn.
fn drawn(name: &str, boxes: Vec<SceneBox>, world_from_body: Isometry3<f64>) -> SceneBody {
    SceneBody {
        name: name.to_owned(),
        boxes,
        friction: 0.0,
        motion: SceneMotion::Fixed { world_from_body },
    }
}

/// A height field as thin plates, each along the surface at its middle.
fn pieces(field: &HeightField, scale: f64) -> Vec<SceneBox> {
    let counts = [field.columns(), field.rows()].map(|count| (count - 1).min(MOST_PIECES));
    let sides_m = [0, 1].map(|axis| field.size_m[axis] / counts[axis] as f64);
    let mut own = field.clone();
    (own.centre_m, own.turn_rad) = ([0.0; 2], 0.0);
    let height_m = |x: f64, y: f64| {
        let edge = [0, 1].map(|axis| 0.5 * own.size_m[axis]);
        let place = [x.clamp(-edge[0], edge[0]), y.clamp(-edge[1], edge[1])];
        scale * own.height_m(place).unwrap_or(0.0)
    };
    let mut boxes = Vec::with_capacity(counts[0] * counts[1]);
    for column in 0..counts[0] {
        for row in 0..counts[1] {
            let x = -0.5 * own.size_m[0] + (column as f64 + 0.5) * sides_m[0];
            let y = -0.5 * own.size_m[1] + (row as f64 + 0.5) * sides_m[1];
            let [dx, dy] = sides_m.map(|side| 0.5 * side);
            let rise = [
                (height_m(x + dx, y) - height_m(x - dx, y)) / sides_m[0],
                (height_m(x, y + dy) - height_m(x, y - dy)) / sides_m[1],
            ];
            let middle_m = 0.25
                * (height_m(x + dx, y)
                    + height_m(x - dx, y)
                    + height_m(x, y + dy)
                    + height_m(x, y - dy));
            let normal = Vector3::new(-rise[0], -rise[1], 1.0).normalize();
            let turn = UnitQuaternion::rotation_between(&Vector3::z(), &normal)
                .unwrap_or_else(UnitQuaternion::identity);
            let middle = Vector3::new(x, y, middle_m) - normal * (0.5 * CRUST_M);
            boxes.push(SceneBox {
                sides_m: Vector3::new(
                    sides_m[0] * (1.0 + rise[0] * rise[0]).sqrt(),
                    sides_m[1] * (1.0 + rise[1] * rise[1]).sqrt(),
                    CRUST_M,
                ),
                body_from_box: Isometry3::from_parts(middle.into(), turn),
            });
        }
    }
    boxes
}
