//! A damaged store, or one of another version, gives an error and never different results.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::path::Path;

use crate::finished::{fingerprint, search, study, tamper, trial};
use rand::{Rng, RngExt};
use realgap_core::random::Numbered;
use realgap_store::{Fingerprint, Listing, Mode, RobotRow, STORE_FILE, Store, Trial, TrialScore};

/// Everything that is read from a store: the listing, and the rows from which a run is resumed.
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

/// Damages one random page, as a failing disk or an interrupted copy does.
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

/// Damages a store `times` times: every time it is refused, or gives the same results as before.
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
fn a_finished_store_that_is_truncated_anywhere_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    study(folder.path());
    let file = folder.path().join(STORE_FILE);
    let whole = std::fs::read(&file).unwrap();
    for share in 0..200 {
        std::fs::write(&file, &whole[..whole.len() * share / 200]).unwrap();
        assert!(Listing::read(folder.path()).is_err(), "{share} of 200");
    }
}

#[test]
#[ignore = "minutes; `.ci/run` runs the short one"]
fn thousands_of_damaged_pages_are_errors_or_change_nothing() {
    survive(study, 4000);
    survive(search, 4000);
}

#[test]
fn a_changed_missing_or_added_row_is_reported_as_damage() {
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
fn a_run_that_was_killed_before_it_created_its_tables_has_an_empty_store() {
    for mode in [Mode::Start, Mode::Resume, Mode::Restart] {
        let folder = tempfile::tempdir().unwrap();
        // The files that a killed process leaves after it locked the folder and opened its store.
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
fn finished_results_are_used_or_refused_but_removed_only_by_a_restart() {
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
    // Results of another study, version or kind of run are refused, and the error does not advise to remove anything.
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
    // A run with more rows than the store makes the store unfinished until these rows are stored too.
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
fn results_of_another_version_are_refused_with_the_version_and_stay_unchanged() {
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
        // The file is unchanged.
        assert_eq!(
            std::fs::read(folder.path().join(STORE_FILE)).unwrap(),
            before
        );
    }
}

/// Runs of one study that were ended by kill -9: each is an open store whose files are copied while its writer is still open.
struct Killed {
    folder: tempfile::TempDir,
    /// The stores are kept open, so that their logs stay.
    _writers: Vec<Store<Trial>>,
}

const STORE_FILES: [&str; 4] = [
    STORE_FILE,
    "results.sqlite-wal",
    "results.sqlite-count",
    ".lock",
];

impl Killed {
    fn new() -> Self {
        Self {
            folder: tempfile::tempdir().unwrap(),
            _writers: Vec::new(),
        }
    }

    /// Starts a run that has stored `rows` rows, one at a time; the rows before `merged` are in the main file, the others in the log.
    fn run(&mut self, name: &str, fingerprint: &Fingerprint, rows: usize, merged: usize) {
        let open = self.folder.path().join(name);
        let mut store = Store::<Trial>::create(&open, fingerprint).unwrap();
        let list = serde_json::json!(["floor.friction", "floor.restitution"]).to_string();
        let described = [
            ("kind", "sweep"),
            ("study", "floor"),
            ("metric", "rms"),
            ("unit", "m"),
            ("parameters", &list),
            ("recordings", "[]"),
        ];
        store
            .describe(described.map(|(name, value)| (name, value.to_owned())))
            .unwrap();
        for index in 0..rows {
            if index == merged {
                tamper(&open, "PRAGMA wal_checkpoint(TRUNCATE)");
            }
            store.insert(&[trial(index)]).unwrap();
        }
        self._writers.push(store);
    }

    /// The files that a killed run leaves, in a folder of their own.
    fn left(&self, name: &str, copy: &str) -> std::path::PathBuf {
        let (open, killed) = (self.folder.path().join(name), self.folder.path().join(copy));
        let _fresh = std::fs::remove_dir_all(&killed);
        std::fs::create_dir(&killed).unwrap();
        for file in STORE_FILES {
            std::fs::copy(open.join(file), killed.join(file)).unwrap();
        }
        killed
    }
}

/// Checks that the store of a killed run is read unchanged, or refused with the advice to resume; a resumed store holds only rows that were
/// stored. Returns true if the store was refused.
fn read_and_resume(killed: &Path, fingerprint: &Fingerprint, whole: &[Trial], what: &str) -> bool {
    let listed = Store::<Trial>::read(killed).and_then(|store| store.trials());
    let is_refused = match listed {
        Ok(trials) => {
            assert_eq!(trials, whole, "silently different: {what}");
            false
        }
        Err(error) => {
            assert!(error.to_string().contains("resume"), "{what}: {error}");
            let started = Store::<Trial>::open(killed, fingerprint, Mode::Start, "run", "all");
            assert!(started.is_err(), "started over it: {what}");
            true
        }
    };
    let mut resumed = Store::<Trial>::resume(killed, fingerprint)
        .unwrap_or_else(|error| panic!("{what}: {error}"));
    let there = resumed.finished().unwrap();
    let rest: Vec<Trial> = (0..whole.len())
        .filter(|index| !there.contains(index))
        .map(trial)
        .collect();
    assert_eq!(rest.is_empty(), !is_refused || there.len() == whole.len());
    resumed.insert(&rest).unwrap();
    assert_eq!(resumed.trials().unwrap(), whole, "{what}");
    drop(resumed);
    let again = Store::<Trial>::read(killed).unwrap();
    assert_eq!(again.trials().unwrap(), whole, "{what}");
    is_refused
}

#[test]
fn a_truncated_missing_damaged_or_foreign_log_is_an_error_that_resuming_repairs() {
    let mut all = Killed::new();
    let whole: Vec<Trial> = (0..24).map(trial).collect();
    let others = Fingerprint::new().with("realgap", "1").with("points", 7);
    // The first run has all rows in its log, the second has a part of them in its main file.
    all.run("log", &fingerprint(), 24, 99);
    all.run("both", &fingerprint(), 24, 9);
    all.run("shorter", &fingerprint(), 5, 99);
    all.run("other", &others, 24, 99);
    let log_of = |folder: &Path| folder.join("results.sqlite-wal");
    for name in ["log", "both"] {
        let resume = |killed: &Path, what: &str| {
            read_and_resume(killed, &fingerprint(), &whole, &format!("{name}, {what}"))
        };
        assert!(!resume(&all.left(name, "killed"), "as it was left"));
        let log = std::fs::read(log_of(&all.left(name, "killed"))).unwrap();
        let mut rng = Numbered::SearchStep.generator(24, 0);
        for _ in 0..12 {
            let killed = all.left(name, "killed");
            let length = rng.random_range(0..log.len());
            std::fs::write(log_of(&killed), &log[..length]).unwrap();
            assert!(resume(&killed, &format!("cut to {length}")));
            let killed = all.left(name, "killed");
            let mut damaged = log.clone();
            damaged[length] ^= 1 << rng.random_range(0..8);
            std::fs::write(log_of(&killed), damaged).unwrap();
            resume(&killed, &format!("a bit at {length}"));
        }
        let killed = all.left(name, "killed");
        std::fs::remove_file(log_of(&killed)).unwrap();
        assert!(resume(&killed, "missing"));
        for foreign in ["shorter", "other", "log", "both"] {
            if foreign == name {
                continue;
            }
            let killed = all.left(name, "killed");
            std::fs::copy(log_of(&all.left(foreign, "foreign")), log_of(&killed)).unwrap();
            let refused = resume(&killed, &format!("with the log of {foreign}"));
            // The logs of the two runs of this study hold the same rows, so they may replace each other.
            assert!(refused || ["log", "both"].contains(&foreign), "{foreign}");
        }
        // The file with the noted count is missing or damaged.
        for left in [None, Some("x"), Some("")] {
            let killed = all.left(name, "killed");
            let count = killed.join("results.sqlite-count");
            match left {
                None => std::fs::remove_file(count).unwrap(),
                Some(text) => std::fs::write(count, text).unwrap(),
            }
            assert!(resume(&killed, "without its count"));
        }
    }
}

#[test]
fn a_log_beside_a_closed_store_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let closed = folder.path().join("closed");
    std::fs::create_dir(&closed).unwrap();
    study(&closed);
    let expected = answer(&closed).unwrap();
    let mut all = Killed::new();
    all.run("other", &fingerprint(), 8, 99);
    let log = closed.join("results.sqlite-wal");
    std::fs::copy(all.left("other", "left").join("results.sqlite-wal"), &log).unwrap();
    let error = Listing::read(&closed).unwrap_err().to_string();
    assert!(error.contains("does not belong to the store"), "{error}");
    assert!(Store::<Trial>::open(&closed, &fingerprint(), Mode::Start, "run", "all").is_err());
    drop(Store::<Trial>::resume(&closed, &fingerprint()).unwrap());
    assert_eq!(answer(&closed).unwrap(), expected);
}
