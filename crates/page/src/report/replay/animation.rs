//! A replay as an animated PNG: for slides, papers and pages without scripts.

use nalgebra::{Isometry3, Vector3};

use crate::plot::{Animation, Look, Moment, Trace, draw_animation};
use crate::report::replay::page::Replay;
use crate::report::replay::solid::{Kind, Solid};
use crate::report::replay::stage::{Actor, Mover, Stage};
use realgap_core::error::Result;
use realgap_robot::morphology::{Morphology, Surface};

/// The largest number of samples of one run.
const MOST_SAMPLES: usize = 20_000;
/// Pictures a second, and the largest number of pictures: longer runs have fewer a second.
const PICTURES_1_S: f64 = 10.0;
const MOST_PICTURES: f64 = 240.0;

impl Replay<'_> {
    /// The replay as an animated PNG file: ten pictures a second in real time, at most 240. Recorded robots are outlines, recorded
    /// paths points with a line to the run.
    ///
    /// # Errors
    /// Paths too long to be compared.
    pub fn animation(&self) -> Result<Vec<u8>> {
        let stage = self.stage(MOST_SAMPLES)?;
        let duration_s = stage.duration_s();
        let step_s = (1.0 / PICTURES_1_S).max(duration_s / (MOST_PICTURES - 1.0));
        // A last step that is much shorter than the others gets no picture.
        let steps = (duration_s / step_s + 1e-6).floor() as usize;
        let models: Vec<Vec<Model<'_>>> = stage.actors.iter().map(models).collect();
        let moments = (0..=steps).map(|step| moment(&stage, &models, step as f64 * step_s));
        let (floor, fixed) = (&stage.fixed[0], &stage.fixed[1..]);
        let top = |[x, y]: [f64; 2]| {
            let half = floor.shape.half_extents_m();
            let corner = Vector3::new(x * half.x, y * half.y, half.z);
            <[f64; 3]>::from((floor.pose * nalgebra::Point3::from(corner)).coords)
        };
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(top);
        let rise = -self.floor.slope_rad.tan();
        draw_animation(&Animation {
            title: self
                .robot
                .map_or(self.run_name, Morphology::name)
                .to_owned(),
            labels: [self.run_name, self.reality()].map(str::to_owned),
            floor_m: corners,
            floor_rise: [self.floor.height_m, rise],
            traces: stage.actors.iter().map(trace).collect(),
            fixed: (fixed.iter()).filter_map(placed).collect(),
            moments: moments.collect(),
            shown_s: step_s,
        })
    }
}

fn trace(actor: &Actor) -> Trace {
    Trace {
        is_recorded: actor.is_recorded,
        times_s: actor.times_s.clone(),
        places_m: actor.places_m.iter().map(|p| (*p).into()).collect(),
    }
}

/// What moves, and its surfaces in its own frame.
struct Model<'a> {
    mover: &'a Mover,
    surfaces: Vec<(Surface, Look)>,
}

fn models(actor: &Actor) -> Vec<Model<'_>> {
    let model = |mover| Model {
        mover,
        surfaces: (mover.solids.iter())
            .filter_map(|solid| Some((placed(solid)?, look(solid.kind))))
            .collect(),
    };
    actor.movers.iter().map(model).collect()
}

/// A surface in the frame of the body that carries it.
fn placed(solid: &Solid) -> Option<Surface> {
    Some(solid.shape.surface()?.placed(&solid.pose))
}

/// The poses of all bodies at a time; after the end of a run its last poses.
fn moment(stage: &Stage, models: &[Vec<Model<'_>>], time_s: f64) -> Moment {
    let mut moment = Moment {
        time_s,
        ..Moment::default()
    };
    for (actor, models) in stage.actors.iter().zip(models) {
        let after = actor.times_s.partition_point(|t| *t <= time_s + 1e-9);
        let before = after.saturating_sub(1);
        let share = match actor.times_s.get(after) {
            Some(to) => (time_s - actor.times_s[before]) / (to - actor.times_s[before]),
            None => 0.0,
        };
        for model in models {
            let pose = pose(model.mover, before, share.clamp(0.0, 1.0));
            for (surface, look) in &model.surfaces {
                let surface = surface.placed(&pose);
                if actor.is_recorded {
                    moment.outlines.push(surface);
                } else {
                    moment.solids.push((surface, *look));
                }
            }
        }
    }
    moment
}

fn pose(mover: &Mover, before: usize, share: f64) -> Isometry3<f64> {
    let from = mover.poses[before];
    match mover.poses.get(before + 1) {
        Some(to) if share > 0.0 => from.try_lerp_slerp(to, share, 1e-12).unwrap_or(*to),
        _ => from,
    }
}

fn look(kind: Kind) -> Look {
    match kind {
        Kind::Passive => Look::Passive,
        Kind::Active => Look::Active,
        Kind::Plate => Look::Plate,
        Kind::Floor | Kind::Other | Kind::Run | Kind::Recorded => Look::Other,
    }
}
