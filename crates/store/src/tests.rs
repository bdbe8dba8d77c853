//! Tests of a store: rows come back unchanged, one writer at a time, no mixture of studies.

use std::fs;

use super::*;

fn trial(index: usize) -> Trial {
    Trial {
        index,
        values: vec![0.1 + index as f64, f64::MIN_POSITIVE],
        cases: vec![
            CaseRow {
                steps: 480,
                outcome: CaseOutcome::Completed(CaseResult {
                    net_displacement_m: 0.1_f64.sqrt(),
                    scores: vec![1.0 / 3.0],
                    path_xy_m: vec![[0.0, -0.0], [1e-300, 2.0]],
                }),
            },
            CaseRow {
                steps: 3,
                outcome: CaseOutcome::Diverged("part 0 left".to_owned()),
            },
        ],
    }
}

#[test]
fn trials_are_read_back_with_the_same_bits() {
    let folder = tempfile::tempdir().unwrap();
    let fingerprint = Fingerprint::new().with("a", 1).with("b", "x");
    let mut store = Store::create(folder.path(), &fingerprint).unwrap();
    store.insert(&[trial(7), trial(2)]).unwrap();
    drop(store);
    let store = Store::resume(folder.path(), &fingerprint).unwrap();
    assert_eq!(store.trials().unwrap(), [trial(2), trial(7)]);
    assert_eq!(
        store.finished().unwrap().into_iter().collect::<Vec<_>>(),
        [2, 7]
    );
    assert_eq!(store.trials().unwrap()[0].diverged(), Some("part 0 left"));
}

#[test]
fn scores_and_descriptions_are_read_back_and_can_be_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let mut store = Store::create(folder.path(), &Fingerprint::new()).unwrap();
    store.insert(&[trial(0), trial(1)]).unwrap();
    let score = |index, score| TrialScore {
        index,
        score,
        displacement_error_m: score,
        recordings: vec![0.1, 1.0 / 3.0],
    };
    store
        .insert_scores(&[score(0, Some(2.0)), score(1, None)])
        .unwrap();
    store.insert_scores(&[score(0, Some(0.1 + 0.2))]).unwrap();
    assert_eq!(
        store.scores().unwrap(),
        [score(0, Some(0.1 + 0.2)), score(1, None)]
    );
    store.describe([("metric", "pca".to_owned())]).unwrap();
    store.describe([("metric", "rms".to_owned())]).unwrap();
    assert_eq!(store.description().unwrap()["metric"], "rms");
    assert_eq!(store.rows_within(1..9).unwrap(), [trial(1)]);
}

#[test]
fn a_folder_accepts_one_writer_and_one_study() {
    let folder = tempfile::tempdir().unwrap();
    let fingerprint = Fingerprint::new().with("a", 1);
    let store = Store::<Trial>::create(folder.path(), &fingerprint).unwrap();
    let busy = Store::<Trial>::resume(folder.path(), &fingerprint).unwrap_err();
    assert!(busy.to_string().contains("another process"), "{busy}");
    drop(store);
    let there = Store::<Trial>::create(folder.path(), &fingerprint).unwrap_err();
    assert!(there.to_string().contains("resume"), "{there}");
    let other =
        Store::<Trial>::resume(folder.path(), &Fingerprint::new().with("a", 2)).unwrap_err();
    assert!(other.to_string().contains("now 2, stored 1"), "{other}");
    let other = Fingerprint::new().with("a", 2);
    Store::<Trial>::open(folder.path(), &other, Mode::Restart, "run", "all").unwrap();
}

#[test]
fn a_store_can_be_read_while_another_process_writes() {
    let folder = tempfile::tempdir().unwrap();
    let mut store = Store::create(folder.path(), &Fingerprint::new()).unwrap();
    store.insert(&[trial(0)]).unwrap();
    let reader = Store::<Trial>::read(folder.path()).unwrap();
    store.insert(&[trial(1)]).unwrap();
    assert_eq!(reader.finished().unwrap().len(), 2);
}

#[test]
fn a_file_that_is_not_a_store_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join(STORE_FILE),
        b"not a database, but long enough to look at",
    )
    .unwrap();
    assert!(Store::<Trial>::resume(folder.path(), &Fingerprint::new()).is_err());
}

/// A run of two trials on a network file system, as the answer of the system is faked for this test.
fn on_nfs(folder: &std::path::Path) -> Store<Trial> {
    file_system::tests::fake(file_system::FileSystem::Shared("nfs4".to_owned()));
    let mut store = Store::create(folder, &Fingerprint::new().with("a", 1)).unwrap();
    store.insert(&[trial(0), trial(1)]).unwrap();
    store
}

#[test]
fn on_a_network_file_system_there_is_no_log_and_rows_are_read_while_a_run_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let mut store = on_nfs(folder.path());
    let names = || -> Vec<String> {
        let all = fs::read_dir(folder.path()).unwrap();
        all.map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect()
    };
    let has_log = |names: &[String]| {
        names
            .iter()
            .any(|name| name.ends_with("-wal") || name.ends_with("-shm"))
    };
    assert!(!has_log(&names()), "{:?}", names());
    assert_eq!(
        Store::<Trial>::read(folder.path())
            .unwrap()
            .trials()
            .unwrap(),
        [trial(0), trial(1)]
    );
    store.insert(&[trial(2)]).unwrap();
    assert!(!has_log(&names()), "{:?}", names());
    let second = Store::<Trial>::resume(folder.path(), &Fingerprint::new().with("a", 1));
    let second = second.unwrap_err().to_string();
    assert!(second.contains("another process"), "{second}");
    drop(store);
    let again = Store::<Trial>::resume(folder.path(), &Fingerprint::new().with("a", 1)).unwrap();
    assert_eq!(again.trials().unwrap(), [trial(0), trial(1), trial(2)]);
}

/// The files of a folder as they are now, as a killed process leaves them.
fn copied(folder: &std::path::Path) -> tempfile::TempDir {
    let copy = tempfile::tempdir().unwrap();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        fs::copy(&path, copy.path().join(path.file_name().unwrap())).unwrap();
    }
    copy
}

#[test]
fn a_write_that_was_cut_off_on_a_network_file_system_is_taken_back_by_who_opens_it_next() {
    let folder = tempfile::tempdir().unwrap();
    let fingerprint = Fingerprint::new().with("a", 1);
    let store = on_nfs(folder.path());
    // The files are copied in the middle of a transaction.
    store
        .connection
        .execute_batch(
            "PRAGMA cache_size = 0; PRAGMA cache_spill = 1; BEGIN IMMEDIATE; UPDATE tally SET rows = 99",
        )
        .unwrap();
    let filler = "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < 400)
        INSERT INTO description SELECT 'filler ' || i, hex(randomblob(500)) FROM n";
    store.connection.execute_batch(filler).unwrap();
    let killed = copied(folder.path());
    assert!(
        killed
            .path()
            .join("results.sqlite-journal")
            .metadata()
            .unwrap()
            .len()
            > 4096
    );
    let copy = copied(killed.path());
    let read = Store::<Trial>::read(copy.path()).unwrap();
    assert_eq!(read.trials().unwrap(), [trial(0), trial(1)]);
    assert!(!copy.path().join("results.sqlite-journal").exists());
    // A living writer's change is not taken back.
    assert!(Store::<Trial>::read(folder.path()).is_err());
    assert!(folder.path().join("results.sqlite-journal").exists());
    let resumed = Store::<Trial>::resume(killed.path(), &fingerprint).unwrap();
    assert_eq!(resumed.trials().unwrap(), [trial(0), trial(1)]);
}

#[test]
fn a_log_is_not_used_on_a_network_file_system_and_the_error_says_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    let fingerprint = Fingerprint::new().with("a", 1);
    let mut store = Store::create(folder.path(), &fingerprint).unwrap();
    store.insert(&[trial(0)]).unwrap();
    let killed = copied(folder.path());
    drop(store);
    file_system::tests::fake(file_system::FileSystem::Shared("nfs".to_owned()));
    for error in [
        Store::<Trial>::read(killed.path()).unwrap_err().to_string(),
        Store::<Trial>::resume(killed.path(), &fingerprint)
            .unwrap_err()
            .to_string(),
    ] {
        for said in [
            "network file system",
            "nfs",
            "copy the whole folder to a disk of this computer",
        ] {
            assert!(error.contains(said), "{error}");
        }
    }
    // What was closed has no log, and is read anywhere.
    assert_eq!(
        Store::<Trial>::read(folder.path())
            .unwrap()
            .trials()
            .unwrap(),
        [trial(0)]
    );
}

#[test]
fn a_file_system_whose_locks_others_do_not_see_is_refused_and_nothing_is_left_there() {
    file_system::tests::fake(file_system::FileSystem::WithoutLocks(
        "fuse.sshfs".to_owned(),
    ));
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let error = Store::<Trial>::create(&out, &Fingerprint::new())
        .unwrap_err()
        .to_string();
    for said in [
        "fuse.sshfs",
        "other computers",
        "a disk of this computer, and copy",
    ] {
        assert!(error.contains(said), "{error}");
    }
    assert!(!out.exists());
}
