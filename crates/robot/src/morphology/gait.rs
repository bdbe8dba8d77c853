//! Reading and replacing the gaits of a robot, for modular robots and robots of bodies.

use super::{Blueprint, Gait, Morphology};
use realgap_core::Result;

impl Morphology {
    /// The gait of every module, in the order of the modules: the gait of its servo, or of the joint that moves it; `None` for a
    /// module without a servo, or whose joint copies the command of another joint.
    pub fn gaits(&self) -> Vec<Option<Gait>> {
        let mut gaits = vec![None; self.modules.len()];
        for hinge in self.assemble().hinges {
            let follows = self.structure().is_some_and(|structure| {
                let mut drivers = structure.actuators.iter();
                drivers.any(|driver| driver.joint == hinge.name && driver.follows.is_some())
            });
            if let Some(actuator) = hinge.actuator.filter(|_| !follows) {
                gaits[hinge.module].get_or_insert(actuator.gait);
            }
        }
        gaits
    }

    /// The same robot with another name, description and gaits, which are in the order of the modules; `None` stands for a module
    /// without a servo.
    ///
    /// # Errors
    /// A gait whose values are out of range.
    pub fn with_gaits(
        &self,
        name: &str,
        description: &str,
        gaits: &[Option<Gait>],
    ) -> Result<Self> {
        let gait_of = |module: usize| gaits.get(module).copied().flatten();
        let (name, description) = (name.to_owned(), description.to_owned());
        if let Some(built) = &self.built {
            let mut structure = built.structure.clone();
            (structure.name, structure.description) = (name, description);
            for hinge in &built.assembly.hinges {
                let mut drivers = structure.actuators.iter_mut();
                if let Some(driver) = drivers.find(|driver| driver.joint == hinge.name)
                    && let Some(gait) = gait_of(hinge.module).filter(|_| driver.follows.is_none())
                {
                    driver.gait = Some(gait);
                }
            }
            return Self::of_bodies(structure);
        }
        let mut modules = self.modules.clone();
        let mut pivots = self.pivots.clone();
        for (index, module) in modules.iter_mut().enumerate() {
            let pivot = pivots.iter_mut().find(|pivot| pivot.child == index);
            let own = module.drive.as_mut().map(|drive| &mut drive.actuator);
            let actuator = own.or_else(|| pivot.and_then(|pivot| pivot.actuator.as_mut()));
            if let (Some(actuator), Some(gait)) = (actuator, gait_of(index)) {
                actuator.gait = gait;
            }
        }
        Self::new(Blueprint {
            name,
            description,
            modules,
            attachments: self.attachments.clone(),
            pivots,
            collision_exclude: self.collision_exclude.clone(),
            mount_world_m: self.mount_world_m,
            track: Some(self.track),
        })
    }
}
