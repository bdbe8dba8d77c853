//! Somebody else's simulator, a guest: a command that answers questions in lines of JSON.
//!
//! A [`Guest`] implements [`Simulator`](realgap_simulation::Simulator), so that studies, ensembles and predictions simulate with it
//! as with the engines. It asks through a [`Port`]: the [`Pool`] of started commands, or a function of the same process. The page
//! `docs/simulator.md` defines the protocol.

mod command;
mod failure;
mod guest;
mod motion;
mod packed;
mod pool;
mod port;
mod protocol;
mod table;
mod unasked;
mod worker;

pub use command::CommandLine;
pub use failure::{Answered, Failure};
pub use guest::Guest;
pub use pool::Pool;
pub use port::{Port, Question};
pub use protocol::{HELLO, Hello, PROTOCOL, ParameterDeclaration};
pub use unasked::Unasked;
