//! `realgap cluster submit`: let an engine that people have run a plan.

use super::slurm::Slurm;

commands! {
    /// Let Slurm run a plan: arrays of shards, a merge after each, retries, and the answer
    Submit:
    Slurm(Slurm),
}
