//! Adjustments: changes that a study makes to a robot, its joints and its modules, relative to the robot's file.

use nalgebra::{Isometry3, Vector3};

use super::inertia::InertiaChange;
use realgap_robot::morphology::{Assembly, Role};

/// Changes of the whole robot, relative to its morphology.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Adjustment {
    /// Factor on every mass (inertia follows).
    pub mass_scale: f64,
    /// Additional factor on every inertia.
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
    /// Shift of the tracked point along the axes of its own frame, metres: where the markers of a recording really are.
    pub track_offset_m: Vector3<f64>,
    /// Turn of the tracked frame about its own z axis, radians: the heading of the markers on a robot that looks along x.
    pub track_heading_rad: f64,
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
            track_offset_m: Vector3::zeros(),
            track_heading_rad: 0.0,
        }
    }
}

impl Adjustment {
    /// Returns the robot with these changes.
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
        if self.track_offset_m != Vector3::zeros() || self.track_heading_rad != 0.0 {
            let turn = Vector3::z() * self.track_heading_rad;
            robot.robot_from_track *= Isometry3::new(self.track_offset_m, turn);
        }
        robot
    }
}

/// Changes of one joint and its servo, relative to the robot's file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HingeAdjustment {
    /// Factor on the servo's reaction to an angle error: the gain of the velocity law, or the stiffness of the torque law.
    pub gain_scale: f64,
    /// Delay between a command and the servo's reaction, in addition to that of the robot's file, seconds.
    pub latency_s: f64,
    /// Backlash (play) between servo and joint, from end to end, radians: within it the servo exerts no torque, and beyond it the
    /// servo reacts only to the part of the error that exceeds it.
    pub backlash_rad: f64,
    /// Offset that the servo adds to commanded angles, radians.
    pub offset_rad: f64,
    /// Reading of the joint's encoder at angle 0, radians. Servo, recorded start and recorded samples use encoder angles.
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

/// Changes of one module, relative to the robot's file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModuleAdjustment {
    /// Factor on its mass; inertia follows.
    pub mass_scale: f64,
    /// Additional factors on its inertia about x, y and z of its own frame.
    pub inertia_scale: Vector3<f64>,
    /// Change of the distribution of its mass, after these factors.
    pub inertia_change: InertiaChange,
    /// Shift of its centre of mass in its own frame, metres.
    pub centre_of_mass_offset_m: Vector3<f64>,
}

impl Default for ModuleAdjustment {
    fn default() -> Self {
        Self {
            mass_scale: 1.0,
            inertia_scale: Vector3::repeat(1.0),
            inertia_change: InertiaChange::default(),
            centre_of_mass_offset_m: Vector3::zeros(),
        }
    }
}

impl ModuleAdjustment {
    /// Applies the changes to the module of this name, if the robot has one. The module's plate is not changed.
    pub(super) fn apply(&self, name: &str, robot: &mut Assembly) {
        let Some(module) = robot.module_names.iter().position(|known| known == name) else {
            return;
        };
        // Scaling by these factors changes each moment independently of the other axes; products of inertia scale with the
        // geometric mean of their two factors.
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
            solid.inertia_kg_m2 = self.inertia_change.apply(&solid.inertia_kg_m2);
            solid.centre_of_mass_solid_m += self.centre_of_mass_offset_m;
        }
    }
}
