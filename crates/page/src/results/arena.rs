//! Pictures of arenas.

use std::path::Path;

use crate::plot::{AxisSpec, Caption, LinePlot, ScoreScale, Series, SeriesKind, draw_lines};
use realgap_core::error::Result;
use realgap_core::unit::Unit;
use realgap_sensing::arena::Arena;

/// An arena from above, its start as a dot.
///
/// # Errors
/// A path that is no picture's, a full disk.
pub fn draw_arena(arena: &Arena, path: impl AsRef<Path>) -> Result<()> {
    let [width, height] = arena.size_m;
    let closed = |mut points: Vec<[f64; 2]>| {
        points.extend(points.first().copied());
        points.into_iter().map(|[x, y]| (x, y)).collect::<Vec<_>>()
    };
    let corners = [[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]];
    let edge = closed(corners.to_vec());
    let mut all = vec![Series::new("the field", SeriesKind::Level, edge)];
    for (index, object) in arena.objects.iter().enumerate() {
        let label = if index == 0 { "walls and boxes" } else { "" };
        let outline = closed(object.outline_m());
        all.push(Series::new(label, SeriesKind::Line, outline));
    }
    all.extend(ground(arena, &closed));
    if let Some([x, y, heading]) = arena.start {
        let (sin, cos) = heading.sin_cos();
        let length = 0.06 * width.max(height);
        let ray = vec![(x, y), (x + length * cos, y + length * sin)];
        let start = Series::new("start and heading", SeriesKind::Dots, vec![(x, y)]);
        let heading = Series::new("", SeriesKind::Line, ray);
        all.extend([start.colour(1), heading.colour(1)]);
    }
    let title = format!("Arena: {}", arena.name);
    let plot = LinePlot {
        scale: ScoreScale::LikeX,
        ..LinePlot::new(
            Caption::new(title, format!("{width} x {height} m")),
            AxisSpec::new("x (m)", Unit::One),
            ("y (m)", Unit::One),
            all,
        )
    };
    draw_lines(&plot, path)
}

/// The outlines of regions, steps and a height field.
fn ground(arena: &Arena, closed: &dyn Fn(Vec<[f64; 2]>) -> Vec<(f64, f64)>) -> Vec<Series> {
    let ground = &arena.ground;
    let mut all = Vec::new();
    for region in &ground.regions {
        let label = format!("{}: friction {}", region.name, region.friction);
        let outline = closed(region.corners_m.clone());
        all.push(Series::new(label, SeriesKind::Line, outline).colour(2));
    }
    for step in &ground.steps {
        let label = format!("{}: {} m high", step.name, step.height_m);
        let outline = closed(step.outline_m().to_vec());
        all.push(Series::new(label, SeriesKind::Line, outline).colour(3));
    }
    if let Some(field) = &ground.heights {
        let (low_m, high_m) = field.range_m();
        let label = format!("height field: {low_m:.3} to {high_m:.3} m");
        let outline = closed(field.outline_m().to_vec());
        all.push(Series::new(label, SeriesKind::Line, outline).colour(4));
    }
    all
}
