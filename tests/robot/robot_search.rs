//! The search for robots: failures with reasons, the same bits however it runs, finalists that survive or are marked.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use common::{
    SMALL_SEARCH, project, read, realgap, search_file, start_on_one_thread, summary, text,
};
use realgap::file::Source;
use realgap::optimization::{Ending, Progress, RunOptions};
use realgap::robot::genome::{Gene, Genome};
use realgap::search::{EvaluatedRobot, Mode, Overrides, Reason, Search};
use realgap::store::{RobotRow, Store};

/// This text inside `Search( … )`.
fn parse(body: &str) -> realgap::Result<Search> {
    let source = Source::new(
        project().join("sweeps/test.ron"),
        format!("Search(\n{body}\n)"),
    );
    Search::parse(&source, &Overrides::default())
}

fn search(body: &str) -> Search {
    parse(body).unwrap()
}

fn error(body: &str) -> String {
    parse(body).unwrap_err().to_string()
}

fn evaluate(search: &Search, genes: &[[f64; 10]]) -> EvaluatedRobot {
    let genome = Genome::new(genes.iter().map(|g| Gene::clamped(*g)).collect()).unwrap();
    search.evaluate(0, &genome).unwrap()
}

/// An active cube whose driven face looks along +x (0), −x, +y, −y, +z (4), −z (5), under a passive one.
fn walker(face: f64) -> [[f64; 10]; 2] {
    [
        [
            0.9,
            0.0,
            0.0,
            face / 6.0 + 0.01,
            0.0,
            0.0,
            1.0,
            1.0,
            0.0,
            0.5,
        ],
        [0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    ]
}

const QUICK: &str =
    "strategy: Evolution(population: 4, generations: 2), duration_s: 0.5, repeats: 2,
    finalists: (count: 2, repeats: 3),";

#[test]
fn every_reason_to_fail_is_reached_and_has_no_fitness() {
    let of =
        |extra: &str, genes: &[[f64; 10]]| evaluate(&search(&format!("{QUICK} {extra}")), genes);
    // A second servo whose plate would be glued onto the first one's.
    let mut on_servo = walker(4.0);
    on_servo[1] = [
        0.9,
        0.0,
        0.0,
        5.0 / 6.0 + 0.01,
        0.0,
        0.0,
        0.5,
        0.5,
        0.0,
        0.5,
    ];
    // Found by searches; rounded where that changes nothing.
    let leaning = [
        [
            0.798, 0.388, 0.864, 0.977, 0.978, 0.053, 0.97, 0.927, 0.656, 0.778,
        ],
        [
            0.871, 0.419, 0.962, 0.54, 0.365, 0.26, 0.904, 0.914, 0.188, 0.958,
        ],
    ];
    let blocked = [
        [
            0.458, 0.424, 0.934, 0.314, 0.411, 0.247, 0.947, 0.048, 0.942, 0.456,
        ],
        [
            0.789, 0.457, 0.853, 0.014, 0.931, 0.856, 0.174, 0.058, 0.295, 0.976,
        ],
        [
            0.969, 0.464, 0.171, 0.621, 0.727, 0.808, 0.484, 0.447, 0.424, 0.061,
        ],
    ];
    // The plate of one module reaches into the cube that another turns; soft contacts let it in Rapier.
    let tangled = [
        [
            0.798, 0.388, 0.731, 0.977, 0.978, 0.053, 0.97, 0.955, 0.975, 0.778,
        ],
        [
            0.798, 0.388, 0.886, 0.977, 0.978, 0.053, 0.97, 0.927, 0.975, 0.778,
        ],
    ];
    for (expected, robot) in [
        (Reason::DoesNotDevelop, of("", &on_servo)),
        (Reason::PlateBlocked, of("", &blocked)),
        (Reason::Toppled, of("", &leaning)),
        (
            Reason::SelfPenetrating,
            of("set: {\"solver.engine\": 0, \"contact.natural_frequency_hz\": 60, \"contact.damping_ratio\": 10},", &tangled),
        ),
        // On a slope of ice nothing comes to rest.
        (
            Reason::NotSettled,
            of("set: {\"floor.slope_rad\": 0.5, \"floor.friction\": 0.0},", &[[0.1; 10]]),
        ),
        // Too light for its servo, which throws it.
        (
            Reason::Flying,
            of(
                "failures: (unstable: false, plate_blocked: false, overlap_body_lengths: 1e6),
                 development: (active_mass_kg: 0.000001, passive_mass_kg: 0.000001, plate_mass_kg: 0.000001, servo_gain_1_s: 100000,
                    servo_max_torque_nm: 10000, servo_max_speed_rad_s: 10000, amplitude_rad: (1000, 1000), frequency_hz: (100, 100)),",
                &walker(0.0),
            ),
        ),
        // A kilometre down a slope of ice.
        (
            Reason::Diverged,
            evaluate(
                &search(
                    "strategy: Evolution(), duration_s: 20.0, repeats: 1, failures: (unstable: false),
                     set: {\"floor.slope_rad\": 0.5, \"floor.friction\": 0.0},",
                ),
                &[[0.1; 10]],
            ),
        ),
    ] {
        assert_eq!(robot.failure().map(|f| f.reason), Some(expected), "{robot:?}");
        assert_eq!(robot.fitness(), None);
    }
}

#[test]
fn a_lone_passive_cube_is_legal_and_goes_nowhere() {
    let robot = evaluate(&search(QUICK), &[[0.1; 10]]);
    assert!(robot.failure().is_none(), "{robot:?}");
    assert!(robot.fitness().unwrap() < 1e-3, "{robot:?}");
}

#[test]
fn an_invalid_search_is_refused_with_the_place_of_the_error() {
    let good = "duration_s: 1.0, strategy: Evolution(population: 4),";
    for (body, words) in [
        (
            "duration_s: 0.0, strategy: Evolution(),",
            vec!["duration_s", "0.01"],
        ),
        (
            "duration_s: 1.0, strategy: Evolution(population: 0),",
            vec!["test.ron:2", "population"],
        ),
        (
            "duration_s: 1.0, strategy: Evolution(variation: (crossover: \"sawing\")),",
            vec!["sawing", "one-point"],
        ),
        (
            "duration_s: 1.0, strategy: Evolution(variation: (mutation_rate: NaN)),",
            vec!["mutation_rate", "NaN"],
        ),
        (
            "duration_s: 1.0, strategy: Annealing(),",
            vec!["Annealing", "Evolution"],
        ),
        (
            "duration_s: 1.0, strategy: MapElites(),",
            vec!["archive without descriptors"],
        ),
        (
            "duration_s: 1.0, strategy: MapElites(axes: [(name: \"beauty\", from: 0, to: 1, cells: 2)]),",
            vec!["beauty", "height_m"],
        ),
        (
            "duration_s: 1.0, strategy: CmaEs(),",
            vec!["start", "Morphology"],
        ),
        (
            "duration_s: 1.0, strategy: CmaEs(genes: [\"kind\"]), start: Morphology(\"../morphologies/tripod.ron\"),",
            vec!["body is fixed", "kind"],
        ),
        (
            "duration_s: 1.0, strategy: Evolution(), start: Morphology(\"../morphologies/tripod.ron\"),",
            vec!["start"],
        ),
        (
            &format!("{good} objective: (measure: SpeedPerVolt),"),
            vec!["SpeedPerVolt", "SpeedPerEnergy"],
        ),
        (
            &format!("{good} objective: (aggregate: LowerQuantile(1.5)),"),
            vec!["1.5", "0 to 1"],
        ),
        (
            &format!("{good} parameters: [(name: \"floor.friction\", low: 0.5, high: 0.3)],"),
            vec!["wrong order"],
        ),
        (
            &format!("{good} parameters: [(name: \"floor.fricton\", low: 0.5, high: 0.3)],"),
            vec!["floor.friction"],
        ),
        (&format!("{good} repeats: 0,"), vec!["repeats"]),
        (
            &format!("{good} finalists: (tolerance: NaN),"),
            vec!["tolerance"],
        ),
        (
            &format!("{good} development: (side_m: NaN),"),
            vec!["side_m"],
        ),
        (&format!("{good} speling: 1,"), vec!["speling"]),
    ] {
        let message = error(body);
        for word in words {
            assert!(message.contains(word), "{body}\n{message}");
        }
    }
}

/// All results that must not depend on how a search was run.
fn results(folder: &Path) -> String {
    let mut best: Vec<PathBuf> = std::fs::read_dir(folder.join("best"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "ron"))
        .collect();
    best.sort();
    assert!(!best.is_empty());
    let mut all = read(folder, "history.csv") + &read(folder, "summary.json");
    for path in best {
        all += &std::fs::read_to_string(path).unwrap();
    }
    all
}

#[test]
fn threads_and_kill_9_do_not_change_a_bit_and_everything_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let file = search_file(folder.path(), SMALL_SEARCH);
    let run = |out: &Path, more: &[&str]| {
        let mut command = realgap();
        command
            .arg("search")
            .arg(&file)
            .args(more)
            .arg("-o")
            .arg(out);
        command.assert()
    };
    let whole = folder.path().join("whole");
    run(&whole, &["--jobs", "1"]).success();
    let threads = folder.path().join("threads");
    let said = run(&threads, &["--jobs", "3", "--format", "json"]).success();
    assert_eq!(results(&whole), results(&threads));
    let said: serde_json::Value = serde_json::from_str(&text(&said.get_output().stdout)).unwrap();
    assert_eq!(said, summary(&threads));
    assert_eq!(said["robots"], 14);

    let killed = folder.path().join("killed");
    let mut process = start_on_one_thread("search", &file, &killed);
    wait_for_robots(&killed, 3);
    process.kill().unwrap();
    process.wait().unwrap();
    let refused = run(&killed, &[]).code(1);
    let said = text(&refused.get_output().stderr);
    assert!(said.contains("--resume"), "{said}");
    run(&killed, &["--resume"]).success();
    assert_eq!(results(&whole), results(&killed));
    // Another seed is another search.
    let refused = run(&killed, &["--resume", "--seed", "9"]).code(1);
    assert!(text(&refused.get_output().stderr).contains("seed"));

    for picture in ["fitness", "gallery", "paths"] {
        for ending in ["png", "svg"] {
            let path = whole.join(format!("{picture}.{ending}"));
            assert!(
                std::fs::metadata(&path).unwrap().len() > 3_000,
                "{}",
                path.display()
            );
        }
    }
    let best = &summary(&whole)["best"][0];
    let file = best["file"].as_str().unwrap();
    let card: serde_json::Value =
        serde_json::from_str(&read(&whole.join("best"), &format!("{file}.json"))).unwrap();
    assert!(
        card["prediction"]["displacement_m"]["q05"].is_number(),
        "{card}"
    );
    assert_eq!(card["reruns"].as_array().unwrap().len(), 7);
    // What was found can be used by every other command.
    for ending in ["ron", "genome.ron"] {
        let path = whole.join("best").join(format!("{file}.{ending}"));
        realgap().arg("check").arg(path).assert().success();
    }
}

#[test]
fn results_in_memory_and_in_a_folder_are_equal_also_after_an_interruption() {
    let folder = tempfile::tempdir().unwrap();
    let search = search(SMALL_SEARCH);
    let whole = search.run(&RunOptions::default()).unwrap();
    assert_eq!(whole.robots.len(), search.strategy().budget());

    let stop = AtomicBool::new(false);
    let halfway = |progress: Progress| stop.store(progress.done >= 7, Ordering::Relaxed);
    let interrupted = RunOptions {
        stop: Some(&stop),
        progress: Some(&halfway),
        ..RunOptions::default()
    };
    let part = search
        .run_in(folder.path(), Mode::Start, &interrupted)
        .unwrap();
    assert_eq!(part.ending, Ending::Interrupted);
    assert!(part.robots.len() < whole.robots.len());
    let resumed = search
        .run_in(folder.path(), Mode::Resume, &RunOptions::default())
        .unwrap();
    assert_eq!(resumed, whole);
    // Complete results are used without a new simulation.
    let first = std::sync::Mutex::new(None);
    let hear = |progress: Progress| {
        first.lock().unwrap().get_or_insert(progress.done);
    };
    let options = RunOptions {
        progress: Some(&hear),
        ..RunOptions::default()
    };
    let again = search.run_in(folder.path(), Mode::Start, &options).unwrap();
    // All of the first batch is there before anything is simulated.
    let first = first.into_inner().unwrap().unwrap();
    assert_eq!((&again, first), (&whole, whole.batches[0]));
    // Equal to the bit, which `==` does not say of zeros.
    let bits = |results: &realgap::search::SearchResults| -> Vec<Option<u64>> {
        let fitness = results.robots.iter().map(EvaluatedRobot::fitness);
        fitness.map(|f| f.map(f64::to_bits)).collect()
    };
    assert_eq!(bits(&resumed), bits(&whole));
}

fn wait_for_robots(folder: &Path, count: usize) {
    let started = Instant::now();
    while started.elapsed() < Duration::from_secs(60) {
        if let Ok(store) = Store::<RobotRow>::look(folder)
            && store
                .finished()
                .is_ok_and(|finished| finished.len() >= count)
        {
            return;
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    panic!("no {count} robots in {} after a minute", folder.display());
}

#[test]
fn an_archive_is_written_and_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let file = search_file(
        folder.path(),
        "strategy: MapElites(initial: 8, batch: 4, evaluations: 16, variation: (max_modules: 3), axes: [
            (name: \"modules\", from: 0.5, to: 3.5, cells: 3), (name: \"active_faces\", from: -0.5, to: 3.5, cells: 4)]),
         duration_s: 0.5, repeats: 2, finalists: (count: 2, repeats: 3),",
    );
    let out = folder.path().join("out");
    realgap()
        .arg("search")
        .arg(&file)
        .arg("-o")
        .arg(&out)
        .assert()
        .success();
    let archive = read(&out, "archive.csv");
    assert!(
        archive
            .starts_with("modules_cell,active_faces_cell,modules,active_faces,robot,fitness,unit")
    );
    let filled = summary(&out)["archive"][0].as_u64().unwrap();
    assert_eq!(archive.lines().count() as u64, 1 + filled);
    assert!(std::fs::metadata(out.join("archive.png")).unwrap().len() > 3_000);
}

#[test]
fn shipped_searches_are_sound() {
    for name in ["best_robot", "best_tripod_gait", "best_worm", "robot_grid"] {
        let path = project().join(format!("sweeps/{name}.ron"));
        let out = realgap().arg("check").arg(path).assert().success();
        assert!(text(&out.get_output().stdout).contains("search by"));
    }
}

#[cfg(unix)]
#[test]
fn ctrl_c_saves_draws_and_exits_with_130() {
    let folder = tempfile::tempdir().unwrap();
    let file = search_file(
        folder.path(),
        "strategy: Evolution(population: 200, generations: 1, variation: (max_modules: 2)), duration_s: 5.0,",
    );
    let out = folder.path().join("out");
    let mut process = start_on_one_thread("search", &file, &out);
    wait_for_robots(&out, 3);
    let pid = process.id().to_string();
    assert!(
        Command::new("kill")
            .args(["-INT", &pid])
            .status()
            .unwrap()
            .success()
    );
    assert_eq!(process.wait().unwrap().code(), Some(130));
    let summary = summary(&out);
    assert_eq!(summary["complete"], false);
    let robots = summary["robots"].as_u64().unwrap();
    assert!((3..200).contains(&robots), "{robots}");
    assert_eq!(read(&out, "history.csv").lines().count() as u64, 1 + robots);
}

#[test]
fn speed_per_energy_can_be_searched_for_and_cards_show_the_cost_of_transport() {
    let search = search(
        "strategy: Grid(genes: [(gene: \"frequency\", values: [0.3, 0.6])]),
         start: Morphology(\"../morphologies/tripod.ron\"), duration_s: 4.0, repeats: 2,
         development: (amplitude_rad: (0.0, 1.2), frequency_hz: (0.5, 1.5), offset_rad: (-1.0, 1.0)),
         objective: (measure: SpeedPerEnergy, from_s: 1.0), finalists: (count: 1, repeats: 3),",
    );
    let found = search.run(&RunOptions::default()).unwrap();
    for robot in found.robots.iter().filter_map(EvaluatedRobot::performance) {
        for travel in &robot.repeats {
            assert!(travel.servo_j.unwrap() > 0.0, "{travel:?}");
        }
    }
    let finalists = search.finalists(&found, &RunOptions::default()).unwrap();
    let card = finalists[0].card();
    let finals = card.finals.as_ref().unwrap();
    let economy = finals.economy.unwrap();
    // Quantiles of ratios are not ratios of sums, but near.
    let metres_per_joule = finals.fitness.unwrap();
    assert!((metres_per_joule * economy.joules_per_metre - 1.0).abs() < 0.3);
    assert!(economy.residual_share < 0.02, "{economy:?}");
    assert_eq!(finals.unit.label(), "m/J");
    assert!(card.to_string().contains("cost of transport"));
}
