//! What a comparison with other libraries found: the same input, the same metric, by turns.
//!
//! `cargo xtask peers` measures; this is its record, `peers.json`, and the tables made of it.

use std::fmt::Write as _;
use std::path::Path;

use comfy_table::ContentArrangement;
use comfy_table::presets::UTF8_FULL_CONDENSED;
use serde::{Deserialize, Serialize};

use crate::machine::Machine;

/// The schema of `peers.json`.
pub const SCHEMA: &str = "msplines.peers/1";
/// The file's name.
pub const FILE: &str = "peers.json";
/// From which multiple of the fastest peer's time on a step is said to be slow.
const SLOW: f64 = 2.0;
/// The columns of the tables.
pub(crate) const HEAD: [&str; 9] = [
    "input",
    "step",
    "peer",
    "here, CPU s",
    "peer, CPU s",
    "ratio",
    "here, quality",
    "peer, quality",
    "difference",
];

/// A comparison with other libraries.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Peers {
    /// [`SCHEMA`].
    pub schema: String,
    /// Version of this project.
    pub version: String,
    /// Where it was measured.
    pub machine: Machine,
    /// Mean number of processes that ran, over one, five and fifteen minutes, before and after.
    pub load: [String; 2],
    /// Threads of each side.
    pub threads: usize,
    /// What was compared.
    pub rows: Vec<PeerRow>,
}

/// One step of a task, here and in one peer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PeerRow {
    /// What is done.
    pub task: String,
    /// To what.
    pub input: String,
    /// Which part of it.
    pub step: String,
    /// The peer and what of it was called.
    pub peer: String,
    /// Its version, where it could be asked.
    pub version: Option<String>,
    /// This project's side, measured by turns with this peer.
    pub ours: Option<Side>,
    /// The peer's side.
    pub theirs: Option<Side>,
    /// What the quality is, and its unit.
    pub measure: String,
    /// Largest difference of the results, by the row's own scale.
    pub difference: Option<f64>,
    /// Why there is nothing to compare with.
    pub absent: Option<String>,
    /// What a reader must know.
    pub remark: String,
}

/// The times and the quality of one side.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Side {
    /// Processor seconds of each repetition.
    pub seconds: Vec<f64>,
    /// The quality of the last result.
    pub quality: Option<f64>,
}

impl Side {
    /// Returns the median of the processor seconds, the upper one of an even number.
    ///
    /// NaN if there are none.
    #[must_use]
    pub fn median(&self) -> f64 {
        let mut sorted = self.seconds.clone();
        sorted.sort_by(f64::total_cmp);
        sorted.get(sorted.len() / 2).copied().unwrap_or(f64::NAN)
    }
}

impl PeerRow {
    /// Returns our time as a multiple of the peer's.
    #[must_use]
    pub fn ratio(&self) -> Option<f64> {
        let ratio = self.ours.as_ref()?.median() / self.theirs.as_ref()?.median();
        ratio.is_finite().then_some(ratio)
    }
}

impl Peers {
    /// Returns the comparison in a file.
    ///
    /// # Errors
    /// The file cannot be read, or holds something else.
    pub fn read(path: &Path) -> Result<Self, String> {
        let told = |e: &dyn std::fmt::Display| format!("{}: {e}", path.display());
        let text = std::fs::read_to_string(path).map_err(|e| told(&e))?;
        let peers: Self = serde_json::from_str(&text).map_err(|e| told(&e))?;
        if peers.schema == SCHEMA {
            Ok(peers)
        } else {
            Err(told(&format!("the schema is not {SCHEMA}")))
        }
    }

    /// Returns, for each step in which this project takes more than twice the time of its fastest peer,
    /// the row of that peer.
    #[must_use]
    pub fn slow(&self) -> Vec<&PeerRow> {
        let same =
            |a: &PeerRow, b: &PeerRow| (&a.task, &a.input, &a.step) == (&b.task, &b.input, &b.step);
        let is_slowest = |row: &&PeerRow| {
            let ratio = row.ratio().unwrap_or(0.0);
            let rivals = self.rows.iter().filter(|other| same(row, other));
            ratio > SLOW
                && rivals
                    .filter_map(PeerRow::ratio)
                    .all(|other| other <= ratio)
        };
        self.rows.iter().filter(is_slowest).collect()
    }
}

/// Returns the comparison as tables of Markdown, one for each task.
#[must_use]
pub fn markdown(peers: &Peers) -> String {
    let mut out = preamble(peers);
    let mut task = "";
    for row in &peers.rows {
        if row.task != task {
            task = &row.task;
            let _ = write!(out, "\n### {task}\n\nQuality: {}.\n\n", row.measure);
            let _ = writeln!(out, "| {} |", HEAD.join(" | "));
            out.push_str("|---|---|---|---:|---:|---:|---:|---:|---:|\n");
        }
        let _ = writeln!(out, "| {} |", cells(row).join(" | "));
    }
    out.push_str(&closing(peers));
    out
}

/// Returns the same for a terminal.
#[must_use]
pub fn terminal(peers: &Peers) -> String {
    let mut out = preamble(peers).replace("**", "");
    for (at, row) in peers.rows.iter().enumerate() {
        if at > 0 && peers.rows[at - 1].task == row.task {
            continue;
        }
        let mut drawn = comfy_table::Table::new();
        drawn.load_style(UTF8_FULL_CONDENSED);
        drawn.set_content_arrangement(ContentArrangement::Dynamic);
        drawn.set_header(HEAD);
        let own = peers.rows.iter().filter(|other| other.task == row.task);
        drawn.add_rows(own.map(cells));
        let _ = writeln!(out, "\n{} (quality: {})\n{drawn}", row.task, row.measure);
    }
    out.push_str(&closing(peers));
    out
}

/// Returns how, where and under which load it was measured.
pub(crate) fn conditions(peers: &Peers) -> String {
    let Machine { cpu, cores, .. } = &peers.machine;
    let [before, after] = &peers.load;
    format!(
        "Medians of processor seconds, both sides by turns, {} thread each, on {cpu} ({cores} \
         cores); load before and after (1, 5, 15 minutes): {before}; {after}. A ratio below 1 \
         means that this project takes less time.",
        peers.threads,
    )
}

/// Returns what takes more than twice the time of its fastest peer, in words.
pub(crate) fn slow_steps(peers: &Peers) -> Vec<String> {
    let say = |row: &PeerRow| {
        let ratio = row.ratio().unwrap_or(f64::NAN);
        let PeerRow {
            task,
            input,
            step,
            peer,
            ..
        } = row;
        format!("{task}, {input}, {step}: {ratio:.1} times {peer}")
    };
    peers.slow().into_iter().map(say).collect()
}

fn preamble(peers: &Peers) -> String {
    let mut out = format!("{}\n", conditions(peers));
    let slow = slow_steps(peers);
    if slow.is_empty() {
        out.push_str("\nNo step takes more than twice the time of its fastest peer.\n");
    } else {
        out.push_str("\n**More than twice the time of the fastest peer:**\n\n");
    }
    for step in slow {
        let _ = writeln!(out, "- **{step}**");
    }
    out
}

/// Returns the cells of a row, one for each column of [`HEAD`].
pub(crate) fn cells(row: &PeerRow) -> [String; 9] {
    let seconds = |side: &Option<Side>| {
        side.as_ref()
            .map_or(String::new(), |side| time(side.median()))
    };
    let quality = |side: &Option<Side>| {
        let quality = side.as_ref().and_then(|side| side.quality);
        quality.map_or(String::new(), |q| format!("{q:.2e}"))
    };
    let named = match (&row.version, &row.absent) {
        (_, Some(reason)) => format!("{}: {reason}", row.peer),
        (Some(version), None) => format!("{} ({version})", row.peer),
        (None, None) => row.peer.clone(),
    };
    let ratio = row.ratio().map_or(String::new(), |ratio| {
        let shown = format!("{ratio:.2}");
        if ratio > SLOW {
            format!("{shown} (!)")
        } else {
            shown
        }
    });
    [
        row.input.clone(),
        row.step.clone(),
        named.replace('|', "/"),
        seconds(&row.ours),
        seconds(&row.theirs),
        ratio,
        quality(&row.ours),
        quality(&row.theirs),
        row.difference.map_or(String::new(), |d| format!("{d:.1e}")),
    ]
}

fn time(seconds: f64) -> String {
    if seconds.is_nan() {
        String::new()
    } else if seconds < 0.1 {
        format!("{seconds:.4}")
    } else {
        format!("{seconds:.3}")
    }
}

/// Returns what readers must know, each once, in the order of the rows.
pub(crate) fn remarks(peers: &Peers) -> Vec<String> {
    let mut all: Vec<String> = Vec::new();
    for row in peers.rows.iter().filter(|row| !row.remark.is_empty()) {
        let remark = format!("{}, {}: {}", row.task, row.peer, row.remark);
        if !all.contains(&remark) {
            all.push(remark);
        }
    }
    all
}

/// The remarks as a list, if there are any.
fn closing(peers: &Peers) -> String {
    let remarks = remarks(peers);
    if remarks.is_empty() {
        return String::new();
    }
    format!("\nRemarks:\n\n- {}\n", remarks.join("\n- "))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(peer: &str, ours: &[f64], theirs: &[f64]) -> PeerRow {
        let side = |seconds: &[f64]| Side {
            seconds: seconds.to_vec(),
            quality: Some(1e-3),
        };
        PeerRow {
            task: "Solving".to_owned(),
            input: "a mesh".to_owned(),
            step: "factor".to_owned(),
            peer: peer.to_owned(),
            version: Some("1.2".to_owned()),
            ours: Some(side(ours)),
            theirs: (!theirs.is_empty()).then(|| side(theirs)),
            measure: "residual".to_owned(),
            difference: Some(1e-9),
            absent: theirs.is_empty().then(|| "not installed".to_owned()),
            remark: String::new(),
        }
    }

    fn peers(rows: Vec<PeerRow>) -> Peers {
        Peers {
            schema: SCHEMA.to_owned(),
            version: "0".to_owned(),
            machine: Machine::this(),
            load: ["0.1".to_owned(), "0.2".to_owned()],
            threads: 1,
            rows,
        }
    }

    #[test]
    fn the_median_ignores_order_and_outliers() {
        let row = row("a", &[9.0, 1.0, 2.0], &[4.0, 1.0, 100.0]);
        assert_eq!(row.ratio(), Some(0.5));
    }

    #[test]
    fn only_the_fastest_peer_of_a_slow_step_is_named() {
        let rows = vec![
            row("slower", &[5.0], &[2.0]),
            row("fastest", &[5.0], &[1.0]),
            row("absent", &[5.0], &[]),
        ];
        let peers = peers(rows);
        let slow: Vec<_> = peers.slow().iter().map(|row| row.peer.as_str()).collect();
        assert_eq!(slow, ["fastest"]);
        let text = markdown(&peers);
        assert!(text.contains("5.0 times fastest**"), "{text}");
        assert!(text.contains("absent: not installed"), "{text}");
    }

    #[test]
    fn twice_the_time_is_not_slow() {
        let peers = peers(vec![row("a", &[2.0], &[1.0])]);
        assert!(peers.slow().is_empty());
        assert!(terminal(&peers).contains("2.00"));
    }

    #[test]
    fn a_record_is_read_as_it_was_written() {
        let peers = peers(vec![row("a", &[2.0], &[])]);
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join(FILE);
        std::fs::write(&path, serde_json::to_string(&peers).expect("plain data")).expect("a file");
        assert_eq!(Peers::read(&path), Ok(peers.clone()));
        let other = serde_json::to_string(&Peers {
            schema: "other/1".to_owned(),
            ..peers
        });
        std::fs::write(&path, other.expect("plain data")).expect("a file");
        assert!(Peers::read(&path).is_err());
    }
}
