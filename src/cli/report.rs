//! `realgap report`: writes a results folder as one page.

use realgap::file::write_sealed;
use realgap::report::{compared_page, folder_page};
use realgap::results::accept;

use super::kit::*;
use super::output::check_page;
use super::shell::command_line;

/// Write the results of a folder as one HTML page that needs no network
///
/// Use it to write the page again; other commands write it into their folder unless --no-report is given. The page of
/// a sweep or a tuning shows the answer, the map of scores (a click on a point shows its path), verdicts, pictures,
/// the numerical audit, warnings, versions and hashes; the page of other results shows their numbers and pictures. Of
/// several folders, the verdicts and the values of parameters with their intervals stand beside each other.
/// Everything comes from the files in the folder, whose checksums (SHA256SUMS) are verified first.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  realgap report results/tripod_floor
  realgap report results/before results/after -o both.html")]
pub struct ReportCommand {
    /// A folder that sweep, tune, search, ensemble, gap or predict has written; several are shown beside each other
    #[arg(required = true, value_name = "FOLDER")]
    folders: Vec<PathBuf>,
    /// The page [default: report.html in the folder; of several folders comparison.html here]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Accept files of the folder that were changed by hand, and write new checksums of them
    #[arg(long)]
    accept: bool,
}

impl ReportCommand {
    pub fn run(self) -> Result<()> {
        if let Some(other) = self.folders.iter().find(|folder| !folder.is_dir()) {
            return Err(Error::usage("this is not a folder").at_file(other).hint(
                "name a folder that sweep, tune, search, ensemble, gap or predict has written",
            ));
        }
        let only = match self.folders.as_slice() {
            [only] => Some(only.as_path()),
            _ => None,
        };
        let default = || match only {
            Some(folder) => folder.join("report.html"),
            None => PathBuf::from("comparison.html"),
        };
        let output = self.output.unwrap_or_else(default);
        check_page(&output)?;
        if self.accept {
            self.folders.iter().try_for_each(|folder| accept(folder))?;
        }
        let page = match only {
            Some(folder) => folder_page(folder, &command_line())?,
            None => compared_page(&self.folders, &command_line())?,
        };
        let is_of_folder = only.is_some() && output.parent() == only;
        write_sealed(&output, page.as_bytes(), is_of_folder)?;
        terminal::print(format!(
            "written {} ({} kB): open it in a browser",
            output.display(),
            page.len().div_ceil(1000)
        ));
        Ok(())
    }
}
