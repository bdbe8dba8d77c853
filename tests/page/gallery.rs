//! Pictures of robots. `REALGAP_PICTURES=/some/folder` keeps them there for inspection.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

use std::path::PathBuf;

use realgap::plot::{BlockKind, Caption, Gallery, GalleryRobot, draw_gallery};
use realgap::results::portrait::portrait;
use realgap::robot::genome::{Development, Genome};
use realgap::robot::morphology::Morphology;
use realgap::search::generator;

fn shipped(name: &str) -> Morphology {
    Morphology::read(common::project().join(format!("morphologies/{name}.ron"))).unwrap()
}

/// The first random genome of this many modules that develops.
fn random(modules: usize) -> Morphology {
    let settings = Development {
        max_modules: 8,
        ..Development::default()
    };
    (0..50)
        .map(|seed| Genome::random(modules, &mut generator(seed, 0)).unwrap())
        .find_map(|genome| settings.develop(&format!("random_{modules}"), &genome).ok())
        .unwrap()
}

fn gallery(robots: Vec<GalleryRobot>, columns: usize) -> Gallery {
    Gallery {
        caption: Caption::new(
            "A gallery of robots",
            "all to one scale, at zero servo angles",
        ),
        columns,
        robots,
        gait_s: 2.0,
    }
}

/// Draws as PNG and SVG, twice; returns the SVG.
fn draw(name: &str, gallery: &Gallery) -> String {
    let temporary = tempfile::tempdir().unwrap();
    let folder =
        std::env::var_os("REALGAP_PICTURES").map_or(temporary.path().to_path_buf(), PathBuf::from);
    std::fs::create_dir_all(&folder).unwrap();
    let paths = ["png", "svg"].map(|extension| folder.join(format!("{name}.{extension}")));
    let bytes = paths.each_ref().map(|path| {
        draw_gallery(gallery, path).unwrap();
        let first = std::fs::read(path).unwrap();
        draw_gallery(gallery, path).unwrap();
        assert!(
            first == std::fs::read(path).unwrap(),
            "{name}: same robots, other bytes"
        );
        first
    });
    assert_eq!(&bytes[0][..8], b"\x89PNG\r\n\x1a\n");
    let svg = String::from_utf8(bytes[1].clone()).unwrap();
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
    svg
}

#[test]
fn a_gallery_shows_every_robot_with_title_and_note() {
    let robots = (1..=8)
        .map(|modules| portrait(&random(modules), format!("{modules} modules")))
        .collect();
    let svg = draw("gallery_random", &gallery(robots, 4));
    for modules in 1..=8 {
        assert!(svg.contains(&format!("random_{modules}")));
    }
    for word in [
        "active module",
        "passive module",
        "driven face, spins",
        "cm",
    ] {
        assert!(svg.contains(word), "{word}");
    }
    assert!(!svg.contains("bends"), "the key names what is not shown");
}

#[test]
fn shipped_robots_of_all_kinds_can_be_drawn() {
    let names = [
        "tripod",
        "two_module",
        "cube",
        "chain3",
        "spider8",
        "chain30",
    ];
    let robots = names.map(|name| portrait(&shipped(name), "")).to_vec();
    let svg = draw("gallery_shipped", &gallery(robots, 3));
    assert!(svg.contains("driven face, bends"));
    draw(
        "gallery_tripod",
        &gallery(vec![portrait(&shipped("tripod"), "walks")], 1),
    );
}

#[test]
fn a_portrait_has_a_box_for_every_collision_shape() {
    let tripod = portrait(&shipped("tripod"), "");
    let count = |kind| {
        tripod
            .blocks
            .iter()
            .filter(|block| block.kind == kind)
            .count()
    };
    assert_eq!(
        (
            count(BlockKind::Passive),
            count(BlockKind::Active),
            count(BlockKind::Plate)
        ),
        (1, 3, 3)
    );
    let summary = shipped("tripod").summary();
    for axis in 0..3 {
        let low = tripod
            .blocks
            .iter()
            .map(|b| b.lower_m[axis])
            .fold(f64::INFINITY, f64::min);
        assert!((low - summary.lower_robot_m[axis]).abs() < 1e-9);
    }
}

#[test]
fn empty_and_too_large_galleries_are_refused_and_invalid_numbers_are_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.png");
    assert!(draw_gallery(&gallery(Vec::new(), 3), &path).is_err());
    let robot = portrait(&shipped("cube"), "");
    assert!(draw_gallery(&gallery(vec![robot.clone(); 61], 3), &path).is_err());
    assert!(draw_gallery(&gallery(vec![robot.clone()], 0), &path).is_err());
    let mut broken = robot;
    broken.blocks[0].upper_m[1] = f64::NAN;
    draw("gallery_broken", &gallery(vec![broken], 1));
}

/// A portrait shows the name of every module, the mark of the tracked one, and the commands of every servo.
#[test]
fn a_portrait_names_modules_and_draws_commands_of_servos() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("tripod.svg");
    realgap::results::portrait::draw(&shipped("tripod"), &file).unwrap();
    let drawn = std::fs::read_to_string(file).unwrap();
    for word in [
        "core",
        "leg_a",
        "leg_b",
        "leg_c",
        "recordings follow it",
        "gait, ±92° over 2 s",
    ] {
        assert!(drawn.contains(word), "{word}");
    }
    let still = folder.path().join("cube.svg");
    realgap::results::portrait::draw(&shipped("cube"), &still).unwrap();
    assert!(!std::fs::read_to_string(still).unwrap().contains("gait"));
}
