//! Exports of motion capture as their programs lay them out: several lines of names, keys above the numbers, sections.

use realgap_path::trajectory::{InferredReading, Question, Reading, read, read_all};

use super::{put, said};

/// Two rigid bodies, one with a marker, as Motive 2 and 3 export them; a line of parents is in Motive 3 only.
fn motive(unit: &str, parents: &str, rotation: &str) -> String {
    let kinds = format!(
        ",Type,{},{},Marker,Marker,Marker",
        ["Rigid Body"; 7].join(","),
        ["Rigid Body"; 7].join(",")
    );
    let names = format!(
        ",Name,{},{},\"cart:Marker 001\",\"cart:Marker 001\",\"cart:Marker 001\"",
        ["cart"; 7].join(","),
        ["Pole 2"; 7].join(",")
    );
    let parts = "Rotation,Rotation,Rotation,Rotation,Position,Position,Position";
    let axes = "X,Y,Z,W,X,Y,Z";
    let mut text = format!(
        "Format Version,1.23,Take Name,Take 2024,Capture Frame Rate,120.000000,Export Frame Rate,120.000000,Rotation Type,{rotation},Length Units,{unit},Coordinate Space,Global\n\n{kinds}\n{names}\n,ID,1,2,3\n{parents},,{parts},{parts},Position,Position,Position\nFrame,Time (Seconds),{axes},{axes},X,Y,Z\n"
    );
    for k in 0..40 {
        let t = f64::from(k) / 120.0;
        // The body stays at a height of about its size, which is along y here.
        text += &format!(
            "{k},{t:.6},0.0,0.0,0.0,1.0,{},50.0,{},0.0,0.0,0.0,1.0,{},60.0,7.5,1.0,2.0,3.0\n",
            1000.0 * t,
            200.0 * t * t,
            500.0 * t
        );
    }
    text
}

#[test]
fn bodies_of_motive_are_asked_about_and_read_in_the_unit_that_the_file_states() {
    let folder = tempfile::tempdir().unwrap();
    for parents in ["", ",Parent,a,b,c\n"] {
        let path = put(
            folder.path(),
            "take.csv",
            motive("Millimeters", parents, "Quaternion"),
        );
        let guess =
            InferredReading::infer(std::slice::from_ref(&path), &Reading::default(), Some(0.05))
                .unwrap();
        let open = &guess.ambiguities[0];
        assert_eq!(open.question, Question::Body, "{open:?}");
        let names: Vec<&str> = open
            .candidates
            .iter()
            .map(|one| one.name.as_str())
            .collect();
        assert_eq!(names, ["cart", "pole.2"]);
        let known = Reading {
            columns: open.candidates[0].columns.clone(),
            ..Reading::default()
        };
        // Nothing in the file says which axis points up.
        let guess = InferredReading::infer(std::slice::from_ref(&path), &known, None).unwrap();
        assert_eq!(guess.ambiguities[0].question, Question::Up);
        let found = read(&path, known).unwrap();
        let motion = &found.trajectory;
        assert_eq!(motion.len(), 40);
        let place = motion.positions_world_m()[12];
        assert!(
            (place.x - 0.1).abs() < 1e-9 && (place.y - 0.05).abs() < 1e-12,
            "{place}"
        );
        let turn = motion.orientations_world_from_body().unwrap()[12];
        assert_eq!(turn.w, 1.0);
        assert!(said(&found).contains("the positions of 1 marker are not read"));
    }
    // Euler angles are not read as a quaternion.
    let path = put(folder.path(), "euler.csv", motive("Meters", "", "XYZ"));
    let error = read(&path, Reading::default()).unwrap_err().to_string();
    assert!(error.contains("cart Position X (m)"), "{error}");
}

#[test]
fn a_cut_export_of_motive_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let text = motive("Meters", "", "Quaternion");
    let head: String = text
        .lines()
        .take(4)
        .map(|line| format!("{line}\n"))
        .collect();
    let path = put(folder.path(), "cut.csv", head);
    let error = read(&path, Reading::default()).unwrap_err().to_string();
    assert!(error.contains("no complete export of Motive"), "{error}");
}

#[test]
fn markers_of_qualisys_are_millimetres_and_zeros_are_lost() {
    let folder = tempfile::tempdir().unwrap();
    let head = "NO_OF_FRAMES\t30\nNO_OF_CAMERAS\t8\nNO_OF_MARKERS\t2\nFREQUENCY\t100\nNO_OF_ANALOG\t0\nANALOG_FREQUENCY\t0\nDESCRIPTION\t--\nTIME_STAMP\t2024-04-15, 10:39:38.777\t406646.66137317\nDATA_INCLUDED\t3D\nMARKER_NAMES\thip\tfoot\n";
    let row = |k: i32| match k {
        7 => "0.000\t0.000\t0.000".to_owned(),
        k => format!("{}.5\t{}.0\t613.382", 10 * k, 2 * k),
    };
    let foot = "-138.493\t187.190\t53.579";
    let plain: String = (0..30).map(|k| format!("{}\t{foot}\n", row(k))).collect();
    let counted: String = (0..30)
        .map(|k| {
            format!(
                "{}\t{:.5}\t{}\t{foot}\n",
                k + 1,
                0.01 * f64::from(k),
                row(k)
            )
        })
        .collect();
    let named = "Frame\tTime\thip X\thip Y\thip Z\tfoot X\tfoot Y\tfoot Z\n";
    for (name, text) in [
        (
            "plain.tsv",
            format!("{head}TRAJECTORY_TYPES\tMeasured\tMeasured\n{plain}"),
        ),
        ("counted.tsv", format!("{head}{named}{counted}")),
    ] {
        let path = put(folder.path(), name, text);
        let guess = InferredReading::of_file(&path, &Reading::default()).unwrap();
        let open = &guess.ambiguities[0];
        assert_eq!(open.question, Question::Body);
        let known = Reading {
            columns: open.candidates[0].columns.clone(),
            ..Reading::default()
        };
        let lost = read(&path, known.clone()).unwrap_err().to_string();
        assert!(lost.contains("a number is missing"), "{lost}");
        let skipping = Reading {
            skip_lost: Some(true),
            ..known
        };
        let found = read(&path, skipping).unwrap();
        assert_eq!(found.trajectory.len(), 29, "{name}");
        let place = found.trajectory.positions_world_m()[3];
        assert!((place.x - 0.0305).abs() < 1e-12 && (place.z - 0.613382).abs() < 1e-12);
        assert!((found.trajectory.times_s()[3] - 0.03).abs() < 1e-12);
        assert!(said(&found).contains("millimetres"));
    }
}

#[test]
fn bodies_of_qualisys_have_their_rotation() {
    let folder = tempfile::tempdir().unwrap();
    let mut text = "NO_OF_FRAMES\t5\nNO_OF_CAMERAS\t8\nNO_OF_BODIES\t1\nFREQUENCY\t50\nDATA_INCLUDED\t6D\nBODY_NAMES\tcar\nFrame\tTime\tcar X\tY\tZ\tRoll\tPitch\tYaw\tResidual\tRot[0]\tRot[1]\tRot[2]\tRot[3]\tRot[4]\tRot[5]\tRot[6]\tRot[7]\tRot[8]\n".to_owned();
    for k in 0..5 {
        // A quarter of a turn about z: x goes to y. Elements stand column by column.
        text += &format!(
            "{k}\t{:.3}\t{k}00\t0\t10\t0\t0\t90\t0.1\t0\t1\t0\t-1\t0\t0\t0\t0\t1\n",
            0.02 * f64::from(k)
        );
    }
    let path = put(folder.path(), "car.tsv", text);
    let guess = InferredReading::of_file(&path, &Reading::default()).unwrap();
    assert!(guess.ambiguities.is_empty(), "{:?}", guess.ambiguities);
    let found = read(&path, guess.reading).unwrap();
    let turn = found.trajectory.orientations_world_from_body().unwrap()[2];
    let (axis, angle) = turn.axis_angle().unwrap();
    assert!((axis.z * angle - std::f64::consts::FRAC_PI_2).abs() < 1e-9);
    assert!((found.trajectory.positions_world_m()[2].x - 0.2).abs() < 1e-12);
}

#[test]
fn sections_of_vicon_are_told_apart() {
    let folder = tempfile::tempdir().unwrap();
    let rows = |cells: &str| -> String {
        (1..40)
            .map(|k| format!("{k},0,{cells},{k}.5,2,3\n"))
            .collect()
    };
    let text = format!(
        "Trajectories\n100\n,,Car:Front,,,Car:Back,,\nFrame,Sub Frame,X,Y,Z,X,Y,Z\n,,mm,mm,mm,mm,mm,mm\n{}\nDevices\n1000\n,,Force\nFrame,Sub Frame,Fx\n,,N\n1,0,5\n",
        rows("10,20,30")
    );
    let path = put(folder.path(), "trial.csv", text);
    let guess = InferredReading::of_file(&path, &Reading::default()).unwrap();
    let open = &guess.ambiguities[0];
    assert_eq!(open.question, Question::Body);
    let back = open
        .candidates
        .iter()
        .find(|one| one.name.contains("back"))
        .unwrap();
    let known = Reading {
        columns: back.columns.clone(),
        ..Reading::default()
    };
    let found = read(&path, known).unwrap();
    assert_eq!(found.trajectory.len(), 39);
    assert!((found.trajectory.positions_world_m()[4].x - 0.0055).abs() < 1e-12);
    assert!((found.trajectory.times_s()[4] - 0.05).abs() < 1e-12);
    assert!(said(&found).contains("Devices"));

    let text = format!(
        "Objects\n200\n,,Global Angle Wand:Wand,,,,,\nFrame,Sub Frame,RX,RY,RZ,TX,TY,TZ\n,,deg,deg,deg,mm,mm,mm\n{}",
        rows("1,2,3")
    );
    let path = put(folder.path(), "tracker.csv", text);
    let guess = InferredReading::of_file(&path, &Reading::default()).unwrap();
    let found = read(&path, guess.reading).unwrap();
    assert!(found.trajectory.orientations_world_from_body().is_none());
    assert!(
        said(&found).contains("rotations of Global Angle Wand:Wand are not read"),
        "{}",
        said(&found)
    );
}

#[test]
fn deeplabcut_needs_a_rate_and_a_scale() {
    let folder = tempfile::tempdir().unwrap();
    let rows: String = (0..30)
        .map(|k| format!("{k},{}.5,7.25,0.99\n", 3 * k))
        .collect();
    let text = format!(
        "scorer,DLC_resnet50,DLC_resnet50,DLC_resnet50\nbodyparts,nose,nose,nose\ncoords,x,y,likelihood\n{rows}"
    );
    let path = put(folder.path(), "video.csv", text);
    let error = InferredReading::of_file(&path, &Reading::default())
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("counts samples") && error.contains("rate_hz"),
        "{error}"
    );
    let rate = Reading {
        rate_hz: Some(30.0),
        ..Reading::default()
    };
    let error = InferredReading::of_file(&path, &rate)
        .unwrap_err()
        .to_string();
    assert!(error.contains("pixel"), "{error}");
    let scale = Reading {
        scale: Some(0.001),
        ..rate
    };
    let guess = InferredReading::of_file(&path, &scale).unwrap();
    assert!(guess.ambiguities.is_empty(), "{:?}", guess.ambiguities);
    let found = read(&path, guess.reading).unwrap();
    assert!((found.trajectory.positions_world_m()[2].x - 0.0065).abs() < 1e-12);
    assert!((found.trajectory.times_s()[3] - 0.1).abs() < 1e-12);
}

#[test]
fn tables_of_spreadsheets_are_read_whatever_they_put_around_the_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let own = "t_s;x_m;y_m;;\r\n0,0;1,5;2,0;;\r\n0,1;1,75;2,5;;\r\n";
    let utf_16 = |text: &str| -> Vec<u8> {
        let units = std::iter::once(0xfeff).chain(text.encode_utf16());
        units.flat_map(u16::to_le_bytes).collect()
    };
    for (name, content) in [
        ("sep.csv", format!("sep=;\r\n{own}").into_bytes()),
        ("wide.csv", utf_16(own)),
        ("twice.csv", b"t_s,x_m,y_m,note,note\n0,1.5,2,a,b\n0.1,1.75,2.5,a,b\n".to_vec()),
        ("inches.csv", b"t_s,x_in,y_in\n0,59.05511811023622,78.74015748031496\n0.1,68.89763779527559,98.4251968503937\n".to_vec()),
    ] {
        let path = put(folder.path(), name, content);
        let found = read(&path, Reading::default()).unwrap();
        let places = found.trajectory.positions_world_m();
        assert!((places[1].x - 1.75).abs() < 1e-12 && (places[0].y - 2.0).abs() < 1e-12, "{name}");
    }
    let path = put(
        folder.path(),
        "same.csv",
        "t_s,x_m,y_m,x_m\n0,1,2,3\n1,1,2,3\n",
    );
    let error = read(&path, Reading::default()).unwrap_err().to_string();
    assert!(error.contains("same"), "{error}");
    let path = put(
        folder.path(),
        "both.csv",
        "t_s,a_rad,a_deg,b_deg\n0,0.5,28.6,90\n1,0.6,34.4,180\n",
    );
    let found = read(&path, Reading::default()).unwrap();
    let joints = found.trajectory.joints();
    assert_eq!(joints.len(), 2);
    assert_eq!(joints[0].angles_rad, [0.5, 0.6]);
    assert!(said(&found).contains("a_deg"), "{}", said(&found));
}

#[test]
fn json_lines_are_a_table() {
    let folder = tempfile::tempdir().unwrap();
    let line = |k: i32| {
        format!(
            "{{\"t_s\": {}, \"pose\": {{\"position\": [{k}.5, 2, null], \"id\": \"a,b\"}}, \"q\": [0.1, {k}]}}",
            0.1 * f64::from(k)
        )
    };
    let lines: Vec<String> = (0..20).map(line).collect();
    for (name, text) in [
        ("log.jsonl", lines.join("\n")),
        ("log.json", format!("[{}]", lines.join(",\n"))),
    ] {
        let path = put(folder.path(), name, text);
        let guess = InferredReading::of_file(
            &path,
            &Reading {
                skip_lost: None,
                ..Reading::default()
            },
        );
        // The height is lost in every sample.
        assert!(guess.is_err(), "{name}");
        let columns = ["t=t_s", "x=pose.position.x in m", "y=pose.position.y in m"];
        let columns = columns.iter().fold(
            Default::default(),
            |all: realgap_path::trajectory::Columns, text| all.with_text(text).unwrap(),
        );
        let found = read_all(
            &path,
            Reading {
                columns,
                ..Reading::default()
            },
        )
        .unwrap();
        assert_eq!(found[0].trajectory.positions_world_m()[3].x, 3.5, "{name}");
        assert!(said(&found[0]).contains('q'));
    }
    let path = put(folder.path(), "broken.jsonl", "{\"t_s\": 0}\n{\"t_s\": \n");
    let error = read(&path, Reading::default()).unwrap_err();
    assert_eq!(
        error.line_column().map(|(line, _)| line),
        Some(2),
        "{error}"
    );
}

#[test]
fn one_json_object_of_lists_is_a_table_of_columns() {
    let folder = tempfile::tempdir().unwrap();
    let list = |of: &dyn Fn(f64) -> String| {
        let all: Vec<String> = (0..50).map(|k| of(f64::from(k))).collect();
        format!("[{}]", all.join(","))
    };
    let text = format!(
        "{{\"robot\": \"mine\", \"gains\": [1, 2, 3], \"t_s\": {}, \"arm\": {{\"a_rad\": {}, \"b_deg\": {}}}, \"tip\": {{\"position\": {}}}}}",
        list(&|k| format!("{}", 0.02 * k)),
        list(&|k| format!("{}", (0.1 * k).sin())),
        list(&|k| format!("{}", 2.0 * k)),
        list(&|k| format!("[{k}.5, 2, 3]")),
    );
    let path = put(folder.path(), "run.json", &text);
    let columns = ["x=tip.position.x in m", "y=tip.position.y in m"];
    let columns = columns.iter().fold(
        Default::default(),
        |all: realgap_path::trajectory::Columns, text| all.with_text(text).unwrap(),
    );
    let reading = Reading {
        columns,
        ..Reading::default()
    };
    let found = read(&path, reading).unwrap();
    assert_eq!(found.trajectory.times_s().len(), 50);
    assert_eq!(found.trajectory.positions_world_m()[4].x, 4.5);
    let joint = |name: &str| found.trajectory.joint(name).unwrap().angles_rad[3];
    assert!((joint("arm.a") - 0.3_f64.sin()).abs() < 1e-12);
    assert!((joint("arm.b") - 6.0_f64.to_radians()).abs() < 1e-12);
    let said = said(&found);
    assert!(
        said.contains("the lists of 50 values in one object are columns"),
        "{said}"
    );
}

#[test]
fn a_column_that_grows_as_a_time_is_named_where_none_has_the_name_of_a_time() {
    let folder = tempfile::tempdir().unwrap();
    let row = |k: i32| format!("{},{},{}\n", 4000 + 20 * k, k * k, 3 * k % 7);
    let text: String = (0..40).map(row).collect();
    let path = put(folder.path(), "run.csv", format!("tick,x,y\n{text}"));
    let error = InferredReading::of_file(&path, &Reading::default()).unwrap_err();
    let said = error.to_string();
    assert!(
        said.contains("`tick` grows with every row, mostly by 20"),
        "{said}"
    );
    let path = put(folder.path(), "other.csv", "odd,x,y\n1,2,3\n5,2,3\n2,2,3\n");
    let error = InferredReading::of_file(&path, &Reading::default()).unwrap_err();
    assert!(!error.to_string().contains("grows"), "{error}");
}

#[test]
fn kinds_of_files_that_are_not_read_are_named_with_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    for (name, words) in [
        ("run.bag", "rosbags-convert"),
        ("walk.c3d", "export CSV"),
        ("demo.hdf5", "numpy.savez"),
        ("sheet.xlsx", "save the sheet as CSV"),
        ("log.csv.gz", "unpack it"),
    ] {
        let path = put(folder.path(), name, "anything");
        let error = read(&path, Reading::default()).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
}
