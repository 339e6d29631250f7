//! OpenCASCADE's program DRAW, which the tests of STEP files ask.

use std::path::Path;

use super::debian;

/// Debian packages, and a file of each that shows it is there. The program loads its commands from
/// libraries by names without a version, which only the package for developers has.
const PACKAGES: [(&str, &str); 2] = [
    ("occt-draw", "/usr/bin/occt-draw"),
    ("libocct-draw-dev", "/usr/include/opencascade/DBRep.hxx"),
];

/// Installs the program unless it is there; says what to do if that cannot be done.
pub(super) fn prepare() -> Result<(), String> {
    debian::install_if_allowed(&missing());
    match missing()[..] {
        [] => Ok(()),
        ref missing => Err(format!("apt-get install {}", missing.join(" "))),
    }
}

fn missing() -> Vec<&'static str> {
    let missing = PACKAGES
        .iter()
        .filter(|(_, sign)| !Path::new(sign).exists());
    missing.map(|(package, _)| *package).collect()
}
