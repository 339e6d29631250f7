//! Creases beside a control mesh.

#![no_main]

use libfuzzer_sys::fuzz_target;
use msplines_fuzz::readers::creases;

fuzz_target!(|bytes: &[u8]| creases(bytes));
