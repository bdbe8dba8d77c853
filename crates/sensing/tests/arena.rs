//! Tests of casting beams in arenas, and of the errors for bad arenas.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::f64::consts::FRAC_PI_4;

use realgap_core::file::Source;
use realgap_sensing::arena::Arena;

fn arena(body: &str) -> realgap_core::Result<Arena> {
    Arena::parse(&Source::new(
        "arena.ron",
        format!("(name: \"a\", size_m: (4.0, 3.0), {body})"),
    ))
}

#[test]
fn a_beam_hits_objects_at_the_distances_and_angles_of_the_geometry() {
    let arena = arena(
        "boundary: Solid,
        boxes: [(centre_m: (2.0, 1.0), half_m: (0.1, 0.5)), (centre_m: (3.0, 2.0), half_m: (0.2, 0.2), turn_deg: 45)],
        circles: [(centre_m: (1.0, 2.5), radius_m: 0.25)],
        walls: [(from_m: (0.0, 0.2), to_m: (4.0, 0.2), thickness_m: 0.02)]",
    )
    .unwrap();
    let hit = |x: f64, y: f64, degrees: f64| {
        let hit = arena.cast([x, y], degrees.to_radians()).unwrap();
        (hit.distance_m, hit.incidence_rad)
    };
    let near = |(a, b): (f64, f64), (c, d): (f64, f64)| {
        assert!(
            (a - c).abs() < 1e-9 && (b - d).abs() < 1e-7,
            "{a} {b}, not {c} {d}"
        )
    };
    near(hit(1.0, 1.0, 0.0), (0.9, 0.0));
    near(hit(1.0, 1.0, 90.0), (1.25, 0.0));
    near(hit(1.0, 1.0, 180.0), (1.0, 0.0));
    near(hit(1.0, 1.0, -90.0), (0.79, 0.0));
    // The corner of the turned box, and its side.
    near(hit(2.5, 2.0, 0.0), (0.5 - 0.2 * 2f64.sqrt(), FRAC_PI_4));
    near(hit(2.5, 1.5, 45.0), (0.5 * 2f64.sqrt() - 0.2, 0.0));
    // Off the middle of a circle: sin θ = offset / radius.
    near(
        hit(0.3, 2.5 - 0.125, 0.0),
        (
            0.7 - (0.25_f64.powi(2) - 0.125_f64.powi(2)).sqrt(),
            30f64.to_radians(),
        ),
    );
    let oblique = arena.cast([1.0, 1.0], 20f64.to_radians()).unwrap();
    assert!((oblique.incidence_rad - 20f64.to_radians()).abs() < 1e-7);
    // A beam that begins inside of an object has distance 0.
    assert_eq!(arena.cast([2.0, 1.0], 0.3).unwrap().distance_m, 0.0);
    assert_eq!(
        arena
            .object_at([2.0, 1.0])
            .map(|k| arena.clearance_m([2.0, 1.0]) < 0.0 && k > 3),
        Some(true)
    );
    // A cone hits objects that its central line misses.
    let line = arena.cast([0.5, 2.1], 0.0).unwrap();
    let cone = arena.cast_cone([0.5, 2.1], 0.0, 0.35, 9).unwrap();
    assert!(cone.distance_m < line.distance_m && cone.offset_rad > 0.0);
    let same = arena.cast_cone([0.5, 2.1], 0.0, 0.35, 1).unwrap();
    assert_eq!(same.distance_m, line.distance_m);
}

#[test]
fn an_open_field_returns_nothing_and_steps_along_a_beam_reach_the_object() {
    let arena = arena("boundary: Open, circles: [(centre_m: (2.0, 1.5), radius_m: 0.3)]").unwrap();
    assert!(arena.cast([0.5, 1.5], std::f64::consts::PI).is_none());
    for k in 0..400 {
        let angle = f64::from(k) / 400.0 * std::f64::consts::TAU;
        let Some(hit) = arena.cast([0.5, 1.2], angle) else {
            continue;
        };
        let (sin, cos) = angle.sin_cos();
        let at = [0.5 + hit.distance_m * cos, 1.2 + hit.distance_m * sin];
        assert!(arena.clearance_m(at).abs() < 1e-9);
    }
}

#[test]
fn an_impossible_arena_is_refused() {
    for (body, said) in [
        (
            "boundary: Open, boxes: [(centre_m: (1.0, 1.0), half_m: (0.0, 1.0))]",
            "not a box",
        ),
        (
            "boundary: Open, circles: [(centre_m: (1.0, 1.0), radius_m: -1.0)]",
            "not a circle",
        ),
        (
            "boundary: Open, walls: [(from_m: (1.0, 1.0), to_m: (1.0, 1.0))]",
            "not a wall",
        ),
        (
            "boundary: Open, outline_m: [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]",
            "do not close",
        ),
        (
            "boundary: Solid, boxes: [(centre_m: (1.0, 1.0), half_m: (0.5, 0.5))], start: (x_m: 1.0, y_m: 1.0)",
            "cannot start here",
        ),
        (
            "boundary: Solid, start: (x_m: 9.0, y_m: 1.0)",
            "inside of the field",
        ),
        ("boundary: Closed", "Solid, Open"),
    ] {
        let error = arena(body).unwrap_err().to_string();
        assert!(
            error.contains(said) && error.contains("arena.ron:1:"),
            "{error}"
        );
    }
    let closed =
        arena("boundary: Open, outline_m: [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 0.0)]")
            .unwrap();
    assert_eq!(closed.objects.len(), 3);
}

/// An arena whose ground is the height field of a file with these bytes.
fn field(name: &str, bytes: &[u8], more: &str) -> realgap_core::Result<Arena> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join(name), bytes).unwrap();
    let text = format!(
        "(name: \"a\", size_m: (4.0, 3.0), boundary: Open, ground: HeightField(file: \"{name}\", from_m: (0.0, 0.0), size_m: (2.0, 1.0){more}))"
    );
    Arena::parse(&Source::new(folder.path().join("arena.ron"), text))
}

/// A grey picture.
fn png(width: u32, height: u32, depth: png::BitDepth, pixels: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(depth);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(pixels).unwrap();
    writer.finish().unwrap();
    bytes
}

#[test]
fn a_height_field_has_its_first_row_at_the_largest_y_whatever_the_file() {
    let matrix = field("h.csv", b"0, 0.1, 0.2\n0.3; 0.4; 0.5\n", "");
    // A row has commas or semicolons or blanks, another row something else.
    let wide = [0_u16, 13107, 26214, 39321, 52428, 65535];
    let wide: Vec<u8> = wide.iter().flat_map(|v| v.to_be_bytes()).collect();
    let fine = png(3, 2, png::BitDepth::Sixteen, &wide);
    let coarse = png(3, 2, png::BitDepth::Eight, &[0, 51, 102, 153, 204, 255]);
    let range = ", height_m: Some((0.0, 0.5))";
    let all = [
        matrix.unwrap(),
        field("h.png", &fine, range).unwrap(),
        field("h.png", &coarse, range).unwrap(),
    ];
    for arena in &all {
        let heights = arena.ground.heights.as_ref().unwrap();
        for (point, height) in [
            ([0.0, 1.0], 0.0),
            ([2.0, 1.0], 0.2),
            ([0.0, 0.0], 0.3),
            ([2.0, 0.0], 0.5),
            ([1.0, 0.5], 0.25),
        ] {
            let found = heights.height_m(point).unwrap();
            assert!((found - height).abs() < 1e-9, "{point:?}: {found}");
        }
        assert_eq!(heights.height_m([2.1, 0.5]), None);
        assert_eq!(heights.highest_m([0.0, 1.0], 0.1), Some(heights.at(1, 1)));
        assert_eq!(heights.highest_m([5.0, 1.0], 0.1), None);
        // Turned by a right angle about the world's origin.
        let turned = heights.moved([0.0, 0.0], std::f64::consts::FRAC_PI_2);
        let found = turned.height_m([-0.999_999, 0.000_001]).unwrap();
        assert!(found.abs() < 1e-5, "{found}");
    }
}

#[test]
fn files_that_are_no_heights_are_refused_with_the_place_and_a_remedy() {
    let colour = {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, 2, 2);
        encoder.set_color(png::ColorType::Rgb);
        let mut writer = encoder.write_header().unwrap();
        writer.write_image_data(&[0; 12]).unwrap();
        writer.finish().unwrap();
        bytes
    };
    let grey = png(2, 2, png::BitDepth::Eight, &[0; 4]);
    let long = "0 ".repeat(2001) + "\n" + &"0 ".repeat(2001);
    let range = ", height_m: Some((0.0, 0.1))";
    for (name, bytes, more, said) in [
        (
            "h.csv",
            b"0,1\n0,nan\n".to_vec(),
            "",
            "h.csv:2:1: not a height",
        ),
        ("h.csv", b"0,1\n0,inf\n".to_vec(), "", "finite numbers"),
        ("h.csv", b"0,1\n0\n".to_vec(), "", "1 heights in row 2"),
        ("h.csv", b"0,,1\n0,0,0\n".to_vec(), "", "\"\" in column 2"),
        ("h.csv", b"x,y\n0,0\n".to_vec(), "", "without a header"),
        ("h.csv", b"0,1\n".to_vec(), "", "1 x 2 heights"),
        ("h.csv", b"0\n1\n".to_vec(), "", "2 x 1 heights"),
        ("h.csv", b"".to_vec(), "", "0 x 0 heights"),
        ("h.csv", b"0,1\n0,200\n".to_vec(), "", "-100 to 100 m"),
        ("h.csv", b"0,1\n0,\xff\n".to_vec(), "", "UTF-8"),
        ("h.csv", long.into_bytes(), "", "2 to 2000"),
        ("h.csv", b"0,1\n0,1\n".to_vec(), range, "metres already"),
        ("h.png", grey.clone(), "", "height_m: (0.0, 0.05)"),
        (
            "h.png",
            grey.clone(),
            ", height_m: Some((0.0, NaN))",
            "not a height",
        ),
        ("h.png", colour, range, "grey with 8 or 16 bits"),
        ("h.png", grey[..40].to_vec(), range, "cannot be decoded"),
        (
            "h.png",
            png(1, 9, png::BitDepth::Eight, &[0; 9]),
            range,
            "1 x 9 pixels",
        ),
        ("h.txt", b"0,1\n0,1\n".to_vec(), "", "(.csv)"),
    ] {
        let error = field(name, &bytes, more).unwrap_err().to_string();
        assert!(error.contains(said), "{said}: {error}");
    }
    let missing =
        "boundary: Open, ground: HeightField(file: \"no.csv\", from_m: (0, 0), size_m: (1, 1))";
    let error = arena(missing).unwrap_err().to_string();
    assert!(error.contains("no.csv"), "{error}");
    let thin =
        "boundary: Open, ground: HeightField(file: \"no.csv\", from_m: (0, inf), size_m: (1, 1))";
    assert!(arena(thin).unwrap_err().to_string().contains("10 km"));
}

#[test]
fn regions_and_steps_that_are_none_are_refused() {
    let region = |corners: &str, more: &str| {
        format!(
            "boundary: Open, regions: [(name: \"r\", corners_m: [{corners}], friction: 0.5{more})]"
        )
    };
    let square = "(0, 0), (1, 0), (1, 1), (0, 1)";
    let step = |more: &str| {
        format!(
            "boundary: Open, steps: [(name: \"s\", centre_m: (1, 1), half_m: (0.1, 0.1), friction: 0.5, {more})]"
        )
    };
    for (body, said) in [
        (region("(0, 0), (1, 0)", ""), "2 corners"),
        (region("(0, 0), (1, 1), (1, 0), (0, 1)", ""), "cross"),
        (region("(0, 0), (1, 0), (2, 0)", ""), "without an area"),
        (region("(0, 0), (1, 0), (1, 0), (0, 1)", ""), "no length"),
        (region("(0, 0), (1, NaN), (0, 1)", ""), "not a corner"),
        (region(square, ", restitution: Some(2.0)"), "0 to 1"),
        (region(square, ", slope: 1"), "slope"),
        (region(square, "").replace("0.5", "-0.5"), "0 to 10"),
        (
            region(square, "").replace("\"r\"", "\"a.b\""),
            "letters, digits",
        ),
        (
            region(square, "")
                + ", steps: [(name: \"r\", centre_m: (1, 1), half_m: (0.1, 0.1), height_m: 0.1, friction: 0.5)]",
            "one name",
        ),
        (step("height_m: 0"), "0.0001 to 10 m"),
        (step("height_m: 0.1, turn_deg: NaN"), "turn_deg"),
        (
            step("height_m: 0.1").replace("(0.1, 0.1)", "(0.1, 0)"),
            "half_m[1]",
        ),
    ] {
        let error = arena(&body).unwrap_err().to_string();
        assert!(
            error.contains(said) && error.contains("arena.ron:1:"),
            "{said}: {error}"
        );
    }
    // Where two regions overlap, the later one lies on top.
    let both = arena(
        "boundary: Open, regions: [
            (name: \"tiles\", corners_m: [(0, 0), (2, 0), (2, 2), (0, 2)], friction: 0.5),
            (name: \"tape\", corners_m: [(0.5, 0.5), (1.5, 0.5), (1, 1.5)], friction: 0.9)]",
    );
    let ground = both.unwrap().ground;
    assert_eq!(ground.region_at([1.0, 0.7]), Some(1));
    assert_eq!(ground.region_at([0.55, 1.4]), Some(0));
    assert_eq!(ground.region_at([2.5, 1.0]), None);
}
