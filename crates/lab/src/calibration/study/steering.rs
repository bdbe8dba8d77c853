//! The controller of a study: every simulation of a sweep or a tuning runs with it.

use std::path::Path;
use std::sync::Arc;

use crate::calibration::{Definition, StartRule};
use realgap_core::file::{Source, sha256};
use realgap_core::{Error, Result};
use realgap_simulation::{Controller, Experiment, Ground, SceneBody};

impl Definition {
    /// Gives each robot of the definition the controller that the study names for it; `own` are the controllers of single robots.
    pub(in crate::calibration) fn steer(
        &mut self,
        study: &Source,
        shared: Option<&Path>,
        own: &[Option<&Path>],
    ) -> Result<()> {
        let folder = study.path().parent().unwrap_or(Path::new(""));
        let steering = |named: Option<&Path>, of: &Self| {
            let named = named.map(|named| Steering::read(study, &folder.join(named), of));
            named.transpose()
        };
        for (index, named) in own.iter().enumerate() {
            let alone = self.of_member(&self.robots[index]);
            self.robots[index].steering = steering(named.or(shared), &alone)?;
        }
        self.steering = match self.robots.first() {
            Some(first) => first.steering.clone(),
            None => steering(shared, self)?,
        };
        Ok(())
    }
}

/// A controller with the walls of its arena, as every run of a robot has them.
#[derive(Debug, Clone)]
pub struct Steering {
    controller: Arc<Controller>,
    walls: Vec<SceneBody>,
    ground: Ground,
}

impl Steering {
    /// Reads the controller that a study names for the robot of this definition, and checks that it fits.
    ///
    /// # Errors
    /// As [`Controller::read`]; a robot that cannot have one, or that stands among other walls already.
    pub(in crate::calibration) fn read(
        study: &Source,
        named: &Path,
        definition: &Definition,
    ) -> Result<Self> {
        let refuse = |what: &str, hint: &str| {
            let error = Error::invalid(what).field("controller").hint(hint);
            Err(study.at("controller", error))
        };
        if definition.start != StartRule::Settled || definition.vehicle.is_some() {
            return refuse(
                "a robot with a controller starts at rest where its arena says",
                "use `start: Settled` and a morphology, or leave the controller out",
            );
        }
        let mut bodies = definition.scene.iter();
        if bodies.any(|body| body.name == SceneBody::ARENA) || !definition.ground.is_plain() {
            return refuse(
                "the study has an arena, and so has its controller",
                "leave `arena` out of the study",
            );
        }
        let experiment = definition.experiment();
        let controller = Controller::read(named, &experiment)?;
        let steered = experiment.with_controller(controller.clone())?;
        Ok(Self {
            controller: Arc::new(controller),
            walls: steered.scene[experiment.scene.len()..].to_vec(),
            ground: steered.ground,
        })
    }

    /// Adds the controller to the robot of an experiment.
    pub(in crate::calibration) fn give_to(&self, experiment: &mut Experiment) {
        experiment.scene.extend(self.walls.iter().cloned());
        experiment.ground.clone_from(&self.ground);
        experiment.controller = Some(Arc::clone(&self.controller));
    }

    /// Checksum of the controller with its arena and its models.
    pub(in crate::calibration) fn sha256(&self) -> String {
        sha256(format!("{:?}", self.controller).as_bytes())
    }
}
