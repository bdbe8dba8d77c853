//! Pages in a real browser: a chosen point is shown, one slider of time moves all plots, and no network is used.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

use std::path::{Path, PathBuf};

use common::browser::Browser;
use common::{realgap, text};
use serde_json::json;

/// Kinds of screens.
const WIDE: [u32; 2] = [1440, 900];
const PHONE: [u32; 2] = [375, 800];

fn run(args: &[&str]) {
    let output = realgap().args(args).output().unwrap();
    assert!(
        output.status.success(),
        "{args:?}: {}",
        text(&output.stderr)
    );
}

/// A sweep of 441 points, each a moment long: its page.
fn swept(folder: &Path) -> PathBuf {
    let root = common::project().display();
    let body = format!(
        "morphology: \"{root}/morphologies/tripod.ron\",
    recordings: [\"{root}/real_trajectories/tripod_standin/run_0[012].csv\"],
    start: Settled,
    duration_s: 0.25,
    {}
    parameters: [
        (name: \"floor.friction\", from: 0.1, to: 0.9, points: 21),
        (name: \"floor.restitution\", from: 0.0, to: 0.8, points: 21),
    ],",
        common::STANDIN_NUMERICS
    );
    let study = common::study(folder, &body);
    let out = folder.join("swept");
    run(&[
        "sweep",
        study.to_str().unwrap(),
        "--score",
        "single",
        "-o",
        out.to_str().unwrap(),
    ]);
    out.join("report.html")
}

/// Colours that the canvas shows: one would be blank.
const COLOURS: &str = "(() => { realgap.draw(); const c = document.getElementById('canvas'), d = document.createElement('canvas'); \
    d.width = c.width; d.height = c.height; const p = d.getContext('2d'); p.drawImage(c, 0, 0); \
    const data = p.getImageData(0, 0, c.width, c.height).data, all = new Set(); \
    for (let k = 0; k < data.length; k += 4) all.add(data[k] + ',' + data[k + 1] + ',' + data[k + 2]); return all.size; })()";
/// Where everything is that follows the time.
const PLACES: &str = "[...document.querySelectorAll('.live > i:not([hidden])')].map(e => e.className + e.style.left + e.style.top)";
const FITS: &str = "document.documentElement.scrollWidth <= innerWidth";

#[test]
fn a_click_in_the_map_changes_the_path_and_one_time_moves_every_plot() {
    let Some(mut browser) = Browser::start() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let page = swept(folder.path());
    let bytes = std::fs::metadata(&page).unwrap().len();
    assert!(bytes < 1_500_000, "{bytes} bytes");
    browser.look(WIDE, false);
    browser.open(&page, "");
    browser.wait("realgap.ready === true");
    assert_eq!(
        browser.value("document.querySelectorAll('[data-point]').length"),
        json!(441)
    );

    // The path of what was clicked, beside what was recorded.
    let path = "document.querySelector('#path .line.sim').getAttribute('d')";
    assert_eq!(
        browser.value("document.querySelectorAll('#path .line.real').length"),
        json!(3)
    );
    let (best, before) = (browser.value("realgap.chosen()"), browser.value(path));
    let other = usize::from(best != json!(440)) * 440;
    browser.click(&format!("[data-point='{other}']"));
    assert_eq!(browser.value("realgap.chosen()"), json!(other));
    assert_ne!(browser.value(path), before);
    assert_eq!(
        browser.value("document.querySelectorAll('#path .line.real').length"),
        json!(3)
    );
    assert_eq!(
        browser.value("document.querySelectorAll('#path .line.faint').length"),
        json!(1)
    );
    // Keys do the same.
    browser.value("document.getElementById('heat').focus()");
    let key =
        json!({ "type": "keyDown", "key": if other == 0 { "ArrowRight" } else { "ArrowLeft" } });
    browser.call("Input.dispatchKeyEvent", key);
    assert_ne!(browser.value("realgap.chosen()"), json!(other));

    // One slider for all: two cursors over time, a dot a run on the map, the robot in space.
    let before = browser.value(PLACES);
    assert_eq!(before.as_array().unwrap().len(), 2 + 3 + 1);
    browser.value("(() => { const t = document.getElementById('time'); t.value = 700; t.dispatchEvent(new Event('input')); })()");
    let after = browser.value(PLACES);
    for (a, b) in before
        .as_array()
        .unwrap()
        .iter()
        .zip(after.as_array().unwrap())
    {
        assert_ne!(a, b, "it did not move");
    }
    assert_eq!(
        browser.value("document.getElementById('now').textContent"),
        json!("0.17 s")
    );
    assert_eq!(browser.value("document.getElementById('clock').textContent.startsWith('0.17 s') || document.getElementById('clock').textContent.startsWith('0.18 s')"), json!(true));

    // The view in space is drawn only once it is visible.
    assert_eq!(browser.value("typeof realgap.draw"), json!("undefined"));
    browser.value("document.getElementById('replay').scrollIntoView({ behavior: 'instant' })");
    browser.wait("typeof realgap.draw === 'function'");
    let colours = browser.value(COLOURS).as_u64().unwrap();
    assert!(colours > 20, "{colours} colours");
    browser.is_quiet("the sweep");

    // Every screen, both themes; without scripts, too.
    for is_scripted in [true, false] {
        browser.call(
            "Emulation.setScriptExecutionDisabled",
            json!({ "value": !is_scripted }),
        );
        for (size, is_dark) in [(WIDE, true), (PHONE, false), (PHONE, true)] {
            let what = format!("{size:?}, dark: {is_dark}, scripts: {is_scripted}");
            browser.look(size, is_dark);
            browser.open(&page, "");
            assert_eq!(browser.value(FITS), json!(true), "{what}");
            assert_eq!(
                browser.value("document.querySelectorAll('#path .line.real').length"),
                json!(3),
                "{what}"
            );
            let hidden = browser.value("document.getElementById('bar').hidden");
            assert_eq!(hidden, json!(!is_scripted), "{what}");
            assert_eq!(
                browser.value("typeof realgap"),
                json!(if is_scripted { "object" } else { "undefined" }),
                "{what}"
            );
            let ground = browser.value("getComputedStyle(document.body).backgroundColor");
            assert_eq!(
                ground == json!("rgb(21, 23, 26)"),
                is_dark,
                "{what}: {ground}"
            );
            browser.is_quiet(&what);
        }
    }
}

#[test]
fn a_replay_plays_steps_and_remembers_its_moment() {
    let Some(mut browser) = Browser::start() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let page = folder.path().join("replay.html");
    let runs = "real_trajectories/tripod_standin/run_00.csv";
    run(&[
        "replay",
        "morphologies/tripod.ron",
        "--duration",
        "2",
        "--against",
        runs,
        "-o",
        page.to_str().unwrap(),
    ]);
    browser.look(WIDE, false);
    browser.open(&page, "#t=0.5");
    browser.wait("realgap.ready === true && typeof realgap.draw === 'function'");
    assert_eq!(browser.value("realgap.state().time"), json!(0.5));
    let (before, colours) = (
        browser.value(PLACES),
        browser.value(COLOURS).as_u64().unwrap(),
    );
    assert!(colours > 20, "{colours} colours");
    // Space plays, and nothing is drawn again once it stands.
    for (down, then) in [
        (
            " ",
            "realgap.state().playing && realgap.state().time > 0.55",
        ),
        (" ", "!realgap.state().playing"),
    ] {
        browser.call(
            "Input.dispatchKeyEvent",
            json!({ "type": "keyDown", "key": down }),
        );
        browser.wait(then);
    }
    assert_ne!(browser.value(PLACES), before);
    assert_eq!(
        browser.value("location.hash.startsWith('#t=')"),
        json!(true)
    );
    // What docs/validation/pages.md says of speed; other work on the machine counts, so nothing is asserted.
    let first_ms = browser.value("Math.round(realgap.first)");
    browser.value("document.getElementById('play').click()");
    let rate = "new Promise(r => { const n = realgap.frames; setTimeout(() => r((realgap.frames - n) / 2), 2000); })";
    // The first seconds find out what this machine can draw.
    let (_, rate) = (browser.value(rate), browser.value(rate));
    let quality = browser.value("realgap.quality()");
    eprintln!("first frame after {first_ms} ms, {rate} frames/s, {quality}");
    browser.value("document.getElementById('play').click()");
    let frames = "new Promise(r => setTimeout(() => { const n = realgap.frames; setTimeout(() => r(realgap.frames - n), 300); }, 300))";
    assert_eq!(
        browser.value(frames),
        json!(0),
        "it is drawn while nothing moves"
    );
    browser.is_quiet("the replay");
    for size in [WIDE, PHONE] {
        browser.look(size, true);
        browser.open(&page, "");
        assert_eq!(browser.value(FITS), json!(true), "{size:?}");
    }
}

#[test]
fn a_browser_runs_no_foreign_text_of_a_folder() {
    let Some(mut browser) = Browser::start() else {
        return;
    };
    let hostile = "</script><script>document.title='run'</script><img src=x onerror=\"document.title='run'\">]]>\u{202e}{{answer}}";
    let folder = tempfile::tempdir().unwrap();
    let number = json!({ "value": 1.0, "low": 0.5, "high": 2.0 });
    let report = json!({
        "study": hostile, "description": hostile, "source": hostile, "engine": hostile,
        "provenance": { hostile: hostile },
        "warnings": [{ "code": hostile, "message": hostile }],
        "metrics": [{ "metric": hostile, "unit": hostile, "floor": number, "ideal": { "gap": number, "ratio": number } }],
        "over_time": { "times_s": [0.0, 1.0], "ideal_m": [0.0, 1.0], "real_mean_m": [0.0, 1.0] },
    });
    std::fs::write(folder.path().join("gap.json"), report.to_string()).unwrap();
    let kept = json!({
        "command": hostile, "duration_s": 1.0, "reality": hostile, "recorded": [],
        "replay": {
            "motion": "AgACAgAAAgAAAgAA",
            "scene": {
                "steps": [1.0, 1.0, 1.0], "boxes": [], "scene": [], "floor": { "height_m": 0.0, "slope_rad": 0.0 }, "parts": 0,
                "tracks": [{ "name": hostile, "recorded": false, "parts": [] }],
            },
        },
    });
    std::fs::write(folder.path().join("page.json"), kept.to_string()).unwrap();
    run(&["report", folder.path().to_str().unwrap(), "--accept"]);
    let page = folder.path().join("report.html");
    browser.look(WIDE, false);
    browser.open(&page, "#t=1");
    browser.wait("typeof realgap === 'object'");
    let title = browser.value("document.title");
    assert!(title.as_str().unwrap().ends_with(": gap"), "{title}");
    assert_eq!(
        browser.value("document.querySelectorAll('img').length"),
        json!(0)
    );
    let asked: Vec<_> = browser
        .asked
        .iter()
        .filter(|url| !url.starts_with("file:///") || !url.contains("report.html"))
        .collect();
    assert!(asked.is_empty(), "{asked:?}");
    assert!(!std::fs::read_to_string(&page).unwrap().contains('\u{202e}'));
    // A text in place of a number is refused with the name of the file.
    let report = json!({ "metrics": [{ "floor": { "value": hostile } }] });
    std::fs::write(folder.path().join("gap.json"), report.to_string()).unwrap();
    let out = realgap()
        .args(["report", folder.path().to_str().unwrap(), "--accept"])
        .assert()
        .code(1);
    let error = text(&out.get_output().stderr);
    let names = error.contains("gap.json: not a report: invalid type");
    assert!(names && !error.contains('\u{202e}'), "{error}");
}
