//! Progress for people: a bar with phase, rate and remaining time on a terminal, plain lines
//! elsewhere, nothing when quiet. Everything goes to standard error.

use std::io::IsTerminal;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use indicatif::{HumanDuration, MultiProgress, ProgressBar, ProgressStyle};

/// Plain lines about a running phase come no faster than this.
const PLAIN_INTERVAL: Duration = Duration::from_secs(5);
/// Redraw of a bar whose phase gives no news.
const TICK: Duration = Duration::from_millis(120);

/// Where progress is shown.
#[derive(Clone, Debug)]
pub struct Display {
    style: Style,
}

/// How much is said, and how.
#[derive(Clone, Debug)]
enum Style {
    Quiet,
    Plain,
    Terminal(MultiProgress),
}

/// How talkative a program should be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verbosity {
    /// Errors only.
    Quiet,
    /// Bars on a terminal, plain lines elsewhere.
    Normal,
}

impl Display {
    /// Returns a display on standard error.
    #[must_use]
    pub fn new(verbosity: Verbosity) -> Self {
        let style = match verbosity {
            Verbosity::Quiet => Style::Quiet,
            Verbosity::Normal if std::io::stderr().is_terminal() => {
                Style::Terminal(MultiProgress::new())
            }
            Verbosity::Normal => Style::Plain,
        };
        Self { style }
    }

    /// Says one line.
    pub fn line(&self, text: &str) {
        match &self.style {
            Style::Quiet => {}
            Style::Plain => say(text),
            // A terminal that has gone away takes its lines along.
            Style::Terminal(bars) => drop(bars.println(text)),
        }
    }

    /// Starts showing how far `total` tasks are, below their own bars.
    #[must_use]
    pub fn overall(&self, total: usize) -> Overall {
        let bar = match &self.style {
            Style::Terminal(bars) => {
                let bar = bars.add(ProgressBar::new(total as u64));
                bar.set_style(overall_style());
                bar.enable_steady_tick(TICK);
                Some(bar)
            }
            Style::Quiet | Style::Plain => None,
        };
        Overall {
            display: self.clone(),
            bar,
            total,
            done: Mutex::new(Done::default()),
        }
    }

    /// Starts showing a task.
    #[must_use]
    pub fn task(&self, label: &str) -> Task {
        let bar = match &self.style {
            Style::Terminal(bars) => {
                let bar = bars.insert(0, ProgressBar::no_length());
                bar.set_prefix(label.to_owned());
                bar.enable_steady_tick(TICK);
                Some(bar)
            }
            Style::Quiet | Style::Plain => None,
        };
        Task {
            display: self.clone(),
            bar,
            label: label.to_owned(),
            phase: String::new(),
            phase_started: Instant::now(),
            phase_first: 0,
            said: Instant::now(),
        }
    }
}

/// How far all tasks are.
#[derive(Debug)]
pub struct Overall {
    display: Display,
    bar: Option<ProgressBar>,
    total: usize,
    done: Mutex<Done>,
}

/// Tasks that have ended.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Done {
    ran: usize,
    passed_over: usize,
    seconds: f64,
}

impl Done {
    /// Returns what is left of `total` tasks, as if those to come took as long as those so far.
    fn remaining(self, total: usize) -> Option<Duration> {
        let left = total.saturating_sub(self.ran + self.passed_over);
        let each = (self.ran > 0).then(|| self.seconds / self.ran as f64)?;
        Some(Duration::from_secs_f64(each * left as f64))
    }
}

impl Overall {
    /// Counts a task that ran for so many seconds.
    pub fn advance(&self, seconds: f64) {
        let done = self.count(|done| {
            done.ran += 1;
            done.seconds += seconds;
        });
        let (ended, total) = (done.ran + done.passed_over, self.total);
        if self.bar.is_none()
            && let Some(remaining) = done.remaining(total)
        {
            let remaining = remaining.as_secs();
            self.display.line(&format!(
                "{ended} of {total} rows, about {remaining} s remaining"
            ));
        }
    }

    /// Counts a task that took no time.
    pub fn passed_over(&self) {
        self.count(|done| done.passed_over += 1);
    }

    /// Ends the bar.
    pub fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }

    fn count(&self, change: impl FnOnce(&mut Done)) -> Done {
        let mut guard = self.done.lock().unwrap_or_else(|e| e.into_inner());
        change(&mut guard);
        let done = *guard;
        drop(guard);
        if let Some(bar) = &self.bar {
            bar.set_position((done.ran + done.passed_over) as u64);
            if let Some(remaining) = done.remaining(self.total) {
                bar.set_message(format!("about {} remaining", HumanDuration(remaining)));
            }
        }
        done
    }
}

/// A running task.
#[derive(Debug)]
pub struct Task {
    display: Display,
    bar: Option<ProgressBar>,
    label: String,
    phase: String,
    phase_started: Instant,
    phase_first: u64,
    said: Instant,
}

impl Task {
    /// Shows that `done` of `total` units of `phase` are finished; `total` 0 means unknown.
    pub fn show(&mut self, phase: &str, done: u64, total: u64, objective: Option<f64>) {
        let is_new = self.phase != phase;
        if is_new {
            phase.clone_into(&mut self.phase);
            self.phase_started = Instant::now();
            self.phase_first = done;
        }
        match &self.bar {
            Some(bar) => show_bar(bar, is_new, (phase, done, total, objective)),
            None if is_new || self.said.elapsed() >= PLAIN_INTERVAL => {
                self.said = Instant::now();
                let text = plain_line(
                    phase,
                    [self.phase_first, done, total],
                    self.phase_started.elapsed(),
                );
                self.display.line(&format!("{}: {text}", self.label));
            }
            None => {}
        }
    }

    /// Ends the task with a last line.
    pub fn finish(self, text: &str) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
        self.display.line(&format!("{}: {text}", self.label));
    }
}

fn show_bar(bar: &ProgressBar, is_new: bool, step: (&str, u64, u64, Option<f64>)) {
    let (phase, done, total, objective) = step;
    if is_new {
        bar.reset();
        bar.set_style(bar_style(total > 0));
    }
    if total > 0 {
        bar.set_length(total);
    }
    bar.set_position(done);
    if is_new {
        // What was done before the first news has no rate.
        bar.reset_eta();
    }
    match objective {
        Some(value) => bar.set_message(format!("{phase} ({value:.4e})")),
        None => bar.set_message(phase.to_owned()),
    }
}

fn overall_style() -> ProgressStyle {
    ProgressStyle::with_template("all rows [{bar:40}] {pos}/{len} {msg}, {elapsed} so far")
        .unwrap_or_else(|_| ProgressStyle::default_bar())
        .progress_chars("=> ")
}

fn bar_style(known: bool) -> ProgressStyle {
    let template = if known {
        "{prefix} {msg:24} [{bar:24}] {pos}/{len} {per_sec} remaining {eta}"
    } else {
        "{prefix} {msg:24} {spinner} {elapsed}"
    };
    ProgressStyle::with_template(template)
        .unwrap_or_else(|_| ProgressStyle::default_bar())
        .progress_chars("=> ")
}

/// Returns what is said about a phase of `[first, done, total]` units, `first` of which were done
/// when it was first heard of, `elapsed` ago.
fn plain_line(phase: &str, [first, done, total]: [u64; 3], elapsed: Duration) -> String {
    let seconds = elapsed.as_secs_f64();
    if done <= first || total == 0 || seconds <= 0.0 {
        return phase.to_owned();
    }
    let rate = (done - first) as f64 / seconds;
    let remaining = total.saturating_sub(done) as f64 / rate;
    format!("{phase} {done}/{total}, {rate:.1} per second, {remaining:.0} s remaining")
}

#[expect(
    clippy::print_stderr,
    reason = "plain progress is for people at standard error"
)]
fn say(text: &str) {
    eprintln!("{text}");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plain_line_tells_phase_rate_and_remaining_time() {
        let line = plain_line("select", [10, 40, 130], Duration::from_secs(10));
        assert_eq!(line, "select 40/130, 3.0 per second, 30 s remaining");
        assert_eq!(plain_line("read", [0, 0, 0], Duration::ZERO), "read");
    }

    #[test]
    fn what_remains_is_told_from_tasks_that_ran() {
        let done = Done {
            ran: 2,
            passed_over: 3,
            seconds: 10.0,
        };
        assert_eq!(done.remaining(9), Some(Duration::from_secs(20)));
        assert_eq!(Done::default().remaining(9), None);
    }

    #[test]
    fn both_bar_templates_are_understood() {
        for known in [true, false] {
            let bar = ProgressBar::hidden();
            bar.set_style(bar_style(known));
            show_bar(&bar, true, ("fit", 1, u64::from(known), Some(0.5)));
            assert_eq!(bar.message(), "fit (5.0000e-1)");
        }
    }
}
