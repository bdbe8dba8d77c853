//! `realgap check`: validates files and prints what they contain.

mod controller;
mod dynamics;
mod joints;
pub mod report;
#[cfg(feature = "papers")]
mod scene;
mod sensing;

use realgap::calibration::{
    CommandConsent, Definition, Each, Overrides, OwnSimulator, read_parameters,
};
use realgap::file::Source;
use realgap::robot::genome::Individual;
use realgap::robot::import::is_foreign;
use realgap::search::{self, Search};
use realgap::sensing::arena::Arena;
use realgap::text::shown;
use realgap::trajectory::Reading;
use realgap::verification::known_limits;
use realgap::warning::Code;
use realgap::{results::draw_arena, results::portrait, trajectory};

use super::consent::ConsentOption;
use super::kind::Kind;
use super::kit::*;
use super::option::Format;
use super::question;
use report::{FileReport, Motion, Outcome, Varied};

/// Validate files of realgap and recordings, and print what they contain
///
/// Use it before any other command, on robots, genomes, studies, searches, parameter files, arenas, sensors,
/// controllers, scenes and recordings. An error names the place in the file, what was found there, and how to correct
/// it. For a study, the command prints the number of simulations and an estimate of their time, measured on a part of
/// one simulation.
///
/// --plot draws a robot with its plates in vermillion and the direction of positive angles. Where a module is glued
/// onto a driven face, a band around the end of the cube marks that face: orange where it spins, yellow where it
/// bends.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  realgap check morphologies/tripod.ron --plot robot.png
  realgap check sweeps/*.ron runs/*.csv
  realgap check arenas/paper000.ron --plot arena.png
  realgap check controllers/tripod_avoid.ron --robot morphologies/tripod.ron")]
pub struct Check {
    /// Files: .ron, or recordings such as .csv and .tum
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    #[command(flatten)]
    reading: ReadingOptions,
    #[command(flatten)]
    consent: ConsentOption,
    /// Check controllers against this robot: the modules that carry sensors, the names of servos, and that every robot starts clear
    /// of walls
    #[arg(long, value_name = "FILE")]
    robot: Option<PathBuf>,
    /// Draw the robot or arena into this file (.png or .svg); for one morphology, genome, arena or controller
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    /// How to print
    #[arg(long, value_enum, default_value_t)]
    format: Format,
    /// With --format json: masses, poses and mass matrix of a robot at N sets of joint coordinates
    #[arg(long, value_name = "N", default_value_t = 0, hide = true)]
    dynamics: usize,
}

/// Texts from files are cut to this many characters.
const SHOWN: usize = 1000;
/// A sweep that takes longer on one core is not what anybody will run.
const LONG_SWEEP_S: f64 = 86_400.0;

/// The contents of a valid file: lines for people, and details for JSON.
struct Contents {
    kind: Kind,
    lines: Vec<String>,
    details: report::Contents,
    warnings: Vec<Warning>,
}

impl Check {
    pub fn run(self) -> Result<u8> {
        if let Some(plot) = &self.plot {
            self.draw(plot)?;
        }
        let mut reports = Vec::new();
        let mut failed = 0;
        for (index, path) in self.files.iter().enumerate() {
            let reading = self.reading.of_path(path, index, self.files.len())?;
            let found = self.describe(path, &reading);
            if let Err(error) = &found {
                failed += 1;
                terminal::print_error(error);
            }
            match (self.format, found) {
                (Format::Json, found) => reports.push(report(path, found)),
                (Format::Table, Ok(contents)) => {
                    let warnings = contents.warnings.iter().map(|w| format!("  warning: {w}"));
                    let lines: Vec<String> = contents.lines.into_iter().chain(warnings).collect();
                    terminal::print(format!("{}: ok\n{}", path.display(), lines.join("\n")));
                }
                (Format::Table, Err(_)) => {}
            }
        }
        if self.format == Format::Json {
            terminal::print_answers(&reports)?;
        }
        if failed > 0 {
            if self.files.len() > 1 {
                terminal::note(format!(
                    "{failed} of {} files are not sound",
                    self.files.len()
                ));
            }
            return Ok(1);
        }
        Ok(0)
    }

    fn describe(&self, path: &Path, reading: &Reading) -> Result<Contents> {
        // Without consent a study's command is only read about.
        let consent = self.consent.or(CommandConsent::ReadOnly);
        describe(
            path,
            reading,
            (self.dynamics, consent),
            self.robot.as_deref(),
        )
    }

    fn draw(&self, plot: &Path) -> Result<()> {
        output::check_pictures(&self.plot)?;
        let [path] = self.files.as_slice() else {
            return Err(Error::usage("--plot draws one robot")
                .found(format!("{} files", self.files.len()))
                .allowed("one morphology, genome, arena or controller"));
        };
        let source = Source::read(path, "morphology")?;
        match Kind::of_ron(&source) {
            Some(Kind::Arena) => draw_arena(&Arena::parse(&source)?, plot)?,
            Some(Kind::Controller) => controller::draw(&source, self.robot.as_deref(), plot)?,
            Some(Kind::Genome) => {
                let robot = Individual::parse(&source)?.develop();
                portrait::draw(&robot.map_err(|m| Error::from(m).at_file(path))?, plot)?;
            }
            _ => portrait::draw(&Morphology::parse(&source)?, plot)?,
        }
        terminal::note(format!("drawn: {}", plot.display()));
        Ok(())
    }
}

fn report(path: &Path, found: Result<Contents>) -> FileReport {
    let sound = found.map(|found| Outcome::Sound {
        kind: found.kind.name(),
        contents: Box::new(found.details),
        warnings: found.warnings,
    });
    FileReport {
        file: path.to_owned(),
        ok: sound.is_ok(),
        outcome: sound.unwrap_or_else(|error| Outcome::wrong(&error)),
    }
}

fn describe(
    path: &Path,
    reading: &Reading,
    (dynamics, consent): (usize, CommandConsent),
    robot: Option<&Path>,
) -> Result<Contents> {
    if path.is_dir() && !trajectory::is_data_set(path) {
        let folder = path.display();
        return Err(
            Error::invalid("this is a folder, and files are checked one by one")
                .at_file(path)
                .hint(format!(
                    "name the files in it, e.g. realgap check {folder}/*.ron or {folder}/*.csv"
                )),
        );
    }
    if path.extension().is_none_or(|extension| extension != "ron") && !is_foreign(path) {
        return motion(path, reading);
    }
    let source = Source::read(path, "RON file")?;
    if is_foreign(path) {
        return morphology(&source, dynamics);
    }
    match Kind::of_ron(&source) {
        Some(Kind::Morphology) => morphology(&source, dynamics),
        Some(Kind::Genome) => genome(&source),
        Some(Kind::Study) => study(path, consent),
        Some(Kind::Search) => search(path),
        Some(Kind::Parameters) => parameters(path),
        Some(Kind::Meta) => meta(path),
        Some(Kind::Arena) => sensing::arena(&source),
        Some(Kind::Sensor) => sensing::sensor(&source),
        Some(Kind::Vehicle) => sensing::vehicle(path),
        Some(Kind::Radio) => sensing::radio(&source),
        Some(Kind::Controller) => controller::describe(&source, robot),
        #[cfg(feature = "papers")]
        Some(Kind::Scene) => scene::describe(&source),
        Some(Kind::Sensorgraph) => sensing::sensorgraph(path),
        _ => Err(Error::invalid("not a file that realgap knows")
            .at_file(path)
            .allowed("a morphology (modules, glue), a genome (modules, genes), a study (morphology, parameters), a search (strategy), a parameter file (parameters) or a meta.ron (robot, source)")),
    }
}

fn morphology(source: &Source, dynamics: usize) -> Result<Contents> {
    let robot = Morphology::parse(source)?;
    let summary = robot.summary();
    let size = summary.size_m();
    let assembly = robot.assemble();
    let pieces = match assembly.is_modular {
        true => counted(summary.modules, "module"),
        false => format!("{} bodies", summary.modules),
    };
    let lines = vec![
        format!(
            "  morphology \"{}\": {}, {}, {}",
            robot.name(),
            pieces,
            counted(summary.hinges, "hinge"),
            counted(summary.parts, "rigid part")
        ),
        format!("  mass          {:.4} kg", summary.mass_kg),
        format!(
            "  bounding box  {:.4} x {:.4} x {:.4} m at zero servo angles",
            size[0], size[1], size[2]
        ),
        format!(
            "  tracked       \"{}\", body length {:.4} m",
            robot.modules()[robot.track()].name,
            summary.body_length_m
        ),
    ];
    Ok(Contents {
        kind: Kind::Morphology,
        lines,
        details: report::Contents::Morphology {
            name: robot.name().to_owned(),
            modules: summary.modules,
            hinges: summary.hinges,
            parts: summary.parts,
            mass_kg: summary.mass_kg,
            size_m: [size[0], size[1], size[2]],
            track: robot.modules()[robot.track()].name.clone(),
            body_length_m: summary.body_length_m,
            dynamics: dynamics::states(&assembly, dynamics),
        },
        warnings: [
            robot.warnings(),
            known_limits(&Experiment::new(assembly), &[]),
        ]
        .concat(),
    })
}

fn genome(source: &Source) -> Result<Contents> {
    let individual = Individual::parse(source)?;
    let modules = individual.genome.len();
    let (outcome, misfit) = match individual.develop() {
        Ok(robot) => (
            format!(
                "develops into a robot of {:.4} kg with {}",
                robot.summary().mass_kg,
                counted(robot.summary().hinges, "hinge")
            ),
            None,
        ),
        Err(misfit) => (
            format!("does not develop: {misfit} [{}]", misfit.code()),
            Some(misfit.code()),
        ),
    };
    Ok(Contents {
        kind: Kind::Genome,
        lines: vec![
            format!(
                "  genome \"{}\": {}",
                individual.name,
                counted(modules, "module")
            ),
            format!("  {outcome}"),
        ],
        details: report::Contents::Genome {
            name: individual.name,
            modules,
            misfit,
        },
        warnings: Vec::new(),
    })
}

/// What a study's own simulator is, and whether it was asked.
fn simulator_lines(own: &OwnSimulator) -> Vec<String> {
    let mut lines = Vec::new();
    if let Some(command) = own.command() {
        let folder = command.folder().display();
        lines.push(format!(
            "  command       {} (in {folder})",
            shown(&command.to_string(), SHOWN)
        ));
        for (file, hash) in command.files() {
            lines.push(format!("  file          {file}, sha256 {hash}"));
        }
    }
    match own.guest() {
        None => lines.push(
            "  the command was not run: its parameters were not checked (--allow-command)"
                .to_owned(),
        ),
        Some(guest) => {
            let hello = guest.hello();
            for parameter in &hello.parameters {
                lines.push(format!(
                    "  declares      {} from {} to {} {}, {} by default",
                    shown(&parameter.name, SHOWN),
                    parameter.from,
                    parameter.to,
                    shown(&parameter.unit, SHOWN),
                    parameter.default
                ));
            }
        }
    }
    lines
}

fn study(path: &Path, consent: CommandConsent) -> Result<Contents> {
    let overrides = Overrides {
        command: consent,
        ..Overrides::default()
    };
    let study = Definition::read_without_recordings(path, &overrides)?;
    let whose = match study.own_simulator {
        Some(_) => "own simulator",
        None => "robot",
    };
    let mut lines = vec![format!(
        "  study of the {whose} \"{}\", metric {} in {}",
        study.morphology.name(),
        study.metric.name(),
        study.metric.unit()
    )];
    lines.extend(study.own_simulator.iter().flat_map(simulator_lines));
    let is_asked = study
        .own_simulator
        .as_ref()
        .is_none_or(|own| own.guest().is_some());
    let mut ranges = Vec::new();
    for (index, range) in study.grid.ranges().iter().enumerate() {
        let each = match study.each.get(index) {
            Some(Each::Run) => ", for every run",
            _ => "",
        };
        lines.push(format!(
            "  {:<24} {} to {}, {} points{each}",
            range.parameter.label(),
            range.from,
            range.to,
            range.points
        ));
        ranges.push(Varied {
            name: range.parameter.name,
            from: range.from,
            to: range.to,
            points: range.points,
        });
    }
    let points = study.grid.len();
    let (robot, metric) = (study.morphology.name().to_owned(), study.metric);
    let contents = |lines, warnings, (recordings, simulations, cpu_s), parameters| Contents {
        kind: Kind::Study,
        lines,
        details: report::Contents::Study {
            robot: robot.clone(),
            metric: metric.name(),
            unit: metric.unit(),
            parameters,
            points,
            recordings,
            simulations,
            cpu_s,
        },
        warnings,
    };
    let (mut recordings, mut simulations, mut cpu_s) = (None, None, None);
    let mut warnings = Vec::new();
    let names_none = study.recording_globs.is_empty();
    match study.find_recordings(path, &overrides) {
        Ok(whole) => {
            let given = whole.recordings.len();
            let study = realgap::calibration::Study::new(whole)?;
            let runs = study.sweep_runs().checked_mul(study.cases().len());
            recordings = Some(given);
            let given = counted(given, "recording");
            warnings = study.warnings().to_vec();
            if !is_asked {
                lines.push(format!("  {given}, {}", counted(points, "point")));
                return Ok(contents(lines, warnings, (recordings, None, None), ranges));
            }
            let one = study.cpu_s_per_point()?;
            let cost_s = one * study.sweep_runs() as f64;
            if let Some(runs) = runs {
                let (points, all) = (counted(points, "point"), counted(runs, "simulation"));
                (simulations, cpu_s) = (Some(runs), Some(cost_s));
                let estimated = "estimated from a part of one simulation on this machine";
                lines.push(match cost_s > LONG_SWEEP_S {
                    false => format!(
                        "  {given}, {points}, {all}\n  about {cost_s:.0} CPU s for a sweep ({one:.3} s per point and setting, {estimated})"
                    ),
                    true => format!(
                        "  {given}, and more points than a sweep simulates in a day of one core: use realgap tune\n  about {one:.3} CPU s per point and setting, {estimated}"
                    ),
                });
            } else {
                lines.push(format!(
                    "  {given}, more points than a sweep can simulate: use realgap tune"
                ));
                lines.push(format!(
                    "  about {one:.3} CPU s per point, estimated from a part of one simulation on this machine"
                ));
            }
            let grid = &study.definition().grid;
            let tuned: Vec<&str> = grid.ranges().iter().map(|r| r.parameter.name).collect();
            let middle = study.experiment(0, &grid.values(points / 2))?;
            if middle.has_engine() {
                warnings.extend(known_limits(&middle, &tuned));
            }
        }
        Err(error) if names_none => {
            lines.push(format!(
                "  {}; {}",
                counted(points, "point"),
                error.message()
            ));
        }
        Err(error) => return Err(error),
    }
    Ok(contents(
        lines,
        warnings,
        (recordings, simulations, cpu_s),
        ranges,
    ))
}

fn search(path: &Path) -> Result<Contents> {
    let search = Search::read(path, &search::Overrides::default())?;
    let robots = search.strategy().budget();
    Ok(Contents {
        kind: Kind::Search,
        lines: vec![
            format!(
                "  search by {}: {}, {} each of {} s",
                search.strategy().name(),
                counted(robots, "robot"),
                counted(search.repeats(), "repeat"),
                search.duration_s()
            ),
            format!("  maximises: {}", search.objective().label()),
        ],
        details: report::Contents::Search {
            strategy: search.strategy().name(),
            robots,
            repeats: search.repeats(),
            duration_s: search.duration_s(),
            objective: search.objective().label(),
            unit: search.objective().measure.unit(),
            seed: search.seed(),
        },
        warnings: Vec::new(),
    })
}

fn parameters(path: &Path) -> Result<Contents> {
    let set = read_parameters(path)?;
    let lines = set
        .iter()
        .map(|a| format!("  {:<24} {}", a.parameter.label(), a.value))
        .collect();
    let parameters = set.iter().map(|a| (a.parameter.name, a.value)).collect();
    Ok(Contents {
        kind: Kind::Parameters,
        lines,
        details: report::Contents::Parameters { parameters },
        warnings: Vec::new(),
    })
}

fn meta(path: &Path) -> Result<Contents> {
    let meta = trajectory::read_meta(path)?;
    let lines = vec![
        format!(
            "  recordings of the robot \"{}\", source {:?}",
            shown(&meta.robot, SHOWN),
            meta.source
        ),
        format!("  {}", shown(&meta.description, SHOWN)),
        format!(
            "  frame {}, licence {}",
            shown(&meta.frame, SHOWN),
            shown(&meta.licence, SHOWN)
        ),
    ];
    Ok(Contents {
        kind: Kind::Meta,
        lines,
        details: report::Contents::Meta {
            source: format!("{:?}", meta.source),
            robot: meta.robot,
            description: meta.description,
            frame: meta.frame,
            licence: meta.licence,
        },
        warnings: Vec::new(),
    })
}

fn motion(path: &Path, reading: &Reading) -> Result<Contents> {
    let mut lines = Vec::new();
    let mut recordings = Vec::new();
    let mut warnings = Vec::new();
    for recording in question::read_all(path, reading)? {
        let motion = &recording.trajectory;
        let prepared = trajectory::prepare(motion).map_err(|e| e.at_file(path))?;
        let has_orientations = motion.orientations_world_from_body().is_some();
        let has_velocities = motion.velocities_world_m_s().is_some();
        let columns = match (has_orientations, has_velocities) {
            (true, true) => "positions, orientations and velocities",
            (true, false) => "positions and orientations",
            _ => "positions",
        };
        let net_m = motion.net_displacement_world_m().xy().norm();
        let is_of_joints = motion.is_of_joints();
        let path = format!(
            "{columns}; net displacement {net_m:.4} m, path {:.4} m",
            motion.path_length_xy_m()
        );
        let joints = joints::shown_joints(motion);
        let what = match (is_of_joints, joints) {
            (true, Some(joints)) => joints,
            (false, Some(joints)) => format!("{path}; {joints}"),
            (_, None) => path,
        };
        lines.push(format!(
            "  {}: {} over {:.3} s, {what}",
            shown(&recording.name, SHOWN),
            counted(motion.len(), "sample"),
            motion.duration_s(),
        ));
        recordings.push(Motion {
            name: recording.name.clone(),
            samples: motion.len(),
            duration_s: motion.duration_s(),
            orientations: has_orientations,
            velocities: has_velocities,
            net_displacement_m: net_m,
            path_length_m: motion.path_length_xy_m(),
        });
        warnings.extend(
            recording
                .warnings
                .iter()
                .chain(prepared.warnings())
                // Joints alone have no path whose heading could be missed.
                .filter(|warning| !is_of_joints || warning.code != Code::UndefinedHeading)
                .cloned(),
        );
    }
    Ok(Contents {
        kind: Kind::Trajectory,
        lines,
        details: report::Contents::Trajectories { recordings },
        warnings,
    })
}
