//! Solids in the XML format of VTK: text, base64, appended, zlib.

#![no_main]

use libfuzzer_sys::fuzz_target;
use msplines_fuzz::readers::solid;

fuzz_target!(|bytes: &[u8]| solid("a.vtu", bytes));
