//! Warnings about experiments that can be simulated but whose results mean little.

use super::engine::EngineChoice;
use super::experiment::{Experiment, JointFormulation, Solver};
use realgap_core::warning::{Code, Warning};
use realgap_robot::morphology::Role;

/// Smallest number of steps per period of a gait.
const STEPS_A_PERIOD: f64 = 10.0;
/// CPU time for one simulated second of a chain of [`JointFormulation::MOST_HINGES`] multibody joints in Rapier with the usual steps,
/// seconds, and the exponent with which it grows with the number of joints (docs/design.md).
const DOZEN_S: f64 = 0.04;
const GROWTH: f64 = 2.6;

impl Experiment {
    /// Warnings about settings that can be simulated but give meaningless results: a gait that is faster than the steps can
    /// follow (`gait-too-fast`), a centre of mass that lies outside of its cube (`centre-of-mass-outside`). Warnings about the
    /// robot itself come from [`realgap_robot::morphology::Morphology::warnings`].
    pub fn warnings(&self) -> Vec<Warning> {
        let robot = self.adjusted_assembly();
        let name = |module: usize| &robot.module_names[module];
        let timestep_s = self.solver.timestep_s;
        let most_hz = 1.0 / (STEPS_A_PERIOD * timestep_s);
        let driven = robot
            .hinges
            .iter()
            .filter_map(|hinge| Some((hinge, hinge.actuator?.gait)));
        let too_fast = driven.filter(|(_, gait)| {
            gait.amplitude_rad != 0.0 && gait.frequency_hz > most_hz * (1.0 + 1e-9)
        });
        let mut warnings: Vec<Warning> = too_fast
            .map(|(hinge, gait)| {
                Code::GaitTooFast.warning(format!(
                    "the gait of `{}` has {} Hz, but steps of {timestep_s:.3e} s follow {most_hz:.3} Hz at most (ten per period): \
                         lower its frequency or timestep_s",
                    hinge.name,
                    gait.frequency_hz
                ))
            })
            .collect();
        let solids = robot.parts.iter().flat_map(|part| &part.solids);
        let outside = solids.filter(|solid| {
            if solid.mass_kg == 0.0 || !solid.shape.is_box() {
                return false;
            }
            let centre_m = solid.centre_of_mass_solid_m.abs();
            let half_m = solid.half_extents_m();
            solid.role == Role::Cube && (0..3).any(|i| centre_m[i] > half_m[i] * (1.0 + 1e-9))
        });
        warnings.extend(self.slow_joints());
        warnings.extend(self.soft_springs());
        warnings.extend(outside.map(|solid| {
            let centre_m = solid.centre_of_mass_solid_m;
            Code::CentreOfMassOutside.warning(format!(
                "the centre of mass of `{}` is shifted to ({}, {}, {}) m, out of its cube of {} m, which is impossible for a solid cube; \
                     check body.com_offset_x_m, y and z",
                name(solid.module),
                centre_m.x,
                centre_m.y,
                centre_m.z,
                2.0 * solid.half_extents_m().x
            ))
        }));
        if !self.contact.is_on {
            warnings.push(Code::ContactsOff.warning(
                "contacts are off (contact.on): nothing stops the robot's parts in each other, in the floor or in the scene",
            ));
        }
        warnings
    }

    /// A warning about a robot of many joints whose multibody joints will cost Rapier much time.
    fn slow_joints(&self) -> Option<Warning> {
        let joints = self.assembly.hinges.len();
        let is_rapier = EngineChoice::new(self.engine()) == EngineChoice::default();
        let is_slow = self.vehicle.is_none()
            && is_rapier
            && joints > JointFormulation::MOST_HINGES
            && self.joint_kind() == JointFormulation::Multibody;
        let usual = Solver::default();
        let steps = self.solver.substeps as f64 / self.solver.timestep_s;
        let usual_steps = usual.substeps as f64 / usual.timestep_s;
        let share = joints as f64 / JointFormulation::MOST_HINGES as f64;
        let cost_s = DOZEN_S * share.powf(GROWTH) * steps / usual_steps;
        is_slow.then(|| {
            Code::SlowJoints.warning(format!(
                "{joints} multibody joints take Rapier about {} s of CPU for each simulated second, and twice as many about {:.0} times that",
                two_digits(cost_s),
                2.0_f64.powf(GROWTH)
            ))
        })
    }
}

/// A number with two digits.
fn two_digits(number: f64) -> String {
    match number {
        ..10.0 => format!("{number:.1}"),
        _ => format!("{number:.0}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use realgap_core::file::Source;
    use realgap_robot::import::Options;
    use realgap_robot::morphology::Morphology;

    fn codes(experiment: &Experiment) -> Vec<Code> {
        experiment.warnings().iter().map(|w| w.code).collect()
    }

    #[test]
    fn a_gait_too_fast_for_the_steps_and_a_centre_of_mass_outside_its_cube_give_warnings() {
        let robot = Morphology::read(concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../morphologies/tripod.ron"
        ))
        .unwrap();
        let mut experiment = Experiment::new(robot.assemble());
        assert_eq!(codes(&experiment), []);
        experiment.adjustment.centre_of_mass_offset_m.z = 10.0;
        assert!(
            codes(&experiment)
                .iter()
                .all(|c| *c == Code::CentreOfMassOutside)
        );
        assert_eq!(codes(&experiment).len(), robot.modules().len());
        experiment.adjustment.centre_of_mass_offset_m.z = 0.0;
        let fastest_hz = experiment
            .assembly
            .hinges
            .iter()
            .map(|h| h.actuator.unwrap().gait.frequency_hz);
        let fastest_hz = fastest_hz.fold(0.0, f64::max);
        // Exactly ten steps per period are enough.
        experiment.solver.timestep_s = 0.1 / fastest_hz;
        assert_eq!(codes(&experiment), []);
        experiment.adjustment.frequency_scale = 1.01;
        assert!(codes(&experiment).contains(&Code::GaitTooFast));
    }

    #[test]
    fn a_robot_of_many_joints_gets_the_tree_solver_and_a_warning_where_rapier_is_chosen() {
        let of = |joints: usize| {
            let mut text = String::from(r#"<robot name="r"><link name="l0"/>"#);
            for k in 1..=joints {
                text += &format!(
                    r#"<link name="l{k}"><inertial><mass value="0.1"/><inertia ixx="1e-4" iyy="1e-4" izz="1e-4"/></inertial></link>
                    <joint name="j{k}" type="continuous"><origin xyz="0 0 0.1"/><parent link="l{}"/><child link="l{k}"/></joint>"#,
                    k - 1
                );
            }
            let source = Source::new("r.urdf", text + "</robot>");
            let (robot, _) = Morphology::import(&source, &Options::default()).unwrap();
            Experiment::new(robot.assemble())
        };
        assert_eq!(of(12).engine().name(), "rapier");
        let mut long = of(13);
        assert_eq!(long.engine().name(), "tree");
        assert_eq!(codes(&long), []);
        // Settings that only Rapier has lead to Rapier, and the chosen engine is never replaced silently.
        long.solver.joint = JointFormulation::Impulse;
        assert_eq!(long.engine().name(), "rapier");
        long.solver.joint = JointFormulation::Auto;
        long.solver.engine = EngineChoice::default();
        assert_eq!(codes(&long), [Code::SlowJoints]);
    }
}
