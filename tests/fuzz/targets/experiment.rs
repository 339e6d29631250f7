//! Experiment files.

#![no_main]

use libfuzzer_sys::fuzz_target;
use msplines_fuzz::own_files::experiment;

fuzz_target!(|bytes: &[u8]| experiment(bytes));
