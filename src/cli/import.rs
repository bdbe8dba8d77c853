//! `realgap robot import`: a robot of another program.

use std::path::PathBuf;

use clap::Args;
use realgap::Result;
use realgap::file::Source;
use realgap::import::from_urdf;

use super::{output, terminal};

/// Read a robot of boxes and hinges from a URDF, and write it in RON
///
/// Links become modules with their masses and moments, revolute and continuous joints become passive hinges with their friction
/// and limits; what is fixed to each other becomes one module. What cannot be taken over is said on standard error
/// and in comments of the file: gaits and servo laws, which URDF does not know, meshes, products of inertia.
#[derive(Debug, Args)]
pub struct Import {
    /// The URDF
    urdf: PathBuf,
    /// Write to this file instead of standard output
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

impl Import {
    pub fn run(self) -> Result<()> {
        let imported = from_urdf(&Source::read(&self.urdf, "URDF")?)?;
        for left_out in &imported.left_out {
            terminal::note(format!("left out or changed: {left_out}"));
        }
        match &self.output {
            Some(path) => output::write_ron(path, &imported.text)?,
            None => terminal::print(imported.text.trim_end()),
        }
        Ok(())
    }
}
