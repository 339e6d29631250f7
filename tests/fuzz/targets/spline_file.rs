//! Spline files of all methods, of both schemas.

#![no_main]

use libfuzzer_sys::fuzz_target;
use msplines_fuzz::own_files::spline;

fuzz_target!(|bytes: &[u8]| spline(bytes));
