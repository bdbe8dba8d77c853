//! `realgap new`: a file to start from.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, ValueEnum};
use realgap::file::write_atomic;
use realgap::{Error, Result};

use super::terminal;

/// Write a commented file to start from
///
/// Every field stands there with what it means; what you do not need can go. `realgap check FILE` says whether it is sound.
#[derive(Debug, Args)]
pub struct New {
    /// What
    #[arg(value_enum)]
    kind: Template,
    /// The file [default: KIND.ron]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Print it in place of writing a file
    #[arg(long, conflicts_with = "output")]
    print: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Template {
    /// Modules, servos, gait
    Robot,
    /// Recordings, and what is varied to match them
    Study,
    /// A search for the best robot
    Search,
    /// Walls, boxes, radio stations
    Arena,
    /// How repeats differ
    Noise,
    /// What recordings are, beside them
    Meta,
}

impl Template {
    fn name(self) -> &'static str {
        match self {
            Self::Robot => "robot",
            Self::Study => "study",
            Self::Search => "search",
            Self::Arena => "arena",
            Self::Noise => "noise",
            Self::Meta => "meta",
        }
    }

    fn text(self) -> &'static str {
        match self {
            Self::Robot => include_str!("../../assets/templates/robot.ron"),
            Self::Study => include_str!("../../assets/templates/study.ron"),
            Self::Search => include_str!("../../assets/templates/search.ron"),
            Self::Arena => include_str!("../../assets/templates/arena.ron"),
            Self::Noise => include_str!("../../assets/templates/noise.ron"),
            Self::Meta => include_str!("../../assets/templates/meta.ron"),
        }
    }
}

impl New {
    pub fn run(self) -> Result<ExitCode> {
        if self.print {
            terminal::print(self.kind.text().trim_end());
            return Ok(ExitCode::SUCCESS);
        }
        let file = self
            .output
            .unwrap_or_else(|| PathBuf::from(format!("{}.ron", self.kind.name())));
        if file.exists() {
            return Err(Error::conflict("this file is there already, and stays")
                .at_file(file)
                .hint("name another with -o, or look at the template with --print"));
        }
        write_atomic(&file, self.kind.text().as_bytes())?;
        terminal::print(format!(
            "{} is written; its first lines say what to do with it",
            file.display()
        ));
        Ok(ExitCode::SUCCESS)
    }
}
