//! Validation of an experiment before it is simulated.

use super::{EngineChoice, Experiment, FrictionModel, JointFormulation, Sampling};
use realgap_core::error::{Advice, Error, Result};
use realgap_robot::morphology::{Hinge, Role};

/// A part with a compliant bearing needs at least this fraction of the mass of the other part at the hinge: the stiffness follows
/// from the reduced mass of both parts, so the bearing of a much lighter part could not support anything else.
const LEAST_BESIDE: f64 = 0.01;

/// The longest run, seconds: a day.
pub const LONGEST_S: f64 = 86_400.0;

impl Experiment {
    /// Checks the ranges that no single field can check for itself.
    ///
    /// # Errors
    /// A duration, timestep or sampling that cannot be simulated.
    pub fn check(&self) -> Result<()> {
        let range =
            |field: &str, value: f64, allowed: std::ops::RangeInclusive<f64>, unit: &str| {
                if allowed.contains(&value) {
                    return Ok(());
                }
                Err(Error::invalid("out of range")
                    .field(field)
                    .found(format!("{value} {unit}").trim_end())
                    .allowed(format!("{} to {} {unit}", allowed.start(), allowed.end()).trim_end()))
            };
        self.check_edges()?;
        self.check_energy()?;
        self.check_friction()?;
        self.check_turning()?;
        self.check_mount()?;
        self.check_base()?;
        self.check_compliance()?;
        for body in &self.scene {
            body.check()?;
            body.check_clear(self)?;
        }
        self.check_ground()?;
        range("duration_s", self.duration_s, 1e-3..=LONGEST_S, "s")?;
        range("timestep_s", self.solver.timestep_s, 1e-6..=0.1, "s")?;
        range(
            "solver.substeps",
            self.solver.substeps as f64,
            1.0..=256.0,
            "",
        )?;
        let steps = self.duration_s / self.solver.timestep_s;
        if steps > 1e8 {
            return Err(Error::invalid("too many steps for one run")
                .found(format!(
                    "{steps:.0} steps, about {:.0} hours at 20 microseconds a step",
                    steps * 20e-6 / 3600.0
                ))
                .allowed("at most 100 000 000")
                .hint("shorten the duration or lengthen the timestep"));
        }
        match &self.sampling {
            Sampling::Rate(hz) => {
                range("rate", *hz, 1e-3..=1e5, "Hz")?;
                if self.duration_s * hz > 1e7 {
                    return Err(Error::invalid("too many samples for one run")
                        .found(format!("{:.0} samples", self.duration_s * hz))
                        .allowed("at most 10 000 000"));
                }
            }
            Sampling::Times(times_s) => {
                let increasing = times_s.windows(2).all(|w| w[0] < w[1]);
                if times_s.len() < 2 || !increasing || !times_s.iter().all(|t| t.is_finite()) {
                    return Err(Error::invalid(
                        "sample times must be at least two, finite and increasing",
                    ));
                }
            }
        }
        Ok(())
    }

    /// Checks that the energy balance can be computed: it needs the impulses of contacts from the engine.
    fn check_energy(&self) -> Result<()> {
        let Some(from_s) = self.energy_from_s else {
            return Ok(());
        };
        if !(0.0..self.duration_s).contains(&from_s) {
            return Err(
                Error::invalid("the start of the energy balance is outside of the run")
                    .field("energy_from_s")
                    .found(format!("{from_s} s"))
                    .allowed(format!("0 to less than {} s", self.duration_s)),
            );
        }
        if self.vehicle.is_some() {
            return Err(Error::invalid(
                "a vehicle has no servos, so there is no energy balance",
            ));
        }
        if self.assembly.is_compliant() {
            return Err(
                Error::invalid("the energy balance does not support compliant bearings")
                    .field("hinge.bearing_hz")
                    .allowed("0"),
            );
        }
        let is_pyramid = self.contact.friction_model == FrictionModel::Simplified;
        if is_pyramid && self.joint_kind() == JointFormulation::Impulse {
            return Err(
                Error::invalid("the energy balance needs friction impulses, which this friction model does not report")
                    .field("contact.friction_model")
                    .found("Simplified")
                    .allowed("Coulomb"),
            );
        }
        Ok(())
    }

    /// Checks that bearings can be compliant. This needs impulse joints between parts with mass. Rapier would also soften limits
    /// of a compliant hinge, and passes without bias would remove the springs.
    fn check_compliance(&self) -> Result<()> {
        let hinges = self.assembly.hinges.iter();
        let compliant = || hinges.clone().filter(|hinge| hinge.bearing.is_compliant());
        if compliant().next().is_none() {
            return Ok(());
        }
        let is_light = |hinge: &Hinge| {
            let [a, b] = [hinge.parent_part, hinge.child_part]
                .map(|part| self.assembly.parts[part].mass_kg());
            a.min(b) < LEAST_BESIDE * a.max(b)
        };
        let (why, allowed) = if self.joint_kind() != JointFormulation::Impulse {
            (
                "multibody joints cannot be compliant",
                "0, or impulse joints (solver.joint 0)",
            )
        } else if self.solver.relaxations > 0 {
            (
                "passes without bias (relaxations) remove the compliance",
                "0, or solver.relaxations 0",
            )
        } else if compliant().any(|hinge| hinge.bearing.limits_rad.is_some()) {
            (
                "a hinge with limits cannot be compliant",
                "0, or a hinge without limits",
            )
        } else if compliant().any(is_light) {
            (
                "the bearing of a part with almost no mass cannot be compliant",
                "0",
            )
        } else {
            return Ok(());
        };
        Err(Error::invalid(why)
            .field("hinge.bearing_hz")
            .allowed(allowed))
    }

    /// Checks that a robot without contacts is held, and that only a held robot has a mount with a spring, which only the tree solver
    /// simulates.
    fn check_mount(&self) -> Result<()> {
        let is_held = self.assembly.world_from_mount.is_some();
        if !self.contact.is_on && !is_held {
            return Err(Error::invalid(
                "without contacts, a robot that is not held falls for ever",
            )
            .field("contact.on")
            .found("0 (off)")
            .allowed("1 (on), or a robot whose file states a `mount`")
            .advise(Advice::HoldRoot));
        }
        if self.mount.is_none() {
            return Ok(());
        }
        if !is_held {
            return Err(Error::invalid("a robot that moves freely has no stand")
                .field("mount.stiffness_n_m")
                .found("a spring")
                .allowed("a robot whose file states a `mount`")
                .advise(Advice::HoldRoot));
        }
        if self.assembly.is_compliant() {
            return Err(Error::invalid(
                "no engine simulates compliant hinges on a mount with a spring",
            )
            .field("hinge.bearing_hz")
            .allowed("0"));
        }
        if self.energy_from_s.is_some() {
            return Err(
                Error::invalid("the energy balance does not count the spring of a mount")
                    .field("mount.stiffness_n_m")
                    .allowed("no spring"),
            );
        }
        Ok(())
    }

    /// Checks that a base that is led can be: it is the root, which the tree solver leads, and stands on no spring.
    fn check_base(&self) -> Result<()> {
        if self.base.is_none() {
            return Ok(());
        }
        let refuse = |why: &str, found: &str, allowed: &str| {
            let error = Error::invalid(why).field("base");
            Err(error.found(found).allowed(allowed))
        };
        if self.assembly.track_part != 0 {
            return refuse(
                "the pose along which a base is led is that of the root",
                "another body is tracked",
                "a robot whose tracked body (`track`) is its root",
            );
        }
        if self.mount.is_some() {
            return refuse(
                "a base that is led stands on no spring",
                "a spring (`mount.stiffness_n_m`)",
                "one of both: the recorded motion is that of the robot, on whatever it stands",
            );
        }
        if self.assembly.is_compliant() {
            return refuse(
                "no engine simulates compliant hinges on a base that is led",
                "`hinge.bearing_hz` above 0",
                "0",
            );
        }
        if self.vehicle.is_some() || self.controller.is_some() {
            return refuse(
                "the base of a robot that steers itself is not led",
                "a vehicle or a controller",
                "recorded commands or gaits",
            );
        }
        if self.energy_from_s.is_some() {
            return refuse(
                "the energy balance does not count the work of what leads a base",
                "an energy balance",
                "a base that is not led",
            );
        }
        Ok(())
    }

    /// Checks that the engine supports the friction model: Rapier has no relaxed cone.
    fn check_friction(&self) -> Result<()> {
        let is_relaxed = self.contact.friction_model == FrictionModel::Relaxed;
        if !is_relaxed || EngineChoice::new(self.engine()) != EngineChoice::default() {
            return Ok(());
        }
        Err(Error::invalid("this engine has no relaxed friction cone")
            .field("contact.friction_model")
            .found(format!("Relaxed (2), in {}", self.engine_version()))
            .allowed("Simplified (0) and Coulomb (1)")
            .hint("choose the engine `tree`, whose number in `solver.engine` is 1"))
    }

    /// Checks that friction against rolling and spinning can be simulated: the tree solver does, with its exact cone, and it has no
    /// compliant hinges.
    fn check_turning(&self) -> Result<()> {
        if !self.has_turning_friction() {
            return Ok(());
        }
        let refuse = |why: &str, field: &str, found: &str, allowed: &str| {
            let error = Error::invalid(why).field(field).found(found);
            Err(error.allowed(allowed).hint(
                "or state no rolling and torsional friction (floor.rolling_m, floor.torsional_m, `turning` of shapes)",
            ))
        };
        if self.contact.friction_model == FrictionModel::Relaxed {
            return refuse(
                "rolling and torsional friction need an exact friction cone",
                "contact.friction_model",
                "Relaxed (2)",
                "Coulomb (1)",
            );
        }
        if self.assembly.is_compliant() {
            return refuse(
                "no engine simulates compliant hinges together with rolling and torsional friction",
                "hinge.bearing_hz",
                "above 0",
                "0",
            );
        }
        Ok(())
    }

    /// Checks that the edge radius is smaller than half of the narrowest cube.
    fn check_edges(&self) -> Result<()> {
        let radius_m = self.adjustment.edge_radius_m;
        let smallest_m = self
            .assembly
            .parts
            .iter()
            .flat_map(|part| &part.solids)
            .filter(|solid| solid.role == Role::Cube && solid.shape.is_box())
            .map(|solid| solid.half_extents_m().min())
            .fold(f64::INFINITY, f64::min);
        if radius_m == 0.0 || (0.0..smallest_m).contains(&radius_m) {
            return Ok(());
        }
        Err(Error::invalid("the edge radius is too large for the cube")
            .field("body.edge_radius_m")
            .found(format!("{radius_m} m"))
            .allowed(format!("less than half the narrowest cube, {smallest_m} m")))
    }
}
