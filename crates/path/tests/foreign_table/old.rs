//! Tables as older programs lay them out, and tables whose columns or rows are there twice.

use realgap_path::trajectory::{InferredReading, Question, Reading, read};

use super::{SAMPLES, place, put, said};

#[test]
fn commands_of_plotjuggler_are_held_until_the_next_one() {
    let folder = tempfile::tempdir().unwrap();
    let mut text = String::from("__time,/pan_command/data,/joint_states/pan/position\n");
    for k in 0..60 {
        let t = 1_700_000_000.0 + 0.02 * f64::from(k);
        // A command at every third time, between the states; the first state is before the first command.
        text += &format!("{t:.6},,{}\n", 0.01 * f64::from(k));
        if k % 3 == 1 {
            text += &format!("{:.6},{},\n", t + 0.005, 0.5 * f64::from(k));
        }
    }
    let path = put(folder.path(), "juggled.csv", &text);
    let reading = Reading {
        names: [
            ("__time", "t_s"),
            ("/pan_command/data", "pan_command_rad"),
            ("/joint_states/pan/position", "pan_rad"),
        ]
        .map(|(theirs, ours)| (theirs.to_owned(), ours.to_owned()))
        .into(),
        ..Reading::default()
    };
    let found = read(&path, reading).unwrap();
    assert_eq!(found.trajectory.len(), 58);
    let joints = found.trajectory.joints();
    let of = |name: &str| {
        &joints
            .iter()
            .find(|joint| joint.name == name)
            .unwrap()
            .angles_rad
    };
    for (k, (angle, command)) in of("pan").iter().zip(of("pan_command")).enumerate() {
        let k = k + 2;
        assert!((angle - 0.01 * k as f64).abs() < 1e-12);
        assert_eq!(*command, 0.5 * ((k - 2) / 3 * 3 + 1) as f64, "{k}");
    }
    let said = said(&found);
    assert!(
        said.contains("held until the next one (/pan_command/data)"),
        "{said}"
    );
    assert!(
        said.contains("20 rows with commands alone, and 2 before"),
        "{said}"
    );
}

#[test]
fn an_export_of_vicon_in_capitals_without_units_is_in_millimetres_and_asked_about() {
    let folder = tempfile::tempdir().unwrap();
    let mut text =
        String::from("TRAJECTORIES\n100,Hz\n,Cart:front,,,Cart:rear,,\nField #,X,Y,Z,X,Y,Z\n");
    for k in 0..SAMPLES {
        let [x, y, z] = place(k).map(|m| 1000.0 * m);
        text += &format!("{},{x},{y},{z},{},{y},{z}\n", k + 1, x - 200.0);
    }
    let path = put(folder.path(), "old.csv", &text);
    let guess =
        InferredReading::infer(std::slice::from_ref(&path), &Reading::default(), None).unwrap();
    let open = &guess.ambiguities[0];
    assert_eq!(open.question, Question::Body, "{open:?}");
    let known = Reading {
        columns: open.candidates[0].columns.clone(),
        ..Reading::default()
    };
    let found = read(&path, known).unwrap();
    let places = found.trajectory.positions_world_m();
    assert_eq!(places.len(), SAMPLES);
    assert!((places[7].x - place(7)[0]).abs() < 1e-9, "{}", places[7]);
    assert!(said(&found).contains("in millimetres"));
}

#[test]
fn an_angle_in_both_units_has_to_be_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let log = |scale: f64| {
        let rows = (0..40).map(|k| {
            let angle_rad = (0.1 * f64::from(k)).sin();
            // Degrees are often printed with one digit.
            format!(
                "{},{angle_rad},{:.1}\n",
                0.02 * f64::from(k),
                scale * angle_rad.to_degrees()
            )
        });
        format!("t_s,pan_rad,pan_deg\n{}", rows.collect::<String>())
    };
    let path = put(folder.path(), "both.csv", log(1.0));
    assert_eq!(
        read(&path, Reading::default())
            .unwrap()
            .trajectory
            .joints()
            .len(),
        1
    );
    let path = put(folder.path(), "both.csv", log(2.0));
    let error = read(&path, Reading::default()).unwrap_err().to_string();
    assert!(
        error.contains("pan_deg") && error.contains("different angles"),
        "{error}"
    );
}

#[test]
fn a_line_of_names_that_is_repeated_is_left_out_and_said() {
    let folder = tempfile::tempdir().unwrap();
    let mut text = String::new();
    for k in 0..SAMPLES {
        if k % 20 == 0 {
            text += "t_s,x_m,y_m\n";
        }
        let [x, y, _] = place(k);
        text += &format!("{},{x},{y}\n", 0.05 * k as f64);
    }
    let path = put(folder.path(), "appended.csv", &text);
    let found = read(&path, Reading::default()).unwrap();
    assert_eq!(found.trajectory.len(), SAMPLES);
    assert!(said(&found).contains("the line of names is repeated 2 times"));
    // Two columns of one name are not guessed.
    let twice = text.replace("t_s,x_m,y_m", "t_s,x_m,x_m,y_m");
    let path = put(folder.path(), "twice.csv", twice);
    let error = read(&path, Reading::default()).unwrap_err().to_string();
    assert!(error.contains("two columns have the same name"), "{error}");
}
