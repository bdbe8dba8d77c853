//! What MuJoCo says of a model: joints, actuators, keyframes and fields.

use std::collections::BTreeMap;
use std::process::Command;

use realgap::calibration::commanded;
use realgap::simulation::Quantity;
use realgap::trajectory::Recording;
use serde::Deserialize;

use super::super::super::kit::*;

/// A model, as the Python package describes it.
#[derive(Debug, Deserialize)]
pub(super) struct Model {
    pub version: String,
    pub timestep_s: f64,
    pub joints: Vec<Joint>,
    pub keyframes: Vec<String>,
    pub free_joints: usize,
    pub bodies: Vec<String>,
    pub mass_kg: f64,
    pub body_length_m: Option<f64>,
    pub unnamed_touching_geoms: usize,
    pub fields: BTreeMap<String, Field>,
}

/// A joint that turns or slides.
#[derive(Debug, Deserialize)]
pub(super) struct Joint {
    pub name: String,
    pub turns: bool,
    pub actuator: Option<String>,
    /// What its actuator takes: a position, a velocity, or the torque of a motor.
    pub drive: Option<String>,
    /// The largest torque of the actuator, N m.
    pub limit: Option<f64>,
    /// Torque per angle and per speed of an actuator that follows positions, at the joint, N m/rad and N m s/rad.
    pub gains: Option<(f64, f64)>,
    /// Inertia of all that the joint carries, about its axis, where the model starts, without the joint's own armature, kg m² (of a slide
    /// its mass, kg).
    pub inertia_kg_m2: f64,
}

/// A number of the model.
#[derive(Debug, Deserialize)]
pub(super) struct Field {
    pub value: f64,
}

/// Recorded commands: of each joint, the quantities.
pub(super) type Commanded = BTreeMap<String, Vec<Quantity>>;

/// Whether commands of these quantities are angles or speeds, which a motor follows only with gains.
pub(super) fn follows_motion(quantities: &[Quantity]) -> bool {
    quantities.contains(&Quantity::Position) || quantities.contains(&Quantity::Velocity)
}

impl Model {
    /// Asks MuJoCo.
    ///
    /// # Errors
    /// A Python without the packages; a model that MuJoCo does not load.
    pub fn ask(python: &str, file: &Path) -> Result<Self> {
        let done = Command::new(python)
            .args(["-m", "realgap.mujoco"])
            .arg(file)
            .arg("--describe")
            .output();
        let remedy = "pip install realgap mujoco, or name a Python that has them: --python PYTHON";
        let done = done.map_err(|e| {
            Error::usage(format!("{python} cannot be started: {e}"))
                .field("--python")
                .hint(remedy)
        })?;
        if !done.status.success() {
            let said = String::from_utf8_lossy(&done.stderr);
            let last = said.lines().rfind(|line| !line.trim().is_empty());
            let last = last.unwrap_or("no message").trim().to_owned();
            let lacks = last.contains("No module named") || last.contains("is not installed");
            let error = Error::invalid("MuJoCo did not load the model")
                .at_file(file)
                .found(last);
            return Err(match lacks {
                true => error.hint(remedy),
                false => error.hint(format!(
                    "{python} -m realgap.mujoco {} --list says more",
                    file.display()
                )),
            });
        }
        serde_json::from_slice(&done.stdout).map_err(|e| {
            Error::invalid(format!("what MuJoCo says of the model cannot be read: {e}"))
                .at_file(file)
                .hint("the Python package and this program must be of one version")
        })
    }

    /// The joint with this name, or with an actuator of this name.
    pub fn joint(&self, name: &str) -> Option<&Joint> {
        let mut joints = self.joints.iter();
        let by_actuator = || {
            let mut joints = self.joints.iter();
            joints.find(|joint| joint.actuator.as_deref() == Some(name))
        };
        joints.find(|joint| joint.name == name).or_else(by_actuator)
    }

    /// The joints that the recordings command.
    ///
    /// # Errors
    /// A command of a joint without actuator, or of one that the model does not have.
    pub fn commands(&self, recordings: &[Recording]) -> Result<Commanded> {
        let mut all = Commanded::new();
        for recording in recordings {
            let motion = &recording.trajectory;
            let signals = motion.signals().iter().map(|signal| signal.name.as_str());
            let joints = motion.joints().iter();
            // A column NAME_command_rad is read as the angle of a joint NAME_command.
            let angles: Vec<String> = joints.map(|joint| format!("{}_rad", joint.name)).collect();
            for column in signals.chain(angles.iter().map(String::as_str)) {
                let Some((name, quantity)) = commanded(column) else {
                    continue;
                };
                if matches!(quantity, Quantity::Current | Quantity::Duty) {
                    return Err(Error::usage("a model of MuJoCo gets no currents and no duties")
                        .at_file(&recording.path)
                        .field(column)
                        .allowed("NAME_command_rad, NAME_command_rad_s or NAME_command_nm")
                        .hint("turn it into a torque, or leave it out: --reading FILE with `names`"));
                }
                let joint = self.joint(name).filter(|joint| joint.actuator.is_some());
                let joint = joint.ok_or_else(|| {
                    let driven = self.joints.iter().filter(|joint| joint.actuator.is_some());
                    let driven: Vec<&str> = driven.map(|joint| joint.name.as_str()).collect();
                    Error::usage("a recorded command has no actuator in the model")
                        .at_file(&recording.path)
                        .field(column)
                        .allowed(format!("joints with an actuator: {}", driven.join(", ")))
                        .hint("rename the column (--reading FILE, `names`), or give the joint an actuator")
                })?;
                let known = all.entry(joint.name.clone()).or_default();
                if !known.contains(&quantity) {
                    known.push(quantity);
                }
            }
        }
        Ok(all)
    }

    /// Refuses commanded angles of motors without gains, and gains where no motor gets angles.
    ///
    /// # Errors
    /// Both.
    pub fn check_gains(&self, commanded: &Commanded, has_gains: bool, file: &Path) -> Result<()> {
        let needs = |joint: &&Joint| {
            let quantities = commanded.get(&joint.name);
            let follows = quantities.is_some_and(|q| follows_motion(q));
            follows && joint.drive.as_deref() == Some("motor")
        };
        let motors: Vec<&str> = self
            .joints
            .iter()
            .filter(needs)
            .map(|joint| joint.name.as_str())
            .collect();
        match (motors.is_empty(), has_gains) {
            (false, false) => Err(Error::usage(
                "the model's motors take torques, and the recordings hold commanded angles",
            )
            .at_file(file)
            .found(format!("{} without gains: {}", counted(motors.len(), "motor"), motors.join(", ")))
            .allowed("--pd KP,KD: the gains with which the firmware turns angles into torques, N m/rad and N m s/rad")
            .hint("e.g. --pd 20,1.5; they stand in the robot's controller or driver")),
            (true, true) => Err(Error::usage("no motor of the model gets commanded angles, so that gains change nothing")
                .field("--pd")
                .hint("leave it out: <position> actuators have their own kp, which is a field of the model")),
            _ => Ok(()),
        }
    }

    /// The value of a field; `None` where the model does not have it.
    pub fn value(&self, field: &str) -> Option<f64> {
        self.fields.get(field).map(|field| field.value)
    }
}
