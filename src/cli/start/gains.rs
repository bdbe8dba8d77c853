//! The gains with which a robot's firmware turns commanded angles into torques (`--pd`).

use std::collections::BTreeMap;
use std::str::FromStr;

use glob::Pattern;
use realgap::robot::import::PositionGains;
use realgap::robot::morphology::{Hinge, ServoLaw};

use super::super::kit::*;

/// The gains of the joints whose names match a pattern.
#[derive(Debug, Clone)]
pub struct Gains {
    joints: Pattern,
    gains: PositionGains,
}

/// The largest gains, N m/rad and N m s/rad.
const MOST: f64 = 1e6;
const FORM: &str = "allowed: KP,KD or JOINT=KP,KD (N m/rad, N m s/rad; * for any letters), e.g. 20,1.5 or '*_calf_joint=30,2'";

impl FromStr for Gains {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let (joints, numbers) = text.rsplit_once('=').unwrap_or(("*", text));
        let (kp, kd) = numbers.split_once(',').ok_or(FORM)?;
        let number = |text: &str| {
            let value: f64 = text.trim().parse().map_err(|_| FORM.to_owned())?;
            match (0.0..=MOST).contains(&value) {
                true => Ok(value),
                false => Err(format!("a gain lies between 0 and {MOST}; {FORM}")),
            }
        };
        let gains = PositionGains {
            stiffness_nm_rad: number(kp)?,
            damping_nm_s_rad: number(kd)?,
        };
        if gains.stiffness_nm_rad == 0.0 {
            return Err(format!("KP is 0, so no command would act; {FORM}"));
        }
        let joints = Pattern::new(joints.trim()).map_err(|e| format!("{e}; {FORM}"))?;
        Ok(Self { joints, gains })
    }
}

impl Gains {
    /// Both gains, where they are stated for every joint.
    pub fn of_every_joint(&self) -> Option<(f64, f64)> {
        let gains = (self.gains.stiffness_nm_rad, self.gains.damping_nm_s_rad);
        (self.joints.as_str() == "*").then_some(gains)
    }
}

/// The gains of every joint; of several that match, the last counts.
///
/// # Errors
/// Gains of joints that the robot does not have.
pub(super) fn by_joint(all: &[Gains], hinges: &[Hinge]) -> Result<BTreeMap<String, PositionGains>> {
    let mut of = BTreeMap::new();
    for one in all {
        let matching = hinges
            .iter()
            .filter(|hinge| one.joints.matches(&hinge.name));
        let matching: Vec<&Hinge> = matching.collect();
        if matching.is_empty() {
            let names: Vec<&str> = hinges.iter().map(|hinge| hinge.name.as_str()).collect();
            return Err(Error::usage("no joint of the robot has these gains")
                .field("pd")
                .found(one.joints.as_str())
                .allowed(names.join(", ")));
        }
        of.extend(
            matching
                .into_iter()
                .map(|hinge| (hinge.name.clone(), one.gains)),
        );
    }
    Ok(of)
}

/// The parameters that set the gains of servos of a robot in RON, as they stand in a study's `set`.
///
/// # Errors
/// Joints whose servo has another law than a spring with damping.
pub(super) fn values(of: &BTreeMap<String, PositionGains>, hinges: &[Hinge]) -> Result<String> {
    let mut values = Vec::new();
    for hinge in hinges {
        let Some(gains) = of.get(&hinge.name) else {
            continue;
        };
        let law = hinge.actuator.map(|actuator| actuator.servo.law);
        if !matches!(law, Some(ServoLaw::Torque { .. })) {
            return Err(Error::usage("this joint has no servo with gains")
                .field("pd")
                .found(format!("`{}` in the robot's file", hinge.name))
                .allowed("a servo with the law Torque(stiffness_nm_rad: KP, damping_nm_s_rad: KD)")
                .hint("write this law into the robot's file"));
        }
        let name = &hinge.name;
        values.push(format!(
            "\"servo.{name}.stiffness_nm_rad\": {:?}, \"servo.{name}.damping_nm_s_rad\": {:?}",
            gains.stiffness_nm_rad, gains.damping_nm_s_rad
        ));
    }
    Ok(values.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gains_are_read_with_and_without_a_joint_and_nonsense_is_refused() {
        let one: Gains = "20,1.5".parse().unwrap();
        assert!(one.joints.matches("any") && one.gains.stiffness_nm_rad == 20.0);
        let calf: Gains = "*_calf=30, 2".parse().unwrap();
        assert!(calf.joints.matches("FL_calf") && !calf.joints.matches("FL_hip"));
        for wrong in ["20", "20,", "-1,2", "1,-2", "0,1", "a,b", "1e9,1", "nan,1"] {
            let error = wrong.parse::<Gains>().unwrap_err();
            assert!(error.contains("KP,KD"), "{wrong}: {error}");
        }
    }
}
