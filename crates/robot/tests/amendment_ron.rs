//! Changes of the RON file of a robot: only the numbers change.

use proptest::prelude::*;
use realgap_core::file::Source;
use realgap_robot::morphology::amendment::amend;
use realgap_robot::morphology::{Assembly, Morphology};

/// The tokens of a robot; those with `@` are numbers of the fit.
const ARM: &str = r##"( name : "arm" , description : r#"says: ( "dry_nm: 3" // not a comment
/*"# ,
bodies : [ ( name : "base" , mass_kg : 1 , shapes : [ ( form : Box ( sides_m : ( 0.1 , 0.1 , 0.1 ) ) ) , ] ) ,
( name : "rod" , mass_kg : @0.5 , centre_of_mass_m : Some ( ( 0 , 0 , @0.25 ) ) , inertia_kg_m2 : ( xx : 1e-2 , yy : 1e-2 , zz : @1e-3 ) ) ] ,
joints : [ ( name : "elbow" , parent : "base" , child : "rod" , kind : Turn ( axis : ( 0 , 1 , 0 ) , dry_nm : @0.1 , viscous_nm_s_rad : 0.01 , ) ) ] ,
actuators : [ ( joint : "elbow" , servo : ( law : Torque ( stiffness_nm_rad : @20.0 , damping_nm_s_rad : 1 ) , max_torque_nm : 3 ) ) ] , mount : ( ) , )"##;

/// What may stand between two tokens.
const BLANKS: [&str; 8] = [
    " ",
    "",
    "\n",
    "\n    ",
    "\t\r\n",
    " /* ( [ \" */ ",
    " // { a: 1,\n",
    "/* /* nested, */ \n ) */",
];

/// The text with these blanks between its tokens, and with numbers of the fit in place of its own.
fn text(blanks: &[usize], numbers: Option<&[&str; 5]>) -> String {
    let mut numbers = numbers.map(|all| all.iter());
    let raw = ARM.find("r#").unwrap()..ARM.find("\"#").unwrap() + 2;
    let ends = [&ARM[..raw.start], &ARM[raw.end..]];
    let [before, after] = ends.map(|part| {
        part.split_whitespace()
            .map(str::to_owned)
            .collect::<Vec<_>>()
    });
    let tokens = before.into_iter().chain([ARM[raw].to_owned()]).chain(after);
    let mut all = String::new();
    for (index, token) in tokens.enumerate() {
        let token = match (token.strip_prefix('@'), &mut numbers) {
            (Some(_), Some(numbers)) => (*numbers.next().unwrap()).to_owned(),
            (Some(own), None) => own.to_owned(),
            (None, _) => token,
        };
        all.push_str(&token);
        all.push_str(BLANKS[blanks[index % blanks.len()]]);
    }
    all
}

fn parse(text: &str) -> Morphology {
    Morphology::parse(&Source::new("arm.ron", text)).unwrap()
}

/// The text after changes, without the comments that they have put into it.
fn amended(text: &str, to: &Assembly) -> String {
    let robot = parse(text);
    let changes = robot
        .changes(to)
        .into_iter()
        .map(|change| (change, "realgap: x = 1".to_owned()));
    let changes: Vec<_> = changes.collect();
    let source = Source::new("arm.ron", text);
    let amended = amend(&source, &changes).unwrap();
    assert!(
        amended.outcomes.iter().all(Result::is_ok),
        "{:?}",
        amended.outcomes
    );
    let lines = amended.text.split_inclusive('\n');
    let is_own = |line: &str| line.trim() == "// realgap: x = 1";
    assert!(lines.clone().any(is_own), "{}", amended.text);
    lines.filter(|line| !is_own(line)).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn every_byte_but_those_of_fitted_numbers_stays(blanks in prop::collection::vec(0..BLANKS.len(), 40..90)) {
        let new = ["0.625", "0.28125", "0.0015", "0.21", "31.5"];
        let expected = text(&blanks, Some(&new));
        prop_assert_eq!(amended(&text(&blanks, None), &parse(&expected).assemble()), expected);
    }

    #[test]
    fn numbers_of_defaults_appear_and_nothing_else(blanks in prop::collection::vec(0..BLANKS.len(), 40..90)) {
        let own = text(&blanks, None);
        let mut to = parse(&own).assemble();
        to.hinges[0].bearing.armature_kg_m2 = 0.03;
        let actuator = to.hinges[0].actuator.as_mut().unwrap();
        actuator.servo.delay_s = 0.02;
        (actuator.command.lag_s, actuator.command.dead_zone) = (0.05, 0.125);
        to.surroundings.gravity_m_s2 = Some(9.5);
        let mut changed = amended(&own, &to);
        prop_assert_eq!(&parse(&changed).assemble(), &to);
        let added = [
            "armature_kg_m2: 0.03", "delay_s: 0.02", "command: (dead_zone: 0.125, lag_s: 0.05)", "world: (gravity_m_s2: 9.5)",
        ];
        for part in added {
            prop_assert_eq!(changed.matches(part).count(), 1, "{}: {}", part, &changed);
            changed = changed.replace(part, "");
        }
        let plain = |text: &str| text.replace(|c: char| c.is_whitespace() || c == ',', "");
        prop_assert_eq!(plain(&changed), plain(&own));
    }
}

#[test]
fn what_modules_have_from_defaults_changes_there_only_where_all_of_them_agree() {
    let own = r#"(
    name: "pair",
    defaults: (side_m: 0.06, mass_kg: 0.05, servo: (law: Velocity(gain_per_s: 30.0), max_torque_nm: 0.2)), // of the drawing
    modules: [
        (name: "a", kind: Active(face: NegX, axis: Normal(plate: (side_m: 0.06, thickness_m: 0.006, mass_kg: 0.012)))),
        (name: "b", kind: Active(
            face: NegZ,
            axis: Normal(plate: (side_m: 0.06, thickness_m: 0.006, mass_kg: 0.012)),
        )),
    ],
    glue: [(parent: "a", face: PosX, child: "b")],
)
"#;
    let mut to = parse(own).assemble();
    for (hinge, torque_nm) in to.hinges.iter_mut().zip([0.2, 0.3]) {
        let servo = &mut hinge.actuator.as_mut().unwrap().servo;
        servo.law.scale_gain(1.5);
        servo.max_torque_nm = torque_nm;
    }
    let changed = amended(own, &to);
    assert_eq!(parse(&changed).assemble(), to);
    let expected = own.replace("gain_per_s: 30.0", "gain_per_s: 45").replace(
        "mass_kg: 0.012)),\n",
        "mass_kg: 0.012)),\n            servo: (law: Velocity(gain_per_s: 45), max_torque_nm: 0.3),\n",
    );
    assert_eq!(changed, expected);
}
