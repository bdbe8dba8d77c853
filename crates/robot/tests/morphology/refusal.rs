//! Tests that robots which cannot be built are refused with file, line, column and reason.

use realgap_core::file::Source;
use realgap_robot::morphology::Morphology;

fn refusal(text: &str) -> String {
    match Morphology::parse(&Source::new("robot.ron", text)) {
        Ok(morphology) => format!("not refused: {}", morphology.name()),
        Err(error) => error.to_string(),
    }
}

/// A robot of plain cubes `a`, `b`, `c` of 0.1 m and 1 kg; its attachments start on line 8.
fn cubes(glue: &str) -> String {
    format!(
        "(
    name: \"cubes\",
    modules: [
        (name: \"a\", kind: Passive(side_m: 0.1, mass_kg: 1)),
        (name: \"b\", kind: Passive(side_m: 0.1, mass_kg: 1)),
        (name: \"c\", kind: Passive(side_m: 0.1, mass_kg: 1)),
    ],
    glue: [{glue}],
)"
    )
}

/// A robot of one module, whose kind is on line 3.
fn alone(kind: &str) -> String {
    format!("(\n    name: \"alone\",\n    modules: [(name: \"a\", kind: {kind})],\n)")
}

/// A robot of one active module; `rest` states the fields after the face.
fn active(rest: &str) -> String {
    let kind = format!(
        "Active(side_m: 0.1, mass_kg: 1, face: PosX,
        {rest})"
    );
    alone(&kind)
}

const PLATE: &str = "axis: Normal(plate: (side_m: 0.1, thickness_m: 0.01, mass_kg: 0.1))";
const SERVO: &str = "servo: (law: Velocity(gain_1_s: 30), max_torque_nm: 1)";

#[test]
fn an_unknown_field_is_refused_with_the_allowed_ones() {
    insta::assert_snapshot!(refusal(&alone("Passive(side_m: 0.1, masskg: 1)")), @r"
    robot.ron:3:54: modules[0].kind.masskg: unknown field
      found:   masskg
      allowed: side_m, sides_m, boxes, mass_kg, inertia_kg_m2, centre_of_mass_m
      hint:    did you mean `mass_kg`?
    ");
    insta::assert_snapshot!(refusal("(nam: \"x\", modules: [])"), @r"
    robot.ron:1:2: nam: unknown field
      found:   nam
      allowed: name, description, defaults, modules, attachments, glue, hinges, collision_exclude, never_touch, mount_m, track
      hint:    did you mean `name`?
    ");
}

#[test]
fn an_unknown_name_is_refused_with_the_allowed_ones() {
    insta::assert_snapshot!(refusal(&alone("Pasive(side_m: 0.1, mass_kg: 1)")), @r"
    robot.ron:3:33: modules[0].kind: unknown name
      found:   Pasive
      allowed: Passive, Active
      hint:    did you mean `Passive`?
    ");
    insta::assert_snapshot!(refusal(&cubes("(parent: \"a\", face: posx, child: \"b\")")), @r"
    robot.ron:8:32: glue[0].face: unknown name
      found:   posx
      allowed: PosX, NegX, PosY, NegY, PosZ, NegZ
      hint:    did you mean `PosX`?
    ");
}

#[test]
fn a_missing_field_is_named() {
    insta::assert_snapshot!(refusal(&alone("Passive(side_m: 0.1)")), @r"
    robot.ron:3:33: modules[0].kind: the field `mass_kg` is missing
      hint:    add `mass_kg` here, or to `defaults` for all modules
    ");
    insta::assert_snapshot!(refusal(&active(PLATE)), @r"
    robot.ron:3:33: modules[0].kind: the field `servo` is missing
      hint:    add `servo` here, or to `defaults` for all modules
    ");
    insta::assert_snapshot!(refusal(&cubes("(parent: \"a\", child: \"b\")")), @r"
    robot.ron:8:12: glue[0]: the field `face` is missing
      hint:    add `face: ...`
    ");
    insta::assert_snapshot!(refusal("(name: \"x\")"), @r"
    robot.ron:1:1: the field `modules` is missing
      hint:    add `modules: ...`
    ");
}

#[test]
fn a_value_of_the_wrong_type_is_refused() {
    insta::assert_snapshot!(refusal(&alone("Passive(side_m: \"0.1\", mass_kg: 1)")), @r#"
    robot.ron:3:49: modules[0].kind.side_m: a value of the wrong kind
      found:   "0.1"
      allowed: a number
    "#);
    insta::assert_snapshot!(refusal(&alone("Passive")), @r"
    robot.ron:3:40: modules[0].kind: `Passive` needs brackets
      found:   Passive
      allowed: Passive(...)
      hint:    the brackets are needed even if no field stands in them
    ");
    insta::assert_snapshot!(refusal(&alone("3")), @r"
    robot.ron:3:33: modules[0].kind: a value of the wrong kind
      found:   3
      allowed: a name, without quotes
    ");
    insta::assert_snapshot!(refusal(&alone("Passive(side_m: 0.1, mass_kg: 1, centre_of_mass_m: (0, 0))")), @r"
    robot.ron:3:84: modules[0].kind.centre_of_mass_m: wrong number of values
      found:   2
      allowed: a group `( ... )` of 3
    ");
    insta::assert_snapshot!(refusal("(name: tripod, modules: [])"), @r"
    robot.ron:1:8: name: a value of the wrong kind
      found:   tripod
      allowed: text in double quotes
    ");
    insta::assert_snapshot!(refusal("(name: \"x\", modules: 3)"), @r"
    robot.ron:1:22: modules: a value of the wrong kind
      found:   3
      allowed: a list `[ ... ]`
    ");
    insta::assert_snapshot!(
        refusal(&cubes("(parent: \"a\", face: PosX, child: \"b\", quarter_turns: 1.5)")), @r"
    robot.ron:8:65: glue[0].quarter_turns: a value of the wrong kind
      found:   1.5
      allowed: a value that fits here (whole numbers are written without a point)
    ");
}

#[test]
fn a_syntax_error_is_located() {
    insta::assert_snapshot!(refusal("(\n    name: \"x\"\n    modules: [],\n)"), @r"
    robot.ron:3:5: a comma or a closing bracket is missing
      hint:    entries are separated by commas
    ");
    insta::assert_snapshot!(refusal("(\n    name: \"x\",\n    modules: [],\n"), @r"
    robot.ron:3:17: the file ends too early
      hint:    look for a bracket that is never closed
    ");
    insta::assert_snapshot!(refusal("(name: \"x, modules: [])"), @r"
    robot.ron:1:8: name: the text never ends
      hint:    close it with a double quote
    ");
    insta::assert_snapshot!(refusal("(name: \"x\", modules: []))"), @r"
    robot.ron:1:25: something follows the last closing bracket
      hint:    remove it, or look for a superfluous bracket
    ");
    insta::assert_snapshot!(refusal("(name: \"x\", name: \"y\", modules: [])"), @r"
    robot.ron:1:13: name: the field is given twice
      hint:    remove one of the two
    ");
    insta::assert_snapshot!(refusal(""), @r"
    robot.ron: the file is empty
    ");
    insta::assert_snapshot!(refusal("hello world"), @r"
    robot.ron:1:1: fields must stand in plain brackets
      found:   hello
      allowed: ( field: value, ... )
    ");
}

#[test]
fn sizes_and_masses_must_be_those_of_a_real_module() {
    insta::assert_snapshot!(refusal(&alone("Passive(side_m: 0, mass_kg: 1)")), @r"
    robot.ron:3:49: modules[0].kind.side_m: out of range
      found:   0 m
      allowed: 0.001 m to 10 m
    ");
    insta::assert_snapshot!(refusal(&alone("Passive(side_m: -0.1, mass_kg: 1)")), @r"
    robot.ron:3:49: modules[0].kind.side_m: out of range
      found:   -0.1 m
      allowed: 0.001 m to 10 m
    ");
    insta::assert_snapshot!(refusal(&alone("Passive(side_m: 60, mass_kg: 1)")), @r"
    robot.ron:3:49: modules[0].kind.side_m: out of range
      found:   60 m
      allowed: 0.001 m to 10 m
    ");
    insta::assert_snapshot!(refusal(&alone("Passive(side_m: NaN, mass_kg: 1)")), @r"
    robot.ron:3:49: modules[0].kind.side_m: not a number that can be used
      found:   NaN m
      allowed: 0.001 m to 10 m
    ");
    insta::assert_snapshot!(refusal(&alone("Passive(side_m: 0.1, mass_kg: inf)")), @r"
    robot.ron:3:63: modules[0].kind.mass_kg: not a number that can be used
      found:   inf kg
      allowed: 1e-6 kg to 1000 kg
    ");
    insta::assert_snapshot!(refusal(&alone("Passive(side_m: 0.1, mass_kg: 1e300)")), @r"
    robot.ron:3:63: modules[0].kind.mass_kg: out of range
      found:   1e300 kg
      allowed: 1e-6 kg to 1000 kg
    ");
    insta::assert_snapshot!(refusal(&alone("Passive(side_m: 0.1, mass_kg: 0)")), @r"
    robot.ron:3:63: modules[0].kind.mass_kg: out of range
      found:   0 kg
      allowed: 1e-6 kg to 1000 kg
    ");
    insta::assert_snapshot!(
        refusal(&alone("Passive(side_m: 0.1, mass_kg: 1, inertia_kg_m2: (1, 1, 3))")), @r"
    robot.ron:3:81: modules[0].kind.inertia_kg_m2: these moments of inertia are physically impossible
      found:   3 kg m^2, but the two others sum to 2
      allowed: no moment larger than the sum of the two others
    ");
    insta::assert_snapshot!(
        refusal(&alone("Passive(side_m: 0.1, mass_kg: 1, inertia_kg_m2: (1, 0, 1))")), @r"
    robot.ron:3:85: modules[0].kind.inertia_kg_m2[1]: out of range
      found:   0 kg m^2
      allowed: more than 0 kg m^2, at most 100000 kg m^2
    ");
    insta::assert_snapshot!(
        refusal(&alone("Passive(side_m: 0.1, mass_kg: 1, centre_of_mass_m: (0, 0, 0.06))")), @r"
    robot.ron:3:91: modules[0].kind.centre_of_mass_m[2]: the centre of mass must lie inside the module
      found:   0.06 m
      allowed: between -0.05 m and 0.05 m
    ");
    insta::assert_snapshot!(
        refusal(&active("axis: Normal(plate: (side_m: 0.1, thickness_m: 0, mass_kg: 0.1))")
            .replace("0.1))", &format!("0.1)), {SERVO}"))), @r"
    robot.ron:4:56: modules[0].kind.axis.plate.thickness_m: out of range
      found:   0 m
      allowed: more than 0 m, at most 10 m
    ");
}

#[test]
fn servo_and_gait_must_be_in_range() {
    let with = |rest: &str| refusal(&active(&format!("{PLATE}, {rest}")));
    insta::assert_snapshot!(with("servo: (law: Velocity(gain_1_s: 0), max_torque_nm: 1)"), @r"
    robot.ron:4:110: modules[0].kind.servo.law.gain_1_s: out of range
      found:   0 1/s
      allowed: more than 0 1/s, at most 100000 1/s
    ");
    insta::assert_snapshot!(
        with("servo: (law: Torque(stiffness_nm_rad: 5, damping_nm_s_rad: -1), max_torque_nm: 1)"), @r"
    robot.ron:4:137: modules[0].kind.servo.law.damping_nm_s_rad: out of range
      found:   -1 N m s/rad
      allowed: 0 N m s/rad to 1000000 N m s/rad
    ");
    insta::assert_snapshot!(with("servo: (law: Velocity(gain_1_s: 30), max_torque_nm: 1e9)"), @r"
    robot.ron:4:130: modules[0].kind.servo.max_torque_nm: out of range
      found:   1e9 N m
      allowed: more than 0 N m, at most 10000 N m
    ");
    insta::assert_snapshot!(
        with("servo: (law: Velocity(gain_1_s: 30), max_torque_nm: 1, max_speed_rad_s: 0)"), @r"
    robot.ron:4:150: modules[0].kind.servo.max_speed_rad_s: out of range
      found:   0 rad/s
      allowed: more than 0 rad/s, at most 10000 rad/s
      hint:    leave it out for a servo without a speed limit
    ");
    insta::assert_snapshot!(
        with(&format!("{SERVO}, gait: (amplitude_rad: 1, frequency_hz: 1000)")), @r"
    robot.ron:4:173: modules[0].kind.gait.frequency_hz: out of range
      found:   1000 Hz
      allowed: 0 Hz to 100 Hz
    ");
    insta::assert_snapshot!(
        with(&format!("{SERVO}, gait: (amplitude_rad: NaN, frequency_hz: 1)")), @r"
    robot.ron:4:156: modules[0].kind.gait.amplitude_rad: not a number that can be used
      found:   NaN rad
      allowed: -1000 rad to 1000 rad
    ");
}

#[test]
fn a_servo_must_move_something() {
    insta::assert_snapshot!(refusal(&active(&format!("axis: Tangent(axis: PosX), {SERVO}"))), @r"
    robot.ron:4:29: modules[0].kind.axis.axis: a bending axis must be at right angles to the driven face PosX
      found:   PosX
      allowed: PosY, NegY, PosZ, NegZ
      hint:    use `axis: Normal(...)` for a face that spins about its own normal
    ");
    insta::assert_snapshot!(refusal(&active(&format!("axis: Tangent(axis: PosY), {SERVO}"))), @r"
    robot.ron:4:15: modules[0].kind.axis: the servo of `a` moves nothing
      found:   no plate and no module on its driven face PosX
      hint:    attach a module to that face, or make it Passive
    ");
    insta::assert_snapshot!(refusal(&active(&format!("axis: Normal(), {SERVO}"))), @r"
    robot.ron:4:15: modules[0].kind.axis: the servo of `a` moves nothing
      found:   no plate and no module on its driven face PosX
      hint:    add a plate, attach a module to that face, or make it Passive
    ");
}

#[test]
fn two_driven_faces_on_each_other_are_refused() {
    let driver = |name: &str| {
        format!(
            "(name: \"{name}\", kind: Active(side_m: 0.1, mass_kg: 1, face: PosX, {PLATE}, {SERVO}))"
        )
    };
    let text = format!(
        "(name: \"kiss\", modules: [\n{},\n{}],\nglue: [(parent: \"a\", face: PosX, child: \"b\", child_face: PosX)])",
        driver("a"),
        driver("b")
    );
    insta::assert_snapshot!(refusal(&text), @r"
    robot.ron:4:8: glue[0]: two driven faces are attached to each other
      found:   face PosX of `b` on face PosX of `a`
      hint:    two servos would drive one attachment: put a passive module between them
    ");
}

#[test]
fn names_must_be_unique_and_of_allowed_characters() {
    insta::assert_snapshot!(refusal(&cubes("").replace("\"b\"", "\"a\"")), @r"
    robot.ron:5:16: modules[1].name: two modules have the same name
      found:   `a` is also modules[0]
      allowed: a unique name for every module
    ");
    insta::assert_snapshot!(refusal(&cubes("").replace("\"b\"", "\"\"")), @r#"
    robot.ron:5:16: modules[1].name: not a usable name for a module
      found:   "" (0 characters)
      allowed: 1 to 64 letters a-z and A-Z, digits, `_` and `-` (not in front)
    "#);
    insta::assert_snapshot!(refusal(&cubes("").replace("\"b\"", "\"leg a\"")), @r#"
    robot.ron:5:16: modules[1].name: not a usable name for a module
      found:   "leg a" (5 characters)
      allowed: 1 to 64 letters a-z and A-Z, digits, `_` and `-` (not in front)
    "#);
    insta::assert_snapshot!(refusal(&cubes("").replace("\"cubes\"", "\"../cubes\"")), @r#"
    robot.ron:2:11: name: not a usable name for a robot
      found:   "../cubes" (8 characters)
      allowed: 1 to 64 letters a-z and A-Z, digits, `_` and `-` (not in front)
    "#);
}

#[test]
fn attachments_must_name_modules() {
    insta::assert_snapshot!(refusal(&cubes("(parent: \"a\", face: PosX, child: \"d\")")), @r#"
    robot.ron:8:45: glue[0].child: unknown module
      found:   d
      allowed: a, b, c
    "#);
    insta::assert_snapshot!(
        refusal(&cubes("(parent: \"a\", face: PosX, child: \"a\")")), @r"
    robot.ron:8:45: glue[0].child: `a` is attached to itself
    ");
    insta::assert_snapshot!(
        refusal(&cubes("(parent: \"a\", face: PosX, child: \"b\", quarter_turns: 4)")), @r"
    robot.ron:8:65: glue[0].quarter_turns: out of range
      found:   4
      allowed: 0, 1, 2, 3
    ");
    insta::assert_snapshot!(
        refusal(&cubes("(parent: \"a\", face: PosX, child: \"b\", quarter_turns: -1)")), @r"
    robot.ron:8:65: glue[0].quarter_turns: out of range
      found:   -1
      allowed: 0, 1, 2, 3
    ");
    insta::assert_snapshot!(
        refusal(&cubes("(parent: \"a\", face: PosX, child: \"b\"), (parent: \"b\", face: PosX, child: \"c\")")
            .replace("\n)", "\n    track: \"core\",\n)")), @r#"
    robot.ron:9:12: track: unknown module
      found:   core
      allowed: a, b, c
    "#);
}

#[test]
fn attachments_must_form_one_tree() {
    insta::assert_snapshot!(refusal(&cubes("")), @r"
    robot.ron:5:16: modules[1].name: the modules are not all connected
      found:   3 modules without a parent: `a`, `b`, `c`
      allowed: exactly one, the root
      hint:    attach `b` to a neighbour, or remove it
    ");
    insta::assert_snapshot!(refusal(&cubes("(parent: \"a\", face: PosX, child: \"b\")")), @r"
    robot.ron:6:16: modules[2].name: the modules are not all connected
      found:   2 modules without a parent: `a`, `c`
      allowed: exactly one, the root
      hint:    attach `c` to a neighbour, or remove it
    ");
    insta::assert_snapshot!(refusal(&cubes(
        "
        (parent: \"a\", face: PosX, child: \"b\"),
        (parent: \"b\", face: PosX, child: \"c\"),
        (parent: \"c\", face: PosX, child: \"a\"),
    "
    )), @r"
    robot.ron:9:9: glue[0]: the attachments form a cycle
      found:   `a` > `b` > `c` > `a`
      allowed: a tree: one root, and every other module a child of one parent
      hint:    remove one attachment of the cycle; modules that touch need no attachment
    ");
    insta::assert_snapshot!(refusal(&cubes(
        "
        (parent: \"b\", face: PosX, child: \"c\"),
        (parent: \"c\", face: PosX, child: \"b\"),
    "
    )), @r"
    robot.ron:9:9: glue[0]: the attachments form a cycle
      found:   `b` > `c` > `b`
      allowed: a tree: one root, and every other module a child of one parent
      hint:    remove one attachment of the cycle; modules that touch need no attachment
    ");
    insta::assert_snapshot!(refusal(&cubes(
        "
        (parent: \"a\", face: PosX, child: \"b\"),
        (parent: \"a\", face: PosY, child: \"c\"),
        (parent: \"b\", face: PosY, child: \"c\"),
    "
    )), @r"
    robot.ron:11:42: glue[2].child: `c` is attached twice as a child
      found:   to `a` and to `b`
      allowed: every module is a child at most once
      hint:    the robot is a tree: remove one of the two attachments; modules that touch need no attachment
    ");
}

#[test]
fn a_face_holds_one_module() {
    insta::assert_snapshot!(refusal(&cubes(
        "
        (parent: \"a\", face: PosX, child: \"b\"),
        (parent: \"a\", face: PosX, child: \"c\"),
    "
    )), @r"
    robot.ron:10:29: glue[1].face: two modules are attached to face PosX of `a`
      found:   `b` and `c`
      allowed: one module on a face
    ");
    insta::assert_snapshot!(refusal(&cubes(
        "
        (parent: \"a\", face: PosX, child: \"b\"),
        (parent: \"b\", face: NegX, child: \"c\"),
    "
    )), @r"
    robot.ron:10:29: glue[1].face: two modules are attached to face NegX of `b`
      found:   `a` and `c`
      allowed: one module on a face
    ");
}

#[test]
fn boxes_must_not_be_in_the_same_place() {
    let glue = "
        (parent: \"a\", face: PosX, child: \"b\"),
        (parent: \"b\", face: PosY, child: \"c\"),
        (parent: \"c\", face: NegX, child: \"d\"),
        (parent: \"a\", face: PosY, child: \"e\"),
    ";
    let text = cubes(glue).replace(
        "\n    ],\n    glue",
        "\n        (name: \"d\", kind: Passive(side_m: 0.1, mass_kg: 1)),
        (name: \"e\", kind: Passive(side_m: 0.1, mass_kg: 1)),\n    ],\n    glue",
    );
    insta::assert_snapshot!(refusal(&text), @r"
    robot.ron:13:9: glue[2]: `e` and `d` are in the same place
      found:   `d` centred at (0.0000, 0.1000, 0.0000) m in the frame of the root
      allowed: boxes that touch or are separate when all servos are at 0 rad
    ");
    let text = format!(
        "(name: \"spike\", modules: [
    (name: \"a\", kind: Passive(side_m: 0.1, mass_kg: 1)),
    (name: \"b\", kind: Passive(side_m: 0.1, mass_kg: 1)),
    (name: \"c\", kind: Active(side_m: 0.1, mass_kg: 1, face: NegX, {PLATE}, {SERVO})),
    (name: \"d\", kind: Passive(side_m: 0.1, mass_kg: 1)),
], glue: [
    (parent: \"a\", face: PosX, child: \"b\"),
    (parent: \"b\", face: PosY, child: \"c\"),
    (parent: \"a\", face: PosY, child: \"d\"),
])"
    );
    insta::assert_snapshot!(refusal(&text), @r"
    robot.ron:4:5: modules[2]: `d` and the face plate of `c` are in the same place
      found:   the face plate of `c` centred at (0.0450, 0.1000, 0.0000) m in the frame of the root
      allowed: boxes that touch or are separate when all servos are at 0 rad
    ");
}

#[test]
fn more_modules_than_the_limit_are_refused() {
    let modules: String = (0..201)
        .map(|i| format!("(name: \"m{i}\", kind: Passive(side_m: 0.1, mass_kg: 1)),\n"))
        .collect();
    insta::assert_snapshot!(refusal(&format!("(name: \"long\", modules: [{modules}])")), @r"
    robot.ron:1:25: modules: too many modules
      found:   201
      allowed: 1 to 200
    ");
    insta::assert_snapshot!(refusal("(name: \"none\", modules: [])"), @r"
    robot.ron:1:25: modules: a robot without modules
      found:   0
      allowed: 1 to 200
    ");
}
