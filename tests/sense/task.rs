//! `realgap sense tasks` as a command: its output and its errors.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

fn run(args: &[&str]) -> (i32, String, String) {
    let done = common::realgap().args(args).output().unwrap();
    (
        done.status.code().unwrap(),
        common::text(&done.stdout),
        common::text(&done.stderr),
    )
}

#[test]
fn the_command_compares_draws_and_times_and_its_errors_name_the_allowed_values() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path.to_str().unwrap().to_owned()
    };
    let real = write(
        "real.csv",
        "robot,duration_s\na,10\na,12\na,11\nb,30\nb,28\nb,33\nc,5\n",
    );
    let simulated = write(
        "sim.csv",
        "robot,duration_s,surface\na,11,x\na,9,x\na,12,x\nb,25,x\nb,35,x\nb,30,x\n",
    );
    let [plot, curves] =
        ["p.svg", "c.svg"].map(|name| folder.path().join(name).to_str().unwrap().to_owned());
    let (code, json, said) = run(&[
        "sense", "tasks", "compare", &real, &simulated, "--plot", &plot, "--curves", &curves,
        "--format", "json",
    ]);
    assert_eq!(code, 0, "{said}");
    for warning in ["columns-ignored", "unmatched-conditions", "few-repeats"] {
        assert!(said.contains(warning), "{warning}: {said}");
    }
    let found = common::schema::answer("tasks", &json);
    assert_eq!(found["conditions"].as_array().unwrap().len(), 2);
    assert!(std::fs::read_to_string(&plot).unwrap().contains("robot=a"));
    assert!(
        std::fs::read_to_string(&curves)
            .unwrap()
            .contains("share not finished")
    );
    let way = write("way.csv", "t_s,x_m,y_m\n0,0,0\n1,1,0\n2,2,0\n3,3,0\n");
    let (code, csv, said) = run(&[
        "sense",
        "tasks",
        "time",
        &way,
        "--reach",
        "2,0",
        "--within",
        "0.5",
        "--condition",
        "robot=a",
    ]);
    assert_eq!(
        (code, csv.as_str()),
        (0, "robot,run,duration_s,finished\na,0,1.5,1\n"),
        "{said}"
    );
    for (text, expected) in [
        ("robot\na\n", "duration_s"),
        ("duration_s\n-1\n", "above 0"),
        ("duration_s\n0\n", "above 0"),
        ("duration_s\nNaN\n", "a finite number"),
        ("duration_s\ninf\n", "a finite number"),
        ("duration_s\n1e300\n", "at most 1000000000"),
        ("", "the log is empty"),
        ("time\n3\n", "no column `duration_s`"),
        ("duration_s\nfast\n", "not a number"),
        ("duration_s,finished\n3,perhaps\n", "yes or no"),
        ("duration_s\n", "no trials"),
        ("robot,duration_s\nz,3\n", "no condition in common"),
    ] {
        let bad = write("bad.csv", text);
        let (code, _, said) = run(&["sense", "tasks", "compare", &real, &bad]);
        assert!(code == 1 && said.contains(expected), "{expected}: {said}");
        assert!(
            said.contains("bad.csv") || said.contains("no condition"),
            "{said}"
        );
    }
    let slow = write("slow.csv", "duration_s\n700000\n3\n");
    let (code, _, said) = run(&["sense", "tasks", "compare", &slow, &slow]);
    assert!(
        code == 0 && said.contains("long-task") && !said.contains("--time-unit"),
        "{said}"
    );
    for (reach, within) in [
        ("NaN,0", "0.5"),
        ("2", "0.5"),
        ("2,0", "NaN"),
        ("0,0", "0.5"),
    ] {
        let (code, _, said) = run(&[
            "sense", "tasks", "time", &way, "--reach", reach, "--within", within,
        ]);
        assert!(
            code != 0 && said.contains("error"),
            "{reach} {within}: {said}"
        );
    }
}
