//! The contract test: properties that every extractor of the registry must have.

use std::collections::BTreeSet;
use std::sync::Arc;

use realgap_vision::{
    Alphabet, EXTRACTORS, Extractor, Feature, Grey, Sought, extractor_by_name, own_extractors,
    print_text,
};

#[cfg(feature = "tesseract")]
use realgap_vision::{VisionOptions, compare_folders};

use crate::common;
use crate::drawing::{around, ellipse, grey};

const LETTERS: &str = "ABCDEFGHIJKLM\nNOPQRSTUVWXYZ\n0123456789";
const DISC: [f64; 4] = [90.0, 160.0, 40.0, 40.0];
const SIGN: [usize; 2] = [170, 120];

/// All extractors except those whose program is not installed; prints which are left out.
fn usable() -> Vec<&'static dyn Extractor> {
    let is_usable = |extractor: &&dyn Extractor| match extractor.program().map(|p| p.version()) {
        Some(Err(error)) => {
            common::skipped(&format!("the extractor {}: {error}", extractor.name()));
            false
        }
        _ => true,
    };
    EXTRACTORS.iter().copied().filter(is_usable).collect()
}

/// A disc, a sign and a line of text, and where they are.
fn scene() -> (Grey, Sought) {
    let disc = ellipse(320, 240, DISC, 0.2, 0.85);
    let text = print_text("ROOM 42", 30.0, 0.1).unwrap();
    let sign = grey(48, 40, |x, y| {
        if (x / 8 + y / 10) % 2 == 0 || x > 2 * y {
            0.1
        } else {
            0.7
        }
    });
    let picture = grey(320, 240, |x, y| {
        let mut value = disc.at(x as i64, y as i64);
        if x >= SIGN[0] && y >= SIGN[1] && x < SIGN[0] + 48 && y < SIGN[1] + 40 {
            value = sign.at((x - SIGN[0]) as i64, (y - SIGN[1]) as i64);
        }
        if x >= 20 && y >= 10 && x < 20 + text.width() && y < 10 + text.height() {
            value *= text.at(x as i64 - 20, y as i64 - 10);
        }
        value
    });
    let alphabet = Alphabet::learn(&print_text(LETTERS, 48.0, 0.1).unwrap(), LETTERS).unwrap();
    let sought = Sought {
        template: Some(Arc::new(sign)),
        template_at_px: Some([SIGN[0] as f64 + 23.5, SIGN[1] as f64 + 19.5]),
        start_px: around(DISC, 1.3, 40),
        outline_px: around(DISC, 1.0, 400),
        text_region: Some(realgap_vision::Region {
            x_px: 20,
            y_px: 10,
            width_px: text.width(),
            height_px: text.height(),
        }),
        text: Some("ROOM 42".to_owned()),
        alphabet: Some(Arc::new(alphabet)),
    };
    (picture, sought)
}

/// The same scene with less light, with noise, and displaced by one pixel to the right.
fn worse(picture: &Grey) -> Grey {
    grey(picture.width(), picture.height(), |x, y| {
        let noise = ((x * 7919 + y * 104_729 + x * y * 31) % 101) as f32 / 101.0 - 0.5;
        0.05 + 0.3 * picture.at(x as i64 - 1, y as i64) + 0.05 * noise
    })
}

#[test]
fn every_extractor_has_a_unique_name_by_which_it_is_found() {
    let names: BTreeSet<&str> = EXTRACTORS.iter().map(|e| e.name()).collect();
    assert_eq!(names.len(), EXTRACTORS.len());
    for extractor in EXTRACTORS {
        let found = extractor_by_name(extractor.name()).unwrap();
        assert_eq!(found.name(), extractor.name());
        assert!(!extractor.doc().is_empty() && (5..=11).contains(&extractor.figure()));
    }
    assert!(extractor_by_name("edgs").is_err());
}

#[test]
fn an_extractor_that_calls_another_program_is_used_only_if_it_is_named() {
    let own: Vec<&str> = own_extractors().iter().map(|e| e.name()).collect();
    assert_eq!(own, ["edges", "template", "contour", "text"]);
    match extractor_by_name("tesseract") {
        Ok(extractor) => assert!(cfg!(feature = "tesseract") && extractor.program().is_some()),
        Err(error) => assert!(
            error.to_string().contains("--features tesseract"),
            "{error}"
        ),
    }
}

#[test]
fn every_extractor_finds_its_feature_and_shows_its_steps() {
    let (picture, sought) = scene();
    for extractor in usable() {
        assert!(extractor.is_sought(&sought), "{}", extractor.name());
        let found = extractor.extract(&picture, &sought).unwrap();
        // An extractor that calls another program shows only the picture that the program receives.
        let fewest = if extractor.program().is_some() { 1 } else { 4 };
        assert!(found.steps.len() >= fewest, "{}", extractor.name());
        for step in &found.steps {
            let is_shown = step.picture.values().iter().all(|v| v.is_finite());
            assert!(is_shown && !step.name.is_empty(), "{}", step.name);
        }
        let error = extractor.error(&found.feature, &sought);
        assert_eq!(error.is_some(), extractor.error_measure().is_some());
        let most = match extractor.name() {
            "template" => 0.5,
            "contour" => 1.5,
            _ => 0.0,
        };
        println!("{}: {error:?}; {:?}", extractor.name(), found.remarks);
        assert!(
            error.is_none_or(|e| e <= most),
            "{}: {error:?}",
            extractor.name()
        );
    }
}

#[test]
fn a_distance_is_0_for_equal_features_symmetric_and_above_0_for_different_ones() {
    let (picture, sought) = scene();
    let blank = grey(320, 240, |x, _| 0.3 + 0.001 * x as f32);
    for extractor in usable() {
        let of = |picture: &Grey| extractor.extract(picture, &sought).unwrap().feature;
        let (a, b, none) = (of(&picture), of(&worse(&picture)), of(&blank));
        assert_eq!(
            extractor.distance(&a, &a),
            Some(0.0),
            "{}",
            extractor.name()
        );
        let (there, back) = (extractor.distance(&a, &b), extractor.distance(&b, &a));
        assert!(
            (there.unwrap() - back.unwrap()).abs() < 1e-12,
            "{}",
            extractor.name()
        );
        let far = extractor.distance(&a, &none).unwrap();
        println!("{}: worse {there:?}, blank {far}", extractor.name());
        assert!(
            far > there.unwrap(),
            "{}: {far} {there:?}",
            extractor.name()
        );
        assert_eq!(extractor.distance(&a, &Feature::default()), None);
    }
}

#[test]
fn an_extractor_without_anything_to_search_for_gives_an_error() {
    let (picture, _) = scene();
    let nothing = Sought::default();
    for extractor in EXTRACTORS {
        let extracted = extractor.extract(&picture, &nothing);
        assert_eq!(
            extracted.is_ok(),
            extractor.is_sought(&nothing),
            "{}",
            extractor.name()
        );
        if let Err(error) = extracted {
            assert!(error.to_string().contains("there is no"), "{error}");
        }
    }
}

/// Compares a folder of pictures with itself; the report states the version of the program.
#[test]
#[cfg(feature = "tesseract")]
fn the_report_of_an_extractor_that_calls_another_program_states_its_version() {
    let named = extractor_by_name("tesseract").unwrap();
    if !usable().iter().any(|e| e.name() == named.name()) {
        return;
    }
    let (picture, sought) = scene();
    let folder = tempfile::tempdir().unwrap();
    for k in 0..6 {
        let path = folder.path().join(format!("door{k}.png"));
        picture.picture().write_png(path).unwrap();
    }
    let region = sought.text_region.unwrap();
    let views = (0..6).map(|k| {
        format!(
            "(name: \"door{k}\", text: \"ROOM 43\", text_region: (x_px: 20, y_px: 10, width_px: {}, height_px: {})),",
            region.width_px, region.height_px
        )
    });
    let views = format!("Views(views: [{}])", views.collect::<String>());
    std::fs::write(folder.path().join("views.ron"), views).unwrap();
    let compared = |extractors: Vec<&'static dyn Extractor>| {
        let options = VisionOptions {
            extractors,
            ..VisionOptions::default()
        };
        compare_folders(folder.path(), folder.path(), None, &options).unwrap()
    };
    let report = compared(vec![named]);
    let [only] = &report.extractors[..] else {
        panic!("{report}");
    };
    assert!(only.program.as_ref().unwrap().starts_with("tesseract "));
    assert!((only.simulated_error.unwrap().value - 1.0 / 7.0).abs() < 1e-12);
    assert_eq!(only.gap.unwrap().value, 0.0);
    assert!(report.to_string().contains("installed program tesseract"));
    let report = compared(own_extractors());
    assert!(report.extractors.iter().all(|e| e.program.is_none()));
}
