//! Tests of robots in pictures: positions and brightness of bodies, and their motion blur.

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use realgap_core::file::Source;
use realgap_path::trajectory::Trajectory;
use realgap_vision::Grey;
use realgap_vision::camera::{Body, BodyBox, Pose, Ride, Scene, Watch, known, luminance, take};

/// A dark room with a camera without noise at (2, 0.5, 1) m that looks along y, and a mount at (2, 2) m whose x axis is the room's y.
fn room(things: &str, light: &str) -> Scene {
    let text = format!(
        "Scene(name: \"dark\", room_m: (4, 4, 3), wall: (0.02, 0.02, 0.02), floor: (0.02, 0.02, 0.02),
        ceiling: (0.02, 0.02, 0.02), {things} lights: {{ \"l\": ({light}) }},
        cameras: {{ \"c\": (resolution_px: (320, 240), exposure_s: 0.02, electrons_per_cd_s: 1e8, full_well_e: 3e8) }},
        mounts: {{ \"m\": (start_m: (2, 2), facing_deg: 90, place_m: (0, 0, 0), ahead: (1, 0, 0)) }},
        views: [(name: \"ahead\", place_m: (2, 0.5, 1), look_at_m: (2, 4, 1))])"
    );
    Scene::parse(&Source::new("dark.ron", text)).unwrap_or_else(|e| panic!("{e}"))
}

const EVEN: &str = "ambient_lux: 300";
const WHITE: [f64; 3] = [0.9; 3];

fn cube(half_m: [f64; 3]) -> Vec<BodyBox> {
    vec![BodyBox {
        half_m: half_m.into(),
        body_from_box: Isometry3::identity(),
        colour: WHITE,
        planes: [].into(),
    }]
}

/// Two seconds at a place, moving and turning as asked.
fn motion(at_m: [f64; 3], turn: UnitQuaternion<f64>, speed_m_s: [f64; 3]) -> Trajectory {
    let times: Vec<f64> = (0..=200).map(|k| 0.01 * f64::from(k)).collect();
    let places = times
        .iter()
        .map(|t| Vector3::from(at_m) + Vector3::from(speed_m_s) * *t);
    Trajectory::new(times.clone(), places.collect())
        .unwrap()
        .with_orientations(vec![turn; times.len()])
        .unwrap()
}

fn watched(scene: &Scene, motion: &Trajectory, bodies: &[Body]) -> Grey {
    let watch = Watch::new(scene, &scene.mounts[0], motion, bodies);
    let (camera, view, light) = (&scene.cameras[0], &scene.views[0], &scene.lights[0]);
    let taken = watch.take(camera, view, light, 1.0, 1, [0, 0]);
    taken.unwrap_or_else(|e| panic!("{e}")).0.grey()
}

/// Position at which a pinhole at (2, 0.5, 1) m that looks along y sees a point, computed by hand.
fn pinhole([x, y, z]: [f64; 3]) -> [f64; 2] {
    let focal = 160.0 / 30.0_f64.to_radians().tan();
    let away = y - 0.5;
    [
        159.5 + focal * (x - 2.0) / away,
        119.5 - focal * (z - 1.0) / away,
    ]
}

/// Distance of a point inside of the convex hull of some points from its border, pixels; negative outside.
fn within(points: &[[f64; 2]], at: [f64; 2]) -> f64 {
    let mut least = f64::INFINITY;
    for a in points {
        for b in points {
            let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
            let length = dx.hypot(dy);
            let side = |p: &[f64; 2]| (dx * (p[1] - a[1]) - dy * (p[0] - a[0])) / length;
            if length > 1e-9 && points.iter().all(|p| side(p) > -1e-9) {
                least = least.min(side(&at));
            }
        }
    }
    least
}

#[test]
fn a_rotated_cube_has_its_corners_where_a_pinhole_sees_them() {
    let scene = room("", EVEN);
    let turn = UnitQuaternion::from_euler_angles(0.5, -0.7, 0.4);
    let track = motion([7.0, -3.0, 1.1], turn, [0.0; 3]);
    let bodies = [Body::moving("part0", cube([0.3, 0.2, 0.15]), track.clone()).unwrap()];
    let picture = watched(&scene, &track, &bodies);
    let mut corners = Vec::new();
    for corner in 0..8 {
        let sign = |bit: usize| if corner >> bit & 1 == 1 { 1.0 } else { -1.0 };
        let own = Vector3::new(0.3 * sign(0), 0.2 * sign(1), 0.15 * sign(2));
        let off = turn * own;
        // The motion's x axis is the room's y axis.
        corners.push(pinhole([2.0 - off.y, 2.0 + off.x, 1.1 + off.z]));
    }
    let (mut inside, mut wrong) = (0, Vec::new());
    for y in 0..240 {
        for x in 0..320 {
            let depth = within(&corners, [f64::from(x), f64::from(y)]);
            let is_bright = picture.at(x.into(), y.into()) > 0.16;
            inside += usize::from(is_bright);
            if is_bright != (depth > 0.0) && depth.abs() > 1.0 {
                wrong.push((x, y, depth));
            }
        }
    }
    println!(
        "{inside} pixels of the cube, {} beyond a pixel",
        wrong.len()
    );
    assert!(inside > 4000 && wrong.is_empty(), "{wrong:?}");
}

#[test]
fn the_brightness_of_faces_follows_from_their_angle_to_the_lamp() {
    let lamp = [1.2, 0.6, 2.4];
    let scene = room(
        "",
        "ambient_lux: 0, lamps: [(place_m: (1.2, 0.6, 2.4), intensity_cd: 100)]",
    );
    for angles in [(0.0, 0.0, 0.6), (0.3, 0.2, -0.8), (-0.4, 0.5, 0.3)] {
        let turn = UnitQuaternion::from_euler_angles(angles.0, angles.1, angles.2);
        let track = motion([0.0, 0.0, 1.0], turn, [0.0; 3]);
        let half_m = 0.25;
        let bodies = [Body::moving("part0", cube([half_m; 3]), track.clone()).unwrap()];
        let watch = Watch::new(&scene, &scene.mounts[0], &track, &bodies);
        let (camera, pose) = (&scene.cameras[0], &scene.views[0].pose);
        let light = luminance(&watch.room_at(1.0), camera, pose, &scene.lights[0]);
        let in_room = |v: Vector3<f64>| Vector3::new(-v.y, v.x, v.z);
        let mut seen = 0;
        for axis in 0..3 {
            for sign in [-1.0, 1.0] {
                // The point is between the dots of the face.
                let mut own = Vector3::repeat(0.25 * half_m);
                own[axis] = sign * half_m;
                let mut normal = Vector3::zeros();
                normal[axis] = sign;
                let (off, normal) = (in_room(turn * own), in_room(turn * normal));
                let point = Vector3::new(2.0, 2.0, 1.0) + off;
                let to_eye = Vector3::new(2.0, 0.5, 1.0) - point;
                let to_lamp = Vector3::from(lamp) - point;
                let slope = normal.dot(&to_lamp.normalize());
                if normal.dot(&to_eye.normalize()) < 0.2 || slope < 0.2 {
                    continue;
                }
                let by_hand = 0.9 / std::f64::consts::PI * 100.0 * slope / to_lamp.norm_squared();
                let [x, y] = pinhole(point.into());
                let found = f64::from(light[0].between(x, y));
                println!("slope {slope:.3}: {found:.4} cd/m2, by hand {by_hand:.4}");
                assert!((found / by_hand - 1.0).abs() < 0.01, "{found} {by_hand}");
                seen += 1;
            }
        }
        assert!(seen > 0, "{angles:?}");
    }
}

#[test]
fn a_block_has_its_stated_orientation() {
    let shot = |block: &str| {
        let scene = room(
            &format!("blocks: [({block}, colour: (0.9, 0.9, 0.9), faces: Die)],"),
            EVEN,
        );
        let (camera, view) = (&scene.cameras[0], &scene.views[0]);
        take(&scene, camera, view, &scene.lights[0], 1, 0)
            .unwrap()
            .0
            .grey()
    };
    let apart = |a: &Grey, b: &Grey| {
        let both = a.values().iter().zip(b.values());
        both.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
    };
    let turned = shot("centre_m: (2, 2, 1), half_m: (0.3, 0.2, 0.1), turn_deg: 30");
    let (cos, sin) = (15.0_f64.to_radians().cos(), 15.0_f64.to_radians().sin());
    let same = shot(&format!(
        "centre_m: (2, 2, 1), half_m: (0.3, 0.2, 0.1), orientation_wxyz: ({cos}, 0, 0, {sin})"
    ));
    assert!(apart(&turned, &same) < 0.02, "{}", apart(&turned, &same));
    // The block lies on its side: its x axis points up, and so does the face with one dot.
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let on_side = shot(&format!(
        "centre_m: (2, 2, 1), half_m: (0.3, 0.2, 0.1), orientation_wxyz: ({half}, 0, {}, 0)",
        -half
    ));
    let bright = |picture: &Grey| {
        let rows = (0..240).filter(|y| picture.at(159, *y) > 0.2).count();
        let columns = (0..320).filter(|x| picture.at(*x, 119) > 0.2).count();
        (rows, columns)
    };
    let (rows, columns) = bright(&on_side);
    // The near face is 1.3 m away.
    let px = 160.0 / 30.0_f64.to_radians().tan() / 1.3;
    assert!((rows as f64 - 0.6 * px).abs() < 2.0, "{rows} {px}");
    assert!((columns as f64 - 0.2 * px).abs() < 2.0, "{columns} {px}");
}

#[test]
fn a_moving_body_has_motion_blur_in_pictures_of_a_fixed_camera() {
    let scene = room("", EVEN);
    let edge = |speed: f64| {
        // Along the motion's -y axis, the room's x axis.
        let track = motion(
            [0.0, speed, 1.0],
            UnitQuaternion::identity(),
            [0.0, -speed, 0.0],
        );
        let bodies = [Body::moving("part0", cube([0.01, 0.4, 0.4]), track.clone()).unwrap()];
        // The body starts at the mount's start, so that in the middle of the motion it is beside it.
        let start = motion([0.0, 0.0, 1.0], UnitQuaternion::identity(), [0.0; 3]);
        let picture = watched(&scene, &start, &bodies);
        (0..320)
            .map(|x| ((f64::from(picture.at(x, 60)) + 0.055) / 1.055).powf(2.4))
            .collect::<Vec<f64>>()
    };
    let (still, fast) = (edge(0.0), edge(3.0));
    // At 3 m/s, the body moves by 0.06 m in 0.02 s, at a distance of 1.49 m; the edge at rest is at 0.4 m.
    let focal = 160.0 / 30.0_f64.to_radians().tan();
    let half_px = 0.5 * focal / 1.49 * 0.06;
    let edge_px = 159.5 + focal / 1.49 * 0.4;
    // The sum of the light beyond a column, in units of a pixel that shows the rim only.
    let first = edge_px.floor() as usize;
    let (wall, rim) = (still[310], still[first - 3]);
    let beyond = |profile: &[f64]| -> f64 {
        let light = profile[first..310]
            .iter()
            .map(|v| (v - wall) / (rim - wall));
        light.sum()
    };
    // Columns begin half a pixel before their centre; the edge is at every position of its path for the same time.
    let covered = edge_px + 0.5 - first as f64;
    let by_hand = (half_px + covered).powi(2) / (4.0 * half_px);
    let found = beyond(&fast);
    println!(
        "light beyond the edge: still {:.2} px, moving {found:.2} px, by hand {by_hand:.2} px",
        beyond(&still)
    );
    assert!((found / by_hand - 1.0).abs() < 0.05, "{found} {by_hand}");
    assert!((beyond(&still) - covered).abs() < 0.2, "{covered}");
}

#[test]
fn a_camera_sees_out_of_the_body_that_carries_it_and_sees_the_others() {
    let posters = "posters: [(centre_m: (2, 3.99, 1), width_m: 1, facing_deg: -90, motif: Logo)],";
    let scene = room(posters, EVEN);
    let level = UnitQuaternion::identity();
    let track = motion([0.0, 0.0, 1.0], level, [0.0; 3]);
    let own = Body::moving("part0", cube([0.05; 3]), track.clone()).unwrap();
    let arm = motion([0.4, 0.2, 1.0], level, [0.0; 3]);
    let arm = Body::moving("part1", cube([0.05; 3]), arm).unwrap();
    let ride = Ride::new(&scene, &scene.mounts[0], &track).unwrap();
    let (camera, light) = (&scene.cameras[0], &scene.lights[0]);
    let seen = |bodies: &[Body], carrier: &str| {
        let ride = ride.clone().with_bodies(bodies, carrier);
        ride.take(camera, light, 1.0, 1, 0).unwrap().0.grey()
    };
    let alone = seen(&[], "");
    let both = [own, arm];
    assert_eq!(seen(&both[..1], "part0").values(), alone.values());
    let with_arm = seen(&both, "part0");
    // The box is 0.2 m to the left at a distance of 0.35 m with half a width of 0.05 m: beside the poster.
    let focal = 160.0 / 30.0_f64.to_radians().tan();
    let column = |off_m: f64, away_m: f64| (159.5 + focal * off_m / away_m).round() as i64;
    for x in 0..320 {
        let is_other = (with_arm.at(x, 119) - alone.at(x, 119)).abs() > 0.01;
        if x > column(-0.15, 0.45) + 1 {
            assert!(!is_other, "{x}");
        } else if x < column(-0.15, 0.35) - 1 {
            assert!(is_other, "{x}");
        }
    }
    // A camera on top of its body sees the body, and the position of a poster behind an arm is not stated.
    let mut high = scene.clone();
    high.mounts[0].place_body_m = [-0.04, 0.0, 0.06];
    let ride_high = Ride::new(&high, &high.mounts[0], &track).unwrap();
    let on_top = ride_high.clone().with_bodies(&both[..1], "part0");
    let low_half = |ride: &Ride<'_>| {
        let picture = ride.take(camera, light, 1.0, 1, 0).unwrap().0.grey();
        realgap_core::statistics::mean(
            &(0..320)
                .map(|x| f64::from(picture.at(x, 230)))
                .collect::<Vec<f64>>(),
        )
    };
    assert!(low_half(&on_top) > low_half(&ride_high) + 0.2);
    let pose = Pose::towards([2.0, 2.0, 1.0], [2.0, 4.0, 1.0]).unwrap();
    assert!(known(&scene, camera, &pose, "v").template_at_px.is_some());
    let before = motion([0.4, 0.0, 1.0], level, [0.0; 3]);
    let before = [Body::moving("part1", cube([0.05; 3]), before).unwrap()];
    let watch = Watch::new(&scene, &scene.mounts[0], &track, &before);
    let hidden = known(&watch.room_at(1.0), camera, &pose, "v");
    assert!(hidden.template_at_px.is_none());
}

#[test]
fn an_invisible_body_around_the_camera_still_casts_a_shadow() {
    let scene = room(
        "",
        "ambient_lux: 0, lamps: [(place_m: (2, 1, 2), intensity_cd: 100)]",
    );
    let level = UnitQuaternion::identity();
    let track = motion([0.0, 0.0, 1.5], level, [0.0; 3]);
    // The body is at a third of the line from the lamp to (2, 4, 1).
    let bodies = [Body::moving("part0", cube([0.05, 0.3, 0.3]), track.clone()).unwrap()];
    let ride = Ride::new(&scene, &scene.mounts[0], &track).unwrap();
    let (camera, light) = (&scene.cameras[0], &scene.lights[0]);
    let middle = |ride: &Ride<'_>| {
        let room = ride.room_at(1.0);
        let pose = ride.pose_at(1.0).unwrap();
        let [x, y] = camera.lens.project_px(&pose, [2.0, 4.0, 1.0]).unwrap();
        luminance(&room, camera, &pose, light)[0].at(x as i64, y as i64)
    };
    let (open, shaded) = (
        middle(&ride),
        middle(&ride.clone().with_bodies(&bodies, "part0")),
    );
    assert!(open > 0.01 && shaded == 0.0, "{open} {shaded}");
}

#[test]
fn bodies_outside_of_the_room_and_without_orientations_are_refused() {
    let scene = room("", EVEN);
    let level = UnitQuaternion::identity();
    let track = motion([0.0, 0.0, 1.0], level, [3.0, 0.0, 0.0]);
    let bodies = [Body::moving("part3", cube([0.05; 3]), track.clone()).unwrap()];
    let watch = Watch::new(&scene, &scene.mounts[0], &track, &bodies);
    assert!(watch.check(0.5).is_ok());
    let error = watch.check(1.0).unwrap_err().to_string();
    assert!(
        error.contains("leaves the room") && error.contains("`part3` at (2.000, 5.000, 1.000) m"),
        "{error}"
    );
    assert!(watch.check(3.0).is_err());
    // Bodies that do not move may be outside of the walls, for an arena that is larger than the room.
    let far = Isometry3::from_parts(Translation3::new(9.0, 0.0, 0.0), level);
    let bodies = [Body::still("wall", cube([0.05; 3]), far)];
    let watch = Watch::new(&scene, &scene.mounts[0], &track, &bodies);
    assert!(watch.check(1.0).is_ok());
    let times = vec![0.0, 1.0];
    let bare = Trajectory::new(times, vec![Vector3::zeros(); 2]).unwrap();
    let error = Body::moving("part0", cube([0.05; 3]), bare).unwrap_err();
    assert!(error.to_string().contains("without orientations"));
}
