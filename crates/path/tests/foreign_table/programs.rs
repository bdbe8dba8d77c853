//! Tables of programs for drones and arms whose names do not say what they mean: axes, milliseconds, what was sent.

use realgap_path::trajectory::{JointReading, Reading, read};

use super::{heading, place, put, recording, said, text, time_s};

#[test]
fn axes_that_point_north_east_down_are_turned_to_z_up() {
    let ned = |k: usize| {
        let [x, y, z] = place(k);
        [x, -y, -z].map(|value| value.to_string())
    };
    let airsim = text(
        "VehicleName\tTimeStamp\tPOS_X\tPOS_Y\tPOS_Z\tQ_W\tQ_X\tQ_Y\tQ_Z\tImageFile",
        "\t",
        |k| {
            let half = 0.5 * heading(k);
            let stamp = 1_714_558_520_000 + 50 * k;
            let mut row = vec!["car".to_owned(), stamp.to_string()];
            row.extend(ned(k));
            let turn = [half.cos(), 0.0, 0.0, -half.sin()];
            row.extend(turn.map(|value| value.to_string()));
            row.push(format!("img_{k}.png"));
            row
        },
    );
    let qgc = text(
        "Timestamp,roll,localPosition.x,localPosition.y,localPosition.z",
        ",",
        |k| {
            let ms = 50 * k;
            let time = format!("2024-05-01 10:15:{:02}.{:03}", 20 + ms / 1000, ms % 1000);
            [vec![time, "0.1".to_owned()], ned(k).to_vec()].concat()
        },
    );
    let ardupilot = text("timestamp,TimeUS,PN,PE,PD,VN,VE,VD", ",", |k| {
        let time = [(1e9 + time_s(k)).to_string(), (50_000 * k).to_string()];
        let rest = ["0"; 3].map(str::to_owned);
        [time.to_vec(), ned(k).to_vec(), rest.to_vec()].concat()
    });
    for (name, text, program) in [
        ("airsim_rec.txt", airsim, "AirSim"),
        ("telemetry.csv", qgc, "QGroundControl"),
        ("pos.csv", ardupilot, "ArduPilot"),
    ] {
        let recording = recording(name, &text);
        let motion = &recording.trajectory;
        assert!(said(&recording).contains(program), "{}", said(&recording));
        for (k, found) in motion.positions_world_m().iter().enumerate() {
            let [x, y, z] = place(k);
            let off = (found.x - x).abs() + (found.y - y).abs() + (found.z - z).abs();
            assert!(off < 1e-12, "{name}: {found}");
            let since_s = motion.times_s()[k] - motion.times_s()[0];
            assert!((since_s - time_s(k)).abs() < 1e-6, "{name}: {since_s}");
            if program == "AirSim" {
                let turn = motion.orientations_world_from_body().unwrap()[k];
                assert!((turn.euler_angles().2 - heading(k)).abs() < 1e-12);
            }
        }
    }
}

/// The seven columns of a quantity of libfranka.
fn seven(name: &str) -> String {
    let all: Vec<String> = (0..7).map(|joint| format!("{name}[{joint}]")).collect();
    all.join(",")
}

/// A log of libfranka in which angles, or torques, were sent; the other commands are 0.
fn franka(is_new: bool, sends_angles: bool) -> String {
    let (state, sent) = if is_new { ("state.", "cmd.") } else { ("", "") };
    let states = ["q", "q_d", "dq", "dq_d", "tau_J", "tau_ext_hat_filtered"];
    let states = states
        .map(|name| seven(&format!("{state}{name}")))
        .join(",");
    let begin = if is_new {
        "time,success_rate"
    } else {
        "duration, success rate"
    };
    let between = if is_new { "" } else { "sent commands," };
    let commands = ["q_d", "dq_d", "tau_J_d"].map(|name| seven(&format!("{sent}{name}")));
    let mut text = format!("{begin}, {states},{between}{}\n", commands.join(","));
    if is_new {
        text = text.replace(' ', "");
    }
    for k in 0..40 {
        let value = |of: f64| vec![of.to_string(); 7].join(",");
        let angle = 0.1 + 0.001 * f64::from(k);
        let zero = value(0.0);
        let states = [
            value(angle),
            value(9.0),
            value(1.0),
            zero.clone(),
            value(5.0),
            zero.clone(),
        ];
        let sent = match sends_angles {
            true => [value(angle + 0.01), zero.clone(), zero],
            false => [zero.clone(), zero, value(7.0)],
        };
        let between = if is_new { "" } else { "," };
        text += &format!("{k},1.0,{},{between}{}\n", states.join(","), sent.join(","));
    }
    text
}

#[test]
fn logs_of_libfranka_have_milliseconds_and_what_was_sent() {
    let joints: Vec<String> = (1..=7).map(|k| format!("panda_joint{k}")).collect();
    for is_new in [false, true] {
        for sends_angles in [false, true] {
            let folder = tempfile::tempdir().unwrap();
            let path = put(folder.path(), "log.csv", franka(is_new, sends_angles));
            let known = Reading::default();
            let found = JointReading::infer(&path, &known, &joints, &joints).unwrap();
            let recording = read(&path, &found.unwrap().reading).unwrap();
            let motion = &recording.trajectory;
            assert!((motion.times_s()[39] - 0.039).abs() < 1e-12);
            let joint = motion.joint("panda_joint3").unwrap();
            assert_eq!(joint.angles_rad[10], 0.11);
            assert_eq!(joint.speeds_rad_s.as_ref().unwrap()[10], 1.0);
            match sends_angles {
                true => {
                    let command = motion.joint("panda_joint3_command").unwrap();
                    assert!((command.angles_rad[10] - 0.12).abs() < 1e-12);
                }
                false => {
                    let mut signals = motion.signals().iter();
                    let torque = signals.find(|one| one.name == "panda_joint3_command_nm");
                    assert_eq!(torque.unwrap().values[10], 7.0);
                }
            }
        }
    }
}
