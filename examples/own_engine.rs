#![allow(clippy::print_stdout)]
//! Shows how to write your own engine: one type that builds worlds and one that steps them. Commands, sampling, noise, studies and
//! ensembles are the same for all engines.
//!
//! `cargo run --example own_engine`
//!
//! This engine simulates only a block that never turns, on a level floor without bounces: v' = v - µ g t. It refuses every other
//! experiment; then Rapier simulates in its place, with a warning.

use nalgebra::{Isometry3, Point3, Vector3};
use realgap::robot::morphology::Morphology;
use realgap::simulation::{
    Command, Effort, Engine, EngineChoice, Experiment, Load, PartState, Setup, Start, World, run,
};
use realgap::trajectory::State;
use realgap::{Error, Result};

#[derive(Debug)]
struct Sledges;

static SLEDGES: Sledges = Sledges;

impl Engine for Sledges {
    fn name(&self) -> &'static str {
        "sledge"
    }
    fn version(&self) -> &'static str {
        "sledge 1"
    }
    fn refusal(&self, experiment: &Experiment) -> Option<String> {
        let robot = &experiment.assembly;
        let is_one_body = robot.parts.len() == 1 && robot.world_from_mount.is_none();
        let is_plain = experiment.scene.is_empty()
            && experiment.ground.is_plain()
            && experiment.floor.slope_rad == 0.0;
        (!is_one_body || !is_plain)
            .then(|| "a sledge is one body on a level floor, alone".to_owned())
    }
    fn build(&self, setup: &Setup<'_>) -> Result<Box<dyn World>> {
        let world_from_part = setup.world_from_parts[0];
        let part = &setup.assembly.parts[0];
        let part_from_robot = part.solids[0].robot_from_solid.translation.inverse();
        let mass = part.mass(&Isometry3::from(part_from_robot));
        let heights_m = part.solids.iter().map(|solid| {
            let (low_m, _) = solid.bounds_robot_m();
            low_m.z + part_from_robot.vector.z
        });
        Ok(Box::new(Sledge {
            state: PartState {
                world_from_part,
                centre_world_m: (world_from_part * Point3::from(mass.centre_m)).coords,
                velocity_world_m_s: setup.motion.linear_world_m_s,
                angular_velocity_world_rad_s: Vector3::zeros(),
                mass_kg: mass.mass_kg,
                inertia_world_kg_m2: mass.inertia_kg_m2,
            },
            foot_m: heights_m.fold(0.0, f64::min),
            floor_m: setup.experiment.floor.height_m,
            friction: setup.experiment.floor.friction,
            gravity_m_s2: setup.experiment.gravity_m_s2,
            timestep_s: setup.experiment.solver.timestep_s,
        }))
    }
}

struct Sledge {
    state: PartState,
    /// Height of the lowest point relative to the part's origin, which is negative, metres.
    foot_m: f64,
    floor_m: f64,
    friction: f64,
    gravity_m_s2: f64,
    timestep_s: f64,
}

impl World for Sledge {
    fn step(&mut self) {
        let t = self.timestep_s;
        let height_m = self.state.world_from_part.translation.z + self.foot_m - self.floor_m;
        let velocity = &mut self.state.velocity_world_m_s;
        velocity.z -= self.gravity_m_s2 * t;
        // The impulse of friction is proportional to the impulse that stops the fall at the floor.
        let stopped_m_s = (-height_m / t - velocity.z).max(0.0);
        velocity.z += stopped_m_s;
        let slip = Vector3::new(velocity.x, velocity.y, 0.0);
        let rubbed_m_s = (self.friction * stopped_m_s).min(slip.norm());
        *velocity -= slip.try_normalize(0.0).unwrap_or_default() * rubbed_m_s;
        let moved_m = *velocity * t;
        self.state.world_from_part.translation.vector += moved_m;
        self.state.centre_world_m += moved_m;
    }
    fn part(&self, _part: usize) -> (Isometry3<f64>, Vector3<f64>, Vector3<f64>) {
        let state = &self.state;
        let turns = state.angular_velocity_world_rad_s;
        (state.world_from_part, state.velocity_world_m_s, turns)
    }
    fn part_state(&self, _part: usize) -> PartState {
        self.state.clone()
    }
    fn push(&mut self, _part: usize, velocity_world_m_s: &Vector3<f64>) {
        self.state.velocity_world_m_s += velocity_world_m_s;
    }
    // There are no hinges, contact loads or scenes, because `refusal` refuses experiments that need them.
    fn hinge_angle_rad(&self, _hinge: usize, near_rad: f64) -> f64 {
        near_rad
    }
    fn hinge_speed_rad_s(&self, _hinge: usize) -> f64 {
        0.0
    }
    fn drive(&mut self, _hinge: usize, _angle_rad: f64, _command: Command) {}
    fn exert(&mut self, _hinge: usize, _effort: &Effort) {}
    fn loads(&self, loads: &mut Vec<Load>) {
        loads.clear();
    }
    fn scene_poses(&self) -> Vec<Isometry3<f64>> {
        Vec::new()
    }
    fn place_driven(&mut self, _index: usize, _world_from_body: &Isometry3<f64>) {}
    fn lead_driven(&mut self, _index: usize, _next: &Isometry3<f64>) {}
}

/// Slides a block and prints how far it went.
pub fn main() -> Result<()> {
    let cube = Morphology::read("morphologies/cube.ron")?.assemble();
    let mut experiment = Experiment::new(cube);
    experiment.duration_s = 0.5;
    experiment.floor.friction = 0.5;
    let half_m = 0.5 * experiment.assembly.body_length_m;
    experiment.start = Start::State(State {
        position_world_m: Vector3::new(0.0, 0.0, half_m),
        velocity_world_m_s: Vector3::new(1.0, 0.0, 0.0),
        orientation_world_from_body: nalgebra::UnitQuaternion::identity(),
        angular_velocity_body_rad_s: Vector3::zeros(),
    });
    let stops_m = 1.0 / (2.0 * 0.5 * experiment.gravity_m_s2);
    for engine in [EngineChoice::new(&SLEDGES), EngineChoice::default()] {
        experiment.solver.engine = engine;
        let version = experiment.engine().version();
        let went_m = (run(&experiment)?.outcome.into_result()?)
            .net_displacement_world_m()
            .x;
        println!("{version}: {went_m:.4} m, v²/2µg is {stops_m:.4} m");
        if (went_m / stops_m - 1.0).abs() > 0.02 {
            return Err(Error::invalid("the cube slid otherwise than Coulomb says"));
        }
    }
    Ok(())
}
