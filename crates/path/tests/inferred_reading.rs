//! Inferred readings of common file faults, on real tosses of a cube: each fault is corrected with its evidence, asked about, or refused.

use std::f64::consts::FRAC_PI_4;
use std::path::{Path, PathBuf};

use nalgebra::Vector3;
use realgap_path::trajectory::{
    Axes, InferredReading, Question, Reading, Recording, odd_axes, read, read_all,
};

const CUBE_M: f64 = 0.1048;

fn tosses() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../real_trajectories/cube_tosses");
    let mut all: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "csv"))
        .collect();
    all.sort();
    assert_eq!(all.len(), 40);
    all
}

/// A toss in another program's format: a header, and a line for each sample.
fn written(
    toss: &Recording,
    header: &str,
    line: impl Fn(f64, Vector3<f64>, [f64; 4]) -> Vec<f64>,
) -> String {
    let trajectory = &toss.trajectory;
    let turns = trajectory.orientations_world_from_body().unwrap();
    let mut text = format!("{header}\n");
    for (index, time_s) in trajectory.times_s().iter().enumerate() {
        let q = turns[index];
        let place = trajectory.positions_world_m()[index];
        let cells = line(*time_s, place, [q.w, q.i, q.j, q.k]);
        let cells: Vec<String> = cells.iter().map(f64::to_string).collect();
        text += &format!("{}\n", cells.join(","));
    }
    text
}

fn usual(t: f64, p: Vector3<f64>, q: [f64; 4]) -> Vec<f64> {
    vec![t, p.x, p.y, p.z, q[0], q[1], q[2], q[3]]
}

const OURS: &str = "t_s,x_m,y_m,z_m,qw,qx,qy,qz";

struct Trial {
    folder: tempfile::TempDir,
    toss: Recording,
}

impl Trial {
    fn new() -> Self {
        let toss = read(&tosses()[3], Reading::default()).unwrap();
        Self {
            folder: tempfile::tempdir().unwrap(),
            toss,
        }
    }

    fn put(&self, text: &str) -> PathBuf {
        let path = self.folder.path().join("mine.csv");
        std::fs::write(&path, text).unwrap();
        path
    }

    fn guess(&self, text: &str) -> InferredReading {
        InferredReading::infer(&[self.put(text)], &Reading::default(), Some(CUBE_M)).unwrap()
    }

    fn refused(&self, text: &str) -> String {
        let said = InferredReading::infer(&[self.put(text)], &Reading::default(), Some(CUBE_M));
        said.unwrap_err().to_string()
    }

    /// Checks that the file, read with the inferred settings, is the toss, and that the evidence contains these words.
    fn is_the_toss(&self, text: &str, says: &str) -> InferredReading {
        let guess = self.guess(text);
        let evidence = format!("{:?}", guess.evidence);
        assert_eq!(guess.ambiguities, [], "{evidence}");
        assert!(evidence.contains(says), "no `{says}` in {evidence}");
        let read = read_all(self.put(text), &guess.reading)
            .unwrap()
            .swap_remove(0);
        let [mine, toss] = [&read.trajectory, &self.toss.trajectory];
        assert_eq!(mine.len(), toss.len(), "{evidence}");
        for index in 0..toss.len() {
            let far = (mine.positions_world_m()[index] - toss.positions_world_m()[index]).norm();
            assert!(far < 1e-9, "{far} m off: {evidence}");
            let dt = mine.times_s()[index] - mine.times_s()[0];
            assert!((dt - toss.times_s()[index] + toss.times_s()[0]).abs() < 1e-6);
        }
        guess
    }
}

#[test]
fn files_in_the_own_format_are_read_by_default_and_no_toss_counts_as_mirrored() {
    let of = |paths: &[PathBuf]| {
        InferredReading::infer(paths, &Reading::default(), Some(CUBE_M)).unwrap()
    };
    for path in tosses() {
        let guess = of(std::slice::from_ref(&path));
        assert!(guess.reading.is_usual(), "{}: {guess:?}", path.display());
        assert_eq!(guess.ambiguities, [], "{}", path.display());
    }
    assert!(of(&tosses()).reading.is_usual());
    for ten in tosses().chunks(10) {
        of(ten);
    }
}

#[test]
fn units_are_inferred_from_names_from_the_sampling_rate_and_from_free_fall() {
    let trial = Trial::new();
    let scaled = |time: f64, length: f64| move |t: f64, p, q| usual(t * time, p * length, q);
    let of = |header, time, length| written(&trial.toss, header, scaled(time, length));
    // Units that are named, not named, and named wrongly.
    trial.is_the_toss(
        &of("t_s,pos_x [mm],pos_y [mm],pos_z [mm],qw,qx,qy,qz", 1.0, 1e3),
        "in mm",
    );
    trial.is_the_toss(
        &of("time,x,y,z,qw,qx,qy,qz", 1.0, 1e2),
        "lengths are in centimetres",
    );
    trial.is_the_toss(&of(OURS, 1.0, 1e3), "lengths are in millimetres");
    trial.is_the_toss(
        &of("timestamp_ms,x,y,z,qw,qx,qy,qz", 1e3, 1.0),
        "timestamp_ms in ms",
    );
    trial.is_the_toss(
        &of("stamp,x,y,z,qw,qx,qy,qz", 1e9, 1.0),
        "times are in nanoseconds",
    );
    trial.is_the_toss(&of(OURS, 1e3, 1.0), "times are in milliseconds");
}

#[test]
fn the_axis_that_points_up_is_inferred_from_free_fall() {
    let trial = Trial::new();
    let y_up = written(&trial.toss, OURS, |t, p, [w, x, y, z]| {
        vec![t, p.y, p.z, p.x, w, y, z, x]
    });
    let guess = trial.is_the_toss(&y_up, "y points up");
    assert_eq!(guess.reading.axes, Some(Axes::YUp));
    let z_down = written(&trial.toss, OURS, |t, p, [w, x, y, z]| {
        vec![t, p.x, -p.y, -p.z, w, x, -y, -z]
    });
    let guess = trial.is_the_toss(&z_down, "-z points up");
    assert_eq!(guess.reading.axes, Some(Axes::ZDown));
    // Orientations are turned together with the positions.
    let read = read_all(trial.put(&z_down), &guess.reading)
        .unwrap()
        .swap_remove(0);
    let [mine, toss] =
        [&read, &trial.toss].map(|r| r.trajectory.orientations_world_from_body().unwrap());
    assert!(mine[10].angle_to(&toss[10]) < 1e-6);
}

#[test]
fn positions_mirrored_against_the_orientations_are_detected() {
    let folder = tempfile::tempdir().unwrap();
    let mirrored: Vec<PathBuf> = tosses()
        .iter()
        .map(|path| {
            let toss = read(path, Reading::default()).unwrap();
            let text = written(&toss, OURS, |t, p, q| {
                usual(t, Vector3::new(p.x, -p.y, p.z), q)
            });
            let path = folder.path().join(path.file_name().unwrap());
            std::fs::write(&path, text).unwrap();
            path
        })
        .collect();
    let is_caught = |paths: &[PathBuf]| {
        let said = InferredReading::infer(paths, &Reading::default(), Some(CUBE_M));
        said.is_err_and(|error| error.to_string().contains("mirrored"))
    };
    assert!(is_caught(&mirrored));
    let tens = mirrored.chunks(10).filter(|ten| is_caught(ten)).count();
    assert!(tens >= 3, "{tens} of 4");
}

/// A robot with wheels in the own format: `drive` gives its heading and its speed ahead at a time; y and its direction are multiplied by
/// `side`, as in a file with mirrored positions.
fn driven(side: f64, drive: impl Fn(f64) -> (f64, f64)) -> String {
    let (mut text, mut x, mut y) = (format!("{OURS}\n"), 0.0, 0.0);
    for k in 0..400 {
        let t = 0.05 * f64::from(k);
        let (heading_rad, speed_m_s) = drive(t);
        let (qz, qw) = (0.5 * heading_rad).sin_cos();
        text += &format!("{t},{x},{},0.05,{qw},0,0,{qz}\n", side * y);
        x += 0.05 * speed_m_s * heading_rad.cos();
        y += 0.05 * speed_m_s * heading_rad.sin();
    }
    text
}

#[test]
fn a_robot_that_reverses_is_not_mirrored_and_a_mirrored_robot_that_reverses_is() {
    let trial = Trial::new();
    let reverses = |t: f64| if (t / 3.0) as i64 % 2 == 0 { 0.4 } else { -0.3 };
    let drives: [&dyn Fn(f64) -> (f64, f64); 3] = [
        // Ahead on one heading, back on another.
        &|t| {
            if t < 10.0 {
                (FRAC_PI_4, 0.3)
            } else {
                (-FRAC_PI_4, -0.3)
            }
        },
        &|t| (0.9 * t, reverses(t)),
        &|t| (2.0 * (0.7 * t).sin(), reverses(t)),
    ];
    for drive in drives {
        let guess = trial.guess(&driven(1.0, drive));
        let said = format!("{:?}", guess.evidence);
        assert!(!said.contains("mirrored"), "{said}");
    }
    for drive in [drives[1], drives[2], &|t| (0.5 * t, 0.3)] {
        let said = trial.refused(&driven(-1.0, drive));
        assert!(said.contains("mirrored"), "{said}");
    }
}

#[test]
fn axes_that_two_headings_contradict_are_doubted_but_not_refused() {
    let trial = Trial::new();
    let corner = |t: f64| (if t < 10.0 { 0.3 } else { 0.3 + FRAC_PI_4 }, 0.3);
    let guess = trial.guess(&driven(-1.0, corner));
    let said = format!("{:?}", guess.evidence);
    assert!(said.contains("axes may be mirrored"), "{said}");
    let path = trial.put(&driven(-1.0, corner));
    let doubt = odd_axes(&[read(path, Reading::default()).unwrap()], 0.2);
    assert!(doubt.is_some_and(|doubt| doubt.contains("seem mirrored")));
}

#[test]
fn a_file_without_a_needed_column_is_refused_with_the_names_of_its_columns() {
    let trial = Trial::new();
    for (header, says) in [
        ("nothing,x,y,z,qw,qx,qy,qz", "a time"),
        ("t,x,height,z,qw,qx,qy,qz", "both x and y"),
        ("t,a,b,c,d,e,f,g", "both x and y"),
    ] {
        let said = trial.refused(&written(&trial.toss, header, usual));
        assert!(said.contains(says) && said.contains("found"), "{said}");
    }
    let two = written(
        &trial.toss,
        "t,cube1.x,cube1.y,cube1.z,cube2.x,cube2.y,cube2.z,e",
        usual,
    );
    let open = trial.guess(&two).ambiguities.remove(0);
    assert_eq!(open.question, Question::Body);
    assert!(
        open.found.contains("`cube1.x`") && open.found.contains("`cube2.x`"),
        "{open:?}"
    );
    // Every answer is a mapping that reads its body.
    let known = Reading {
        columns: open.candidates[1].columns.clone(),
        ..Reading::default()
    };
    let guess = InferredReading::infer(&[trial.put(&two)], &known, Some(CUBE_M)).unwrap();
    let is_chosen = guess
        .ambiguities
        .iter()
        .all(|open| open.question != Question::Body);
    assert!(is_chosen, "{guess:?}");
    assert!(!trial.refused("t_s,x_m,y_m\n").is_empty());
    assert!(!trial.refused("").is_empty());
}

#[test]
fn lines_before_the_header_lost_samples_and_unsorted_samples_are_handled() {
    let trial = Trial::new();
    let plain = written(&trial.toss, "Time,X,Y,Z,Qw,Qx,Qy,Qz", usual);
    trial.is_the_toss(
        &format!("Recorded by a tracker\nversion,3\n\n{plain}"),
        "line 4 names the columns",
    );
    let plain = written(&trial.toss, OURS, usual);
    let mut lines: Vec<&str> = plain.lines().collect();
    lines.swap(8, 9);
    trial.is_the_toss(&lines.join("\n"), "sorted by time");
    let lost = plain.lines().nth(12).unwrap();
    let time = lost.split(',').next().unwrap();
    let gone = plain.replace(lost, &format!("{time},NaN,NaN,NaN,NaN,NaN,NaN,NaN"));
    let guess = trial.guess(&gone);
    assert_eq!(guess.reading.skip_lost, Some(true));
    assert!(format!("{:?}", guess.evidence).contains("tracker has lost"));
    // Spreadsheets of countries with a decimal comma separate cells by semicolons.
    let semicolons = written(&trial.toss, "t_s,x_m,y_m,z_m,qw,qx,qy,qz", usual);
    let semicolons = semicolons.replace(',', ";").replace('.', ",");
    trial.is_the_toss(&semicolons, "z points up");
}

/// A robot that drives an arc on the floor, recorded in the plane or in space.
fn arc(header: &str, line: impl Fn(f64, f64, f64, f64) -> Vec<f64>) -> String {
    let mut text = format!("{header}\n");
    for i in 0..400 {
        let t = f64::from(i) * 0.02;
        let heading = 0.5 * t;
        let cells = line(t, 0.4 * heading.sin(), 0.4 * (1.0 - heading.cos()), heading);
        let cells: Vec<String> = cells.iter().map(f64::to_string).collect();
        text += &format!("{}\n", cells.join(","));
    }
    text
}

#[test]
fn degrees_several_robots_standstills_and_unknown_lengths_are_noticed() {
    let trial = Trial::new();
    let wrapped = |a: f64| (a.to_degrees() + 180.0).rem_euclid(360.0) - 180.0;
    let guess = trial.guess(&arc("t_s,x_m,y_m,yaw", |t, x, y, a| {
        vec![t, x, y, wrapped(a)]
    }));
    let heading = guess
        .reading
        .columns
        .get(realgap_path::trajectory::Role::Heading);
    assert!(
        heading.is_some_and(|column| column.name == "yaw"),
        "a heading is used, whatever the column of times is called: {guess:?}"
    );
    let guess = trial.guess(&arc("time,x [m],y [m],yaw", |t, x, y, a| {
        vec![t, x, y, wrapped(a)]
    }));
    assert!(
        format!("{guess:?}").contains("angles are in degrees"),
        "{guess:?}"
    );
    let guess = trial.guess(&arc("time,x [m],y [m],yaw", |t, x, y, a| vec![t, x, y, a]));
    assert!(!format!("{guess:?}").contains("degrees"), "{guess:?}");
    // An arc to the left of a robot that turns to the right.
    let said = trial.refused(&arc("time,x [m],y [m],yaw", |t, x, y, a| vec![t, x, y, -a]));
    assert!(said.contains("mirrored"), "{said}");
    // The rows of two robots alternate.
    let several = arc("t_s,x_m,y_m,robot", |t, x, y, _| {
        let second = ((t / 0.02).round() as i64 % 2) as f64;
        vec![t, x + 3.0 * second, y, second]
    });
    assert_eq!(
        trial.guess(&several).ambiguities[0].question,
        Question::Robot
    );
    // The robot stands still for three seconds.
    let waits = arc("t_s,x_m,y_m", |t, _, _, _| {
        let a = (0.5 * (t - 3.0)).max(0.0);
        vec![t, 0.4 * a.sin(), 0.4 * (1.0 - a.cos())]
    });
    let crop = trial.guess(&waits).reading.crop.unwrap();
    assert!((2.5..3.2).contains(&crop.from_s), "{crop:?}");
    // A planar path without units is in metres, because in millimetres the robot would hardly move.
    let plain = arc("t,x,y", |t, x, y, _| vec![t, x, y]);
    let guess = trial.guess(&plain);
    assert!(
        format!("{:?}", guess.evidence).contains("lengths are in metres"),
        "{guess:?}"
    );
    // Without a known robot, the unit of length cannot be inferred.
    let path = trial.put(&plain);
    let open = InferredReading::infer(&[path], &Reading::default(), None)
        .unwrap()
        .ambiguities;
    assert_eq!(open[0].question, Question::Length);
    // A floor below y; and a file with an interval of half a second or half a millisecond.
    let y_up = arc("t,x [m],y [m],z [m]", |t, x, z, _| vec![t, x, 0.052, z]);
    assert_eq!(trial.guess(&y_up).reading.axes, Some(Axes::YUp));
    let slow = arc("t,x [m],y [m]", |t, x, y, _| vec![t * 25.0, x, y]);
    assert_eq!(trial.guess(&slow).ambiguities[0].question, Question::Time);
}

#[test]
fn unstated_axes_are_questioned_if_the_motion_contradicts_them_and_no_shipped_run_is() {
    let trial = Trial::new();
    let odd = |header: &str, line: &dyn Fn(f64, f64, f64, [f64; 2]) -> Vec<f64>| {
        // The quaternion of a heading: its real part, and its part along the axis that points up.
        let half = |a: f64| [(0.5 * a).cos(), (0.5 * a).sin()];
        let text = arc(header, |t, x, y, a| line(t, x, y, half(a)));
        let all = read_all(trial.put(&text), Reading::default()).unwrap();
        odd_axes(&all, 0.1)
    };
    let usual = odd(OURS, &|t, x, y, [w, k]| vec![t, x, y, 0.05, w, 0.0, 0.0, k]);
    assert_eq!(usual, None);
    // It moves straight ahead, and rocks more than it moves.
    let rocking = odd(OURS, &|t, x, _, _| {
        vec![
            t,
            0.1 * x,
            0.0125,
            0.05 + 0.03 * (9.0 * t).sin(),
            1.0,
            0.0,
            0.0,
            0.0,
        ]
    });
    assert_eq!(rocking, None);
    let y_up = odd(OURS, &|t, x, y, [w, k]| vec![t, y, 0.05, x, w, 0.0, k, 0.0]);
    assert!(y_up.is_some_and(|said| said.contains("`axes: \"y-up\"`")));
    let mirrored = odd(OURS, &|t, x, y, [w, k]| {
        vec![t, x, -y, 0.05, w, 0.0, 0.0, k]
    });
    assert!(mirrored.is_some_and(|said| said.contains("mirrored")));
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../real_trajectories");
    for (name, body_m) in [
        ("cube_tosses", CUBE_M),
        ("cube_pushes", 0.1),
        ("elbow_tosses", 0.2),
        ("tripod_mujoco", 0.2),
        ("chain5_mujoco", 0.3),
        ("two_module_mujoco", 0.15),
        ("unitree_a1_standin", 0.4),
        ("turtlebot3_burger_standin", 0.15),
    ] {
        let files = std::fs::read_dir(folder.join(name)).unwrap();
        let mut all: Vec<PathBuf> = files.map(|file| file.unwrap().path()).collect();
        all.retain(|path| path.extension().is_some_and(|e| e == "csv"));
        all.sort();
        assert!(!all.is_empty(), "{name}");
        let read = |path: &PathBuf| read_all(path, Reading::default()).unwrap();
        let all: Vec<Recording> = all.iter().flat_map(read).collect();
        assert_eq!(odd_axes(&all, body_m), None, "{name}");
    }
}
