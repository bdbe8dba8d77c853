//! Springs that are too stiff for the bodies that they move: which engine follows them, and what is said of them.

use nalgebra::{Isometry3, Matrix3};

use super::engine::EngineChoice;
use super::experiment::{Experiment, Solver};
use super::outcome::Divergence;
use super::rapier::{LEAST_SHARE, total_kg};
use realgap_core::warning::{Code, Warning};
use realgap_robot::morphology::{Assembly, Freedom, Hinge};

/// The inertia of two parts about the hinge between them, without other joints, as Rapier sees it, kg m² (kg for a slide).
fn reduced_inertia(assembly: &Assembly, hinge: &Hinge) -> f64 {
    let robot = Isometry3::identity();
    let least_kg = LEAST_SHARE * total_kg(assembly);
    let of = |index: usize| {
        let mass = assembly.parts[index].mass(&robot);
        let (mass_kg, inertia): (f64, Matrix3<f64>) = match mass.mass_kg > 0.0 {
            true => (mass.mass_kg, mass.inertia_kg_m2),
            false => (least_kg, Matrix3::zeros()),
        };
        if hinge.freedom == Freedom::Slide {
            return mass_kg;
        }
        let axis = hinge.axis_robot.into_inner();
        let arm_m = mass.centre_m - hinge.anchor_robot_m;
        axis.dot(&(inertia * axis)) + mass_kg * arm_m.cross(&axis).norm_squared()
    };
    let is_held = |part: usize| part == 0 && assembly.world_from_mount.is_some();
    let parts = [hinge.parent_part, hinge.child_part];
    let inverse: f64 = (parts.into_iter().filter(|part| !is_held(*part)))
        .map(|part| 1.0 / of(part))
        .sum();
    1.0 / inverse + hinge.bearing.armature_kg_m2
}

/// The joints with a spring that Rapier would make softer at this timestep, each with the longest timestep at which it would not.
fn softened(assembly: &Assembly, timestep_s: f64) -> impl Iterator<Item = (&Hinge, f64)> {
    assembly.hinges.iter().filter_map(move |hinge| {
        let stiffness = hinge.bearing.spring?.stiffness_nm_rad;
        let longest_s = (reduced_inertia(assembly, hinge) / stiffness).sqrt();
        (longest_s < timestep_s).then_some((hinge, longest_s))
    })
}

/// Whether Rapier follows the springs of a robot at its usual timestep.
pub(super) fn rapier_follows(assembly: &Assembly) -> bool {
    let timestep_s = Solver::default().timestep_s;
    softened(assembly, timestep_s).next().is_none()
}

impl Divergence {
    /// The same divergence, with the joint that the timestep does not follow, if there is one.
    #[must_use]
    pub(super) fn with_stiff_joint(self, experiment: &Experiment) -> Self {
        match experiment.stiff_joint() {
            None => self,
            Some(stiff) => Self {
                why: format!("{}; {stiff}", self.why),
                ..self
            },
        }
    }
}

impl Experiment {
    /// What is said of a joint that the timestep does not follow: the remedy of a run that diverges.
    pub(super) fn stiff_joint(&self) -> Option<String> {
        let stiffest = self.assembly.stiffest_joint()?;
        (stiffest.timestep_s < self.solver.timestep_s).then(|| {
            format!(
                "the stiffest joint is `{}`, whose vibration needs a timestep of {:.1e} s",
                self.assembly.hinges[stiffest.hinge].name, stiffest.timestep_s
            )
        })
    }

    /// A warning about springs that Rapier makes softer.
    pub(super) fn soft_springs(&self) -> Option<Warning> {
        let is_rapier = EngineChoice::new(self.engine()) == EngineChoice::default();
        if self.vehicle.is_some() || !is_rapier {
            return None;
        }
        let mut soft = softened(&self.assembly, self.solver.timestep_s);
        let (hinge, longest_s) = soft.next()?;
        let others = soft.count();
        Some(Code::KnownLimit.warning(format!(
            "Rapier makes the spring of `{}`{} softer, because steps of {:.1e} s do not follow it: use the engine tree, or timestep_s below {longest_s:.1e}",
            hinge.name,
            if others > 0 { format!(" and of {others} other joints") } else { String::new() },
            self.solver.timestep_s
        )))
    }
}

#[cfg(test)]
mod tests {
    use super::super::run::run;
    use super::*;
    use realgap_core::file::Source;
    use realgap_robot::morphology::Morphology;

    /// A light finger on a spring of this stiffness.
    fn finger(stiffness: f64) -> Assembly {
        let text = format!(
            r#"(name: "finger", mount: (at_m: (0, 0, 1)), bodies: [(name: "palm", mass_kg: 0.2, inertia_kg_m2: (xx: 1e-4, yy: 1e-4, zz: 1e-4)),
                (name: "tip", mass_kg: 0.004, centre_of_mass_m: (0, 0, -0.01), inertia_kg_m2: (xx: 2e-7, yy: 2e-7, zz: 2e-7))],
                joints: [(name: "bend", parent: "palm", child: "tip", start: 0.3,
                    kind: Turn(axis: (0, 1, 0), spring: (stiffness_nm_rad: {stiffness:?})))])"#
        );
        let robot = Morphology::parse(&Source::new("finger.ron", text)).unwrap();
        robot.assemble()
    }

    #[test]
    fn a_stiff_spring_of_a_light_finger_is_left_to_the_tree_solver_and_rapier_says_that_it_softens_it()
     {
        let soft = Experiment::new(finger(1e-3));
        assert!(soft.solver.engine == EngineChoice::default());
        let mut stiff = Experiment::new(finger(1.0));
        assert!(stiff.solver.engine != EngineChoice::default());
        // Its angular frequency is 1290 rad/s.
        assert!(stiff.stiff_joint().unwrap().contains("`bend`"));
        let mut in_rapier = stiff.clone();
        in_rapier.solver.engine = EngineChoice::default();
        let codes: Vec<Code> = in_rapier.warnings().iter().map(|w| w.code).collect();
        assert!(codes.contains(&Code::KnownLimit), "{codes:?}");
        // Without friction, the spring swings as far after many periods as at first.
        stiff.solver.timestep_s = stiff.assembly.stiffest_joint().unwrap().timestep_s;
        stiff.duration_s = 0.5;
        let motion = run(&stiff).unwrap().outcome.completed().unwrap();
        let angles = &motion.joint("bend").unwrap().angles_rad;
        let most = angles
            .iter()
            .fold(0.0_f64, |most, angle| most.max(angle.abs()));
        assert!((0.2..0.31).contains(&most), "{most}");
    }
}
