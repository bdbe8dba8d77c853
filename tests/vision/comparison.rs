//! Folders of pictures: which belong together, what is said of them, and what is refused.

use std::path::Path;

use rand::RngExt;
use realgap::random::Numbered;
use realgap::sensing::vision::{
    Answer, Grey, PictureSource, ViewFile, ViewsFile, VisionOptions, compare_folders,
};

use crate::{around, common, ellipse, grey};

const VIEWS: usize = 7;

/// A disc that is elsewhere in every view.
fn disc(view: usize) -> [f64; 4] {
    [60.0 + 4.0 * view as f64, 55.0 - view as f64, 26.0, 24.0]
}

/// A view in some light, with noise.
fn picture(view: usize, light: (f32, f32), noise: f32, seed: u64) -> Grey {
    let clean = ellipse(150, 110, disc(view), 0.15, 0.8);
    let mut rng = Numbered::SensorReading.generator(seed, view as u64);
    let mut values = Vec::new();
    for v in clean.values() {
        let n: f32 = rng.random_range(-1.0..1.0);
        values.push(light.0 + light.1 * v + noise * n);
    }
    Grey::new(150, 110, values).unwrap()
}

fn write(folder: &Path, name: &str, picture: &Grey) {
    std::fs::create_dir_all(folder).unwrap();
    let file = folder.join(format!("{name}.png"));
    picture.picture().write_png(file).unwrap();
}

/// Simulated, real (twice a view) and badly lit pictures.
fn folders(root: &Path) -> [std::path::PathBuf; 3] {
    let [simulated, real, bad] = ["simulated", "real", "bad"].map(|name| root.join(name));
    let mut views = Vec::new();
    for view in 0..VIEWS {
        let name = format!("view{view}");
        write(&simulated, &name, &picture(view, (0.0, 1.0), 0.01, 1));
        for repeat in 1..=2 {
            let its = picture(view, (0.02, 0.95), 0.02, 10 + repeat);
            write(&real, &format!("{name}_{repeat}"), &its);
        }
        write(&bad, &name, &picture(view, (0.1, 0.07), 0.09, 20));
        let points = |points: Vec<[f64; 2]>| points.into_iter().map(|p| (p[0], p[1])).collect();
        views.push(ViewFile {
            name,
            start_px: points(around(disc(view), 1.3, 40)),
            outline_px: points(around(disc(view), 1.0, 200)),
            ..ViewFile::default()
        });
    }
    let file = ViewsFile {
        source: PictureSource::Simulated,
        views,
        ..ViewsFile::default()
    };
    file.write(&simulated).unwrap();
    [simulated, real, bad]
}

#[test]
fn a_simulated_picture_is_nearer_than_a_badly_lit_one_where_it_is_made_so() {
    let root = tempfile::tempdir().unwrap();
    let [simulated, real, bad] = folders(root.path());
    let report = compare_folders(&simulated, &real, Some(&bad), &VisionOptions::default()).unwrap();
    println!("{report}");
    assert_eq!(report.views.len(), VIEWS);
    let names: Vec<&str> = report.extractors.iter().map(|e| e.extractor).collect();
    assert_eq!(names, ["edges", "contour"]);
    for extractor in &report.extractors {
        let verdict = extractor.verdict.unwrap();
        assert_eq!(verdict.answer, Answer::Nearer, "{}", extractor.extractor);
        assert_eq!(verdict.views, VIEWS);
        let gap = extractor.gap.unwrap();
        let (low, high) = gap.interval.unwrap();
        assert!(low <= gap.value && gap.value <= high);
        assert!(extractor.floor.unwrap().value > 0.0);
        assert!(extractor.gap_ratio.unwrap() > 0.0);
    }
    // The same folders the other way round: what is badly lit is no nearer.
    let other = compare_folders(&bad, &real, Some(&simulated), &VisionOptions::default()).unwrap();
    assert_eq!(other.extractors[0].verdict.unwrap().answer, Answer::Farther);
}

#[test]
fn the_same_pictures_have_no_gap_and_leave_the_question_open() {
    let root = tempfile::tempdir().unwrap();
    let [simulated, ..] = folders(root.path());
    let report = compare_folders(
        &simulated,
        &simulated,
        Some(&simulated),
        &VisionOptions::default(),
    )
    .unwrap();
    for extractor in &report.extractors {
        assert_eq!(extractor.gap.unwrap().value, 0.0);
        let verdict = extractor.verdict.unwrap();
        assert_eq!((verdict.answer, verdict.test.p_value), (Answer::Open, 1.0));
        assert_eq!(verdict.equal, VIEWS);
    }
}

#[test]
fn pictures_without_a_partner_are_named_and_none_at_all_is_an_error() {
    let root = tempfile::tempdir().unwrap();
    let [simulated, real, bad] = folders(root.path());
    std::fs::remove_file(bad.join("view3.png")).unwrap();
    let report = compare_folders(&simulated, &real, Some(&bad), &VisionOptions::default()).unwrap();
    assert_eq!(report.views.len(), VIEWS - 1);
    let warned = report
        .warnings
        .iter()
        .any(|w| w.code.name() == "pictures-unpaired" && w.message.contains("view3"));
    assert!(warned, "{:?}", report.warnings);
    let other = root.path().join("other");
    write(&other, "kitchen", &grey(150, 110, |_, _| 0.5));
    let error = compare_folders(&simulated, &other, None, &VisionOptions::default())
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("kitchen") && error.contains("view0"),
        "{error}"
    );
    let empty = root.path().join("empty");
    std::fs::create_dir(&empty).unwrap();
    let error = compare_folders(&simulated, &empty, None, &VisionOptions::default())
        .unwrap_err()
        .to_string();
    assert!(error.contains("there are no pictures"), "{error}");
}

#[test]
fn pictures_of_one_view_with_different_sizes_are_refused() {
    let root = tempfile::tempdir().unwrap();
    let [simulated, real, _] = folders(root.path());
    write(&real, "view2_1", &grey(80, 60, |_, _| 0.5));
    let error = compare_folders(&simulated, &real, None, &VisionOptions::default())
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("view2_1.png") && error.contains("80 x 60 px"),
        "{error}"
    );
}

#[test]
fn a_list_of_views_that_is_wrong_says_where() {
    let root = tempfile::tempdir().unwrap();
    let [simulated, real, _] = folders(root.path());
    let refused = |text: &str| {
        std::fs::write(simulated.join("views.ron"), text).unwrap();
        compare_folders(&simulated, &real, None, &VisionOptions::default())
            .unwrap_err()
            .to_string()
    };
    let unknown = refused("Views(\n  view: [],\n)");
    assert!(
        unknown.contains("views.ron:2") && unknown.contains("did you mean"),
        "{unknown}"
    );
    let twice = refused("Views(views: [(name: \"a\"), (name: \"a\")])");
    assert!(twice.contains("stands twice"), "{twice}");
    let outside = refused("Views(template: \"../secret.png\")");
    assert!(outside.contains("template"), "{outside}");
}

#[test]
fn the_command_prints_a_table_json_and_pictures() {
    let root = tempfile::tempdir().unwrap();
    let [simulated, real, bad] = folders(root.path());
    let out = root.path().join("out");
    let run = |more: &[&str]| {
        let mut command = common::realgap();
        command
            .args(["vision", "compare"])
            .arg(&simulated)
            .arg(&real);
        let done = command
            .arg("--badly-lit")
            .arg(&bad)
            .args(more)
            .output()
            .unwrap();
        assert!(done.status.success(), "{}", common::text(&done.stderr));
        common::text(&done.stdout)
    };
    let table = run(&["--views", "-o", out.to_str().unwrap()]);
    assert!(table.contains("Is a simulated picture nearer"), "{table}");
    assert!(table.contains("contour (figure 8)"), "{table}");
    for name in ["edges.png", "contour.png"] {
        let drawn = Grey::read(out.join(name)).unwrap();
        assert!(drawn.width() > 500, "{name}");
    }
    let json = common::schema::answer("vision-compare", &run(&["--format", "json"]));
    assert_eq!(json["extractors"][0]["verdict"]["answer"], "nearer");
    let sheet = root.path().join("steps.png");
    let done = common::realgap()
        .args(["vision", "extract", "--extractor", "contour", "-o"])
        .arg(&sheet)
        .arg(simulated.join("view1.png"))
        .output()
        .unwrap();
    assert!(done.status.success(), "{}", common::text(&done.stderr));
    assert!(common::text(&done.stdout).contains("mean snake distance"));
    assert!(Grey::read(sheet).unwrap().width() > 600);
}
