//! Arrays of NumPy.

#![no_main]

use libfuzzer_sys::fuzz_target;
use msplines_fuzz::readers::array;

fuzz_target!(|bytes: &[u8]| array(bytes));
