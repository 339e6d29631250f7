//! Kills a small reproduction, and the writing of its report.

use std::path::{Path, PathBuf};
use std::process::Command;

use rand_pcg::Pcg64Mcg;

use super::fits::make;
use super::moment::{Ended, Moment, Times, Victim, goes_on, killed, undisturbed};
use super::tally::{Files, Tally, files, is_same, is_temporary};

/// Four rows of tenths of a second, on generated surfaces, with a picture.
const ITEM: [&str; 2] = ["he2005", "figure3"];
/// One of its rows: what an older report shows.
const OLDER: &str = "basis-1";

/// A reproduction into a folder, with what undisturbed runs give.
struct Bench<'a> {
    program: &'a Path,
    folder: PathBuf,
    /// The report of one row, and its store.
    old: Files,
    /// The report of all rows, and their store.
    new: Files,
}

/// Kills reproductions and reports, so many times.
pub(super) fn run(
    program: &Path,
    folder: &Path,
    [of_rows, of_reports]: [u32; 2],
    random: &mut Pcg64Mcg,
) -> Result<Vec<Tally>, String> {
    if of_rows + of_reports == 0 {
        return Ok(Vec::new());
    }
    make(folder)?;
    let mut bench = Bench {
        program,
        folder: folder.join("report"),
        old: Files::new(),
        new: Files::new(),
    };
    undisturbed(bench.command(&[]).arg(OLDER), &[])?;
    bench.old = files(&bench.folder)?;
    bench.put(&Files::new())?;
    make(&bench.rows())?;
    let times = undisturbed(&mut bench.command(&[]), &[bench.rows()])?;
    bench.new = files(&bench.folder)?;
    let mut rows = Tally::new("repro");
    for trial in 0..of_rows {
        bench.kill_rows(times, trial, random, &mut rows)?;
    }
    println!(
        "{}: {of_rows} kills, {} faults",
        rows.phase,
        rows.faults.len()
    );
    let mut reports = Tally::new("report");
    bench.put(&bench.new)?;
    let times = undisturbed(&mut bench.command(&["--stored"]), &bench.of_report())?;
    for trial in 0..of_reports {
        let moment = times.moment(trial, random);
        bench.kill_report(moment, trial, &mut reports)?;
    }
    println!(
        "{}: {of_reports} kills, {} faults",
        reports.phase,
        reports.faults.len()
    );
    Ok(vec![rows, reports])
}

impl Bench<'_> {
    fn command(&self, more: &[&str]) -> Command {
        let mut command = Command::new(self.program);
        command.arg("repro").args(ITEM).args(more);
        command
            .args(["--threads", "1", "--still", "--out"])
            .arg(&self.folder);
        command
    }

    fn rows(&self) -> PathBuf {
        self.folder.join("rows")
    }

    /// Folders that change when a report is written.
    fn of_report(&self) -> [PathBuf; 2] {
        [self.folder.clone(), self.folder.join("pictures")]
    }

    /// Kills a reproduction from nothing or from one finished row, and lets the next one end.
    fn kill_rows(
        &self,
        times: Times,
        trial: u32,
        random: &mut Pcg64Mcg,
        tally: &mut Tally,
    ) -> Result<(), String> {
        let none = Files::new();
        let old = if trial % 4 < 2 { &self.old } else { &none };
        self.put(old)?;
        make(&self.rows())?;
        let victim = if trial.is_multiple_of(3) {
            Victim::Group
        } else {
            Victim::Program
        };
        let moment = times.moment(trial, random);
        let (ended, group) = killed(&mut self.command(&[]), &[self.rows()], moment, victim)?;
        match ended {
            Ended::Killed => tally.kills += 1,
            Ended::Before => tally.ended_before += 1,
        }
        let found = files(&self.folder)?;
        for (name, new) in &self.new {
            self.count(name, found.get(name), old.get(name), new, tally);
        }
        let left = self.leftovers(&found, tally);
        tally.leftovers += left;
        // At once, whatever the killed one has left running.
        undisturbed(&mut self.command(&[]), &[])?;
        if goes_on(group) {
            tally.fault("a row went on without the program that had started it");
        }
        let after = files(&self.folder)?;
        for (name, new) in &self.new {
            let bytes = after.get(name);
            if !bytes.is_some_and(|bytes| is_whole(name, bytes, new)) {
                tally.fault(format!("the next run gives another {name}"));
            }
            // A row that runs again has other times.
            if is_row(name) && found.contains_key(name) && found.get(name) != bytes {
                tally.fault(format!("{name} was finished and ran again"));
            }
        }
        let left = self.leftovers(&after, tally);
        tally.leftovers_after += left;
        Ok(())
    }

    /// What holds times is whole where it reads to its end, as no two runs give the same.
    fn count(
        &self,
        name: &str,
        found: Option<&Vec<u8>>,
        old: Option<&Vec<u8>>,
        new: &[u8],
        tally: &mut Tally,
    ) {
        let found = found.map(Vec::as_slice);
        let old = old.map(Vec::as_slice);
        match found {
            Some(bytes) if Some(bytes) != old && is_whole(name, bytes, new) => {
                tally.whole_new += 1;
            }
            _ => tally.count(name, found, old, new),
        }
    }

    /// Kills the writing of a report over an older one or none, and writes it again.
    fn kill_report(&self, moment: Moment, trial: u32, tally: &mut Tally) -> Result<(), String> {
        let is_filled = trial % 4 < 2;
        let mut start = self.new.clone();
        start.retain(|name, _| name.starts_with("rows/"));
        let is_of_report = |name: &&String| !name.starts_with("rows/");
        for name in self.new.keys().filter(is_of_report) {
            if let Some(old) = self.old.get(name).filter(|_| is_filled) {
                start.insert(name.clone(), old.clone());
            }
        }
        self.put(&start)?;
        make(&self.folder.join("pictures"))?;
        let mut command = self.command(&["--stored"]);
        let (ended, _) = killed(&mut command, &self.of_report(), moment, Victim::Program)?;
        match ended {
            Ended::Killed => tally.kills += 1,
            Ended::Before => tally.ended_before += 1,
        }
        let found = files(&self.folder)?;
        for (name, new) in self.new.iter().filter(|(name, _)| is_of_report(name)) {
            let found = found.get(name).map(Vec::as_slice);
            tally.count(name, found, start.get(name).map(Vec::as_slice), new);
        }
        let left = self.leftovers(&found, tally);
        tally.leftovers += left;
        undisturbed(&mut self.command(&["--stored"]), &[])?;
        let after = files(&self.folder)?;
        for (name, new) in &self.new {
            if !after
                .get(name)
                .is_some_and(|bytes| is_same(name, bytes, new))
            {
                tally.fault(format!("the next run gives another {name}"));
            }
        }
        let left = self.leftovers(&after, tally);
        tally.leftovers_after += left;
        Ok(())
    }

    /// Returns the number of temporary files; whatever else does not belong there is a fault.
    fn leftovers(&self, found: &Files, tally: &mut Tally) -> u32 {
        let mut count = 0;
        for name in found.keys().filter(|name| !self.new.contains_key(*name)) {
            if is_temporary(name) {
                count += 1;
            } else {
                tally.fault(format!("{name} was left and cannot be recognised"));
            }
        }
        count
    }

    /// Makes the folder hold these files and no others.
    fn put(&self, files: &Files) -> Result<(), String> {
        let told = |e: std::io::Error| format!("{}: {e}", self.folder.display());
        if self.folder.exists() {
            std::fs::remove_dir_all(&self.folder).map_err(told)?;
        }
        make(&self.folder)?;
        for (name, bytes) in files {
            let path = self.folder.join(name);
            make(path.parent().unwrap_or(&self.folder))?;
            std::fs::write(path, bytes).map_err(told)?;
        }
        Ok(())
    }
}

/// Returns whether a file of the store says that a row has ended.
fn is_row(name: &str) -> bool {
    let row = name.strip_prefix("rows/");
    row.is_some_and(|row| row.ends_with(".json") && !row.contains('/'))
}

/// Returns whether a file is what an undisturbed run gives; tables and pages print times, so that
/// of them only the length in lines and the end can be compared.
fn is_whole(name: &str, found: &[u8], expected: &[u8]) -> bool {
    let prints_times =
        !name.contains('/') && [".html", ".csv", ".md"].iter().any(|e| name.ends_with(e));
    if !prints_times {
        return is_same(name, found, expected);
    }
    let lines = |bytes: &[u8]| bytes.iter().filter(|&&byte| byte == b'\n').count();
    let last = |bytes: &[u8]| bytes.last().copied();
    lines(found) == lines(expected) && last(found) == last(expected)
}

#[cfg(test)]
mod tests {
    use super::{is_row, is_whole};

    #[test]
    fn rows_are_told_from_their_files() {
        assert!(is_row("rows/k.json"));
        assert!(!is_row("rows/k/atlas.json") && !is_row("report.json"));
    }

    #[test]
    fn a_table_may_differ_in_times_but_not_end_early() {
        assert!(is_whole("t.md", b"a 1.0\nb\n", b"a 2.5\nb\n"));
        assert!(!is_whole("t.md", b"a 1.0\n", b"a 2.5\nb\n"));
        assert!(!is_whole("rows/k/x.csv", b"1", b"2"));
    }
}
