//! `realgap study examples`: the shipped robots, studies, recordings and arenas.

use realgap::file::write_atomic;

use super::example_file::files;
use super::kit::*;

commands! {
    /// The shipped robots, studies, recordings and arenas: list them, or copy them to where you can change them
    Examples:
    List(List),
    Copy(CopyOptions),
}

/// List the shipped examples
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  realgap study examples list")]
pub struct List {}

impl List {
    pub fn run(self) -> Result<()> {
        let paths: Vec<String> = files().map(|(path, _)| path).collect();
        terminal::print(paths.join("\n"));
        Ok(())
    }
}

/// Copy the shipped examples into a folder
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  realgap study examples copy here")]
pub struct CopyOptions {
    /// Into this folder
    folder: PathBuf,
}

impl CopyOptions {
    /// Copies all of them or none: a file that is there already stays.
    pub fn run(self) -> Result<()> {
        let mut places = files().map(|(path, _)| self.folder.join(path));
        let there = places.find(|path| path.exists());
        if let Some(path) = there {
            return Err(Error::conflict("this file is there already, and stays")
                .at_file(path)
                .hint("copy into an empty folder"));
        }
        for (path, bytes) in files() {
            let path = self.folder.join(path);
            if let Some(folder) = path.parent() {
                std::fs::create_dir_all(folder)
                    .map_err(|e| Error::io("make the folder", folder, &e))?;
            }
            write_atomic(&path, bytes)?;
        }
        let folder = self.folder.display();
        terminal::print(format!(
            "{} in {folder}; begin with: cd {folder} && realgap sweep sweeps/cube_toss.ron",
            counted(files().count(), "file")
        ));
        Ok(())
    }
}
