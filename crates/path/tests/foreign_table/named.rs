//! Tables whose names, units and lines are those of other programs.

use super::Fate::{Read, Said, Turned};
use super::*;

pub(super) fn cases() -> Vec<Case> {
    let usual = Reading::default;
    let metres = || plain("t_s,x_m,y_m,z_m", 1.0, 1.0);
    let decimal_comma = plain("Time (s);X (m);Y (m);Z (m)", 1.0, 1.0);
    let mut decimal_comma = decimal_comma.lines();
    let head = decimal_comma.next().unwrap().to_owned();
    let rows: Vec<String> = decimal_comma
        .map(|row| row.replace(',', ";").replace('.', ","))
        .collect();
    let decimal_comma = format!("{head}\n{}\n", rows.join("\n"));
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
    ]
}
