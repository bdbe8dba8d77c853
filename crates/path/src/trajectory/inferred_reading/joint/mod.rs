//! Infers which columns of another program's log hold the angles, commands and speeds of a robot's joints, and their unit.

mod name;
mod unit;

use std::collections::BTreeMap;
use std::path::Path;

use super::super::joint_column::plain_name;
use super::super::reading::Reading;
use super::super::registry::{format_in, read_bytes};
use super::Evidence;
use name::{Column, Found, Quantity, SpeedUnit, Whose, columns, found, only_number};
use realgap_core::error::{Advice, Error, Result};
use realgap_core::unit::counted;
use unit::{Unit, unit};

/// A reading that names the columns of joints as this program does, with the evidence.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct JointReading {
    /// The given settings, completed by the names and the unit of the joints' columns.
    pub reading: Reading,
    /// The inferences, each with its reason.
    pub evidence: Vec<Evidence>,
}

impl JointReading {
    /// Infers the columns of the robot's `joints` in a log; `order` names the joints of numbered columns and of lists, in their order.
    /// `None` for a file that needs no inference, or that holds no columns of these joints.
    ///
    /// # Errors
    /// A file that cannot be read; numbered columns without an order; angles in a unit that the values do not show.
    pub fn infer(
        path: &Path,
        known: &Reading,
        joints: &[String],
        order: &[String],
    ) -> Result<Option<Self>> {
        if joints.is_empty() || !known.names.is_empty() || !known.lists.is_empty() {
            return Ok(None);
        }
        let bytes = read_bytes(path)?;
        let format = format_in(path, &bytes)?;
        if !format.is_table() {
            return Ok(None);
        }
        let text = format
            .decode(bytes, known)
            .map_err(|e| e.at_file(path))?
            .text;
        Self::of_text(&text, known, joints, order).map_err(|e| e.at_file(path))
    }

    /// Columns that are called as this program calls them, but for the signs in the joints' names that an import replaces.
    fn of_plain_names(columns: &[Column<'_>], known: &Reading, joints: &[String]) -> Option<Self> {
        let of_joint = |name: &str| {
            let mut joints = joints.iter();
            joints.any(|joint| {
                name.strip_prefix(joint.as_str())
                    .is_some_and(|rest| rest.starts_with('_'))
            })
        };
        let is_angle = |name: &str| {
            let mut joints = joints.iter();
            joints.any(|joint| {
                [format!("{joint}_rad"), format!("{joint}_deg")].contains(&name.to_owned())
            })
        };
        let renamed: Vec<(&str, String)> = columns
            .iter()
            .filter(|column| column.element.is_none())
            .map(|column| (column.name, plain_name(column.name)))
            .filter(|(theirs, ours)| theirs != ours && of_joint(ours))
            .collect();
        if !renamed.iter().any(|(_, ours)| is_angle(ours)) {
            return None;
        }
        let shown: Vec<String> = (renamed.iter().take(3))
            .map(|(theirs, ours)| format!("{ours} from `{theirs}`"))
            .collect();
        let mut made = Self {
            reading: known.clone(),
            evidence: vec![Evidence {
                finding: format!("{} columns of joints: {}", renamed.len(), shown.join(", ")),
                reason:
                    "the robot's joints have these names but for signs that names here do not have"
                        .to_owned(),
            }],
        };
        for (theirs, ours) in renamed {
            made.reading.names.insert(theirs.to_owned(), ours);
        }
        Some(made)
    }

    fn of_text(
        text: &str,
        known: &Reading,
        joints: &[String],
        order: &[String],
    ) -> Result<Option<Self>> {
        let columns = columns(text, known);
        let own = |name: &str| {
            let mut joints = joints.iter();
            joints.any(|joint| {
                [format!("{joint}_rad"), format!("{joint}_deg")].contains(&name.to_owned())
            })
        };
        if columns.iter().any(|column| own(column.name)) {
            return Ok(None);
        }
        if let Some(made) = Self::of_plain_names(&columns, known, joints) {
            return Ok(Some(made));
        }
        let found: Vec<Found<'_, '_>> = columns
            .iter()
            .filter_map(|column| found(column, joints))
            .collect();
        let has_angle = found.iter().any(|one| one.quantity == Quantity::Angle);
        if !has_angle {
            return Ok(commands_alone(&found, known, joints));
        }
        let order = order_of(&found, joints, order)?;
        let (unit, because) = unit(&found, known)?;
        let mut made = Self {
            reading: known.clone(),
            evidence: Vec::new(),
        };
        if let Unit::Ticks(ticks) = unit {
            made.reading.ticks = Some(ticks);
        }
        made.evidence.push(Evidence {
            finding: format!("angles of joints are in {}", unit.words()),
            reason: because,
        });
        let mut lists: BTreeMap<&str, Vec<String>> = BTreeMap::new();
        let mut said: BTreeMap<Quantity, Vec<String>> = BTreeMap::new();
        for one in &found {
            let joint = match one.joint {
                Whose::Named(index) => &joints[index],
                Whose::Numbered(number) => match order.get(&number) {
                    Some(joint) => joint,
                    None => continue,
                },
            };
            let name = match one.speed_unit {
                Some(speed) if one.quantity == Quantity::CommandedSpeed => {
                    Some(format!("{joint}{}", speed.command_ending()))
                }
                _ => unit.name(joint, one.quantity),
            };
            let Some(name) = name else {
                continue;
            };
            said.entry(one.quantity)
                .or_default()
                .push(format!("{joint} from `{}`", one.column.label()));
            match one.column.element {
                Some(_) => lists.entry(one.column.name).or_default().push(name),
                None => {
                    made.reading.names.insert(one.column.name.to_owned(), name);
                }
            }
        }
        for (column, names) in lists {
            made.reading.lists.insert(column.to_owned(), names);
        }
        for (quantity, all) in said {
            made.evidence.push(Evidence {
                finding: format!("{} of joints: {}", quantity.words(), all.join(", ")),
                reason: "the names of the columns".to_owned(),
            });
        }
        Ok(Some(made))
    }
}

/// Of the moves of a command from row to row, the share that is none where the command is a speed. A commanded angle that stays as
/// it is stops the wheel.
const STEADY: f64 = 0.5;

/// The reading of a log that holds commands of wheels and no angle of any joint: commanded speeds by their names, or because they
/// stay as they are while the robot moves. `None` where this cannot be told.
fn commands_alone(
    found: &[Found<'_, '_>],
    known: &Reading,
    joints: &[String],
) -> Option<JointReading> {
    let is_steady = |one: &Found<'_, '_>| {
        let values = &one.column.values;
        let pairs = values.windows(2).filter(|pair| pair[0] != 0.0);
        let stays = pairs.filter(|pair| pair[0] == pair[1]).count();
        stays as f64 > STEADY * values.len() as f64
    };
    let is_named = |one: &Found<'_, '_>| one.quantity == Quantity::CommandedSpeed;
    let commands: Vec<&Found<'_, '_>> = found
        .iter()
        .filter(|one| is_named(one) || one.quantity == Quantity::Command)
        .collect();
    let is_of_speeds = commands.iter().any(|one| is_named(one) || is_steady(one));
    if !is_of_speeds || known.angle.is_some() {
        return None;
    }
    let unit_of = |one: &Found<'_, '_>| one.speed_unit.unwrap_or(SpeedUnit::RadiansPerSecond);
    let units: Vec<SpeedUnit> = commands.iter().map(|one| unit_of(one)).collect();
    let unit = match units.split_first() {
        Some((first, rest)) if rest.iter().all(|unit| unit == first) => first.words(),
        _ => "each in its own unit",
    };
    let mut made = JointReading {
        reading: known.clone(),
        evidence: Vec::new(),
    };
    let mut said = Vec::new();
    for one in &commands {
        let Whose::Named(joint) = one.joint else {
            return None;
        };
        let name = format!("{}{}", joints[joint], unit_of(one).command_ending());
        if one.column.name != name {
            made.reading.names.insert(one.column.name.to_owned(), name);
            said.push(format!("{} from `{}`", joints[joint], one.column.label()));
        }
    }
    if said.is_empty() {
        return None;
    }
    made.evidence.push(Evidence {
        finding: format!("commanded speeds of joints, {unit}: {}", said.join(", ")),
        reason: match commands.iter().all(|one| is_named(one)) {
            true => "the names of the columns".to_owned(),
            false => "they stay as they are while the robot moves; a commanded angle that stays would stop the wheel".to_owned(),
        },
    });
    Some(made)
}

/// The joint of every number.
fn order_of(
    found: &[Found<'_, '_>],
    joints: &[String],
    order: &[String],
) -> Result<BTreeMap<usize, String>> {
    let of = |quantity: Quantity| {
        let numbers = found.iter().filter(move |one| one.quantity == quantity);
        let numbers = numbers.filter_map(|one| match one.joint {
            Whose::Numbered(number) => Some(number),
            Whose::Named(_) => None,
        });
        let mut numbers: Vec<usize> = numbers.collect();
        numbers.sort_unstable();
        numbers
    };
    let numbers = of(Quantity::Angle);
    let Some(first) = numbers.first().copied() else {
        return Ok(BTreeMap::new());
    };
    let by_digits: BTreeMap<usize, String> = joints
        .iter()
        .filter_map(|joint| Some((only_number(joint)?, joint.clone())))
        .collect();
    if order.is_empty() && numbers.iter().all(|number| by_digits.contains_key(number)) {
        return Ok(by_digits);
    }
    let labels: Vec<String> = found
        .iter()
        .filter(|one| one.quantity == Quantity::Angle && matches!(one.joint, Whose::Numbered(_)))
        .map(|one| one.column.label())
        .collect();
    let is_one_joint = numbers.len() == 1 && joints.len() == 1;
    if order.len() != numbers.len() && !is_one_joint {
        return Err(Error::usage("the recordings leave a question open")
            .found(format!(
                "{} without names: {}",
                counted(numbers.len(), "joint"),
                labels.join(", ")
            ))
            .allowed(format!(
                "the names of these joints in this order, of {}",
                joints.join(", ")
            ))
            .advise(Advice::JointOrder));
    }
    if let Some(strange) = order.iter().find(|name| !joints.contains(name)) {
        return Err(Error::usage("the robot has no joint of this name")
            .found(strange)
            .allowed(joints.join(", "))
            .advise(Advice::JointOrder));
    }
    let names = if is_one_joint { joints } else { order };
    Ok(numbers
        .iter()
        .map(|number| (*number, names[number - first].clone()))
        .collect())
}

#[cfg(test)]
mod tests {
    use super::super::super::reading::Ticks;
    use super::*;
    use realgap_core::unit::AngleUnit;

    const JOINTS: [&str; 2] = ["pan", "lift"];

    /// A log of two joints, whose columns are called so; angles in units of `size` radians from `zero`.
    fn log(header: &str, row: &dyn Fn([f64; 4]) -> String) -> String {
        let rows = (0..50).map(|k| {
            let t = 0.02 * f64::from(k);
            let q = [
                (3.0 * t).sin(),
                0.5 * (2.0 * t).cos(),
                (3.1 * t).sin(),
                0.5 * (2.1 * t).cos(),
            ];
            format!("{t},{}\n", row(q))
        });
        format!("{header}\n{}", rows.collect::<String>())
    }

    fn infer(text: &str, known: &Reading, order: &[&str]) -> Result<Option<JointReading>> {
        let own = |names: &[&str]| {
            names
                .iter()
                .map(|name| (*name).to_owned())
                .collect::<Vec<_>>()
        };
        JointReading::of_text(text, known, &own(&JOINTS), &own(order))
    }

    fn flat(scale: f64) -> impl Fn([f64; 4]) -> String {
        move |q| q.map(|q| format!("{:.6}", scale * q)).join(",")
    }

    #[test]
    fn names_of_other_programs_are_mapped_to_the_joints_with_their_quantity() {
        let degrees = 180.0 / std::f64::consts::PI;
        for (header, scale, expected) in [
            ("t,pan_pos,lift_pos,pan_cmd,lift_cmd", 1.0, "rad"),
            (
                "t,pan.pos,lift.pos,action.pan.pos,action.lift.pos",
                1.0,
                "rad",
            ),
            (
                "t,observation.state.pan,observation.state.lift,action.pan,action.lift",
                1.0,
                "rad",
            ),
            (
                "t,actual_pan,actual_lift,target_pan,target_lift",
                degrees,
                "deg",
            ),
            (
                "t,Pan_Position,Lift_Position,Pan_Goal_Position,Lift_Goal_Position",
                degrees,
                "deg",
            ),
            (
                "t,pan/position,lift/position,pan/setpoint,lift/setpoint",
                1.0,
                "rad",
            ),
        ] {
            let made = infer(&log(header, &flat(scale)), &Reading::default(), &[]).unwrap();
            let made = made.unwrap_or_else(|| panic!("{header}"));
            let names: Vec<&str> = header.split(',').skip(1).collect();
            let ours = ["pan_", "lift_", "pan_command_", "lift_command_"];
            for (theirs, ours) in names.iter().zip(ours) {
                let ours = format!("{ours}{expected}");
                assert_eq!(made.reading.names.get(*theirs), Some(&ours), "{header}");
            }
        }
    }

    #[test]
    fn commanded_speeds_of_wheels_keep_the_unit_that_their_names_state() {
        for (words, ending) in [
            ("rpm_cmd", "rpm"),
            ("cmd (rpm)", "rpm"),
            ("speed_cmd_deg_s", "deg_s"),
            ("cmd [deg/s]", "deg_s"),
            ("cmd_rad_s", "rad_s"),
            ("target velocity rad/s", "rad_s"),
        ] {
            let header = format!("t,x,pan {words},lift {words}");
            let made = infer(&log(&header, &flat(9.0)), &Reading::default(), &[]).unwrap();
            let names = made.unwrap_or_else(|| panic!("{header}")).reading.names;
            let expected = format!("pan_command_{ending}");
            assert_eq!(
                names.get(&format!("pan {words}")),
                Some(&expected),
                "{header}"
            );
        }
    }

    #[test]
    fn numbers_that_begin_at_0_are_not_taken_for_joints_that_are_counted_from_1() {
        let joints = ["joint_1".to_owned(), "joint_2".to_owned()];
        let text = log("t,actual_q_0,actual_q_1,target_q_0,target_q_1", &flat(1.0));
        let infer =
            |order: &[String]| JointReading::of_text(&text, &Reading::default(), &joints, order);
        let error = infer(&[]).unwrap_err().to_string();
        assert!(
            error.contains("2 joints without names: actual_q_0, actual_q_1"),
            "{error}"
        );
        let names = infer(&joints).unwrap().unwrap().reading.names;
        assert_eq!(names["actual_q_0"], "joint_1_rad");
        assert_eq!(names["target_q_1"], "joint_2_command_rad");
    }

    #[test]
    fn raw_speeds_of_servos_that_count_angles_are_not_read() {
        let counts =
            |q: [f64; 4]| format!("{},{}", 2048 + (600.0 * q[0]) as i32, (90.0 * q[1]) as i32);
        let text = log("time_ms,id1_present_position,id1_present_velocity", &counts);
        let joints = ["joint1".to_owned()];
        let made = JointReading::of_text(&text, &Reading::default(), &joints, &[]);
        let names = made.unwrap().unwrap().reading.names;
        assert_eq!(names["id1_present_position"], "joint1_ticks");
        assert!(!names.contains_key("id1_present_velocity"), "{names:?}");
    }

    #[test]
    fn the_only_joint_of_a_robot_needs_no_name() {
        let joints = ["knee".to_owned()];
        for (header, angle, command) in [
            (
                "t,Present Position (deg),x,Goal Position (deg),y",
                "knee_deg",
                "knee_command_deg",
            ),
            (
                "t,position,speed,goal_position,load",
                "knee_rad",
                "knee_command_rad",
            ),
            ("t,measured,x,setpoint,y", "knee_rad", "knee_command_rad"),
        ] {
            let scale = if angle.ends_with("deg") { 57.3 } else { 1.0 };
            let text = log(header, &flat(scale));
            let made = JointReading::of_text(&text, &Reading::default(), &joints, &[]);
            let names = made
                .unwrap()
                .unwrap_or_else(|| panic!("{header}"))
                .reading
                .names;
            let theirs: Vec<&str> = header.split(',').collect();
            assert_eq!(names[theirs[1]], angle, "{header}");
            assert_eq!(names[theirs[3]], command, "{header}");
        }
    }

    #[test]
    fn measured_torques_and_commanded_currents_are_found_beside_angles() {
        let header = "t,pan_pos,lift_pos,pan_tau,lift_cmd_current";
        let made = infer(&log(header, &flat(1.0)), &Reading::default(), &[]);
        let names = made.unwrap().unwrap().reading.names;
        assert_eq!(names["pan_tau"], "pan_torque_nm");
        assert_eq!(names["lift_cmd_current"], "lift_command_a");
    }

    #[test]
    fn numbered_joints_are_asked_about_and_lists_are_taken_apart_in_the_given_order() {
        let numbered = log("t,q1,q2,q_des1,q_des2", &flat(1.0));
        let error = infer(&numbered, &Reading::default(), &[])
            .unwrap_err()
            .to_string();
        assert!(error.contains("2 joints without names: q1, q2"), "{error}");
        let made = infer(&numbered, &Reading::default(), &["lift", "pan"])
            .unwrap()
            .unwrap();
        assert_eq!(made.reading.names["q1"], "lift_rad");
        assert_eq!(made.reading.names["q_des2"], "pan_command_rad");
        assert!(infer(&numbered, &Reading::default(), &["lift", "nose"]).is_err());
        let list = |q: [f64; 4]| format!("\"[{}, {}]\",\"[{}, {}]\"", q[0], q[1], q[2], q[3]);
        let lists = log("timestamp,observation.state,action", &list);
        let made = infer(&lists, &Reading::default(), &["pan", "lift"])
            .unwrap()
            .unwrap();
        assert_eq!(
            made.reading.lists["observation.state"],
            ["pan_rad", "lift_rad"]
        );
        assert_eq!(
            made.reading.lists["action"],
            ["pan_command_rad", "lift_command_rad"]
        );
    }

    #[test]
    fn counts_of_an_encoder_are_recognised_and_shares_of_a_range_are_asked_about() {
        let count = |q: [f64; 4]| {
            q.map(|q| format!("{:.0}", 2048.0 + q * 4096.0 / std::f64::consts::TAU))
                .join(",")
        };
        let counts = log(
            "t,pan_position,lift_position,pan_goal_position,lift_goal_position",
            &count,
        );
        let made = infer(&counts, &Reading::default(), &[]).unwrap().unwrap();
        assert_eq!(
            made.reading.ticks,
            Some(Ticks {
                per_turn: 4096.0,
                zero: 2048.0
            })
        );
        assert_eq!(made.reading.names["pan_position"], "pan_ticks");
        let header = "t,observation.pan.pos,observation.lift.pos,action.pan.pos,action.lift.pos";
        let shares = log(header, &flat(99.0));
        let error = infer(&shares, &Reading::default(), &[])
            .unwrap_err()
            .to_string();
        assert!(error.contains("-100 to 100"), "{error}");
        let degrees = Reading {
            angle: Some(AngleUnit::Degree),
            ..Reading::default()
        };
        let made = infer(&shares, &degrees, &[]).unwrap().unwrap();
        assert_eq!(made.reading.names["action.pan.pos"], "pan_command_deg");
    }

    #[test]
    fn a_log_in_own_names_and_a_table_without_joints_need_no_inference() {
        for header in [
            "t_s,pan_rad,lift_rad,pan_command_rad,lift_command_rad",
            "t_s,x_m,y_m,z_m,battery",
        ] {
            assert_eq!(
                infer(&log(header, &flat(1.0)), &Reading::default(), &[]).unwrap(),
                None
            );
        }
    }
}
