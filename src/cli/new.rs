//! `realgap study new`: a file to start from.

use realgap::file::write_atomic;

use super::kit::*;

/// Write a commented file to start from
///
/// Every field stands there with what it means; what you do not need can go. `realgap check FILE` says whether it is sound.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  realgap study new study -o study.ron")]
pub struct New {
    /// What
    #[arg(value_parser = choice(TEMPLATES))]
    kind: (&'static str, &'static str),
    /// The file [default: KIND.ron]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Print it in place of writing a file
    #[arg(long, conflicts_with = "output")]
    print: bool,
}

macro_rules! templates {
    ($($name:literal $about:literal;)*) => {
        &[$(($name, ($name, include_str!(concat!("../../assets/templates/", $name, ".ron"))), $about),)*]
    };
}

/// The files that there are, each with its name.
const TEMPLATES: &[Choice<(&str, &str)>] = templates! {
    "robot" "Modules, servos, gait";
    "study" "Recordings, and what is varied to match them";
    "search" "A search for the best robot";
    "arena" "Walls, boxes, radio stations";
    "noise" "How repeats differ";
    "meta" "What recordings are, beside them";
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
            return Err(Error::conflict("this file is there already, and stays")
                .at_file(file)
                .hint("name another with -o, or look at the template with --print"));
        }
        write_atomic(&file, text.as_bytes())?;
        terminal::print(format!(
            "{} is written; its first lines say what to do with it",
            file.display()
        ));
        Ok(())
    }
}
