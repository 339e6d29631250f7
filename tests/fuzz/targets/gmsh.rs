//! Solids in Gmsh, versions 2.2 and 4.1, text and binary.

#![no_main]

use libfuzzer_sys::fuzz_target;
use msplines_fuzz::readers::solid;

fuzz_target!(|bytes: &[u8]| solid("a.msh", bytes));
