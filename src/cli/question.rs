//! Asks what recordings leave open, and reads recordings whose names, units or order have to be inferred.

use std::io::{BufRead as _, IsTerminal as _};
use std::path::Path;

use realgap::trajectory::{self, Ambiguity, Axes, InferredReading, Question, Reading, Recording};
use realgap::warning::Code;
use realgap::{Error, Result};

use super::terminal;

/// Asks on a terminal; elsewhere the error names the option that answers.
pub fn answer(open: &Ambiguity, known: &mut Reading) -> Result<()> {
    if !std::io::stdin().is_terminal() || !std::io::stderr().is_terminal() {
        return Err(open.error());
    }
    let question = match open.question {
        Question::Time => "In which unit are times (s, ms, us, ns)?",
        Question::Length => "In which unit are lengths (m, cm, mm, in, ft)?",
        Question::Up => "Which way do axes point (world: z up; y-up; z-down; camera)?",
        Question::Robot => "Whose rows are read (COLUMN=VALUE)?",
        Question::Body => "Whose columns are read (a name)?",
        Question::Split => "Are these several recordings (yes, no)?",
    };
    terminal::note(format!("{question} {}", open.found));
    let mut line = String::new();
    let read = std::io::stdin().lock().read_line(&mut line);
    if read.map_err(|e| Error::io("read the answer", "standard input", &e))? == 0 {
        return Err(Error::interrupted("no answer"));
    }
    let line = line.trim();
    let wrong = |why: String| terminal::note(why);
    match open.question {
        Question::Time => line
            .parse()
            .map_or_else(wrong, |unit| known.time = Some(unit)),
        Question::Length => {
            // A unit that contradicts the names of the columns has to be mapped.
            if let Some(one) = open.candidates.iter().find(|one| one.name == line) {
                known.columns = one.columns.clone();
            }
            line.parse()
                .map_or_else(wrong, |unit| known.length = Some(unit));
        }
        Question::Up => line
            .parse::<Axes>()
            .map_or_else(wrong, |axes| known.axes = Some(axes)),
        Question::Robot => line
            .parse()
            .map_or_else(wrong, |only| known.only = Some(only)),
        Question::Body => match open.candidates.iter().find(|one| one.name == line) {
            Some(one) => known.columns = one.columns.clone(),
            None => wrong(format!("nothing is called `{line}`")),
        },
        Question::Split => match line {
            "yes" | "y" => known.split = Some(true),
            "no" | "n" => known.split = Some(false),
            _ => wrong("allowed: yes, no".to_owned()),
        },
    }
    Ok(())
}

/// The reading of one file, inferred where the known settings do not suffice; every inference that changes it is printed.
fn inferred(path: &Path, known: &Reading) -> Result<Reading> {
    let mut known = known.clone();
    let guess = loop {
        let guess = InferredReading::of_file(path, &known)?;
        match guess.ambiguities.first() {
            None => break guess,
            Some(open) => answer(open, &mut known).map_err(|error| error.at_file(path))?,
        }
    };
    for evidence in &guess.evidence {
        terminal::note(format!(
            "{}: {}: {}",
            path.display(),
            evidence.finding,
            evidence.reason
        ));
    }
    Ok(guess.reading)
}

/// Reads a file with `read`, and with an inferred reading if the known settings do not suffice.
fn read_with<T>(
    path: &Path,
    known: &Reading,
    read: impl Fn(&Reading) -> Result<T>,
    has_unused: impl Fn(&T) -> bool,
) -> Result<T> {
    match read(known) {
        Ok(found) if !has_unused(&found) => Ok(found),
        // A column that is not used may be the heading.
        Ok(found) => match InferredReading::of_file(path, known) {
            Ok(guess) if guess.ambiguities.is_empty() && guess.reading != *known => {
                read(&inferred(path, known)?)
            }
            // Whoever maps columns without a unit may not know that there is one to state.
            Ok(guess)
                if !known.columns.is_empty()
                    && (guess.ambiguities.iter()).any(|open| open.question == Question::Length) =>
            {
                read(&inferred(path, known)?)
            }
            _ => Ok(found),
        },
        // A file that is not there has nothing to infer.
        Err(error) if !path.is_file() => Err(error),
        Err(_) => read(&inferred(path, known)?),
    }
}

fn has_unused(recording: &Recording) -> bool {
    let mut all = recording.warnings.iter();
    all.any(|warning| warning.code == Code::ColumnsIgnored)
}

/// All recordings of a file.
pub fn read_all(path: &Path, known: &Reading) -> Result<Vec<Recording>> {
    let read = |reading: &Reading| trajectory::read_all(path, reading);
    read_with(path, known, read, |all| all.iter().any(has_unused))
}

/// The recording of a file that holds one.
pub fn read(path: &Path, known: &Reading) -> Result<Recording> {
    let read = |reading: &Reading| trajectory::read(path, reading);
    read_with(path, known, read, has_unused)
}
