//! Measures the cost of rendering pictures, of extracting features, and of radio models.
//!
//! `cargo bench --bench vision`; compare ratios, because absolute times differ between machines.

#![allow(
    clippy::expect_used,
    reason = "settings are sound, and a benchmark has no user to report an error to"
)]

use std::hint::black_box;
use std::sync::Arc;

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion, criterion_group, criterion_main};
use realgap::file::Source;
use realgap::sensing::arena::Arena;
use realgap::sensing::radio::{
    Link, LogBase, Message, RadioLog, RadioLogOptions, RadioModel, RadioOptions, Service,
    ServiceOptions, ShadowField, fit,
};
use realgap::vision::camera::{ALPHABET_TEXT, Motif, Scene, alphabet_picture, known, take};
use realgap::vision::{Alphabet, Sought, own_extractors};

fn room(more: &str) -> Scene {
    let text = std::fs::read_to_string("scenes/room.ron").expect("a shipped scene");
    let text = text.replacen("blocks: [", &format!("blocks: [{more}"), 1);
    Scene::parse(&Source::new("room.ron", text)).expect("a sound scene")
}

/// The shipped scene with ninety more cubes.
fn crowd() -> Scene {
    let cube = |k: usize| {
        let at = |step: usize, from: f64, size: f64| from + size * (k * step % 100) as f64 / 100.0;
        format!(
            "(centre_m: ({:.2}, {:.2}, {:.2}), half_m: (0.08, 0.08, 0.08), turn_deg: {}),",
            at(37, 0.3, 5.4),
            at(61, 1.8, 2.8),
            at(23, 0.1, 2.5),
            k
        )
    };
    room(&(0..90).map(cube).collect::<String>())
}

fn one_thread() -> rayon::ThreadPool {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    pool.expect("one thread")
}

fn pictures(criterion: &mut Criterion) {
    let scene = crowd();
    let (camera, light) = (scene.camera("model"), scene.light("well"));
    let (camera, light) = (camera.expect("named"), light.expect("named"));
    let pool = one_thread();
    let mut group = criterion.benchmark_group("camera");
    group.sample_size(10);
    group.bench_function("640 x 480 pixels, 100 things, one thread", |b| {
        pool.install(|| {
            b.iter(|| {
                let taken = take(&scene, camera, &scene.views[1], light, 1, 0);
                black_box(taken.expect("a sound picture"))
            });
        });
    });
    group.finish();
}

/// Measures every extractor on one picture of the shipped scene.
fn extractors(criterion: &mut Criterion) {
    let scene = room("");
    let (camera, light) = (scene.camera("model"), scene.light("well"));
    let (camera, light) = (camera.expect("named"), light.expect("named"));
    let view = &scene.views[1];
    let (picture, pose) = take(&scene, camera, view, light, 1, 0).expect("a sound picture");
    let picture = picture.grey();
    let of = known(&scene, camera, &pose, &view.name);
    let points = |of: &[(f64, f64)]| of.iter().map(|(x, y)| [*x, *y]).collect();
    let alphabet = alphabet_picture().expect("a learning picture");
    let sought = Sought {
        template: Some(Arc::new(
            Motif::Logo.picture().expect("a logo").resized(96, 96),
        )),
        template_at_px: of.template_at_px.map(|(x, y)| [x, y]),
        start_px: points(&of.start_px),
        outline_px: points(&of.outline_px),
        text_region: of.text_region,
        text: of.text,
        alphabet: Some(Arc::new(
            Alphabet::learn(&alphabet, ALPHABET_TEXT).expect("letters"),
        )),
    };
    let pool = one_thread();
    let mut group = criterion.benchmark_group("extractors, 640 x 480 pixels, one thread");
    group.sample_size(10);
    for extractor in own_extractors() {
        group.bench_function(extractor.name(), |b| {
            pool.install(|| {
                b.iter(|| {
                    let found = extractor.extract(&picture, &sought);
                    black_box(found.expect("something to find"))
                });
            });
        });
    }
    group.finish();
}

/// Measures the fit of as many strengths as in a session of the real flat, on a path through all of its rooms.
fn radio(criterion: &mut Criterion) {
    let arena = Arena::read("arenas/flat.ron").expect("a shipped arena");
    let truth = RadioModel {
        values: vec![-42.0, 1.9, 6.0],
        reference_distance_m: 1.0,
        log_base: LogBase::Ten,
        robot_height_m: 0.3,
        ..RadioModel::paper002()
    };
    let field = ShadowField::new(1, 0.9);
    let header: Vec<String> = arena
        .anchors
        .iter()
        .map(|anchor| format!("anchor_{}_dbm", anchor.name))
        .collect();
    let mut text = format!("x_m,y_m,{}\n", header.join(","));
    for k in 0..1500 {
        let turn = 0.05 * f64::from(k);
        let at_m = [4.5 + 4.2 * turn.sin(), 3.5 + 3.3 * (0.37 * turn).cos()];
        text += &format!("{},{}", at_m[0], at_m[1]);
        for anchor in &arena.anchors {
            let [x, y, _] = anchor.position_m;
            let link = Link::new(&arena, truth.robot_at(at_m), anchor.position_m);
            let dbm = truth.strength_dbm(&link) + 3.0 * field.at([x, y], at_m);
            text += &format!(",{dbm}");
        }
        text += "\n";
    }
    let log = RadioLog::parse_with("log.csv", &text, &RadioLogOptions::default());
    let log = log.expect("a sound log");
    let pool = one_thread();
    let mut group = criterion.benchmark_group("radio, one thread");
    group.sample_size(10);
    group.bench_function("a fit of 9000 strengths, every model", |b| {
        pool.install(|| {
            b.iter(|| {
                let found = fit(&log, &arena, &arena.anchors, &RadioOptions::default());
                black_box(found.expect("a fit"))
            });
        });
    });
    group.bench_function("a shadow", |b| {
        b.iter(|| black_box(field.at(black_box([1.0, 2.0]), black_box([3.0, 4.0]))));
    });
    messages(&mut group, &arena, &truth);
    group.finish();
}

/// Measures one message between positions without a cached pair, and one between positions with a cached pair.
fn messages(group: &mut BenchmarkGroup<'_, WallTime>, arena: &Arena, model: &RadioModel) {
    let service = Service::new(model, arena, ServiceOptions::default());
    let service = service.expect("sound options");
    let mut number = 0;
    let mut message = |is_new: bool| {
        number += 1;
        // A different height is a different position.
        let height_m = if is_new { 1e-9 * number as f64 } else { 0.3 };
        Message {
            number,
            from_m: [1.0, 1.0, height_m],
            to_m: [7.0, 6.0, 0.3],
            at_s: 0.0,
        }
    };
    for (name, is_new) in [("new places", true), ("known places", false)] {
        group.bench_function(format!("a message between {name}"), |b| {
            b.iter(|| black_box(service.send(&message(is_new))));
        });
    }
}

criterion_group!(benches, pictures, extractors, radio);
criterion_main!(benches);
