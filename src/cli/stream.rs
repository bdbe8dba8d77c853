//! `-` and pipes in place of files. Input is copied into a temporary file, which can be read twice. Output is written into a
//! temporary file, and copied to standard output once it is complete.

use std::ffi::OsString;
use std::io::{Read, Write as _};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::sync::mpsc;
use std::time::Duration;

use realgap::file::write_atomic;
use realgap::{Error, Result};

use super::terminal;

/// Largest number of bytes of a stream.
const MOST: u64 = 1 << 30;
/// How long to wait for a program that writes into a pipe.
const PATIENCE: Duration = Duration::from_secs(10);
/// Name of the temporary file for standard output.
const OUTPUT: &str = "standard_output.csv";
/// The folder of the temporary files, once there are any.
static FOLDER: OnceLock<PathBuf> = OnceLock::new();

/// The arguments with files in place of streams. `--reading -` means no file.
///
/// # Errors
/// A pipe into which no program writes, a full disk.
pub fn kept(mut words: Vec<OsString>) -> Result<Vec<OsString>> {
    for index in 1..words.len() {
        let (before, word) = (&words[index - 1], &words[index]);
        let is_output = before == "-o" || before == "--output";
        let is_stdin = word == "-" || word == "/dev/stdin";
        if before == "--reading" || !(is_stdin || is_pipe(Path::new(word))) {
            continue;
        }
        words[index] = match (is_output, is_stdin) {
            (true, true) => {
                terminal::leave_stdout();
                folder()?.join(OUTPUT).into()
            }
            // A pipe that is written into is left as it is.
            (true, false) => continue,
            (false, true) => keep(index, read("standard input".as_ref(), std::io::stdin())?)?,
            (false, false) => keep(index, read_pipe(Path::new(word))?)?,
        };
    }
    Ok(words)
}

/// Copies the file for standard output to standard output, and removes the temporary files.
///
/// # Errors
/// Standard output that cannot be written.
pub fn finish() -> Result<()> {
    let Some(folder) = FOLDER.get() else {
        return Ok(());
    };
    let written = std::fs::read(folder.join(OUTPUT));
    // A failure is ignored, because the folder is temporary.
    let _removed = std::fs::remove_dir_all(folder);
    match written {
        Ok(bytes) => std::io::stdout()
            .write_all(&bytes)
            .map_err(|e| Error::io("write to standard output", "standard output", &e)),
        Err(_) => Ok(()),
    }
}

fn folder() -> Result<&'static Path> {
    let folder = FOLDER.get_or_init(|| {
        std::env::temp_dir().join(format!("realgap-streams-{}", std::process::id()))
    });
    terminal::leave_out(folder);
    std::fs::create_dir_all(folder)
        .map_err(|e| Error::io("make a folder for streams", folder, &e))?;
    Ok(folder)
}

/// Writes these bytes into a file, with an ending that fits their content.
fn keep(index: usize, bytes: Vec<u8>) -> Result<OsString> {
    let text = String::from_utf8_lossy(&bytes[..bytes.len().min(10_000)]).into_owned();
    let lines = text.lines().map(str::trim_start);
    let first = lines
        .filter(|line| !line.is_empty() && !line.starts_with("//"))
        .find(|line| !line.starts_with("#!["))
        .unwrap_or_default();
    let name = first.split('(').next().unwrap_or_default();
    let is_ron = first.contains('(') && name.chars().all(char::is_alphanumeric);
    let ending = match (is_ron, first.starts_with('<')) {
        (true, _) => "ron",
        (_, true) => "urdf",
        _ => "csv",
    };
    let path = folder()?.join(format!("standard_input_{index}.{ending}"));
    write_atomic(&path, &bytes)?;
    Ok(path.into())
}

fn read(path: &Path, stream: impl Read) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    stream
        .take(MOST)
        .read_to_end(&mut bytes)
        .map_err(|e| Error::io("read the stream", path, &e))?;
    Ok(bytes)
}

/// Reads a pipe, if a program writes into it.
fn read_pipe(path: &Path) -> Result<Vec<u8>> {
    let (send, opened) = mpsc::channel();
    let pipe = path.to_path_buf();
    std::thread::spawn(move || send.send(std::fs::File::open(pipe)));
    match opened.recv_timeout(PATIENCE) {
        Ok(file) => read(
            path,
            file.map_err(|e| Error::io("read the pipe", path, &e))?,
        ),
        Err(_) => Err(Error::invalid("no program writes into this pipe")
            .at_file(path)
            .found(format!("nothing within {} s", PATIENCE.as_secs()))
            .hint("start the program that writes into it first, or name a file")),
    }
}

#[cfg(unix)]
fn is_pipe(path: &Path) -> bool {
    use std::os::unix::fs::FileTypeExt as _;
    std::fs::metadata(path).is_ok_and(|metadata| metadata.file_type().is_fifo())
}

#[cfg(not(unix))]
fn is_pipe(_path: &Path) -> bool {
    false
}
