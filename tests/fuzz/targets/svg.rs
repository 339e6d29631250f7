//! Curve networks in SVG.

#![no_main]

use libfuzzer_sys::fuzz_target;
use msplines_fuzz::readers::drawing;

fuzz_target!(|bytes: &[u8]| drawing(bytes));
