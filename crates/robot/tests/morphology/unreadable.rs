//! Tests that unreadable files and malformed text are refused with one clear error.

use realgap_core::ErrorKind;
use realgap_core::file::{MAX_FILE_BYTES, Source};
use realgap_robot::morphology::Morphology;

#[test]
fn a_missing_file_is_named() {
    let error = Morphology::read("no/such/robot.ron").unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Io);
    let text = error.to_string();
    assert!(
        text.starts_with("no/such/robot.ron: cannot read the morphology"),
        "{text}"
    );
    assert!(text.contains("check the path"), "{text}");
}

#[test]
fn a_folder_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let error = Morphology::read(folder.path()).unwrap_err();
    assert!(error.message().contains("this is a folder"), "{error}");
}

#[test]
fn an_endless_file_is_refused_after_a_megabyte() {
    let endless = std::path::Path::new("/dev/zero");
    if endless.exists() {
        let error = Morphology::read(endless).unwrap_err();
        assert!(error.message().contains("too large"), "{error}");
    }
}

#[test]
fn a_large_file_is_refused_and_the_largest_allowed_one_is_read() {
    let limit = usize::try_from(MAX_FILE_BYTES).unwrap();
    assert!(Source::from_bytes("x.ron", vec![b' '; limit], "study").is_ok());
    let error = Source::from_bytes("x.ron", vec![b' '; limit + 1], "study").unwrap_err();
    insta::assert_snapshot!(error, @r"
    x.ron: cannot read the study: the file is too large
      found:   more than 1000000 bytes
      allowed: at most 1000000 bytes
      hint:    is this really a study file?
    ");
}

#[test]
fn text_that_is_not_utf8_is_located() {
    let error =
        Source::from_bytes("x.ron", b"(\n  name: \"B\xf6b\")".to_vec(), "study").unwrap_err();
    insta::assert_snapshot!(error, @r"
    x.ron:2:11: cannot read the study: the file is not UTF-8 text
      found:   the byte 0xf6
      hint:    save it as UTF-8 in a text editor
    ");
}

#[test]
fn values_are_located_behind_comments_and_strings() {
    let text = "// glue: [(1)]\n#![enable(implicit_some)]\n(\n  name: \"a, (b: \\\" [\", /* list: [ /* ) */ */\n  \
                raw: r#\"\"(\"#,\n  list: [Some((x: 'c', y: 1)), (y: -2.5e-3)],\n  map: {\"k\": [0, 1]},\n)";
    let source = Source::new("x.ron", text);
    assert_eq!(source.locate("name"), Some((4, 9)));
    assert_eq!(source.locate("list[0][0].y"), Some((6, 27)));
    assert_eq!(source.locate("list[1].y"), Some((6, 36)));
    assert_eq!(source.locate("map.k[1]"), Some((7, 18)));
    // A field that is left out is located at the value that should contain it.
    assert_eq!(source.locate("list[1].z.deeper"), Some((6, 32)));
    assert_eq!(source.locate("lis"), None);
}

#[test]
fn the_hash_is_the_sha256_of_the_text() {
    assert_eq!(
        Source::new("x", "abc").sha256(),
        "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
    );
}

#[test]
fn a_byte_order_mark_is_not_part_of_the_text() {
    let source = Source::from_bytes("x.ron", b"\xef\xbb\xbf(a: 1)".to_vec(), "study").unwrap();
    assert_eq!(source.locate("a"), Some((1, 5)));
}

fn refusal(text: &str) -> String {
    let source = Source::new("robot.ron", text);
    Morphology::parse(&source).unwrap_err().to_string()
}

#[test]
fn deep_nesting_is_refused_before_the_stack_overflows() {
    for open in ["(", "[", "{", "(a:", "Some(", "[(", "{1:"] {
        let text = open.repeat(100_000);
        assert!(refusal(&text).contains("nested too deeply"), "{open}");
    }
    insta::assert_snapshot!(refusal(&format!("(name: {}", "[".repeat(1000))), @r"
    robot.ron:1:39: nested too deeply
      allowed: at most 32 brackets open at once
      hint:    look for a bracket that is never closed
    ");
    // Comments nest without limit in RON, and cost no stack here.
    assert!(refusal(&"/*".repeat(100_000)).contains("the comment never ends"));
}
