//! `realgap report`: a results folder as one page.

use std::path::PathBuf;

use clap::Args;
use realgap::file::write_atomic;
use realgap::report::folder_page;
use realgap::{Error, Result};

use super::output::check_page;
use super::shell::command_line;
use super::terminal;

/// Show what a results folder holds: one HTML file that needs no network
///
/// Of a sweep or a tuning: the answer, the map of scores (a click on a point shows its path), verdicts, pictures, the numerical
/// audit, warnings, versions and hashes. Of other results: their numbers and pictures. Everything comes from the files in the folder.
#[derive(Debug, Args)]
pub struct ReportCommand {
    /// A folder that sweep, tune, search, ensemble, gap or predict has written
    folder: PathBuf,
    /// The page [default: report.html in the folder]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

impl ReportCommand {
    pub fn run(self) -> Result<()> {
        if !self.folder.is_dir() {
            return Err(Error::usage("this is no folder")
                .at_file(&self.folder)
                .hint(
                    "name a folder that sweep, tune, search, ensemble, gap or predict has written",
                ));
        }
        let output = self
            .output
            .unwrap_or_else(|| self.folder.join("report.html"));
        check_page(&output)?;
        let page = folder_page(&self.folder, &command_line())?;
        write_atomic(&output, page.as_bytes())?;
        terminal::print(format!(
            "written {} ({} kB): open it in a browser",
            output.display(),
            page.len().div_ceil(1000)
        ));
        Ok(())
    }
}
