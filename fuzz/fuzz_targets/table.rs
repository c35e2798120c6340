#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| rackmesh_fuzz::table::check(data));
