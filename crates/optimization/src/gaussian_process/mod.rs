//! Gaussian processes with a Matérn 5/2 kernel: models of an unknown function from some values of it.
//!
//! Two parts of realgap use them: the optimizer `bayesian`, and the emulator of the crate `realgap-inference`. Both share the
//! kernel ([`Matern`]), the factorisation of the covariance ([`factorise`]), and the prediction and the deviance of a process that
//! is conditioned on values ([`ConditionedProcess`]). `GaussianProcess` adds the fit of a kernel by maximum likelihood; the emulator
//! draws its kernels from their posterior distribution instead, because it has to know how uncertain they are.

mod conditioned;
mod fit;
mod matern;
mod process;

pub use conditioned::{ConditionedProcess, JointPrediction, Mean, factorise};
pub use matern::Matern;
pub(crate) use process::{GaussianProcess, Hyperparameters};
