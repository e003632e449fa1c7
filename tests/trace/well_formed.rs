//! Whether a text is well-formed XML, as far as pictures use it.

/// Checks it, and panics where it is not.
pub fn check(xml: &str) {
    let mut open: Vec<&str> = Vec::new();
    let mut rest = xml;
    while let Some(at) = rest.find('<') {
        text(&rest[..at]);
        let end = rest[at..].find('>').unwrap_or_else(|| panic!("a tag without end: {}", &rest[at..])) + at;
        let tag = &rest[at + 1..end];
        if let Some(name) = tag.strip_prefix('/') {
            assert_eq!(open.pop(), Some(name), "closed in another order");
        } else {
            let (tag, empty) = tag.strip_suffix('/').map_or((tag, false), |t| (t, true));
            let (name, attributes) = tag.split_once(' ').unwrap_or((tag, ""));
            assert!(name.bytes().all(|b| b.is_ascii_lowercase()), "a name: {name}");
            // Texts between quotes, and what stands before them.
            for (i, piece) in attributes.split('"').enumerate() {
                match i % 2 {
                    0 => assert!(piece.is_empty() || piece.ends_with('='), "an attribute: {tag}"),
                    _ => text(piece),
                }
            }
            assert!(attributes.matches('"').count() % 2 == 0, "quotes: {tag}");
            if !empty {
                open.push(name);
            }
        }
        rest = &rest[end + 1..];
    }
    assert_eq!((rest.trim(), open.len()), ("", 0));
}

fn text(text: &str) {
    assert!(!text.contains(|c: char| c.is_control() && c != '\n' || c == '<'), "{text}");
    for after in text.split('&').skip(1) {
        let entity = after.split(';').next().unwrap_or_default();
        assert!(["amp", "lt", "gt", "quot"].contains(&entity), "an entity: {after}");
    }
}
