//! Tests of the simulated camera: geometry, light, noise, and determinism for a seed.

use rand::RngExt;
use realgap_core::file::Source;
use realgap_core::random::Numbered;
use realgap_core::statistics::{mean, standard_deviation};
use realgap_vision::camera::{Scene, known, take};
use realgap_vision::{Extractor, Grey, Sought, Template};

use crate::common;

fn scene(cameras: &str, lights: &str, things: &str) -> Scene {
    let text = format!(
        "Scene(name: \"test\", room_m: (4, 4, 3), wall: (0.5, 0.5, 0.5), {things}
        lights: {{{lights}}}, cameras: {{{cameras}}},
        views: [(name: \"ahead\", place_m: (2, 1, 1.5), look_at_m: (2, 4, 1.5)),
            (name: \"aslant\", place_m: (1, 1, 1.2), look_at_m: (2.3, 4, 1.6))])"
    );
    Scene::parse(&Source::new("test.ron", text)).unwrap_or_else(|e| panic!("{e}"))
}

const PLAIN: &str = "\"plain\": (resolution_px: (320, 240), exposure_s: 0.01, electrons_per_cd_s: 50000, full_well_e: 100000)";
const EVEN: &str = "\"even\": (ambient_lux: 300)";
const POSTERS: &str = "posters: [
    (centre_m: (1.4, 3.99, 1.6), width_m: 0.7, facing_deg: -90, motif: Logo),
    (centre_m: (2.6, 3.99, 1.5), width_m: 0.8, facing_deg: -90, motif: Disc)],";

fn shot(scene: &Scene, view: usize, seed: u64) -> Grey {
    let (picture, _) = take(
        scene,
        &scene.cameras[0],
        &scene.views[view],
        &scene.lights[0],
        seed,
        0,
    )
    .unwrap();
    picture.grey()
}

/// The stated positions of posters agree with the rendered picture, which tests lens, distortion and rays.
#[test]
fn the_known_truth_of_a_picture_agrees_with_the_picture() {
    for distortion in ["(0, 0)", "(-0.08, 0.01)", "(0.06, 0)"] {
        let camera = PLAIN.replace(
            "exposure_s",
            &format!("distortion: {distortion}, exposure_s"),
        );
        let scene = scene(&camera, EVEN, POSTERS);
        for view in 0..2 {
            let picture = shot(&scene, view, 1);
            let pose = &scene.views[view].pose;
            let truth = known(&scene, &scene.cameras[0], pose, "ahead");
            let (x, y) = truth.template_at_px.unwrap();
            let logo = realgap_vision::camera::Motif::Logo.picture().unwrap();
            let template = logo.resized(70, 70);
            let (found, _) = Template::PAPER.find(&picture, &template).unwrap();
            let apart = (found.centre_px[0] - x).hypot(found.centre_px[1] - y);
            println!("{distortion}, view {view}: {apart:.2} px, r {:.3}", found.r);
            assert!(
                apart < 2.0 && found.r > 0.7,
                "{distortion} {view}: {apart} {}",
                found.r
            );
            // Along the outline of the disc, inside is dark and outside bright.
            let count = truth.outline_px.len() as f64;
            let centre = truth
                .outline_px
                .iter()
                .fold((0.0, 0.0), |c, p| (c.0 + p.0 / count, c.1 + p.1 / count));
            for (px, py) in &truth.outline_px {
                let at = |share: f64| {
                    picture.between(
                        centre.0 + share * (px - centre.0),
                        centre.1 + share * (py - centre.1),
                    )
                };
                assert!(at(0.9) < 0.45 && at(1.1) > 0.6, "{} {}", at(0.9), at(1.1));
            }
        }
    }
}

/// A grey wall in uniform light: luminance, electrons and pixel value are computed by hand.
#[test]
fn a_uniform_wall_has_the_brightness_of_the_formula_and_photon_noise() {
    let camera = "\"c\": (resolution_px: (200, 150), exposure_s: 0.01, electrons_per_cd_s: 2000, full_well_e: 2000, read_noise_e: 12)";
    let scene = scene(camera, EVEN, "");
    let picture = shot(&scene, 0, 3);
    let share: Vec<f64> = picture
        .values()
        .iter()
        .map(|v| {
            let v = f64::from(*v);
            if v <= 0.04045 {
                v / 12.92
            } else {
                ((v + 0.055) / 1.055).powf(2.4)
            }
        })
        .collect();
    // The luminance is 0.5 times 300 lux divided by pi; the exposure is 0.01 s at 2000 electrons per second.
    let electrons = 0.5 * 300.0 / std::f64::consts::PI * 20.0;
    let found = 2000.0 * mean(&share);
    assert!(
        (found / electrons - 1.0).abs() < 0.005,
        "{found} {electrons}"
    );
    // A grey value is a mean of three colours with independent noise.
    let weights = (0.2125_f64.powi(2) + 0.7154_f64.powi(2) + 0.0721_f64.powi(2)).sqrt();
    let sd = (electrons + 144.0).sqrt() * weights;
    let spread = 2000.0 * standard_deviation(&share);
    println!("{found:.1} electrons (by hand {electrons:.1}), sd {spread:.2} (by hand {sd:.2})");
    assert!((spread / sd - 1.0).abs() < 0.03, "{spread} {sd}");
}

/// The light of a lamp falls with the square of the distance and with the angle of incidence, and boxes cast shadows.
#[test]
fn a_lamp_lights_by_distance_and_angle_and_boxes_cast_shadows() {
    let camera = "\"c\": (resolution_px: (161, 121), field_of_view_deg: 60, exposure_s: 0.01, electrons_per_cd_s: 1e7, full_well_e: 1e6)";
    let lamp = "\"l\": (ambient_lux: 0, lamps: [(place_m: (2, 1, 2.5), intensity_cd: 100)])";
    let linear = |v: f32| ((f64::from(v) + 0.055) / 1.055).powf(2.4);
    let open = shot(&scene(camera, lamp, ""), 0, 1);
    // Straight ahead: (2, 4, 1.5); one metre below the lamp and three away.
    let squared: f64 = 9.0 + 1.0;
    let by_hand = 0.5 * 100.0 * 3.0 / squared.sqrt() / squared / std::f64::consts::PI * 1e5 / 1e6;
    let found = linear(open.at(80, 60));
    assert!((found / by_hand - 1.0).abs() < 0.03, "{found} {by_hand}");
    let block = "blocks: [(centre_m: (2, 2, 2.15), half_m: (0.3, 0.1, 0.1))],";
    let shaded = shot(&scene(camera, lamp, block), 0, 1);
    assert!(shaded.at(80, 60) < 0.02, "{}", shaded.at(80, 60));
    assert!((shaded.at(20, 60) - open.at(20, 60)).abs() < 0.02);
}

#[test]
fn the_seed_gives_the_same_bytes_on_any_number_of_threads() {
    let scene = Scene::read(common::project().join("scenes/room.ron")).unwrap();
    let bytes = |threads: usize, seed: u64| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            let camera = scene.camera("standin").unwrap();
            let light = scene.light("badly").unwrap();
            let (picture, _) = take(&scene, camera, &scene.views[0], light, seed, 7).unwrap();
            picture.to_png().unwrap()
        })
    };
    let one = bytes(1, 5);
    assert_eq!(one, bytes(3, 5));
    assert_ne!(one, bytes(1, 6));
}

/// The hierarchy of many boxes gives the same hits as a search through all of them: pictures of all boxes and of their halves agree.
#[test]
fn many_boxes_occlude_each_other_correctly() {
    let mut rng = Numbered::SensorReading.generator(4, 0);
    let mut blocks = Vec::new();
    for _ in 0..200 {
        let [x, y, z] = [0.2..3.8, 2.0..3.8, 0.2..2.8].map(|range| rng.random_range(range));
        let turn = rng.random_range(0.0..90.0);
        blocks.push(format!(
            "(centre_m: ({x:.3}, {y:.3}, {z:.3}), half_m: (0.06, 0.06, 0.06), turn_deg: {turn:.1}, colour: (0, 0, 0))"
        ));
    }
    let black = |blocks: &[String]| {
        let things = format!("blocks: [{}],", blocks.join(", "));
        let picture = shot(&scene(PLAIN, EVEN, &things), 0, 1);
        picture
            .values()
            .iter()
            .map(|v| *v < 0.05)
            .collect::<Vec<bool>>()
    };
    let whole = black(&blocks);
    let (a, b) = (black(&blocks[..100]), black(&blocks[100..]));
    let differ = (0..whole.len())
        .filter(|i| whole[*i] != (a[*i] || b[*i]))
        .count();
    assert!(whole.iter().filter(|is| **is).count() > 2000);
    // Pixels on borders are mixed.
    assert!(differ < whole.len() / 500, "{differ}");
}

#[test]
fn most_viewpoints_of_the_shipped_scene_show_everything() {
    let scene = Scene::read(common::project().join("scenes/room.ron")).unwrap();
    let camera = scene.camera("model").unwrap();
    let truths: Vec<_> = scene
        .views
        .iter()
        .map(|view| known(&scene, camera, &view.pose, &view.name))
        .collect();
    assert_eq!(truths.len(), 8);
    let count =
        |has: &dyn Fn(&realgap_vision::ViewFile) -> bool| truths.iter().filter(|t| has(t)).count();
    let counts = [
        count(&|t| t.template_at_px.is_some()),
        count(&|t| !t.outline_px.is_empty()),
        count(&|t| t.text.is_some()),
    ];
    println!("template, contour, text: {counts:?} of 8 views");
    assert!(counts.iter().all(|n| *n >= 6), "{counts:?}");
}

#[test]
fn an_impossible_scene_gives_an_error_with_its_position() {
    let refused = |from: &str, to: &str| {
        let path = common::project().join("scenes/room.ron");
        let text = std::fs::read_to_string(path).unwrap();
        assert!(text.contains(from), "{from}");
        let text = text.replacen(from, to, 1);
        Scene::parse(&Source::new("room.ron", text))
            .unwrap_err()
            .to_string()
    };
    let far = refused("place_m: (3.0, 0.6, 1.5)", "place_m: (3.0, -0.6, 1.5)");
    assert!(
        far.contains("views[0]") && far.contains("not inside of the room"),
        "{far}"
    );
    let within = refused("place_m: (3.0, 0.6, 1.5)", "place_m: (0.4, 2.6, 0.9)");
    assert!(within.contains("stands in a box"), "{within}");
    let up = refused("look_at_m: (3.1, 5.0, 1.5)", "look_at_m: (3.0, 0.6, 2.5)");
    assert!(up.contains("direction of the camera is not valid"), "{up}");
    let wide = refused("field_of_view_deg: 62,", "field_of_view_deg: 190,");
    assert!(wide.contains("1 degrees to 150 degrees"), "{wide}");
    let colour = refused("wall: (0.62", "wall: (1.62");
    assert!(colour.contains("not a colour"), "{colour}");
    for turn in [
        "0, 0, 0, 0",
        "inf, 0, 0, 0",
        "1e200, 0, 0, 0",
        "NaN, 0, 0, 1",
    ] {
        let turned = refused(
            "turn_deg:",
            &format!("orientation_wxyz: ({turn}), turn_deg:"),
        );
        assert!(
            turned.contains(".orientation_wxyz: not an orientation"),
            "{turned}"
        );
    }
    let unknown = refused("tile_m", "tiles_m");
    assert!(unknown.contains("did you mean `tile_m`"), "{unknown}");
    let empty = refused("Text(\"ROOM 42\\nEXIT LEFT\\nGATE 1073\")", "Text(\" \")");
    assert!(empty.contains("needs text"), "{empty}");
    let scene = Scene::read(common::project().join("scenes/room.ron")).unwrap();
    let error = scene.camera("modle").unwrap_err().to_string();
    assert!(error.contains("did you mean `model`"), "{error}");
}

/// A picture of one pixel, without anything to find, is valid.
#[test]
fn a_camera_of_one_pixel_takes_a_picture() {
    let camera = PLAIN.replace("(320, 240)", "(1, 1)");
    let scene = scene(&camera, EVEN, POSTERS);
    let picture = shot(&scene, 0, 1);
    assert_eq!((picture.width(), picture.height()), (1, 1));
    let truth = known(&scene, &scene.cameras[0], &scene.views[0].pose, "one");
    assert!(truth.template_at_px.is_none() && truth.outline_px.is_empty());
    let edges = realgap_vision::Edges::PAPER;
    assert!(edges.extract(&picture, &Sought::default()).is_ok());
}
