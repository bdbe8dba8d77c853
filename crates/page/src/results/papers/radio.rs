//! Maps of radio: how strong an anchor is everywhere, and where a model errs.

use std::path::Path;

use crate::plot::{AxisSpec, Caption, HeatMap, ScoreScale, Truth, draw_heat_map};
use realgap_core::error::Result;
use realgap_core::unit::Unit;
use realgap_sensing::arena::{Anchor, Arena};
use realgap_sensing::radio::{CELL_M, Evaluation, Link, RadioModel};

/// Cells along the longer side of a map of strengths.
const CELLS: usize = 160;

/// Middles of cells along a side.
fn middles(length_m: f64, cell_m: f64) -> Vec<f64> {
    let count = (length_m / cell_m).ceil().max(1.0) as usize;
    (0..count).map(|k| (k as f64 + 0.5) * cell_m).collect()
}

/// A map of an arena without values.
fn blank(arena: &Arena, cell_m: f64, caption: Caption, score_label: &str) -> HeatMap {
    let [x, y] = arena.size_m;
    let closed = arena.objects.iter().map(|object| {
        let mut corners = object.outline_m();
        corners.extend(corners.first().copied());
        corners.into_iter().map(|[x, y]| (x, y)).collect()
    });
    let axis = |name: &str, length_m: f64| {
        let spec = AxisSpec::new(name, Unit::Metre);
        (spec, middles(length_m, cell_m))
    };
    let (axes, score) = ([axis("x", x), axis("y", y)], (score_label, Unit::One));
    HeatMap {
        missing: "nothing heard here".to_owned(),
        scale: ScoreScale::Linear,
        lines: closed.collect(),
        ..HeatMap::new(caption, axes, Vec::new(), score)
    }
}

/// How strong an anchor's signal is everywhere in an arena.
///
/// # Errors
/// A path that is no picture's, a full disk.
pub fn draw_strength_map(
    model: &RadioModel,
    arena: &Arena,
    anchor: &Anchor,
    path: impl AsRef<Path>,
) -> Result<()> {
    let [x, y] = arena.size_m;
    let caption = Caption::new(
        format!("Strength of anchor {} in {}", anchor.name, arena.name),
        format!("{}; {}", model.propagation.formula(), model.description),
    );
    let cell_m = x.max(y) / CELLS as f64;
    let mut map = blank(arena, cell_m, caption, "strength (dBm)");
    for y in &map.y_values {
        for x in &map.x_values {
            let link = Link::new(arena, model.robot_at([*x, *y]), anchor.position_m);
            map.scores.push(Some(model.strength_dbm(&link)));
        }
    }
    map.larger_is_better = true;
    map.truth = Some(Truth {
        x: anchor.position_m[0],
        y: anchor.position_m[1],
        label: format!("anchor {}", anchor.name),
    });
    draw_heat_map(&map, path)
}

/// Where a model errs: the root mean square error of every quarter of a metre.
///
/// # Errors
/// A path that is no picture's, a full disk.
pub fn draw_error_map(found: &Evaluation, arena: &Arena, path: impl AsRef<Path>) -> Result<()> {
    let title = format!("Where the radio model errs in {}", arena.name);
    let (rmse_db, count) = (found.rmse_db, found.readings);
    let subtitle = format!(
        "{}; {rmse_db:.2} dB over {count} strengths",
        found.propagation
    );
    let caption = Caption::new(title, subtitle);
    let mut map = blank(arena, CELL_M, caption, "root mean square error (dB)");
    let columns = map.x_values.len();
    map.scores = vec![None; columns * map.y_values.len()];
    for (at_m, error_db) in &found.errors {
        let [ix, iy] = at_m.map(|v| (v / CELL_M).floor());
        let is_in = ix >= 0.0 && iy >= 0.0 && (ix as usize) < columns;
        let score = map.scores.get_mut(iy as usize * columns + ix as usize);
        if let Some(score) = score.filter(|_| is_in) {
            *score = Some(*error_db);
        }
    }
    draw_heat_map(&map, path)
}
