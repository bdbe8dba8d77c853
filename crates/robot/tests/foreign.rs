//! Tests of the import of URDF and MJCF: which elements are supported, which notes are given, and which files are refused with
//! file and line.
#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

use std::path::PathBuf;

use nalgebra::Isometry3;
use realgap_core::file::Source;
use realgap_robot::import::{Note, NoteKind, Options};
use realgap_robot::morphology::body::uniform;
use realgap_robot::morphology::{Assembly, Freedom, Morphology, Shape};

const LINK: &str = r#"<inertial><mass value="0.2"/><inertia ixx="1e-4" iyy="2e-4" izz="2.5e-4"/></inertial>
    <collision><geometry><sphere radius="0.05"/></geometry></collision>"#;

fn import(name: &str, text: &str) -> (Assembly, Vec<Note>) {
    let source = Source::new(name, text);
    let (robot, notes) =
        Morphology::import(&source, &Options::default()).unwrap_or_else(|e| panic!("{e}"));
    // An imported robot can be written and read again.
    let ron = robot.to_ron().unwrap();
    let again =
        Morphology::parse(&Source::new("robot.ron", &ron)).unwrap_or_else(|e| panic!("{e}\n{ron}"));
    assert_eq!(robot.assemble(), again.assemble());
    (robot.assemble(), notes)
}

fn has_note(notes: &[Note], kind: NoteKind, part: &str) -> bool {
    notes
        .iter()
        .any(|note| note.kind == kind && note.what.contains(part) && !note.remedy.is_empty())
}

fn refusal(text: &str) -> String {
    let source = Source::new("bad.urdf", text);
    let error = Morphology::import(&source, &Options::default())
        .unwrap_err()
        .to_string();
    assert!(error.contains("bad.urdf"), "{error}");
    error
}

fn two(joint: &str) -> String {
    format!(
        "<robot name=\"r\">\n<link name=\"a\">{LINK}</link>\n<link name=\"b\">{LINK}</link>\n{joint}</robot>"
    )
}

const ENDS: &str = r#"<parent link="a"/><child link="b"/>"#;

#[test]
fn shapes_and_joints_keep_their_kind() {
    let (robot, notes) = import(
        "r.urdf",
        &format!(
            r#"<robot name="r"><link name="a">{LINK}</link>
        <link name="b"><inertial><origin xyz="0.01 0 0" rpy="0 0 0.5"/><mass value="0.3"/><inertia ixx="1e-4" iyy="2e-4" izz="2.5e-4"/></inertial>
            <collision><origin rpy="0.3 0 0"/><geometry><cylinder radius="0.03" length="0.1"/></geometry></collision></link>
        <joint name="j" type="prismatic"><origin xyz="0 0 0.2" rpy="0 0.4 0"/>{ENDS}<axis xyz="0 0 1"/>
            <limit lower="-0.1" upper="0.3" effort="10" velocity="2"/></joint></robot>"#
        ),
    );
    assert_eq!(robot.hinges[0].freedom, Freedom::Slide);
    assert_eq!(robot.hinges[0].bearing.limits_rad, Some((-0.1, 0.3)));
    let cylinder = robot.parts[1]
        .solids
        .iter()
        .find(|s| s.has_surface())
        .unwrap();
    assert!(matches!(
        cylinder.shape,
        Shape::Cylinder {
            radius_m: 0.03,
            half_length_m: 0.05
        }
    ));
    // The inertial frame is turned by 0.5 rad about z.
    let own = robot.parts[1].solids[0].inertia_kg_m2;
    let expected = 1e-4 * 0.5_f64.cos().powi(2) + 2e-4 * 0.5_f64.sin().powi(2);
    assert!((own[(0, 0)] - expected).abs() < 1e-15, "{own}");
    assert!(has_note(&notes, NoteKind::Assumed, "servos of 1 joints"));
}

#[test]
fn every_assumed_or_changed_value_gives_a_note_with_a_remedy() {
    let text = format!(
        r#"<robot name="r"><link name="a">{LINK}</link>
        <link name="b c"><inertial><mass value="1"/></inertial><collision><geometry><mesh filename="package://none/x.stl"/></geometry></collision></link>
        <link name="B_c"/>
        <joint name="j" type="revolute"><parent link="a"/><child link="b c"/><limit lower="0" upper="0" effort="1e6" velocity="1"/></joint>
        <joint name="k" type="continuous"><parent link="a"/><child link="B_c"/></joint>
        <transmission name="t"/><gazebo/></robot>"#
    );
    let (robot, notes) = import("r.urdf", &text);
    assert_eq!(robot.hinges.len(), 1);
    for (kind, part) in [
        (NoteKind::Doubt, "cannot be found"),
        (NoteKind::Doubt, "case only"),
        (NoteKind::Assumed, "inertia of link `b c`"),
        (NoteKind::Changed, "limits 0 to 0"),
        (NoteKind::Changed, "effort 1000000"),
        (NoteKind::Changed, "beyond joint `k` have no mass"),
        (NoteKind::Changed, "the name \"b c\""),
        (NoteKind::LeftOut, "<transmission>"),
        (NoteKind::LeftOut, "<gazebo>"),
    ] {
        assert!(has_note(&notes, kind, part), "{part}: {notes:#?}");
    }
}

#[test]
fn a_root_named_world_or_without_mass_is_mounted_and_any_other_root_is_free() {
    let fixed = |root: &str, inside: &str, kind: &str| {
        let text = format!(
            r#"<robot name="r"><link name="{root}">{inside}</link><link name="b">{LINK}</link><link name="c">{LINK}</link>
            <joint name="j" type="{kind}"><parent link="{root}"/><child link="b"/></joint>
            <joint name="k" type="continuous"><parent link="b"/><child link="c"/></joint></robot>"#
        );
        import("r.urdf", &text).0.world_from_mount.is_some()
    };
    assert!(fixed("world", "", "fixed"));
    assert!(fixed("base", "", "continuous"));
    assert!(!fixed("base", "", "fixed"));
    assert!(!fixed("base", LINK, "continuous"));
}

#[test]
fn meshes_become_hulls_and_unusable_meshes_give_a_doubt() {
    let folder = std::env::temp_dir().join(format!("realgap-meshes-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let stl = |corners: &[[f64; 9]]| {
        let mut text = "solid s\n".to_owned();
        for c in corners {
            text += &format!(
                "facet normal 0 0 0\nouter loop\nvertex {} {} {}\nvertex {} {} {}\nvertex {} {} {}\nendloop\nendfacet\n",
                c[0], c[1], c[2], c[3], c[4], c[5], c[6], c[7], c[8]
            );
        }
        text + "endsolid s\n"
    };
    let tetrahedron = [
        [0.0, 0.0, 0.0, 0.1, 0.0, 0.0, 0.0, 0.1, 0.0],
        [0.0, 0.0, 0.0, 0.0, 0.1, 0.0, 0.0, 0.0, 0.1],
        [0.0, 0.0, 0.0, 0.0, 0.0, 0.1, 0.1, 0.0, 0.0],
        [0.1, 0.0, 0.0, 0.0, 0.0, 0.1, 0.0, 0.1, 0.0],
    ];
    std::fs::write(folder.join("good.stl"), stl(&tetrahedron)).unwrap();
    std::fs::write(folder.join("flat.stl"), stl(&tetrahedron[..1])).unwrap();
    std::fs::write(folder.join("empty.stl"), stl(&[])).unwrap();
    let read = |mesh: &str, scale: &str| {
        let text = format!(
            r#"<robot name="r"><link name="a"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1"/></inertial>
            <collision><geometry><mesh filename="{mesh}.stl" scale="{scale}"/></geometry></collision></link></robot>"#
        );
        let path: PathBuf = folder.join("r.urdf");
        let source = Source::new(path, text);
        let (robot, notes) =
            Morphology::import(&source, &Options::default()).unwrap_or_else(|e| panic!("{e}"));
        (robot.assemble(), notes)
    };
    let (robot, notes) = read("good", "1 1 1");
    let hull = robot.parts[0]
        .solids
        .iter()
        .find(|s| s.has_surface())
        .unwrap();
    assert!(
        matches!(&hull.shape, Shape::Hull { points_m } if points_m.len() == 4) && notes.is_empty(),
        "{notes:#?}"
    );
    assert!(has_note(&read("flat", "1 1 1").1, NoteKind::Doubt, "flat"));
    assert!(has_note(
        &read("empty", "1 1 1").1,
        NoteKind::Doubt,
        "empty"
    ));
    assert!(has_note(
        &read("good", "1000 1000 1000").1,
        NoteKind::Doubt,
        "m long"
    ));
    std::fs::remove_dir_all(&folder).unwrap();
}

/// The triangles of a box between two corners, as ASCII STL writes them.
fn facets(low: [f64; 3], high: [f64; 3]) -> String {
    let corner = |k: usize| {
        [0, 1, 2].map(|axis| {
            if k >> axis & 1 == 1 {
                high[axis]
            } else {
                low[axis]
            }
        })
    };
    let sides = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let mut text = String::new();
    for [a, b, c, d] in sides {
        for triangle in [[a, b, c], [a, c, d]] {
            text += "facet normal 0 0 0\nouter loop\n";
            for [x, y, z] in triangle.map(corner) {
                text += &format!("vertex {x} {y} {z}\n");
            }
            text += "endloop\nendfacet\n";
        }
    }
    text
}

#[test]
fn a_concave_mesh_stays_open_as_several_hulls_while_a_single_hull_fills_it() {
    let folder = tempfile::tempdir().unwrap();
    // A channel: a floor and two walls, 20 mm thick, 100 mm wide and high.
    let channel = [
        facets([0.0, 0.0, 0.0], [0.1, 0.1, 0.02]),
        facets([0.0, 0.0, 0.02], [0.02, 0.1, 0.1]),
        facets([0.08, 0.0, 0.02], [0.1, 0.1, 0.1]),
    ];
    let text = format!("solid s\n{}endsolid s\n", channel.concat());
    std::fs::write(folder.path().join("channel.stl"), text).unwrap();
    let volume_m3 = |hulls: usize| {
        let text = r#"<robot name="r"><link name="a"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1"/></inertial>
            <collision><geometry><mesh filename="channel.stl"/></geometry></collision></link></robot>"#;
        let source = Source::new(folder.path().join("r.urdf"), text);
        let options = Options {
            hulls,
            ..Options::default()
        };
        let (robot, _) = Morphology::import(&source, &options).unwrap_or_else(|e| panic!("{e}"));
        let solids = robot.assemble().parts[0].solids.clone();
        let shapes = solids.iter().filter(|solid| solid.has_surface());
        let volumes = shapes.map(|solid| uniform(&solid.shape).unwrap().volume_m3);
        let volumes: Vec<f64> = volumes.collect();
        (volumes.len(), volumes.iter().sum::<f64>())
    };
    let (filled, true_m3) = (1e-3, 0.1 * 0.1 * 0.02 + 2.0 * 0.02 * 0.1 * 0.08);
    let (count, own_m3) = volume_m3(1);
    assert!(
        count == 1 && (own_m3 / filled - 1.0).abs() < 1e-6,
        "{own_m3}"
    );
    let (count, parts_m3) = volume_m3(8);
    assert!((3..=8).contains(&count), "{count}");
    assert!(
        (parts_m3 / true_m3 - 1.0).abs() < 0.05,
        "{parts_m3} of {true_m3}"
    );
}

#[test]
fn a_robot_without_masses_gets_those_of_its_shapes_at_the_density_of_water() {
    let link = |name: &str, shape: &str| {
        format!("<link name=\"{name}\"><collision><geometry>{shape}</geometry></collision></link>")
    };
    let joint =
        format!("<joint name=\"j\" type=\"continuous\"><origin xyz=\"0 0 1\"/>{ENDS}</joint>");
    let (a, b) = ("<box size=\"0.1 0.2 0.3\"/>", "<sphere radius=\"0.1\"/>");
    let text = format!(
        "<robot name=\"r\">{}{}{joint}</robot>",
        link("a", a),
        link("b", b)
    );
    let (robot, notes) = import("r.urdf", &text);
    let masses = robot
        .parts
        .iter()
        .map(|part| part.mass(&Isometry3::identity()).mass_kg);
    let masses: Vec<f64> = masses.collect();
    let ball_kg = 1000.0 * 4.0 / 3.0 * std::f64::consts::PI * 1e-3;
    assert!(
        (masses[0] - 6.0).abs() < 1e-9 && (masses[1] - ball_kg).abs() < 1e-9,
        "{masses:?}"
    );
    assert!(
        has_note(
            &notes,
            NoteKind::Assumed,
            "no link has a mass: the masses are"
        ),
        "{notes:#?}"
    );
    // Without shapes every link is assumed to be a ball, and a note has_note so.
    let (robot, notes) = import(
        "r.urdf",
        &format!("<robot name=\"r\"><link name=\"a\"/><link name=\"b\"/>{joint}</robot>"),
    );
    assert_eq!(robot.hinges.len(), 1);
    assert!(
        has_note(&notes, NoteKind::Assumed, "each link is a ball of 1 kg"),
        "{notes:#?}"
    );
}

#[test]
fn errors_that_other_readers_accept_are_repaired_and_ignored_elements_give_notes() {
    let joint = |name: &str, inside: &str| {
        format!(
            "<joint name=\"{name}\" type=\"revolute\">{inside}<limit lower=\"-1\" upper=\"1\" effort=\"2\" velocity=\"1\"/></joint>"
        )
    };
    let text = format!(
        r#"<!DOCTYPE robot>
        <!-- ---- two hyphens are no XML ---- -->
        <robot name="r"><link name="a">{LINK}</link><link name="b">{LINK}</link><link name="c">
            <inertial><mass value="0.2"/><inertia ixx="1e-4" iyy="2e-4" izz="2.5e-4"/></inertial>
            <collision><geometry><box size="-0.1 0.1 0.1"/></geometry></collision></link>
        {}{}
        <joint name="l" type="revolute"><parent link="a"/><child link="d"/><limit lower="-1" upper="1" effort="inf" velocity="inf" jerk="3"/></joint>
        <link name="d">{LINK}</link><link name="e">{LINK}</link>
        <joint name="m" type="revolute"><parent link="a"/><child link="e"/><limit lower="-1" upper="1"/></joint></robot>"#,
        joint(
            "j",
            &format!("{ENDS}<mimic joint=\"k\"/><origin xyz=\"\" quat_xyzw=\"0 0 1 0\"/>")
        ),
        joint(
            "k",
            "<parent link=\"b\"/><child link=\"c\"/><mimic joint=\"j\"/>"
        ),
    );
    let (robot, notes) = import("r.urdf", &text);
    assert_eq!(robot.hinges.len(), 4);
    // Half a turn about z.
    let axis = robot.hinges[0].axis_robot;
    assert!((axis.x + 1.0).abs() < 1e-12, "{axis:?}");
    for (kind, part) in [
        (NoteKind::LeftOut, "document type"),
        (NoteKind::Changed, "is negative"),
        (NoteKind::LeftOut, "mimics a joint that mimics it"),
        (NoteKind::Changed, "empty list"),
        (NoteKind::Changed, "the effort inf"),
        (NoteKind::LeftOut, "`jerk` of <limit>"),
        (NoteKind::LeftOut, "servos of 1 joints that state no effort"),
    ] {
        assert!(has_note(&notes, kind, part), "{part}: {notes:#?}");
    }
}

#[test]
fn files_without_a_valid_robot_are_refused_with_file_line_and_reason() {
    let joint = |inside: &str| {
        two(&format!(
            "<joint name=\"j\" type=\"revolute\">{inside}{ENDS}</joint>"
        ))
    };
    let body =
        |inside: &str| format!("<robot name=\"r\">\n<link name=\"a\">{inside}</link></robot>");
    let bomb =
        "<!DOCTYPE r [<!ENTITY a \"aaaaaaaa\"><!ENTITY b \"&a;&a;&a;&a;\">]><robot name=\"&b;\"/>";
    for (text, expected) in [
        ("<robot".to_owned(), "not XML"),
        ("<sdf/>".to_owned(), "neither"),
        (bomb.to_owned(), "entities"),
        (two(""), "exactly one root"),
        (
            two("<joint name=\"j\" type=\"fixed\"><parent link=\"a\"/><child link=\"c\"/></joint>"),
            "bad.urdf:6:",
        ),
        (
            two(&format!(
                "<joint name=\"j\" type=\"fixed\">{ENDS}</joint><joint name=\"k\" type=\"fixed\">{ENDS}</joint>"
            )),
            "two joints",
        ),
        (
            two(&format!(
                "<joint name=\"j\" type=\"fixed\">{ENDS}</joint><joint name=\"k\" type=\"fixed\"><parent link=\"b\"/><child link=\"a\"/></joint>"
            )),
            "cycle",
        ),
        (joint("<origin xyz=\"0 0\"/>"), "3 finite numbers"),
        (joint("<axis xyz=\"0 0 nan\"/>"), "3 finite numbers"),
        (joint("<axis xyz=\"0 0 0\"/>"), "no direction"),
        (joint("<origin xyz=\"${x} 0 0\"/>"), "xacro"),
        (
            two(&format!("<joint name=\"j\" type=\"hinge\">{ENDS}</joint>")),
            "unknown type",
        ),
        (
            body("<inertial><mass value=\"-1\"/></inertial>"),
            "negative mass",
        ),
        (
            body(
                "<inertial><mass value=\"1\"/><inertia ixx=\"-1\" iyy=\"1\" izz=\"1\"/></inertial>",
            ),
            "physically impossible",
        ),
        (
            body(
                "<inertial><mass value=\"1\"/><inertia ixx=\"0\" iyy=\"1\" izz=\"1\"/></inertial>",
            ),
            "bad.urdf:2:",
        ),
        (
            format!(
                "<robot name=\"r\"><link name=\"a\">{LINK}</link><link name=\"a\">{LINK}</link></robot>"
            ),
            "same name",
        ),
        ("<robot name=\"r\"/>".to_owned(), "without links"),
        (
            body("<inertial><mass value=\"0,5\"/></inertial>"),
            "bad.urdf:2:",
        ),
        (
            body("<inertial><mass value=\"1e300\"/></inertial>"),
            "bad.urdf:2:",
        ),
        (
            two(&format!(
                "<joint name=\"j\" type=\"fixed\">{ENDS}</joint>\n<joint name=\"k\" type=\"fixed\"><parent link=\"b\"/><child link=\"b\"/></joint>"
            )),
            "two joints",
        ),
        (
            format!(
                "<robot name=\"r\"><link name=\"base\">{LINK}</link><link name=\"a\">{LINK}</link><link name=\"b\">{LINK}</link>\n\n<joint name=\"j\" type=\"fixed\">{ENDS}</joint><joint name=\"k\" type=\"fixed\"><parent link=\"b\"/><child link=\"a\"/></joint></robot>"
            ),
            // The collision shape of each link starts a new line, three times.
            "bad.urdf:6:",
        ),
        (joint("<origin xyz=\"1e200 0 0\"/>"), "bad.urdf:6:"),
    ] {
        let error = refusal(&text);
        assert!(error.contains(expected), "{text}\n{error}");
    }
}

#[test]
fn mjcf_resolves_defaults_angles_and_densities() {
    let (robot, notes) = import(
        "r.xml",
        r#"<mujoco model="r"><compiler angle="degree" autolimits="true"/>
        <default><geom density="500"/><joint damping="0.2" armature="0.01"/></default>
        <worldbody><geom type="plane" size="1 1 1"/>
        <body name="torso" pos="0 0 1"><freejoint/><geom type="box" size="0.1 0.2 0.3"/>
            <body name="leg" pos="0 0 -0.3"><joint name="x" axis="1 0 0" range="-30 60"/><joint name="y" axis="0 1 0" stiffness="3"/>
                <geom type="capsule" fromto="0 0 0 0 0 -0.4" size="0.05"/><site name="foot" pos="0 0 -0.4"/></body></body></worldbody>
        <actuator><motor joint="x" gear="20" ctrlrange="-1 1"/><position joint="y" kp="10"/></actuator>
        <tendon/><sensor><gyro site="foot"/></sensor></mujoco>"#,
    );
    assert_eq!(
        (robot.parts.len(), robot.hinges.len(), robot.marks.len()),
        (3, 2, 1)
    );
    let torso = robot.parts[0].mass(&Isometry3::identity());
    assert!(
        (torso.mass_kg - 500.0 * 0.2 * 0.4 * 0.6).abs() < 1e-12,
        "{}",
        torso.mass_kg
    );
    let limits = robot.hinges[0].bearing.limits_rad.unwrap();
    assert!((limits.1 - 60.0_f64.to_radians()).abs() < 1e-12);
    assert!(
        robot
            .hinges
            .iter()
            .all(|hinge| hinge.bearing.viscous_nm_s_rad == 0.2)
    );
    assert_eq!(robot.hinges[0].actuator.unwrap().servo.max_torque_nm, 20.0);
    assert!(robot.world_from_mount.is_none());
    assert!(
        has_note(&notes, NoteKind::LeftOut, "<sensor>"),
        "{notes:#?}"
    );
    assert!(has_note(&notes, NoteKind::Assumed, "torques as commands"));
}

#[test]
fn the_heaviest_body_with_a_free_joint_is_the_robot_and_what_stands_beside_it_is_said() {
    let text = r#"<mujoco><worldbody><geom type="plane" size="5 5 .1"/>
        <body name="target" mocap="true" pos="1 0 .5"><geom size=".02" contype="0" conaffinity="0"/></body>
        <body name="puck" pos="1 1 .1"><freejoint/><geom size=".05" mass="0.1"/></body>
        <body name="rover" pos="0 0 .5"><freejoint/><geom type="box" size=".1 .1 .05" mass="1"/>
            <body name="arm"><joint axis="0 1 0"/><geom size=".03" mass="0.2"/></body></body>
        </worldbody></mujoco>"#;
    let (assembly, notes) = import("two.xml", text);
    assert!(assembly.world_from_mount.is_none());
    assert_eq!(assembly.module_names, ["rover", "arm"]);
    // A ball is no box, and nothing can touch the target.
    for said in [
        "1 bodies beside the robot, whose root is `rover`, the heaviest body with a free joint: `puck`",
        "`target`",
    ] {
        assert!(has_note(&notes, NoteKind::LeftOut, said), "{notes:?}");
    }
}

#[test]
fn a_held_hand_does_not_start_inside_the_floor() {
    let text = r#"<mujoco><worldbody><body name="palm"><geom type="box" size=".05 .05 .05" mass="1"/>
        <body name="finger" pos="0 0 -.05"><joint name="j" axis="0 1 0"/><geom type="capsule" fromto="0 0 0 0 0 -.1" size=".01" mass=".1"/></body></body></worldbody>
        <actuator><position joint="j" kp="2"/></actuator></mujoco>"#;
    let (assembly, notes) = import("hand.xml", text);
    let height_m = assembly.world_from_mount.unwrap().translation.z;
    assert!(height_m > 0.16, "{height_m}");
    assert!(
        has_note(&notes, NoteKind::Assumed, "160.0 mm below the floor"),
        "{notes:?}"
    );
    let (assembly, _) = import(
        "arm.xml",
        &text.replace("name=\"palm\"", "name=\"palm\" pos=\"0 0 1\""),
    );
    assert_eq!(assembly.world_from_mount.unwrap().translation.z, 0.0);
}

#[test]
fn xacro_and_sdf_are_refused_with_the_command_that_converts_them() {
    let declared = r#"<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">
        <xacro:property name="a" value="1"/><link name="l"/></robot>"#;
    let bare = r#"<robot name="r"><xacro:macro name="a"/><link name="l"/></robot>"#;
    for text in [declared, bare] {
        let said = refusal(text);
        assert!(said.contains("xacro FILE.xacro > FILE.urdf"), "{said}");
    }
    assert!(refusal("<sdf version='1.9'><model name='m'/></sdf>").contains("gz sdf -p"));
}
