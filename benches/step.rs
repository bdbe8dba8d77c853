//! Measures the cost of one simulation step for robots of growing size and both joint formulations, and of building the world.
//!
//! `cargo bench --bench step`; compare ratios, because absolute times differ between machines.

#![allow(
    clippy::expect_used,
    reason = "shipped files are sound, and a benchmark has no user to report an error to"
)]

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use realgap::robot::morphology::Morphology;
use realgap::simulation::{Experiment, JointFormulation, Sampling, run};

fn experiment(robot: &str) -> Experiment {
    let path = format!("{}/morphologies/{robot}.ron", env!("CARGO_MANIFEST_DIR"));
    let robot = Morphology::read(path).expect("a shipped robot is sound");
    let mut experiment = Experiment::new(robot.assemble());
    experiment.duration_s = 1.0;
    experiment.sampling = Sampling::Rate(30.0);
    experiment
}

fn step(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("simulated second");
    group.sample_size(20);
    for robot in ["cube", "chain3", "tripod", "chain5", "spider8", "chain30"] {
        for joint in [JointFormulation::Impulse, JointFormulation::Multibody] {
            if robot == "chain30" && joint == JointFormulation::Multibody {
                continue; // A third of a second each; its cost is in docs/validation.md.
            }
            let mut experiment = experiment(robot);
            experiment.solver.joint = joint;
            group.throughput(Throughput::Elements(
                (1.0 / experiment.solver.timestep_s) as u64,
            ));
            group.bench_function(BenchmarkId::new(robot, format!("{joint:?}")), |b| {
                b.iter(|| run(&experiment))
            });
        }
    }
    group.finish();

    let mut world = experiment("chain5");
    world.duration_s = 1.0 / 240.0;
    world.start = realgap::simulation::Start::State(realgap::trajectory::State {
        position_world_m: nalgebra::Vector3::new(0.0, 0.0, 1.0),
        orientation_world_from_body: nalgebra::UnitQuaternion::identity(),
        velocity_world_m_s: nalgebra::Vector3::zeros(),
        angular_velocity_body_rad_s: nalgebra::Vector3::zeros(),
    });
    criterion.bench_function("build a world and take one step, chain5", |b| {
        b.iter(|| run(&world))
    });
}

criterion_group!(benches, step);
criterion_main!(benches);
