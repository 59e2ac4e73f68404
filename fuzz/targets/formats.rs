//! `oracles::formats` under libFuzzer.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    if let Err(words) = oracles::formats(bytes) {
        panic!("{words}");
    }
});
