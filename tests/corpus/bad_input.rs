//! Input that nobody writes on purpose: never a panic, never an endless check, always a report one can use.

#![allow(clippy::disallowed_methods, reason = "a test of a time limit needs the wall clock; 2026-11")]

use super::bad_form;
use soifra::{files::Loader, report::Findings};
use soifra_graph::Severity;
use soifra_lang::{CheckOptions, check};
use std::{
    thread,
    time::{Duration, Instant},
};

/// Longest check of anything.
const LONGEST: Duration = Duration::from_secs(20);
/// The stack that the program checks on, too.
const STACK: usize = 512 << 20;

/// Checks a text; asserts that it ends in time and that every finding is in form. Gives the codes of errors.
fn codes(name: &str, text: impl Into<String>) -> Vec<&'static str> {
    let (name, text) = (name.to_string(), text.into());
    let work = move || {
        let start = Instant::now();
        let checked = check(&format!("{name}.soi"), &text, &mut Loader, &CheckOptions::default());
        assert!(start.elapsed() < LONGEST, "{name}: {:?}", start.elapsed());
        let errors: Vec<_> =
            checked.diagnostics.iter().filter(|d| d.severity == Severity::Error).map(|d| d.code).collect();
        assert!(checked.graph.is_none() || errors.is_empty(), "{name}: a graph in spite of errors");
        let findings = Findings {
            diagnostics: checked.diagnostics.into_iter().take(100).collect(),
            sources: checked.sources,
        };
        let wrong = bad_form(&findings);
        assert!(wrong.is_empty(), "{name}: {wrong:?}");
        findings.render(false);
        errors
    };
    let started = thread::Builder::new().stack_size(STACK).spawn(work).expect("a thread");
    started.join().unwrap_or_else(|e| std::panic::resume_unwind(e))
}

/// An agent whose one service does `what`.
fn agent(what: &str) -> String {
    format!(
        "agent a {{\n  state x: Number = 0\n  state on: Bool = false\n  sensor ir: List<Beam, 8>\n  service s every 1 s {{\n    {what}\n  }}\n}}\n"
    )
}

/// `n` pseudo-random bytes out of `from`.
fn noise(n: usize, from: &[u8]) -> String {
    let mut state = 0x2545_f491_4f6c_dd1d_u64;
    let mut byte = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        from[(state % from.len() as u64) as usize] as char
    };
    (0..n).map(|_| byte()).collect()
}

#[test]
fn ten_megabytes_of_garbage() {
    const SIZE: usize = 10_000_000;
    for (name, text) in [
        ("noise", noise(SIZE, b"abc {}()[]\"/*-+=<>.,:;\n 0123456789")),
        ("words", noise(SIZE, b"abc \n")),
        ("opening", "(".repeat(SIZE)),
        ("agents", "agent a {\n".repeat(SIZE / 10)),
        ("quotes", "\"".repeat(SIZE)),
        ("comments", "/*".repeat(SIZE / 2)),
        ("letters", "é中".repeat(SIZE / 5)),
        ("items", "mission x { service every 3 m foo(a, b) }\n".repeat(SIZE / 42)),
    ] {
        assert!(!codes(name, text).is_empty(), "{name}");
    }
}

#[test]
fn deep_nesting() {
    for (open, close) in [("(", ")"), ("[", "]"), ("abs(", ")")] {
        let nested = |n: usize| agent(&format!("let y = {}1{}", open.repeat(n), close.repeat(n)));
        assert_eq!(codes("too deep", nested(257)), ["S0102"], "{open}");
        // The braces of agent and service count too.
        assert_eq!(codes("deep", nested(254)).len(), 0, "{open}");
    }
    assert_eq!(codes("blocks", agent(&("if on {".repeat(257) + &"}".repeat(257)))), ["S0102"]);
    let plan = "sequence {".repeat(200) + "note \"x\"" + &"}".repeat(200);
    assert_eq!(codes("plan", format!("agent a {{ plan p every 1 s {{ {plan} }} }}")), ["S0102"]);
    for arm in ["otherwise => ", "some(q) => 2 otherwise => "] {
        let text = format!("match ir.find(b => on) {{ {arm}").repeat(200) + "1" + &"}".repeat(200);
        assert!(codes("match", agent(&format!("set x = {text}"))).is_empty());
    }
}

#[test]
fn long_chains() {
    let refused = |name: &str, what: String| assert_eq!(codes(name, agent(&what)), ["S0102"], "{name}");
    refused("operators", format!("set x = {}1", "1 + ".repeat(10_000)));
    refused("not", format!("set on = {}on", "not ".repeat(5000)));
    refused("minus", format!("set x = {}1", "-".repeat(5000)));
    refused("else if", format!("set x = {}1", "if on then 1 else ".repeat(5000)));
    assert!(!codes("calls", agent(&format!("set x = ir{}", ".first()".repeat(5000)))).is_empty());
    let allowed = |name: &str, what: String| assert_eq!(codes(name, agent(&what)).len(), 0, "{name}");
    allowed("operators", format!("set x = {}1", "1 + ".repeat(250)));
    allowed("not", format!("set on = {}on", "not ".repeat(250)));
    allowed("else if", format!("set x = {}1", "if on and x > 3 then 1 else ".repeat(250)));
    allowed(
        "binding",
        format!("set x = {}1", "if ir.find(b => on) is some(q) and x > 3 then 1 else ".repeat(250)),
    );
    let statements = "if on { set x = 1 } ".to_string() + &"else if on { set x = 1 } ".repeat(250);
    allowed("statements", statements);
}

/// What is written out where it is used could double with every level.
#[test]
fn doubling_definitions() {
    let chain = |n: usize, first: &str, next: &dyn Fn(usize) -> String| {
        (1..=n).fold(first.to_string(), |text, i| text + &next(i))
    };
    let lets = chain(60, "let a0 = 1\n", &|i| format!("let a{i} = a{} + a{}\n", i - 1, i - 1));
    assert_eq!(codes("lets", lets + &agent("set x = a60")), ["S0510"]);
    let own = chain(60, "let a0 = x\n", &|i| format!("let a{i} = a{} + a{}\n", i - 1, i - 1));
    let text = format!("agent a {{ state x: Number = 0 {own} service s every 1 s {{ set x = a60 }} }}");
    assert!(codes("agent lets", text).is_empty());
    let actions = chain(20, "action b0 { set x = 1 }\n", &|i| {
        format!("action b{i} {{ do b{} do b{} }}\n", i - 1, i - 1)
    });
    let text = format!("agent a {{ state x: Number = 0 {actions} service s every 1 s {{ do b20 }} }}");
    assert_eq!(codes("actions", text), ["S0510"]);
    let fns = chain(40, "fn f0(x: Number) -> Number = x + 1\n", &|i| {
        format!("fn f{i}(x: Number) -> Number = f{}(f{}(x))\n", i - 1, i - 1)
    });
    let mission = "mission m { robot r: khepera4 at (0 m, 0 m) runs a goal g { subgoal s by a achieved when on } within 3 s }\n";
    assert_eq!(codes("functions", fns + &agent("set x = f40(1) set on = true") + mission), ["S0510"]);
    let profiles = chain(3000, "platform p0 { }\n", &|i| format!("platform p{i} extends p{} {{ }}\n", i - 1));
    assert!(codes("profiles", profiles).contains(&"S0102"));
}

#[test]
fn odd_texts() {
    assert!(codes("empty", "").is_empty());
    assert!(codes("blank", " \n\n\t").is_empty());
    assert!(codes("comments", "// nothing\n/* at all */\n").is_empty());
    assert_eq!(codes("nul", "edition 1\n\0\0agent a {\0}\n"), ["S0101"]);
    assert_eq!(codes("long line", agent(&format!("set x = 1{}+ 1 m", " ".repeat(2_000_000)))), ["S0303"]);
    assert_eq!(codes("string", agent("note \"never closed")), ["S0101"]);
    assert_eq!(codes("comment", agent("set x = 1") + "/* never closed"), ["S0101"]);
    assert_eq!(codes("comment inside", agent("set x = 1 /* never closed")), ["S0101"]);
    assert_eq!(codes("letters", agent("let größe = 1")), ["S0101"]);
    assert!(codes("lines of windows", agent("set x = x + 1").replace('\n', "\r\n")).is_empty());
    assert_eq!(codes("lines of windows, wrong", agent("set x = x + 1 m").replace('\n', "\r\n")), ["S0303"]);
    assert!(codes("mark", format!("\u{feff}edition 1\n{}", agent("set x = x + 1"))).is_empty());
    assert_eq!(codes("name", format!("let {} = 1\n", "a".repeat(256))), ["S0103"]);
    assert!(codes("name", format!("let {} = 1\n", "a".repeat(255))).is_empty());
    assert_eq!(codes("unit", agent("set x = 1 m^999999999999/s^-3")).first(), Some(&"S0301"));
    let numbers = "let a = 99999999999999999999999999\nlet b = 1e999999999999999999\nlet c = 1e-300\n";
    assert_eq!(codes("numbers", numbers), ["S0104", "S0104"]);
}

#[test]
fn large_programs() {
    let wrong: String = (0..20_000).map(|i| format!("let a{i} = 1 m + 1 s\n")).collect();
    assert_eq!(codes("mistakes", wrong).len(), 20_000);
    let functions: String =
        (0..20_000).map(|i| format!("fn f{i}(x: Number) -> Number = x + {i}\n")).collect();
    assert!(codes("functions", functions).is_empty());
    let robots = "agent a { state x: Bool = false service s every 1 s { set x = not x } }\n\
        mission m { robot r[1000000]: disc_robot at (1 m * index , 0 m) runs a\n\
        goal g { subgoal s by a achieved when x } clock step 1 s within 3 s }";
    codes("robots", robots);
}

/// Records that hold each other could be looked through once for every way that leads to them.
#[test]
fn records_in_records_end() {
    let doubling = |leaf: &str| {
        (0..45).fold(format!("record R45 {{ {leaf} }}\n"), |t, i| {
            format!("{t}record R{i} {{ a: R{0}, b: R{0} }}\n", i + 1)
        })
    };
    codes("doubling records", doubling("x: Int"));
    codes("doubling records of nothing", doubling(""));
    assert_eq!(codes("a ring behind a record", "record A { b: B }\nrecord B { b: B? }\n"), ["S0208"]);
}
