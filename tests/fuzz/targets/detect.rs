//! Files whose format only their content can tell, by every reader.

#![no_main]

use libfuzzer_sys::fuzz_target;
use msplines_fuzz::readers::anything;

fuzz_target!(|bytes: &[u8]| anything(bytes));
