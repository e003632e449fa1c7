//! The fuzz body of trace loading over a corpus: a real file cut, flipped, and rearranged.

use super::sample;
use crate::support::folder;
use soifra::fuzz::fuzz_trace;
use std::fs;

fn corpus(name: &str) -> Vec<Vec<u8>> {
    let dir = folder(name);
    let path = dir.join("t.mcap");
    super::file::write(&path, &sample::run(1, 2));
    let compressed = fs::read(&path).unwrap();
    // The same without compression and checksums: damage gets past the envelope, to the records.
    let options = mcap::WriteOptions::new().compression(None).calculate_chunk_crcs(false);
    let mut plain = options.create(std::io::Cursor::new(Vec::new())).unwrap();
    for message in mcap::MessageStream::new(&compressed).unwrap() {
        plain.write(&message.unwrap()).unwrap();
    }
    plain.finish().unwrap();
    vec![compressed, plain.into_inner().into_inner()]
}

#[test]
fn cut_files() {
    for bytes in corpus("trace_cut_files") {
        for cut in (0..bytes.len()).step_by(397).chain(0..60) {
            fuzz_trace(&bytes[..cut]);
        }
    }
}

#[test]
fn flipped_bits() {
    for bytes in corpus("trace_flipped_bits") {
        for i in (0..bytes.len()).step_by(401).chain(0..100) {
            let mut damaged = bytes.clone();
            damaged[i] ^= 1 << (i % 8);
            fuzz_trace(&damaged);
        }
    }
}

#[test]
fn lengths_that_lie() {
    // Every field of eight bytes in the first part overwritten with great numbers.
    for bytes in corpus("trace_lengths_that_lie") {
        for i in (8..200).chain((200..bytes.len() - 8).step_by(997)) {
            for value in [u64::MAX, u64::MAX - 8, 1 << 62, 1 << 31, 0] {
                let mut damaged = bytes.clone();
                damaged[i..i + 8].copy_from_slice(&value.to_le_bytes());
                fuzz_trace(&damaged);
            }
        }
    }
}

#[test]
fn numbers_that_overflow() {
    for bytes in corpus("trace_numbers_that_overflow") {
        for (from, to) in [
            (&b"\"nsec\":0"[..], &b"\"nsec\":9"[..]),
            (b"\"sec\":1", b"\"sec\":-"),
            (b"\"robot\":0", b"\"robot\":9"),
            (b"\"x\":0.", b"\"x\":9e"),
            (b"\"Number\":0", b"\"Number\":9"),
        ] {
            let mut changed = bytes.clone();
            let places: Vec<usize> =
                (0..changed.len() - from.len()).filter(|i| &bytes[*i..*i + from.len()] == from).collect();
            for i in places {
                changed[i..i + to.len()].copy_from_slice(to);
            }
            fuzz_trace(&changed);
        }
    }
}
