//! Tests that exported functions in other languages give the same ranges as the model.

use realgap_sensing::graph::{Frame, GraphOptions, Language, ScanLog, fit, functions};

use super::{common, room};

/// The exported functions give the same ranges as the model, for each language whose interpreter or compiler is installed.
#[test]
fn exported_functions_in_other_languages_give_the_ranges_of_the_model() {
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
        let python = functions(&model, Language::Python).unwrap()
            + &calls(&|call| format!("print(repr({call}))\n"));
        match run("python3", &["-c", &python]) {
            Some(output) => check(Language::Python, output),
            None => println!("SKIPPED: no python3"),
        }
        let c = format!(
            "{}#include <stdio.h>\nint main(void) {{\n{}return 0; }}\n",
            functions(&model, Language::C).unwrap(),
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
        let rust = functions(&model, Language::Rust).unwrap();
        assert!(
            rust.contains("pub fn sensorgraph_range_m")
                && rust.matches(" => (").count() == model.polynomials.len() + 1
        );
    }
}
