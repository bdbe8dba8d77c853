//! The pictures as files: ordinary ones, and every extreme that data can bring.
//!
//! With `REALGAP_PICTURES=/some/folder` the pictures stay there to be looked at.

use std::path::{Path, PathBuf};

use super::*;
use realgap_core::ErrorKind;
use realgap_core::unit::Unit;

/// The folder for pictures; the guard removes a temporary one.
fn folder() -> (PathBuf, Option<tempfile::TempDir>) {
    match std::env::var_os("REALGAP_PICTURES") {
        Some(kept) => {
            std::fs::create_dir_all(&kept).unwrap();
            (PathBuf::from(kept), None)
        }
        None => {
            let folder = tempfile::tempdir().unwrap();
            (folder.path().to_path_buf(), Some(folder))
        }
    }
}

/// Width and height from the header of a PNG file.
fn png_size(path: &Path) -> (u32, u32) {
    let bytes = std::fs::read(path).unwrap();
    assert_eq!(&bytes[..8], b"\x89PNG\r\n\x1a\n");
    let number = |at: usize| u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap());
    (number(16), number(20))
}

/// Draws as PNG and SVG, twice; returns the SVG.
pub(super) fn check(name: &str, draw: impl Fn(&Path) -> Result<(), realgap_core::Error>) -> String {
    let (folder, _guard) = folder();
    let (png, svg) = (
        folder.join(format!("{name}.png")),
        folder.join(format!("{name}.svg")),
    );
    draw(&png).unwrap();
    draw(&svg).unwrap();
    let first = (std::fs::read(&png).unwrap(), std::fs::read(&svg).unwrap());
    draw(&png).unwrap();
    draw(&svg).unwrap();
    let second = (std::fs::read(&png).unwrap(), std::fs::read(&svg).unwrap());
    assert!(first == second, "{name}: same data, other bytes");
    let leftovers = std::fs::read_dir(&folder)
        .unwrap()
        .filter(|entry| {
            let file = entry.as_ref().unwrap().file_name();
            file.to_string_lossy().contains(&format!(".{name}."))
        })
        .count();
    assert_eq!(leftovers, 0, "{name}: temporary files are left over");
    let (width, height) = png_size(&png);
    assert!(width >= 1200 && height >= 500, "{name}: {width} x {height}");
    let text = String::from_utf8(first.1).unwrap();
    assert!(text.contains(&format!("width=\"{width}\" height=\"{height}\"")));
    assert!(!text.contains("NaN") && !text.contains("inf"));
    text
}

fn grid(count: usize, from: f64, to: f64) -> Vec<f64> {
    let step = (to - from) / (count.max(2) - 1) as f64;
    (0..count).map(|i| from + step * i as f64).collect()
}

fn truth(y: f64) -> Option<Truth> {
    let label = "hidden value".into();
    Some(Truth { x: 0.47, y, label })
}

/// A bowl with a valley from high friction and low restitution to the opposite corner.
fn valley(nx: usize, ny: usize) -> HeatMap {
    let (x_values, y_values) = (grid(nx, 0.05, 1.0), grid(ny, 0.0, 0.9));
    let score = |x: f64, y: f64| {
        let across = x + 0.45 * y - 0.62;
        let along = y - 0.35 - 0.2 * (x - 0.5);
        0.004 + 0.35 * across * across + 0.02 * along * along + 0.01 * x * y * y
    };
    let mut scores: Vec<Option<f64>> = y_values
        .iter()
        .flat_map(|&y| x_values.iter().map(move |&x| Some(score(x, y))))
        .collect();
    let best = (0..scores.len())
        .min_by(|&a, &b| scores[a].unwrap().total_cmp(&scores[b].unwrap()))
        .unwrap();
    let lowest = scores[best].unwrap();
    let indistinguishable = scores.iter().map(|s| s.unwrap() < 1.25 * lowest).collect();
    for iy in 0..ny {
        for ix in 0..nx {
            if iy + 3 >= ny && ix * 20 < nx * 3 && (ix + iy) % 3 != 0 {
                scores[iy * nx + ix] = None;
            }
        }
    }
    let axis = |name: &str| AxisSpec::new(name, Unit::One);
    HeatMap {
        best: Some((best % nx, best / nx)),
        indistinguishable,
        truth: truth(0.31),
        ..HeatMap::new(
            Caption::new(
                "tripod_floor: which floor makes the simulation match reality?",
                "4 stand-in recordings, not hardware · 441 points · rapier 0.36.1, 1/240 s, 4 substeps",
            ),
            [
                (axis("friction"), x_values),
                (axis("restitution"), y_values),
            ],
            scores,
            ("PCA discrepancy", Unit::Metre),
        )
    }
}

pub(super) fn curved_path(length_m: f64, bend: f64, wobble: f64) -> Vec<PathPoint> {
    let mut points = vec![[0.0, 0.0]];
    for i in 1..182 {
        let t = f64::from(i) / 181.0;
        let heading = bend * (t - 0.4) + wobble * (25.0 * t).sin();
        let [x, y] = points[points.len() - 1];
        let step = length_m / 181.0;
        points.push([x + step * heading.cos(), y + step * heading.sin()]);
    }
    points
}

fn nine_panels() -> PanelGrid {
    let panels = (0..9)
        .map(|i| {
            let (row, column) = (f64::from(i / 3), f64::from(i % 3));
            Panel {
                score: (i != 2)
                    .then_some(0.012 + 0.05 * (row - 1.0).abs() + 0.03 * (column - 1.0).abs()),
                note: format!(
                    "friction {:.2}, restitution {:.2}",
                    0.1 + 0.4 * column,
                    0.8 - 0.4 * row
                ),
                simulated_m: vec![curved_path(0.5 + 0.3 * row, 1.5 - 0.6 * column, 0.6)],
                is_best: i == 4,
            }
        })
        .collect();
    PanelGrid {
        caption: Caption::new(
            "tripod_floor: simulated paths across the sweep",
            "number: PCA discrepancy from the stand-in recordings, not hardware",
        ),
        columns: 3,
        panels,
        reality_m: vec![curved_path(0.82, 1.0, 0.6)],
        reality_label: "stand-in for reality".into(),
        unit: Unit::Metre,
    }
}

fn overlay(count: usize) -> Overlay {
    Overlay {
        caption: Caption::new(
            "tripod run 1, aligned",
            "PCA discrepancy from the reference · stand-in recordings, not hardware",
        ),
        reference: OverlayPath {
            name: "tripod_run_1".into(),
            discrepancy: None,
            points_m: curved_path(0.82, 1.0, 0.6),
        },
        others: (0..count)
            .map(|i| OverlayPath {
                name: format!("simulated_friction_0.{i}"),
                discrepancy: (i != 2).then_some(0.0123 * (i as f64 + 1.0)),
                points_m: curved_path(0.6 + 0.09 * i as f64, 1.6 - 0.5 * i as f64, 0.6),
            })
            .collect(),
        unit: Unit::Metre,
    }
}

/// A score over friction; `score` gives that at a position and its value.
fn curve_of(count: usize, score: impl Fn(usize, f64) -> Option<f64>) -> LinePlot {
    let x_values = grid(count, 0.05, 1.0);
    let scores = x_values.iter().enumerate().map(|(i, x)| score(i, *x));
    let scores: Vec<Option<f64>> = scores.collect();
    let best = (0..count)
        .filter(|&i| scores[i].is_some())
        .min_by(|&a, &b| scores[a].unwrap().total_cmp(&scores[b].unwrap()));
    let inside = |s: &Option<f64>| s.is_some_and(|s| s < 0.0065);
    LinePlot {
        best: best.map(|i| BestPoint {
            x: x_values[i],
            score: scores[i],
        }),
        truth: truth(0.0),
        ..LinePlot::over_parameter(
            Caption::new(
                "cube_toss: position error over friction",
                "100 real recordings",
            ),
            AxisSpec::new("friction", Unit::One),
            ("PCA discrepancy", Unit::Metre),
            x_values.clone(),
            &scores,
            scores.iter().map(inside).collect(),
        )
    }
}

fn curve(count: usize) -> LinePlot {
    curve_of(count, |_, x| {
        (x < 0.9).then_some(0.006 + 0.12 * (x - 0.42) * (x - 0.42) + 0.002 * (40.0 * x).sin())
    })
}

#[test]
fn an_ordinary_heat_map() {
    let map = valley(21, 21);
    let svg = check("heatmap", |path| draw_heat_map(&map, path));
    for text in [
        "tripod_floor",
        "not hardware",
        "friction",
        "restitution",
        "PCA discrepancy (cm)",
    ] {
        assert!(svg.contains(text), "{text}");
    }
    assert!(svg.contains("sans-serif"));
}

#[test]
fn heat_maps_of_extreme_data() {
    let mut wide = valley(21, 21);
    wide.scores
        .iter_mut()
        .flatten()
        .for_each(|s| *s = (*s * 80.0).powi(3));
    wide.caption.title = "scores over four decades".into();
    assert!(check("heatmap_log", |p| draw_heat_map(&wide, p)).contains("log scale"));
    wide.scores[5] = Some(0.0);
    assert!(check("heatmap_zero", |p| draw_heat_map(&wide, p)).contains("lowest values cut"));
    wide.scores[5] = Some(-1.0);
    assert!(check("heatmap_robust", |p| draw_heat_map(&wide, p)).contains("98th percentile"));

    check("heatmap_huge", |p| draw_heat_map(&valley(101, 101), p));
    check("heatmap_row", |p| draw_heat_map(&valley(21, 1), p));
    check("heatmap_column", |p| draw_heat_map(&valley(1, 5), p));

    let mut one = valley(1, 1);
    one.scores = vec![Some(3.0)];
    one.truth = None;
    check("heatmap_one_cell", |p| draw_heat_map(&one, p));

    let mut equal = valley(5, 5);
    equal.scores = vec![Some(0.0); 25];
    equal.indistinguishable = vec![true; 25];
    equal.x_values = grid(5, -2.0, 2.0);
    check("heatmap_equal", |p| draw_heat_map(&equal, p));

    let mut diverged = valley(5, 4);
    diverged.scores = vec![None; 20];
    diverged.scores[3] = Some(f64::NAN);
    diverged.best = None;
    diverged.indistinguishable = Vec::new();
    diverged.truth = None;
    check("heatmap_diverged", |p| draw_heat_map(&diverged, p));

    let mut long = valley(7, 6);
    long.caption.title = "a title that goes on and on, ".repeat(20);
    long.caption.subtitle = "and a subtitle & <tags> \"quoted\" \u{7} that does so too, ".repeat(9);
    long.score_label = "a very long name of a score, ".repeat(8);
    long.x.label = "a parameter with a really long name, ".repeat(6);
    long.y = AxisSpec::new("module.leg.mass", Unit::Kilogram);
    check("heatmap_long", |p| draw_heat_map(&long, p));

    let mut absurd = valley(3, 3);
    absurd.x_values = vec![-1e99, 0.0, 1e99];
    absurd.scores[0] = Some(f64::MAX);
    absurd.scores[1] = Some(-f64::MAX);
    check("heatmap_absurd", |p| draw_heat_map(&absurd, p));
}

#[test]
fn curves() {
    let svg = check("curve", |p| draw_lines(&curve(21), p));
    for text in [
        "cube_toss",
        "friction",
        "PCA discrepancy (cm)",
        "diverged (3)",
    ] {
        assert!(svg.contains(text), "{text}");
    }
    check("curve_one", |p| draw_lines(&curve(1), p));
    check("curve_many", |p| draw_lines(&curve(2001), p));
    let diverged = curve_of(5, |_, _| None);
    check("curve_diverged", |p| draw_lines(&diverged, p));
    let wide = curve_of(12, |i, _| Some(10f64.powi(i as i32 - 6)));
    check("curve_log", |p| draw_lines(&wide, p));
}

#[test]
fn panels() {
    let svg = check("panels", |p| render::write(&nine_panels(), p));
    for text in [
        "tripod_floor",
        "x (cm)",
        "y (cm)",
        "diverged",
        "friction 0.10",
        "1.20 cm",
    ] {
        assert!(svg.contains(text), "{text}");
    }
    let mut many = nine_panels();
    many.reality_m = (0..6)
        .map(|i| curved_path(0.7 + 0.04 * f64::from(i), 1.0, 0.5))
        .collect();
    many.panels.truncate(5);
    many.columns = 2;
    check("panels_two_columns", |p| render::write(&many, p));

    let mut still = nine_panels();
    still.reality_m = vec![vec![[0.0, 0.0]; 182], Vec::new()];
    for panel in &mut still.panels {
        panel.simulated_m = vec![
            vec![[0.0, 0.0]],
            vec![[f64::NAN, 0.0], [f64::INFINITY, 1.0]],
        ];
    }
    check("panels_still", |p| render::write(&still, p));

    let mut one = nine_panels();
    one.panels.truncate(1);
    one.panels[0].score = None;
    check("panels_one", |p| render::write(&one, p));

    // A straight walker is a flat line from above, whatever its pace: it is shown over time.
    let mut straight = nine_panels();
    straight.reality_m = vec![curved_path(0.7, 0.02, 0.01)];
    for (k, panel) in (0..).zip(&mut straight.panels) {
        panel.simulated_m = vec![curved_path(0.5 + 0.05 * f64::from(k), 0.02, 0.01)];
    }
    let svg = check("panels_straight", |p| render::write(&straight, p));
    assert!(svg.contains("time (% of the run)") && !svg.contains("y (cm)"));

    let mut upright = nine_panels();
    for path in upright
        .panels
        .iter_mut()
        .flat_map(|panel| &mut panel.simulated_m)
    {
        path.iter_mut().for_each(|point| point.swap(0, 1));
    }
    upright
        .panels
        .iter_mut()
        .for_each(|panel| panel.note = panel.note.repeat(5));
    upright.columns = 5;
    check("panels_upright", |p| render::write(&upright, p));
}

#[test]
fn overlays() {
    let svg = check("overlay", |p| draw_overlay(&overlay(4), p));
    for text in [
        "aligned",
        "x (cm)",
        "y (cm)",
        "simulated_friction_0.1: 2.46 cm",
        "(reference)",
    ] {
        assert!(svg.contains(text), "{text}");
    }
    check("overlay_many", |p| draw_overlay(&overlay(40), p));
    let mut still = overlay(1);
    still.reference.points_m = vec![[0.0, 0.0]; 3];
    still.others[0].points_m = vec![[0.0, 0.0], [1e-9, 0.0], [f64::NAN, 1e300]];
    check("overlay_still", |p| draw_overlay(&still, p));
    check("overlay_alone", |p| draw_overlay(&overlay(0), p));
}

#[test]
fn wrong_data_are_refused() {
    let path = Path::new("/nonexistent/map.png");
    let changes: [fn(&mut HeatMap); 4] = [
        |map| map.scores.truncate(8),
        |map| map.x_values[1] = f64::NAN,
        |map| map.x_values.clear(),
        |map| map.best = Some((3, 0)),
    ];
    let maps = changes.map(|change| {
        let mut map = valley(3, 3);
        change(&mut map);
        draw_heat_map(&map, path)
    });
    let mut grid = nine_panels();
    grid.panels.clear();
    let mut nothing = overlay(0);
    nothing.reference.points_m.clear();
    let others = [render::write(&grid, path), draw_overlay(&nothing, path)];
    for drawn in maps.into_iter().chain(others) {
        assert_eq!(drawn.unwrap_err().kind(), ErrorKind::Invalid);
    }
}

#[test]
fn files_that_cannot_be_written_are_reported() {
    let map = valley(3, 3);
    let error = draw_heat_map(&map, "/nonexistent/map.png").unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Io);
    for wrong in ["map.jpg", "map", ".png"] {
        let error = draw_heat_map(&map, wrong).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Usage, "{wrong}");
        assert!(error.to_string().contains(".png, .svg"));
    }

    // The old picture survives a failure, and no part of a new one appears.
    let folder = tempfile::tempdir().unwrap();
    assert!(check_picture_path(folder.path().join("MAP.PNG")).is_ok());
    let taken = folder.path().join("map.png");
    std::fs::create_dir(&taken).unwrap();
    assert_eq!(
        draw_heat_map(&map, &taken).unwrap_err().kind(),
        ErrorKind::Io
    );
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn a_heat_map_marks_where_its_scores_come_from() {
    let mut map = valley(21, 21);
    map.best = Some((8, 7));
    map.best_at = Some((0.4433, 0.333));
    map.evaluated = vec![(0.1, 0.1), (0.4433, 0.333), (0.9, 0.7)];
    let svg = check("heatmap_evaluated", |path| draw_heat_map(&map, path));
    assert!(svg.contains("evaluated (3)") && svg.contains("friction 0.4433"));
    map.evaluated.clear();
    let plain = check("heatmap_cells", |path| draw_heat_map(&map, path));
    assert!(!plain.contains("evaluated"));
    // Three dots and the one in the legend, of two discs each.
    let discs = |svg: &str| svg.matches("<circle").count();
    assert_eq!(discs(&svg), discs(&plain) + 8);
}

#[test]
fn bright_is_good_whichever_way_the_score_counts() {
    let map = |larger_is_better| HeatMap {
        scores: vec![Some(1.0), Some(2.0)],
        x_values: vec![2.0, 3.0],
        y_values: vec![1.0],
        best: None,
        indistinguishable: Vec::new(),
        truth: None,
        larger_is_better,
        lines: Vec::new(),
        ..valley(2, 2)
    };
    // The paper is white; what comes next is the cell of the lower score.
    let first_cell_is_bright = |svg: &str| {
        let areas = svg.split("<rect").skip(1);
        let mut fills = areas.filter_map(|area| area.split("fill=\"#").nth(1)?.get(..6));
        let first = fills.find(|colour| *colour != "FFFFFF").unwrap();
        u8::from_str_radix(&first[..2], 16).unwrap() > 128
    };
    let low_is_good = check("heatmap_low", |path| draw_heat_map(&map(false), path));
    let high_is_good = check("heatmap_high", |path| draw_heat_map(&map(true), path));
    assert!(first_cell_is_bright(&low_is_good));
    assert!(!first_cell_is_bright(&high_is_good));
}

#[test]
fn a_count_has_no_ticks_between_whole_numbers() {
    let mut map = valley(4, 12);
    map.x = AxisSpec::new("modules", Unit::One).whole();
    map.y = AxisSpec::new("active faces", Unit::One).whole();
    map.x_values = vec![1.25, 1.75, 2.25, 2.75];
    map.y_values = (1..=12).map(f64::from).collect();
    map.best = None;
    map.truth = None;
    let svg = check("heatmap_counts", |path| draw_heat_map(&map, path));
    for half in ["1.0", "1.25", "1.5", "2.5", "2.75"] {
        assert!(
            !svg.contains(&format!(">\n{half}")) && !svg.contains(&format!(">{half}")),
            "{half}"
        );
    }
}
