//! Tables of many programs: each is read rightly, asked about, or refused with a remedy; none is read wrongly without a word.

mod joint_text;
mod motion_capture;
mod named;
mod numpy;
mod old;
mod open;
mod opensim;
mod programs;
mod stamped;
mod unnamed;

use realgap_path::trajectory::{InferredReading, Question, Reading, Recording, read, read_all};

/// Samples in every file.
const SAMPLES: usize = 60;
const INTERVAL_S: f64 = 0.05;
/// Seconds since 1970 of the first sample, where times are dates.
const EPOCH_S: u64 = 1_709_251_199;

fn put(folder: &std::path::Path, name: &str, content: impl AsRef<[u8]>) -> std::path::PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, content).unwrap();
    path
}

/// The recording of a file that leaves no question.
fn recording(name: &str, text: &str) -> Recording {
    let folder = tempfile::tempdir().unwrap();
    let path = put(folder.path(), name, text);
    let inferred = InferredReading::without_questions(&path, &Reading::default()).unwrap();
    read(&path, &inferred.reading).unwrap()
}

/// All warnings of a recording.
fn said(recording: &Recording) -> String {
    let all = recording
        .warnings
        .iter()
        .map(|warning| warning.message.as_str());
    all.collect::<Vec<_>>().join("\n")
}

/// The place of sample `k`: a robot that drives along x and swings along y.
fn place(k: usize) -> [f64; 3] {
    let k = k as f64;
    [1.0 + 0.02 * k, 0.05 * (0.1 * k).sin(), 0.1]
}

fn heading(k: usize) -> f64 {
    (0.005 * (0.1 * k as f64).cos()).atan2(0.02)
}

fn time_s(k: usize) -> f64 {
    INTERVAL_S * k as f64
}

/// Nanoseconds since 1970; the first second ends after half of the samples.
fn time_ns(k: usize) -> u64 {
    EPOCH_S * 1_000_000_000 + 5_000_000 + 50_000_000 * k as u64
}

fn text(header: &str, separator: &str, row: impl Fn(usize) -> Vec<String>) -> String {
    let rows = (0..SAMPLES).map(|k| row(k).join(separator));
    let all: Vec<String> = std::iter::once(header.to_owned()).chain(rows).collect();
    all.join("\n") + "\n"
}

/// The usual table: time and place in these units, comma-separated.
fn plain(header: &str, second: f64, metre: f64) -> String {
    text(header, ",", |k| {
        let [x, y, z] = place(k).map(|value| value * metre);
        [time_s(k) * second, x, y, z]
            .map(|value| value.to_string())
            .to_vec()
    })
}

/// As [`plain`], with times as any text.
fn timed(header: &str, time: impl Fn(usize) -> String) -> String {
    text(header, ",", |k| {
        let [x, y, z] = place(k).map(|value| value.to_string());
        vec![time(k), x, y, z]
    })
}

/// As [`plain`], with a heading in place of z.
fn headed(header: &str, angle: f64) -> String {
    text(header, ",", |k| {
        let [x, y, _] = place(k);
        [time_s(k), x, y, heading(k) * angle]
            .map(|value| value.to_string())
            .to_vec()
    })
}

/// As [`plain`], with a quaternion whose real part is last.
fn posed(header: &str, separator: &str) -> String {
    text(header, separator, |k| {
        let [x, y, z] = place(k);
        let half = 0.5 * heading(k);
        [time_s(k), x, y, z, 0.0, 0.0, half.sin(), half.cos()]
            .map(|value| value.to_string())
            .to_vec()
    })
}

/// What has to become of a file.
enum Fate {
    /// One recording with all samples, at the right times and places.
    Read,
    /// As `Read`, with the right headings.
    Turned,
    /// As `Read`, and the evidence contains these words.
    Said(&'static str),
    /// This question is asked.
    Asked(Question),
    /// It is refused with these words.
    Refused(&'static str),
}
use Fate::{Asked, Read, Refused, Said, Turned};

fn stated(ron: &str) -> Reading {
    Reading::parse(&realgap_core::file::Source::new("reading.ron", ron)).unwrap()
}

/// A recording is right if its steps are: the origin of times may be any.
fn check(name: &str, recording: &Recording, is_turned: bool) {
    let motion = &recording.trajectory;
    assert_eq!(motion.len(), SAMPLES, "{name}");
    for k in 0..SAMPLES {
        let since_s = motion.times_s()[k] - motion.times_s()[0];
        assert!(
            (since_s - time_s(k)).abs() < 1e-6,
            "{name}: {since_s} s at sample {k}"
        );
        let [x, y, _] = place(k);
        let found = motion.positions_world_m()[k];
        let far = (found.x - x).hypot(found.y - y);
        assert!(far < 1e-6, "{name}: {far} m off at sample {k}");
        if is_turned {
            let turn = motion.orientations_world_from_body().expect(name)[k];
            let (_, _, yaw) = turn.euler_angles();
            assert!((yaw - heading(k)).abs() < 1e-9, "{name}: {yaw}");
        }
    }
}

/// A name, the text of the file, the reading that is known, and what has to become of it.
type Case = (&'static str, String, Reading, Fate);

fn cases() -> Vec<Case> {
    let all = [named::cases(), stamped::cases(), open::cases()];
    all.into_iter().flatten().collect()
}

#[test]
fn no_table_of_another_program_is_read_wrongly_without_a_word() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.csv");
    let all = cases();
    assert!(all.len() >= 40);
    for (name, text, known, fate) in all {
        std::fs::write(&path, &text).unwrap();
        let inferred = InferredReading::of_file(&path, &known);
        let said = format!("{inferred:?}");
        match fate {
            Refused(words) => {
                let error = inferred.expect_err(name).to_string();
                assert!(error.contains(words), "{name}: {error}");
            }
            Asked(question) => {
                let open = inferred.expect(name).ambiguities;
                let asked: Vec<_> = open.iter().map(|open| open.question.clone()).collect();
                assert_eq!(asked, [question], "{name}: {said}");
                let error = InferredReading::without_questions(&path, &known).expect_err(name);
                assert!(!error.advice().is_empty(), "{name}: {error}");
            }
            Read | Turned | Said(_) => {
                let inferred = inferred.unwrap_or_else(|error| panic!("{name}: {error}"));
                assert_eq!(inferred.ambiguities, [], "{name}");
                let read = read_all(&path, &inferred.reading);
                let read = read.unwrap_or_else(|error| panic!("{name}: {error}"));
                assert_eq!(read.len(), 1, "{name}");
                check(name, &read[0], matches!(fate, Turned));
                if let Said(words) = fate {
                    assert!(said.contains(words), "{name}: {said}");
                }
            }
        }
    }
}

/// The lengths of the recordings of a file that is split.
fn split(text: &str) -> Vec<(String, usize)> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("twice.csv");
    std::fs::write(&path, text).unwrap();
    let all = read_all(&path, stated("(split: true)")).unwrap();
    all.iter()
        .map(|one| (one.name.clone(), one.trajectory.len()))
        .collect()
}

#[test]
fn runs_and_bodies_in_one_file_are_split_on_request_and_no_sample_is_lost() {
    let both = [
        ("twice/1".to_owned(), SAMPLES),
        ("twice/2".to_owned(), SAMPLES),
    ];
    let mut found = 0;
    for (name, text, _, fate) in cases() {
        if matches!(fate, Asked(Question::Split)) {
            let parts = split(&text);
            let samples: usize = parts.iter().map(|(_, samples)| samples).sum();
            assert_eq!(samples, text.lines().count() - 1, "{name}");
            assert_eq!(parts.len(), 2, "{name}");
            found += usize::from(parts == both);
        }
    }
    assert_eq!(
        found, 3,
        "the clock that was set back has parts of half the length"
    );
    // A file with one run stays one recording.
    assert_eq!(
        split(&plain("t_s,x_m,y_m,z_m", 1.0, 1.0)),
        [("twice".to_owned(), SAMPLES)]
    );
}

#[test]
fn a_step_back_is_named_with_its_rows_and_sorting_is_refused_where_it_mixes_runs() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.csv");
    let refuse = |text: &str, ron: &str| {
        std::fs::write(&path, text).unwrap();
        read_all(&path, stated(ron)).unwrap_err().to_string()
    };
    for (name, text, _, fate) in cases() {
        let is_two = matches!(fate, Asked(Question::Split));
        if is_two && name != "rows of two bodies between each other" {
            let error = refuse(&text, "(sort: true)");
            assert!(
                error.contains("in line") && error.contains("split: true"),
                "{name}: {error}"
            );
        }
    }
    let (_, appended, ..) = cases()
        .into_iter()
        .find(|case| case.0 == "an appended run")
        .unwrap();
    let error = refuse(&appended, "()");
    assert!(error.contains("0.002 after 2.95 in line 62"), "{error}");
    assert!(
        error.contains("2 runs in one file") && error.contains("clock"),
        "{error}"
    );
}

#[test]
fn stamps_of_two_files_of_one_clock_are_equal_to_the_bit() {
    let folder = tempfile::tempdir().unwrap();
    let read = |name: &str, text: String| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        let inferred = InferredReading::without_questions(&path, &Reading::default()).unwrap();
        read_all(&path, &inferred.reading)
            .unwrap()
            .swap_remove(0)
            .trajectory
    };
    let (whole, rest) = (
        |k| time_ns(k) / 1_000_000_000,
        |k| time_ns(k) % 1_000_000_000,
    );
    let ns = read(
        "ns.csv",
        timed("stamp,x_m,y_m,z_m", |k| time_ns(k).to_string()),
    );
    let decimal = read(
        "s.csv",
        timed("stamp,x_m,y_m,z_m", |k| {
            format!("{}.{:09}", whole(k), rest(k))
        }),
    );
    let parts = read(
        "parts.csv",
        text("sec,nanosec,x_m,y_m", ",", |k| {
            let [x, y, _] = place(k).map(|value| value.to_string());
            vec![whole(k).to_string(), rest(k).to_string(), x, y]
        }),
    );
    assert_eq!(ns.times_s(), decimal.times_s());
    assert_eq!(parts.times_s(), decimal.times_s());
}

#[test]
fn a_rate_for_files_without_times_leaves_stamped_files_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.csv");
    std::fs::write(&path, plain("t_s,x_m,y_m,z_m", 1.0, 1.0)).unwrap();
    let read = read_all(&path, stated("(rate_hz: 7)")).unwrap();
    check("stamped", &read[0], false);
    assert!(read[0].warnings.is_empty(), "{:?}", read[0].warnings);
    // Frames that the camera has dropped are gaps.
    std::fs::write(&path, "frame,x_m,y_m\n10,0,0\n11,1,0\n14,4,0\n").unwrap();
    let read = read_all(&path, stated("(rate_hz: 10)")).unwrap();
    assert_eq!(read[0].trajectory.times_s(), [1.0, 1.1, 1.4]);
}

#[test]
fn a_stated_unit_is_not_asked_again() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("far.csv");
    // A way of 1.2 km of a robot of 10 cm.
    std::fs::write(&path, plain("t,x,y,z", 1.0, 1e3)).unwrap();
    let body_m = Some(0.1);
    let infer = |known: &Reading| {
        let paths = [path.clone()];
        InferredReading::infer(&paths, known, body_m).unwrap()
    };
    let known = stated("(length: \"m\", axes: \"world\")");
    let guess = infer(&known);
    assert_eq!(guess.ambiguities, [], "{guess:?}");
    assert!(format!("{guess:?}").contains("doubtful"), "{guess:?}");
    let asked = infer(&stated("(axes: \"world\", length: \"mm\")"));
    assert_eq!(asked.ambiguities, []);
}
