//! `realgap report`: writes a results folder as one page.

use realgap::file::write_sealed;
use realgap::report::folder_page;
use realgap::results::accept;

use super::kit::*;
use super::output::check_page;
use super::shell::command_line;

/// Write the results of a folder as one HTML page that needs no network
///
/// Use it to write the page again; other commands write it into their folder unless --no-report is given. The page of
/// a sweep or a tuning shows the answer, the map of scores (a click on a point shows its path), verdicts, pictures,
/// the numerical audit, warnings, versions and hashes; the page of other results shows their numbers and pictures.
/// Everything comes from the files in the folder, whose checksums (SHA256SUMS) are verified first.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  realgap report results/tripod_floor")]
pub struct ReportCommand {
    /// A folder that sweep, tune, search, ensemble, gap or predict has written
    folder: PathBuf,
    /// The page [default: report.html in the folder]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Accept files of the folder that were changed by hand, and write new checksums of them
    #[arg(long)]
    accept: bool,
}

impl ReportCommand {
    pub fn run(self) -> Result<()> {
        if !self.folder.is_dir() {
            return Err(Error::usage("this is not a folder")
                .at_file(&self.folder)
                .hint(
                    "name a folder that sweep, tune, search, ensemble, gap or predict has written",
                ));
        }
        let output = self
            .output
            .unwrap_or_else(|| self.folder.join("report.html"));
        check_page(&output)?;
        if self.accept {
            accept(&self.folder)?;
        }
        let page = folder_page(&self.folder, &command_line())?;
        let is_of_folder = output.parent() == Some(&self.folder);
        write_sealed(&output, page.as_bytes(), is_of_folder)?;
        terminal::print(format!(
            "written {} ({} kB): open it in a browser",
            output.display(),
            page.len().div_ceil(1000)
        ));
        Ok(())
    }
}
