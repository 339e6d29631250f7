//! Surface meshes in STL, text and binary.

#![no_main]

use libfuzzer_sys::fuzz_target;
use msplines_fuzz::readers::surface;

fuzz_target!(|bytes: &[u8]| surface("a.stl", bytes));
