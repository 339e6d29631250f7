//! Spline files of all methods whose JSON is whole and whose numbers lie.

#![no_main]

use libfuzzer_sys::fuzz_target;
use msplines_fuzz::damage::damaged_spline;

fuzz_target!(|bytes: &[u8]| damaged_spline(bytes));
