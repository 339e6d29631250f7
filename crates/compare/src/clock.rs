//! Phase times and what the process has used.

use std::collections::BTreeMap;
use std::time::Instant;

use crate::record::Seconds;

/// Wall time per phase: one phase runs at a time, and entering one leaves the one before.
#[derive(Debug)]
pub struct PhaseClock {
    process_start: Instant,
    entered: Instant,
    current: Option<&'static str>,
    phases: BTreeMap<String, f64>,
}

impl PhaseClock {
    /// Returns a clock without a phase; `process_start` is where the total begins.
    #[must_use]
    pub fn start(process_start: Instant) -> Self {
        Self {
            process_start,
            entered: Instant::now(),
            current: None,
            phases: BTreeMap::new(),
        }
    }

    /// Enters `phase`; the time until now belongs to the phase before.
    pub fn enter(&mut self, phase: &'static str) {
        if self.current != Some(phase) {
            self.leave();
            self.current = Some(phase);
        }
    }

    /// Leaves the present phase; the time until the next one counts only in the total.
    pub fn leave(&mut self) {
        let now = Instant::now();
        if let Some(phase) = self.current.take() {
            let seconds = now.duration_since(self.entered).as_secs_f64();
            *self.phases.entry(phase.to_owned()).or_insert(0.0) += seconds;
        }
        self.entered = now;
    }

    /// Returns the times so far.
    pub fn read(&mut self) -> Seconds {
        let current = self.current;
        self.leave();
        self.current = current;
        Seconds {
            total: self.process_start.elapsed().as_secs_f64(),
            cpu: process_usage().cpu_seconds,
            phases: self.phases.clone(),
        }
    }
}

/// What the process has used since its start.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Usage {
    /// User and system time of all threads; 0 where the system does not say.
    pub cpu_seconds: f64,
    /// Largest resident memory; 0 where the system does not say.
    pub peak_rss_bytes: u64,
}

/// Returns what this process has used.
#[cfg(unix)]
#[must_use]
pub fn process_usage() -> Usage {
    use nix::sys::resource::{UsageWho, getrusage};
    use nix::sys::time::TimeValLike;
    // Linux counts kibibytes, the BSDs too; only Apple's systems count bytes.
    const RSS_UNIT: u64 = if cfg!(target_vendor = "apple") {
        1
    } else {
        1024
    };
    getrusage(UsageWho::RUSAGE_SELF).map_or_else(
        |_| Usage::default(),
        |usage| {
            let micros =
                usage.user_time().num_microseconds() + usage.system_time().num_microseconds();
            Usage {
                cpu_seconds: micros as f64 * 1e-6,
                peak_rss_bytes: usage.max_rss().unsigned_abs() * RSS_UNIT,
            }
        },
    )
}

/// Returns what this process has used: unknown on this system.
#[cfg(not(unix))]
#[must_use]
pub fn process_usage() -> Usage {
    Usage::default()
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn phases_add_up_and_leave_out_what_lies_between() {
        let start = Instant::now();
        let mut clock = PhaseClock::start(start);
        clock.enter("fit");
        std::thread::sleep(Duration::from_millis(4));
        clock.enter("fit");
        clock.enter("write");
        clock.leave();
        std::thread::sleep(Duration::from_millis(4));
        clock.enter("fit");
        let seconds = clock.read();
        let sum: f64 = seconds.phases.values().sum();
        assert!(
            seconds.phases["fit"] >= 0.004 && sum <= seconds.total - 0.004,
            "{seconds:?}"
        );
    }

    #[cfg(unix)]
    #[test]
    fn a_running_process_has_used_memory() {
        assert!(process_usage().peak_rss_bytes > 100_000);
    }
}
