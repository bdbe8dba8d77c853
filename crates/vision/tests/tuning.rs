//! Tests of tuning a camera: the known settings of a stand-in camera are recovered from its pictures.

use std::path::Path;

use rand::RngExt;
use realgap_core::file::Source;
use realgap_core::random::Numbered;
use realgap_vision::camera::{Camera, Scene, take};
use realgap_vision::tuning::{CameraOptions, Known, TunedCamera, tune_camera};
use realgap_vision::{PictureSource, ViewsFile};

use crate::common;

/// The shipped scene with a small camera without automatic gain control, and a stand-in with these settings.
fn room(standin: &str) -> Scene {
    let text = std::fs::read_to_string(common::project().join("scenes/room.ron")).unwrap();
    let (before, after) = (
        text.find("cameras: {").unwrap(),
        text.find("views: [").unwrap(),
    );
    let text = format!(
        "{}cameras: {{
            \"model\": (resolution_px: (160, 120), field_of_view_deg: 62, exposure_s: 0.016,
                electrons_per_cd_s: 3400, read_noise_e: 8, gain: 1.5, jpeg_quality: 90),
            \"standin\": (stand_in: true, resolution_px: (160, 120), electrons_per_cd_s: 3400,
                place_sd_m: 0.008, angle_sd_deg: 0.25, {standin}),
        }},\n{}",
        &text[..before],
        &text[after..]
    );
    Scene::parse(&Source::new("room.ron", text)).unwrap_or_else(|e| panic!("{e}"))
}

/// The settings of the stand-in, which the fit does not know.
fn hidden(seed: u64) -> String {
    let mut rng = Numbered::SensorReading.generator(seed, 50);
    let mut between = |low: f64, high: f64| low + (high - low) * rng.random::<f64>();
    format!(
        "field_of_view_deg: {}, distortion: ({}, 0), blur_px: {}, exposure_s: {}, gain: {}, read_noise_e: {}, jpeg_quality: {}",
        between(60.0, 64.0),
        between(-0.08, 0.08),
        between(0.3, 1.2),
        0.016 * between(-0.5, 0.5).exp(),
        1.5 * between(-0.4, 0.4).exp(),
        between(5.0, 40.0),
        between(60.0, 95.0).round()
    )
}

fn pictures(scene: &Scene, folder: &Path, seed: u64) -> Camera {
    let camera = scene.camera("standin").unwrap();
    for (index, view) in scene.views.iter().enumerate() {
        let (picture, _) = take(
            scene,
            camera,
            view,
            &scene.lights[1],
            seed,
            1000 * index as u64,
        )
        .unwrap();
        picture
            .write_png(folder.join(format!("{}.png", view.name)))
            .unwrap();
    }
    let views = ViewsFile {
        source: PictureSource::StandIn,
        ..ViewsFile::default()
    };
    views.write(folder).unwrap();
    camera.clone()
}

fn tuned(seed: u64) -> (Camera, TunedCamera) {
    let root = tempfile::tempdir().unwrap();
    let scene = room(&hidden(seed));
    let truth = pictures(&scene, root.path(), seed);
    let start = scene.camera("model").unwrap();
    let light = scene.light("well").unwrap();
    let found = tune_camera(
        &scene,
        start,
        light,
        root.path(),
        &CameraOptions::default(),
        None,
    )
    .unwrap();
    (truth, found)
}

/// The true values in the order of the settings.
fn truths(camera: &Camera) -> [f64; 8] {
    [
        camera.lens.field_of_view_rad.to_degrees(),
        camera.lens.distortion[0],
        camera.lens.distortion[1],
        camera.sensor.exposure_s,
        camera.sensor.gain,
        camera.sensor.read_noise_e,
        camera.lens.blur_px,
        f64::from(camera.sensor.jpeg_quality.unwrap()),
    ]
}

#[test]
fn the_settings_of_a_stand_in_are_within_their_intervals_and_held_out_views_agree() {
    if !common::is_long_run("settings of a camera") {
        return;
    }
    let (truth, found) = tuned(1);
    println!("{found}");
    for (setting, value) in found.settings.iter().zip(truths(&truth)) {
        let is_in = setting.low <= value && value <= setting.high;
        println!("{} {value:.4} {is_in}", setting.name);
        assert!(is_in, "{} {value}", setting.name);
    }
    let brightness = |camera: &Camera| camera.sensor.exposure_s * camera.sensor.gain;
    let ratio = brightness(&found.camera) / brightness(&truth);
    assert!((ratio - 1.0).abs() < 0.03, "{ratio}");
    let judged = found.held_out.unwrap();
    assert!(judged.look_tuned < 0.2 * judged.look_start, "{judged}");
    assert!(
        judged.corners_tuned_px < 0.8 * judged.corners_start_px,
        "{judged}"
    );
    assert_eq!(found.real, PictureSource::StandIn);
    assert_eq!(found.held_out_views, ["left", "high"]);
    // The camera is read back unchanged from its file.
    let root = tempfile::tempdir().unwrap();
    let path = root.path().join("tuned.ron");
    std::fs::write(&path, found.camera.to_ron().unwrap()).unwrap();
    let again = Camera::read(&path).unwrap();
    assert!((again.lens.field_of_view_rad - found.camera.lens.field_of_view_rad).abs() < 1e-12);
    assert_eq!(again.sensor, found.camera.sensor);
}

/// A long one, for docs/validation/vision.md.
#[test]
#[ignore = "minutes"]
fn intervals_of_camera_settings_contain_the_truth_as_often_as_stated() {
    let (mut held, mut asked) = ([0; 8], 0);
    let count = std::env::var("CAMERAS").map_or(20, |n| n.parse().unwrap());
    let mut names = Vec::new();
    let from: u64 = std::env::var("FROM").map_or(100, |n| n.parse().unwrap());
    for seed in from..from + count {
        let (truth, found) = tuned(seed);
        asked += 1;
        names = found.settings.iter().map(|s| s.name).collect();
        for (k, (setting, value)) in found.settings.iter().zip(truths(&truth)).enumerate() {
            let is_in = setting.low <= value && value <= setting.high;
            held[k] += usize::from(is_in);
            println!(
                "{seed} {:18} {value:9.4} {:9.4} {:9.4} to {:9.4} {is_in} {:?}",
                setting.name, setting.value, setting.low, setting.high, setting.known
            );
        }
        println!("{seed} {}", found.held_out.unwrap());
    }
    for (name, held) in names.iter().zip(held) {
        println!("{name}: {held} of {asked}");
    }
    let all: usize = held.iter().sum();
    println!("{all} of {}", 8 * asked);
    assert!(all as f64 >= 0.85 * f64::from(8 * asked), "{all}");
}

/// With automatic gain control, pictures do not depend on the gain, so the gain must be reported as undetermined.
#[test]
fn a_gain_that_the_camera_sets_itself_is_not_determined() {
    if !common::is_long_run("settings of a camera") {
        return;
    }
    let root = tempfile::tempdir().unwrap();
    let mut scene = room("exposure_s: 0.016, most_gain: 24, jpeg_quality: 80");
    pictures(&scene, root.path(), 3);
    let start = scene
        .cameras
        .iter_mut()
        .find(|c| c.name == "model")
        .unwrap();
    start.sensor.gain = 0.4;
    start.sensor.most_gain = 24.0;
    let start = start.clone();
    let options = CameraOptions {
        held_out: Some(vec!["door".to_owned(), "left".to_owned()]),
        ..CameraOptions::default()
    };
    let light = scene.light("well").unwrap();
    let found = tune_camera(&scene, &start, light, root.path(), &options, None).unwrap();
    println!("{found}");
    let gain = found.settings.iter().find(|s| s.name == "gain").unwrap();
    assert_ne!(gain.known, Known::Determined, "{gain:?}");
    assert_eq!(found.held_out_views, ["door", "left"]);
    // Impossible requests are refused.
    let refused = |options: &CameraOptions, start: &Camera, folder: &Path| {
        tune_camera(&scene, start, light, folder, options, None)
            .unwrap_err()
            .to_string()
    };
    let unknown = CameraOptions {
        held_out: Some(vec!["attic".to_owned()]),
        ..CameraOptions::default()
    };
    assert!(refused(&unknown, &start, root.path()).contains("attic"));
    let few = CameraOptions {
        held_out: Some(scene.views[..6].iter().map(|v| v.name.clone()).collect()),
        ..CameraOptions::default()
    };
    assert!(refused(&few, &start, root.path()).contains("too few views"));
    let other = tempfile::tempdir().unwrap();
    std::fs::copy(
        root.path().join("door.png"),
        other.path().join("kitchen.png"),
    )
    .unwrap();
    let error = refused(&CameraOptions::default(), &start, other.path());
    assert!(
        error.contains("kitchen") && error.contains("window"),
        "{error}"
    );
    // Pictures with the names of other views are refused.
    for name in ["door", "right", "corner", "low"] {
        std::fs::copy(
            root.path().join("high.png"),
            other.path().join(format!("{name}.png")),
        )
        .unwrap();
    }
    let error = refused(&CameraOptions::default(), &start, other.path());
    assert!(error.contains("the scene is not found"), "{error}");
}
