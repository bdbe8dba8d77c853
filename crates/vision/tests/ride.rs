//! Tests of a camera on a body: it takes the same pictures as a fixed camera at the same pose, with motion blur.

use nalgebra::{UnitQuaternion, Vector3};
use realgap_core::file::Source;
use realgap_path::trajectory::Trajectory;
use realgap_vision::Grey;
use realgap_vision::camera::{Camera, Pose, Ride, Scene, View, take};

use crate::common;

/// The shipped scene with a small camera without noise, on a mount that begins at (3, 1) m and looks along the motion's x axis.
fn room() -> Scene {
    let text = std::fs::read_to_string(common::project().join("scenes/room.ron")).unwrap();
    let (before, after) = (
        text.find("cameras: {").unwrap(),
        text.find("views: [").unwrap(),
    );
    let text = format!(
        "{}cameras: {{ \"small\": (resolution_px: (160, 120), field_of_view_deg: 62, exposure_s: 0.02,
            electrons_per_cd_s: 1e8, full_well_e: 3e8) }},
        mounts: {{ \"front\": (place_m: (0.1, 0, 1.5), ahead: (1, 0, 0), start_m: (3, 1), facing_deg: 90) }},\n{}",
        &text[..before],
        &text[after..]
    );
    Scene::parse(&Source::new("room.ron", text)).unwrap_or_else(|e| panic!("{e}"))
}

/// Two seconds from (5, 7) m at a speed along x and turning about the vertical.
fn motion(speed_m_s: f64, turning_rad_s: f64) -> Trajectory {
    let times: Vec<f64> = (0..=200).map(|k| 0.01 * f64::from(k)).collect();
    let places = times
        .iter()
        .map(|t| Vector3::new(5.0 + speed_m_s * t, 7.0, 0.0));
    let turns = times
        .iter()
        .map(|t| UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turning_rad_s * (t - 1.0)));
    Trajectory::new(times.clone(), places.collect())
        .unwrap()
        .with_orientations(turns.collect())
        .unwrap()
}

fn seen(scene: &Scene, motion: &Trajectory) -> Grey {
    let ride = Ride::new(scene, &scene.mounts[0], motion).unwrap();
    let (camera, light) = (&scene.cameras[0], scene.light("well").unwrap());
    ride.take(camera, light, 1.0, 1, 0).unwrap().0.grey()
}

/// Mean square of the change from column to column: in the left and right quarter of the picture, and in its middle.
fn sharpness(picture: &Grey) -> [f64; 2] {
    let mean = |columns: Vec<i64>| {
        let all: Vec<f64> = columns
            .into_iter()
            .flat_map(|x| (0..picture.height() as i64).map(move |y| (x, y)))
            .map(|(x, y)| f64::from(picture.at(x + 1, y) - picture.at(x, y)).powi(2))
            .collect();
        realgap_core::statistics::mean(&all)
    };
    [
        mean((0..40).chain(120..159).collect()),
        mean((60..100).collect()),
    ]
}

#[test]
fn a_camera_on_a_body_at_rest_has_the_pose_of_the_mount() {
    let scene = room();
    let rest = motion(0.0, 0.0);
    let ride = Ride::new(&scene, &scene.mounts[0], &rest).unwrap();
    let pose = ride.pose_at(1.0).unwrap();
    let meant = Pose::towards([3.0, 1.1, 1.5], [3.0, 5.0, 1.5]).unwrap();
    for (a, b) in pose.place_m.iter().zip(meant.place_m) {
        assert!((a - b).abs() < 1e-12, "{pose:?}");
    }
    let (camera, light) = (&scene.cameras[0], scene.light("well").unwrap());
    let view = View {
        name: "there".to_owned(),
        pose: meant,
    };
    let (fixed, _) = take(&scene, camera, &view, light, 1, 0).unwrap();
    let off = fixed.grey();
    let off = off
        .values()
        .iter()
        .zip(seen(&scene, &rest).values().to_vec());
    let worst = off.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    assert!(worst < 0.01, "{worst}");
    // After a second at 0.4 m/s; the motion's x axis is the room's y axis.
    let driving = motion(0.4, 0.0);
    let ride = Ride::new(&scene, &scene.mounts[0], &driving).unwrap();
    let place = ride.pose_at(1.0).unwrap().place_m;
    assert!(
        (place[1] - 1.5).abs() < 1e-9 && (place[0] - 3.0).abs() < 1e-9,
        "{place:?}"
    );
}

#[test]
fn turning_blurs_the_whole_picture_and_driving_ahead_blurs_its_border() {
    let scene = room();
    let still = sharpness(&seen(&scene, &motion(0.0, 0.0)));
    // At 4 rad/s, the camera turns by 0.08 rad in 0.02 s, which are 10.7 pixels.
    let turning = seen(&scene, &motion(0.0, 4.0));
    let [border, middle] = sharpness(&turning);
    assert!(
        border < 0.4 * still[0] && middle < 0.4 * still[1],
        "{still:?} {border} {middle}"
    );
    let mut camera: Camera = scene.cameras[0].clone();
    camera.turning_rad_s = [-4.0, 0.0];
    let view = View {
        name: "there".to_owned(),
        pose: Pose::towards([3.0, 1.1, 1.5], [3.0, 5.0, 1.5]).unwrap(),
    };
    let light = scene.light("well").unwrap();
    let (other, _) = take(&scene, &camera, &view, light, 1, 0).unwrap();
    let other = other.grey();
    let apart: Vec<f64> = (20..140)
        .flat_map(|x| (0..120).map(move |y| (x, y)))
        .map(|(x, y)| f64::from((turning.at(x, y) - other.at(x, y)).abs()))
        .collect();
    let apart = realgap_core::statistics::mean(&apart);
    assert!(apart < 0.01, "{apart}");
    // Driving fast ahead, things at the side move through the picture, and things ahead only grow.
    let start = motion(0.0, 0.0);
    let fast = motion(30.0, 0.0);
    let ride = Ride::new(&scene, &scene.mounts[0], &fast).unwrap();
    assert!(ride.pose_at(1.0).is_err());
    let early = |motion: &Trajectory| {
        let ride = Ride::new(&scene, &scene.mounts[0], motion).unwrap();
        let taken = ride.take(&scene.cameras[0], light, 0.02, 1, 0);
        sharpness(&taken.unwrap().0.grey())
    };
    let (still, driving) = (early(&start), early(&fast));
    println!("{still:?} {driving:?}");
    let [border, middle] = [0, 1].map(|k| driving[k] / still[k]);
    assert!(border < 0.75 && middle > border, "{border} {middle}");
}
