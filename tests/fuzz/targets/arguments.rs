//! The command line.

#![no_main]

use libfuzzer_sys::fuzz_target;
use msplines_fuzz::command_line::arguments;

fuzz_target!(|bytes: &[u8]| arguments(bytes));
