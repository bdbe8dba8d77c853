//! What a replay shows, whatever the format: the moving bodies, their shapes, and their poses over time.

use nalgebra::{Isometry3, UnitQuaternion, Vector3};

use crate::report::replay::solid::{Kind, Solid, robot_solids};
use realgap_core::statistics::ends_of;
use realgap_robot::morphology::{Morphology, Shape};
use realgap_simulation::{Film, Floor, SceneBody, SceneMotion, part_name};

/// Half the height of the slab that stands for the floor, metres.
const FLOOR_HALF_M: f64 = 0.001;
/// How far the floor reaches beyond the paths, metres.
const FLOOR_MARGIN_M: f64 = 0.15;

/// Shapes that move as one.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::report) struct Mover {
    pub(in crate::report) name: String,
    pub(in crate::report) solids: Vec<Solid>,
    /// Poses in the world at the actor's times.
    pub(in crate::report) poses: Vec<Isometry3<f64>>,
}

/// One run, simulated or recorded.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::report) struct Actor {
    /// Differs from that of all others.
    pub(in crate::report) name: String,
    pub(in crate::report) is_recorded: bool,
    /// Seconds since its start.
    pub(in crate::report) times_s: Vec<f64>,
    /// The tracked point in the world.
    pub(in crate::report) places_m: Vec<Vector3<f64>>,
    /// Its orientation, where known.
    pub(in crate::report) turns: Option<Vec<UnitQuaternion<f64>>>,
    /// Its parts, and other bodies that move; none where only a path is known.
    pub(in crate::report) movers: Vec<Mover>,
}

/// All runs and bodies of a replay.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::report) struct Stage {
    /// The run, then recorded runs.
    pub(in crate::report) actors: Vec<Actor>,
    /// What stands still; the floor is the first.
    pub(in crate::report) fixed: Vec<Solid>,
    /// The largest interval of the samples that are shown: 3 means every third.
    pub(in crate::report) every: usize,
}

impl Actor {
    /// The kind of its path, which decides the colour.
    pub(in crate::report) fn kind(&self) -> Kind {
        match self.is_recorded {
            true => Kind::Recorded,
            false => Kind::Run,
        }
    }

    /// Its opacity: recorded robots are transparent.
    pub(in crate::report) fn alpha(&self) -> f64 {
        if self.is_recorded { 0.4 } else { 1.0 }
    }
}

impl Stage {
    /// The run and recorded ones by name, at most so many samples of each.
    pub(in crate::report) fn new<'a>(
        robot: Option<&Morphology>,
        films: impl Iterator<Item = (&'a str, &'a Film)>,
        floor: Floor,
        scene: &[SceneBody],
        most: usize,
    ) -> Self {
        let mut actors: Vec<Actor> = Vec::new();
        let mut largest = 1;
        for (name, film) in films {
            let every = film.track.len().div_ceil(most).max(1);
            largest = largest.max(every);
            let mut actor = actor(robot, film, scene, every);
            actor.is_recorded = !actors.is_empty();
            let all = actor.movers.iter_mut().flat_map(|mover| &mut mover.solids);
            for solid in all.filter(|_| !actors.is_empty()) {
                solid.kind = Kind::Recorded;
            }
            let is_taken = |name: &str| actors.iter().any(|other| other.name == name);
            let names = std::iter::once(name.to_owned());
            let mut names = names.chain((2..).map(|number| format!("{name} {number}")));
            actor.name = names.find(|name| !is_taken(name)).unwrap_or_default();
            actors.push(actor);
        }
        let mut fixed = vec![slab(&actors, floor)];
        for body in scene {
            if let SceneMotion::Fixed { world_from_body } = &body.motion {
                fixed.extend(solids(body, *world_from_body));
            }
        }
        Self {
            actors,
            fixed,
            every: largest,
        }
    }

    /// How long the longest run is, seconds.
    pub(in crate::report) fn duration_s(&self) -> f64 {
        let ends = self.actors.iter().filter_map(|actor| actor.times_s.last());
        ends.copied().fold(0.0, f64::max)
    }
}

fn actor(robot: Option<&Morphology>, film: &Film, scene: &[SceneBody], every: usize) -> Actor {
    let track = &film.track;
    let picks = picks(track.len(), every);
    let pick = |poses: &[Isometry3<f64>]| picks.iter().map(|k| poses[*k]).collect();
    let all = robot.map(robot_solids).unwrap_or_default();
    let mut movers = Vec::new();
    for (part, poses) in film.parts.iter().enumerate() {
        let Some(poses) = poses else { continue };
        let own = all.iter().filter(|one| one.part == part);
        movers.push(Mover {
            name: part_name(part),
            solids: own.map(|one| one.solid.clone()).collect(),
            poses: pick(poses),
        });
    }
    for (body, poses) in scene.iter().zip(&film.scene) {
        if matches!(body.motion, SceneMotion::Fixed { .. }) {
            continue;
        }
        movers.push(Mover {
            name: body.name.clone(),
            solids: solids(body, Isometry3::identity()).collect(),
            poses: pick(poses),
        });
    }
    let (times_s, places) = (track.times_s(), track.positions_world_m());
    Actor {
        name: String::new(),
        is_recorded: false,
        times_s: picks.iter().map(|k| times_s[*k] - times_s[0]).collect(),
        places_m: picks.iter().map(|k| places[*k]).collect(),
        turns: (track.orientations_world_from_body())
            .map(|turns| picks.iter().map(|k| turns[*k]).collect()),
        movers,
    }
}

/// The boxes of a body beside the robot, the body's pose before them.
fn solids(body: &SceneBody, from_body: Isometry3<f64>) -> impl Iterator<Item = Solid> + '_ {
    body.boxes.iter().map(move |one| Solid {
        shape: Shape::cuboid(0.5 * one.sides_m),
        pose: from_body * one.body_from_box,
        kind: Kind::Other,
    })
}

/// The positions of every `every`-th sample, and of the last one.
pub(in crate::report) fn picks(samples: usize, every: usize) -> Vec<usize> {
    let last = samples - 1;
    let mut picks: Vec<usize> = (0..=last).step_by(every).collect();
    if picks.last() != Some(&last) {
        picks.push(last);
    }
    picks
}

/// A piece of floor below all paths.
fn slab(actors: &[Actor], floor: Floor) -> Solid {
    let places = || actors.iter().flat_map(|actor| &actor.places_m);
    let range = |axis: usize| {
        let (low, high) = ends_of(places().map(|p| p[axis]));
        (0.5 * (low + high), 0.5 * (high - low) + FLOOR_MARGIN_M)
    };
    let ((x, half_x), (y, half_y)) = (range(0), range(1));
    let turn = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), floor.slope_rad);
    let up = turn * Vector3::z();
    // The point of the floor above or below the middle of the paths.
    let z = floor.height_m - floor.slope_rad.tan() * x;
    let middle = Vector3::new(x, y, z) - FLOOR_HALF_M * up;
    let half_x = half_x / floor.slope_rad.cos();
    Solid {
        shape: Shape::cuboid(Vector3::new(half_x, half_y, FLOOR_HALF_M)),
        pose: Isometry3::from_parts(middle.into(), turn),
        kind: Kind::Floor,
    }
}

/// Orientations, each with the sign that is nearer to the one before: both signs are the same turn.
pub(in crate::report) fn continuous(
    turns: impl Iterator<Item = UnitQuaternion<f64>>,
) -> impl Iterator<Item = UnitQuaternion<f64>> {
    let mut last: Option<UnitQuaternion<f64>> = None;
    turns.map(move |turn| {
        let is_far = last.is_some_and(|last| last.coords.dot(&turn.coords) < 0.0);
        let next = match is_far {
            true => UnitQuaternion::new_unchecked(-turn.into_inner()),
            false => turn,
        };
        last = Some(next);
        next
    })
}
