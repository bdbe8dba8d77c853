//! `realgap check`: is a file of ours sound, and what is in it?

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use realgap::file::Source;
use realgap::genome::Specimen;
use realgap::morphology::Morphology;
use realgap::quantity::LengthUnit;
use realgap::study::{Overrides, StartRule, Study, read_parameters};
use realgap::{Error, Result, portrait, report, trajectory};

use super::option::UnitOption;
use super::terminal;

/// Validate morphologies, genomes, studies, parameter files and trajectories, and print what they hold
#[derive(Debug, Args)]
pub struct Check {
    /// Files: .ron, .csv or .tum
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Unit of length of trajectories
    #[arg(long, value_enum, default_value_t)]
    unit: UnitOption,
    /// Draw the robot into this file (.png or .svg); for one morphology or genome
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
}

impl Check {
    pub fn run(self) -> Result<ExitCode> {
        if let Some(plot) = &self.plot {
            self.draw(plot)?;
        }
        let mut failed = 0;
        for path in &self.files {
            match describe(path, LengthUnit::from(self.unit)) {
                Ok(text) => terminal::print(format!("{}: ok\n{text}", path.display())),
                Err(error) => {
                    failed += 1;
                    terminal::print_error(&error);
                }
            }
        }
        if failed > 0 {
            if self.files.len() > 1 {
                terminal::note(format!(
                    "{failed} of {} files are not sound",
                    self.files.len()
                ));
            }
            return Ok(ExitCode::FAILURE);
        }
        Ok(ExitCode::SUCCESS)
    }

    fn draw(&self, plot: &Path) -> Result<()> {
        report::check_picture_path(plot)?;
        let [path] = self.files.as_slice() else {
            return Err(Error::usage("--plot draws one robot")
                .found(format!("{} files", self.files.len()))
                .allowed("one morphology or genome"));
        };
        let source = Source::read(path, "morphology")?;
        let robot = if source.locate("genes").is_some() {
            let specimen = Specimen::parse(&source)?;
            specimen
                .develop()
                .map_err(|m| Error::from(m).at_file(path))?
        } else {
            Morphology::parse(&source)?
        };
        portrait::draw(&robot, plot)?;
        terminal::note(format!("drawn: {}", plot.display()));
        Ok(())
    }
}

fn describe(path: &Path, unit: LengthUnit) -> Result<String> {
    if path.extension().is_some_and(|extension| extension == "ron") {
        let source = Source::read(path, "RON file")?;
        let has = |field: &str| source.locate(field).is_some();
        if has("genes") {
            return genome(&source);
        }
        return match (has("modules"), has("morphology"), has("parameters"), has("robot")) {
            (true, ..) => morphology(&source),
            (_, true, ..) => study(path),
            (_, _, true, _) => parameters(path),
            (_, _, _, true) => meta(path),
            _ => Err(Error::invalid("not a file of ours")
                .at_file(path)
                .allowed("a morphology (modules, glue), a genome (modules, genes), a study (morphology, parameters), a parameter file (parameters) or a meta.ron (robot, source)")),
        };
    }
    motion(path, unit)
}

fn morphology(source: &Source) -> Result<String> {
    let robot = Morphology::parse(source)?;
    let summary = robot.summary();
    let size = summary.size_m();
    let mut lines = vec![
        format!(
            "  morphology \"{}\": {} modules, {} hinges, {} rigid parts",
            robot.name(),
            summary.modules,
            summary.hinges,
            summary.parts
        ),
        format!("  mass          {:.4} kg", summary.mass_kg),
        format!(
            "  bounding box  {:.4} x {:.4} x {:.4} m at zero servo angles",
            size[0], size[1], size[2]
        ),
        format!(
            "  tracked       \"{}\", body length {:.4} m",
            robot.track(),
            summary.body_length_m
        ),
    ];
    lines.extend(robot.warnings().iter().map(|w| format!("  warning: {w}")));
    Ok(lines.join("\n"))
}

fn genome(source: &Source) -> Result<String> {
    let specimen = Specimen::parse(source)?;
    let outcome = match specimen.develop() {
        Ok(robot) => format!(
            "develops into a robot of {:.4} kg with {} hinges",
            robot.summary().mass_kg,
            robot.summary().hinges
        ),
        Err(misfit) => format!("does not develop: {misfit} [{}]", misfit.code()),
    };
    Ok(format!(
        "  genome \"{}\": {} modules\n  {outcome}",
        specimen.name,
        specimen.genome.len()
    ))
}

fn study(path: &Path) -> Result<String> {
    let study = Study::read_without_recordings(path, &Overrides::default())?;
    let mut lines = vec![format!(
        "  study of the robot \"{}\", metric {} in {}",
        study.morphology.name(),
        study.metric.name(),
        study.metric.unit()
    )];
    for range in study.grid.ranges() {
        lines.push(format!(
            "  {:<24} {} to {}, {} points",
            range.parameter.label(),
            range.from,
            range.to,
            range.points
        ));
    }
    let points = study.grid.len();
    match Study::read(path, &Overrides::default()) {
        Ok(whole) => {
            let simulations = match whole.start {
                StartRule::Settled => points,
                StartRule::FromRecording => points * whole.recordings.len(),
            };
            let problem = realgap::study::Problem::new(whole)?;
            let one = time_one(&problem)?;
            lines.push(format!(
                "  {} recordings, {points} points, {simulations} simulations",
                problem.study().recordings.len()
            ));
            lines.push(format!(
                "  about {:.0} CPU s ({:.3} s a point, measured on this machine just now)",
                one * points as f64,
                one
            ));
            lines.extend(problem.warnings().iter().map(|w| format!("  warning: {w}")));
        }
        Err(error) if study.recording_globs.is_empty() => {
            lines.push(format!("  {points} points; {}", error.message()));
        }
        Err(error) => return Err(error),
    }
    Ok(lines.join("\n"))
}

/// CPU seconds of one point in the middle of the grid.
fn time_one(problem: &realgap::study::Problem) -> Result<f64> {
    let values = problem.study().grid.values(problem.study().grid.len() / 2);
    let run = realgap::simulation::run(&problem.experiment(0, &values)?)?;
    let share = problem.simulated_s() / problem.cases()[0].experiment.duration_s;
    Ok(run.cpu.as_secs_f64() * share)
}

fn parameters(path: &Path) -> Result<String> {
    let set = read_parameters(path)?;
    let lines: Vec<String> = set
        .iter()
        .map(|a| format!("  {:<24} {}", a.parameter.label(), a.value))
        .collect();
    Ok(lines.join("\n"))
}

fn meta(path: &Path) -> Result<String> {
    let meta = trajectory::read_meta(path)?;
    Ok(format!(
        "  recordings of the robot \"{}\", source {:?}\n  {}\n  frame {}, licence {}",
        meta.robot, meta.source, meta.description, meta.frame, meta.licence
    ))
}

fn motion(path: &Path, unit: LengthUnit) -> Result<String> {
    let mut lines = Vec::new();
    for recording in trajectory::read_all(path, unit)? {
        let motion = &recording.trajectory;
        let prepared = trajectory::prepare(motion).map_err(|e| e.at_file(path))?;
        let columns = match (
            motion.orientations_world_from_body(),
            motion.velocities_world_m_s(),
        ) {
            (Some(_), Some(_)) => "positions, orientations and velocities",
            (Some(_), None) => "positions and orientations",
            _ => "positions",
        };
        lines.push(format!(
            "  {}: {} samples over {:.3} s, {columns}; net displacement {:.4} m, path {:.4} m",
            recording.name,
            motion.len(),
            motion.duration_s(),
            motion.net_displacement_world_m().xy().norm(),
            motion.path_length_xy_m(),
        ));
        let warnings = recording.warnings.iter().chain(prepared.warnings());
        lines.extend(warnings.map(|w| format!("  warning: {w}")));
    }
    Ok(lines.join("\n"))
}
