//! `realgap cluster submit`: runs a plan with a job scheduler.

use super::slurm::Slurm;

commands! {
    /// Run a whole plan with a job scheduler: shards, merges, retries, and the results
    Submit:
    Slurm(Slurm),
}
