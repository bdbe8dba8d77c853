//! Mapping of foreign columns, units and orders.

use realgap::calibration::{Definition, Overrides, Study};
use realgap::file::Source;
use realgap::trajectory::{Reading, read, read_all};
use realgap::unit::LengthUnit;
use realgap::warning::Code;

use super::common::{project, realgap, study, text};
use super::{
    FOREIGN, codes, file, foreign_form, is_near, own_form, read_text, reading, refuse, said, walk,
};

#[test]
fn a_mapping_reads_a_foreign_file_and_the_warning_says_so() {
    let own = read_text(&own_form(&walk()), LengthUnit::Metre);
    let foreign = read_text(&foreign_form(&walk()), reading(FOREIGN));
    is_near(&foreign, &own);
    assert!(foreign.trajectory.is_planar());
    assert_eq!(codes(&foreign), [Code::ReadAs]);
    assert_eq!(
        said(&foreign, Code::ReadAs),
        "recordings are read with t from `%time in ns`, x from `pose.x in mm`, y from `pose.y in mm`, heading from `yaw in deg`; \
         only rows with robot = 3"
    );
    assert!(codes(&own).is_empty(), "{:?}", own.warnings);
    // A file in the own form is not touched by it.
    let untouched = read_text(&own_form(&walk()), reading(FOREIGN));
    assert_eq!(untouched.trajectory, own.trajectory);
    assert!(codes(&untouched).is_empty());
}

#[test]
fn the_page_about_recordings_reads_its_own_example() {
    let page = std::fs::read_to_string(project().join("docs/recordings.md")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    // Half a minute of waiting, then the walk.
    let waits = (0..1500).map(|i| [f64::from(i) / 50.0, 0.0, 0.0, 0.0]);
    let walks = walk().into_iter().map(|[t, x, y, a]| [t + 30.0, x, y, a]);
    let poses: Vec<[f64; 4]> = waits.chain(walks).collect();
    let field = file(folder.path(), "field.csv", &foreign_form(&poses));
    let after = |start: &str| page.split(start).nth(1).unwrap();
    let header = after("```text\n").lines().next().unwrap();
    assert!(foreign_form(&poses).starts_with(header));
    // What the names do not tell is asked: which robot's rows are read.
    let refused = realgap().arg("check").arg(&field).assert().code(1);
    let error = text(&refused.get_output().stderr);
    assert!(
        error.contains("leave a question open") && error.contains("--where"),
        "{error}"
    );
    // The options as the page has them, split as a shell does.
    let command = after("```sh\n").split("```").next().unwrap();
    let command = command.replace("\\\n", " ");
    let options = command
        .split('\'')
        .enumerate()
        .flat_map(|(index, part)| match index % 2 {
            0 => part.split_whitespace().map(str::to_owned).collect(),
            _ => vec![part.to_owned()],
        });
    let options: Vec<String> = options.skip(3).collect();
    let out = realgap()
        .arg("check")
        .arg(&field)
        .args(&options)
        .assert()
        .success();
    let found = text(&out.get_output().stdout);
    assert!(found.contains("1001 samples over 20.000 s"), "{found}");
    assert!(
        found.contains("[read-as]") && !found.contains("[standstill]"),
        "{found}"
    );
    // The section of a study says the same.
    let section = after("    reading: (").split("    ),\n```").next().unwrap();
    let section = Reading::parse(&Source::new("page", format!("({section})"))).unwrap();
    let whole = read(&field, &section).unwrap();
    assert_eq!(whole.trajectory.len(), 1001);
}

#[test]
fn a_mapping_may_stand_in_a_study_a_file_the_metadata_or_on_the_command_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let own = file(path, "own.csv", &own_form(&walk()));
    let foreign = file(path, "foreign.csv", &foreign_form(&walk()));
    let how = file(path, "how.ron", FOREIGN);
    let rms = |arguments: &[&str]| {
        let out = realgap()
            .arg("compare")
            .args([&own, &foreign])
            .args(["--metric", "rms", "--format", "json"])
            // The clocks have different epochs.
            .args(["--time", "start"])
            .args(arguments)
            .assert()
            .success();
        let rows: serde_json::Value = serde_json::from_slice(&out.get_output().stdout).unwrap();
        let codes = rows[0]["warnings"].as_array().unwrap();
        assert!(codes.iter().any(|w| w["code"] == "read-as"), "{rows}");
        rows[0]["rms_m"].as_f64().unwrap()
    };
    // The file is planar, the other is not: only their plane is compared. Steps of 0.24 µs in time are 10 nm of way.
    let same_m = 1e-7;
    assert!(rms(&["--reading", how.to_str().unwrap()]) < same_m);
    assert!(rms(&["--reading", "-", "--reading", how.to_str().unwrap()]) < same_m);
    let options = [
        "--column",
        "t=%time in ns",
        "--column",
        "x=pose.x",
        "--column",
        "y=pose.y in mm",
        "--unit",
        "mm",
        "--column",
        "heading=yaw",
        "--angle-unit",
        "deg",
        "--where",
        "robot=3",
    ];
    // --unit is for all files, but the names of the first one's columns state their own.
    assert!(rms(&options) < same_m);
    let mut options = options.to_vec();
    options.splice(6..8, ["--unit", "m", "--unit", "mm"]);
    assert!(rms(&options) < same_m);
    // In a study:
    let body = |with: &str| {
        format!(
            "morphology: \"{}/morphologies/tripod.ron\",
    recordings: [\"foreign.csv\"],
    {with}
    start: Settled,
    duration_s: 1.0,
    parameters: [(name: \"floor.friction\", from: 0.1, to: 0.9, points: 2)],",
            project().display()
        )
    };
    let file_of_study = study(path, &body(&format!("reading: {FOREIGN},")));
    let definition = Definition::read(&file_of_study, &Overrides::default()).unwrap();
    let expected = read(&own, LengthUnit::Metre).unwrap();
    is_near(&definition.recordings[0], &expected);
    assert!(definition.warnings.iter().any(|w| w.code == Code::ReadAs));
    // What an option says comes first.
    let overrides = Overrides {
        reading: reading("(crop: (from_s: 5.0))"),
        ..Overrides::default()
    };
    let cropped = Definition::read(&file_of_study, &overrides).unwrap();
    assert!((cropped.recordings[0].trajectory.duration_s() - 15.0).abs() < 1e-6);
    // Another way of reading is another study.
    let print = |definition| Study::new(definition).unwrap().fingerprint();
    assert_ne!(print(definition), print(cropped));
    // In meta.ron, for everybody who reads these files:
    let meta = format!(
        "(robot: \"tripod\", source: Real, description: \"\", frame: \"\", licence: \"\", reading: {FOREIGN})"
    );
    file(path, "meta.ron", &meta);
    is_near(&read(&foreign, LengthUnit::Metre).unwrap(), &expected);
    let plain = Definition::read(study(path, &body("")), &Overrides::default()).unwrap();
    is_near(&plain.recordings[0], &expected);
}

#[test]
fn an_invalid_mapping_is_refused_with_its_place() {
    let parse = |ron: &str| {
        Reading::parse(&Source::new("how.ron", ron))
            .unwrap_err()
            .to_string()
    };
    for (ron, start, words) in [
        (
            "(\n columns: (t: \"a\", xx: \"b\"),\n)",
            "how.ron:2:",
            "did you mean `x`?",
        ),
        (
            "(\n columns: (x: \"b in deg\"),\n)",
            "how.ron:2:",
            "allowed: m, cm, mm, in, ft",
        ),
        (
            "(\n columns: (t: \"b in mm\"),\n)",
            "how.ron:2:",
            "allowed: s, ms, us, ns",
        ),
        (
            "(\n columns: (qw: \"b in mm\"),\n)",
            "how.ron:2:",
            "it has no unit",
        ),
        (
            "(\n length: \"mile\",\n)",
            "how.ron:2:",
            "allowed: m, cm, mm, in, ft",
        ),
        (
            "(\n quaternion: \"xywz\",\n)",
            "how.ron:2:",
            "allowed: wxyz, xyzw",
        ),
        (
            "(\n crop: (from_s: 3.0, to_s: 2.0),\n)",
            "how.ron:2:",
            "to_s later than from_s",
        ),
        (
            "(\n lenght: \"mm\",\n)",
            "how.ron:2:",
            "did you mean `length`?",
        ),
    ] {
        let error = parse(ron);
        assert!(error.starts_with(start) && error.contains(words), "{error}");
    }
    let mapped = reading("(columns: (t: \"time\", x: \"px in mn\", y: \"py\"))");
    let error = refuse("time,px,py\n0,0,0\n1,1,1\n", mapped);
    assert!(
        error.contains("there is no column `px in mn`") && error.contains("part of the name"),
        "{error}"
    );
    let study_file = |with: &str| {
        let folder = tempfile::tempdir().unwrap();
        let robot = project().join("morphologies/cube.ron");
        let body = format!(
            "morphology: \"{}\", recordings: [\"*.csv\"], start: Settled,\n{with}\nparameters: [(name: \"floor.friction\", from: 0.1, to: 0.9, points: 2)],",
            robot.display()
        );
        let error = Definition::read(study(folder.path(), &body), &Overrides::default());
        error.unwrap_err().to_string()
    };
    let error = study_file("reading: (crop: (from_s: -1.0)),");
    assert!(
        error.contains("study.ron:3:") && error.contains("from_s of 0 or more"),
        "{error}"
    );
    let folder = tempfile::tempdir().unwrap();
    let run = file(folder.path(), "run.csv", &own_form(&walk()));
    for (option, value, words) in [
        ("--crop", "3", "FROM:TO"),
        ("--crop", "3:2", "FROM:TO"),
        ("--where", "robot", "COLUMN=VALUE"),
        ("--unit", "mile", "m, cm, mm, in, ft"),
        ("--time-unit", "min", "s, ms, us, ns"),
        ("--quaternion", "xy", "wxyz, xyzw"),
        ("--column", "time=t", "unknown content of a column"),
        ("--column", "t", "WHAT=NAME"),
    ] {
        let out = realgap()
            .arg("check")
            .arg(&run)
            .args([option, value])
            .assert()
            .code(2);
        let error = text(&out.get_output().stderr);
        assert!(error.contains(words), "{option} {value}: {error}");
    }
}

#[test]
fn every_refusal_of_a_recording_names_a_remedy_of_this_tool() {
    let usual = || Reading::default();
    for (csv, how, remedy) in [
        (
            "time,px,py\n0,0,0\n1,1,1\n",
            usual(),
            "columns: (t: \"NAME in ms\"",
        ),
        ("0,0,0\n1,1,1\n", usual(), "skip_lines: N"),
        ("t_s,x_m,y_m\n0,0,0\n2,1,1\n1,2,2\n", usual(), "sort: true"),
        (
            "t_s,x_m,y_m\n0,0,0\n1,,1\n2,2,2\n",
            usual(),
            "skip_lost: true",
        ),
        (
            "t_s,x_m,y_m\n0,0,0\n1,nan,1\n2,2,2\n",
            usual(),
            "skip_lost: true",
        ),
        (
            "t_s,x_m,y_m,qw,qx,qy,qz\n0,0,0,1,0,0,0\n1,0,0,0,0,0,0\n",
            usual(),
            "skip_lost: true",
        ),
        (
            "t_s,x_m,y_m,qw,qx,qy,qz\n0,0,0,1,0,0,0\n1,0,0,30,0,0,90\n",
            usual(),
            "columns: (",
        ),
        (
            "t_s,x_m,y_m,robot\n0,0,0,a\n0,5,5,b\n1,0,1,a\n1,5,6,b\n",
            usual(),
            "`robot` says that this file holds several recordings (a, b)",
        ),
        (
            "t_s,x_m,y_m,run\n0,0,0,1\n1,0,0,1\n0,0,0,2\n1,0,0,2\n",
            usual(),
            "only: (column:",
        ),
        (
            "t_s,x_px,y_px\n0,0,0\n1,1,1\n",
            reading("(columns: (x: \"x_px\", y: \"y_px\"))"),
            "scale: 0.0021",
        ),
        (
            "t_s,x_m,y_m\n0,0,0\n1,1,0\n2,2,0\n3,3,0\n0,5,0\n1,6,0\n2,7,0\n3,8,0\n0,9,0\n1,8,0\n2,7,0\n3,6,0\n4,5,0\n5,4,0\n6,3,0\n7,2,0\n8,1,0\n9,0,0\n10,1,0\n11,2,0\n12,3,0\n13,4,0\n14,5,0\n15,6,0\n",
            usual(),
            "split: true",
        ),
        (
            "t_s,x_m,y_m\n0,0,0\n1,1,1\n",
            reading("(crop: (from_s: 0.5))"),
            "choose another part: `crop:",
        ),
        (
            "t_s,x_m,y_m,robot\n0,0,0,a\n1,0,1,b\n",
            reading("(only: (column: \"robot\", value: \"c\"))"),
            "allowed: a, b",
        ),
    ] {
        let error = refuse(csv, how);
        assert!(error.contains(remedy), "{csv}\n{error}");
    }
    // The remedies work.
    let read = |csv: &str, how: &str| read_text(csv, reading(how));
    let rest: String = (3..22).map(|k| format!("{k},{k},{k}\n")).collect();
    let late = format!("t_s,x_m,y_m\n0,0,0\n2,2,2\n1,1,1\n2,2,2.1\n{rest}");
    let sorted = read(&late, "(sort: true)");
    assert_eq!(sorted.trajectory.times_s()[..3], [0.0, 1.0, 2.0]);
    assert_eq!(sorted.trajectory.len(), 22);
    assert_eq!(sorted.trajectory.positions_world_m()[2].y, 2.0);
    assert_eq!(
        said(&sorted, Code::SamplesSorted),
        "1 sample no later than the previous sample, the first in line 4; all samples are sorted by time"
    );
    assert_eq!(
        sorted.warnings[1].message,
        "1 sample at the same time as an earlier sample left out, at up to 0.100 m from it"
    );
    let found = read(
        "t_s,x_m,y_m\n0,0,0\n1,,1\n1.5,NaN,1\n2,2,2\n",
        "(skip_lost: true)",
    );
    assert_eq!(found.trajectory.times_s(), [0.0, 2.0]);
    assert_eq!(
        said(&found, Code::LostSamples),
        "2 samples without numbers left out"
    );
    let chosen = read(
        "t_s,x_m,y_m,run\n0,0,0,1\n1,0,0,1\n0,7,0,2\n1,0,0,2\n",
        "(only: (column: \"run\", value: \"2\"))",
    );
    assert_eq!(chosen.trajectory.positions_world_m()[0].x, 7.0);
    let below = read(
        "made by a logger\nt_s,x_m,y_m\n0,0,0\n1,1,1\n",
        "(skip_lines: 1)",
    );
    assert_eq!(below.trajectory.len(), 2);
}

#[test]
fn a_table_of_a_spreadsheet_is_read_with_its_decimal_commas() {
    let semicolons = read_text("t_s;x_m;y_m\n0;0;0\n0,5;0,08;-1,5e-1\n", LengthUnit::Metre);
    assert_eq!(semicolons.trajectory.times_s(), [0.0, 0.5]);
    let [x, y] = [0, 1].map(|i| semicolons.trajectory.positions_world_m()[1][i]);
    assert_eq!([x, y], [0.08, -0.15]);
    let tabs = read_text("t_s\tx_m\ty_m\n0\t0\t0\n1\t2\t3\n", LengthUnit::Metre);
    assert_eq!(tabs.trajectory.positions_world_m()[1].x, 2.0);
    assert!(
        refuse("t_s;x_m;y_m\n0;0;0\n1;1.000,5;0\n", LengthUnit::Metre).contains("not a number")
    );
}

#[test]
fn columns_of_runs_and_sets_may_be_called_otherwise() {
    let csv = "sensor,trial,t_s,x_m,y_m\nir,1,0,0,0\nir,1,1,1,0\nir,2,0,0,0\nir,2,1,2,0\nus,1,0,0,0\nus,1,1,3,0\n";
    let folder = tempfile::tempdir().unwrap();
    let path = file(folder.path(), "runs.csv", csv);
    let how = reading("(columns: (condition: \"sensor\", run: \"trial\"))");
    let all = read_all(&path, &how).unwrap();
    let names: Vec<&str> = all.iter().map(|r| r.name.as_str()).collect();
    assert_eq!(names, ["runs/ir/1", "runs/ir/2", "runs/us/1"]);
    let sets = realgap::trajectory::read_sets(&path, &how, None).unwrap();
    assert_eq!(sets[2].0, "us");
}
