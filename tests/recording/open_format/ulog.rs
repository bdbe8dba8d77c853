//! Logs of PX4: bytes as the published format says, and what pyulog reads in them and writes again.

use std::path::Path;

use nalgebra::Vector3;
use realgap::trajectory::{Reading, read};

use super::common::python_with;
use super::{put, python};

/// A message with its length and kind.
fn message(kind: u8, body: &[u8]) -> Vec<u8> {
    let size = u16::try_from(body.len()).unwrap().to_le_bytes();
    [size.as_slice(), &[kind], body].concat()
}

fn floats(values: &[f32]) -> Vec<u8> {
    values
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect()
}

/// A flight: north at 2 m/s, half as fast to the east, rising; turning by yaw; four motors. With `more`, an odometry, too.
fn flight(more: bool) -> Vec<u8> {
    let mut log = b"ULog\x01\x12\x35\x01".to_vec();
    log.extend(1000_u64.to_le_bytes());
    log.extend(message(b'B', &[0; 40]));
    let formats = [
        "point:float x;float y;",
        "vehicle_local_position:uint64_t timestamp;float x;float y;float z;float vx;float vy;float vz;bool xy_valid;bool z_valid;uint8_t[2] _padding0;",
        "vehicle_attitude:uint64_t timestamp;float[4] q;",
        "actuator_motors:uint64_t timestamp;float[4] control;",
        "vehicle_odometry:uint64_t timestamp;float[3] position;float[4] q;float[3] velocity;float[3] angular_velocity;uint8_t pose_frame;uint8_t velocity_frame;",
        "other:uint64_t timestamp;point[2] corners;char[4] name;",
    ];
    for format in formats {
        log.extend(message(b'F', format.as_bytes()));
    }
    log.extend(message(b'I', b"\x0fchar[3] sys_nameabc"));
    for (number, topic) in [
        "vehicle_local_position",
        "vehicle_attitude",
        "actuator_motors",
        "vehicle_odometry",
        "other",
    ]
    .iter()
    .enumerate()
    .filter(|(_, topic)| more || **topic != "vehicle_odometry")
    {
        let head = [0, number as u8, 0];
        log.extend(message(b'A', &[head.as_slice(), topic.as_bytes()].concat()));
    }
    let mut data = |number: u8, time_us: u64, body: &[u8]| {
        let time = time_us.to_le_bytes();
        log.extend(message(
            b'D',
            &[&[number, 0], time.as_slice(), body].concat(),
        ));
    };
    for k in 0..100_u16 {
        let time_us = 5_000_000 + 10_000 * u64::from(k);
        let s = 0.01 * f32::from(k);
        let half = 0.15 * s;
        let q = floats(&[half.cos(), 0.0, 0.0, half.sin()]);
        data(1, time_us, &q);
        if k % 2 == 0 {
            let place = floats(&[2.0 * s, s, -0.5 * s, 2.0, 1.0, -0.5]);
            data(0, time_us + 3, &[place.as_slice(), &[1, 1]].concat());
            data(2, time_us + 1, &floats(&[0.5, 0.25, s, f32::NAN]));
            if more {
                let own = [
                    floats(&[2.0 * s, s, -0.5 * s]),
                    q,
                    floats(&[2.0, 1.0, -0.5, 0.0, 0.0, 0.3]),
                ]
                .concat();
                data(3, time_us, &[own.as_slice(), &[1, 1]].concat());
            }
        }
        data(
            4,
            time_us,
            &[floats(&[0.0; 4]).as_slice(), b"abcd"].concat(),
        );
    }
    log.extend(message(b'O', &40_u16.to_le_bytes()));
    log
}

fn of(topic: &str) -> Reading {
    Reading {
        topic: Some(topic.to_owned()),
        ..Reading::default()
    }
}

fn must_be_the_flight(path: &Path, reading: Reading) -> Vec<String> {
    let recording = read(path, reading).unwrap();
    let motion = &recording.trajectory;
    assert_eq!(motion.len(), 50);
    let last = motion.positions_world_m()[49];
    // North, west, up.
    let wanted = Vector3::new(1.96, -0.98, 0.49);
    assert!((last - wanted).norm() < 1e-6, "{last}");
    let turn = motion.orientations_world_from_body().unwrap()[49];
    // Clockwise seen from above.
    assert!(
        (turn.euler_angles().2 + 0.3 * 0.98).abs() < 1e-6,
        "{:?}",
        turn.euler_angles()
    );
    // Positions alone come without turning, with which a speed is complete.
    if let Some(speeds) = motion.velocities_world_m_s() {
        let wanted = Vector3::new(2.0, -1.0, 0.5);
        assert!((speeds[20] - wanted).norm() < 1e-6, "{}", speeds[20]);
    }
    assert!((motion.times_s()[1] - motion.times_s()[0] - 0.02).abs() < 1e-9);
    recording
        .warnings
        .iter()
        .map(|w| w.message.clone())
        .collect()
}

#[test]
fn a_flight_is_read_with_z_up_and_its_attitude_and_several_paths_are_asked_about() {
    let folder = tempfile::tempdir().unwrap();
    let path = put(folder.path(), "flight.ulg", flight(false));
    let said = must_be_the_flight(&path, Reading::default()).join("\n");
    assert!(
        said.contains("z up") && said.contains("vehicle_attitude"),
        "{said}"
    );
    assert!(said.contains("40 ms were not recorded"), "{said}");
    let path = put(folder.path(), "both.ulg", flight(true));
    let error = read(&path, Reading::default()).unwrap_err().to_string();
    assert!(
        error.contains("vehicle_local_position (50 messages); vehicle_odometry (50 messages)"),
        "{error}"
    );
    must_be_the_flight(&path, of("vehicle_local_position"));
    let said = must_be_the_flight(&path, of("vehicle_odometry")).join("\n");
    let odometry = read(&path, of("vehicle_odometry")).unwrap().trajectory;
    assert!(odometry.velocities_world_m_s().is_some());
    assert!(said.contains("not read: vehicle_local_position"), "{said}");
    let error = read(&path, of("other")).unwrap_err().to_string();
    assert!(error.contains("no positions with this name"), "{error}");
}

#[test]
fn a_log_that_is_cut_off_or_damaged_is_said_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    let whole = flight(true);
    let mut said = 0;
    for share in 0..200 {
        let cut = &whole[..whole.len() * share / 200 + 1];
        let path = put(folder.path(), "cut.ulg", cut);
        // A log may end behind any message: the rest is as if the vehicle had been switched off.
        if let Ok(recording) = read(&path, of("vehicle_odometry")) {
            let is_said =
                |w: &realgap::Warning| w.message.contains("ends in the middle of a message");
            said += usize::from(recording.warnings.iter().any(is_said));
        }
    }
    assert!(said > 100, "{said}");
    for (at, byte) in (16..whole.len())
        .zip([0, 255, 128, 7].iter().cycle())
        .step_by(11)
    {
        let mut damaged = whole.clone();
        damaged[at] = *byte;
        let path = put(folder.path(), "damaged.ulg", &damaged);
        // No panic, whatever is read.
        let _ = read(&path, of("vehicle_local_position"));
    }
    for short in [
        message(b'A', b""),
        message(b'D', b"\x00"),
        message(b'D', &[9, 9, 9]),
        message(b'F', b"endless:endless[9] a;"),
    ] {
        let mut log = whole.clone();
        log.extend(short);
        log.extend(message(b'A', b"\0\x09\0endless"));
        let path = put(folder.path(), "hostile.ulg", &log);
        let error = read(&path, of("vehicle_odometry")).unwrap_err().to_string();
        assert!(error.contains("the log is damaged"), "{error}");
    }
}

#[test]
fn pyulog_reads_the_same_and_what_it_writes_is_read() {
    let Some(program) = python_with("pyulog") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    put(folder.path(), "flight.ulg", flight(true));
    let script = "
from pyulog import ULog
log = ULog('flight.ulg')
p = log.get_dataset('vehicle_local_position').data
assert len(p['x']) == 50 and abs(p['x'][49] - 1.96) < 1e-6 and abs(p['z'][49] + 0.49) < 1e-6, p['x'][49]
log.write_ulog('again.ulg')
";
    python(&program, folder.path(), script);
    must_be_the_flight(
        &folder.path().join("again.ulg"),
        of("vehicle_local_position"),
    );
}
