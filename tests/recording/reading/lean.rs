//! A floor that leans in the recorded axes.

use std::fmt::Write as _;

use nalgebra::{Rotation3, UnitQuaternion, Vector3};
use realgap::file::Source;
use realgap::trajectory::{Reading, read};

use super::{file, reading};

/// What slides and turns on a floor whose normal a tracker has as (-0.1, 0.2, 1), as it wrote it, and where it ends.
fn leaning() -> (String, Vector3<f64>) {
    let normal = Vector3::new(-0.1, 0.2, 1.0);
    let lean = Rotation3::rotation_between(&Vector3::z(), &normal).unwrap();
    let mut text = String::from(
        "t_s,x_m,y_m,z_m,qw,qx,qy,qz,vx_m_s,vy_m_s,vz_m_s,wx_rad_s,wy_rad_s,wz_rad_s\n",
    );
    let mut end = Vector3::zeros();
    for k in 0..=10 {
        let t = 0.1 * f64::from(k);
        end = lean * Vector3::new(t, 2.0 * t, 0.05);
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 3.0 * t);
        let turn = UnitQuaternion::from_rotation_matrix(&lean) * turn;
        let [x, y, z, w] = turn.coords.into();
        let speed = lean * Vector3::new(1.0, 2.0, 0.0);
        writeln!(
            text,
            "{t},{},{},{},{w},{x},{y},{z},{},{},{},0,0,3",
            end.x, end.y, end.z, speed.x, speed.y, speed.z
        )
        .unwrap();
    }
    (text, end)
}

#[test]
fn on_a_floor_that_leans_what_slid_flat_slides_flat_and_ends_where_it_ended() {
    let folder = tempfile::tempdir().unwrap();
    let (text, end) = leaning();
    let path = file(folder.path(), "run.csv", &text);
    let how = reading("(floor_leans: (-0.1, 0.2))");
    let motion = read(&path, how).unwrap().trajectory;
    for place in motion.positions_world_m() {
        assert!((place.z - end.z).abs() < 1e-12, "{place}");
    }
    assert!((motion.positions_world_m()[10] - end).norm() < 1e-15);
    for turn in motion.orientations_world_from_body().unwrap() {
        assert!(
            (turn * Vector3::z() - Vector3::z()).norm() < 1e-12,
            "{turn}"
        );
    }
    for speed in motion.velocities_world_m_s().unwrap() {
        assert!(
            (speed - Vector3::new(1.0, 2.0, 0.0)).norm() < 1e-12,
            "{speed}"
        );
    }
    // The body's own axes are as they were.
    let spin = motion.angular_velocities_body_rad_s().unwrap()[3];
    assert_eq!(spin, Vector3::new(0.0, 0.0, 3.0));
}

#[test]
fn a_floor_that_stands_on_end_and_several_bodies_are_refused() {
    let error =
        Reading::parse(&Source::new("reading.ron", "(floor_leans: (0.1, -2))")).unwrap_err();
    assert_eq!(error.field_name(), Some("floor_leans"));

    let folder = tempfile::tempdir().unwrap();
    let text =
        "t_s,cube_x_m,cube_y_m,cube_z_m,tip_x_m,tip_y_m,tip_z_m\n0,0,0,0,0,0,0\n1,1,0,0,1,1,0\n";
    let path = file(folder.path(), "two.csv", text);
    let how = reading("(floor_leans: (0.1, 0))");
    let error = read(&path, how).unwrap_err().to_string();
    assert!(error.contains("several bodies"), "{error}");
}
