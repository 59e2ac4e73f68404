//! `oracles::state` under libFuzzer.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    if let Err(words) = oracles::state(bytes) {
        panic!("{words}");
    }
});
