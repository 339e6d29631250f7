//! Records, cases, atlases and rows, as runs store them.

#![no_main]

use libfuzzer_sys::fuzz_target;
use msplines_fuzz::own_files::records;

fuzz_target!(|bytes: &[u8]| records(bytes));
