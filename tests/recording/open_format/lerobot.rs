//! Data sets of LeRobot, whose Parquet files pyarrow writes with the layout of versions 2.1 and 3.0.

use std::path::Path;

use realgap::trajectory::{JointReading, JointTrack, Reading, read, read_all};

use super::common::python_with;
use super::python;

/// Two episodes of a motion in whole counts of the encoders, as degrees and as shares of the range, in both layouts.
const WRITE: &str = "
import json, os
import numpy as np, pyarrow as pa, pyarrow.parquet as pq
NAMES = ['shoulder_pan', 'elbow_flex', 'gripper']
RANGE = {'shoulder_pan': (701, 3402), 'elbow_flex': (880, 3095), 'gripper': (2020, 3490)}
def counts(episode, lag):
    k = np.arange(60) - lag
    a = 2048 + 1300 * np.sin(0.07 * k + episode)
    b = 1987 + 700 * np.cos(0.05 * k)
    c = 2500 + 400 * np.sin(0.03 * k)
    return np.round(np.stack([a, b, c], axis=1))
def numbers(raw, kind):
    out = np.zeros(raw.shape)
    for j, name in enumerate(NAMES):
        low, high = RANGE[name]
        if name == 'gripper':
            out[:, j] = (raw[:, j] - low) / (high - low) * 100
        elif kind == 'degrees':
            out[:, j] = (raw[:, j] - (low + high) / 2) * 360 / 4095
        else:
            out[:, j] = (raw[:, j] - low) / (high - low) * 200 - 100
    return out.astype(np.float32)
def table(episodes, kind, pictures):
    parts = []
    for e in episodes:
        n = 60
        def lists(values):
            return pa.FixedSizeListArray.from_arrays(pa.array(values.reshape(-1)), 3)
        columns = {
            'observation.state': lists(numbers(counts(e, 2), kind)),
            'action': lists(numbers(counts(e, 0), kind)),
            'timestamp': pa.array((np.arange(n) / 30).astype(np.float32)),
            'frame_index': pa.array(np.arange(n)), 'episode_index': pa.array(np.full(n, e)),
            'index': pa.array(60 * e + np.arange(n)), 'task_index': pa.array(np.zeros(n, dtype=np.int64)),
        }
        if pictures:
            columns['observation.images.top'] = pa.array([{'bytes': b'', 'path': 'x.png'}] * n)
        parts.append(pa.table(columns))
    return pa.concat_tables(parts)
def info(folder, version, names, pictures):
    features = {key: {'dtype': 'float32', 'shape': [3], 'names': names} for key in ('observation.state', 'action')}
    features['timestamp'] = {'dtype': 'float32', 'shape': [1], 'names': None}
    for key in ('frame_index', 'episode_index', 'index', 'task_index'):
        features[key] = {'dtype': 'int64', 'shape': [1], 'names': None}
    if pictures:
        features['observation.images.top'] = {'dtype': 'image', 'shape': [4, 4, 3], 'names': ['height', 'width', 'channels']}
    os.makedirs(folder + '/meta', exist_ok=True)
    os.makedirs(folder + '/data/chunk-000', exist_ok=True)
    json.dump({'codebase_version': version, 'robot_type': 'so101_follower', 'fps': 30, 'features': features}, open(folder + '/meta/info.json', 'w'))
def calibrated(folder):
    motors = {n: {'id': i + 1, 'drive_mode': 0, 'homing_offset': 12, 'range_min': RANGE[n][0], 'range_max': RANGE[n][1]} for i, n in enumerate(NAMES)}
    json.dump(motors, open(folder + '/meta/calibration.json', 'w'))
for kind in ('degrees', 'shares'):
    folder = kind + '_v21'
    info(folder, 'v2.1', {'motors': ['main_' + n for n in NAMES]}, False)
    for e in (0, 1):
        pq.write_table(table([e], kind, False), f'{folder}/data/chunk-000/episode_{e:06d}.parquet', compression='snappy')
    folder = kind + '_v30'
    info(folder, 'v3.0', [n + '.pos' for n in NAMES], True)
    pq.write_table(table([0, 1], kind, True), folder + '/data/chunk-000/file-000.parquet', compression='snappy')
    calibrated(kind + '_v21')
    calibrated(kind + '_v30')
info('bare', 'v3.0', [n + '.pos' for n in NAMES], False)
pq.write_table(table([0], 'degrees', False), 'bare/data/chunk-000/file-000.parquet')
info('bare_shares', 'v3.0', [n + '.pos' for n in NAMES], False)
pq.write_table(table([0], 'shares', False), 'bare_shares/data/chunk-000/file-000.parquet')
with open('truth.csv', 'w') as f:
    f.write('t_s,' + ','.join(n + '_rad' for n in NAMES) + ',' + ','.join(n + '_command_rad' for n in NAMES) + '\\n')
    def angles(raw):
        out = np.zeros(raw.shape)
        for j, name in enumerate(NAMES):
            low, high = RANGE[name]
            middle = low if name == 'gripper' else (low + high) / 2
            out[:, j] = (raw[:, j] - middle) * 2 * np.pi / 4096
        return out
    q, u = angles(counts(0, 2)), angles(counts(0, 0))
    for k in range(60):
        f.write(','.join(repr(float(v)) for v in [k / 30, *q[k], *u[k]]) + '\\n')
";

/// What float32 can tell apart below 180 degrees, radians.
const QUANTUM_RAD: f64 = 3e-7;

fn must_be(found: &[JointTrack], wanted: &[JointTrack], what: &str) {
    assert_eq!(found.len(), wanted.len(), "{what}");
    for track in wanted {
        let mut all = found.iter();
        let own = all
            .find(|own| own.name == track.name)
            .unwrap_or_else(|| panic!("{what}: {}", track.name));
        for (a, b) in own.angles_rad.iter().zip(&track.angles_rad) {
            assert!(
                (a - b).abs() < QUANTUM_RAD,
                "{what} {}: {a} {b}",
                track.name
            );
        }
    }
}

fn refused(path: &Path) -> String {
    read_all(path, Reading::default()).unwrap_err().to_string()
}

#[test]
fn episodes_of_a_data_set_are_runs_with_the_angles_that_the_encoders_counted() {
    let Some(program) = python_with("pyarrow") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    python(&program, folder, WRITE);
    let truth = read(folder.join("truth.csv"), Reading::default()).unwrap();
    for name in ["degrees_v21", "degrees_v30", "shares_v21", "shares_v30"] {
        let all = read_all(folder.join(name), Reading::default()).unwrap();
        let names: Vec<&str> = all
            .iter()
            .map(|recording| recording.name.as_str())
            .collect();
        assert_eq!(names, [format!("{name}/0"), format!("{name}/1")]);
        let motion = &all[0].trajectory;
        must_be(motion.joints(), truth.trajectory.joints(), name);
        for (a, b) in motion.times_s().iter().zip(truth.trajectory.times_s()) {
            assert!((a - b).abs() < 1e-6, "{name}: {a} {b}");
        }
        let said: Vec<&str> = all[0].warnings.iter().map(|w| w.message.as_str()).collect();
        let kind = if name.starts_with("degrees") {
            "in degrees"
        } else {
            "shares of their ranges"
        };
        assert!(said.iter().any(|said| said.contains(kind)), "{said:?}");
    }
    // A single file of a data set knows what its `meta` says, too.
    let one = read_all(
        folder.join("shares_v21/data/chunk-000/episode_000000.parquet"),
        Reading::default(),
    );
    must_be(
        one.unwrap()[0].trajectory.joints(),
        truth.trajectory.joints(),
        "one file",
    );

    // A calibration of another arm: no value is a whole count of its encoders.
    let calibration = folder.join("shares_v30/meta/calibration.json");
    let text = std::fs::read_to_string(&calibration).unwrap();
    std::fs::write(
        &calibration,
        text.replace("3402", "3377").replace("3095", "3050"),
    )
    .unwrap();
    let error = refused(&folder.join("shares_v30"));
    assert!(
        error.contains("does not fit") && error.contains("shares_v30"),
        "{error}"
    );
    std::fs::write(&calibration, text.replace("elbow_flex", "elbow")).unwrap();
    assert!(refused(&folder.join("shares_v30")).contains("no range of elbow_flex"));
    std::fs::write(folder.join("degrees_v30/meta/info.json"), "{").unwrap();
    assert!(refused(&folder.join("degrees_v30")).contains("meta/info.json"));
}

#[test]
fn without_a_calibration_degrees_are_found_and_shares_are_asked_about() {
    let Some(program) = python_with("pyarrow") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    python(&program, folder, WRITE);
    let joints: Vec<String> = ["shoulder_pan", "elbow_flex", "gripper"]
        .map(str::to_owned)
        .to_vec();
    let infer =
        |name: &str| JointReading::infer(&folder.join(name), &Reading::default(), &joints, &[]);
    let made = infer("bare").unwrap().unwrap();
    assert_eq!(
        made.reading.names["observation.state.shoulder_pan.pos"],
        "shoulder_pan_deg"
    );
    assert_eq!(
        made.reading.names["action.elbow_flex.pos"],
        "elbow_flex_command_deg"
    );
    let all = read_all(folder.join("bare"), made.reading).unwrap();
    assert_eq!(all[0].trajectory.joints().len(), 6);
    let error = infer("bare_shares").unwrap_err().to_string();
    assert!(
        error.contains("shares of a range") && error.contains("bare_shares"),
        "{error}"
    );
    // The lists may still be named by hand.
    let names = ["a_deg", "b_deg", "c_deg"].map(str::to_owned).to_vec();
    let own = Reading {
        lists: [("observation.state".to_owned(), names)].into(),
        ..Reading::default()
    };
    let all = read_all(folder.join("bare_shares"), own).unwrap();
    assert_eq!(all[0].trajectory.joints()[1].name, "b");
}
