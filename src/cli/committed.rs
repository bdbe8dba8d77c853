//! Files of the repository that tests generate: they must equal what the program generates now.

use std::path::Path;

/// Compares a committed file with the generated text; with REALGAP_BLESS=1 the file is written.
pub fn must_hold(path: &str, text: &str, test: &str) {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    if std::env::var_os("REALGAP_BLESS").is_some_and(|value| value == "1") {
        std::fs::write(&file, text).unwrap_or_else(|error| panic!("{path}: {error}"));
    }
    let found = std::fs::read_to_string(&file).unwrap_or_default();
    assert!(
        found == text,
        "{path} is out of date; REALGAP_BLESS=1 cargo test {test} writes it"
    );
}
