//! Graphviz's language.

use super::model::{Inside, Kind, View};
use std::fmt::Write;

/// The digraph's text.
pub fn draw(view: &View) -> String {
    let mut s = format!(
        "digraph mission {{\n  label={};\n  labelloc=t;\n  rankdir=LR;\n  compound=true;\n  node [shape=box, fontname=\"sans-serif\", fontsize=11];\n  edge [fontname=\"sans-serif\", fontsize=9];\n",
        quote(&view.title)
    );
    for t in &view.things {
        let shape = match t.kind {
            Kind::Sensor => "ellipse",
            Kind::Actuator => "box3d",
            Kind::Topic => "cds",
            Kind::Arbiter => "diamond",
            Kind::Goal => "doublecircle",
            Kind::Mission => "house",
            Kind::Subgoal => "ellipse",
            Kind::Plan => "note",
            Kind::Agent => "component",
            Kind::Service | Kind::Action => "box",
        };
        let _ = writeln!(s, "  {} [shape={shape}, label={}];", t.id, quote(&t.lines.join("\n")));
    }
    for a in &view.agents {
        let _ = writeln!(
            s,
            "  subgraph cluster_{} {{\n    label={};\n    {} [shape=point, style=invis];",
            a.id,
            quote(&a.title),
            a.id
        );
        for u in &a.units {
            match &u.inside {
                Inside::Lines(lines) => {
                    let text = std::iter::once(&u.title).chain(lines).cloned().collect::<Vec<_>>().join("\n");
                    let _ = writeln!(s, "    {} [label={}];", u.id, quote(&text));
                }
                Inside::Nodes { round, nodes, edges } => {
                    let _ = writeln!(s, "    subgraph cluster_{} {{\n      label=\"\";", u.id);
                    let _ = writeln!(s, "      {} [shape=plaintext, label={}];", u.id, quote(&u.title));
                    let style = if *round { "rounded" } else { "solid" };
                    for (i, n) in nodes.iter().enumerate() {
                        let _ = writeln!(s, "      {}n{i} [style={style}, label={}];", u.id, quote(n));
                    }
                    let _ = writeln!(s, "      {0} -> {0}n0 [style=dotted];", u.id);
                    for (from, to, label) in edges {
                        let _ = writeln!(s, "      {0}n{from} -> {0}n{to} [label={1}];", u.id, quote(label));
                    }
                    s.push_str("    }\n");
                }
            }
        }
        s.push_str("  }\n");
    }
    for l in &view.links {
        let _ = writeln!(s, "  {} -> {} [label={}];", l.from, l.to, quote(&l.label));
    }
    s.push_str("}\n");
    s
}

fn quote(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            '\n' => out.push_str("\\l"),
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    if text.contains('\n') {
        out.push_str("\\l");
    }
    out.push('"');
    out
}
