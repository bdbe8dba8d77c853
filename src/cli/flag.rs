//! From what the library calls things to the options that set them: the library knows no command line.

use realgap::{Error, ErrorKind};

/// The error in terms of options, where a wrong value came from one.
pub fn in_options(error: Error) -> Error {
    let flag = match (error.kind(), error.field_name()) {
        (ErrorKind::Usage, Some("budget")) => "--budget",
        (ErrorKind::Usage, Some("folds")) => "--folds",
        (ErrorKind::Usage, Some("hold_out")) => "--hold-out",
        (ErrorKind::Usage, Some("points")) => "--points",
        (ErrorKind::Usage, Some("recordings")) => {
            return error
                .field("--recordings")
                .hint("realgap gap --recordings 'FOLDER/*.csv', or realgap gap STUDY");
        }
        (ErrorKind::Invalid, Some("recordings"))
            if error.message() == "the study names no recordings" =>
        {
            return error.hint(
                "name them with --recordings 'FOLDER/*.csv', or in the file: recordings: [\"../runs/*.csv\"]",
            );
        }
        (ErrorKind::Conflict, _) => return with_store_options(error),
        _ => return error,
    };
    error.field(flag)
}

/// The error with the options that its hint means, where results are already in a folder.
fn with_store_options(error: Error) -> Error {
    let Some(hint) = error.hint_text().map(str::to_owned) else {
        return error;
    };
    let options: Vec<&str> = [("resume", "--resume"), ("another folder", "--output DIR")]
        .into_iter()
        .filter(|(words, _)| hint.contains(words))
        .map(|(_, option)| option)
        .collect();
    if options.is_empty() {
        return error;
    }
    error.hint(format!("{hint} ({})", options.join(", ")))
}
