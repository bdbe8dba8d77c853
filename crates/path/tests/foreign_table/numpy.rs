//! Arrays as NumPy writes them.

use realgap_path::trajectory::{InferredReading, JointReading, Reading, read};

use super::said;
use crate::common::python_with;

const SCRIPT: &str = "
import numpy as np
n = 60
t = 0.05 * np.arange(n)
place = np.stack([1 + 0.02 * np.arange(n), 0.05 * np.sin(t), 0.1 + 0 * t], axis=1)
np.savez('own.npz', t_s=t, x_m=place[:, 0], y_m=place[:, 1].astype('>f8'), mass=np.array([1.5, 2.0]), label=np.array(['a', 'b']))
np.savez_compressed('packed.npz', t_s=t, x_m=place[:, 0], y_m=place[:, 1])
np.savez('place.npz', time=t, position=np.asfortranarray(place))
q = np.stack([np.sin(3 * t), 0.5 * np.cos(2 * t)], axis=1)
np.savez('joints.npz', timestamp=t, q=q, q_des=q + 0.01)
table = np.zeros(n, dtype=[('t_s', '<f8'), ('x_m', '<f4'), ('y_m', '<f8')])
table['t_s'], table['x_m'], table['y_m'] = t, place[:, 0], place[:, 1]
np.save('table.npy', table)
np.save('bare.npy', place)
np.savetxt('own.csv', np.stack([t, place[:, 0], place[:, 1]], axis=1), delimiter=',', header='t_s,x_m,y_m', comments='', fmt='%.17g')
";

/// A folder with the files of the script, where NumPy is installed.
fn arrays() -> Option<tempfile::TempDir> {
    let program = python_with("numpy")?;
    let folder = tempfile::tempdir().unwrap();
    let mut python = std::process::Command::new(program);
    let done = python.args(["-c", SCRIPT]).current_dir(folder.path());
    assert!(done.status().unwrap().success());
    Some(folder)
}

#[test]
fn arrays_of_numpy_are_the_same_numbers_as_csv() {
    let Some(folder) = arrays() else {
        return;
    };
    let folder = folder.path();
    let csv = read(folder.join("own.csv"), Reading::default()).unwrap();
    let own = read(folder.join("own.npz"), Reading::default()).unwrap();
    assert_eq!(own.trajectory, csv.trajectory);
    for left_out in ["mass (<f8 of [2])", "label"] {
        assert!(said(&own).contains(left_out), "{}", said(&own));
    }
    let packed = read(folder.join("packed.npz"), Reading::default()).unwrap();
    assert_eq!(packed.trajectory, csv.trajectory);
    let table = read(folder.join("table.npy"), Reading::default()).unwrap();
    assert_eq!(table.trajectory.times_s(), csv.trajectory.times_s());
    // Single precision has seven digits.
    let places = table
        .trajectory
        .positions_world_m()
        .iter()
        .zip(csv.trajectory.positions_world_m());
    for (single, double) in places {
        assert!((single - double).norm() < 2e-7);
    }
    let place = folder.join("place.npz");
    let guess = InferredReading::of_file(&place, &Reading::default()).unwrap();
    let found = read(&place, guess.reading).unwrap().trajectory;
    assert_eq!(
        found.positions_world_m()[7].x,
        csv.trajectory.positions_world_m()[7].x
    );
    assert_eq!(found.positions_world_m()[7].z, 0.1);
    let error = read(folder.join("bare.npy"), Reading::default())
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("no names") && error.contains("[60, 3]"),
        "{error}"
    );

    let joints = ["pan", "lift"].map(str::to_owned);
    let log = folder.join("joints.npz");
    let named = JointReading::infer(&log, &Reading::default(), &joints, &joints)
        .unwrap()
        .unwrap();
    let guess = InferredReading::infer(std::slice::from_ref(&log), &named.reading, None).unwrap();
    let found = read(&log, guess.reading).unwrap().trajectory;
    assert_eq!(found.joints()[1].name, "lift");
    assert!((found.joints()[1].angles_rad[5] - 0.5 * (0.5f64).cos()).abs() < 1e-12);
    let command = &found
        .signals()
        .iter()
        .map(|signal| signal.name.as_str())
        .collect::<Vec<_>>();
    assert!(
        found
            .joints()
            .iter()
            .any(|joint| joint.name == "pan_command"),
        "{command:?}"
    );
}

#[test]
fn a_cut_archive_is_refused() {
    let Some(folder) = arrays() else {
        return;
    };
    let folder = folder.path();
    let whole = std::fs::read(folder.join("packed.npz")).unwrap();
    for length in (0..whole.len()).step_by(37) {
        let path = super::put(folder, "cut.npz", &whole[..length]);
        assert!(read(&path, Reading::default()).is_err(), "{length}");
    }
    let mut turned = whole.clone();
    turned[whole.len() / 4] ^= 1;
    let path = super::put(folder, "turned.npz", turned);
    assert!(read(&path, Reading::default()).is_err());
}
