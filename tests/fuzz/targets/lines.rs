//! Curve networks in the lines of an OBJ.

#![no_main]

use libfuzzer_sys::fuzz_target;
use msplines_fuzz::readers::network;

fuzz_target!(|bytes: &[u8]| network("a.obj", bytes));
