//! Trajectories: formats, preparation, comparison.

#[path = "../../../tests/common/shared.rs"]
mod common;
mod formats;
mod golden;
mod metric_contract;
mod pca_reference;
mod preparation;
mod whitened;
