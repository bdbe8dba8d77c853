//! A run that is cut into shards: many machines simulate, one merges, and the results folder has the same bytes as that of one
//! machine.
//!
//! A [`Plan`] is a folder. Its `plan.json` has the command and the number of shards; `round.json` has the rows that are simulated
//! at the moment; `shards/ROUND/SHARD/` are the stores of the workers; `results/` is the results folder into which everything is
//! merged. A run is a sequence of rounds: a sweep has its grid and three waves after it; a tuning and a search have one round per
//! batch, because each proposal depends on everything before. In a round, every shard simulates its
//! [`Share`](realgap_store::Share) of the rows. Rows depend on their index alone, never on the worker.
//!
//! Nothing here starts a program: the schedulers of users (Slurm, `HyperQueue`, Ray) call [`Work::run_shard`] and [`Work::merge`]
//! through the same two commands.

mod cost;
mod merge;
mod plan_file;
mod round;
mod shard;
mod work;

pub use cost::{Cost, time};
pub use merge::{Merged, Refused};
#[cfg(feature = "schema")]
pub use plan_file::Saved;
pub use plan_file::{PLAN_FILE, Plan, PlanDraft};
pub use round::Round;
pub use shard::{Shard, ShardState, Status};
pub use work::Work;
