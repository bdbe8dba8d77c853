//! Tests of a simulator that is not ours: small shell scripts that speak the protocol, or do not.
#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used)]

mod failures;
mod protocol;

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use realgap_core::Result;
use realgap_guest::{CommandLine, Guest, Pool};
use realgap_robot::morphology::Assembly;
use realgap_simulation::{Experiment, Outcome, Sampling, SimulatorChoice};

/// The answer to the first question of a simulator with one parameter.
pub const HELLO: &str = r#"{"realgap":1,"name":"toy","parameters":[{"name":"k","unit":"N/m","from":0,"to":10,"default":2}]}"#;

/// A script that answers the first question, and to each run with what `answer` prints; `$id` is the number of the run.
pub fn script(answer: &str) -> String {
    format!(
        r#"while read -r line; do case "$line" in
*hello*) echo '{HELLO}';;
*) id=${{line#*\"id\":}}; id=${{id%%,*}}; {answer};;
esac; done"#
    )
}

/// The command that runs a script of the shell in this folder.
pub fn command(folder: &Path, script: &str) -> CommandLine {
    std::fs::write(folder.join("toy.sh"), script).unwrap();
    let words = ["sh", "toy.sh"].map(str::to_owned).to_vec();
    let mut command = CommandLine::new(words, folder, &[]).unwrap();
    command.start_limit = Duration::from_secs(20);
    command.answer_limit = Duration::from_secs(20);
    command
}

/// The simulator of a command.
pub fn guest(command: CommandLine) -> Result<Guest> {
    Guest::new(Arc::new(Pool::new(command)))
}

/// An experiment of one second that a guest simulates, sampled at its ends.
pub fn experiment(guest: Arc<Guest>) -> Experiment {
    let mut experiment = Experiment::new(Assembly::empty());
    experiment.duration_s = 1.0;
    experiment.sampling = Sampling::Times([0.0, 1.0].into());
    experiment.foreign.values = guest.defaults();
    experiment.simulator = SimulatorChoice::new(guest);
    experiment
}

/// The angles of the joint `a` in one run, or why the run failed.
pub fn answer(experiment: &Experiment) -> std::result::Result<Vec<f64>, String> {
    match realgap_simulation::run(experiment).unwrap().outcome {
        Outcome::Completed(motion) => Ok(motion.joint("a").unwrap().angles_rad.clone()),
        Outcome::Diverged(divergence) => Err(divergence.to_string()),
    }
}
