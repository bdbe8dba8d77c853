//! What a simulator that speaks the protocol is asked, and how its answers are read.

use std::sync::Arc;

use crate::{answer, command, experiment, guest, script};
use realgap_simulation::parameter::ParameterSet;
use realgap_simulation::{ForeignStart, Simulator};

/// Answers with the value of `k` in the question.
const ECHO: &str =
    r#"k=${line#*\"k\":}; k=${k%%\}*}; echo "{\"id\":$id,\"channels\":{\"a_rad\":[0,$k]}}""#;

#[test]
fn a_simulator_is_asked_with_the_values_of_its_parameters() {
    let folder = tempfile::tempdir().unwrap();
    let guest = Arc::new(guest(command(folder.path(), &script(ECHO))).unwrap());
    let experiment = experiment(Arc::clone(&guest));
    assert_eq!(answer(&experiment), Ok(vec![0.0, 2.0]));
    let set: ParameterSet = ["sim.k=7.5".parse().unwrap()].into_iter().collect();
    assert_eq!(answer(&set.apply(&experiment)), Ok(vec![0.0, 7.5]));
    let unknown = guest.parameter("q").unwrap_err().to_string();
    assert!(
        unknown.contains("found:   q") && unknown.contains("allowed: k"),
        "{unknown}"
    );
}

#[test]
fn logs_on_the_output_are_no_answers_and_a_second_answer_is_dropped() {
    let folder = tempfile::tempdir().unwrap();
    let noisy = format!("echo loading; {ECHO}; {ECHO}; echo done");
    let guest = Arc::new(guest(command(folder.path(), &script(&noisy))).unwrap());
    let experiment = experiment(guest);
    for k in [1.0, 2.0, 3.0] {
        let set: ParameterSet = [format!("sim.k={k}").parse().unwrap()]
            .into_iter()
            .collect();
        assert_eq!(answer(&set.apply(&experiment)), Ok(vec![0.0, k]));
    }
}

#[test]
fn an_answer_may_be_a_file_beside_the_study() {
    let folder = tempfile::tempdir().unwrap();
    let file =
        r#"printf 't_s,a_rad\n0,1\n2,3\n' > out.csv; echo "{\"id\":$id,\"file\":\"out.csv\"}""#;
    let guest = Arc::new(guest(command(folder.path(), &script(file))).unwrap());
    assert_eq!(answer(&experiment(guest)), Ok(vec![1.0, 2.0]));
}

#[test]
fn one_process_answers_all_questions_of_a_thread() {
    let folder = tempfile::tempdir().unwrap();
    let counting = format!("echo x >> asked; echo $$ >> processes; {ECHO}");
    let guest = Arc::new(guest(command(folder.path(), &script(&counting))).unwrap());
    let experiment = experiment(guest);
    for _ in 0..5 {
        answer(&experiment).unwrap();
    }
    let lines = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    let mut processes: Vec<String> = lines("processes").lines().map(str::to_owned).collect();
    processes.dedup();
    assert_eq!((lines("asked").lines().count(), processes.len()), (5, 1));
}

#[test]
fn a_simulator_that_answers_differently_is_found_before_the_study() {
    let folder = tempfile::tempdir().unwrap();
    let steady = Arc::new(guest(command(folder.path(), &script(ECHO))).unwrap());
    let of_steady = experiment(Arc::clone(&steady));
    assert!(steady.prepare(&of_steady).unwrap().is_empty());
    assert_eq!(steady.settings(16), 1);
    // Each answer is one more than the one before.
    let counting = r#"n=$((n+1)); echo "{\"id\":$id,\"channels\":{\"a_rad\":[0,$n]}}""#;
    let folder = tempfile::tempdir().unwrap();
    let moody = Arc::new(guest(command(folder.path(), &script(counting))).unwrap());
    let warnings = moody.prepare(&experiment(Arc::clone(&moody))).unwrap();
    assert_eq!(warnings[0].code.name(), "not-reproducible");
    assert_eq!(moody.settings(16), 16);
}

#[test]
fn a_changed_script_is_another_simulator() {
    let folder = tempfile::tempdir().unwrap();
    let version = |text: &str| {
        let guest = Arc::new(guest(command(folder.path(), &script(text))).unwrap());
        let experiment = experiment(Arc::clone(&guest));
        experiment.engine_version()
    };
    let before = version(ECHO);
    assert_eq!(before, version(ECHO));
    assert_ne!(before, version(&format!("{ECHO} # changed")));
}

#[test]
fn a_run_starts_in_true_lengths_where_recorded_ones_are_scaled() {
    let folder = tempfile::tempdir().unwrap();
    let says_x = r#"x=${line#*\"x_m\":}; x=${x%%[,\}]*}; v=${line#*\"vy_m_s\":}; v=${v%%[,\}]*}; echo "{\"id\":$id,\"channels\":{\"a_rad\":[$x,$v]}}""#;
    let guest = Arc::new(guest(command(folder.path(), &script(says_x))).unwrap());
    let mut experiment = experiment(guest);
    let values = [("x_m", 0.8), ("vy_m_s", -0.4), ("a_rad", 0.5)];
    experiment.foreign.start = Arc::new(ForeignStart {
        values: values
            .map(|(name, value)| (name.to_owned(), value))
            .to_vec(),
        ..ForeignStart::default()
    });
    assert_eq!(answer(&experiment).unwrap(), [0.8, -0.4]);
    experiment.recording_length_scale = 0.5;
    assert_eq!(answer(&experiment).unwrap(), [1.6, -0.8]);
}
