//! Solids in the legacy format of VTK, text and binary.

#![no_main]

use libfuzzer_sys::fuzz_target;
use msplines_fuzz::readers::solid;

fuzz_target!(|bytes: &[u8]| solid("a.vtk", bytes));
