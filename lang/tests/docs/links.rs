//! Links of the pages lead somewhere.

use super::{read, repository};

/// The anchor that a heading gets.
fn anchor(heading: &str) -> String {
    let kept = heading.trim().to_lowercase();
    kept.chars()
        .filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-'))
        .map(|c| if c == ' ' { '-' } else { c })
        .collect()
}

#[test]
fn links_lead_somewhere() {
    for page in ["docs/language.md", "docs/glossary.md"] {
        let text = read(page);
        let anchors: Vec<String> =
            text.lines().filter(|l| l.starts_with('#')).map(|l| anchor(l.trim_start_matches('#'))).collect();
        for link in text.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            match link.strip_prefix('#') {
                Some(to) => assert!(anchors.iter().any(|a| a == to), "{page} has no `#{to}`"),
                None => assert!(repository("docs").join(link).exists(), "{page}: there is no {link}"),
            }
        }
    }
}
