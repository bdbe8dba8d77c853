//! Tables that leave a question open, and tables that cannot be read.

use super::Fate::{Asked, Refused};
use super::*;

pub(super) fn cases() -> Vec<Case> {
    let usual = Reading::default;
    let metres = || plain("t_s,x_m,y_m,z_m", 1.0, 1.0);
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
                text("t_s,x_m,y_m,z_m", ",", |k| {
                    let [x, y, z] = place(k);
                    let time_s = time_s(k) - if k < 30 { 0.0 } else { 0.3 };
                    [time_s, x, y, z].map(|value| value.to_string()).to_vec()
                })
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
