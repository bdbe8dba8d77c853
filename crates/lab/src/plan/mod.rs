//! A run cut into shards: many machines simulate, one merges, and the folder has the bytes of one machine's.
//!
//! A [`Plan`] is a folder. Its `plan.json` says which command is run and how many shards there are; `round.json` which rows are
//! being made; `shards/ROUND/SHARD/` are the stores of the workers; `results/` is the results folder that everything is
//! merged into. A run is a sequence of rounds: a sweep has its grid and three waves of what may be the best, a tuning and a search
//! have one a batch, since what is proposed next depends on everything before. In a round, every shard makes
//! its [`Share`](realgap_store::Share) of the rows. Rows depend on their index alone, never on who made them.
//!
//! Nothing here starts a program: engines that people have (Slurm, `HyperQueue`, Ray) call [`Work::run_shard`] and [`Work::merge`]
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
