//! Both sides of a task by turns.

use msplines_compare::peers::{PeerRow, Side};

use super::{Failure, Settings};
use crate::Library;

/// From so many seconds on for both sides together, three repetitions are enough.
const LONG: f64 = 4.0;
/// Repetitions of long tasks.
const LONG_ROUNDS: usize = 3;

/// What one run of one side took, step by step, and found.
#[derive(Clone, Debug, Default)]
pub(super) struct Timed {
    pub(super) seconds: Vec<f64>,
    pub(super) result: Vec<f64>,
}

/// Largest difference of two results, where they can be compared.
type Difference<'a> = &'a dyn Fn(&[f64], &[f64]) -> Option<f64>;

/// A task on one input.
pub(super) struct Contest<'a> {
    pub(super) task: &'a str,
    pub(super) input: &'a str,
    /// What is timed; a side may do only the first of them.
    pub(super) steps: &'a [&'a str],
    /// What the quality is.
    pub(super) measure: &'a str,
    pub(super) quality: &'a dyn Fn(&[f64]) -> Option<f64>,
    /// Largest difference of two results.
    pub(super) difference: Difference<'a>,
}

/// A peer in a task.
pub(super) struct Rival<'a> {
    pub(super) name: &'a str,
    /// Its version, or why it cannot be had.
    pub(super) version: Result<String, String>,
    pub(super) remark: &'a str,
}

impl Contest<'_> {
    /// Returns a row for each step: both sides by turns, this project first.
    ///
    /// A peer that fails is a row that says so.
    pub(super) fn run(
        &self,
        settings: &Settings,
        rival: &Rival<'_>,
        ours: &mut dyn FnMut() -> Result<Timed, Failure>,
        theirs: &mut dyn FnMut() -> Result<Timed, Failure>,
    ) -> Result<Vec<PeerRow>, Failure> {
        let mut sides = [Vec::new(), Vec::new()];
        let mut absent = rival.version.as_ref().err().cloned();
        let mut rounds = settings.rounds;
        while sides[0].len() < rounds {
            sides[0].push(ours()?);
            if absent.is_none() {
                match theirs() {
                    Ok(timed) => sides[1].push(timed),
                    Err(error) => absent = Some(error.to_string()),
                }
            }
            let total: f64 = sides.iter().flatten().flat_map(|run| &run.seconds).sum();
            if sides[0].len() == 1 && total > LONG {
                rounds = rounds.min(LONG_ROUNDS);
            }
        }
        if absent.is_some() {
            sides[1].clear();
        }
        let [ours, theirs] = &sides;
        let rows = self.steps.iter().enumerate().map(|(step, text)| PeerRow {
            task: self.task.to_owned(),
            input: self.input.to_owned(),
            step: (*text).to_owned(),
            peer: rival.name.to_owned(),
            version: rival.version.as_ref().ok().cloned(),
            ours: self.side(ours, step),
            theirs: self.side(theirs, step),
            measure: self.measure.to_owned(),
            difference: match (ours.last(), theirs.last()) {
                (Some(a), Some(b)) => (self.difference)(&a.result, &b.result),
                _ => None,
            },
            absent: absent.clone(),
            remark: rival.remark.to_owned(),
        });
        // A step that the peer does not have is no row, but an absent peer has one.
        let all = rows.enumerate().filter(|(step, row)| match &row.absent {
            Some(_) => *step == 0,
            None => row.theirs.is_some(),
        });
        Ok(all.map(|(_, row)| row).collect())
    }

    fn side(&self, runs: &[Timed], step: usize) -> Option<Side> {
        let seconds: Option<Vec<f64>> = runs
            .iter()
            .map(|run| run.seconds.get(step).copied())
            .collect();
        let last = runs.last()?;
        Some(Side {
            seconds: seconds?,
            quality: (self.quality)(&last.result),
        })
    }
}

/// Returns the version of a library without its name, as a rival has it.
pub(super) fn version_of(library: Library) -> Result<String, String> {
    let version = library.version();
    let number = version.rsplit(' ').next().unwrap_or_default();
    Ok(number.to_owned())
}
