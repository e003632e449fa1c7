//! The fuzz bodies over a corpus: every source of the repository, whole, cut off and damaged.

use crate::support::files;
use soifra::fuzz::{fuzz_check, fuzz_graph, fuzz_images, fuzz_parse, fuzz_trace};

/// Cut-offs and damages of `data`, the same at every run.
fn variants(data: &[u8], count: usize) -> Vec<Vec<u8>> {
    let mut state = data.len() as u64 + 1;
    let mut next = move |n: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % n.max(1)
    };
    let mut out = vec![data.to_vec()];
    for i in 0..count {
        let mut v = data.to_vec();
        match i % 4 {
            0 => v.truncate(next(data.len())),
            1 if !v.is_empty() => {
                let at = next(v.len());
                v[at] = b"{}()[]\"/-<>=,.:0\n\xff"[next(18)];
            }
            2 if !v.is_empty() => {
                let (a, b) = (next(v.len()), next(v.len()));
                v.drain(a.min(b)..a.max(b).min(a.min(b) + 40));
            }
            _ if !v.is_empty() => {
                let (a, n) = (next(v.len()), next(60));
                let piece = v[a..(a + n).min(v.len())].to_vec();
                let at = next(v.len());
                v.splice(at..at, piece);
            }
            _ => {}
        }
        out.push(v);
    }
    out
}

/// Runs `body` on a thread with the stack that the program has.
fn with_stack(body: impl FnOnce() + Send + 'static) {
    let thread = std::thread::Builder::new().stack_size(256 << 20).spawn(body).expect("a thread");
    if let Err(panic) = thread.join() {
        std::panic::resume_unwind(panic);
    }
}

fn sources() -> Vec<Vec<u8>> {
    files("", ".soi").iter().filter_map(|p| std::fs::read(p).ok()).collect()
}

#[test]
fn parse() {
    with_stack(|| {
        for s in sources() {
            variants(&s, 24).iter().for_each(|v| fuzz_parse(v));
        }
    });
}

#[test]
fn check() {
    with_stack(|| {
        for s in sources() {
            variants(&s, 8).iter().for_each(|v| fuzz_check(v));
        }
    });
}

#[test]
fn nesting_is_bounded() {
    with_stack(|| {
        for open in
            ["(", "[", "{", "-", "not ", "if true then ", "mission m { ", "List<", "a.b(", "sequence { "]
        {
            let text = format!("edition 1\nfn f(x: Number) -> Number = {}", open.repeat(100_000));
            fuzz_parse(text.as_bytes());
            fuzz_check(text.as_bytes());
        }
    });
}

#[test]
fn graph() {
    with_stack(|| {
        let mut seeds: Vec<Vec<u8>> = vec![
            b"schema: 1\n".to_vec(),
            b"{\"schema\":1}".to_vec(),
            b"[".repeat(200_000),
            b"a: &a [*a, *a]".to_vec(),
        ];
        if let Some(graph) = crate::cli::small_graph() {
            seeds.push(graph);
        }
        for s in seeds {
            variants(&s, 60).iter().for_each(|v| fuzz_graph(v));
        }
    });
}

#[test]
fn trace() {
    with_stack(|| {
        let magic = b"\x89MCAP0\r\n";
        let mut seeds: Vec<Vec<u8>> = vec![Vec::new(), magic.to_vec(), [magic.as_slice(), &[1; 64]].concat()];
        if let Some(trace) = crate::cli::small_trace() {
            seeds.push(trace);
        }
        for s in seeds {
            variants(&s, 60).iter().for_each(|v| fuzz_trace(v));
        }
    });
}

#[test]
fn images() {
    with_stack(|| {
        for s in crate::recording::samples() {
            variants(&s, 60).iter().for_each(|v| fuzz_images(v));
        }
    });
}
