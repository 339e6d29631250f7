//! The program `msplines`.

use std::process::ExitCode;
use std::time::Instant;

use clap::Parser;
use msplines_cli::Arguments;

fn main() -> ExitCode {
    let process_start = Instant::now();
    msplines_cli::run(&Arguments::parse(), process_start)
}

#[cfg(test)]
mod tests {
    use clap::{Command, CommandFactory};
    use msplines_cli::Arguments;
    use msplines_compare::battery::is_tried;

    /// Collects the options of a command that no case of the battery tries.
    fn untried(command: &Command, path: &str, found: &mut Vec<String>) {
        for inner in command.get_subcommands() {
            let path = format!("{path} {}", inner.get_name());
            untried(inner, path.trim_start(), found);
        }
        let of_common = |name: &str| is_tried("info", name);
        let options = command
            .get_arguments()
            .filter_map(|argument| argument.get_long());
        let names = options.map(|name| format!("--{name}"));
        let forgotten = names.filter(|name| !is_tried(path, name) && !of_common(name));
        found.extend(forgotten.map(|name| format!("{path} {name}")));
    }

    #[test]
    fn every_option_is_tried_beyond_its_limits() {
        let mut found = Vec::new();
        untried(&Arguments::command(), "", &mut found);
        let known = ["--output", "--report"];
        found.retain(|line| !known.iter().any(|option| line.ends_with(option)));
        assert!(found.is_empty(), "add them to options.toml: {found:?}");
    }
}
