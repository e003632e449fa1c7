//! Dropped-in cases: `tests/golden/format/NAME.soi` is formatted to `NAME.out`.

use std::fs;

#[test]
fn golden_cases_are_formatted_as_written_down() {
    let bless = std::env::var_os("SOIFRA_BLESS").is_some();
    let folder = crate::docs::repository("tests/golden/format");
    let mut inputs: Vec<_> = fs::read_dir(&folder).unwrap().map(|e| e.unwrap().path()).collect();
    inputs.retain(|p| p.extension().is_some_and(|e| e == "soi"));
    inputs.sort();
    assert!(!inputs.is_empty());
    for input in inputs {
        let name = input.display().to_string();
        let text = fs::read_to_string(&input).unwrap();
        let formatted = super::format(&name, &text);
        super::assert_faithful(&name, &text, &formatted);
        let output = input.with_extension("out");
        if bless {
            fs::write(&output, &formatted).unwrap();
        }
        let wanted = fs::read_to_string(&output).unwrap_or_default();
        assert_eq!(formatted, wanted, "{name}: run again with SOIFRA_BLESS=1 if the new layout is better");
    }
}

#[test]
fn shipped_sources_are_formatted() {
    for (name, text) in super::sources() {
        if !name.contains("golden") {
            assert_eq!(super::format(&name, &text), text, "{name}: run `make fmt`");
        }
    }
}
