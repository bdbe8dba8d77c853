//! Tables with times of all notations, and readings that state what a table does not.

use super::Fate::{Read, Refused, Said};
use super::*;

pub(super) fn cases() -> Vec<Case> {
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
    vec![
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
            timed("time,x_m,y_m,z_m", clock),
            usual(),
            Read,
        ),
        (
            "time of day with a third colon over midnight",
            timed("time,x_m,y_m,z_m", |k| clock(k).replace('.', ":") + "000"),
            usual(),
            Read,
        ),
        (
            "dates with slashes, AM and PM over midnight",
            timed("timestamp,x_m,y_m,z_m", |k| {
                let date = date(k);
                let clock = clock(k);
                let (half, hour) = match clock.starts_with("23") {
                    true => ("PM", "11"),
                    false => ("AM", "12"),
                };
                format!(
                    "{}/{}/2024 {hour}{} {half}",
                    &date[5..7],
                    &date[8..],
                    &clock[2..]
                )
            }),
            usual(),
            Read,
        ),
        (
            "dates as in names of files",
            timed("time,x_m,y_m,z_m", |k| {
                format!("{}-{}", date(k), clock(k).replace(':', "-"))
            }),
            usual(),
            Read,
        ),
        (
            "dates with points",
            timed("time,x_m,y_m,z_m", |k| {
                let date = date(k);
                format!("{}.{}.2024 {}", &date[8..], &date[5..7], clock(k))
            }),
            usual(),
            Read,
        ),
        (
            "a time code with frames",
            timed("time,x_m,y_m,z_m", |k| {
                format!("10:15:{:02}:{:02}", 20 + k / 20, k % 20)
            }),
            usual(),
            Refused("count frames"),
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
    ]
}
