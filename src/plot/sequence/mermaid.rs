//! A message sequence chart as a Mermaid sequence diagram.

use super::{
    Sequence,
    layout::{dropped, label},
    rows::{Row, What},
};
use crate::mermaid::{escape, title};
use std::fmt::Write;

/// The diagram's text. Writing to a String cannot fail: results are dropped.
pub(super) fn write(chart: &Sequence) -> String {
    let mut s = title(&chart.title) + "sequenceDiagram\n";
    for (i, l) in chart.lifelines.iter().enumerate() {
        let _ = writeln!(s, "  participant p{i} as {}", escape(&l.full()));
    }
    let time = |row: &Row| chart.unit.exact(row.t);
    for row in &chart.rows {
        let _ = match &row.what {
            What::Arrow(a) => {
                let head = if a.is_lost() { "--x" } else { "->>" };
                let until = (a.count > 1).then(|| format!(" to {}", chart.unit.exact(a.last)));
                let mut when = vec![time(row) + &until.unwrap_or_default()];
                when.extend(dropped(a));
                let text = format!("{} ({})", label(a), when.join(", "));
                writeln!(s, "  p{}{head}p{}: {}", a.from, a.to, escape(&text))
            }
            What::Service { of, text, .. } | What::Life { of, text, .. } => {
                writeln!(s, "  Note over p{of}: {}", escape(&format!("{text} ({})", time(row))))
            }
            // Messages tell that a conversation is over: notes of it would only be in their way.
            What::Over { .. } => continue,
        };
    }
    if let (Some(rest), Some(last)) = (chart.rest(), chart.lifelines.len().checked_sub(1)) {
        let over = if last == 0 { "p0".into() } else { format!("p0,p{last}") };
        let _ = writeln!(s, "  Note over {over}: {rest}");
    }
    s
}
