//! Tests of recognising text: clean, rotated, of other sizes, with noise; and of the error rate.

use std::sync::Arc;

use rand::RngExt;
use realgap_core::random::Numbered;
use realgap_vision::{
    Alphabet, Extractor, Grey, Script, Sought, character_error_rate, edit_distance, print_text,
};

const LETTERS: &str =
    "ABCDEFGHIJKLM\nNOPQRSTUVWXYZ\nabcdefghijklm\nnopqrstuvwxyz\n0123456789\nH.,:-+?!/=";
const TEXT: &str = "The quick brown fox jumps\nOVER 13 LAZY DOGS, 24.\nPack my box: 5 dozen\nliquor jugs + 6780-9?";

fn sought() -> Sought {
    let picture = print_text(LETTERS, 48.0, 0.1).unwrap();
    Sought {
        alphabet: Some(Arc::new(Alphabet::learn(&picture, LETTERS).unwrap())),
        text: Some(TEXT.to_owned()),
        ..Sought::default()
    }
}

/// The error rate and the text.
fn read(picture: &Grey, sought: &Sought) -> (f64, String) {
    let found = Script::PAPER.extract(picture, sought).unwrap();
    let rate = Script::PAPER.error(&found.feature, sought).unwrap();
    (rate, found.feature.text.unwrap())
}

/// At 20 pixels to the em, the narrow space before a `j` is not wider than the gap after a `1`.
#[test]
fn clean_text_is_read_without_an_error_from_24_pixels_to_the_em_on() {
    let sought = sought();
    let edits = |size_px: f64| {
        let (rate, text) = read(&print_text(TEXT, size_px, 0.1).unwrap(), &sought);
        println!("{size_px} px: error rate {rate:.3}");
        ((rate * TEXT.chars().count() as f64).round(), text)
    };
    for size_px in [24.0, 27.0, 32.0, 40.0, 48.0, 77.0] {
        let (count, text) = edits(size_px);
        assert_eq!(count, 0.0, "{size_px} px:\n{text}");
    }
    assert!(edits(20.0).0 <= 1.0);
}

#[test]
fn rotated_text_is_straightened() {
    let sought = sought();
    let page = print_text(TEXT, 40.0, 0.1).unwrap();
    for angle_deg in [-9.0_f64, -3.3, 1.7, 6.0] {
        let (rate, text) = read(&page.turned(angle_deg.to_radians(), 1.0), &sought);
        println!("turned by {angle_deg} degrees: error rate {rate:.3}");
        assert!(rate <= 0.05, "{angle_deg}: {rate}\n{text}");
    }
}

#[test]
fn text_is_read_at_any_brightness_and_with_noise() {
    let sought = sought();
    let page = print_text(TEXT, 40.0, 0.1).unwrap();
    let dim = |low: f32, high: f32| {
        let values = page
            .values()
            .iter()
            .map(|v| low + (high - low) * v)
            .collect();
        Grey::new(page.width(), page.height(), values).unwrap()
    };
    assert_eq!(read(&dim(0.1, 0.3), &sought).0, 0.0);
    assert_eq!(read(&dim(0.6, 0.9), &sought).0, 0.0);
    let mut rng = Numbered::SensorReading.generator(1, 0);
    let mut values = page.values().to_vec();
    for _ in 0..300 {
        let place = rng.random_range(0..values.len());
        values[place] = 0.0;
    }
    let spotted = Grey::new(page.width(), page.height(), values).unwrap();
    let rate = read(&spotted, &sought).0;
    println!("with 300 spots: error rate {rate:.3}");
    assert!(rate <= 0.05, "{rate}");
}

#[test]
fn an_empty_or_very_small_page_has_no_text_and_is_not_an_error() {
    let sought = sought();
    for page in [
        print_text(" ", 40.0, 0.0).unwrap(),
        crate::drawing::grey(1, 1, |_, _| 0.5),
    ] {
        let (rate, text) = read(&page, &sought);
        assert_eq!((rate, text.as_str()), (1.0, ""));
    }
}

#[test]
fn the_error_rate_counts_edits_per_character_of_the_truth() {
    assert_eq!(edit_distance("", "abc"), 3);
    assert_eq!(edit_distance("flaw", "lawn"), 2);
    assert_eq!(character_error_rate("GATE 7", " GATE  7\n\n"), 0.0);
    assert_eq!(character_error_rate("GATE", "GATE 7777"), 5.0 / 9.0);
    assert_eq!(character_error_rate("xxxxxxxx", "ab"), 4.0);
}

#[test]
fn a_learning_picture_that_does_not_fit_its_text_is_refused() {
    let picture = print_text("ABC\nDEF", 48.0, 0.1).unwrap();
    let refused = |text: &str| Alphabet::learn(&picture, text).unwrap_err().to_string();
    assert!(refused("ABC").contains("number of rows"));
    let glyphs = refused("ABC\nDE");
    assert!(glyphs.contains("glyphs of row 2"), "{glyphs}");
    assert!(refused("").contains("number of rows"));
}
