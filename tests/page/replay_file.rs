//! Replays for other programs: MCAP for Foxglove, glTF; read back here and by their own packages.
#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

use crate::common;

use std::path::Path;

use common::{python_with, realgap, text};
use nalgebra::Isometry3;
use realgap::report::{Replay, SIMULATION};
use realgap::robot::morphology::Morphology;
use realgap::simulation::{Experiment, Film, Floor, Sampling, film};
use realgap::trajectory::{self, Reading, Recording};
use serde_json::Value;

const RUNS: &str = "real_trajectories/tripod_standin";

/// Two seconds of the tripod.
fn run() -> (Morphology, Film) {
    let robot = Morphology::read(common::project().join("morphologies/tripod.ron")).unwrap();
    let mut experiment = Experiment::new(robot.assemble());
    experiment.duration_s = 2.0;
    experiment.sampling = Sampling::Rate(60.0);
    let (_, film) = film(&experiment).unwrap();
    (robot, film.unwrap())
}

/// Two runs, and one of which only the path is known.
fn recordings() -> Vec<Recording> {
    let file = |name: &str| common::project().join(RUNS).join(name);
    let read = |name: &str| {
        let mut recording = trajectory::read(file(name), Reading::default()).unwrap();
        recording.trajectory = trajectory::clip(&recording.trajectory, 3.0).unwrap();
        recording
    };
    let mut path = read("run_01.csv");
    let motion = &path.trajectory;
    let (times, places) = (
        motion.times_s().to_vec(),
        motion.positions_world_m().to_vec(),
    );
    path.trajectory = trajectory::Trajectory::new(times, places).unwrap();
    // The name of another.
    path.name = "run_00".to_owned();
    vec![read("run_00.csv"), path]
}

fn replay<'a>(robot: &'a Morphology, run: &'a Film, recordings: &'a [Recording]) -> Replay<'a> {
    Replay {
        robot: Some(robot),
        run,
        run_name: SIMULATION,
        recordings,
        align: true,
        floor: Floor::default(),
        scene: &[],
        warnings: &[],
        provenance: &[],
    }
}

fn python(program: &str, folder: &Path, script: &str) {
    let done = std::process::Command::new(program)
        .args(["-c", script])
        .current_dir(folder)
        .output()
        .unwrap();
    assert!(done.status.success(), "{}", text(&done.stderr));
}

#[test]
fn an_mcap_replay_moves_every_part_as_the_run_did() {
    let (robot, run) = run();
    let recordings = recordings();
    let bytes = replay(&robot, &run, &recordings).mcap().unwrap();
    assert_eq!(bytes, replay(&robot, &run, &recordings).mcap().unwrap());
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("replay.mcap");
    std::fs::write(&file, bytes).unwrap();
    let of = |topic: &str, child: Option<String>| {
        let reading = Reading {
            topic: Some(topic.to_owned()),
            child_frame: child,
            ..Reading::default()
        };
        trajectory::read(&file, reading).unwrap().trajectory
    };
    let tracked = of("/simulation/pose", None);
    assert_eq!(tracked.positions_world_m(), run.track.positions_world_m());
    for (part, poses) in run.parts.iter().enumerate() {
        let moved = of("/tf", Some(format!("simulation/part{part}")));
        for (pose, place) in poses
            .as_ref()
            .unwrap()
            .iter()
            .zip(moved.positions_world_m())
        {
            assert_eq!(pose.translation.vector, *place);
        }
    }
    // The second of two with one name has another; it is a point.
    let point = of("/tf", Some("run_00 2/point".to_owned()));
    assert_eq!(
        point.positions_world_m(),
        of("/run_00 2/pose", None).positions_world_m()
    );
    assert!((point.positions_world_m()[0] - tracked.positions_world_m()[0]).norm() < 1e-12);
}

#[test]
fn the_package_mcap_finds_a_scene_in_frames_that_move() {
    let Some(program) = python_with("mcap.reader") else {
        return;
    };
    let (robot, run) = run();
    let folder = tempfile::tempdir().unwrap();
    let bytes = replay(&robot, &run, &recordings()).mcap().unwrap();
    std::fs::write(folder.path().join("replay.mcap"), bytes).unwrap();
    let script = "
import json
from mcap.reader import make_reader
kinds, frames, scenes, poses = {}, set(), {}, 0
with open('replay.mcap', 'rb') as file:
    reader = make_reader(file, validate_crcs=True)
    last = 0
    for schema, channel, message in reader.iter_messages():
        assert schema.encoding == 'jsonschema' and channel.message_encoding == 'json'
        known = json.loads(schema.data)['properties']
        body = json.loads(message.data)
        assert set(body) <= set(known), (set(body), set(known))
        assert message.log_time >= last; last = message.log_time
        kinds[channel.topic] = schema.name
        if schema.name == 'foxglove.FrameTransforms':
            frames |= {t['child_frame_id'] for t in body['transforms']}
        elif schema.name == 'foxglove.SceneUpdate':
            scenes[channel.topic] = body['entities']
        else:
            poses += 1
assert kinds['/tf'] == 'foxglove.FrameTransforms', kinds
assert {'/floor', '/simulation/scene', '/run_00/scene', '/run_00 2/scene'} == set(scenes), scenes.keys()
for entities in scenes.values():
    for entity in entities:
        assert entity['frame_id'] in frames | {'world'}, entity['frame_id']
        assert entity['frame_locked'] and entity['lifetime'] == {'sec': 0, 'nsec': 0}
cubes = lambda topic: [c for e in scenes[topic] for c in e['cubes']]
assert len(cubes('/simulation/scene')) > 3 and all(c['color']['a'] == 1 for c in cubes('/simulation/scene'))
assert len(cubes('/run_00/scene')) > 0 and all(c['color']['a'] < 1 for c in cubes('/run_00/scene'))
assert not cubes('/run_00 2/scene') and sum(len(e['spheres']) for e in scenes['/run_00 2/scene']) == 1
for topic in scenes:
    lines = [l for e in scenes[topic] for l in e['lines']]
    assert topic == '/floor' or (len(lines) == 1 and len(lines[0]['points']) > 50), topic
assert poses > 300
";
    python(&program, folder.path(), script);
}

/// The document and the bytes of a binary glTF file, whose form is checked.
fn parts(file: &[u8]) -> (Value, Vec<u8>) {
    let number = |at: usize| u32::from_le_bytes(file[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!(
        (&file[..4], number(4), number(8)),
        (&b"glTF"[..], 2, file.len())
    );
    let length = number(12);
    assert_eq!((&file[16..20], length % 4), (&b"JSON"[..], 0));
    let document = serde_json::from_slice(&file[20..20 + length]).unwrap();
    let rest = 20 + length;
    assert_eq!(&file[rest + 4..rest + 8], b"BIN\0");
    assert_eq!(number(rest), file.len() - rest - 8);
    (document, file[rest + 8..].to_vec())
}

/// The numbers of an accessor, row by row.
fn rows(document: &Value, bytes: &[u8], accessor: &Value) -> Vec<Vec<f32>> {
    let accessor = &document["accessors"][accessor.as_u64().unwrap() as usize];
    assert_eq!(accessor["componentType"], 5126);
    let width = match accessor["type"].as_str().unwrap() {
        "SCALAR" => 1,
        "VEC3" => 3,
        _ => 4,
    };
    let view = &document["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
    let at = view["byteOffset"].as_u64().unwrap() as usize;
    let length = view["byteLength"].as_u64().unwrap() as usize;
    assert_eq!(
        length,
        4 * width * accessor["count"].as_u64().unwrap() as usize
    );
    let numbers = bytes[at..at + length].chunks_exact(4);
    let numbers: Vec<f32> = numbers
        .map(|b| f32::from_le_bytes(b.try_into().unwrap()))
        .collect();
    numbers.chunks_exact(width).map(<[f32]>::to_vec).collect()
}

#[test]
fn a_model_moves_every_part_as_the_run_did() {
    let (robot, run) = run();
    let recordings = recordings();
    let file = replay(&robot, &run, &recordings).gltf().unwrap();
    let (document, bytes) = parts(&file);
    let length = document["buffers"][0]["byteLength"].as_u64().unwrap();
    assert_eq!(length, bytes.len() as u64);
    let animation = &document["animations"][0];
    for (part, poses) in run.parts.iter().enumerate() {
        let nodes = document["nodes"].as_array().unwrap();
        let name = format!("simulation/part{part}");
        let node = nodes
            .iter()
            .position(|node| node["name"] == name.as_str())
            .unwrap();
        let of = |path: &str| {
            let channels = animation["channels"].as_array().unwrap();
            let mut channels = channels.iter().map(|channel| (&channel["target"], channel));
            let found =
                channels.find(|(target, _)| target["node"] == node && target["path"] == path);
            let sampler = found.unwrap().1["sampler"].as_u64().unwrap() as usize;
            let sampler = &animation["samplers"][sampler];
            [&sampler["input"], &sampler["output"]].map(|of| rows(&document, &bytes, of))
        };
        let ([times, places], [_, turns]) = (of("translation"), of("rotation"));
        assert_eq!(times.len(), run.track.len());
        let start = nodes[node]["translation"].as_array().unwrap();
        let start = start.iter().map(|value| value.as_f64().unwrap() as f32);
        assert_eq!(
            start.collect::<Vec<_>>(),
            places[0],
            "without animation it stands at its start"
        );
        for (k, pose) in poses.as_ref().unwrap().iter().enumerate() {
            assert!((f64::from(times[k][0]) - run.track.times_s()[k]).abs() < 1e-6);
            let near = |rows: &[f32], wanted: &[f64]| {
                let pairs = rows.iter().zip(wanted);
                pairs
                    .map(|(a, b)| (f64::from(*a) - b).abs())
                    .fold(0.0, f64::max)
            };
            assert!(near(&places[k], pose.translation.vector.as_slice()) < 1e-6);
            let dot: f64 = (turns[k].iter().zip(pose.rotation.coords.iter()))
                .map(|(a, b)| f64::from(*a) * b)
                .sum();
            assert!(dot.abs() > 1.0 - 1e-6);
            let before = &turns[k.saturating_sub(1)];
            let step: f32 = turns[k].iter().zip(before).map(|(a, b)| a * b).sum();
            assert!(step > 0.0, "the sign of an orientation flips");
        }
    }
    // Up is y: the world's z axis.
    let world = document["nodes"].as_array().unwrap().last().unwrap();
    let q = &world["rotation"];
    let q = [0, 1, 2, 3].map(|k| q[k].as_f64().unwrap());
    let turn = nalgebra::Quaternion::new(q[3], q[0], q[1], q[2]);
    let up = nalgebra::UnitQuaternion::new_normalize(turn) * nalgebra::Vector3::z();
    assert!((up - nalgebra::Vector3::y()).norm() < 1e-6, "{up}");
    assert_eq!(file, replay(&robot, &run, &recordings).gltf().unwrap());
}

#[test]
fn other_programs_load_the_model() {
    let Some(program) = python_with("trimesh, pygltflib") else {
        return;
    };
    let (robot, run) = run();
    let folder = tempfile::tempdir().unwrap();
    let file = replay(&robot, &run, &recordings()).gltf().unwrap();
    std::fs::write(folder.path().join("replay.glb"), file).unwrap();
    let script = "
import numpy as np, pygltflib, trimesh
model = pygltflib.GLTF2().load('replay.glb')
assert model.asset.version == '2.0' and len(model.animations) == 1
assert {c.target.path for c in model.animations[0].channels} == {'translation', 'rotation'}
scene = trimesh.load('replay.glb')
boxes = [g for g in scene.geometry.values() if isinstance(g, trimesh.Trimesh)]
assert boxes and all(b.is_watertight or len(b.vertices) == 24 for b in boxes)
# Outward faces: a unit cube turned inside out has a negative volume.
merged = boxes[0].copy(); merged.merge_vertices(merge_norm=True)
assert abs(abs(merged.volume) - 8) < 1e-6 and merged.volume > 0, merged.volume
";
    python(&program, folder.path(), script);
}

/// Every picture of an animated PNG file as it is shown, and how long each is, seconds.
fn pictures(file: &[u8]) -> (Vec<Vec<u8>>, usize, f64) {
    let mut reader = png::Decoder::new(std::io::Cursor::new(file))
        .read_info()
        .unwrap();
    let (width, height) = reader.info().size();
    let control = reader.info().animation_control.unwrap();
    assert_eq!(control.num_plays, 0, "it plays for ever");
    let mut shown = vec![0; 3 * width as usize * height as usize];
    let mut part = vec![0; reader.output_buffer_size().unwrap()];
    let (mut all, mut shown_s) = (Vec::new(), 0.0);
    for _ in 0..control.num_frames {
        reader.next_frame(&mut part).unwrap();
        let frame = *reader.info().frame_control().unwrap();
        shown_s = f64::from(frame.delay_num) / f64::from(frame.delay_den);
        let [left, top, wide] = [frame.x_offset, frame.y_offset, frame.width].map(|v| v as usize);
        for row in 0..frame.height as usize {
            for column in 0..wide {
                let to = 3 * ((top + row) * width as usize + left + column);
                let pixel = &part[4 * (row * wide + column)..][..4];
                // Transparent pixels are as they were.
                if pixel[3] == u8::MAX {
                    shown[to..to + 3].copy_from_slice(&pixel[..3]);
                }
            }
        }
        all.push(shown.clone());
    }
    (all, width as usize, shown_s)
}

/// The middle of the pixels of about this colour.
fn middle_of(
    picture: &[u8],
    width: usize,
    colour: [u8; 3],
    rows: std::ops::Range<usize>,
) -> Option<[f64; 2]> {
    let pixels = picture.chunks_exact(3).enumerate();
    let own = pixels.filter(|(index, pixel)| {
        rows.contains(&(index / width)) && pixel.iter().zip(colour).all(|(a, b)| a.abs_diff(b) < 6)
    });
    let places: Vec<[f64; 2]> = own
        .map(|(index, _)| [(index % width) as f64, (index / width) as f64])
        .collect();
    let count = places.len() as f64;
    let sum = |axis: usize| places.iter().map(|place| place[axis]).sum::<f64>();
    (!places.is_empty()).then(|| [sum(0) / count, sum(1) / count])
}

#[test]
fn an_animation_shows_the_robot_where_it_is_over_time() {
    let (robot, run) = run();
    let recordings = recordings();
    let file = replay(&robot, &run, &recordings).animation().unwrap();
    let (all, width, shown_s) = pictures(&file);
    assert_eq!((all.len(), shown_s), (longest_s(&run, &recordings), 0.1));
    let each = file.len() / all.len();
    assert!(each < 40_000, "{each} bytes a picture");
    let height = all[0].len() / 3 / width;
    // The plates of the robot are vermillion; above and below stand words.
    let plates = |picture: &[u8]| middle_of(picture, width, [213, 94, 0], 60..height - 50);
    let moved: Vec<[f64; 2]> = all.iter().filter_map(|picture| plates(picture)).collect();
    assert!(
        moved.len() > 10,
        "the plates are seen in {} pictures",
        moved.len()
    );
    let differs = all
        .windows(2)
        .take(20)
        .filter(|pair| pair[0] != pair[1])
        .count();
    assert_eq!(differs, 20, "pictures stand still");
    // What was recorded is green.
    assert!(middle_of(&all[3], width, [0, 138, 100], 60..height - 50).is_some());
    assert_eq!(file, replay(&robot, &run, &recordings).animation().unwrap());
}

/// Ten pictures a second, and the first.
fn longest_s(run: &Film, recordings: &[Recording]) -> usize {
    let recorded = recordings
        .iter()
        .map(|recording| recording.trajectory.duration_s());
    let longest_s = recorded.fold(run.track.duration_s(), f64::max);
    ((10.0 * longest_s + 1e-4).floor() as usize).min(239) + 1
}

#[test]
fn the_ending_of_the_file_says_what_a_replay_becomes() {
    let folder = tempfile::tempdir().unwrap();
    for (name, start) in [
        ("replay.mcap", &b"\x89MCAP0\r\n"[..]),
        ("replay.glb", b"glTF"),
        ("replay.png", b"\x89PNG"),
        ("replay.html", b"<!doctype html>"),
    ] {
        let file = folder.path().join(name);
        let mut command = realgap();
        command.args([
            "replay",
            "morphologies/tripod.ron",
            "--duration",
            "0.5",
            "-o",
        ]);
        command.arg(&file).assert().success();
        let bytes = std::fs::read(&file).unwrap();
        assert!(bytes[..start.len()].eq_ignore_ascii_case(start), "{name}");
    }
    let mut command = realgap();
    command.args(["replay", "morphologies/tripod.ron", "-o", "replay.mp4"]);
    let refused = command.assert().failure();
    let said = text(&refused.get_output().stderr);
    assert!(
        said.contains("replay.mp4") && said.contains(".glb"),
        "{said}"
    );
    let mut command = realgap();
    let simulated = folder.path().join("simulated.glb");
    command.args([
        "simulate",
        "morphologies/tripod.ron",
        "--duration",
        "0.2",
        "--replay",
    ]);
    command.arg(&simulated).assert().success();
    parts(&std::fs::read(&simulated).unwrap());
}

#[test]
fn a_recording_without_a_robot_is_a_point_that_moves() {
    let recordings = recordings();
    let film = Film {
        track: recordings[1].trajectory.clone(),
        parts: Vec::new(),
        scene: Vec::new(),
    };
    let alone = Replay {
        robot: None,
        run: &film,
        run_name: "run",
        recordings: &[],
        align: true,
        floor: Floor::default(),
        scene: &[],
        warnings: &[],
        provenance: &[],
    };
    let (document, bytes) = parts(&alone.gltf().unwrap());
    let animation = &document["animations"][0];
    let places = rows(&document, &bytes, &animation["samplers"][0]["output"]);
    let first: Isometry3<f32> = Isometry3::translation(places[0][0], places[0][1], places[0][2]);
    let wanted = film.track.positions_world_m()[0].cast::<f32>();
    assert!((first.translation.vector - wanted).norm() < 1e-6);
    assert!(alone.mcap().unwrap().len() > 1000);
}

#[test]
fn wheels_and_balls_are_shown_as_they_are_and_not_as_boxes() {
    let robot = Morphology::read(common::project().join("morphologies/turtlebot3_burger.ron"));
    let robot = robot.unwrap();
    let mut experiment = Experiment::new(robot.assemble());
    experiment.duration_s = 0.2;
    let run = film(&experiment).unwrap().1.unwrap();
    let shown = replay(&robot, &run, &[]);
    let (document, bytes) = parts(&shown.gltf().unwrap());
    let nodes = document["nodes"].as_array().unwrap();
    let count = |name: &str| nodes.iter().filter(|node| node["name"] == name).count();
    assert_eq!(
        (count("cylinder"), count("sphere"), count("box")),
        (3, 1, 1)
    );
    // Every corner of a wheel is as far from its axle as it is wide.
    let wheel = nodes
        .iter()
        .rfind(|node| node["name"] == "cylinder")
        .unwrap();
    let mesh = &document["meshes"][wheel["mesh"].as_u64().unwrap() as usize];
    let attributes = &mesh["primitives"][0]["attributes"];
    let corners = rows(&document, &bytes, &attributes["POSITION"]);
    let radius = |row: &Vec<f32>| f64::from(row[0].hypot(row[1]));
    assert!(corners.len() > 100 && corners.iter().all(|row| (radius(row) - 0.033).abs() < 1e-6));
    for normal in rows(&document, &bytes, &attributes["NORMAL"]) {
        let length = normal.iter().map(|v| v * v).sum::<f32>().sqrt();
        assert!((length - 1.0).abs() < 1e-5);
    }
    let page = shown.page().unwrap();
    let (_, scene) = page.split_once("id=\"scene-data\">").unwrap();
    let (scene, _) = scene.split_once("</script>").unwrap();
    let scene: Value = serde_json::from_str(scene).unwrap();
    let shapes = scene["boxes"].as_array().unwrap();
    let rounded = shapes.iter().filter(|shape| shape.get("corners").is_some());
    let rounded: Vec<&Value> = rounded.collect();
    assert_eq!((shapes.len(), rounded.len()), (5, 4));
    for shape in rounded {
        let corners = shape["corners"].as_array().unwrap().len() / 3;
        let triangles = shape["triangles"].as_array().unwrap();
        assert!(
            triangles
                .iter()
                .all(|corner| corner.as_u64().unwrap() < corners as u64)
        );
    }
}
