//! Runs the scripts of `contrib/slurm` on a real Slurm, which the test starts (Debian's
//! `slurm-wlm`, as root).

use std::fs::{self, File};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::run::binary;
use crate::{SCENE, compare_with_a_single_run, empty_folder, output, root};

/// Samples per pixel, enough for each task to take a few seconds.
const SAMPLES: &str = "192";
const PARTS: &str = "4";
const SIZE: &str = "256x256";

/// A step that takes longer than this is stuck.
const TIMEOUT: Duration = Duration::from_secs(300);

/// The configuration, with the placeholders `@FOLDER@` and `@HOST@`.
const CONFIGURATION: &str = include_str!("slurm.conf");

/// The reason why Slurm cannot start here, if any.
pub(crate) fn why_not() -> Option<&'static str> {
    let is_there = |program: &str| {
        let path = std::env::var_os("PATH").unwrap_or_default();
        let folders = std::env::split_paths(&path).chain(["/usr/sbin".into()]);
        folders.into_iter().any(|folder| folder.join(program).is_file())
    };
    let user = Command::new("id").arg("-u").output();
    if !["munged", "slurmctld", "slurmd", "sbatch"].into_iter().all(is_there) {
        Some("slurm-wlm is not installed")
    } else if !user.is_ok_and(|output| output.stdout.starts_with(b"0\n")) {
        Some("only root can start a private Slurm")
    } else {
        None
    }
}

/// Starts Slurm, renders a scene as an array, kills and requeues one task, and compares the merged
/// picture with that of a single run.
pub(crate) fn run() -> Result<(), String> {
    let folder = empty_folder("slurm")?;
    let picture = folder.join("merged.pfm");
    let cluster = Cluster::start(&folder.join("cluster"))?;
    let merge = cluster.submit(&picture)?;
    cluster.kill_one_task(&folder.join("merged.pfm.parts/2.part.checkpoint"))?;
    cluster.wait_for(&merge)?;

    let log = fs::read_to_string(folder.join("merged.pfm.parts/2.log")).map_err(text)?;
    if !log.contains("resuming from") {
        return Err(format!("the killed task did not resume from its checkpoint:\n{log}"));
    }
    compare_with_a_single_run(&picture, &["--spp", SAMPLES, "--size", SIZE])
}

/// A running Slurm, which stops on drop.
struct Cluster {
    configuration: PathBuf,
    daemons: Vec<Child>,
}

impl Cluster {
    fn start(folder: &Path) -> Result<Self, String> {
        for name in ["spool", "state", "log"] {
            fs::create_dir_all(folder.join(name)).map_err(text)?;
        }
        let host = output(&mut Command::new("hostname"))?;
        let filled = CONFIGURATION
            .replace("@FOLDER@", &folder.display().to_string())
            .replace("@HOST@", host.trim());
        let configuration = folder.join("slurm.conf");
        fs::write(&configuration, filled).map_err(text)?;
        let run = "/run/munge";
        output(
            Command::new("install").args(["-d", "-o", "munge", "-g", "munge", "-m", "755", run]),
        )?;

        let mut cluster = Self { configuration, daemons: Vec::new() };
        let log = |name: &str| File::create(folder.join("log").join(name)).map_err(text);
        let mut munged = Command::new("runuser");
        munged.args(["-u", "munge", "--", "/usr/sbin/munged", "--foreground"]);
        cluster.start_daemon(munged, log("munged.log")?)?;
        wait_until("munged", || Path::new("/run/munge/munge.socket.2").exists())?;
        let mut controller = Command::new("/usr/sbin/slurmctld");
        controller.args(["-D", "-c", "-f"]).arg(&cluster.configuration);
        cluster.start_daemon(controller, log("controller.out")?)?;
        let mut worker = Command::new("/usr/sbin/slurmd");
        worker.args(["-D", "-N", host.trim(), "-f"]).arg(&cluster.configuration);
        cluster.start_daemon(worker, log("worker.out")?)?;
        wait_until("an idle node", || {
            cluster.output("sinfo", &["-h", "-o", "%t"]).is_ok_and(|state| state.trim() == "idle")
        })?;
        Ok(cluster)
    }

    fn start_daemon(&mut self, mut daemon: Command, log: File) -> Result<(), String> {
        let errors = log.try_clone().map_err(text)?;
        daemon.stdin(Stdio::null()).stdout(log).stderr(errors);
        match daemon.spawn() {
            Ok(child) => self.daemons.push(child),
            Err(error) => return Err(format!("{:?}: {error}", daemon.get_program())),
        }
        Ok(())
    }

    /// A Slurm command with this configuration.
    fn command(&self, program: &str, arguments: &[&str]) -> Command {
        let mut command = Command::new(program);
        command.args(arguments).env("SLURM_CONF", &self.configuration).stdin(Stdio::null());
        command
    }

    fn output(&self, program: &str, arguments: &[&str]) -> Result<String, String> {
        output(&mut self.command(program, arguments))
    }

    /// Submits the render like a user; returns the id of the merge job.
    fn submit(&self, picture: &Path) -> Result<String, String> {
        let script = root().join("contrib/slurm/submit.sh");
        let mut submit = self.command("sh", &[]);
        submit.arg(script).arg(root().join(SCENE)).arg(picture).args([SAMPLES, PARTS]);
        submit.args(["--size", SIZE, "--checkpoint-every", "200ms"]);
        let id = output(submit.env("ETENDUE", binary()))?;
        Ok(id.trim().to_owned())
    }

    /// Kills and requeues the second task once it has written a checkpoint.
    fn kill_one_task(&self, checkpoint: &Path) -> Result<(), String> {
        wait_until("a checkpoint of the second task", || checkpoint.exists())?;
        let jobs = self.output("squeue", &["-h", "-r", "-o", "%F_%K", "-n", "etendue"])?;
        let task = jobs.lines().find(|line| line.ends_with("_2"));
        let task = task.ok_or("the second task ended too early")?.to_owned();
        // Let it render more than its first pass, so that a restart from zero would show.
        sleep(Duration::from_secs(2));
        self.output("scontrol", &["requeue", &task])?;
        wait_until("the requeued task", || {
            let state = self.output("squeue", &["-h", "-r", "-o", "%F_%K %t %r"]);
            state.is_ok_and(|state| state.contains(&format!("{task} PD BeginTime")))
        })?;
        // By default Slurm delays a requeued task by two minutes.
        self.output("scontrol", &["update", &format!("JobId={task}"), "StartTime=now"])?;
        Ok(())
    }

    /// Waits for a job, which must complete successfully.
    fn wait_for(&self, job: &str) -> Result<(), String> {
        let mut state = String::new();
        wait_until("the merge job", || {
            let shown = self.output("scontrol", &["show", "job", job]).unwrap_or_default();
            let word = shown.split_whitespace().find_map(|word| word.strip_prefix("JobState="));
            state = word.unwrap_or_default().to_owned();
            !matches!(state.as_str(), "" | "PENDING" | "RUNNING" | "CONFIGURING" | "COMPLETING")
        })?;
        if state == "COMPLETED" { Ok(()) } else { Err(format!("the merge job is {state}")) }
    }
}

impl Drop for Cluster {
    /// Terminates all daemons, the worker first, and kills those still running after ten seconds.
    fn drop(&mut self) {
        for daemon in self.daemons.iter().rev() {
            let _ = Command::new("kill").args(["-TERM", &daemon.id().to_string()]).status();
        }
        let started = Instant::now();
        for daemon in &mut self.daemons {
            let has_ended = |daemon: &mut Child| daemon.try_wait().is_ok_and(|end| end.is_some());
            while !has_ended(daemon) && started.elapsed() < Duration::from_secs(10) {
                sleep(Duration::from_millis(50));
            }
            let _ = daemon.kill();
            let _ = daemon.wait();
        }
    }
}

fn wait_until(what: &str, mut is_so: impl FnMut() -> bool) -> Result<(), String> {
    let started = Instant::now();
    while !is_so() {
        if started.elapsed() > TIMEOUT {
            return Err(format!("timed out waiting for {what}"));
        }
        sleep(Duration::from_millis(50));
    }
    Ok(())
}

fn text(error: std::io::Error) -> String {
    match error.kind() {
        ErrorKind::NotFound => "a file is missing".to_owned(),
        _ => error.to_string(),
    }
}
