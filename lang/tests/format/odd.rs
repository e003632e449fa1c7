//! Inputs nobody writes: deep, long, empty, broken.

use super::{assert_faithful, format};
use std::fmt::Write;

#[test]
fn nothing_stays_nothing() {
    for text in ["", " ", "\n\n\t\n"] {
        assert_eq!(format("nothing", text), "");
    }
    assert_eq!(format("a comment", "\n\n   // only this"), "// only this\n");
    assert_eq!(format("a comment", "/* only this */   "), "/* only this */\n");
}

#[test]
fn deep_brackets() {
    for depth in [10, 60, 200] {
        let text = format!("let x = {}1{}\n", "(".repeat(depth), ")".repeat(depth));
        assert_faithful("brackets", &text, &format("brackets", &text));
        let text = format!("let x = {}1{}\n", "f([a + ".repeat(depth / 2), "])".repeat(depth / 2));
        assert_faithful("calls", &text, &format("calls", &text));
        let text = format!("let x = {}1{}\n", "(-".repeat(depth), ")".repeat(depth));
        assert_faithful("signs", &text, &format("signs", &text));
    }
}

#[test]
fn too_deep_brackets_are_an_error() {
    for open in ["(", "[", "{"] {
        assert!(soifra_lang::format(&format!("let x = {}", open.repeat(100_000))).is_err());
    }
}

#[test]
fn deep_bodies() {
    let mut text = String::from("agent a {\nservice s every step {\n");
    for _ in 0..100 {
        text.push_str("when a => { set b = if c then 1 else ");
        text.push_str("2 when d => ");
    }
    text.push_str("set e = f");
    text.push_str(&"}".repeat(100));
    text.push_str("}}");
    assert_faithful("bodies", &text, &format("bodies", &text));
}

#[test]
fn long_chains_and_lists() {
    let sum = (0..250).map(|i| format!("x{i}")).collect::<Vec<_>>();
    for between in [" + ", " and ", " - -", " * (a or b) ^ 2 / "] {
        let text = format!("let x = {}\n", sum.join(between));
        assert_faithful("chain", &text, &format("chain", &text));
    }
    let numbers = (0..20_000).map(|i| format!("{i} mm")).collect::<Vec<_>>().join(",");
    let formatted = format("numbers", &format!("let x = [{numbers}]"));
    assert!(formatted.lines().all(|l| l.len() <= soifra_lang::format::WIDTH));
    assert!(formatted.lines().count() < 2_500);
}

#[test]
fn what_does_not_parse_is_an_error() {
    for text in [
        "mission {",
        "}",
        "let x =",
        "agent a { service }",
        "\u{feff}edition 1",
        "let x = \"a\nb\"",
        "@",
        "é",
    ] {
        assert!(soifra_lang::format(text).is_err_and(|e| !e.is_empty()), "{text}");
    }
}

#[test]
fn what_is_unknown_is_formatted_all_the_same() {
    assert_eq!(format("unit", "let  x=2 furlong/fortnight"), "let x = 2 furlong/fortnight\n");
}

#[test]
fn a_division_by_a_name_stays_one() {
    for (text, wanted) in [
        ("let x = 2 m / t", "let x = 2 m / t\n"),
        ("let x = 2 m/ t", "let x = 2 m / t\n"),
        ("let x = 2 m/t", "let x = 2 m/t\n"),
        ("let x = 2m", "let x = 2 m\n"),
        ("let x = 2 m ^ 2", "let x = 2 m ^ 2\n"),
        ("let x = 2 m^2", "let x = 2 m^2\n"),
        ("let x = y ^ 2", "let x = y^2\n"),
        ("let x = -(2 m) ^ - 2", "let x = -(2 m)^-2\n"),
        ("let x = 2 m\nfn m() = 2\nfn n() = 1", "let x = 2 m\nfn m() = 2\nfn n() = 1\n"),
        ("fn f() { let x = 2\nm }", "fn f() {\n  let x = 2\n  m\n}\n"),
        ("fn f() { let x = y (m) }", "fn f() {\n  let x = y\n  (m)\n}\n"),
        ("fn f() { let x = y(m) 3 }", "fn f() {\n  let x = y(m)\n  3\n}\n"),
        ("let x = match y { a => 2\nm => 3 }", "let x = match y {\n  a => 2\n  m => 3\n}\n"),
        ("let x = 4%", "let x = 4 %\n"),
        ("let x = 1 ..3", "let x = 1 .. 3\n"),
        ("let x = 1e3 m", "let x = 1e3 m\n"),
        ("let x = not  - a", "let x = not -a\n"),
    ] {
        assert_eq!(format("numbers", text), wanted);
        assert_eq!(super::meaning(text), super::meaning(wanted), "{text}");
    }
}

#[test]
fn keywords_can_be_names() {
    let text = "let state = at(sum).state(count: 1) agent at(to: Int) { sensor sensor: step state state: any = at.to[0].on }";
    if let Ok(formatted) = soifra_lang::format(text) {
        assert_faithful("names", text, &formatted);
    }
    let text = "fn step( at:Int )=at(1)+step(at)";
    assert_eq!(format("names", text), "fn step(at: Int) = at(1) + step(at)\n");
}

#[test]
fn a_long_file_takes_time_in_proportion() {
    let mut text = String::new();
    for i in 0..2_000 {
        writeln!(
            text,
            "agent a{i} {{ // an agent\nstate x: Int = {i}\n\n// does nothing\nlet y = x + {i}\n}}"
        )
        .unwrap();
    }
    let formatted = format("long", &text);
    assert_eq!(formatted.lines().count(), 2_000 * 7 - 1);
}
