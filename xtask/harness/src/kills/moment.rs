//! Running a program and killing it at a moment.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant, SystemTime};

use rand::RngExt;
use rand_pcg::Pcg64Mcg;

/// How often a running program is looked at: well below the time that a small file takes.
const POLL: Duration = Duration::from_micros(200);
/// How long the rows of a killed reproduction may take to notice.
const PATIENCE: Duration = Duration::from_secs(5);

/// How long a program runs when nobody disturbs it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Times {
    /// From start to end.
    whole: Duration,
    /// From the first change of a watched folder to the end.
    writing: Duration,
}

/// When a program is killed.
#[derive(Clone, Copy, Debug)]
pub(super) enum Moment {
    /// So long after its start.
    Running(Duration),
    /// So long after the first change of a watched folder: most of a run writes nothing.
    Writing(Duration),
}

/// Who is killed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Victim {
    /// The program; what it started has to notice.
    Program,
    /// The program and all that it started.
    Group,
}

/// How a program ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ended {
    /// By the kill.
    Killed,
    /// By itself, before the moment.
    Before,
}

impl Times {
    /// Returns a moment: every other one somewhere in the whole run, the others while files are
    /// written.
    pub(super) fn moment(&self, trial: u32, random: &mut Pcg64Mcg) -> Moment {
        let share: f64 = random.random();
        if trial.is_multiple_of(2) {
            Moment::Running(self.whole.mul_f64(share))
        } else {
            Moment::Writing(self.writing.mul_f64(share))
        }
    }
}

/// Runs a command to its good end and returns how long that took.
pub(super) fn undisturbed(command: &mut Command, watched: &[PathBuf]) -> Result<Times, String> {
    let before = changes(watched);
    let started = Instant::now();
    let mut child = start(command)?;
    let mut first = None;
    let status = loop {
        if first.is_none() && changes(watched) != before {
            first = Some(Instant::now());
        }
        if let Some(status) = ended(&mut child)? {
            break status;
        }
        std::thread::sleep(POLL);
    };
    if !status.success() {
        return Err(format!("{command:?} ended with {status}"));
    }
    Ok(Times {
        whole: started.elapsed(),
        writing: first.unwrap_or(started).elapsed(),
    })
}

/// Starts a command and kills it at `moment`.
pub(super) fn killed(
    command: &mut Command,
    watched: &[PathBuf],
    moment: Moment,
    victim: Victim,
) -> Result<(Ended, u32), String> {
    let before = changes(watched);
    let mut since = Instant::now();
    let mut child = start(command)?;
    let group = child.id();
    let mut is_waiting = matches!(moment, Moment::Writing(_));
    let (Moment::Running(after) | Moment::Writing(after)) = moment;
    loop {
        if ended(&mut child)?.is_some() {
            return Ok((Ended::Before, group));
        }
        if is_waiting && changes(watched) != before {
            is_waiting = false;
            since = Instant::now();
        }
        if !is_waiting && since.elapsed() >= after {
            break;
        }
        let left = after.saturating_sub(since.elapsed());
        std::thread::sleep(if is_waiting { POLL } else { POLL.min(left) });
    }
    if victim == Victim::Group {
        let script = format!("kill -KILL -{group}");
        let sent = Command::new("/bin/sh").args(["-c", &script]).status();
        sent.map_err(|e| format!("nobody could be killed: {e}"))?;
    }
    child.kill().map_err(|e| format!("cannot be killed: {e}"))?;
    let status = child.wait().map_err(|e| format!("was lost: {e}"))?;
    let by_itself = status.code().is_some();
    let ended = if by_itself {
        Ended::Before
    } else {
        Ended::Killed
    };
    Ok((ended, group))
}

/// Returns whether anything that a killed program had started goes on.
pub(super) fn goes_on(group: u32) -> bool {
    let started = Instant::now();
    while living(group) > 0 {
        if started.elapsed() > PATIENCE {
            return true;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    false
}

fn start(command: &mut Command) -> Result<Child, String> {
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(command, 0);
    command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .map_err(|e| format!("{command:?} cannot be started: {e}"))
}

fn ended(child: &mut Child) -> Result<Option<ExitStatus>, String> {
    child.try_wait().map_err(|e| format!("was lost: {e}"))
}

/// Returns when the watched folders last changed.
fn changes(watched: &[PathBuf]) -> Vec<Option<SystemTime>> {
    let last = |folder: &PathBuf| folder.metadata().and_then(|m| m.modified()).ok();
    watched.iter().map(last).collect()
}

/// Returns the number of living processes of a group, 0 where the system does not tell.
fn living(group: u32) -> usize {
    let Ok(entries) = Path::new("/proc").read_dir() else {
        return 0;
    };
    let stat = |entry: std::io::Result<std::fs::DirEntry>| {
        let text = std::fs::read_to_string(entry.ok()?.path().join("stat")).ok()?;
        // After the name in parentheses: state, parent, group.
        let mut fields = text.rsplit_once(')')?.1.split_whitespace();
        let state = fields.next()?.to_owned();
        Some((state, fields.nth(1)?.parse::<u32>().ok()?))
    };
    let stats = entries.filter_map(stat);
    stats.filter(|(s, g)| *g == group && s != "Z").count()
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    fn shell(script: &str) -> Command {
        let mut command = Command::new("/bin/sh");
        command.args(["-c", script]);
        command
    }

    #[test]
    fn a_program_is_killed_at_its_moment_or_ends_before() {
        let moment = Moment::Running(Duration::from_millis(50));
        let (ended, _) = killed(&mut shell("exec sleep 20"), &[], moment, Victim::Program).unwrap();
        assert_eq!(ended, Ended::Killed);
        let late = Moment::Running(Duration::from_secs(20));
        let (ended, _) = killed(&mut shell("exit 0"), &[], late, Victim::Program).unwrap();
        assert_eq!(ended, Ended::Before);
        assert!(undisturbed(&mut shell("exit 3"), &[]).is_err());
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn what_a_killed_program_left_running_is_seen() {
        let moment = Moment::Running(Duration::from_millis(300));
        let script = "sleep 20 & wait";
        let (_, group) = killed(&mut shell(script), &[], moment, Victim::Program).unwrap();
        assert_eq!(living(group), 1);
        shell(&format!("kill -KILL -{group}")).status().unwrap();
        assert!(!goes_on(group));
        let (_, group) = killed(&mut shell(script), &[], moment, Victim::Group).unwrap();
        assert!(!goes_on(group));
    }

    #[test]
    fn writing_is_seen() {
        let folder = tempfile::tempdir().unwrap();
        let watched = [folder.path().to_owned()];
        let file = folder.path().join("x");
        let script = format!("sleep 0.3; : > {}; sleep 20", file.display());
        let moment = Moment::Writing(Duration::ZERO);
        let (ended, _) = killed(&mut shell(&script), &watched, moment, Victim::Group).unwrap();
        assert_eq!(ended, Ended::Killed);
        assert!(file.exists());
    }
}
