//! Tables of OpenSim: angles in the unit that the file states, and markers.

use realgap_path::trajectory::{InferredReading, Question, Reading, read};

use super::{put, recording, said};

fn motion(title: &str, degrees: &str, names: &str, row: impl Fn(f64) -> String) -> String {
    let mut text = format!(
        "{title}\nversion=1\nnRows=40\nnColumns=3\ninDegrees={degrees}\n\nUnits are S.I. units (second, meters, Newtons, ...)\n\nendheader\n{names}\n"
    );
    for k in 0..40 {
        let t = f64::from(k) / 100.0;
        text += &format!("      {t:.8}\t      {}\n", row(t));
    }
    text
}

#[test]
fn coordinates_are_angles_in_the_unit_that_the_file_states() {
    for (degrees, size) in [("yes", 1_f64.to_radians()), ("no", 1.0)] {
        let text = motion(
            "Coordinates",
            degrees,
            "time\tpelvis_tx\tknee_angle_r",
            |t| format!("0.9\t{}", 10.0 * t),
        );
        let recording = recording("walk.mot", &text);
        let knee = recording.trajectory.joint("knee_angle_r").unwrap();
        assert!((knee.angles_rad[39] - 3.9 * size).abs() < 1e-6, "{degrees}");
        assert!(recording.trajectory.joint("pelvis_tx").is_none());
        assert!(said(&recording).contains("_tx"), "{}", said(&recording));
    }
}

#[test]
fn states_have_the_names_of_their_coordinates() {
    let names = "time\t/jointset/knee_r/knee_angle_r/value\t/jointset/knee_r/knee_angle_r/speed\t/forceset/soleus/activation";
    let text = motion("states", "no", names, |t| format!("{}\t2.0\t0.5", 2.0 * t));
    let recording = recording("walk.sto", &text);
    let knee = recording.trajectory.joint("knee_angle_r").unwrap();
    assert!((knee.angles_rad[39] - 0.78).abs() < 1e-9);
    assert_eq!(knee.speeds_rad_s.as_ref().unwrap()[3], 2.0);
}

#[test]
fn forces_are_no_angles() {
    let text = motion("ActuationForce", "no", "time\tsoleus_r\tgastroc_r", |_| {
        "100\t200".to_owned()
    });
    let folder = tempfile::tempdir().unwrap();
    let path = put(folder.path(), "force.sto", text);
    assert!(InferredReading::without_questions(&path, &Reading::default()).is_err());
}

#[test]
fn markers_are_asked_about_and_read_in_the_stated_unit() {
    let mut text = "PathFileType\t4\t(X/Y/Z)\twalk.trc\nDataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames\n100\t100\t40\t2\tmm\t100\t1\t40\nFrame#\tTime\tR.ASIS\t\t\tL.ASIS\t\t\t\n\t\tX1\tY1\tZ1\tX2\tY2\tZ2\n\n".to_owned();
    for k in 0..40 {
        let t = f64::from(k) / 100.0;
        text += &format!(
            "{}\t{t}\t{}\t900\t10\t{}\t900\t200\n",
            k + 1,
            1000.0 * t,
            2000.0 * t
        );
    }
    let folder = tempfile::tempdir().unwrap();
    let path = put(folder.path(), "walk.trc", text);
    let guess = InferredReading::of_file(&path, &Reading::default()).unwrap();
    assert_eq!(guess.ambiguities[0].question, Question::Body);
    let candidates = &guess.ambiguities[0].candidates;
    assert_eq!(candidates.len(), 2, "{candidates:?}");
    let reading = Reading {
        columns: candidates[1].columns.clone(),
        ..Reading::default()
    };
    let recording = read(&path, &reading).unwrap();
    let places = recording.trajectory.positions_world_m();
    assert!((places[39].x - 0.78).abs() < 1e-9 && (places[39].y - 0.9).abs() < 1e-9);
    assert!(
        said(&recording).contains("in OpenSim it is y"),
        "{}",
        said(&recording)
    );
}
