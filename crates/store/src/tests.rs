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
