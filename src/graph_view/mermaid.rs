//! A Mermaid flowchart.

use super::model::{Inside, Kind, View};
use crate::mermaid::{escape, title};
use std::fmt::Write;

/// The flowchart's text.
pub fn draw(view: &View) -> String {
    let mut s = title(&view.title) + "flowchart LR\n";
    for t in &view.things {
        let label = quote(&t.lines.join("\n"));
        let (open, close) = match t.kind {
            Kind::Sensor => ("([", "])"),
            Kind::Actuator => ("[[", "]]"),
            Kind::Topic => (">", "]"),
            Kind::Arbiter => ("{", "}"),
            Kind::Goal => ("((", "))"),
            Kind::Mission => ("{{", "}}"),
            Kind::Subgoal => ("(", ")"),
            Kind::Plan => ("[/", "/]"),
            Kind::Agent => ("[[", "]]"),
            Kind::Service | Kind::Action => ("[", "]"),
        };
        let _ = writeln!(s, "  {}{open}{label}{close}", t.id);
    }
    for a in &view.agents {
        let _ = writeln!(s, "  subgraph {}[{}]", a.id, quote(&a.title));
        for u in &a.units {
            match &u.inside {
                Inside::Lines(lines) => {
                    let text = std::iter::once(&u.title).chain(lines).cloned().collect::<Vec<_>>().join("\n");
                    let _ = writeln!(s, "    {}[{}]", u.id, quote(&text));
                }
                Inside::Nodes { round, nodes, edges } => {
                    let _ = writeln!(s, "    subgraph {}[{}]", u.id, quote(&u.title));
                    for (i, n) in nodes.iter().enumerate() {
                        let (open, close) = if *round { ("(", ")") } else { ("[", "]") };
                        let _ = writeln!(s, "      {}n{i}{open}{}{close}", u.id, quote(n));
                    }
                    for (from, to, label) in edges {
                        let _ = writeln!(s, "      {0}n{from} -->{1} {0}n{to}", u.id, edge_label(label));
                    }
                    s.push_str("    end\n");
                }
            }
        }
        s.push_str("  end\n");
    }
    for l in &view.links {
        let _ = writeln!(s, "  {} -->{} {}", l.from, edge_label(&l.label), l.to);
    }
    s
}

fn edge_label(label: &str) -> String {
    if label.is_empty() { String::new() } else { format!("|{}|", quote(label)) }
}

fn quote(text: &str) -> String {
    format!("\"{}\"", escape(text))
}
