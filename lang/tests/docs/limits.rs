//! The limits of the language, each tried at its bound and one beyond.

use super::Library;
use soifra_graph::Severity;
use soifra_lang::{CheckOptions, Loader, check};
use std::fmt::Write as _;

/// What is limited, the limit in words, the last value that passes, the first that does not, the code it
/// gives, and a source for a value.
type Limit = (&'static str, &'static str, u64, u64, &'static str, fn(u64) -> String);

const LIMITS: &[Limit] = &[
    ("brackets inside brackets", "256", 256, 257, "S0102", |n| {
        format!("let x = {}1{}\n", "(".repeat(n as usize), ")".repeat(n as usize))
    }),
    ("operators in one expression", "255", 255, 256, "S0102", |n| {
        format!("fn f() -> Number = 1{}\n", " + 1".repeat(n as usize))
    }),
    ("fields and calls after one value", "256; `.f(x)` counts as two", 128, 129, "S0102", |n| {
        format!("fn f() -> Number = 1{}\n", ".abs()".repeat(n as usize))
    }),
    ("blocks inside blocks", "24", 24, 25, "S0102", |n| {
        let n = n as usize;
        service(&format!("{}note \"x\" {}", "if now > 1 s { ".repeat(n), "} ".repeat(n)))
    }),
    ("plan nodes inside plan nodes", "64", 64, 65, "S0102", |n| {
        let n = n as usize;
        format!(
            "agent a {{ plan p every 1 s {{ {}note \"x\" {}}} }}\n",
            "sequence { ".repeat(n),
            "} ".repeat(n)
        )
    }),
    ("length of a name", "255 bytes", 255, 256, "S0103", |n| format!("let {} = 1\n", "x".repeat(n as usize))),
    ("whole number", "2^53", 1 << 53, (1 << 53) + 2, "S0104", |n| format!("let x = {n}\n")),
    ("capacity of a list", "1 to 4096", 4096, 4097, "S0310", |n| {
        format!("record Track {{ points: List<Point<map>, {n}> }}\n")
    }),
    ("capacity of a topic", "1 to 1024", 1024, 1025, "S0310", |n| {
        format!("record Mark {{ number: Int }}\ntopic mark: Mark = channel(capacity: {n})\n")
    }),
    ("rows and columns of a matrix", "1 to 8", 8, 9, "S0206", |n| {
        format!("record Gain {{ k: Matrix<{n}, {n}> }}\n")
    }),
    ("exponent of `^`", "-16 to 16", 16, 17, "S0307", |n| format!("fn f(x: Number) -> Number = x ^ {n}\n")),
    ("rounds of `repeat` and `retry`", "1 to 1000000", 1_000_000, 1_000_001, "S0310", |n| {
        format!("agent a {{ plan p every 1 s {{ repeat {n} {{ note \"x\" }} }} }}\n")
    }),
    ("period", "at least 1 us", 1000, 999, "S0310", |n| {
        format!("agent a {{ service s every {n} ns {{ note \"x\" }} }}\n")
    }),
    ("duration in a trigger or timing clause", "at most 9e8 s", 900_000_000, 900_000_001, "S0310", |n| {
        format!("agent a {{ service s every {n} s {{ note \"x\" }} }}\n")
    }),
    ("files importing files", "64 levels", 64, 65, "S0205", |n| format!("import \"{n}.soi\"\n")),
];

fn service(body: &str) -> String {
    format!("agent a {{ service s every 1 s {{ {body} }} }}\n")
}

/// File `n.soi` imports file `n-1.soi`, down to an empty one.
struct Ladder;

impl Loader for Ladder {
    fn load(&mut self, path: &str) -> Result<String, String> {
        let n: u64 = path
            .trim_start_matches("missions/")
            .trim_end_matches(".soi")
            .parse()
            .map_err(|_| path.to_string())?;
        Ok(if n > 1 { format!("import \"{}.soi\"\n", n - 1) } else { String::new() })
    }

    fn library(&self) -> Vec<(String, String)> {
        Library.library()
    }
}

fn errors(text: &str) -> Vec<&'static str> {
    let c = check("missions/example.soi", text, &mut Ladder, &CheckOptions::default());
    c.diagnostics.iter().filter(|d| d.severity == Severity::Error).map(|d| d.code).collect()
}

#[test]
fn limits_are_where_the_reference_says() {
    let mut wrong = String::new();
    for (what, _, pass, fail, code, make) in LIMITS {
        let (at, beyond) = (errors(&make(*pass)), errors(&make(*fail)));
        if !at.is_empty() || beyond != [*code] {
            let _ = writeln!(wrong, "{what}: {at:?} at {pass}, {beyond:?} at {fail}, {code} is expected");
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

/// The table of limits.
pub fn table() -> Vec<Vec<String>> {
    LIMITS
        .iter()
        .map(|(what, limit, _, _, code, _)| {
            vec![(*what).to_string(), (*limit).to_string(), format!("`{code}`")]
        })
        .collect()
}
