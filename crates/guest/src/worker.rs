//! One started command: its process, the lines that it answers, and what it wrote last.

use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use serde::Deserialize;

use super::command::CommandLine;
use super::failure::{Answered, Failure, Fault};
use super::port::Question;
use realgap_core::text::{shown, shown_end};

/// Most characters of a simulator's last words that are kept.
const LAST_WORDS: usize = 600;
/// Most bytes of one line: an answer of 10 million numbers as text.
const LONGEST_LINE: u64 = 256 << 20;
/// Lines that are read ahead. A simulator that prints without end waits here, and takes no memory.
const READ_AHEAD: usize = 16;
/// A line up to this many bytes fits into an empty pipe, so that writing it never waits.
const FITS_INTO_PIPE: usize = 32 << 10;
/// How long a simulator may take to end by itself after its input has ended.
const FAREWELL: Duration = Duration::from_millis(300);
/// How long the last words of a process that has ended may take to arrive.
const LAST_BREATH: Duration = Duration::from_millis(500);
/// Script of the guard: it waits until its input ends, which happens however this program ends, and then ends the whole group.
const GUARD: &str = "read _; kill -9 -- -$$";

/// A started simulator. It ends, with everything that it has started, where this value is dropped or this program ends.
#[derive(Debug)]
pub(crate) struct Worker {
    process: Child,
    /// A shell that leads the process group of the simulator.
    guard: Option<Child>,
    input: Option<ChildStdin>,
    lines: Receiver<String>,
    errors: Arc<Mutex<String>>,
    /// The thread that reads the errors until their end.
    reading: Option<thread::JoinHandle<()>>,
    /// What the simulator printed besides its answers.
    printed: String,
    /// When it is ended, where its input has ended already.
    leaves_by: Option<Instant>,
    limits: [Duration; 2],
}

impl Worker {
    /// Starts the command.
    pub fn start(command: &CommandLine) -> Answered<Self> {
        let guard = start_guard();
        let words = command.words();
        let mut process = Command::new(&words[0]);
        process
            .args(&words[1..])
            .current_dir(command.folder())
            // Python would else keep short answers back.
            .env("PYTHONUNBUFFERED", "1")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        join_group(&mut process, guard.as_ref());
        let mut process = match process.spawn() {
            Ok(process) => process,
            Err(error) => {
                if let Some(guard) = guard {
                    dismiss(guard);
                }
                let why = format!("`{command}` cannot be started: {error}");
                return Err(Failure::new(Fault::Ended, why));
            }
        };
        let (sender, lines) = sync_channel(READ_AHEAD);
        if let Some(output) = process.stdout.take() {
            thread::spawn(move || send_lines(output, &sender));
        }
        let errors = Arc::new(Mutex::new(String::new()));
        let reading = process.stderr.take().map(|output| {
            let errors = Arc::clone(&errors);
            thread::spawn(move || keep_last(output, &errors))
        });
        Ok(Self {
            input: process.stdin.take(),
            process,
            guard,
            lines,
            errors,
            reading,
            printed: String::new(),
            leaves_by: None,
            limits: [command.start_limit, command.answer_limit],
        })
    }

    /// The answer to one line; other lines that the simulator prints are kept as its words.
    pub fn ask(&mut self, line: &str, question: Question) -> Answered<String> {
        let limit = self.limits[usize::from(question != Question::Hello)];
        let end = Instant::now() + limit;
        let writing = self.write(line)?;
        loop {
            let left = end.saturating_duration_since(Instant::now());
            match self.lines.recv_timeout(left) {
                Ok(line) => match addressee(&line) {
                    Some(Addressee::Question(asked)) if asked == question => {
                        if let Some(writing) = writing {
                            self.input = self.finished(writing, end)?;
                        }
                        return Ok(line);
                    }
                    // A second answer to an earlier question.
                    Some(Addressee::Question(_)) => {}
                    Some(Addressee::Nobody(why)) => return Err(self.failure(Fault::Answered, why)),
                    None => self.keep(&line),
                },
                Err(RecvTimeoutError::Timeout) => {
                    let why = format!("gave no answer within {} s", limit.as_secs_f64());
                    return Err(self.failure(Fault::Hung, why));
                }
                Err(RecvTimeoutError::Disconnected) => return Err(self.ended()),
            }
        }
    }

    /// Writes a line; a long one in a thread, because it waits where the simulator does not read.
    fn write(&mut self, line: &str) -> Answered<Option<Writing>> {
        let Some(mut input) = self.input.take() else {
            return Err(self.ended());
        };
        if line.len() > FITS_INTO_PIPE {
            let line = line.to_owned();
            return Ok(Some(thread::spawn(move || {
                write_line(&mut input, &line).ok().map(|()| input)
            })));
        }
        if write_line(&mut input, line).is_err() {
            return Err(self.ended());
        }
        self.input = Some(input);
        Ok(None)
    }

    /// The input after a line was written, which a simulator that answers has read, or reads until `end`.
    fn finished(&self, writing: Writing, end: Instant) -> Answered<Option<ChildStdin>> {
        while !writing.is_finished() {
            if Instant::now() >= end {
                let why = "answered without reading the whole question".to_owned();
                return Err(self.failure(Fault::Hung, why));
            }
            thread::sleep(Duration::from_millis(1));
        }
        Ok(writing.join().ok().flatten())
    }

    /// Ends the input, so that a simulator that reads it to the end takes its leave. Those of a pool do so at the same time.
    pub fn say_farewell(&mut self) {
        drop(self.input.take());
        self.leaves_by
            .get_or_insert_with(|| Instant::now() + FAREWELL);
    }

    /// Keeps a line that is no answer.
    fn keep(&mut self, line: &str) {
        self.printed.push_str(line);
        self.printed.push('\n');
        keep_end(&mut self.printed);
    }

    /// The failure of a simulator whose output has ended.
    fn ended(&mut self) -> Failure {
        let end = Instant::now() + LAST_BREATH;
        let status = loop {
            match self.process.try_wait() {
                Ok(None) if Instant::now() < end => thread::sleep(Duration::from_millis(5)),
                status => break status.ok().flatten(),
            }
        };
        let why = match status {
            Some(status) => format!("ended ({status})"),
            None => "closed its output".to_owned(),
        };
        // The thread that reads the last words may be behind, and what the simulator has started may keep it reading.
        let is_read = || {
            self.reading
                .as_ref()
                .is_none_or(thread::JoinHandle::is_finished)
        };
        while !is_read() && Instant::now() < end {
            thread::sleep(Duration::from_millis(2));
        }
        self.failure(Fault::Ended, why)
    }

    fn failure(&self, fault: Fault, why: String) -> Failure {
        let errors = self.errors.lock().unwrap_or_else(PoisonError::into_inner);
        let words = match errors.trim().is_empty() {
            true => &self.printed,
            false => &*errors,
        };
        Failure::new(fault, why).with_last_words(&shown_end(words.trim(), LAST_WORDS))
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        self.say_farewell();
        let end = self.leaves_by.unwrap_or_else(Instant::now);
        while matches!(self.process.try_wait(), Ok(None)) && Instant::now() < end {
            thread::sleep(Duration::from_millis(2));
        }
        let _already_ended = self.process.kill();
        if let Some(guard) = self.guard.take() {
            dismiss(guard);
        }
        let _reaped = self.process.wait();
    }
}

/// A line that is being written.
type Writing = thread::JoinHandle<Option<ChildStdin>>;

/// Ends a guard with its group.
fn dismiss(mut guard: Child) {
    end_group(&guard);
    let _reaped = guard.wait();
}

fn write_line(input: &mut ChildStdin, line: &str) -> std::io::Result<()> {
    // One call: the other side wakes up once.
    input.write_all(format!("{line}\n").as_bytes())?;
    input.flush()
}

/// Whom a line of the simulator answers.
enum Addressee {
    /// This question.
    Question(Question),
    /// None, although it is meant as an answer: why.
    Nobody(String),
}

/// The part of an answer that says to which question it belongs.
#[derive(Deserialize)]
struct Address {
    id: Option<u64>,
    realgap: Option<u64>,
}

/// Whom a line answers; `None` for a line that is no answer.
fn addressee(line: &str) -> Option<Addressee> {
    if !line.trim_start().starts_with('{') {
        return None;
    }
    let excerpt = || shown(line, 200);
    Some(match serde_json::from_str::<Address>(line) {
        Ok(Address { id: Some(id), .. }) => Addressee::Question(Question::Run(id)),
        Ok(Address {
            realgap: Some(_), ..
        }) => Addressee::Question(Question::Hello),
        Ok(_) => Addressee::Nobody(format!(
            "answered without the `id` of the question: {}",
            excerpt()
        )),
        Err(_) if line.contains("NaN") || line.contains("Infinity") => {
            Addressee::Nobody("answered NaN or Infinity, which are no numbers of JSON".to_owned())
        }
        Err(error) => Addressee::Nobody(format!("answered no JSON ({error}): {}", excerpt())),
    })
}

fn send_lines(output: impl Read, sender: &SyncSender<String>) {
    let mut output = BufReader::with_capacity(1 << 16, output);
    loop {
        let mut line = Vec::new();
        match output
            .by_ref()
            .take(LONGEST_LINE)
            .read_until(b'\n', &mut line)
        {
            Ok(0) | Err(_) => return,
            Ok(_) => {}
        }
        while line.last().is_some_and(u8::is_ascii_whitespace) {
            line.pop();
        }
        let line = String::from_utf8(line)
            .unwrap_or_else(|error| String::from_utf8_lossy(error.as_bytes()).into_owned());
        if sender.send(line).is_err() {
            return;
        }
    }
}

fn keep_last(mut output: impl Read, kept: &Mutex<String>) {
    let mut buffer = [0; 4096];
    while let Ok(count @ 1..) = output.read(&mut buffer) {
        let mut kept = kept.lock().unwrap_or_else(PoisonError::into_inner);
        kept.push_str(&String::from_utf8_lossy(&buffer[..count]));
        keep_end(&mut kept);
    }
}

/// Cuts a text to its end.
fn keep_end(text: &mut String) {
    let most = 4 * LAST_WORDS;
    if text.len() > 2 * most {
        let mut from = text.len() - most;
        while !text.is_char_boundary(from) {
            from += 1;
        }
        text.drain(..from);
    }
}

/// Starts the guard of a new process group; `None` where there is no shell.
#[cfg(unix)]
fn start_guard() -> Option<Child> {
    use std::os::unix::process::CommandExt;
    Command::new("/bin/sh")
        .args(["-c", GUARD])
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .process_group(0)
        .spawn()
        .ok()
}

#[cfg(unix)]
fn join_group(process: &mut Command, guard: Option<&Child>) {
    use std::os::unix::process::CommandExt;
    let group = guard.and_then(|guard| i32::try_from(guard.id()).ok());
    process.process_group(group.unwrap_or(0));
}

#[cfg(unix)]
fn end_group(guard: &Child) {
    use rustix::process::{Pid, Signal, kill_process_group};
    let group = i32::try_from(guard.id()).ok().and_then(Pid::from_raw);
    if let Some(group) = group {
        let _already_ended = kill_process_group(group, Signal::KILL);
    }
}

/// Other systems have no process groups: only the simulator itself is ended.
#[cfg(not(unix))]
fn start_guard() -> Option<Child> {
    let _ = GUARD;
    None
}

#[cfg(not(unix))]
fn join_group(_: &mut Command, _: Option<&Child>) {}

#[cfg(not(unix))]
fn end_group(_: &Child) {}
