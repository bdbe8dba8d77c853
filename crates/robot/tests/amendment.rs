//! Fitted numbers in files of robots: only they change, and the import reads them back.

use nalgebra::{Matrix3, Vector3};
use realgap_core::file::Source;
use realgap_robot::import::amendment::{
    Amended, Amendment, BodyMass, JointQuantity, Target, amend,
};
use realgap_robot::import::{Options, import};
use realgap_robot::morphology::ServoLaw;
use realgap_robot::morphology::body::{JointKind, Structure};

const MJCF: &str = r#"<mujoco model="arm">
  <!-- größe: mm — kept -->
  <compiler angle="degree"/>
  <default>
    <joint damping="0.2"  armature="0.01"/>
    <position kp="20" kv="0.5" forcerange="-3 3"/>
  </default>
  <worldbody>
    <body name="base">
      <geom type="box" size=".1 .1 .1" contype="0" conaffinity="0"/>
      <body name="upper" pos="0 0 .2">
        <inertial pos="0 0 .1" mass="0.5" diaginertia="1e-3 1e-3 1e-4"/>
        <joint name="shoulder"
               axis="0 1 0" range="-90 90"/> <!-- the first -->
        <body name="lower" pos="0 0 .3">
          <joint name="elbow" axis="0 1 0" frictionloss='0.05'/><geom type="capsule" size=".02 .1"/>
        </body>
      </body>
    </body>
  </worldbody>
  <actuator>
    <position name="m1" joint="shoulder"/>
    <general name="m2" joint="elbow" gaintype="fixed" biastype="affine" gainprm="10" biasprm="0 -10 -1"/>
  </actuator>
</mujoco>
"#;

const URDF: &str = r#"<?xml version="1.0"?>
<robot name="arm">
  <link name="base"/>
  <link name="upper">
    <inertial> <origin xyz="0 0 0.1"/> <mass value="0.5"/>
      <inertia ixx="0.001" ixy="0" ixz="0" iyy="0.001" iyz="0" izz="0.0001"/></inertial>
  </link>
  <link name="lower"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="shoulder" type="revolute">
    <parent link="base"/><child link="upper"/>
    <limit lower="-1" upper="1" effort="3" velocity="5"/> <!-- guessed -->
    <dynamics damping="0.2"/>
  </joint>
  <joint name="elbow" type="continuous">
    <parent link="upper"/>
    <child link="lower"/>
  </joint>
</robot>
"#;

fn joint(joint: &str, quantity: JointQuantity, from: f64, to: f64) -> Amendment {
    let joint = joint.to_owned();
    Amendment {
        target: Target::Joint {
            joint,
            quantity,
            from,
            to,
        },
        remark: "realgap: fitted -- here".to_owned(),
    }
}

fn field(name: &str, to: f64) -> Amendment {
    let name = name.to_owned();
    Amendment {
        target: Target::Field { name, to },
        remark: String::new(),
    }
}

fn amended(file: &str, text: &str, amendments: &[Amendment]) -> Amended {
    amend(&Source::new(file, text), &Options::default(), amendments).unwrap()
}

fn read(file: &str, text: &str) -> Structure {
    let source = Source::new(file, text);
    import(&source, &Options::default()).unwrap().structure
}

/// Viscous friction, dry friction and armature of a joint.
fn bearing(robot: &Structure, name: &str) -> [f64; 3] {
    let mut joints = robot.joints.iter();
    match joints.find(|joint| joint.name == name).unwrap().kind {
        JointKind::Turn {
            viscous_nm_s_rad,
            dry_nm,
            armature_kg_m2,
            ..
        } => [viscous_nm_s_rad, dry_nm, armature_kg_m2],
        _ => panic!("{name} does not turn"),
    }
}

/// The lines of one text that the other does not have.
fn more<'a>(of: &'a str, than: &str) -> Vec<&'a str> {
    let known: Vec<&str> = than.lines().collect();
    of.lines().filter(|line| !known.contains(line)).collect()
}

#[test]
fn in_an_mjcf_only_fitted_numbers_change_and_the_import_reads_them() {
    use JointQuantity::{Armature, Dry, ServoDamping, ServoLimit, ServoStiffness, Viscous};
    let all = [
        joint("shoulder", Viscous, 0.2, 0.31),
        joint("elbow", Dry, 0.05, 0.07),
        joint("elbow", Armature, 0.01, 0.02),
        joint("shoulder", ServoStiffness, 20.0, 25.5),
        joint("shoulder", ServoLimit, 3.0, 2.5),
        joint("elbow", ServoStiffness, 10.0, 12.0),
        joint("elbow", ServoDamping, 1.0, 1.5),
    ];
    let amended = amended("arm.xml", MJCF, &all);
    for outcome in &amended.outcomes {
        assert!(outcome.is_ok(), "{outcome:?}");
    }
    let new = more(&amended.text, MJCF);
    let expected = [
        "        <!-- realgap: fitted - - here -->",
        "               axis=\"0 1 0\" range=\"-90 90\" damping=\"0.31\"/> <!-- the first -->",
        "          <!-- realgap: fitted - - here -->",
        "          <joint name=\"elbow\" axis=\"0 1 0\" frictionloss='0.07' armature=\"0.02\"/><geom type=\"capsule\" size=\".02 .1\"/>",
        "    <!-- realgap: fitted - - here -->",
        "    <position name=\"m1\" joint=\"shoulder\" forcerange=\"-2.5 2.5\" kp=\"25.5\"/>",
        "    <!-- realgap: fitted - - here -->",
        "    <general name=\"m2\" joint=\"elbow\" gaintype=\"fixed\" biastype=\"affine\" gainprm=\"12\" biasprm=\"0 -12 -1.5\"/>",
    ];
    assert_eq!(new, expected, "{}", amended.text);
    let robot = read("arm.xml", &amended.text);
    assert_eq!(bearing(&robot, "shoulder"), [0.31, 0.0, 0.01]);
    assert_eq!(bearing(&robot, "elbow"), [0.2, 0.07, 0.02]);
    let servo = |index: usize| robot.actuators[index].servo;
    assert_eq!(servo(0).max_torque_nm, 2.5);
    let law = |stiffness_nm_rad, damping_nm_s_rad| ServoLaw::Torque {
        stiffness_nm_rad,
        damping_nm_s_rad,
    };
    assert_eq!(servo(0).law, law(25.5, 0.5));
    assert_eq!(servo(1).law, law(12.0, 1.5));
}

#[test]
fn a_second_fit_replaces_the_comments_of_the_first() {
    let fit = |text: &str, from: f64, to: f64| {
        let one = joint("shoulder", JointQuantity::Viscous, from, to);
        amended("arm.xml", text, &[one]).text
    };
    let twice = fit(&fit(MJCF, 0.2, 0.31), 0.31, 0.4);
    assert_eq!(twice, fit(MJCF, 0.2, 0.4));
}

#[test]
fn masses_of_an_mjcf_are_stated_where_they_stand_or_in_place_of_the_shapes() {
    let robot = read("arm.xml", MJCF);
    let mass = |robot: &Structure, name: &str| {
        let body = robot.bodies.iter().find(|body| body.name == name).unwrap();
        let (x, y, z) = body.centre_of_mass_m.unwrap();
        BodyMass {
            mass_kg: body.mass_kg,
            centre_m: Vector3::new(x, y, z),
            inertia_kg_m2: body.inertia_kg_m2.unwrap().matrix(),
        }
    };
    let change = |name: &str, to: BodyMass| Amendment {
        target: Target::Body {
            body: name.to_owned(),
            from: mass(&robot, name),
            to,
        },
        remark: "fitted".to_owned(),
    };
    let scaled = |name: &str| {
        let own = mass(&robot, name);
        BodyMass {
            mass_kg: own.mass_kg * 1.5,
            inertia_kg_m2: own.inertia_kg_m2 * 1.5,
            ..own
        }
    };
    let sheared = BodyMass {
        centre_m: Vector3::new(0.01, 0.0, 0.09),
        inertia_kg_m2: Matrix3::new(2e-3, 1e-4, 0.0, 1e-4, 1e-3, 0.0, 0.0, 0.0, 1.5e-3),
        ..mass(&robot, "upper")
    };
    for (name, to) in [
        ("upper", scaled("upper")),
        ("lower", scaled("lower")),
        ("upper", sheared),
    ] {
        let amended = amended("arm.xml", MJCF, &[change(name, to)]);
        assert!(amended.outcomes[0].is_ok(), "{:?}", amended.outcomes);
        let found = mass(&read("arm.xml", &amended.text), name);
        assert!((found.mass_kg - to.mass_kg).abs() < 1e-12);
        assert!((found.centre_m - to.centre_m).norm() < 1e-12, "{found:?}");
        assert!(
            (found.inertia_kg_m2 - to.inertia_kg_m2).amax() < 1e-12,
            "{found:?} {to:?}"
        );
        assert!(more(&amended.text, MJCF).len() <= 3, "{}", amended.text);
    }
}

#[test]
fn fields_of_an_mjcf_are_found_by_name_and_in_its_own_units() {
    let all = [
        field("joint.*.damping", 0.4),
        field("joint.elbow.springref", std::f64::consts::FRAC_PI_2),
        field("actuator.m1.kp", 33.0),
        field("option.gravity[2]", -1.6),
        field("body.upper.mass", 1.0),
        field("joint.shoudler.damping", 1.0),
        field("joint.elbow.colour", 1.0),
    ];
    let amended = amended("arm.xml", MJCF, &all);
    let is_written: Vec<bool> = amended.outcomes.iter().map(Result::is_ok).collect();
    assert_eq!(is_written, [true, true, true, true, true, false, false]);
    let text = &amended.text;
    for part in [
        "range=\"-90 90\" damping=\"0.4\"",
        "springref=\"90\"",
        "kp=\"33\"",
        "<option gravity=\"0 0 -1.6\"/>",
        "mass=\"1\" diaginertia=\"0.002 0.002 0.0002\"",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let why = amended.outcomes[5].clone().unwrap_err();
    assert!(why.contains("no joint with the name `shoudler`"), "{why}");
}

#[test]
fn what_an_mjcf_cannot_say_leaves_it_as_it_was() {
    let replicated = MJCF.replace(
        "<body name=\"lower\" pos=\"0 0 .3\">",
        "<replicate count=\"2\"><body name=\"lower\" pos=\"0 0 .3\">",
    );
    let replicated = replicated.replacen("</body>", "</body></replicate>", 1);
    let copy = joint("elbow0", JointQuantity::Viscous, 0.2, 0.3);
    let own = MJCF
        .replace(" armature=\"0.01\"", "")
        .replace("<position kp", "<position armature=\"0.01\" kp");
    for (text, change, part) in [
        (replicated.as_str(), copy, "copies"),
        (
            MJCF,
            joint("wrist", JointQuantity::Dry, 0.0, 1.0),
            "no joint `wrist`",
        ),
        (
            own.as_str(),
            joint("shoulder", JointQuantity::Armature, 0.01, 0.005),
            "add 0.01",
        ),
    ] {
        let amended = amended("arm.xml", text, &[change]);
        let why = amended.outcomes[0].clone().unwrap_err();
        assert!(why.contains(part), "{why}");
        assert_eq!(amended.text, text);
    }
}

#[test]
fn in_a_urdf_only_fitted_numbers_change_and_the_import_reads_them() {
    use JointQuantity::{Armature, Dry, ServoLimit, ServoStiffness, Viscous};
    let all = [
        joint("shoulder", Viscous, 0.2, 0.31),
        joint("elbow", Dry, 0.0, 0.07),
        joint("shoulder", ServoLimit, 3.0, 2.5),
        joint("elbow", Armature, 0.0, 0.1),
        joint("shoulder", ServoStiffness, 1.0, 2.0),
    ];
    let amended = amended("arm.urdf", URDF, &all);
    let is_written: Vec<bool> = amended.outcomes.iter().map(Result::is_ok).collect();
    assert_eq!(is_written, [true, true, true, false, false]);
    let expected = [
        "    <!-- realgap: fitted - - here -->",
        "    <limit lower=\"-1\" upper=\"1\" effort=\"2.5\" velocity=\"5\"/> <!-- guessed -->",
        "    <!-- realgap: fitted - - here -->",
        "    <dynamics damping=\"0.31\"/>",
        "  <!-- realgap: fitted - - here -->",
        "    <dynamics friction=\"0.07\"/>",
    ];
    assert_eq!(more(&amended.text, URDF), expected, "{}", amended.text);
    let robot = read("arm.urdf", &amended.text);
    assert_eq!(bearing(&robot, "shoulder")[..2], [0.31, 0.0]);
    assert_eq!(bearing(&robot, "elbow")[..2], [0.0, 0.07]);
    assert_eq!(robot.actuators[0].servo.max_torque_nm, 2.5);
}
