//! Sensorgraphs: forward regression as SysIdentPy's, known polynomials found again, and a real scanner on a way that was left out.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]
#![allow(
    clippy::print_stdout,
    reason = "the numbers in docs/fidelity/sensing.md"
)]

mod common;

use nalgebra::{DMatrix, DVector};
use rand::RngExt;
use rand_distr::StandardNormal;
use realgap::random::Numbered;
use realgap::sensing::graph::regression::{
    Stop, count, criterion, estimate, mean_squares, monomial, monomials, order,
};
use realgap::sensing::graph::{Evaluation, Frame, GraphOptions, Language, ScanLog, fit, functions};

fn regressors(places: &[[f64; 2]], degree: u32) -> DMatrix<f64> {
    let powers = monomials(degree);
    DMatrix::from_fn(places.len(), powers.len(), |row, term| {
        monomial(powers[term], places[row])
    })
}

#[derive(serde::Deserialize)]
struct Golden {
    places: Vec<[f64; 2]>,
    values: Vec<f64>,
    powers: Vec<[u32; 2]>,
    ratios: Vec<f64>,
    coefficients: Vec<f64>,
    aic: Vec<f64>,
    bic: Vec<f64>,
}

/// Its order of terms, ratios, coefficients and criteria (tools/golden_frols.py).
#[test]
fn forward_regression_is_that_of_sysidentpy() {
    let text = common::read(&common::project().join("tests/golden"), "frols.json");
    let cases: Vec<Golden> = serde_json::from_str(&text).unwrap();
    assert_eq!(cases.len(), 4);
    let close = |what: &str, found: f64, expected: f64| {
        assert!(
            (found - expected).abs() <= 1e-8 * expected.abs().max(1.0),
            "{what}: {found} {expected}"
        );
    };
    for case in cases {
        let matrix = regressors(&case.places, 4);
        let y = DVector::from_vec(case.values.clone());
        let chosen = order(&matrix, &y, case.powers.len()).unwrap();
        let powers: Vec<[u32; 2]> = chosen.iter().map(|c| monomials(4)[c.index]).collect();
        assert_eq!(powers, case.powers);
        for (found, expected) in chosen.iter().zip(&case.ratios) {
            close("ratio", found.ratio, *expected);
        }
        let found = estimate(&matrix, &y, &chosen).unwrap();
        for (found, expected) in found.values.iter().zip(&case.coefficients) {
            close("coefficient", *found, *expected);
        }
        let squares = mean_squares(&chosen, &y);
        for (stop, expected) in [(Stop::Aic, &case.aic), (Stop::Bic, &case.bic)] {
            for (found, expected) in criterion(stop, &squares, y.len()).iter().zip(expected) {
                close("criterion", *found, *expected);
            }
        }
    }
}

#[test]
fn a_sparse_polynomial_is_found_with_its_terms_and_standard_errors_that_hold() {
    let truth = [([0, 0], 3.0), ([1, 0], 1.2), ([1, 1], -0.8), ([0, 3], 0.6)];
    let (mut right, mut held, mut asked) = (0, 0, 0);
    for seed in 0..100 {
        let mut rng = Numbered::SensorReading.generator(seed, 0);
        let places: Vec<[f64; 2]> = (0..200)
            .map(|_| [0; 2].map(|_| 2.0 * rng.random::<f64>() - 1.0))
            .collect();
        let y = DVector::from_iterator(
            200,
            places.iter().map(|place| {
                let noise: f64 = rng.sample(StandardNormal);
                truth
                    .iter()
                    .map(|(powers, value)| value * monomial(*powers, *place))
                    .sum::<f64>()
                    + 0.2 * noise
            }),
        );
        let matrix = regressors(&places, 4);
        let mut chosen = order(&matrix, &y, 12).unwrap();
        chosen.truncate(count(Stop::Bic, &chosen, &y));
        let found = estimate(&matrix, &y, &chosen).unwrap();
        let mut powers: Vec<[u32; 2]> = chosen.iter().map(|c| monomials(4)[c.index]).collect();
        for (known, value) in truth {
            if let Some(index) = powers.iter().position(|p| *p == known) {
                asked += 1;
                held +=
                    usize::from((found.values[index] - value).abs() <= 1.96 * found.errors[index]);
            }
        }
        powers.sort_unstable();
        let mut known = truth.map(|(powers, _)| powers);
        known.sort_unstable();
        right += usize::from(powers == known);
    }
    // BIC takes a needless term now and then, which does not bias the others.
    assert!(right >= 75, "{right} of 100");
    assert!(held as f64 >= 0.9 * asked as f64, "{held} of {asked}");
    // The ratio of all terms together explains what they were asked to.
    let places: Vec<[f64; 2]> = (0..50)
        .map(|k| [f64::from(k) / 50.0, (f64::from(k) * 0.37).sin()])
        .collect();
    let y = DVector::from_iterator(50, places.iter().map(|p| 1.0 + p[0] * p[1]));
    let chosen = order(&regressors(&places, 4), &y, 10).unwrap();
    let kept = count(Stop::Err(0.99), &chosen, &y);
    let sum = |n: usize| chosen[..n].iter().map(|c| c.ratio).sum::<f64>();
    assert!(sum(kept) >= 0.99 && sum(kept - 1) < 0.99);
    assert_eq!(count(Stop::Terms(3), &chosen, &y), 3);
}

#[test]
fn a_regression_that_cannot_be_is_refused() {
    let places = [[0.0, 0.0], [0.5, 0.1], [1.0, -0.2]];
    let y = DVector::from_vec(vec![1.0, 2.0, 3.0]);
    let of = |most: usize, y: &DVector<f64>| {
        order(&regressors(&places, 4), y, most).map_err(|e| e.to_string())
    };
    assert!(of(4, &y).unwrap_err().contains("more terms than samples"));
    assert!(
        of(2, &DVector::zeros(3))
            .unwrap_err()
            .contains("nothing to explain")
    );
    assert!(
        of(2, &DVector::from_vec(vec![1.0, f64::NAN, 1.0]))
            .unwrap_err()
            .contains("finite")
    );
    // The same place over and over: one term and no more.
    let same = [[0.3, 0.3]; 8];
    let chosen = order(&regressors(&same, 2), &DVector::from_element(8, 2.0), 6).unwrap();
    assert_eq!(chosen.len(), 1);
}

/// A robot that winds through a square room with a scanner all round.
fn room(scans: usize, all_round: bool) -> String {
    let step = 10;
    let (from, to) = if all_round { (0, 360) } else { (-90, 91) };
    let beams: Vec<i32> = (from..to).step_by(step).collect();
    let names: Vec<String> = beams.iter().map(|b| format!("range_{b}_m")).collect();
    let mut text = format!("t_s,x_m,y_m,heading_rad,{}\n", names.join(","));
    for k in 0..scans {
        let t = k as f64 / scans as f64;
        let (x, y, heading) = (3.0 * (9.0 * t).sin(), 3.0 * (14.0 * t).cos(), 40.0 * t);
        let range = |beam: &i32| {
            let (sin, cos) = (heading + f64::from(*beam).to_radians()).sin_cos();
            let to_x = if cos > 0.0 {
                (5.0 - x) / cos
            } else {
                (-5.0 - x) / cos
            };
            let to_y = if sin > 0.0 {
                (5.0 - y) / sin
            } else {
                (-5.0 - y) / sin
            };
            to_x.min(to_y).to_string()
        };
        let ranges: Vec<String> = beams.iter().map(range).collect();
        text += &format!(
            "{},{x},{y},{heading},{}\n",
            0.25 * k as f64,
            ranges.join(",")
        );
    }
    text
}

#[test]
fn a_room_is_foretold_on_a_way_that_was_left_out() {
    for all_round in [true, false] {
        let log = ScanLog::parse("room.csv", &room(900, all_round)).unwrap();
        assert_eq!(log.is_all_round(), all_round);
        let (first, rest) = (log.part(0.0, 0.75), log.part(0.75, 1.0));
        for frame in [Frame::Robot, Frame::World] {
            let options = GraphOptions {
                frame: Some(frame),
                ..GraphOptions::default()
            };
            let found = fit(&first, &options).unwrap();
            assert_eq!(
                found.model.segments_deg.len(),
                if all_round { 12 } else { 6 }
            );
            let held = Evaluation::new(&found.model, &rest, 1).unwrap();
            assert!(
                held.mean_absolute_error_m < held.baseline_constant_m,
                "{frame:?}: {held}"
            );
            assert!(
                held.mann_whitney_p < 0.01 && held.spearman.unwrap() > 0.3,
                "{frame:?}: {held}"
            );
        }
        let auto = fit(&first, &GraphOptions::default()).unwrap();
        assert_eq!(auto.frame, Frame::World, "walls do not turn with the robot");
        assert!(auto.world_frame_error_m < auto.robot_frame_error_m);
        assert_eq!(
            auto.model,
            fit(&first, &GraphOptions::default()).unwrap().model
        );
    }
}

/// Every polynomial is a function of any language: the same numbers as the model's, where there is something that runs them.
#[test]
fn functions_in_other_languages_say_what_the_model_says() {
    let log = ScanLog::parse("room.csv", &room(300, true)).unwrap();
    let folder = tempfile::tempdir().unwrap();
    for frame in [Frame::Robot, Frame::World] {
        let options = GraphOptions {
            frame: Some(frame),
            ..GraphOptions::default()
        };
        let model = fit(&log, &options).unwrap().model;
        let asked = [
            (0.5, -1.0, 0.3, 0),
            (2.0, 2.5, -2.9, 7),
            (-9.0, 0.0, 6.1, 11),
        ];
        let expected: Vec<f64> = asked
            .iter()
            .map(|(x, y, h, s)| model.range_m([*x, *y], *h, *s))
            .collect();
        let calls = |print: &dyn Fn(&str) -> String| -> String {
            let call = |(x, y, h, s): &(f64, f64, f64, usize)| {
                print(&format!("sensorgraph_range_m({x:?}, {y:?}, {h:?}, {s})"))
            };
            asked.iter().map(call).collect()
        };
        let check = |language: Language, output: std::process::Output| {
            assert!(output.status.success(), "{}", common::text(&output.stderr));
            let found: Vec<f64> = common::text(&output.stdout)
                .lines()
                .map(|l| l.trim().parse().unwrap())
                .collect();
            for (found, expected) in found.iter().zip(&expected) {
                assert!(
                    (found - expected).abs() < 1e-9,
                    "{language:?} {frame:?}: {found} {expected}"
                );
            }
            assert_eq!(found.len(), expected.len());
        };
        let run = |program: &str, args: &[&str]| {
            std::process::Command::new(program).args(args).output().ok()
        };
        let python =
            functions(&model, Language::Python) + &calls(&|call| format!("print(repr({call}))\n"));
        match run("python3", &["-c", &python]) {
            Some(output) => check(Language::Python, output),
            None => println!("SKIPPED: no python3"),
        }
        let c = format!(
            "{}#include <stdio.h>\nint main(void) {{\n{}return 0; }}\n",
            functions(&model, Language::C),
            calls(&|call| format!("printf(\"%.17g\\n\", {call});\n"))
        );
        let (source, program) = (folder.path().join("graph.c"), folder.path().join("graph"));
        std::fs::write(&source, c).unwrap();
        match run(
            "cc",
            &[
                source.to_str().unwrap(),
                "-o",
                program.to_str().unwrap(),
                "-lm",
            ],
        ) {
            Some(built) => {
                assert!(built.status.success(), "{}", common::text(&built.stderr));
                check(Language::C, run(program.to_str().unwrap(), &[]).unwrap());
            }
            None => println!("SKIPPED: no C compiler"),
        }
        let rust = functions(&model, Language::Rust);
        assert!(
            rust.contains("pub fn sensorgraph_range_m")
                && rust.matches(" => (").count() == model.polynomials.len() + 1
        );
    }
}

#[test]
fn a_carmen_log_is_read_as_its_csv() {
    let text = "# CARMEN Logfile\nPARAM robot_length 1\nODOM 0 0 0 0 0 0 0.1 host 0.1\n\
        FLASER 5 1.0 2.0 3.0 81.83 5.0 0.5 -0.5 3.5 0 0 0 12.5 host 12.5\n\
        FLASER 5 1.5 2.5 3.5 4.5 5.5 0.6 -0.5 -1.0 0 0 0 12.75 host 12.75\n";
    let log = ScanLog::parse("log.clf", text).unwrap();
    assert_eq!(log.scans.len(), 2);
    let degrees: Vec<f64> = log
        .beams_rad
        .iter()
        .map(|b| b.to_degrees().round())
        .collect();
    assert_eq!(degrees, [-90.0, -45.0, 0.0, 45.0, 90.0]);
    let first = &log.scans[0];
    assert_eq!((first.position_world_m, first.time_s), ([0.5, -0.5], 12.5));
    assert!((first.heading_rad - (3.5 - std::f64::consts::TAU)).abs() < 1e-12);
    assert_eq!(
        first.ranges_m,
        [Some(1.0), Some(2.0), Some(3.0), None, Some(5.0)]
    );
    for (bad, said) in [
        ("FLASER 5 1 2 3\n", "ends too early"),
        ("FLASER x 1\n", "number of beams"),
        (
            "FLASER 2 1 2 0 0 0 0 0 0 1 h 1\nFLASER 3 1 2 3 0 0 0 0 0 0 1 h 1\n",
            "same number of beams",
        ),
        ("ODOM 0 0 0 0 0 0 0 h 0\n", "no scans"),
    ] {
        let error = ScanLog::parse("log.clf", bad).unwrap_err().to_string();
        assert!(error.contains(said), "{error}");
    }
}

#[test]
fn a_bad_log_of_scans_is_told_what_is_wrong_with_it() {
    for (text, said) in [
        ("t_s,x_m,y_m,heading_rad\n0,0,0,0\n", "no ranges"),
        (
            "t_s,x_m,y_m,range_000_m\n0,0,0,1\n",
            "no column `heading_rad`",
        ),
        ("t_s,x_m,y_m,heading_rad,range_000_m\n", "no scans"),
        (
            "t_s,x_m,y_m,heading_rad,range_000_m\n0,0,0,0,-1\n",
            "cannot be negative",
        ),
        (
            "t_s,x_m,y_m,heading_rad,range_000_m\n0,nan,0,0,1\n",
            "not a finite number",
        ),
        (
            "t_s,x_m,y_m,heading_rad,range_000_m\n1,0,0,0,1\n0,0,0,0,1\n",
            "must not fall",
        ),
    ] {
        let error = ScanLog::parse("scans.csv", text).unwrap_err().to_string();
        assert!(
            error.contains(said) && error.contains("scans.csv"),
            "{error}"
        );
    }
    let still = ScanLog::parse(
        "a.csv",
        &format!(
            "t_s,x_m,y_m,heading_rad,range_000_m\n{}",
            "0,1,1,0,2\n".repeat(20)
        ),
    )
    .unwrap();
    assert!(
        fit(&still, &GraphOptions::default())
            .unwrap_err()
            .to_string()
            .contains("never moved")
    );
    let few = ScanLog::parse("a.csv", &room(5, true)).unwrap();
    assert!(
        fit(&few, &GraphOptions::default())
            .unwrap_err()
            .to_string()
            .contains("too few scans")
    );
    let seeing = room(30, true);
    let blind = seeing.lines().enumerate().map(|(k, line)| {
        let pose: Vec<&str> = line.split(',').take(4).collect();
        if k == 0 {
            format!("{line}\n")
        } else {
            format!("{}{}\n", pose.join(","), ",".repeat(36))
        }
    });
    let blind = ScanLog::parse("a.csv", &blind.collect::<String>()).unwrap();
    assert!(
        fit(&blind, &GraphOptions::default())
            .unwrap_err()
            .to_string()
            .contains("not a single beam")
    );
    // Only some headings: said, and the mean stands in.
    let log = ScanLog::parse("a.csv", &room(60, true)).unwrap();
    let options = GraphOptions {
        frame: Some(Frame::Robot),
        headings: 90,
        ..GraphOptions::default()
    };
    let found = fit(&log, &options).unwrap();
    assert_eq!(found.warnings[0].code.name(), "empty-headings");
    assert!(found.model.range_m([0.0, 0.0], 0.1, 0).is_finite());
}

/// Real scans of a furnished flat, fitted on a part of the way and held against the rest.
#[test]
fn a_real_flat_is_foretold_better_than_by_constants_and_by_the_nearest_pose() {
    let Some(folder) = common::shared_data("radio_flat") else {
        return;
    };
    let log = ScanLog::read(folder.join("scans.csv")).unwrap();
    let mut better_than_constant = 0;
    println!(
        "| fitted | tested | error | constant | nearest pose | nearest turned | rank |\n|---|---|---|---|---|---|---|"
    );
    for (fitted, tested) in [
        ((0.0, 0.7), (0.7, 1.0)),
        ((0.3, 1.0), (0.0, 0.3)),
        ((0.0, 0.5), (0.5, 1.0)),
        ((0.5, 1.0), (0.0, 0.5)),
    ] {
        let model = fit(&log.part(fitted.0, fitted.1), &GraphOptions::default()).unwrap();
        let held = Evaluation::new(&model.model, &log.part(tested.0, tested.1), 1).unwrap();
        println!(
            "| {fitted:?} | {tested:?} | {:.3} ± {:.3} m | {:.3} m | {:.3} m | {:.3} m | {:.2} |",
            held.mean_absolute_error_m,
            held.standard_error_m,
            held.baseline_constant_m,
            held.baseline_nearest_m.unwrap(),
            held.baseline_nearest_turned_m.unwrap(),
            held.spearman.unwrap()
        );
        assert_eq!(model.frame, Frame::World);
        assert!(held.mann_whitney_p < 0.05 && held.p.unwrap() < 0.05);
        better_than_constant += usize::from(held.mean_absolute_error_m < held.baseline_constant_m);
    }
    assert!(better_than_constant >= 3, "{better_than_constant} of 4");
}

#[test]
fn the_commands_fit_evaluate_and_print() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    std::fs::write(path("scans.csv"), room(400, true)).unwrap();
    let run = |args: &[&str]| {
        let output = common::realgap().args(args).output().unwrap();
        assert!(output.status.success(), "{}", common::text(&output.stderr));
        common::text(&output.stdout)
    };
    run(&[
        "sensorgraph",
        "fit",
        &path("scans.csv"),
        "--to",
        "0.7",
        "-o",
        &path("model.ron"),
    ]);
    let json = run(&[
        "sensorgraph",
        "evaluate",
        &path("scans.csv"),
        "--from",
        "0.7",
        "--parameters",
        &path("model.ron"),
        "--plot",
        &path("way.png"),
        "--segment",
        "3",
        "--format",
        "json",
    ]);
    let found: serde_json::Value = serde_json::from_str(&json).unwrap();
    for field in [
        "mean_absolute_error_m",
        "baseline_constant_m",
        "baseline_nearest_m",
        "spearman",
        "p",
    ] {
        assert!(found[field].is_f64(), "{field}: {}", found[field]);
    }
    assert!(found["mean_absolute_error_m"].as_f64() < found["baseline_constant_m"].as_f64());
    assert!(folder.path().join("way.png").is_file());
    assert!(run(&["sensorgraph", "print", &path("model.ron")]).contains("direction 30 deg:"));
    assert!(
        run(&[
            "sensorgraph",
            "print",
            &path("model.ron"),
            "--language",
            "c"
        ])
        .contains("double sensorgraph_range_m")
    );
    let bic = run(&[
        "sensorgraph",
        "fit",
        &path("scans.csv"),
        "--stop",
        "bic",
        "--frame",
        "robot",
        "--format",
        "json",
    ]);
    let bic: serde_json::Value = serde_json::from_str(&bic).unwrap();
    assert_eq!(bic["polynomials"], 144);
    let output = common::realgap()
        .args([
            "sensorgraph",
            "fit",
            &path("scans.csv"),
            "--from",
            "0.9",
            "--to",
            "0.2",
        ])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
}
