//! `oracles::recording` under libFuzzer.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    if let Err(words) = oracles::recording(bytes) {
        panic!("{words}");
    }
});
