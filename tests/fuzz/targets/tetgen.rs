//! Solids in TetGen's pair of files.

#![no_main]

use libfuzzer_sys::fuzz_target;
use msplines_fuzz::readers::tetgen;

fuzz_target!(|bytes: &[u8]| tetgen(bytes));
