//! A real Slurm runs plans to the end, even when jobs and nodes are killed. Its controller and node run on this machine, as root,
//! during the test.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use common::{SMALL_SEARCH, must_be_equal, quick_study, realgap, search_file, skipped, text};

/// Longest time until a plan is answered.
const PATIENCE: Duration = Duration::from_secs(300);

/// A cluster of one node.
struct Cluster {
    folder: PathBuf,
    host: String,
    controller: Child,
    node: Child,
}

fn program(name: &str) -> Option<PathBuf> {
    ["/usr/sbin", "/usr/bin", "/usr/local/sbin", "/usr/local/bin"]
        .iter()
        .map(|folder| Path::new(folder).join(name))
        .find(|path| path.exists())
}

fn free_port() -> u16 {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    listener.local_addr().unwrap().port()
}

impl Cluster {
    /// Starts a cluster, or prints why it cannot.
    fn start(folder: &Path) -> Option<Self> {
        let is_root = Command::new("id").arg("-u").output().unwrap().stdout == b"0\n";
        if program("slurmctld").is_none() || program("slurmd").is_none() || !is_root {
            skipped(
                "Slurm (Debian: slurmctld slurmd slurm-client) is not here, or this is not root",
            );
            return None;
        }
        let host = text(&Command::new("hostname").arg("-s").output().unwrap().stdout);
        let host = host.trim().to_owned();
        let folder = folder.join("slurm");
        for name in ["spool", "state"] {
            std::fs::create_dir_all(folder.join(name)).unwrap();
        }
        let at = folder.display();
        let (controller_port, node_port) = (free_port(), free_port());
        let text = format!(
            "ClusterName=trial\nSlurmctldHost={host}(127.0.0.1)\nSlurmUser=root\nSlurmdUser=root\n\
             AuthType=auth/none\nCredType=cred/none\nProctrackType=proctrack/linuxproc\nTaskPlugin=task/none\n\
             SelectType=select/cons_tres\nSelectTypeParameters=CR_CPU\nSwitchType=switch/none\nMpiDefault=none\n\
             SlurmctldPort={controller_port}\nSlurmdPort={node_port}\n\
             SlurmctldPidFile={at}/controller.pid\nSlurmdPidFile={at}/node.pid\n\
             SlurmdSpoolDir={at}/spool\nStateSaveLocation={at}/state\n\
             SlurmctldLogFile={at}/controller.log\nSlurmdLogFile={at}/node.log\n\
             ReturnToService=2\nJobRequeue=1\nSlurmdTimeout=10\nKillWait=2\nMinJobAge=300\n\
             SchedulerParameters=batch_sched_delay=1,sched_interval=2\n\
             AccountingStorageType=accounting_storage/none\nJobAcctGatherType=jobacct_gather/none\n\
             NodeName={host} NodeAddr=127.0.0.1 CPUs=2 RealMemory=1000 State=UNKNOWN\n\
             PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP\n"
        );
        std::fs::write(folder.join("slurm.conf"), text).unwrap();
        let controller = daemon(&folder, "slurmctld", &["-D", "-c"]);
        let node = daemon(&folder, "slurmd", &["-D", "-N", &host]);
        let cluster = Self {
            folder,
            host,
            controller,
            node,
        };
        let begun = Instant::now();
        while !cluster.slurm(&["sinfo", "-h", "-o", "%T"]).contains("idle") {
            if begun.elapsed() > Duration::from_secs(60) {
                let log = std::fs::read_to_string(cluster.folder.join("controller.log"));
                let last = log
                    .unwrap_or_default()
                    .lines()
                    .last()
                    .unwrap_or("")
                    .to_owned();
                skipped(&format!("Slurm does not start here: {last}"));
                return None;
            }
            std::thread::sleep(Duration::from_millis(300));
        }
        Some(cluster)
    }

    fn slurm(&self, words: &[&str]) -> String {
        let said = Command::new(words[0])
            .args(&words[1..])
            .env("SLURM_CONF", self.folder.join("slurm.conf"))
            .output()
            .unwrap();
        text(&said.stdout) + &text(&said.stderr)
    }

    fn wait(&self, what: &str, is: impl Fn() -> bool) {
        let begun = Instant::now();
        while !is() {
            assert!(
                begun.elapsed() < PATIENCE,
                "never: {what}\n{}\n{}",
                self.slurm(&["squeue"]),
                self.logs()
            );
            std::thread::sleep(Duration::from_millis(300));
        }
    }

    /// The output of the jobs.
    fn logs(&self) -> String {
        let mut all = String::new();
        let plan = self.folder.parent().unwrap().join("plan");
        for entry in std::fs::read_dir(plan.join("slurm/logs"))
            .into_iter()
            .flatten()
            .flatten()
        {
            all += &std::fs::read_to_string(entry.path()).unwrap_or_default();
        }
        all
    }

    fn submit(&self, plan: &str) {
        let said = realgap()
            .args([
                "cluster",
                "submit",
                "slurm",
                plan,
                "--go",
                "--partition",
                "main",
            ])
            .env("SLURM_CONF", self.folder.join("slurm.conf"))
            .output()
            .unwrap();
        assert!(said.status.success(), "{}", text(&said.stderr));
        assert!(
            text(&said.stdout).contains("its merge is job"),
            "{}",
            text(&said.stdout)
        );
    }

    fn wait_for_the_answer(&self, plan: &str) {
        self.wait("the plan is answered", || {
            !status(plan, "--answered").is_empty()
        });
        // The command itself writes more after its store is complete.
        self.wait("no job is left", || {
            self.slurm(&["squeue", "-h"]).trim().is_empty()
        });
    }
}

impl Drop for Cluster {
    fn drop(&mut self) {
        let _best_effort = self.slurm(&["scancel", "-u", "root"]);
        for child in [&mut self.node, &mut self.controller] {
            let _best_effort = child.kill();
            let _best_effort = child.wait();
        }
    }
}

fn daemon(folder: &Path, name: &str, words: &[&str]) -> Child {
    Command::new(program(name).unwrap())
        .args(words)
        .env("SLURM_CONF", folder.join("slurm.conf"))
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap()
}

fn status(plan: &str, what: &str) -> String {
    let said = realgap()
        .args(["cluster", "status", plan, what])
        .output()
        .unwrap();
    assert!(said.status.success(), "{}", text(&said.stderr));
    text(&said.stdout).trim().to_owned()
}

fn run(words: &[&str]) {
    let said = realgap().args(words).output().unwrap();
    assert!(said.status.success(), "{words:?}: {}", text(&said.stderr));
}

#[test]
fn a_search_goes_through_its_generations_and_a_sweep_through_requeues_and_dead_nodes() {
    if !common::is_long_run("Slurm") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let Some(mut cluster) = Cluster::start(folder.path()) else {
        return;
    };
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();

    // A search: every generation is an array of its own, submitted by the merge of the one before.
    let search = search_file(folder.path(), SMALL_SEARCH);
    let search = search.to_str().unwrap();
    run(&["search", search, "-o", &at("search")]);
    let plan = at("plan");
    run(&[
        "cluster",
        "plan",
        search,
        "--shards",
        "3",
        "--no-measure",
        "-o",
        &plan,
    ]);
    cluster.submit(&plan);
    cluster.wait_for_the_answer(&plan);
    must_be_equal(
        &folder.path().join("search"),
        &folder.path().join("plan/results"),
    );
    std::fs::remove_dir_all(&plan).unwrap();

    // A sweep with a shard requeued, another killed, and the daemon of the node killed and started again.
    let study = quick_study(folder.path(), 4);
    let long = std::fs::read_to_string(&study)
        .unwrap()
        .replace("duration_s: 0.25", "duration_s: 16.0");
    std::fs::write(&study, long).unwrap();
    let study = study.to_str().unwrap();
    let options = ["--score", "single", "--metric", "rms"];
    run(&[&["sweep", study, "-o", &at("sweep")][..], &options].concat());
    run(&[
        &[
            "cluster",
            "plan",
            study,
            "--shards",
            "4",
            "--no-measure",
            "-o",
            &plan,
            "--",
        ][..],
        &options,
    ]
    .concat());
    cluster.submit(&plan);
    let is_begun = |shard: &str| {
        let store = Path::new(&plan).join(format!(
            "shards/round_0000/shard_0000{shard}/results.sqlite"
        ));
        store.exists()
    };
    cluster.wait("two shards are at work", || is_begun("0") && is_begun("1"));
    let jobs = cluster.slurm(&["squeue", "-h", "-r", "-t", "R", "-o", "%F_%K %A"]);
    let running: Vec<&str> = jobs.lines().collect();
    let (first, _) = running[0].split_once(' ').unwrap();
    let said = cluster.slurm(&["scontrol", "requeue", first]);
    assert!(said.trim().is_empty(), "{said}");
    let _maybe_done = Command::new("pkill")
        .args(["-9", "-f", &format!("run {plan} --shard 1")])
        .status();
    std::thread::sleep(Duration::from_millis(500));
    cluster.node.kill().unwrap();
    cluster.node.wait().unwrap();
    cluster.node = daemon(&cluster.folder, "slurmd", &["-D", "-N", &cluster.host]);
    // A requeued job waits for two minutes unless it is released.
    cluster.wait("the plan is answered", || {
        for job in cluster
            .slurm(&["squeue", "-h", "-r", "-t", "PD", "-o", "%i"])
            .lines()
        {
            let _best_effort = cluster.slurm(&[
                "scontrol",
                "update",
                &format!("JobId={job}"),
                "StartTime=now",
            ]);
        }
        !status(&plan, "--answered").is_empty()
    });
    cluster.wait_for_the_answer(&plan);
    must_be_equal(
        &folder.path().join("sweep"),
        &folder.path().join("plan/results"),
    );
    std::fs::remove_dir_all(&plan).unwrap();
    a_full_disk_costs_nothing_but_time(&cluster, folder.path(), study, &options);
}

/// A small file system that is mounted over a folder during a test.
struct SmallDisk(PathBuf);

impl SmallDisk {
    fn mount(folder: PathBuf, options: &str) -> Option<Self> {
        std::fs::create_dir_all(&folder).unwrap();
        let mut command = Command::new("mount");
        command
            .args(["-t", "tmpfs", "-o", options, "tmpfs"])
            .arg(&folder);
        let is_mounted = command.stderr(Stdio::null()).status().unwrap().success();
        is_mounted.then_some(Self(folder))
    }

    fn remount(&self, options: &str) {
        let options = format!("remount,{options}");
        let mut command = Command::new("mount");
        command.args(["-o", &options]).arg(&self.0);
        assert!(command.status().unwrap().success());
    }
}

impl Drop for SmallDisk {
    fn drop(&mut self) {
        let _best_effort = Command::new("umount").arg("-l").arg(&self.0).status();
    }
}

/// The sweep once more, with its shards on a disk that is full until the test frees space.
fn a_full_disk_costs_nothing_but_time(
    cluster: &Cluster,
    folder: &Path,
    study: &str,
    options: &[&str],
) {
    let plan = folder.join("plan").to_str().unwrap().to_owned();
    let cut = [
        "cluster",
        "plan",
        study,
        "--shards",
        "2",
        "--no-measure",
        "-o",
        &plan,
        "--",
    ];
    run(&[&cut[..], options].concat());
    let Some(disk) = SmallDisk::mount(Path::new(&plan).join("shards"), "size=64k") else {
        skipped("the full disk: nothing can be mounted here");
        return;
    };
    cluster.submit(&plan);
    cluster.wait("the jobs have given up", || {
        cluster.logs().contains("failed") && cluster.slurm(&["squeue", "-h"]).trim().is_empty()
    });
    let said = cluster.logs();
    assert!(said.contains("full"), "{said}");
    assert_eq!(status(&plan, "--answered"), "");
    disk.remount("size=64m");
    cluster.submit(&plan);
    cluster.wait_for_the_answer(&plan);
    must_be_equal(&folder.join("sweep"), &folder.join("plan/results"));
}
