//! Finished results are read where nothing can be written.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::path::Path;

use realgap_store::{Listing, STORE_FILE};

#[path = "../../crates/store/tests/finished.rs"]
mod finished;

use finished::{study, tamper};

/// `study results` lists so many lines from a folder that cannot be written, where the system lets a test make one.
fn read_only(folder: &Path, lines: usize) {
    let results = format!(
        "mount --bind '{0}' '{0}' && mount -o remount,ro,bind '{0}' || exit 77; exec '{1}' study results '{0}' --format csv",
        folder.display(),
        env!("CARGO_BIN_EXE_realgap")
    );
    let said = std::process::Command::new("unshare")
        .args(["--mount", "--map-root-user", "sh", "-c", &results])
        .output();
    match said {
        Ok(said) if said.status.code() != Some(77) => {
            let printed = String::from_utf8_lossy(&said.stdout);
            assert_eq!(printed.lines().count(), lines, "{said:?}");
        }
        refused => {
            use std::io::Write as _;
            let _ = writeln!(
                std::io::stderr(),
                "SKIPPED: nothing can be mounted here: {refused:?}"
            );
        }
    }
}

#[test]
fn a_finished_folder_holds_no_log_and_is_read_where_nothing_can_be_written() {
    let folder = tempfile::tempdir().unwrap();
    study(folder.path());
    let expected = Listing::read(folder.path()).unwrap();
    let names: Vec<String> = std::fs::read_dir(folder.path())
        .unwrap()
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .filter(|name| name.starts_with(STORE_FILE))
        .collect();
    assert_eq!(names, [STORE_FILE]);
    // The file alone, with a name that means something in a URI; once as it is left, once as a copy of an unfinished one.
    let media = tempfile::tempdir().unwrap();
    for (name, mode) in [("50 % of #1?", "DELETE"), ("log", "WAL")] {
        let place = media.path().join(name);
        std::fs::create_dir(&place).unwrap();
        std::fs::copy(folder.path().join(STORE_FILE), place.join(STORE_FILE)).unwrap();
        tamper(&place, &format!("PRAGMA journal_mode = {mode}"));
        read_only(&place, 1 + expected.rows.len());
    }
}
