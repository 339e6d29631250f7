//! The list of models.

#![no_main]

use libfuzzer_sys::fuzz_target;
use msplines_fuzz::own_files::models;

fuzz_target!(|bytes: &[u8]| models(bytes));
