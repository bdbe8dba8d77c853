//! Tables of many programs: each is read rightly, asked about, or refused with a remedy; none is read wrongly without a word.

use realgap_path::trajectory::{InferredReading, Question, Reading, Recording, read_all};

/// Samples in every file.
const SAMPLES: usize = 60;
const INTERVAL_S: f64 = 0.05;
/// Seconds since 1970 of the first sample, where times are dates.
const EPOCH_S: u64 = 1_709_251_199;

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

fn cases() -> Vec<(&'static str, String, Reading, Fate)> {
    let usual = Reading::default;
    let metres = || plain("t_s,x_m,y_m,z_m", 1.0, 1.0);
    let ns = |k: usize| (time_ns(k) / 1_000_000_000, time_ns(k) % 1_000_000_000);
    let clock = |k: usize| {
        let (s, ns) = ns(k);
        let day = s % 86_400;
        format!(
            "{:02}:{:02}:{:02}.{:03}",
            day / 3600,
            day / 60 % 60,
            day % 60,
            ns / 1_000_000
        )
    };
    let date = |k: usize| {
        if ns(k).0 % 86_400 < 43_200 {
            "2024-03-01"
        } else {
            "2024-02-29"
        }
    };
    let two_parts = |header: &str| {
        text(header, ",", |k| {
            let [x, y, z] = place(k).map(|value| value.to_string());
            vec![ns(k).0.to_string(), ns(k).1.to_string(), x, y, z]
        })
    };
    let several = |header: &str| {
        text(header, ",", |k| {
            let [x, y, z] = place(k).map(|value| value.to_string());
            vec![
                time_s(k).to_string(),
                x,
                y,
                z,
                (3.0 * place(k)[0]).to_string(),
                "2".to_owned(),
            ]
        })
    };
    let decimal_comma = plain("Time (s);X (m);Y (m);Z (m)", 1.0, 1.0);
    let mut decimal_comma = decimal_comma.lines();
    let head = decimal_comma.next().unwrap().to_owned();
    let rows: Vec<String> = decimal_comma
        .map(|row| row.replace(',', ";").replace('.', ","))
        .collect();
    let decimal_comma = format!("{head}\n{}\n", rows.join("\n"));
    let doubled = |shift_s: f64, rows: &dyn Fn(&str, &str) -> String| {
        let one = metres();
        let other = text("", ",", |k| {
            let [x, y, z] = place(k);
            [time_s(k) + shift_s, -x, 3.0 + y, z]
                .map(|value| value.to_string())
                .to_vec()
        });
        rows(&one, &other)
    };
    let appended = |one: &str, other: &str| format!("{one}{}", other.trim_start());
    let alternating = |one: &str, other: &str| {
        let mut all = "t_s,x_m,y_m,z_m\n".to_owned();
        for (a, b) in one.lines().skip(1).zip(other.lines().skip(1)) {
            all += &format!("{a}\n{b}\n");
        }
        all
    };
    vec![
        ("own form", metres(), usual(), Read),
        (
            "own form in millimetres",
            plain("t_ms,x_mm,y_mm,z_mm", 1e3, 1e3),
            usual(),
            Read,
        ),
        (
            "inches",
            plain("time_s,x_in,y_in,z_in", 1.0, 1.0 / 0.0254),
            usual(),
            Read,
        ),
        (
            "feet",
            plain("time [s],x [ft],y [ft],z [ft]", 1.0, 1.0 / 0.3048),
            usual(),
            Read,
        ),
        (
            "words for units",
            plain(
                "Time (milliseconds),X (inches),Y (inches),Z (inches)",
                1e3,
                1.0 / 0.0254,
            ),
            usual(),
            Read,
        ),
        (
            "names with brackets",
            plain("Time (s),X [cm],Y [cm],Z [cm]", 1.0, 1e2),
            usual(),
            Read,
        ),
        (
            "axis last",
            plain("TimeStamp,Position X,Position Y,Position Z", 1.0, 1.0),
            usual(),
            Said("taken for metres"),
        ),
        (
            "axis first",
            plain("elapsed,x_position,y_position,z_position", 1.0, 1.0),
            usual(),
            Said("taken for metres"),
        ),
        (
            "fused",
            plain("time,PosX,PosY,PosZ", 1.0, 1.0),
            usual(),
            Said("taken for metres"),
        ),
        (
            "short",
            plain("t,px,py,pz", 1.0, 1.0),
            usual(),
            Said("taken for metres"),
        ),
        (
            "planar, timestamp px py theta",
            headed("timestamp,px,py,theta", 1.0),
            usual(),
            Turned,
        ),
        (
            "yaw beside t_s",
            headed("t_s,x_m,y_m,yaw", 1.0),
            usual(),
            Turned,
        ),
        (
            "yaw beside time",
            headed("time,x_m,y_m,yaw", 1.0),
            usual(),
            Turned,
        ),
        (
            "degrees in the name",
            headed("t_s,x_m,y_m,heading_deg", 180.0 / std::f64::consts::PI),
            usual(),
            Turned,
        ),
        (
            "rosbag columns",
            posed(
                "header.stamp,pose.pose.position.x,pose.pose.position.y,pose.pose.position.z,pose.pose.orientation.x,pose.pose.orientation.y,pose.pose.orientation.z,pose.pose.orientation.w",
                ",",
            ),
            usual(),
            Turned,
        ),
        (
            "rostopic echo -p",
            {
                text(
                    "%time,field.header.seq,field.header.stamp,field.header.frame_id,field.pose.position.x,field.pose.position.y,field.pose.position.z",
                    ",",
                    |k| {
                        let [x, y, z] = place(k).map(|value| value.to_string());
                        vec![
                            (time_ns(k) + 7_000_000 + k as u64).to_string(),
                            k.to_string(),
                            time_ns(k).to_string(),
                            "odom".to_owned(),
                            x,
                            y,
                            z,
                        ]
                    },
                )
            },
            usual(),
            Said("further times are not used: %time"),
        ),
        (
            "PlotJuggler",
            posed(
                "__time,/odom/pose/position/x,/odom/pose/position/y,/odom/pose/position/z,/odom/pose/orientation/x,/odom/pose/orientation/y,/odom/pose/orientation/z,/odom/pose/orientation/w",
                ",",
            ),
            usual(),
            Turned,
        ),
        (
            "TUM with a header",
            posed("# timestamp tx ty tz qx qy qz qw", " "),
            usual(),
            Turned,
        ),
        (
            "TUM with a glued comment",
            posed("#timestamp tx ty tz qx qy qz qw", " "),
            usual(),
            Turned,
        ),
        (
            "spaces",
            posed("timestamp tx ty tz q_x q_y q_z q_w", " "),
            usual(),
            Turned,
        ),
        (
            "tabs",
            posed("timestamp\ttx\tty\ttz\tq_x\tq_y\tq_z\tq_w", "\t"),
            usual(),
            Turned,
        ),
        ("decimal commas", decimal_comma, usual(), Read),
        (
            "comments between",
            metres().replacen("\n1,", "\n% the robot turns\n# here\n1,", 1),
            usual(),
            Read,
        ),
        (
            "comments before",
            format!("# recorded 2024\n# by nobody\n{}", metres()),
            usual(),
            Read,
        ),
        (
            "lines before",
            format!(
                "Tracker 3\nversion,1\n\n{}",
                plain("time,x [m],y [m],z [m]", 1.0, 1.0)
            ),
            usual(),
            Said("names the columns"),
        ),
        (
            "a row of units",
            metres()
                .replacen("t_s,x_m,y_m,z_m", "time,x,y,z\nms,mm,mm,mm", 1)
                .replacen("time,x,y,z\nms,mm,mm,mm", "time,x,y,z\ns,m,m,m", 1),
            usual(),
            Read,
        ),
        (
            "a row of other units",
            plain("t,x,y,z\n[ms],[mm],[mm],[mm]", 1e3, 1e3),
            usual(),
            Read,
        ),
        (
            "separators at the ends of lines",
            metres().replace('\n', ",\n"),
            usual(),
            Read,
        ),
        (
            "separators at the ends of rows only",
            metres().replace('\n', ",\n").replacen(",\n", "\n", 1),
            usual(),
            Read,
        ),
        (
            "byte order mark, quotes, CRLF",
            format!(
                "\u{feff}{}",
                metres()
                    .replacen("t_s,x_m,y_m,z_m", "\"t_s\",\"x_m\",\"y_m\",\"z_m\"", 1)
                    .replace('\n', "\r\n")
            ),
            usual(),
            Read,
        ),
        (
            "an index without name",
            text(",t_s,x_m,y_m", ",", |k| {
                let [x, y, _] = place(k).map(|value| value.to_string());
                vec![k.to_string(), time_s(k).to_string(), x, y]
            }),
            usual(),
            Read,
        ),
        (
            "sec and nanosec",
            two_parts("sec,nanosec,x,y,z"),
            usual(),
            Said("taken for metres"),
        ),
        (
            "secs and nsecs",
            two_parts(
                ".header.stamp.secs,.header.stamp.nsecs,.pose.position.x,.pose.position.y,.pose.position.z",
            ),
            usual(),
            Said("t_ns from"),
        ),
        (
            "stamp_sec and stamp_nanosec",
            two_parts("stamp_sec,stamp_nanosec,x_m,y_m,z_m"),
            usual(),
            Said("t_ns from"),
        ),
        (
            "nanoseconds since 1970",
            timed("timestamp,x_m,y_m,z_m", |k| time_ns(k).to_string()),
            usual(),
            Said("times are in nanoseconds"),
        ),
        (
            "milliseconds since 1970",
            timed("timestamp,x_m,y_m,z_m", |k| {
                (time_ns(k) / 1_000_000).to_string()
            }),
            usual(),
            Said("times are in milliseconds"),
        ),
        (
            "seconds since 1970",
            timed("timestamp,x_m,y_m,z_m", |k| {
                format!("{}.{:09}", ns(k).0, ns(k).1)
            }),
            usual(),
            Said("times are in seconds"),
        ),
        (
            "unpadded nanoseconds",
            timed("time,x_m,y_m,z_m", |k| format!("{}.{}", ns(k).0, ns(k).1)),
            usual(),
            Said("whole nanoseconds"),
        ),
        (
            "ISO 8601",
            timed("time,x_m,y_m,z_m", |k| format!("{}T{}Z", date(k), clock(k))),
            usual(),
            Read,
        ),
        (
            "ISO 8601 with a space and an offset",
            timed("datetime,x_m,y_m,z_m", |k| {
                format!("{} {}+01:00", date(k), clock(k))
            }),
            usual(),
            Read,
        ),
        (
            "ISO 8601 with a comma",
            timed("t,x_m,y_m,z_m", |k| {
                format!("\"{}T{}\"", date(k), clock(k).replace('.', ","))
            }),
            usual(),
            Read,
        ),
        (
            "time of day over midnight",
            timed("time,x_m,y_m,z_m", &clock),
            usual(),
            Read,
        ),
        (
            "milliseconds since boot",
            plain("time_boot_ms,x,y,z", 1e3, 1.0),
            usual(),
            Said("taken for metres"),
        ),
        (
            "ArduPilot",
            plain("TimeUS,PX,PY,PZ", 1e6, 1.0),
            usual(),
            Said("in us"),
        ),
        (
            "microseconds without a unit",
            plain("timestamp,x_m,y_m,z_m", 1e6, 1.0),
            usual(),
            Said("times are in microseconds"),
        ),
        (
            "t in usec",
            plain("t_usec,x_m,y_m,z_m", 1e6, 1.0),
            usual(),
            Read,
        ),
        (
            "several time columns",
            text("time,computation_time,x_m,y_m", ",", |k| {
                let [x, y, _] = place(k).map(|value| value.to_string());
                vec![time_s(k).to_string(), "0.002".to_owned(), x, y]
            }),
            usual(),
            Read,
        ),
        (
            "a goal beside the pose",
            text("t,x,y,goal_x,goal_y", ",", |k| {
                let [x, y, _] = place(k).map(|value| value.to_string());
                vec![time_s(k).to_string(), x, y, "5".to_owned(), "5".to_owned()]
            }),
            usual(),
            Read,
        ),
        (
            "velocities beside the pose",
            text("t,x,y,twist.linear.x,twist.linear.y", ",", |k| {
                let [x, y, _] = place(k).map(|value| value.to_string());
                vec![time_s(k).to_string(), x, y, "5".to_owned(), "5".to_owned()]
            }),
            usual(),
            Read,
        ),
        (
            "frames with a rate",
            text("frame,x_m,y_m", ",", |k| {
                let [x, y, _] = place(k).map(|value| value.to_string());
                vec![(100 + k).to_string(), x, y]
            }),
            stated("(rate_hz: 20)"),
            Read,
        ),
        (
            "no times, with a rate",
            text("x_m,y_m", ",", |k| {
                place(k)[..2].iter().map(f64::to_string).collect()
            }),
            stated("(rate_hz: 20)"),
            Read,
        ),
        (
            "pixels with a scale",
            plain("t_s,x_px,y_px,z_px", 1.0, 500.0),
            stated("(scale: 0.002)"),
            Read,
        ),
        (
            "a unit in a name against a stated one",
            metres(),
            stated("(length: \"mm\")"),
            Read,
        ),
        (
            "a wrong name that is mapped",
            plain("t_s,x_m,y_m,z_m", 1.0, 100.0),
            stated("(columns: (x: \"x_m in cm\", y: \"y_m in cm\", z: \"z_m in cm\"))"),
            Read,
        ),
        (
            "late samples",
            {
                let text = metres();
                let mut lines: Vec<&str> = text.lines().collect();
                lines.swap(20, 21);
                lines.join("\n")
            },
            usual(),
            Said("sorted by time"),
        ),
        // Questions.
        (
            "odometry and a filter in one file",
            several("t,odom_x,odom_y,z,amcl_x,amcl_y"),
            usual(),
            Asked(Question::Body),
        ),
        (
            "two bodies of a tracker",
            several("t,pose.a.x,pose.a.y,z,pose.b.x,pose.b.y"),
            usual(),
            Asked(Question::Body),
        ),
        (
            "millimetres that nothing states",
            plain("t,x,y,z", 1.0, 1e3),
            usual(),
            Asked(Question::Length),
        ),
        (
            "an appended run",
            doubled(0.002, &appended),
            usual(),
            Asked(Question::Split),
        ),
        (
            "a clock that was set back",
            {
                let rows = text("t_s,x_m,y_m,z_m", ",", |k| {
                    let [x, y, z] = place(k);
                    let time_s = time_s(k) - if k < 30 { 0.0 } else { 0.3 };
                    [time_s, x, y, z].map(|value| value.to_string()).to_vec()
                });
                rows
            },
            usual(),
            Asked(Question::Split),
        ),
        (
            "rows of two bodies at the same times",
            doubled(0.0, &alternating),
            usual(),
            Asked(Question::Split),
        ),
        (
            "rows of two bodies between each other",
            doubled(0.02, &alternating),
            usual(),
            Asked(Question::Split),
        ),
        (
            "slow times without a unit",
            plain("t,x_m,y_m", 10.0, 1.0).replace(",0.1\n", "\n"),
            usual(),
            Asked(Question::Time),
        ),
        // Refused.
        (
            "latitude and longitude",
            plain("time,latitude,longitude,altitude", 1.0, 1e-5),
            usual(),
            Refused("metres east and north"),
        ),
        (
            "frames without a rate",
            text("frame,x_m,y_m", ",", |k| {
                vec![k.to_string(), "1".to_owned(), "2".to_owned()]
            }),
            usual(),
            Refused("`frame` counts samples"),
        ),
        (
            "no times",
            text("x_m,y_m", ",", |_| vec!["1".to_owned(), "2".to_owned()]),
            usual(),
            Refused("rate_hz"),
        ),
        (
            "pixels without a scale",
            plain("t_s,x_px,y_px,z_px", 1.0, 500.0),
            usual(),
            Refused("scale"),
        ),
        (
            "two columns of one quantity",
            several("t,x,y,z,pos_x,w"),
            usual(),
            Refused("same quantity"),
        ),
        (
            "speeds alone",
            plain("t,vx,vy,vz", 1.0, 1.0),
            usual(),
            Refused("both x and y"),
        ),
        (
            "samples in no order",
            {
                let text = metres();
                let lines: Vec<&str> = text.lines().collect();
                let rows = (0..SAMPLES).map(|k| lines[1 + (k * k + 7 * k) % 59]);
                std::iter::once(lines[0])
                    .chain(rows)
                    .collect::<Vec<_>>()
                    .join("\n")
            },
            usual(),
            Refused("does not increase"),
        ),
    ]
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
