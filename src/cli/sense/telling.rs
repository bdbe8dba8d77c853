//! How a command tells a value that prints itself.

use std::fmt::Display;

use crate::cli::kit::*;

impl Telling {
    /// Tells a value that prints itself: its page, then the warnings that were not said yet, then what it says.
    pub fn value<'a>(
        &self,
        kind: &'static str,
        of: &Path,
        found: &(impl terminal::Answer + Display),
        pictures: impl IntoIterator<Item = &'a PathBuf>,
        warnings: &[Warning],
    ) -> Result<()> {
        self.write(kind, of, found, &found.to_string(), pictures)?;
        terminal::print_warnings(warnings);
        self.print.value(found)
    }
}
