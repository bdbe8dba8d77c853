//! Calls another program with a picture on its standard input and reads its text output.

use std::io::{self, Read, Write};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::OnceLock;
use std::sync::mpsc::{Receiver, channel};
use std::thread;
use std::time::{Duration, Instant};

use realgap_core::error::{Error, Result};

/// Default time limit for a picture, which is much longer than a picture takes.
const LIMIT: Duration = Duration::from_secs(60);
/// Largest output of a program, bytes; a page of text has some thousand.
const MOST_BYTES: u64 = 1 << 20;
/// Interval at which it is checked whether a program has ended after it has closed its output.
const LOOK: Duration = Duration::from_millis(1);

/// An installed program that reads from its standard input and writes text.
#[derive(Debug)]
pub struct Program {
    command: &'static str,
    options: &'static [&'static str],
    remedy: &'static str,
    limit: Duration,
    version: OnceLock<String>,
}

/// A running program. It is killed when this value is dropped, so that no process remains after an error.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        // Killing a process that has already ended is an error, which is ignored.
        let _ended = self.0.kill();
        let _status = self.0.wait();
    }
}

impl Running {
    /// The exit status; `None` if the program has not ended by the deadline.
    fn ended(&mut self, deadline: Instant) -> io::Result<Option<ExitStatus>> {
        loop {
            if let Some(status) = self.0.try_wait()? {
                return Ok(Some(status));
            }
            if Instant::now() >= deadline {
                return Ok(None);
            }
            thread::sleep(LOOK);
        }
    }
}

/// Reads the output of a pipe on a thread of its own, at most one byte more than [`MOST_BYTES`]. The thread is not joined, because a child
/// process of the program may hold the pipe open for longer.
fn listen(mut pipe: impl Read + Send + 'static) -> io::Result<Receiver<Vec<u8>>> {
    let (sender, receiver) = channel();
    thread::Builder::new().spawn(move || {
        let mut bytes = Vec::new();
        // A broken pipe counts as its end; errors of the program show in its exit status.
        let _read = pipe.by_ref().take(MOST_BYTES + 1).read_to_end(&mut bytes);
        // The receiver may be gone because of the time limit.
        let _sent = sender.send(bytes);
    })?;
    Ok(receiver)
}

/// The last line that is not empty.
fn last_line(bytes: &[u8]) -> Option<String> {
    let text = String::from_utf8_lossy(bytes);
    let line = text.lines().rfind(|line| !line.trim().is_empty());
    line.map(|line| line.trim().to_owned())
}

impl Program {
    /// A program by its name, its options, and the hint to show if it is not installed. The time limit for a picture is a minute.
    pub const fn new(
        command: &'static str,
        options: &'static [&'static str],
        remedy: &'static str,
    ) -> Self {
        Self {
            command,
            options,
            remedy,
            limit: LIMIT,
            version: OnceLock::new(),
        }
    }

    /// The same program with another time limit for a picture.
    #[must_use]
    pub const fn with_limit(mut self, limit: Duration) -> Self {
        self.limit = limit;
        self
    }

    /// The command line: name and options of the program.
    pub fn call(&self) -> String {
        let words = std::iter::once(&self.command).chain(self.options);
        words.copied().collect::<Vec<_>>().join(" ")
    }

    /// The first line that the program prints about its version; the program is called once only.
    ///
    /// # Errors
    /// The errors of [`Program::read`].
    pub fn version(&self) -> Result<&str> {
        if let Some(version) = self.version.get() {
            return Ok(version);
        }
        let said = self.run(&["--version"], &[])?;
        let text = String::from_utf8_lossy(&said);
        let first = text.lines().find(|line| !line.trim().is_empty());
        let first = first.unwrap_or(self.command).trim().to_owned();
        Ok(self.version.get_or_init(|| first))
    }

    /// The text that the program writes for this input.
    ///
    /// # Errors
    /// A program that is not installed or cannot be started, fails, takes too long, or writes more than a megabyte or bytes that are not
    /// UTF-8.
    pub fn read(&self, input: &[u8]) -> Result<String> {
        let said = self.run(self.options, input)?;
        String::from_utf8(said).map_err(|e| {
            self.error("wrote no text")
                .found(format!(
                    "a byte that is not UTF-8 behind the first {}",
                    e.utf8_error().valid_up_to()
                ))
                .allowed("UTF-8")
        })
    }

    fn error(&self, what: &str) -> Error {
        Error::invalid(format!("the program {} {what}", self.command))
    }

    fn run(&self, options: &[&str], input: &[u8]) -> Result<Vec<u8>> {
        let deadline = Instant::now() + self.limit;
        let child = Command::new(self.command)
            .args(options)
            // The program is limited to one thread, because several pictures are processed in parallel.
            .env("OMP_THREAD_LIMIT", "1")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn();
        let mut running = Running(child.map_err(|e| {
            match e.kind() {
                io::ErrorKind::NotFound => self.error("is not installed"),
                _ => self.error(&format!("cannot be started: {e}")),
            }
            .hint(self.remedy)
        })?);
        let broken = |e: io::Error| self.error(&format!("cannot be communicated with: {e}"));
        let child = &mut running.0;
        let pipes = (child.stdin.take(), child.stdout.take(), child.stderr.take());
        let (Some(mut to), Some(from), Some(complaints)) = pipes else {
            return Err(self.error("has no pipes"));
        };
        // The program may write before it has read all input, so input and output are handled by different threads.
        let (text, complaints) = (
            listen(from).map_err(broken)?,
            listen(complaints).map_err(broken)?,
        );
        let input = input.to_vec();
        thread::Builder::new()
            // An error of writing is ignored, because the program may not need all input; its exit status shows failures.
            .spawn(move || drop(to.write_all(&input)))
            .map_err(broken)?;
        let left = || deadline.saturating_duration_since(Instant::now());
        let received = [text, complaints].map(|pipe| pipe.recv_timeout(left()));
        let [Ok(text), Ok(complaints)] = received else {
            return Err(self.too_long());
        };
        if text.len() as u64 > MOST_BYTES {
            return Err(self
                .error("wrote too much")
                .found(format!("more than {MOST_BYTES} bytes"))
                .allowed(format!("{MOST_BYTES} bytes")));
        }
        let Some(status) = running.ended(deadline).map_err(broken)? else {
            return Err(self.too_long());
        };
        if !status.success() {
            let last = last_line(&complaints).map_or(String::new(), |line| format!(": {line}"));
            return Err(self
                .error("failed")
                .found(format!("{status}{last}"))
                .hint(self.by_hand()));
        }
        Ok(text)
    }

    fn too_long(&self) -> Error {
        self.error("took too long")
            .found(format!("no end within {:.0?}", self.limit))
            .hint(self.by_hand())
    }

    fn by_hand(&self) -> String {
        let call = self.call();
        format!("try it by hand: {call} < PICTURE, or leave it out")
    }
}
