//! Where a run's mechanical energy comes from and where it goes.
//!
//! The engine says what contacts did during a step, for all substeps together, but not what a motor did. So what crosses a hinge
//! follows from momentum: the parts beyond it have changed theirs by gravity, by contacts and by what the hinge passed on, and
//! nothing else. That impulse times the mean of the speeds before and after the step is its work, as for every impulse (½ m v²
//! changes by m Δv times the mean of v). Nothing here is found from the change of energy, so that the balance can fail to
//! close: what is left over is [`EnergyBalance::residual_j`].
//!
//! Steps are resolved, substeps are not: a servo that speeds a part up and a contact that stops it again within the same step
//! both count as having done nothing.

use nalgebra::{Isometry3, Point3, Vector3};
use serde::Serialize;

use super::engine::{EngineChoice, Load, World};
use super::experiment::{Experiment, JointFormulation};
use super::kinematics::robot_from_part_at_zero;
use super::motor::Effort;
use super::part_state::PartState;
use realgap_core::warning::{Code, Warning};
use realgap_robot::morphology::{Assembly, Bearing, Freedom};

/// Above this share of what the servos gave, a balance is called open.
const OPEN_SHARE: f64 = 0.02;

/// Where the mechanical energy of a run came from and went, from [`Experiment::energy_from_s`] to the end, joules.
///
/// Work is positive where it adds to the robot's energy: `servo + gravity + contact + friction + joint + slack + residual = kinetic`.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct EnergyBalance {
    /// Work of all servos: what their motors gave minus what they took.
    pub servo_j: f64,
    /// What they gave, each servo and step by itself: an actuator that cannot store what it takes spends this.
    pub servo_positive_j: f64,
    /// Work of gravity: weight times fall.
    pub gravity_j: f64,
    /// Work of contacts along their normals; impacts lose energy, pushed-in contacts and led bodies may give some.
    pub contact_j: f64,
    /// Work of contacts across their normals: friction.
    pub friction_j: f64,
    /// Work of friction, gears and limits of the hinges. A limit of a hinge with a servo without a gear counts as the servo's.
    pub joint_j: f64,
    /// Work of hinges that gave way: an ideal hinge does none, an impulse joint opens a little.
    pub slack_j: f64,
    /// Change of kinetic energy, rotors included.
    pub kinetic_j: f64,
    /// What nothing above explains: numerical.
    pub residual_j: f64,
}

impl EnergyBalance {
    /// What is not explained, as a share of what the servos gave, or of what gravity did or what moved where that is more.
    pub fn residual_share(&self) -> f64 {
        let scale_j = self
            .servo_positive_j
            .max(self.gravity_j.abs())
            .max(self.kinetic_j.abs());
        if self.residual_j == 0.0 {
            return 0.0;
        }
        self.residual_j.abs() / scale_j
    }

    /// What to know where the balance does not close.
    pub(super) fn warning(&self) -> Option<Warning> {
        let share = self.residual_share();
        (share.is_nan() || share > OPEN_SHARE).then(|| {
            Code::EnergyOpen.warning(format!(
                "{:.1} % of the energy comes from nowhere or goes nowhere: shorter steps or more substeps close the balance",
                100.0 * share
            ))
        })
    }

    /// Mechanical cost of transport: what the servos gave per weight and distance; `None` for who gets nowhere or weighs nothing.
    pub fn cost_of_transport(&self, weight_n: f64, distance_m: f64) -> Option<f64> {
        let cost = self.servo_positive_j / (weight_n * distance_m);
        cost.is_finite().then_some(cost)
    }
}

/// What a hinge is to the meter.
struct Gauge {
    parent: usize,
    child: usize,
    /// Point on the axis, in the child's frame.
    anchor_child_m: Point3<f64>,
    /// The axis, in the frame of either part at any angle.
    axis_part: Vector3<f64>,
    slides: bool,
    bearing: Bearing,
    has_servo: bool,
    /// Inertia of a rotor that no part has, kg m².
    armature_kg_m2: f64,
}

impl Gauge {
    /// Speed, rad/s.
    fn speed_rad_s(&self, parts: &[PartState]) -> f64 {
        let (parent, child) = (&parts[self.parent], &parts[self.child]);
        let axis_world = parent.world_from_part.rotation * self.axis_part;
        if self.slides {
            let anchor_world_m = child.world_from_part * self.anchor_child_m;
            let at = |part: &PartState| {
                let arm_m = anchor_world_m.coords - part.centre_world_m;
                part.velocity_world_m_s + part.angular_velocity_world_rad_s.cross(&arm_m)
            };
            return (at(child) - at(parent)).dot(&axis_world);
        }
        (child.angular_velocity_world_rad_s - parent.angular_velocity_world_rad_s).dot(&axis_world)
    }
}

/// Impulse and moment about the world's origin.
#[derive(Clone, Copy)]
struct Wrench {
    impulse_n_s: Vector3<f64>,
    moment_nm_s: Vector3<f64>,
}

/// Motion of a part in the middle of a step.
struct Mean {
    centre_world_m: Vector3<f64>,
    velocity_world_m_s: Vector3<f64>,
    angular_world_rad_s: Vector3<f64>,
}

impl Mean {
    fn of(a: &PartState, b: &PartState) -> Self {
        Self {
            centre_world_m: 0.5 * (a.centre_world_m + b.centre_world_m),
            velocity_world_m_s: 0.5 * (a.velocity_world_m_s + b.velocity_world_m_s),
            angular_world_rad_s: 0.5
                * (a.angular_velocity_world_rad_s + b.angular_velocity_world_rad_s),
        }
    }

    /// Velocity of a point that moves with the part, and angular velocity.
    fn about(&self, point_world_m: &Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
        let arm_m = point_world_m - self.centre_world_m;
        let velocity = self.velocity_world_m_s + self.angular_world_rad_s.cross(&arm_m);
        (velocity, self.angular_world_rad_s)
    }
}

/// Reads the energy off a run, one step at a time, and changes nothing.
pub(super) struct Meter {
    from_s: f64,
    gravity_m_s2: f64,
    timestep_s: f64,
    gauges: Vec<Gauge>,
    before: Vec<PartState>,
    loads: Vec<Load>,
    wrenches: Vec<Wrench>,
    balance: EnergyBalance,
}

impl Meter {
    /// A meter for a robot that counts from `from_s` on.
    pub fn new(experiment: &Experiment, assembly: &Assembly, from_s: f64) -> Self {
        let has_rotors = experiment.joint_kind() == JointFormulation::Multibody
            || experiment.solver.engine != EngineChoice::default();
        let gauges = assembly.hinges.iter().map(|hinge| {
            let child_from_robot: Isometry3<f64> =
                robot_from_part_at_zero(assembly, hinge.child_part).inverse();
            let servo = hinge.actuator.as_ref().map(|actuator| &actuator.servo);
            let motor = servo.and_then(|servo| servo.law.motor());
            Gauge {
                parent: hinge.parent_part,
                child: hinge.child_part,
                anchor_child_m: child_from_robot * Point3::from(hinge.anchor_robot_m),
                axis_part: hinge.axis_robot.into_inner(),
                slides: hinge.freedom == Freedom::Slide,
                bearing: hinge.bearing,
                has_servo: servo.is_some(),
                armature_kg_m2: motor
                    .filter(|_| has_rotors)
                    .map_or(0.0, |motor| motor.armature_kg_m2)
                    + hinge.bearing.armature_kg_m2,
            }
        });
        Self {
            from_s,
            gravity_m_s2: experiment.gravity_m_s2,
            timestep_s: experiment.solver.timestep_s,
            gauges: gauges.collect(),
            before: Vec::new(),
            loads: Vec::new(),
            wrenches: Vec::new(),
            balance: EnergyBalance::default(),
        }
    }

    /// The balance so far.
    pub fn balance(&self) -> EnergyBalance {
        let mut balance = self.balance;
        balance.residual_j = balance.kinetic_j
            - balance.servo_j
            - balance.gravity_j
            - balance.contact_j
            - balance.friction_j
            - balance.joint_j
            - balance.slack_j;
        balance
    }

    /// Looks at the robot before the first step.
    pub fn start(&mut self, assembly: &Assembly, world: &dyn World) {
        self.before = look(assembly, world);
    }

    /// Looks at the robot after a step that began at `began_s`; `efforts` of motors behind gears, by hinge.
    pub fn read(
        &mut self,
        assembly: &Assembly,
        world: &dyn World,
        began_s: f64,
        efforts: &[Option<Effort>],
    ) {
        let after = look(assembly, world);
        // The step in whose middle counting starts belongs to the later part.
        if began_s + 0.5 * self.timestep_s >= self.from_s {
            world.loads(&mut self.loads);
            self.count(assembly.world_from_mount.is_some(), &after, efforts);
        }
        self.before = after;
    }

    fn count(&mut self, is_held: bool, after: &[PartState], efforts: &[Option<Effort>]) {
        let balance = &mut self.balance;
        self.wrenches.clear();
        for (index, (a, b)) in self.before.iter().zip(after).enumerate() {
            let weight_n = Vector3::new(0.0, 0.0, -b.mass_kg * self.gravity_m_s2);
            let centre_world_m = 0.5 * (a.centre_world_m + b.centre_world_m);
            let spin =
                |part: &PartState| part.inertia_world_kg_m2 * part.angular_velocity_world_rad_s;
            // What is held in place takes up whatever comes.
            if !(is_held && index == 0) {
                balance.kinetic_j += b.kinetic_energy_j() - a.kinetic_energy_j();
                balance.gravity_j += weight_n.dot(&(b.centre_world_m - a.centre_world_m));
            }
            let impulse_n_s =
                b.momentum_world_kg_m_s() - a.momentum_world_kg_m_s() - weight_n * self.timestep_s;
            self.wrenches.push(Wrench {
                impulse_n_s,
                moment_nm_s: spin(b) - spin(a) + centre_world_m.cross(&impulse_n_s),
            });
        }
        for load in &self.loads {
            let mean = Mean::of(&self.before[load.part], &after[load.part]);
            let point_world_m = mean.centre_world_m + load.arm_world_m;
            let (velocity_m_s, _) = mean.about(&point_world_m);
            balance.contact_j += load.normal_world_n_s.dot(&velocity_m_s);
            balance.friction_j += load.friction_world_n_s.dot(&velocity_m_s);
            let impulse_n_s = load.normal_world_n_s + load.friction_world_n_s;
            let wrench = &mut self.wrenches[load.part];
            wrench.impulse_n_s -= impulse_n_s;
            wrench.moment_nm_s -= point_world_m.cross(&impulse_n_s);
        }
        // Parents come before their children, so from the last hinge on all beyond a hinge is known.
        for (index, gauge) in self.gauges.iter().enumerate().rev() {
            let passed = self.wrenches[gauge.child];
            let parent = &mut self.wrenches[gauge.parent];
            parent.impulse_n_s += passed.impulse_n_s;
            parent.moment_nm_s += passed.moment_nm_s;
            let (a, b) = (
                self.before[gauge.child].world_from_part,
                after[gauge.child].world_from_part,
            );
            let anchor_world_m =
                0.5 * ((a * gauge.anchor_child_m).coords + (b * gauge.anchor_child_m).coords);
            let axis_world =
                (a.rotation * gauge.axis_part + b.rotation * gauge.axis_part).normalize();
            let moment_nm_s = passed.moment_nm_s - anchor_world_m.cross(&passed.impulse_n_s);
            let [parent, child] = [gauge.parent, gauge.child]
                .map(|part| Mean::of(&self.before[part], &after[part]).about(&anchor_world_m));
            let open_m_s = child.0 - parent.0;
            let turn_rad_s = child.1 - parent.1;
            // What the joint leaves free is no slack.
            let along = |v: &Vector3<f64>| axis_world * v.dot(&axis_world);
            let (slack_m_s, slack_rad_s, along_axis) = if gauge.slides {
                let impulse_n_s = passed.impulse_n_s.dot(&axis_world);
                (open_m_s - along(&open_m_s), turn_rad_s, impulse_n_s)
            } else {
                let tilt_rad_s = turn_rad_s - along(&turn_rad_s);
                (open_m_s, tilt_rad_s, moment_nm_s.dot(&axis_world))
            };
            balance.slack_j += passed.impulse_n_s.dot(&slack_m_s) + moment_nm_s.dot(&slack_rad_s);
            let [first_rad_s, then_rad_s] =
                [gauge.speed_rad_s(&self.before), gauge.speed_rad_s(after)];
            let mean_rad_s = 0.5 * (first_rad_s + then_rad_s);
            let rotor_j = 0.5 * gauge.armature_kg_m2 * (then_rad_s.powi(2) - first_rad_s.powi(2));
            balance.kinetic_j += rotor_j;
            let hinge_j = along_axis * mean_rad_s + rotor_j;
            let servo_j = match efforts.get(index).copied().flatten() {
                _ if !gauge.has_servo => 0.0,
                Some(effort) => {
                    let torque_nm = effort.damping_nm_s_rad * (effort.target_rad_s - mean_rad_s);
                    torque_nm * mean_rad_s * self.timestep_s
                }
                None => {
                    let Bearing {
                        viscous_nm_s_rad,
                        dry_nm,
                        ..
                    } = gauge.bearing;
                    let lost_w = viscous_nm_s_rad * mean_rad_s.powi(2) + dry_nm * mean_rad_s.abs();
                    hinge_j + lost_w * self.timestep_s
                }
            };
            balance.servo_j += servo_j;
            balance.servo_positive_j += servo_j.max(0.0);
            balance.joint_j += hinge_j - servo_j;
        }
    }
}

fn look(assembly: &Assembly, world: &dyn World) -> Vec<PartState> {
    (0..assembly.parts.len())
        .map(|part| world.part_now(part))
        .collect()
}
