//! `realgap sense radio` as a command: its output and its errors.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

use common::schema::answer;
use realgap::sensing::arena::{Anchor, Arena};
use realgap::sensing::radio::{Link, LogBase, RadioModel};

fn known() -> RadioModel {
    RadioModel {
        values: vec![-42.0, 1.9, 6.0],
        reference_distance_m: 1.0,
        log_base: LogBase::Ten,
        robot_height_m: 0.3,
        ..RadioModel::paper002()
    }
}

fn run(args: &[&str]) -> (i32, String, String) {
    let done = common::realgap().args(args).output().unwrap();
    let code = done.status.code().unwrap();
    (code, common::text(&done.stdout), common::text(&done.stderr))
}

#[test]
fn the_command_fits_evaluates_maps_and_sends() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (log, model, map) = (path("log.csv"), path("radio.ron"), path("map.svg"));
    let flat = "arenas/flat.ron";
    let arena = Arena::read(common::project().join(flat)).unwrap();
    let mut text = String::from("session,x_m,y_m,anchor_1_dbm,anchor_4_dbm\n");
    for k in 0..200 {
        let at_m = [
            1.0 + 0.035 * f64::from(k),
            3.0 + libm::sin(0.1 * f64::from(k)),
        ];
        let dbm = ["1", "4"].map(|name| {
            let anchor: &Anchor = arena.anchors.iter().find(|a| a.name == name).unwrap();
            let link = Link::new(&arena, known().robot_at(at_m), anchor.position_m);
            known().strength_dbm(&link) + f64::from(k % 7) - 3.0
        });
        text += &format!(
            "{},{},{},{},{}\n",
            k % 2,
            at_m[0],
            at_m[1],
            dbm[0],
            if k == 5 { 100.0 } else { dbm[1] }
        );
    }
    std::fs::write(&log, &text).unwrap();
    let (code, json, said) = run(&[
        "sense",
        "radio",
        "fit",
        &log,
        "--session",
        "0",
        "--arena",
        flat,
        "-o",
        &model,
        "--format",
        "json",
    ]);
    assert_eq!(code, 0, "{said}");
    let fitted = answer("radio-fit", &json);
    assert_eq!(fitted["readings"], 200);
    let (code, json, said) = run(&[
        "sense",
        "radio",
        "evaluate",
        &log,
        "--session",
        "1",
        "--arena",
        flat,
        "--parameters",
        &model,
        "--fingerprints",
        &log,
        "--fingerprint-session",
        "0",
        "--format",
        "json",
    ]);
    assert_eq!(code, 0, "{said}");
    assert!(said.contains("impossible-readings"), "{said}");
    let seen = answer("radio-evaluate", &json);
    assert!(seen["rmse_db"].as_f64().unwrap() < 3.0 && seen["coverage_90"].as_f64().unwrap() > 0.8);
    assert_eq!(seen["anchors"][1]["anchor"], "4");
    assert_eq!(
        run(&[
            "sense",
            "radio",
            "map",
            "--arena",
            flat,
            "--parameters",
            &model,
            "--anchor",
            "4",
            "--plot",
            &map
        ])
        .0,
        0
    );
    assert!(std::fs::read_to_string(&map).unwrap().contains("anchor 4"));
    let send = [
        "sense",
        "radio",
        "send",
        "--arena",
        flat,
        "--parameters",
        &model,
        "--from",
        "1,6",
        "--to",
        "8,5",
        "--format",
        "json",
    ];
    let (code, first, _) = run(&send);
    assert_eq!((code, &first), (0, &run(&send).1));
    answer("radio-send", &first);
    assert_eq!(run(&["check", flat, &model]).0, 0);
}

#[test]
fn bad_logs_arenas_and_models_are_refused_with_the_allowed_values() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path.to_str().unwrap().to_owned()
    };
    let flat = "arenas/flat.ron";
    let refused = |log: &str, arena: &str, more: &[&str], expected: &[&str]| {
        let mut args = vec!["sense", "radio", "fit", log, "--arena", arena];
        args.extend(more);
        let (code, _, said) = run(&args);
        assert_eq!(
            code,
            if more.contains(&"--model") { 2 } else { 1 },
            "{said}"
        );
        for word in expected {
            assert!(said.contains(word), "{word} is missing in {said}");
        }
    };
    let good = write(
        "good.csv",
        "x_m,y_m,anchor_1_dbm\n1,1,-50\n3,1,-60\n5,5,-62\n7,6,-64\n1,6,-65\n",
    );
    refused(
        &write("a.csv", "t_s,anchor_1_dbm\n0,-50\n"),
        flat,
        &[],
        &["x_m", "a.csv:1"],
    );
    refused(
        &write("b.csv", "x_m,y_m\n0,1\n"),
        flat,
        &[],
        &["no strengths", "_dbm"],
    );
    refused(
        &write("c.csv", "x_m,y_m,anchor_1_dbm\n0,1,loud\n"),
        flat,
        &[],
        &["c.csv:2", "loud"],
    );
    refused(
        &write("d.csv", "x_m,y_m,anchor_1_dbm\n0,1,5\n1,1,0\n1,1,100\n"),
        flat,
        &[],
        &[
            "no signal was received",
            "3 of 0 dBm or more",
            "-120 and 0 dBm",
        ],
    );
    refused(&write("empty.csv", ""), flat, &[], &["the log is empty"]);
    refused(
        &write("rows.csv", "x_m,y_m,anchor_1_dbm\n"),
        flat,
        &[],
        &["no rows"],
    );
    refused(
        &write("nan.csv", "x_m,y_m,anchor_1_dbm\nNaN,1,-50\n"),
        flat,
        &[],
        &["nan.csv:2", "NaN", "a finite number"],
    );
    refused(
        &write("e.csv", "x_m,y_m,anchor_9_dbm\n1,1,-50\n"),
        flat,
        &[],
        &["anchor", "9", "1, 2, 3, 4, 5, 6"],
    );
    refused(
        &write("f.csv", "x_m,y_m,anchor_1_dbm\n1,1,-50\n1.1,1,-50\n"),
        flat,
        &[],
        &["too few places"],
    );
    refused(
        &write("g.csv", "x_m,y_m,anchor_1_dbm\n-50,1,-50\n-60,2,-51\n"),
        flat,
        &[],
        &["outside of the arena"],
    );
    refused(&good, flat, &["--session", "2"], &["session"]);
    refused(
        &good,
        "arenas/cartons.ron",
        &[],
        &["this arena has no anchors"],
    );
    refused(
        &good,
        flat,
        &["--model", "wall"],
        &["walls", "did you mean"],
    );
    let twice = write(
        "twice.ron",
        r#"Arena(name: "a", size_m: (5, 5), boundary: Open, anchors: [(name: "1", position_m: (1, 1, 1)), (name: "1", position_m: (2, 1, 1))])"#,
    );
    refused(
        &good,
        &twice,
        &[],
        &["twice.ron:1", "a name that no other anchor has"],
    );
    let bad = write("bad.ron", r#"(propagation: "walls", values: [-40, 2])"#);
    let (code, _, said) = run(&[
        "sense",
        "radio",
        "evaluate",
        &good,
        "--arena",
        flat,
        "--parameters",
        &bad,
    ]);
    assert!(code == 1 && said.contains("wall_loss_db"), "{said}");
}

/// Doubtful input is fitted with a warning, and parameters that six strengths cannot determine are marked as not determined.
#[test]
fn doubtful_logs_and_arenas_get_warnings() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path.to_str().unwrap().to_owned()
    };
    let rows = "x_m,y_m,anchor_1_dbm\n1,1,-50\n3,1,-60\n5,5,-62\n7,6,-64\n1,6,-65\n4,3,-60\n";
    let (good, loud) = (
        write("good.csv", rows),
        write("loud.csv", &format!("{rows}2,2,5\n3,3,0\n")),
    );
    let arena = |name: &str, walls: &str| {
        let anchors = "anchors: [(name: \"1\", position_m: (1, 1, 1))]";
        let text = format!(
            "Arena(name: \"a\", size_m: (10, 10), boundary: Open, walls: [{walls}], {anchors})"
        );
        write(name, &text)
    };
    let open = arena("open.ron", "");
    let walled = arena(
        "walled.ron",
        "(from_m: (0.5, 1), to_m: (1.8, 1), thickness_m: 0.3), (from_m: (0, 4.5), to_m: (10, 4.5), thickness_m: 0.1)",
    );
    let fitted = |log: &str, arena: &str, more: &[&str], warnings: &[&str]| {
        let mut args = vec![
            "sense", "radio", "fit", log, "--arena", arena, "--format", "json",
        ];
        args.extend(more);
        let (code, json, said) = run(&args);
        assert_eq!(code, 0, "{said}");
        for code in warnings {
            assert!(said.contains(code), "{code} is missing in {said}");
        }
        serde_json::from_str::<serde_json::Value>(&json).unwrap()
    };
    let found = fitted(&loud, &open, &[], &["impossible-readings", "no-walls"]);
    assert_eq!(
        (&found["readings"], &found["missing"]),
        (&6.into(), &2.into())
    );
    fitted(&good, &walled, &[], &["anchor-in-wall", "few-places"]);
    let (code, _, said) = run(&[
        "sense", "radio", "fit", &good, "--arena", &open, "--model", "walls",
    ]);
    assert!(
        code == 1 && said.contains("no link crosses a wall") && said.contains("without walls"),
        "{said}"
    );
    // Six readings at six places with errors of 1.7 dB leave every parameter uncertain: every interval must be wider than 1.
    let found = fitted(&good, &open, &["--model", "log-distance"], &[]);
    for parameter in found["parameters"].as_array().unwrap() {
        let [low, high] = ["low", "high"].map(|key| parameter[key].as_f64().unwrap());
        assert!(high - low > 1.0, "{parameter}");
    }
}
