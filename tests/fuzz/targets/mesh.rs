//! Acceptance and repair of faces without order.

#![no_main]

use libfuzzer_sys::fuzz_target;
use msplines_fuzz::meshes::soup;

fuzz_target!(|bytes: &[u8]| soup(bytes));
