//! Robots: bodies, genomes, import.

#[path = "../../../tests/common/shared.rs"]
mod common;
mod genome;
mod morphology;
mod urdf;
