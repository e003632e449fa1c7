//! Tables for people.

use comfy_table::{CellAlignment, Table, presets};

/// A table: the first column left, all others right aligned; no lines but one under the header.
pub fn table(header: &[&str], rows: &[Vec<String>]) -> String {
    let mut t = Table::new();
    t.load_style(presets::NOTHING);
    t.set_header(header.iter().copied());
    for r in rows {
        t.add_row(r);
    }
    for i in 1..header.len() {
        if let Some(c) = t.column_mut(i) {
            c.set_cell_alignment(CellAlignment::Right);
        }
    }
    t.trim_fmt().lines().map(|l| format!("  {}\n", l.trim_end())).collect()
}

/// A number for people: as many digits as tell something.
pub fn figure(x: Option<f64>) -> String {
    match x {
        None => "–".into(),
        Some(x) if !x.is_finite() => "–".into(),
        // Nobody is left by minus nothing.
        Some(x) if x == x.trunc() && x.abs() < 1e9 => format!("{:.0}", x + 0.0),
        Some(x) if x.abs() >= 100.0 => format!("{x:.1}"),
        Some(x) if x.abs() >= 1e-3 => format!("{x:.4}"),
        Some(x) => format!("{x:.2e}"),
    }
}
