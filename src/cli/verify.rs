//! `realgap verify`: checks the simulator against closed forms, with the user's settings.

use realgap::robot::morphology::Assembly;
use realgap::simulation::EngineChoice;
use realgap::verification::{self, Check, CheckResult, Limit, Settings, Tolerance};

use super::kit::*;
use super::option::SolverOptions;

/// Check the simulator against closed-form solutions, with the settings given
///
/// Use it to see whether a timestep, a number of substeps or an engine is accurate enough. The checks cover stopping
/// distance, slip angle, bounce height, pendulum, servo limits, hinges and more; docs/validation.md explains each.
/// Checks that involve hinges run with both formulations of joints unless --joint chooses one. Exit code 0: all
/// checks passed, or only known limits failed; 1: another check failed.
#[derive(Debug, Args)]
#[command(allow_negative_numbers = true, mut_arg("joint", |arg| arg.help("Check hinges with this formulation of joints only")))]
#[command(after_help = "\
Examples:
  realgap verify
  realgap verify --timestep 0.002 --substeps 4 --strict")]
pub struct Verify {
    #[command(flatten)]
    solver: SolverOptions,
    #[command(flatten)]
    values: Values,
    /// Count known limits as failures, too
    #[arg(long)]
    strict: bool,
    #[command(flatten)]
    print: Print,
}

/// Results of the checks.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct VerifyReport<'a> {
    /// Timestep, seconds.
    timestep_s: f64,
    /// Solver substeps per step.
    substeps: usize,
    /// Kinds of joint.
    joints: Vec<String>,
    /// Number of checks that passed.
    passed: usize,
    /// Number of checks that failed.
    failed: usize,
    /// Failed checks whose error and reason are known.
    known_limits: Vec<KnownLimit>,
    /// The checks.
    checks: &'a [Check],
    /// Engine and its version.
    engine: &'static str,
    /// Version of the program.
    version: &'static str,
}

/// A check that fails for a known reason.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct KnownLimit {
    /// Name of the check.
    name: &'static str,
    /// Smallest and largest error that the reason explains, in the terms of the check's tolerance.
    error: (f64, f64),
    /// The reason.
    why: &'static str,
}

impl Verify {
    pub fn run(self) -> Result<u8> {
        let settings = self.settings()?;
        let checks = verification::run(&settings)?;
        let failed = checks
            .iter()
            .filter(|c| c.verdict == CheckResult::Fail)
            .count();
        let known: Vec<&Limit> = checks
            .iter()
            .filter_map(|check| Limit::of(check, settings.solver.engine))
            .collect();
        let unexpected = failed - known.len();
        if self.print.is_json() {
            let joints: Vec<String> = settings
                .kinds()
                .iter()
                .map(|kind| format!("{kind:?}").to_lowercase())
                .collect();
            let limits = known.iter().map(|limit| KnownLimit {
                name: limit.name,
                error: limit.error,
                why: limit.why,
            });
            terminal::print_answer(&VerifyReport {
                timestep_s: settings.solver.timestep_s,
                substeps: settings.solver.substeps,
                joints,
                passed: checks.len() - failed,
                failed,
                known_limits: limits.collect(),
                checks: &checks,
                engine: settings.solver.engine.get().version(),
                version: env!("CARGO_PKG_VERSION"),
            })?;
        } else {
            terminal::print(table(
                &checks,
                settings.solver.engine,
                terminal::stdout_wants_colour(),
            ));
            terminal::print(format!(
                "\n{} of {} checks passed at timestep {:.6} s, {} substeps, {}",
                checks.len() - failed,
                checks.len(),
                settings.solver.timestep_s,
                settings.solver.substeps,
                settings.solver.engine.get().version(),
            ));
            for check in checks.iter().filter(|c| c.verdict == CheckResult::Fail) {
                terminal::print(match Limit::of(check, settings.solver.engine) {
                    Some(limit) => format!("known limit: {}: {}", check.name, limit.why),
                    None => format!("failed: {}: {}", check.name, check.what),
                });
            }
            if !known.is_empty() && unexpected == 0 && !self.strict {
                terminal::print("only known limits failed; --strict counts them as failures");
            }
        }
        let failures = if self.strict { failed } else { unexpected };
        Ok(if failures == 0 { 0 } else { 1 })
    }

    fn settings(&self) -> Result<Settings> {
        let values = self.values.parameter_set()?;
        for assignment in values.iter() {
            let name = assignment.parameter.name;
            if !(name.starts_with("contact.") || name.starts_with("solver."))
                && name != "timestep_s"
            {
                return Err(Error::usage("the checks set this themselves")
                    .field(name)
                    .allowed("timestep_s, solver.*, contact.*"));
            }
        }
        let joint_is_set = values.value("solver.joint").is_some();
        // Solver and contact settings do not depend on the robot.
        let no_robot = Assembly::empty();
        let experiment = self.solver.apply(values.apply(&Experiment::new(no_robot)));
        let joints = if self.solver.joint.is_some() || joint_is_set {
            vec![experiment.solver.joint]
        } else {
            Settings::default().joints
        };
        Ok(Settings {
            solver: experiment.solver,
            contact: experiment.contact,
            joints,
        })
    }
}

fn table(checks: &[Check], engine: EngineChoice, colour: bool) -> String {
    let mut table = TextTable::new([
        ("check", Side::Left),
        ("expected", Side::Right),
        ("measured", Side::Right),
        ("unit", Side::Left),
        ("error", Side::Right),
        ("tolerance", Side::Right),
        ("verdict", Side::Left),
    ]);
    for check in checks {
        let (error, tolerance) = match check.tolerance {
            Tolerance::Relative(limit) => (
                if check.error.is_finite() {
                    format!("{:.2} %", 100.0 * check.error)
                } else {
                    number(check.error)
                },
                format!("{} %", number(100.0 * limit)),
            ),
            Tolerance::Absolute(limit) => (number(check.error), number(limit)),
        };
        let verdict = match check.verdict {
            CheckResult::Pass => "pass",
            CheckResult::Fail if Limit::of(check, engine).is_some() => "known",
            CheckResult::Fail => "FAIL",
        };
        table.push([
            check.name.clone(),
            number(check.expected),
            number(check.measured),
            check.unit.symbol().to_owned(),
            error,
            tolerance,
            verdict.to_owned(),
        ]);
    }
    let text = table.render(colour);
    if !colour {
        return text.trim_end().to_owned();
    }
    let paint = |line: &str| match (line.strip_suffix("pass"), line.strip_suffix("FAIL")) {
        (Some(start), _) => format!("{start}\x1b[32mpass\x1b[0m"),
        (_, Some(start)) => format!("{start}\x1b[1;31mFAIL\x1b[0m"),
        _ => line.to_owned(),
    };
    text.lines().map(paint).collect::<Vec<_>>().join("\n")
}

/// Four significant digits.
fn number(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if !value.is_finite() {
        return "-".to_owned();
    }
    let magnitude = value.abs().log10().floor();
    if magnitude < -4.0 {
        return format!("{value:.1e}");
    }
    let decimals = (3.0 - magnitude).clamp(0.0, 8.0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::number;

    #[test]
    fn numbers_of_any_size_keep_four_digits() {
        for (value, text) in [
            (0.0, "0"),
            (0.0612345, "0.06123"),
            (8.0, "8"),
            (1234.56, "1235"),
            (3.2e-7, "3.2e-7"),
            (f64::NAN, "-"),
        ] {
            assert_eq!(number(value), text);
        }
    }
}
