//! Ctrl-C and the time limit: both ask for the best result so far.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Exit code of a program that an interrupt ended at once.
const INTERRUPTED: i32 = 130;

/// Tells whether a run should end with what it has.
#[derive(Clone, Debug)]
pub(crate) struct Interrupt {
    asked: Arc<AtomicBool>,
    deadline: Option<Instant>,
}

impl Interrupt {
    /// Listens for Ctrl-C: the first asks to stop, a second ends the program at once. The time
    /// limit counts from `process_start`.
    pub(crate) fn listen(process_start: Instant, time_limit: Option<f64>) -> Self {
        let asked = Arc::new(AtomicBool::new(false));
        let flag = Arc::clone(&asked);
        let listening = ctrlc::set_handler(move || {
            if flag.swap(true, Ordering::SeqCst) {
                std::process::exit(INTERRUPTED);
            }
            eprintln!("stopping with the best result so far; press Ctrl-C again to end at once");
        });
        if let Err(error) = listening {
            eprintln!("warning: Ctrl-C will end the program at once: {error}");
        }
        let deadline = time_limit
            .and_then(|seconds| Duration::try_from_secs_f64(seconds).ok())
            .and_then(|limit| process_start.checked_add(limit));
        Self { asked, deadline }
    }

    /// Returns whether the run should end.
    pub(crate) fn is_due(&self) -> bool {
        self.asked.load(Ordering::SeqCst) || self.deadline.is_some_and(|d| Instant::now() >= d)
    }
}
