//! Generated parts of the reference: `<!-- table: units -->` … `<!-- end -->`.

use super::{read, repository, writing};
use std::fs;

/// Compares every part that `make` knows with what stands there; with `SOIFRA_BLESS=1` writes it anew.
/// `make` gets what stands behind the colon.
pub fn check(path: &str, kind: &str, make: impl Fn(&str) -> String) {
    let _guard = writing();
    let old = read(path);
    let (start, end) = (format!("<!-- {kind}: "), "<!-- end -->");
    let (mut new, mut rest, mut stale, mut count) = (String::new(), old.as_str(), Vec::new(), 0);
    while let Some(at) = rest.find(&start) {
        let head = at + rest[at..].find("-->\n").expect("a marker is not closed") + 4;
        let name = rest[at + start.len()..head - 4].trim();
        let to = head + rest[head..].find(end).unwrap_or_else(|| panic!("`{name}` has no end"));
        let made = format!("{}\n", make(name).trim_end());
        if rest[head..to] != made {
            stale.push(name.to_string());
        }
        new.push_str(&rest[..head]);
        new.push_str(&made);
        rest = &rest[to..];
        count += 1;
    }
    new.push_str(rest);
    assert!(count > 0, "{path} has no `{start}…`");
    if new != old && std::env::var_os("SOIFRA_BLESS").is_some() {
        fs::write(repository(path), new).unwrap();
        return;
    }
    assert!(stale.is_empty(), "{path} is stale: {}; run again with SOIFRA_BLESS=1", stale.join(", "));
}
