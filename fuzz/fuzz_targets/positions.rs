#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| undulate_fuzz::run("positions", data));
