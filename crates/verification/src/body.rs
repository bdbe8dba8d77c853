//! Builds the simple robots that the checks simulate.

use nalgebra::{Isometry3, Matrix3, UnitQuaternion, Vector3};

use realgap_core::error::Result;
use realgap_core::file::Source;
use realgap_robot::morphology::{
    Actuator, Assembly, Bearing, CommandScale, Freedom, Gait, Hinge, Morphology, Part, Role, Servo,
    ServoLaw, Shape, Solid,
};

/// Edge of a module, metres.
pub(super) const SIDE_M: f64 = 0.06;
/// Mass of a module, kg.
pub(super) const MASS_KG: f64 = 0.1;

/// A uniform box along the robot's axes; inertia m (a² + b²) / 12 about each axis.
pub(super) fn block(centre_m: Vector3<f64>, half_m: Vector3<f64>, mass_kg: f64) -> Solid {
    let squares = half_m.component_mul(&half_m) * 4.0;
    let about = |a: f64, b: f64| mass_kg * (a + b) / 12.0;
    Solid {
        module: 0,
        role: Role::Cube,
        number: 0,
        shape: Shape::cuboid(half_m),
        robot_from_solid: Isometry3::from_parts(centre_m.into(), UnitQuaternion::identity()),
        mass_kg,
        centre_of_mass_solid_m: Vector3::zeros(),
        inertia_kg_m2: Matrix3::from_diagonal(&Vector3::new(
            about(squares.y, squares.z),
            about(squares.x, squares.z),
            about(squares.x, squares.y),
        )),
        gravity_compensation: 0.0,
        collides: true,
        tyre: None,
        turning: Default::default(),
    }
}

/// A module whose centre is this many modules away from the robot frame's origin.
pub(super) fn module(x: f64, y: f64, z: f64) -> Solid {
    block(
        Vector3::new(x, y, z) * SIDE_M,
        Vector3::repeat(0.5 * SIDE_M),
        MASS_KG,
    )
}

/// Parts and hinges as a robot; the origin of the robot frame is tracked.
pub(super) fn robot(parts: Vec<Vec<Solid>>, hinges: Vec<Hinge>) -> Assembly {
    Assembly {
        name: "body".to_owned(),
        module_names: vec!["body".to_owned()],
        parts: parts.into_iter().map(|solids| Part { solids }).collect(),
        hinges,
        is_modular: true,
        collision_exclude: Vec::new(),
        world_from_mount: None,
        marks: Vec::new(),
        track_part: 0,
        robot_from_track: Isometry3::identity(),
        body_length_m: SIDE_M,
        surroundings: Default::default(),
    }
}

/// A single module.
pub(super) fn cube() -> Assembly {
    robot(vec![vec![module(0.0, 0.0, 0.0)]], Vec::new())
}

/// Three modules rigidly attached in the shape of an L.
pub(super) fn corner() -> Assembly {
    let solids = vec![
        module(0.0, 0.0, 0.0),
        module(1.0, 0.0, 0.0),
        module(0.0, 1.0, 0.0),
    ];
    robot(vec![solids], Vec::new())
}

/// Four modules rigidly attached in a bar along x.
pub(super) fn bar() -> Assembly {
    let solids = (0..4).map(|k| module(f64::from(k), 0.0, 0.0)).collect();
    robot(vec![solids], Vec::new())
}

/// A body without any symmetry: five modules in three dimensions.
pub(super) fn lopsided() -> Assembly {
    let solids = vec![
        module(0.0, 0.0, 0.0),
        module(1.0, 0.0, 0.0),
        module(2.0, 0.0, 0.0),
        module(0.0, 1.0, 0.0),
        module(0.0, 0.0, 1.0),
    ];
    robot(vec![solids], Vec::new())
}

/// Half the edge of the base that carries an arm, metres.
pub(super) const BASE_HALF_M: f64 = 0.2;
/// Distance of the arm's centre of mass from its hinge, metres.
pub(super) const ARM_M: f64 = 0.5 * SIDE_M;

/// Inertia of the arm about its hinge: m s²/6 + m r², kg m².
pub(super) fn arm_inertia_kg_m2(mass_kg: f64) -> f64 {
    mass_kg * (SIDE_M * SIDE_M / 6.0 + ARM_M * ARM_M)
}

/// A base so heavy (a tonne) that it stands still, and an arm (one module) that is hinged to it and sticks out along +x.
/// With a hinge axis along +y, the arm swings under gravity; with an axis along +z, the hinge carries the arm's weight.
pub(super) fn arm(mass_kg: f64, axis: Vector3<f64>, servo: Servo, gait: Gait) -> Assembly {
    let base = block(Vector3::zeros(), Vector3::repeat(BASE_HALF_M), 1000.0);
    let mut arm = block(
        Vector3::new(BASE_HALF_M + ARM_M, 0.0, 0.0),
        Vector3::repeat(0.5 * SIDE_M),
        mass_kg,
    );
    arm.collides = false;
    let hinge = Hinge {
        name: "hinge".to_owned(),
        module: 0,
        parent_part: 0,
        child_part: 1,
        anchor_robot_m: Vector3::new(BASE_HALF_M, 0.0, 0.0),
        axis_robot: nalgebra::Unit::new_normalize(axis),
        freedom: Freedom::Turn,
        actuator: Some(Actuator {
            servo,
            gait,
            command: CommandScale::default(),
        }),
        bearing: Bearing::default(),
        is_stated: false,
        start_rad: None,
    };
    robot(vec![vec![base], vec![arm]], vec![hinge])
}

/// A servo that follows its command with gain `gain_per_s` within its limits of torque and speed.
pub(super) fn velocity_servo(gain_per_s: f64, max_torque_nm: f64, max_speed_rad_s: f64) -> Servo {
    Servo {
        law: ServoLaw::Velocity { gain_per_s },
        max_torque_nm,
        max_speed_rad_s,
        delay_s: 0.0,
        torque_constant_nm_a: None,
    }
}

/// A hinge that turns freely.
pub(super) fn no_servo() -> Servo {
    velocity_servo(0.0, 0.0, f64::INFINITY)
}

/// A command that stays at zero.
pub(super) const STILL: Gait = Gait {
    offset_rad: 0.0,
    amplitude_rad: 0.0,
    frequency_hz: 0.0,
    phase_rad: 0.0,
};

/// A command that moves away from zero at 157 rad/s, which is too fast for the servo to catch up.
pub(super) const RUNAWAY: Gait = Gait {
    amplitude_rad: 1000.0,
    frequency_hz: 0.025,
    ..STILL
};

/// Half the edge of the square plate that a cube stands on, metres.
pub(super) const PLATE_HALF_M: f64 = 0.5 * SIDE_M;
/// Thickness of the plate that a cube stands on, metres.
pub(super) const PLATE_THICKNESS_M: f64 = 0.006;
/// Mass of the plate that a cube stands on, kg.
pub(super) const PLATE_KG: f64 = 0.012;
/// From the floor to the centre of the cube that stands on the plate, metres.
pub(super) const CUBE_ON_PLATE_M: f64 = PLATE_THICKNESS_M + 0.5 * SIDE_M;

/// A module on a light plate that a vertical hinge turns; the module's centre is tracked.
pub(super) fn on_plate(servo: Servo, gait: Gait) -> Assembly {
    stool(vec![module(0.0, 0.0, 0.0)], servo, gait)
}

/// Several rigidly attached modules; a vertical hinge connects the one at the origin to a light plate below it.
pub(super) fn stool(modules: Vec<Solid>, servo: Servo, gait: Gait) -> Assembly {
    let plate = Solid {
        role: Role::Plate,
        ..block(
            Vector3::new(0.0, 0.0, 0.5 * PLATE_THICKNESS_M - CUBE_ON_PLATE_M),
            Vector3::new(PLATE_HALF_M, PLATE_HALF_M, 0.5 * PLATE_THICKNESS_M),
            PLATE_KG,
        )
    };
    let hinge = Hinge {
        name: "hinge".to_owned(),
        module: 0,
        parent_part: 0,
        child_part: 1,
        anchor_robot_m: Vector3::new(0.0, 0.0, -0.5 * SIDE_M),
        axis_robot: -Vector3::z_axis(),
        freedom: Freedom::Turn,
        actuator: Some(Actuator {
            servo,
            gait,
            command: CommandScale::default(),
        }),
        bearing: Bearing::default(),
        is_stated: false,
        start_rad: None,
    };
    robot(vec![modules, vec![plate]], vec![hinge])
}

/// The walking tripod, the same robot as in `morphologies/`.
pub(super) fn tripod() -> Result<Assembly> {
    let text = include_str!("../tripod.ron");
    Ok(Morphology::parse(&Source::new("morphologies/tripod.ron", text))?.assemble())
}

/// A heavy module with ten light modules attached to it in a row along x; the last module is tracked. The robot is read from the
/// text of a robot file so that the check covers the attachments of robot files, too.
pub(super) fn cantilever() -> Result<Assembly> {
    let names: Vec<String> = (0..10).map(|k| format!("m{k}")).collect();
    let modules: String = names
        .iter()
        .map(|name| format!("(name: \"{name}\", kind: Passive(mass_kg: 0.07)),"))
        .collect();
    let attachments: String = names
        .iter()
        .enumerate()
        .map(|(k, name)| {
            let parent = k.checked_sub(1).map_or("base", |before| &names[before]);
            format!("(parent: \"{parent}\", face: PosX, child: \"{name}\"),")
        })
        .collect();
    let text = format!(
        "(name: \"cantilever\", defaults: (side_m: {SIDE_M}), modules: [(name: \"base\", \
         kind: Passive(mass_kg: 20.0)), {modules}], attachments: [{attachments}], track: \"m9\")"
    );
    Ok(Morphology::parse(&Source::new("cantilever.ron", text))?.assemble())
}
