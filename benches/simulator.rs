//! Measures what the protocol of a simulator of one's own costs: answers of ten and of 40,000 numbers, two workers.
//!
//! `cargo bench --bench simulator`. The simulator is a script of Python that computes nothing; without Python nothing is measured.
#![allow(clippy::unwrap_used)]
#![allow(clippy::print_stdout, reason = "it is a table for people")]

use std::sync::Arc;
use std::time::Instant;

use realgap::guest::{CommandLine, Guest, Pool};
use realgap::robot::morphology::Assembly;
use realgap::simulation::{Experiment, Sampling, SimulatorChoice};

const WORKERS: usize = 2;
const SCRIPT: &str = r#"
import base64, json, sys
from array import array
packed = {}
for line in sys.stdin:
    asked = json.loads(line)
    if asked["ask"] == "hello":
        print('{"realgap":1,"name":"idle","parameters":[{"name":"k","from":0,"to":1,"default":0}]}', flush=True)
        continue
    times = asked["times_s"]
    channels = int(sys.argv[1]) // len(times)
    if len(times) < 16:
        values = [[float(t) for t in times] for _ in range(channels)]
    else:
        values = [{"base64_f64": base64.b64encode(array("d", times).tobytes()).decode()} for _ in range(channels)]
    answer = {"id": asked["id"], "channels": {f"c{n}": v for n, v in enumerate(values)}}
    sys.stdout.write(json.dumps(answer) + "\n")
    sys.stdout.flush()
"#;

/// Mean time of an answer of `numbers` in channels of `samples`, milliseconds, with all workers asked at once.
fn time_ms(samples: usize, numbers: usize, asked: usize) -> Option<f64> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("idle.py"), SCRIPT).unwrap();
    let words = ["python3", "idle.py", &numbers.to_string()].map(str::to_owned);
    let command = CommandLine::new(words.to_vec(), folder.path(), &[]).unwrap();
    let guest = Arc::new(Guest::new(Arc::new(Pool::new(command))).ok()?);
    let mut experiment = Experiment::new(Assembly::empty());
    experiment.duration_s = 1.0;
    let times_s = (0..samples).map(|k| k as f64 / (samples - 1) as f64);
    experiment.sampling = Sampling::Times(times_s.collect());
    experiment.foreign.values = guest.defaults();
    experiment.simulator = SimulatorChoice::new(guest);
    let ask = |times: usize| {
        for _ in 0..times {
            let run = realgap::simulation::run(&experiment).unwrap();
            assert!(run.outcome.is_completed(), "{:?}", run.outcome.divergence());
        }
    };
    let all = |times: usize| {
        std::thread::scope(|scope| {
            for _ in 0..WORKERS {
                scope.spawn(|| ask(times));
            }
        });
    };
    all(10);
    let begun = Instant::now();
    all(asked);
    Some(1e3 * begun.elapsed().as_secs_f64() / (WORKERS * asked) as f64)
}

fn main() {
    println!("numbers  ms per answer, {WORKERS} workers");
    for (samples, numbers, asked) in [(10, 10, 5000), (1000, 40_000, 200), (10_000, 40_000, 200)] {
        match time_ms(samples, numbers, asked) {
            Some(ms) => println!("{numbers:7}  {ms:.3} ({samples} samples)"),
            None => println!("SKIPPED: no python3"),
        }
    }
}
