//! What a study may change about a robot, relative to its morphology.

use nalgebra::Vector3;

use realgap_robot::morphology::{Assembly, Role};

/// What a study may change about the robot, relative to its morphology.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Adjustment {
    /// Factor on every mass (inertia follows).
    pub mass_scale: f64,
    /// Further factor on every inertia.
    pub inertia_scale: f64,
    /// Shift of every cube's centre of mass in the module's own frame, metres.
    pub centre_of_mass_offset_m: Vector3<f64>,
    /// Radius of every cube's edges and corners, metres; 0 for sharp ones.
    pub edge_radius_m: f64,
    /// Factor on every gait frequency.
    pub frequency_scale: f64,
    /// Factor on every gait amplitude.
    pub amplitude_scale: f64,
    /// Shift of the boxes of every driven body of the scene, in the body's own frame, metres.
    pub pusher_offset_m: Vector3<f64>,
    /// Friction between robot and every driven body of the scene, in place of the scene's.
    pub pusher_friction: Option<f64>,
}

impl Default for Adjustment {
    fn default() -> Self {
        Self {
            mass_scale: 1.0,
            inertia_scale: 1.0,
            centre_of_mass_offset_m: Vector3::zeros(),
            edge_radius_m: 0.0,
            frequency_scale: 1.0,
            amplitude_scale: 1.0,
            pusher_offset_m: Vector3::zeros(),
            pusher_friction: None,
        }
    }
}

impl Adjustment {
    /// The robot with these changes.
    pub(super) fn apply(&self, robot: &Assembly) -> Assembly {
        let mut robot = robot.clone();
        for solid in robot.parts.iter_mut().flat_map(|part| &mut part.solids) {
            solid.mass_kg *= self.mass_scale;
            solid.inertia_kg_m2 *= self.mass_scale * self.inertia_scale;
            if solid.role == Role::Cube {
                solid.centre_of_mass_solid_m += self.centre_of_mass_offset_m;
            }
        }
        for hinge in &mut robot.hinges {
            let Some(actuator) = &mut hinge.actuator else {
                continue;
            };
            actuator.gait.frequency_hz *= self.frequency_scale;
            actuator.gait.amplitude_rad *= self.amplitude_scale;
        }
        robot
    }
}

/// What a study may change about one joint and its servo beside what the robot's file states of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HingeAdjustment {
    /// Factor on how strongly the servo answers an angle error: the gain of the velocity law, the stiffness of
    /// the torque law.
    pub gain_scale: f64,
    /// Age of the command that the servo acts on, beside that of the robot's file, seconds.
    pub latency_s: f64,
    /// Play between servo and joint, from end to end, radians: within it the servo exerts no torque, beyond it
    /// the servo sees only the error that is left.
    pub backlash_rad: f64,
    /// What the servo adds to the angles that it is told, radians.
    pub offset_rad: f64,
    /// What the joint's encoder reads where the angle is 0, radians. Servo, recorded start and recorded samples go by the encoder.
    pub zero_rad: f64,
}

impl Default for HingeAdjustment {
    fn default() -> Self {
        Self {
            gain_scale: 1.0,
            latency_s: 0.0,
            backlash_rad: 0.0,
            offset_rad: 0.0,
            zero_rad: 0.0,
        }
    }
}

/// What a study may change about one module.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModuleAdjustment {
    /// Factor on its mass; inertia follows.
    pub mass_scale: f64,
    /// Further factors on its inertia about x, y and z of its own frame.
    pub inertia_scale: Vector3<f64>,
    /// Shift of its centre of mass in its own frame, metres.
    pub centre_of_mass_offset_m: Vector3<f64>,
}

impl Default for ModuleAdjustment {
    fn default() -> Self {
        Self {
            mass_scale: 1.0,
            inertia_scale: Vector3::repeat(1.0),
            centre_of_mass_offset_m: Vector3::zeros(),
        }
    }
}

impl ModuleAdjustment {
    /// Changes the module of this name, if the robot has it. Its plate is left alone.
    pub(super) fn apply(&self, name: &str, robot: &mut Assembly) {
        let Some(module) = robot.module_names.iter().position(|known| known == name) else {
            return;
        };
        // Moments along x, y, z times these leave the moments of the other axes alone; products follow their mean.
        let root = self.inertia_scale.map(f64::sqrt);
        let solids = robot.parts.iter_mut().flat_map(|part| &mut part.solids);
        for solid in solids.filter(|s| s.module == module && s.role == Role::Cube) {
            solid.mass_kg *= self.mass_scale;
            for row in 0..3 {
                for column in 0..3 {
                    solid.inertia_kg_m2[(row, column)] *=
                        self.mass_scale * root[row] * root[column];
                }
            }
            solid.centre_of_mass_solid_m += self.centre_of_mass_offset_m;
        }
    }
}
