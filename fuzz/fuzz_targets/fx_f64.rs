#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| umbra_fuzz::fx_f64::run(data));
