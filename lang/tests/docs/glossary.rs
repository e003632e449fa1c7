//! The glossary: one row a word, in order of the alphabet.

use super::read;

fn rows() -> Vec<Vec<String>> {
    let text = read("docs/glossary.md");
    let rows = text.lines().filter(|l| l.starts_with("| ") && !l.starts_with("| word"));
    rows.map(|l| l.trim_matches('|').split(" | ").map(|c| c.trim().to_string()).collect()).collect()
}

#[test]
fn words_are_sorted_and_single() {
    let rows = rows();
    assert!(rows.len() > 40);
    let words: Vec<String> = rows.iter().map(|r| r[0].to_lowercase()).collect();
    for pair in words.windows(2) {
        assert!(pair[0] < pair[1], "`{}` stands before `{}`", pair[0], pair[1]);
    }
    for r in &rows {
        assert_eq!(r.len(), 3, "three columns are wanted: {r:?}");
    }
}

/// A word that is to be avoided is no entry, and no keyword of the language.
#[test]
fn avoided_words_are_no_entries() {
    let rows = rows();
    let keywords = super::grammar::keywords();
    for r in &rows {
        for avoided in r[2].split(',').map(str::trim).filter(|w| !w.is_empty() && *w != "–") {
            assert!(
                !rows.iter().any(|o| o[0] == avoided),
                "`{avoided}` is avoided at `{}` and is an entry",
                r[0]
            );
            assert!(!keywords.contains(avoided), "`{avoided}` is avoided at `{}` and is a keyword", r[0]);
        }
    }
}
