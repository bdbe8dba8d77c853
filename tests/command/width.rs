//! Tables fit a terminal of 80 columns, and the output about a vehicle does not mention a physics engine.

use crate::common::{project, realgap, text};

/// A row of a table has several gaps, or one and begins at the left; prose may be long, for a terminal wraps it.
fn is_row(line: &str) -> bool {
    let gaps = line.trim().split("  ").filter(|cell| !cell.is_empty());
    let gaps = gaps.count().saturating_sub(1);
    gaps >= 2 || (gaps == 1 && !line.starts_with(' '))
}

#[test]
fn no_table_of_a_command_is_wider_than_eighty_columns() {
    let folder = tempfile::tempdir().unwrap();
    let results = |name: &str| folder.path().join(name).display().to_string();
    let runs: Vec<String> = (0..10)
        .map(|run| format!("real_trajectories/tripod_mujoco/run_{run:02}.csv"))
        .collect();
    let runs = runs.join(" ");
    let search = folder.path().join("search.ron");
    let few = [
        ("evaluations: 100", "evaluations: 8"),
        ("duration_s: 20.0", "duration_s: 1.0"),
        ("repeats: 8", "repeats: 2"),
        ("count: 5, repeats: 50", "count: 2, repeats: 4"),
        ("..", &project().display().to_string()),
    ];
    let small = (few.iter()).fold(
        std::fs::read_to_string(project().join("sweeps/best_tripod_gait.ron")).unwrap(),
        |text, (from, to)| text.replace(from, to),
    );
    std::fs::write(&search, small).unwrap();
    let scans = "real_trajectories/radio_flat/scans.csv";
    let radio = "real_trajectories/radio_flat/poses.csv --session 0 --arena arenas/flat.ron";
    let commands = [
        "check sweeps/tripod_self.ron morphologies/tripod.ron vehicles/two_wheel.ron".to_owned(),
        format!("check {runs}"),
        format!("simulate morphologies/tripod.ron --duration 0.2 -o {}", results("run.csv")),
        format!("compare {runs}"),
        format!("compare {runs} --metric rms"),
        format!("sweep sweeps/two_wheel_us1.ron --points 2 -o {}", results("sweep")),
        format!("report {}", results("sweep")),
        format!("study results {}", results("sweep")),
        format!("study results {} --per-recording", results("sweep")),
        format!("tune sweeps/two_wheel_us_bayesian.ron --budget 80 -o {}", results("tune")),
        "evaluate sweeps/cube_toss_fit.ron --parameters sweeps/cube_toss_best.ron --limit-recordings 2".to_owned(),
        format!("gap sweeps/two_wheel_us1.ron --repeats 4 -o {}", results("gap")),
        "gap --recordings real_trajectories/tripod_mujoco/*.csv".to_owned(),
        format!("predict morphologies/two_module.ron --duration 1 --repeats 4 -o {}", results("predict")),
        format!("ensemble sweeps/two_wheel_us1.ron --repeats 20 -o {}", results("ensemble")),
        format!("search {} -o {}", search.display(), results("search")),
        format!("study results {}", results("search")),
        format!("robot genome random -o {}", results("genome.ron")),
        format!("robot develop {} -o {}", results("genome.ron"), results("robot.ron")),
        "study identify sweeps/cube_toss_fit.ron".to_owned(),
        "study sensitivity sweeps/two_wheel_us1.ron".to_owned(),
        format!("sense draw ultrasonic --readings 300 -o {}", results("log.csv")),
        format!("sense fit {}", results("log.csv")),
        format!("sense belief ultrasonic --distances 2,20 --log {}", results("log.csv")),
        format!("sense graph fit {scans} --to 0.7 -o {}", results("graph.ron")),
        format!("sense graph evaluate {scans} --from 0.7 --parameters {}", results("graph.ron")),
        format!("sense radio fit {radio} -o {}", results("radio.ron")),
        format!("sense radio evaluate {radio} --parameters {}", results("radio.ron")),
        format!("cluster plan sweeps/two_wheel_us1.ron --shards 3 -o {} -- --points 2", results("plan")),
        format!("cluster run {} --shard 0-1", results("plan")),
        format!("cluster status {}", results("plan")),
        "study parameters".to_owned(),
        "study schema".to_owned(),
        "study examples list".to_owned(),
    ];
    let mut tables = 0;
    for command in commands {
        let out = realgap()
            .current_dir(project())
            .args(command.split(' '))
            .assert()
            .success();
        let out = text(&out.get_output().stdout);
        for line in out.lines().filter(|line| is_row(line)) {
            tables += 1;
            let width = line.chars().count();
            assert!(width <= 80, "{command}: {width} columns: {line}");
        }
    }
    assert!(tables > 100, "{tables} rows");
}

#[test]
fn the_output_about_a_vehicle_mentions_no_physics_engine() {
    let folder = tempfile::tempdir().unwrap();
    let out = realgap()
        .current_dir(project())
        .args([
            "ensemble",
            "sweeps/two_wheel_us1.ron",
            "--repeats",
            "20",
            "-o",
        ])
        .arg(folder.path().join("ensemble"))
        .assert()
        .success();
    let said = text(&out.get_output().stdout);
    assert!(said.contains("as predicted"), "{said}");
    let json = std::fs::read_to_string(folder.path().join("ensemble/ensemble.json")).unwrap();
    for word in [
        "Rapier",
        "rapier",
        "numerics",
        "another engine",
        "second one",
    ] {
        assert!(
            !said.contains(word) && !json.contains(word),
            "{word}: {said}"
        );
    }
}
