//! The started commands of one study: one for each thread that asks at the same time.

use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use super::command::CommandLine;
use super::failure::{Answered, Failure, Fault};
use super::port::{Port, Question};
use super::protocol::HELLO;
use super::worker::Worker;

/// Started commands. A thread that asks takes an idle one, or starts one where all are busy; after an answer it is idle again.
#[derive(Debug)]
pub struct Pool {
    command: CommandLine,
    idle: Mutex<Vec<Worker>>,
    /// Answers that were waited for in vain, one after the other.
    in_vain: AtomicUsize,
}

/// So many questions in a row without an answer in time mean that the simulator hangs whatever it is asked.
const IN_VAIN: usize = 5;

impl Pool {
    /// No command is started before the first question.
    pub fn new(command: CommandLine) -> Self {
        Self {
            command,
            idle: Mutex::default(),
            in_vain: AtomicUsize::new(0),
        }
    }

    /// What the command is.
    pub fn command(&self) -> &CommandLine {
        &self.command
    }

    fn started(&self, question: Question) -> Answered<Worker> {
        let mut worker = Worker::start(&self.command)?;
        // The first question of every worker is who it is; only the pool's first caller needs the answer.
        if question != Question::Hello {
            worker.ask(HELLO, Question::Hello)?;
        }
        Ok(worker)
    }

    fn idle(&self) -> Option<Worker> {
        self.idle
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .pop()
    }

    /// Asks a worker that was never asked before.
    fn asked_anew(&self, line: &str, question: Question) -> Answered<String> {
        self.asked(self.started(question)?, line, question)
    }

    /// Asks this worker, which is idle afterwards. A worker that fails is dropped, and with it everything that it has started.
    fn asked(&self, mut worker: Worker, line: &str, question: Question) -> Answered<String> {
        let answer = worker.ask(line, question)?;
        self.idle
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .push(worker);
        Ok(answer)
    }
}

impl Drop for Pool {
    fn drop(&mut self) {
        let workers = self.idle.get_mut().unwrap_or_else(PoisonError::into_inner);
        workers.iter_mut().for_each(Worker::say_farewell);
        workers.clear();
    }
}

impl Port for Pool {
    fn identity(&self) -> String {
        self.command.identity()
    }

    fn ask(&self, line: &str, question: Question) -> Answered<String> {
        if self.in_vain.load(Ordering::Relaxed) >= IN_VAIN {
            return Err(Failure::new(
                Fault::Hung,
                format!("gave no answer to {IN_VAIN} questions in a row, and is asked no more"),
            ));
        }
        let answer = match self.idle() {
            None => self.asked_anew(line, question),
            // Whether a worker that was asked before ends here may depend on what it was asked before, and so on the number of
            // threads. A new one answers this question alone.
            Some(worker) => match self.asked(worker, line, question) {
                Err(failure) if failure.fault == Fault::Ended => self.asked_anew(line, question),
                answer => answer,
            },
        };
        match &answer {
            Err(failure) if failure.fault == Fault::Hung => {
                self.in_vain.fetch_add(1, Ordering::Relaxed);
            }
            _ => self.in_vain.store(0, Ordering::Relaxed),
        }
        answer
    }

    fn folder(&self) -> Option<&Path> {
        Some(self.command.folder())
    }
}
