//! The program in a process of its own, watched.

use std::io::Read;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

/// A case that computes for longer hangs: the slowest takes a few seconds.
const LIMIT: Duration = Duration::from_secs(60);
/// The same for a case that waits, or whose time the system does not tell: other work may run beside it.
const PATIENCE: Duration = Duration::from_secs(600);
/// Resident bytes beyond which a case is ended: the largest sound one takes 1 GB.
const MEMORY: u64 = 4 << 30;
/// How often a process is looked at.
const POLL: Duration = Duration::from_millis(4);

/// How a process ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum End {
    /// With this exit code.
    Code(i32),
    /// Otherwise, as the text says.
    Fault(String),
}

/// What a process left.
#[derive(Clone, Debug)]
pub(super) struct Ended {
    pub(super) end: End,
    pub(super) out: String,
    pub(super) err: String,
}

/// Runs the program in a folder, on one thread.
///
/// # Errors
/// A program that cannot be started.
pub(super) fn run(program: &Path, arguments: &[String], folder: &Path) -> std::io::Result<Ended> {
    let mut child = Command::new(program)
        .args(arguments)
        .current_dir(folder)
        .env("RAYON_NUM_THREADS", "1")
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()?;
    let (out, err) = (collect(child.stdout.take()), collect(child.stderr.take()));
    let end = watch(&mut child)?;
    let text = |thread: std::thread::JoinHandle<String>| thread.join().unwrap_or_default();
    Ok(Ended {
        end,
        out: text(out),
        err: text(err),
    })
}

fn collect(stream: Option<impl Read + Send + 'static>) -> std::thread::JoinHandle<String> {
    std::thread::spawn(move || {
        let mut bytes = Vec::new();
        // What came until the pipe broke is all there is.
        let _ = stream.map(|mut stream| stream.read_to_end(&mut bytes));
        String::from_utf8_lossy(&bytes).into_owned()
    })
}

fn watch(child: &mut Child) -> std::io::Result<End> {
    let started = Instant::now();
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok(end_of(status));
        }
        let hangs = computed(child.id()) > LIMIT || started.elapsed() > PATIENCE;
        let fault = if hangs {
            format!("it ran for more than {} s", LIMIT.as_secs())
        } else if resident(child.id()) > MEMORY {
            format!("it took more than {} GiB of memory", MEMORY >> 30)
        } else {
            std::thread::sleep(POLL);
            continue;
        };
        // It may have ended by itself in between.
        let _ = child.kill();
        child.wait()?;
        return Ok(End::Fault(fault));
    }
}

fn end_of(status: ExitStatus) -> End {
    match status.code() {
        Some(code) => End::Code(code),
        None => End::Fault(format!("it crashed ({status})")),
    }
}

/// Returns for how long a process has computed, zero where the system does not say.
fn computed(process: u32) -> Duration {
    /// Ticks of a second, where it matters.
    const TICKS: u64 = 100;
    let text = std::fs::read_to_string(format!("/proc/{process}/stat")).unwrap_or_default();
    // The name of the program stands in brackets, and may hold spaces.
    let after_name = text.rsplit_once(')').map_or("", |(_, rest)| rest);
    let fields = after_name.split_whitespace().skip(11).take(2);
    let ticks: u64 = fields.filter_map(|n| n.parse::<u64>().ok()).sum();
    Duration::from_millis(1000 * ticks / TICKS)
}

/// Returns the resident bytes of a process, 0 where the system does not say.
fn resident(process: u32) -> u64 {
    /// Bytes of a page, where it matters.
    const PAGE: u64 = 4096;
    let text = std::fs::read_to_string(format!("/proc/{process}/statm")).unwrap_or_default();
    let pages = text.split(' ').nth(1).and_then(|n| n.parse::<u64>().ok());
    pages.unwrap_or(0) * PAGE
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    #[cfg(target_os = "linux")]
    fn the_time_of_a_process_is_what_it_computed() {
        let mut busy = Command::new("/bin/sh")
            .args(["-c", "while :; do :; done"])
            .spawn()
            .expect("started");
        let mut idle = Command::new("/bin/sleep")
            .arg("100")
            .spawn()
            .expect("started");
        let started = Instant::now();
        while computed(busy.id()).is_zero() && started.elapsed() < LIMIT {
            std::thread::sleep(POLL);
        }
        let times = [busy.id(), idle.id()].map(computed);
        for child in [&mut busy, &mut idle] {
            child.kill().expect("running");
            child.wait().expect("a child");
        }
        assert!(times[0] > times[1], "{times:?}");
    }

    #[test]
    fn a_code_and_a_crash_are_told_apart() {
        let shell = |script: &str| {
            let arguments = ["-c", script].map(str::to_owned);
            run(Path::new("/bin/sh"), &arguments, Path::new(".")).expect("started")
        };
        let ended = shell("echo a; echo b >&2; exit 3");
        assert_eq!(
            (ended.end, ended.out, ended.err),
            (End::Code(3), "a\n".into(), "b\n".into())
        );
        let End::Fault(text) = shell("kill -SEGV $$").end else {
            panic!("a crash has no code");
        };
        assert!(text.contains("signal: 11"), "{text}");
    }
}
