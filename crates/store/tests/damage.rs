//! A store keeps what was written or says that it cannot: damage, other versions, media that cannot be written.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::path::Path;

use crate::finished::{fingerprint, search, study, tamper, trial};
use rand::{Rng, RngExt};
use realgap_core::random::Numbered;
use realgap_store::{Fingerprint, Listing, Mode, RobotRow, STORE_FILE, Store, Trial, TrialScore};

/// Everything that a store says: what `results` lists, and what a run goes on with.
#[derive(Debug, PartialEq)]
struct Answer {
    listing: Listing,
    trials: Vec<Trial>,
    scores: Vec<TrialScore>,
    robots: Vec<RobotRow>,
}

fn answer(folder: &Path) -> realgap_core::Result<Answer> {
    let listing = Listing::read(folder)?;
    let mut answer = Answer {
        listing,
        trials: Vec::new(),
        scores: Vec::new(),
        robots: Vec::new(),
    };
    if Store::<RobotRow>::is_in(folder)? {
        answer.robots = Store::<RobotRow>::resume(folder, &fingerprint())?.rows()?;
    } else {
        let store = Store::<Trial>::resume(folder, &fingerprint())?;
        answer.trials = store.trials()?;
        answer.scores = store.scores()?;
    }
    Ok(answer)
}

/// Size of SQLite's pages.
const PAGE: usize = 4096;

/// Damages one random page, as a disk or a copy does.
fn damage(bytes: &mut [u8], rng: &mut dyn Rng) {
    let pages = bytes.len() / PAGE;
    let page = rng.random_range(0..pages) * PAGE;
    let place = page + rng.random_range(0..PAGE);
    match rng.random_range(0..5) {
        0 => rng.fill_bytes(&mut bytes[page..page + PAGE]),
        1 => bytes[page..page + PAGE].fill(0),
        2 => {
            let other = rng.random_range(0..pages) * PAGE;
            bytes.copy_within(other..other + PAGE, page);
        }
        3 => bytes[place] ^= 1 << rng.random_range(0..8),
        _ => {
            let end = (place + 64).min(page + PAGE);
            rng.fill_bytes(&mut bytes[place..end]);
        }
    }
}

/// Damages a store so many times: every time it is refused, or says what it said before.
fn survive(write: fn(&Path), times: u64) {
    let whole = tempfile::tempdir().unwrap();
    write(whole.path());
    let bytes = std::fs::read(whole.path().join(STORE_FILE)).unwrap();
    let expected = answer(whole.path()).unwrap();
    let mut refused = 0;
    for seed in 0..times {
        let mut rng = Numbered::SearchStep.generator(seed, 0);
        let mut damaged = bytes.clone();
        damage(&mut damaged, &mut rng);
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join(STORE_FILE), damaged).unwrap();
        match answer(folder.path()) {
            Err(_) => refused += 1,
            Ok(said) => assert_eq!(said, expected, "silently different with seed {seed}"),
        }
    }
    assert!(2 * refused > times, "{refused} of {times} refused");
}

#[test]
fn a_damaged_page_is_an_error_or_changes_nothing() {
    survive(study, 60);
    survive(search, 40);
}

#[test]
#[ignore = "minutes; `.ci/run` runs the short one"]
fn thousands_of_damaged_pages_are_errors_or_change_nothing() {
    survive(study, 4000);
    survive(search, 4000);
}

#[test]
fn a_row_that_is_changed_gone_or_added_is_an_error_that_says_so() {
    for sql in [
        "UPDATE trial SET parameters = zeroblob(16) WHERE id = 3",
        "UPDATE outcome SET steps = 1 WHERE trial = 4 AND position = 2",
        "DELETE FROM outcome WHERE trial = 5 AND position = 2",
        "DELETE FROM outcome WHERE trial = 38; DELETE FROM score WHERE trial = 38; DELETE FROM trial WHERE id = 38",
        "UPDATE score SET score = 0.0 WHERE trial = 6",
        "DELETE FROM score WHERE trial = 6",
        "UPDATE description SET value = 'mm' WHERE name = 'unit'",
        "DELETE FROM description WHERE name = 'ending'",
        "UPDATE tally SET rows = rows - 1",
        "DELETE FROM tally",
    ] {
        let folder = tempfile::tempdir().unwrap();
        study(folder.path());
        tamper(folder.path(), sql);
        let listed = Listing::read(folder.path()).unwrap_err().to_string();
        assert!(
            listed.contains("damaged") && listed.contains("backup"),
            "{sql}: {listed}"
        );
        let resumed = Store::<Trial>::resume(folder.path(), &fingerprint()).unwrap_err();
        assert!(resumed.to_string().contains("damaged"), "{sql}: {resumed}");
    }
}

#[test]
fn a_run_that_was_killed_before_its_tables_has_an_empty_store() {
    for mode in [Mode::Start, Mode::Resume, Mode::Restart] {
        let folder = tempfile::tempdir().unwrap();
        // What is left of a process that had locked the folder and opened its file.
        std::fs::write(folder.path().join(".lock"), "").unwrap();
        for left in [None, Some("")] {
            if let Some(left) = left {
                std::fs::write(folder.path().join(STORE_FILE), left).unwrap();
            }
            let store =
                Store::<Trial>::open(folder.path(), &fingerprint(), mode, "run", "all").unwrap();
            assert!(store.finished().unwrap().is_empty());
            drop(store);
            std::fs::remove_file(folder.path().join(STORE_FILE)).unwrap();
        }
    }
}

#[test]
fn finished_results_are_used_or_refused_but_never_removed_unless_that_is_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    study(folder.path());
    let expected = answer(folder.path()).unwrap();
    let open = |fingerprint: &Fingerprint, mode| {
        Store::<Trial>::open(folder.path(), fingerprint, mode, "run", "40 points")
    };
    let store = open(&fingerprint(), Mode::Start).unwrap();
    assert_eq!(store.trials().unwrap(), expected.trials);
    assert!(store.is_complete().unwrap());
    drop(store);
    // Another study, another version, another kind of run: refused, without advice to remove anything.
    let other = fingerprint().with("seed", 2);
    let version = Fingerprint::new().with("realgap", "2").with("points", 40);
    for refused in [
        open(&other, Mode::Start).unwrap_err(),
        open(&other, Mode::Resume).unwrap_err(),
        open(&version, Mode::Start).unwrap_err(),
        Store::<RobotRow>::open(folder.path(), &fingerprint(), Mode::Start, "run", "all")
            .unwrap_err(),
    ] {
        let said = refused.to_string();
        assert!(said.contains("another folder"), "{said}");
        assert!(
            !said.contains("restart") && !said.contains("anew"),
            "{said}"
        );
    }
    assert_eq!(answer(folder.path()).unwrap(), expected);
    // Asked for more than is there, the store is unfinished until it has that, too.
    let mut store = open(&fingerprint(), Mode::Start).unwrap();
    store.insert(&[trial(40)]).unwrap();
    assert!(!store.is_complete().unwrap());
    drop(store);
    let refused = open(&fingerprint(), Mode::Start).unwrap_err().to_string();
    assert!(
        refused.contains("unfinished") && refused.contains("resume"),
        "{refused}"
    );
    let resumed = open(&fingerprint(), Mode::Resume).unwrap();
    assert_eq!(resumed.finished().unwrap().len(), 41);
    drop(resumed);
    let restarted = open(&other, Mode::Restart).unwrap();
    assert!(restarted.finished().unwrap().is_empty());
}

#[test]
fn another_version_says_which_and_offers_a_way_that_removes_nothing() {
    for (version, words) in [(2, "an earlier version"), (99, "a later version")] {
        let folder = tempfile::tempdir().unwrap();
        study(folder.path());
        tamper(folder.path(), &format!("PRAGMA user_version = {version}"));
        let before = std::fs::read(folder.path().join(STORE_FILE)).unwrap();
        for said in [
            Listing::read(folder.path()).unwrap_err().to_string(),
            Store::<Trial>::resume(folder.path(), &fingerprint())
                .unwrap_err()
                .to_string(),
        ] {
            assert!(
                said.contains(words) && said.contains(&format!("layout {version}")),
                "{said}"
            );
        }
        // Not a byte of it has changed.
        assert_eq!(
            std::fs::read(folder.path().join(STORE_FILE)).unwrap(),
            before
        );
    }
}

#[test]
fn damage_in_the_log_of_a_killed_run_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let open = folder.path().join("open");
    let mut store = Store::<Trial>::create(&open, &Fingerprint::new()).unwrap();
    let list = serde_json::json!(["floor.friction"]).to_string();
    store
        .describe([
            ("kind", "sweep".to_owned()),
            ("study", "floor".to_owned()),
            ("metric", "rms".to_owned()),
            ("unit", "m".to_owned()),
            ("parameters", list),
            ("recordings", "[]".to_owned()),
        ])
        .unwrap();
    for index in 0..20 {
        let trial = Trial {
            index,
            values: vec![index as f64],
            cases: Vec::new(),
        };
        store.insert(&[trial]).unwrap();
    }
    // What kill -9 leaves: the file and its log, with nobody holding the folder.
    let copy = |name: &str| {
        let killed = folder.path().join(name);
        std::fs::create_dir(&killed).unwrap();
        for file in ["results.sqlite", "results.sqlite-wal", ".lock"] {
            std::fs::copy(open.join(file), killed.join(file)).unwrap();
        }
        killed
    };
    let killed = copy("killed");
    assert_eq!(Listing::read(&killed).unwrap().rows.len(), 20);
    let log = std::fs::read(killed.join("results.sqlite-wal")).unwrap();
    assert!(log.len() > 40_000, "{}", log.len());
    for (number, at) in [20, 40, 60, 5_000, log.len() / 2, log.len() - 9_000]
        .into_iter()
        .enumerate()
    {
        let killed = copy(&format!("damaged_{number}"));
        let mut damaged = log.clone();
        damaged[at] ^= 4;
        std::fs::write(killed.join("results.sqlite-wal"), damaged).unwrap();
        let listed = Listing::read(&killed).unwrap_err().to_string();
        assert!(
            listed.contains("damaged") && listed.contains("-wal"),
            "{at}: {listed}"
        );
        let resumed = Store::<Trial>::resume(&killed, &Fingerprint::new()).unwrap_err();
        assert!(resumed.to_string().contains("damaged"), "{at}: {resumed}");
    }
    // A last write that was cut off is no damage: what was stored before it is there.
    let killed = copy("cut");
    std::fs::write(killed.join("results.sqlite-wal"), &log[..log.len() - 100]).unwrap();
    let listed = Listing::read(&killed).unwrap().rows.len();
    assert!((18..20).contains(&listed), "{listed}");
    drop(store);
}
