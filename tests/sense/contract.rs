//! The error for an extractor whose program is not installed.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

#[test]
#[cfg(feature = "tesseract")]
fn a_program_that_is_not_installed_is_an_error_before_any_picture_is_read() {
    for args in [
        [
            "extract",
            "nowhere.png",
            "--extractor",
            "tesseract",
            "--view=a",
        ],
        [
            "compare",
            "nowhere",
            "elsewhere",
            "--extractor",
            "tesseract",
        ],
    ] {
        let mut command = crate::common::realgap();
        let done = command
            .args(["sense", "vision"])
            .args(args)
            .env("PATH", "")
            .output();
        let said = crate::common::text(&done.unwrap().stderr);
        for word in ["tesseract is not installed", "apt install", "leave out"] {
            assert!(said.contains(word), "{word} is missing in {said}");
        }
    }
}
