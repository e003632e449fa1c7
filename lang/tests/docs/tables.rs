//! The tables of the reference are made from what the checker works with.

use super::{grammar, limits, read, regions};
use soifra_graph::{
    FUNCTIONS, QuantityUnit, component,
    dim::{Dim, QUANTITIES, unit_names},
    reason::REASONS,
};

fn table(head: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let row = |cells: Vec<String>| {
        format!("| {} |\n", cells.iter().map(|c| c.replace('|', "\\|")).collect::<Vec<_>>().join(" | "))
    };
    let mut out = row(head.iter().map(|h| (*h).to_string()).collect());
    out.push_str(&format!("|{}\n", "---|".repeat(head.len())));
    rows.into_iter().for_each(|r| out.push_str(&row(r)));
    out
}

fn code(s: &str) -> String {
    format!("`{s}`")
}

fn quantities() -> String {
    table(
        &["type", "SI unit", "units of that dimension"],
        QUANTITIES.iter().map(|(name, dim)| {
            let units: Vec<String> = unit_names()
                .filter(|u| QuantityUnit::parse(u).is_ok_and(|p| p.dim == *dim))
                .map(code)
                .collect();
            let si = if *dim == Dim::NONE { "none".to_string() } else { code(&dim.si_unit()) };
            vec![code(name), si, units.join(" ")]
        }),
    )
}

fn units() -> String {
    table(
        &["unit", "is", "quantity"],
        unit_names().map(|u| {
            let parsed = QuantityUnit::parse(u).unwrap();
            let value = parsed.value("1").unwrap();
            let si = parsed.dim.si_unit();
            let is = format!("{value} {si}");
            let dim = parsed.dim.to_string();
            vec![code(u), is.trim().to_string(), code(&dim)]
        }),
    )
}

fn models(role: &str) -> String {
    table(
        &["model", "meaning"],
        component::MODELS
            .iter()
            .filter(|m| m.role == role)
            .map(|m| vec![code(&m.signature.text), m.doc.to_string()]),
    )
}

fn functions() -> String {
    table(
        &["function", "value"],
        FUNCTIONS.iter().map(|(_, signature, doc)| vec![code(signature), (*doc).to_string()]),
    )
}

fn standard(path: &str) -> String {
    let text = read(&format!("lang/std/{path}.soi"));
    format!("```soi\n{}```", text)
}

fn make(name: &str) -> String {
    match name.split_once(' ').unwrap_or((name, "")) {
        ("quantities", _) => quantities(),
        ("units", _) => units(),
        ("functions", _) => functions(),
        ("models", role) => models(role),
        ("reasons", _) => table(&["reason"], REASONS.iter().map(|r| vec![format!("{r}")])),
        ("reserved", _) => grammar::reserved().iter().map(|w| code(w)).collect::<Vec<_>>().join(" "),
        ("keywords", _) => {
            let reserved = grammar::reserved();
            let others: Vec<String> =
                grammar::keywords().iter().filter(|k| !reserved.contains(k)).map(|w| code(w)).collect();
            others.join(" ")
        }
        ("limits", _) => table(&["what", "limit", "beyond it"], limits::table()),
        ("standard", path) => standard(path),
        _ => panic!("there is no table `{name}`"),
    }
}

#[test]
fn tables_are_up_to_date() {
    regions::check("docs/language.md", "table", make);
}

/// A role that is added to the components is added to the reference.
#[test]
fn every_role_has_a_table() {
    let text = read("docs/language.md");
    for m in component::MODELS.iter() {
        assert!(
            text.contains(&format!("<!-- table: models {} -->", m.role)),
            "no table of `{}` models",
            m.role
        );
    }
}
