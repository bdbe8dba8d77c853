//! The output of an answer that formats itself as text.

use std::fmt::Display;

use crate::cli::kit::*;

impl Telling {
    /// Outputs an answer: writes its page, prints these warnings, then prints the answer.
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
