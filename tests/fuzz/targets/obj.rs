//! Surface meshes and point files in OBJ.

#![no_main]

use libfuzzer_sys::fuzz_target;
use msplines_fuzz::readers::surface;

fuzz_target!(|bytes: &[u8]| surface("a.obj", bytes));
