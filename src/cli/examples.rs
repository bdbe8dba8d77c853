//! `realgap examples`: the shipped robots, studies, recordings and arenas.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, Subcommand};
use realgap::file::write_atomic;
use realgap::unit::counted;
use realgap::{Error, Result};

use super::example_file::FILES;
use super::terminal;

/// The shipped robots, studies, recordings and arenas: list them, or copy them to where you can change them
#[derive(Debug, Args)]
pub struct Examples {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    /// List them
    List,
    /// Copy them
    Copy(CopyOptions),
}

#[derive(Debug, Args)]
struct CopyOptions {
    /// Into this folder
    folder: PathBuf,
}

impl Examples {
    pub fn run(self) -> Result<ExitCode> {
        match self.what {
            What::List => {
                let paths: Vec<&str> = FILES.iter().map(|(path, _)| *path).collect();
                terminal::print(paths.join("\n"));
            }
            What::Copy(options) => options.copy()?,
        }
        Ok(ExitCode::SUCCESS)
    }
}

impl CopyOptions {
    /// Copies all of them or none: a file that is there already stays.
    fn copy(&self) -> Result<()> {
        let there = FILES
            .iter()
            .map(|(path, _)| self.folder.join(path))
            .find(|path| path.exists());
        if let Some(path) = there {
            return Err(Error::conflict("this file is there already, and stays")
                .at_file(path)
                .hint("copy into an empty folder"));
        }
        for (path, bytes) in FILES {
            let path = self.folder.join(path);
            if let Some(folder) = path.parent() {
                std::fs::create_dir_all(folder)
                    .map_err(|e| Error::io("make the folder", folder, &e))?;
            }
            write_atomic(&path, bytes)?;
        }
        let folder = self.folder.display();
        terminal::print(format!(
            "{} in {folder}; begin with: cd {folder} && realgap sweep sweeps/tripod_floor.ron --points 5",
            counted(FILES.len(), "file")
        ));
        Ok(())
    }
}
