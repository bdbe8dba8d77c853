//! Tests of comparing folders of pictures: pairing by name, results, and errors.

use realgap_vision::{Answer, VisionOptions, compare_folders};

use crate::album::{VIEWS, folders, write};
use crate::drawing::grey;

#[test]
fn simulated_pictures_that_are_made_similar_are_nearer_than_badly_lit_ones() {
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
    // If the folders are swapped, the badly lit pictures are not nearer.
    let other = compare_folders(&bad, &real, Some(&simulated), &VisionOptions::default()).unwrap();
    assert_eq!(other.extractors[0].verdict.unwrap().answer, Answer::Farther);
}

#[test]
fn identical_pictures_have_no_gap_and_the_test_is_not_significant() {
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
fn unpaired_pictures_give_a_warning_and_folders_without_pairs_an_error() {
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
fn a_bad_list_of_views_gives_an_error_with_its_position() {
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
    assert!(twice.contains("listed twice"), "{twice}");
    let outside = refused("Views(template: \"../secret.png\")");
    assert!(outside.contains("template"), "{outside}");
}
