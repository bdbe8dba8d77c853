//! Energy balance of a run: the work of servos, gravity, contacts and friction, and the change of kinetic energy.
//!
//! The engine reports the impulses of contacts during a step, summed over all substeps, but not those of motors. The impulse
//! through a hinge is therefore computed from momentum: the momentum of the parts beyond the hinge changes only by gravity, by
//! contacts and by the impulse through the hinge. The work of that impulse is the impulse times the mean of the speeds before and
//! after the step, as for every impulse (½ m v² changes by m Δv times the mean of v). No term is computed from the change of
//! energy, so the sum of all terms is an independent check: its deviation from the change of energy is
//! [`EnergyBalance::residual_j`].
//!
//! The balance resolves steps, but not substeps: a servo that accelerates a part and a contact that stops it again within the
//! same step both count as having done no work.

use nalgebra::{Isometry3, Point3, Vector3};
use serde::Serialize;

use super::engine::{EngineChoice, Load, World};
use super::experiment::{Experiment, JointFormulation};
use super::kinematics::{compensated, robot_from_part_at_zero};
use super::motor::Effort;
use super::part_state::PartState;
use realgap_core::warning::{Code, Warning};
use realgap_robot::morphology::{Assembly, Bearing, Freedom};

/// A balance whose residual exceeds this fraction of the servos' positive work gives a warning.
const OPEN_SHARE: f64 = 0.02;

/// Energy balance of a run from [`Experiment::energy_from_s`] to its end, joules.
///
/// Work is positive where it adds to the robot's energy: `servo + gravity + contact + friction + joint + slack + residual = kinetic`.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct EnergyBalance {
    /// Net work of all servos: positive minus negative work of their motors.
    pub servo_j: f64,
    /// Positive work of all servos, summed over servos and steps: the energy that actuators spend if they cannot recover energy.
    pub servo_positive_j: f64,
    /// Work of gravity: weight times loss of height.
    pub gravity_j: f64,
    /// Work of contacts along their normals; impacts dissipate energy, while penetrating contacts and driven bodies may add some.
    pub contact_j: f64,
    /// Work of contacts across their normals: friction, also that against rolling and spinning.
    pub friction_j: f64,
    /// Work of friction, gears and limits of the hinges. The work of a limit counts as the servo's if the hinge has a servo
    /// without a gear.
    pub joint_j: f64,
    /// Work against the constraints of the hinges: an ideal hinge does none, an impulse joint opens a little.
    pub slack_j: f64,
    /// Change of kinetic energy, rotors included.
    pub kinetic_j: f64,
    /// Residual that no term above explains: numerical error.
    pub residual_j: f64,
}

impl EnergyBalance {
    /// The residual as a fraction of the servos' positive work, or of the work of gravity or the change of kinetic energy if one
    /// of these is larger.
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

    /// A warning if the balance does not close.
    pub(super) fn warning(&self) -> Option<Warning> {
        let share = self.residual_share();
        (share.is_nan() || share > OPEN_SHARE).then(|| {
            Code::EnergyOpen.warning(format!(
                "the energy balance does not close: its residual is {:.1} % of the energy; use shorter steps or more substeps",
                100.0 * share
            ))
        })
    }

    /// Mechanical cost of transport: the servos' positive work per weight and distance; `None` if distance or weight is zero.
    pub fn cost_of_transport(&self, weight_n: f64, distance_m: f64) -> Option<f64> {
        let cost = self.servo_positive_j / (weight_n * distance_m);
        cost.is_finite().then_some(cost)
    }
}

/// The properties of a hinge that the energy meter needs.
struct HingeMeter {
    parent: usize,
    child: usize,
    /// Point on the axis, in the child's frame.
    anchor_child_m: Point3<f64>,
    /// The axis, in the frame of either part at any angle.
    axis_part: Vector3<f64>,
    slides: bool,
    bearing: Bearing,
    has_servo: bool,
    /// Inertia of a rotor that is not part of any body's inertia, kg m².
    armature_kg_m2: f64,
}

impl HingeMeter {
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

/// Computes the energy balance of a run step by step, without influence on the run.
pub(super) struct EnergyMeter {
    from_s: f64,
    gravity_m_s2: f64,
    /// Mass of each part whose weight is compensated, kg, and its centre in the part's frame, metres.
    compensated: Vec<(f64, Vector3<f64>)>,
    timestep_s: f64,
    hinge_meters: Vec<HingeMeter>,
    before: Vec<PartState>,
    loads: Vec<Load>,
    wrenches: Vec<Wrench>,
    balance: EnergyBalance,
}

impl EnergyMeter {
    /// A meter for a robot that counts from `from_s` on.
    pub fn new(experiment: &Experiment, assembly: &Assembly, from_s: f64) -> Self {
        let has_rotors = experiment.joint_kind() == JointFormulation::Multibody
            || experiment.solver.engine != EngineChoice::default();
        let hinge_meters = assembly.hinges.iter().map(|hinge| {
            let child_from_robot: Isometry3<f64> =
                robot_from_part_at_zero(assembly, hinge.child_part).inverse();
            let servo = hinge.actuator.as_ref().map(|actuator| &actuator.servo);
            let motor = servo.and_then(|servo| servo.law.motor());
            HingeMeter {
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
            compensated: (0..assembly.parts.len())
                .map(|part| compensated(assembly, part))
                .collect(),
            timestep_s: experiment.solver.timestep_s,
            hinge_meters: hinge_meters.collect(),
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

    /// Records the state of the robot before the first step.
    pub fn start(&mut self, assembly: &Assembly, world: &dyn World) {
        self.before = part_states(assembly, world);
    }

    /// Evaluates a step that began at `began_s` from the state after it; `efforts` are those of motors behind gears, by hinge.
    pub fn read(
        &mut self,
        assembly: &Assembly,
        world: &dyn World,
        began_s: f64,
        efforts: &[Option<Effort>],
    ) {
        let after = part_states(assembly, world);
        // A step is counted if its middle is not before the start of counting.
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
            // A fixed part absorbs any impulse and does not move.
            if !(is_held && index == 0) {
                balance.kinetic_j += b.kinetic_energy_j() - a.kinetic_energy_j();
                balance.gravity_j += weight_n.dot(&(b.centre_world_m - a.centre_world_m));
            }
            // The part of the weight that is compensated acts at a place of its own.
            let (lifted_kg, lifted_part_m) = self.compensated[index];
            let lift_n = Vector3::new(0.0, 0.0, lifted_kg * self.gravity_m_s2);
            let place =
                |part: &PartState| (part.world_from_part * Point3::from(lifted_part_m)).coords;
            if !(is_held && index == 0) {
                balance.gravity_j += lift_n.dot(&(place(b) - place(a)));
            }
            let lift_arm_m = 0.5 * (place(a) + place(b)) - centre_world_m;
            let impulse_n_s = b.momentum_world_kg_m_s()
                - a.momentum_world_kg_m_s()
                - (weight_n + lift_n) * self.timestep_s;
            self.wrenches.push(Wrench {
                impulse_n_s,
                moment_nm_s: spin(b) - spin(a) + centre_world_m.cross(&impulse_n_s)
                    - lift_arm_m.cross(&lift_n) * self.timestep_s,
            });
        }
        for load in &self.loads {
            let mean = Mean::of(&self.before[load.part], &after[load.part]);
            let point_world_m = mean.centre_world_m + load.arm_world_m;
            let (velocity_m_s, turn_rad_s) = mean.about(&point_world_m);
            balance.contact_j += load.normal_world_n_s.dot(&velocity_m_s);
            balance.friction_j += load.friction_world_n_s.dot(&velocity_m_s)
                + load.couple_world_n_m_s.dot(&turn_rad_s);
            let impulse_n_s = load.normal_world_n_s + load.friction_world_n_s;
            let wrench = &mut self.wrenches[load.part];
            wrench.impulse_n_s -= impulse_n_s;
            wrench.moment_nm_s -= point_world_m.cross(&impulse_n_s) + load.couple_world_n_m_s;
        }
        // Parents precede their children, so in reverse order all impulses beyond a hinge are known when the hinge is reached.
        for (index, hinge_meter) in self.hinge_meters.iter().enumerate().rev() {
            let passed = self.wrenches[hinge_meter.child];
            let parent = &mut self.wrenches[hinge_meter.parent];
            parent.impulse_n_s += passed.impulse_n_s;
            parent.moment_nm_s += passed.moment_nm_s;
            let (a, b) = (
                self.before[hinge_meter.child].world_from_part,
                after[hinge_meter.child].world_from_part,
            );
            let anchor_world_m = 0.5
                * ((a * hinge_meter.anchor_child_m).coords
                    + (b * hinge_meter.anchor_child_m).coords);
            let axis_world = (a.rotation * hinge_meter.axis_part
                + b.rotation * hinge_meter.axis_part)
                .normalize();
            let moment_nm_s = passed.moment_nm_s - anchor_world_m.cross(&passed.impulse_n_s);
            let [parent, child] = [hinge_meter.parent, hinge_meter.child]
                .map(|part| Mean::of(&self.before[part], &after[part]).about(&anchor_world_m));
            let open_m_s = child.0 - parent.0;
            let turn_rad_s = child.1 - parent.1;
            // Motion along the joint's degree of freedom is no opening of the joint.
            let along = |v: &Vector3<f64>| axis_world * v.dot(&axis_world);
            let (slack_m_s, slack_rad_s, along_axis) = if hinge_meter.slides {
                let impulse_n_s = passed.impulse_n_s.dot(&axis_world);
                (open_m_s - along(&open_m_s), turn_rad_s, impulse_n_s)
            } else {
                let tilt_rad_s = turn_rad_s - along(&turn_rad_s);
                (open_m_s, tilt_rad_s, moment_nm_s.dot(&axis_world))
            };
            balance.slack_j += passed.impulse_n_s.dot(&slack_m_s) + moment_nm_s.dot(&slack_rad_s);
            let [first_rad_s, then_rad_s] = [
                hinge_meter.speed_rad_s(&self.before),
                hinge_meter.speed_rad_s(after),
            ];
            let mean_rad_s = 0.5 * (first_rad_s + then_rad_s);
            let rotor_j =
                0.5 * hinge_meter.armature_kg_m2 * (then_rad_s.powi(2) - first_rad_s.powi(2));
            balance.kinetic_j += rotor_j;
            let hinge_j = along_axis * mean_rad_s + rotor_j;
            let servo_j = match efforts.get(index).copied().flatten() {
                _ if !hinge_meter.has_servo => 0.0,
                Some(effort) => {
                    let torque_nm = effort.damping_nm_s_rad * (effort.target_rad_s - mean_rad_s);
                    torque_nm * mean_rad_s * self.timestep_s
                }
                None => {
                    let Bearing {
                        viscous_nm_s_rad,
                        dry_nm,
                        ..
                    } = hinge_meter.bearing;
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

fn part_states(assembly: &Assembly, world: &dyn World) -> Vec<PartState> {
    (0..assembly.parts.len())
        .map(|part| world.part_now(part))
        .collect()
}
