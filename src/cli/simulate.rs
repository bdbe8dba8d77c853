//! `realgap simulate`: simulates one run of one robot.

use realgap::file::Source;
use realgap::report::SIMULATION;
use realgap::simulation::{
    Controller, Divergence, EnergyBalance, EngineChoice, Film, Outcome, Run, Sampling, film_with,
    run_with,
};
use realgap::trajectory;
use realgap::unit::decimals;

use super::kit::*;
use super::option::SolverOptions;
use super::replay::{Shown, check_replay, diverged};

/// Simulate one run of a robot from rest and print how it moved
///
/// Use it to try a robot, its gait or values of parameters, or to write a trajectory. The robot is placed on the
/// floor with its servos at their first command, comes to rest, and then follows its gait. `-o` writes the tracked
/// module's motion (.csv with velocities, or .tum).
///
/// Walls of an arena are 0.5 m high, its circles are polygons of sixteen corners, and a robot that would start deeper
/// than 5 mm in a wall is refused.
#[derive(Debug, Args)]
#[command(allow_negative_numbers = true)]
#[command(after_help = "\
Examples:
  realgap simulate morphologies/tripod.ron --duration 20 -o run.csv
  realgap simulate morphologies/tripod.ron --set floor.friction=0.4 --energy
  realgap simulate morphologies/tripod.ron --arena arenas/cartons.ron
  realgap simulate morphologies/tripod.ron \\
      --controller controllers/tripod_avoid.ron")]
pub struct Simulate {
    /// The robot, e.g. morphologies/tripod.ron
    morphology: PathBuf,
    /// Length of the run, seconds
    #[arg(long, value_name = "S", default_value_t = 10.0, value_parser = parse_seconds)]
    duration: f64,
    #[command(flatten)]
    solver: SolverOptions,
    /// Simulate among the walls of this arena, from its start pose; the motion is written with its start at (0, 0)
    #[arg(long, value_name = "FILE")]
    arena: Option<PathBuf>,
    /// Control the robot by its sensors, with the rules, the arena and the other robots of this controller file
    #[arg(long, value_name = "FILE", conflicts_with = "arena")]
    controller: Option<PathBuf>,
    /// Seed of the noise of sensors and radio; without a seed they read their mean
    #[arg(long, value_name = "SEED", requires = "controller")]
    seed: Option<u64>,
    /// Write readings, received messages and decisions to this .csv file
    #[arg(long, value_name = "FILE", requires = "controller")]
    decisions: Option<PathBuf>,
    #[command(flatten)]
    values: Values,
    /// Print the energy balance and the cost of transport
    #[arg(long)]
    energy: bool,
    /// Samples per second of the output
    #[arg(long, alias = "rate", value_name = "HZ", default_value_t = 60.0)]
    rate_hz: f64,
    /// Write the motion to this file
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Write the motion of every part and hinge to this .csv file: the columns of -o, `NAME_rad` and `NAME_rad_s` of every hinge, and
    /// `part0_x_m` to `part0_qz` and so on of every rigid part (part0 carries the root module, the others follow in the order of the
    /// hinges; origin at the centre of the part's first box, axes of the robot at zero angles)
    #[arg(long, value_name = "FILE")]
    parts: Option<PathBuf>,
    /// Write a replay of the run in space to this file: .html, .png, .mcap or .glb, as `replay` does
    #[arg(long, value_name = "FILE")]
    replay: Option<PathBuf>,
    #[command(flatten)]
    print: Print,
}

/// One run.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SimulateReport {
    /// Name of the robot.
    morphology: String,
    /// How the run ended.
    status: Status,
    /// Distance from the first to the last place on the floor, metres; nothing of a run that diverged.
    net_displacement_m: Option<f64>,
    /// From the first to the last place, world frame, metres.
    net_displacement_world_m: Option<[f64; 3]>,
    /// Length of the path on the floor, metres.
    path_length_m: Option<f64>,
    /// Direction of the net displacement, radians.
    heading_rad: Option<f64>,
    /// Change of the tracked module's heading, radians.
    turned_rad: Option<f64>,
    /// Error of the servos, root mean square, radians.
    servo_rms_rad: f64,
    /// Energy balance, where `--energy` was given.
    energy: Option<EnergyBalance>,
    /// Energy per metre of net displacement, J/m.
    joules_per_metre: Option<f64>,
    /// Energy per metre divided by the weight: the mechanical cost of transport.
    cost_of_transport: Option<f64>,
    /// CPU seconds.
    cpu_s: f64,
    /// Steps.
    steps: u64,
    /// Steps before the run, in which the robot came to rest.
    settle_steps: u64,
    /// Time simulated, seconds.
    simulated_s: f64,
    /// Simulated seconds per CPU second, including the time to come to rest.
    times_real_time: f64,
    /// Timestep, seconds.
    timestep_s: f64,
    /// Solver substeps per step.
    substeps: usize,
    /// Engine and its version.
    engine: &'static str,
    /// Version of the program.
    version: &'static str,
    /// What the reader should know.
    warnings: Vec<Warning>,
    /// The file that was written.
    output: Option<PathBuf>,
}

/// How a run ended.
#[derive(Serialize)]
#[serde(tag = "status", rename_all = "snake_case")]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
enum Status {
    /// It ran as long as was asked for.
    Completed,
    /// The simulation blew up.
    Diverged {
        /// When it blew up, seconds of simulated time.
        at_s: f64,
        /// What was seen of it.
        why: String,
    },
}

impl Status {
    fn of(run: &Run) -> Self {
        match &run.outcome {
            Outcome::Completed(_) => Self::Completed,
            Outcome::Diverged(Divergence { at_s, why }) => Self::Diverged {
                at_s: *at_s,
                why: why.to_string(),
            },
        }
    }
}

impl Simulate {
    pub fn run(self) -> Result<()> {
        let morphology = read_morphology(&self.morphology)?;
        let mut experiment = Experiment::new(morphology.assemble());
        experiment.duration_s = self.duration;
        experiment.sampling = Sampling::Rate(self.rate_hz);
        if let Some(path) = &self.arena {
            experiment.enter_arena(&Source::read(path, "arena")?)?;
        }
        if let Some(path) = &self.controller {
            let controller = Controller::read(path, &experiment)?;
            experiment = experiment.with_controller(controller)?;
            experiment.perturbation.draw = self.seed.map(|seed| (seed, 0));
        }
        terminal::print_warnings(&morphology.warnings());
        let (experiment, warnings) = self.values.apply(&experiment)?;
        terminal::print_warnings(&warnings);
        let mut experiment = self.solver.apply(experiment);
        for output in self.output.iter().chain(&self.parts) {
            trajectory::check_output(output)?;
        }
        let files = [&self.output, &self.parts, &self.decisions];
        output::check_all(files.into_iter().flatten())?;
        if let Some(page) = &self.replay {
            check_replay(page)?;
        }
        if self.energy {
            experiment.energy_from_s = Some(0.0);
        }
        experiment.check().map_err(Error::into_usage)?;
        let (run, film, log) = progress::during_one(self.duration, |hooks| {
            if self.parts.is_some() || self.replay.is_some() {
                return film_with(&experiment, hooks);
            }
            let (run, log) = run_with(&experiment, hooks)?;
            Ok((run, None, log))
        })?;
        terminal::print_warnings(&run.warnings);
        if let (Some(output), Some(motion)) = (&self.output, run.outcome.get()) {
            if log.others.is_empty() {
                terminal::print_warnings(&trajectory::write(output, motion)?);
            } else {
                trajectory::write_with_bodies(output, motion, &log.others)?;
            }
        }
        if let (Some(file), Some(controller)) = (&self.decisions, &experiment.controller) {
            output::write(file, log.to_csv(controller).as_bytes())?;
        }
        if let Some(film) = &film {
            self.write_film(&morphology, &experiment, film, &run.warnings)?;
        }
        self.print(&morphology, &experiment, &run)?;
        match &run.outcome {
            Outcome::Completed(_) => Ok(()),
            Outcome::Diverged(divergence) => Err(diverged(divergence, &self.morphology)),
        }
    }

    /// Writes all parts into a file, and the replay.
    fn write_film(
        &self,
        morphology: &Morphology,
        experiment: &Experiment,
        film: &Film,
        warnings: &[Warning],
    ) -> Result<()> {
        if let Some(parts) = &self.parts {
            trajectory::write_with_bodies(parts, &film.track, &film.bodies()?)?;
        }
        let Some(page) = &self.replay else {
            return Ok(());
        };
        let mut files = vec![self.morphology.as_path()];
        files.extend(self.arena.as_deref());
        files.extend(self.controller.as_deref());
        let all: Vec<Warning> = morphology
            .warnings()
            .iter()
            .chain(warnings)
            .cloned()
            .collect();
        Shown {
            morphology: Some(morphology),
            film,
            name: SIMULATION,
            experiment: Some(experiment),
            recordings: &[],
            align: true,
            warnings: &all,
            files: &files,
        }
        .write(page)?;
        Ok(())
    }

    fn print(&self, morphology: &Morphology, experiment: &Experiment, run: &Run) -> Result<()> {
        let simulated_s = run.steps as f64 * experiment.solver.timestep_s;
        let cpu_s = run.cpu.as_secs_f64();
        let whole_s = (run.steps + run.settle_steps) as f64 * experiment.solver.timestep_s;
        let times_real = whole_s / cpu_s.max(1e-9);
        let motion = run.outcome.get();
        let net_m = motion.map(|t| t.net_displacement_world_m());
        let path_m = motion.map(|t| t.path_length_xy_m());
        let turned_rad = motion.and_then(|t| t.turned_rad());
        let weight_n = morphology.summary().mass_kg * experiment.gravity_m_s2;
        let cost = run.energy.zip(net_m).and_then(|(energy, net)| {
            let transport = energy.cost_of_transport(weight_n, net.xy().norm())?;
            Some((transport * weight_n, transport))
        });
        if self.print.is_json() {
            return terminal::print_answer(&SimulateReport {
                morphology: morphology.name().to_owned(),
                status: Status::of(run),
                net_displacement_m: net_m.map(|d| d.xy().norm()),
                net_displacement_world_m: net_m.map(|d| [d.x, d.y, d.z]),
                path_length_m: path_m,
                heading_rad: net_m.map(|d| d.y.atan2(d.x)),
                turned_rad,
                servo_rms_rad: run.servo_rms_rad,
                energy: run.energy,
                joules_per_metre: cost.map(|(joules_per_metre, _)| joules_per_metre),
                cost_of_transport: cost.map(|(_, transport)| transport),
                cpu_s,
                steps: run.steps,
                settle_steps: run.settle_steps,
                simulated_s,
                times_real_time: times_real,
                timestep_s: experiment.solver.timestep_s,
                substeps: experiment.solver.substeps,
                engine: experiment.engine_version(),
                version: env!("CARGO_PKG_VERSION"),
                warnings: run.warnings.clone(),
                output: self.output.clone(),
            });
        }
        let mut lines = vec![format!(
            "{}: {simulated_s:.2} s simulated",
            morphology.name()
        )];
        if let (Some(net), Some(path)) = (net_m, path_m) {
            lines.push(format!(
                "  net displacement  {}",
                quantity(net.xy().norm(), Unit::Metre)
            ));
            lines.push(format!(
                "  path length       {}",
                quantity(path, Unit::Metre)
            ));
            lines.push(format!(
                "  heading           {} deg (direction of the net displacement)",
                decimals(net.y.atan2(net.x).to_degrees(), 1)
            ));
            if let Some(turned) = turned_rad {
                lines.push(format!(
                    "  turned            {} deg (change of the tracked module's heading)",
                    decimals(turned.to_degrees(), 1)
                ));
            }
            let mut hinges = experiment.assembly.hinges.iter();
            if hinges.any(|hinge| hinge.actuator.is_some()) {
                lines.push(format!(
                    "  servo error       {:.2} deg rms",
                    run.servo_rms_rad.to_degrees()
                ));
            }
        }
        if let Some(energy) = &run.energy {
            lines.push(energy_line(energy));
            if let Some((joules_per_metre, transport)) = cost {
                lines.push(format!(
                    "  energy per metre  {joules_per_metre:.3} J/m, cost of transport {transport:.3}"
                ));
            }
        }
        lines.push(format!(
            "  cost              {:.3} s CPU, {} steps + {} to settle, {times_real:.0} x real time",
            cpu_s, run.steps, run.settle_steps
        ));
        if experiment.solver.engine != EngineChoice::default() {
            lines.push(format!(
                "  engine            {}",
                experiment.engine_version()
            ));
        }
        if let (Some(output), Some(motion)) = (&self.output, run.outcome.get()) {
            lines.push(format!(
                "  written           {} ({} samples)",
                output.display(),
                motion.len()
            ));
        }
        for file in [&self.parts, &self.replay, &self.decisions]
            .into_iter()
            .flatten()
        {
            lines.push(format!("  written           {}", file.display()));
        }
        terminal::print(lines.join("\n"));
        Ok(())
    }
}

/// The balance in one line, for people.
fn energy_line(energy: &EnergyBalance) -> String {
    format!(
        "  energy            servos {:.4} J (gave {:.4} J), gravity {:.4} J, contacts {:.4} J, friction {:.4} J, hinges {:.4} J; \
         kinetic {:+.4} J, unexplained {:+.4} J",
        energy.servo_j,
        energy.servo_positive_j,
        energy.gravity_j,
        energy.contact_j,
        energy.friction_j,
        energy.joint_j + energy.slack_j,
        energy.kinetic_j,
        energy.residual_j
    )
}
