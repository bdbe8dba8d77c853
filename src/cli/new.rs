//! `realgap study new`: writes a template.

use realgap::file::write_atomic;

use super::kit::*;

/// Write a commented template of a robot, study, search, arena, noise or meta file
///
/// Use it to start a file of your own. Every field is listed with its meaning; fields that you do not need can be
/// deleted. `realgap check FILE` validates the result.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  realgap study new study -o study.ron")]
pub struct New {
    /// Kind of file
    #[arg(value_parser = choice(TEMPLATES))]
    kind: (&'static str, &'static str),
    /// The file [default: KIND.ron]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Print the template instead of writing a file
    #[arg(long, conflicts_with = "output")]
    print: bool,
}

macro_rules! templates {
    ($($name:literal $about:literal;)*) => {
        &[$(($name, ($name, include_str!(concat!("../../assets/templates/", $name, ".ron"))), $about),)*]
    };
}

/// The templates, each with its name.
const TEMPLATES: &[Choice<(&str, &str)>] = templates! {
    "robot" "Modules, servos, gait";
    "study" "Recordings, and the parameters to vary";
    "search" "A search for the best robot";
    "arena" "Walls, boxes, radio stations";
    "noise" "How repeats differ";
    "meta" "Description of the recordings in its folder";
};

impl New {
    pub fn run(self) -> Result<()> {
        let (name, text) = self.kind;
        if self.print {
            terminal::print(text.trim_end());
            return Ok(());
        }
        let file = self
            .output
            .unwrap_or_else(|| PathBuf::from(format!("{name}.ron")));
        if file.exists() && !output::is_forced() {
            return Err(
                Error::conflict("this file exists already and is not replaced")
                    .at_file(file)
                    .hint("name another file with -o, or print the template with --print"),
            );
        }
        write_atomic(&file, text.as_bytes())?;
        terminal::print(format!(
            "{} is written; its first lines say what to do with it",
            file.display()
        ));
        Ok(())
    }
}
