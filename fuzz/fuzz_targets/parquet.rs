#![no_main]
//! Any bytes are read as Parquet or refused.

use std::sync::Once;

use libfuzzer_sys::fuzz_target;
use recording::{Format, beginning_of_bytes, read};

static HOOK: Once = Once::new();

fuzz_target!(|bytes: &[u8]| {
    // The reader turns the library's panics into errors; the fuzzer's own hook would end the process before it can. A
    // panic that reaches the fuzzer still does.
    HOOK.call_once(|| std::panic::set_hook(Box::new(|_| {})));
    let _ = read(bytes.to_vec(), Format::Parquet, "fuzz", None);
    let _ = beginning_of_bytes(bytes.to_vec(), Format::Parquet);
});
