//! Any blanks between the tokens give the same layout, but for the blank lines an author may leave.

use super::pieces::{Piece, pieces};
use proptest::prelude::*;

/// Blanks without and with a line break.
const WITHIN: [&str; 5] = [" ", "  ", "\t", "   \t ", "        "];
const BREAKS: [&str; 6] = ["\n", "\r\n", "\n\n", " \n\t ", "\n\n\n\n  ", "  \n                    "];

/// The pieces with other blanks. A comment keeps its place: alone on its lines, or at the end of one.
fn scramble(pieces: &[Piece], choices: &[u8]) -> String {
    let mut out = String::new();
    let mut choices = choices.iter().cycle().map(|c| usize::from(*c));
    for (i, p) in pieces.iter().enumerate() {
        let choice = choices.next().unwrap_or(0);
        let before = i.checked_sub(1).map(|i| &pieces[i]);
        if before.is_some_and(|b| p.is_bound_to(b)) {
            out.push_str(&p.blanks);
            out.push_str(&p.text);
            continue;
        }
        let comment = p.is_comment() || before.is_some_and(Piece::is_comment);
        let breaks = if comment { p.blanks.contains('\n') } else { choice % 2 == 1 };
        let bracket = |p: &Piece| matches!(p.text.as_str(), "(" | ")" | "[" | "]" | "{" | "}" | ",");
        let may_touch =
            !comment && p.text != "(" && (p.blanks.is_empty() || bracket(p) || before.is_some_and(bracket));
        out.push_str(match choice / 2 {
            _ if breaks => BREAKS[choice / 2 % BREAKS.len()],
            c if may_touch && c % 2 == 0 => "",
            _ if before.is_none() => "",
            c => WITHIN[c % WITHIN.len()],
        });
        out.push_str(&p.text);
    }
    out
}

fn without_blank_lines(text: &str) -> String {
    text.lines().filter(|l| !l.is_empty()).map(|l| format!("{l}\n")).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn layout_does_not_depend_on_blanks(choices in prop::collection::vec(any::<u8>(), 200..2000)) {
        for (name, text) in super::sources() {
            // The lines inside such comments are the author's.
            if text.contains("second one. */") {
                continue;
            }
            let wanted = super::format(&name, &text);
            let input = scramble(&pieces(&text), &choices);
            let output = super::format(&name, &input);
            prop_assert_eq!(without_blank_lines(&output), without_blank_lines(&wanted), "{}", name);
            prop_assert_eq!(super::format(&name, &output), output, "{}: twice", name);
        }
    }

    #[test]
    fn comments_anywhere_are_kept(places in prop::collection::vec((any::<prop::sample::Index>(), 0..4usize), 1..12)) {
        const COMMENTS: [&str; 4] = [" // note\n", "\n// note\n", " /* note */ ", "\n/* note\n * on */\n"];
        for (name, text) in super::sources() {
            let cut = pieces(&text);
            let mut at: Vec<(usize, usize)> = places.iter().map(|(i, c)| (i.index(cut.len()), *c)).collect();
            at.retain(|(i, _)| *i == 0 || !cut[*i].is_bound_to(&cut[*i - 1]));
            at.sort();
            let mut input = String::new();
            for (i, p) in cut.iter().enumerate() {
                for (_, c) in at.iter().filter(|(at, _)| *at == i) {
                    input.push_str(COMMENTS[*c]);
                }
                input.push_str(&p.blanks);
                input.push_str(&p.text);
            }
            super::assert_faithful(&name, &input, &super::format(&name, &input));
        }
    }
}

#[test]
fn one_line_and_one_token_a_line_give_the_same() {
    for (name, text) in super::sources() {
        if text.contains("//") || text.contains("/*") {
            continue;
        }
        let cut = pieces(&text);
        let join = |between: &str| {
            let mut out = String::new();
            for (i, p) in cut.iter().enumerate() {
                out.push_str(if i > 0 && p.is_bound_to(&cut[i - 1]) { &p.blanks } else { between });
                out.push_str(&p.text);
            }
            out
        };
        let (short, long) = (super::format(&name, &join("\n")), super::format(&name, &join(" ")));
        assert_eq!(short, long, "{name}");
    }
}
