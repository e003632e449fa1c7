#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| soifra::fuzz::fuzz_images(data));
