//! `realgap study examples`: the shipped robots, studies, recordings and arenas.

use realgap::file::write_atomic;

use super::example_file::files;
use super::kit::*;

commands! {
    /// List the shipped robots, studies, recordings and arenas, or copy them into a folder
    Examples:
    List(List),
    Copy(CopyOptions),
}

/// List the shipped examples
///
/// Use it to see which robots, studies, recordings and arenas come with the program.
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
///
/// Use it to try the commands on files that you can change.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  realgap study examples copy here")]
pub struct CopyOptions {
    /// The folder to copy into
    folder: PathBuf,
}

impl CopyOptions {
    /// Copies all files, or none where one of them exists already.
    pub fn run(self) -> Result<()> {
        let mut places = files().map(|(path, _)| self.folder.join(path));
        let there = places.find(|path| path.exists());
        if let Some(path) = there {
            return Err(
                Error::conflict("this file exists already and is not replaced")
                    .at_file(path)
                    .hint("copy into an empty folder"),
            );
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
