#![no_main]
//! Any bytes are read as MCAP or refused.

use libfuzzer_sys::fuzz_target;
use recording::{Format, beginning_of_bytes, read};

fuzz_target!(|bytes: &[u8]| {
    let _ = read(bytes.to_vec(), Format::Mcap, "fuzz", None);
    let _ = beginning_of_bytes(bytes.to_vec(), Format::Mcap);
});
