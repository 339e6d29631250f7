//! Debian packages that a step needs, installed where that is allowed.

use std::path::Path;

use super::steps;

/// Installs packages if this is the superuser of a Debian system; whether that worked shows later.
pub(super) fn install_if_allowed(packages: &[&str]) {
    if packages.is_empty() || !may_install() {
        return;
    }
    let apt = Path::new("apt-get");
    let mut arguments = vec!["install", "--yes", "--no-install-recommends"];
    arguments.extend(packages);
    steps::program(apt, &["update", "--quiet"]);
    steps::program(apt, &arguments);
}

fn may_install() -> bool {
    // Only the superuser may write the package database.
    steps::succeeds("test", &["-w", "/var/lib/dpkg/status"])
        && steps::succeeds("apt-get", &["--version"])
}
