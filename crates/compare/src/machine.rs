//! The machine that a run took place on, as far as it matters to its times.

use serde::{Deserialize, Serialize};

/// What a reader of times must know of the machine.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Machine {
    /// Name of the processor, or its architecture where the system does not say.
    pub cpu: String,
    /// Processors that this process may use.
    pub cores: usize,
    /// Operating system.
    pub system: String,
}

impl Machine {
    /// Returns this machine.
    #[must_use]
    pub fn this() -> Self {
        let described = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        Self {
            cpu: processor(&described).unwrap_or_else(|| std::env::consts::ARCH.to_owned()),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            system: std::env::consts::OS.to_owned(),
        }
    }
}

/// Returns the first processor's name in the words of Linux.
fn processor(described: &str) -> Option<String> {
    let mut lines = described.lines().filter_map(|line| line.split_once(':'));
    let (_, name) = lines.find(|(key, _)| key.trim() == "model name")?;
    let name = name.trim();
    (!name.is_empty()).then(|| name.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_processor_is_the_first_that_is_described() {
        let text = "processor\t: 0\nmodel name\t: Some CPU @ 2.1GHz\nmodel name\t: other\n";
        assert_eq!(processor(text).as_deref(), Some("Some CPU @ 2.1GHz"));
        assert_eq!(processor("model name :  \n"), None);
        assert!(!Machine::this().cpu.is_empty() && Machine::this().cores > 0);
    }
}
