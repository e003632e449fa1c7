//! The graph as a picture: things and agents in layers from what is sensed to what is commanded; in each
//! agent its units below each other, with their rules, states or plan nodes inside.

use super::{
    layout::{self, Edge, Placed, Size},
    model::{AgentBox, Inside, Kind, Thing, UnitBox, View},
};
use std::{collections::BTreeMap, fmt::Write};

/// Width of a character of the 12 px monospaced font, and of the 10 px one of labels.
const CHAR: f64 = 7.25;
const SMALL: f64 = 6.05;
const LINE: f64 = 16.0;
const PAD: f64 = 10.0;

const STYLE: &str = "text{font:12px 'DejaVu Sans Mono',Menlo,Consolas,monospace;fill:#1c2733}\
.t{font-weight:bold}.l{font-size:10px;fill:#51606e}.h{font:bold 16px sans-serif}\
.e{fill:none;stroke:#5b6b7a;stroke-width:1.2;marker-end:url(#a)}.p{fill:none;stroke:#9aa7b3;stroke-width:1}\
.agent{fill:#f3f6f9;stroke:#8fa1b3}.unit{fill:#fff;stroke:#5b6b7a}.node{fill:#eef4ff;stroke:#4a73b8}\
.sensor{fill:#e6f4ea;stroke:#3c8c55}.actuator{fill:#fdebe3;stroke:#c4582c}.topic{fill:#f2ebfb;stroke:#7d55b5}\
.arbiter{fill:#fff6da;stroke:#b08a1a}.goal{fill:#e4f3f7;stroke:#2b7d94}";

/// The picture's text.
pub fn draw(view: &View) -> String {
    let things = view.things.len();
    let mut blocks: Vec<Block> = view.things.iter().map(|t| Block::thing(t, 0.0)).collect();
    blocks.extend(view.agents.iter().map(Block::agent));
    let mut at: BTreeMap<String, (usize, f64)> = BTreeMap::new();
    for (i, b) in blocks.iter().enumerate() {
        at.extend(b.anchors.iter().map(|(id, y)| (id.clone(), (i, *y))));
    }
    let links: Vec<_> =
        view.links.iter().filter_map(|l| Some((l, *at.get(&l.from)?, *at.get(&l.to)?))).collect();
    // Things grow with their labelled links; units of agents have one place for all.
    let pairs: Vec<(usize, usize, bool)> =
        links.iter().map(|(l, a, b)| (a.0, b.0, !l.label.is_empty())).collect();
    let (heights, ends) = layout::slots(&blocks.iter().map(|b| b.size.h).collect::<Vec<_>>(), &pairs);
    for (i, t) in view.things.iter().enumerate() {
        blocks[i] = Block::thing(t, heights[i]);
    }
    let edges: Vec<Edge> = links
        .iter()
        .zip(ends)
        .map(|((l, a, b), ends)| Edge {
            from: a.0,
            to: b.0,
            from_y: if a.0 < things { ends.0 } else { a.1 },
            to_y: if b.0 < things { ends.1 } else { b.1 },
            label_w: width(&l.label, SMALL),
        })
        .collect();
    let sizes: Vec<Size> = blocks.iter().map(|b| b.size).collect();
    let placed = layout::place(&sizes, &edges);

    let (margin, top) = (20.0, 50.0);
    let (w, h) = (placed.w + 2.0 * margin, placed.h + top + margin + 26.0);
    let w = w.max(width(&view.title, 9.5) + 2.0 * margin).max(560.0);
    let mut s = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w:.0}\" height=\"{h:.0}\" viewBox=\"0 0 {w:.0} {h:.0}\">\n\
         <style>{STYLE}</style>\n<defs><marker id=\"a\" viewBox=\"0 0 8 8\" refX=\"7.5\" refY=\"4\" markerWidth=\"8\" markerHeight=\"8\" orient=\"auto\">\
         <path d=\"M0 0L8 4L0 8z\" fill=\"#5b6b7a\"/></marker></defs>\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n"
    );
    let _ = writeln!(s, "<text class=\"h\" x=\"{margin}\" y=\"28\">{}</text>", escape(&view.title));
    let _ = writeln!(s, "<g transform=\"translate({margin} {top})\">");
    for (i, b) in blocks.iter().enumerate() {
        let (x, y) = placed.boxes[i];
        let _ = writeln!(s, "<g transform=\"translate({x:.1} {y:.1})\">{}</g>", b.drawing);
    }
    for ((link, a, _), (route, edge)) in links.iter().zip(placed.routes.iter().zip(&edges)) {
        if edge.from == edge.to {
            // Within one box: around its right side.
            let (x, y) = placed.boxes[a.0];
            loop_edge(&mut s, x + sizes[a.0].w, y + edge.from_y, y + edge.to_y, &link.label);
        } else {
            curve(&mut s, route, &link.label);
        }
    }
    s.push_str("</g>\n");
    legend(&mut s, margin, h - 14.0);
    s.push_str("</svg>\n");
    s
}

/// A drawn box, and the heights at which links meet it.
struct Block {
    size: Size,
    drawing: String,
    anchors: Vec<(String, f64)>,
}

impl Block {
    fn thing(t: &Thing, height: f64) -> Block {
        let w = t.lines.iter().map(|l| width(l, CHAR)).fold(30.0, f64::max) + 2.0 * PAD;
        let text = t.lines.len() as f64 * LINE + PAD;
        let h = text.max(height);
        let (class, radius) = match t.kind {
            Kind::Sensor => ("sensor", text / 2.0),
            Kind::Actuator => ("actuator", 2.0),
            Kind::Topic => ("topic", 8.0),
            Kind::Arbiter => ("arbiter", 2.0),
            Kind::Goal | Kind::Mission => ("goal", text / 2.0),
            Kind::Subgoal => ("sensor", text / 2.0),
            Kind::Plan => ("topic", 2.0),
            Kind::Agent => ("agent", 2.0),
            Kind::Service => ("unit", 2.0),
            Kind::Action => ("actuator", 2.0),
        };
        let mut s = String::new();
        rect(&mut s, class, 0.0, 0.0, w, h, radius);
        for (i, l) in t.lines.iter().enumerate() {
            let _ = write!(
                s,
                "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
                w / 2.0,
                (h - text) / 2.0 + PAD / 2.0 + 12.0 + i as f64 * LINE,
                escape(l)
            );
        }
        Block { size: Size { w, h }, drawing: s, anchors: vec![(t.id.clone(), h / 2.0)] }
    }

    fn agent(a: &AgentBox) -> Block {
        let units: Vec<Block> = a.units.iter().map(Block::unit).collect();
        let w = units.iter().map(|u| u.size.w).fold(width(&a.title, CHAR), f64::max) + 2.0 * PAD;
        let mut y = LINE + 1.5 * PAD;
        let (mut inner, mut anchors) = (String::new(), vec![(a.id.clone(), LINE)]);
        for u in &units {
            let _ = write!(inner, "<g transform=\"translate({PAD} {y:.1})\">{}</g>", u.drawing);
            // Units are as wide as they need; links reach them from the agent's border.
            for (id, at) in &u.anchors {
                anchors.push((id.clone(), y + at));
                let _ = write!(inner, "<path class=\"p\" d=\"M0 {0:.1}H{PAD}\"/>", y + at);
                let _ =
                    write!(inner, "<path class=\"p\" d=\"M{1:.1} {0:.1}H{w:.1}\"/>", y + at, PAD + u.size.w);
            }
            y += u.size.h + PAD;
        }
        let mut s = String::new();
        rect(&mut s, "agent", 0.0, 0.0, w, y, 6.0);
        let _ = write!(
            s,
            "<text class=\"t\" x=\"{PAD}\" y=\"{:.1}\">{}</text>{inner}",
            PAD / 2.0 + 13.0,
            escape(&a.title)
        );
        Block { size: Size { w, h: y }, drawing: s, anchors }
    }

    fn unit(u: &UnitBox) -> Block {
        let (size, inside) = match &u.inside {
            Inside::Lines(lines) => text_lines(lines),
            Inside::Nodes { round, nodes, edges } => inner_graph(*round, nodes, edges),
        };
        let head = LINE + PAD;
        let (w, h) = (
            size.w.max(width(&u.title, CHAR)) + 2.0 * PAD,
            size.h + head + if size.h > 0.0 { PAD } else { 0.0 },
        );
        let mut s = String::new();
        rect(&mut s, "unit", 0.0, 0.0, w, h, 3.0);
        let _ = write!(
            s,
            "<text class=\"t\" x=\"{PAD}\" y=\"{:.1}\">{}</text>",
            PAD / 2.0 + 13.0,
            escape(&u.title)
        );
        let _ = write!(s, "<g transform=\"translate({PAD} {head})\">{inside}</g>");
        Block { size: Size { w, h }, drawing: s, anchors: vec![(u.id.clone(), head / 2.0)] }
    }
}

fn text_lines(lines: &[String]) -> (Size, String) {
    let mut s = String::new();
    for (i, l) in lines.iter().enumerate() {
        let _ =
            write!(s, "<text x=\"0\" y=\"{:.1}\">{}. {}</text>", 10.0 + i as f64 * LINE, i + 1, escape(l));
    }
    let w = lines.iter().map(|l| width(l, CHAR) + 4.0 * CHAR).fold(0.0, f64::max);
    (Size { w, h: lines.len() as f64 * LINE }, s)
}

fn inner_graph(round: bool, nodes: &[String], edges: &[(usize, usize, String)]) -> (Size, String) {
    let pairs: Vec<(usize, usize, bool)> =
        edges.iter().map(|(a, b, label)| (*a, *b, !label.is_empty())).collect();
    let (heights, ends) = layout::slots(&vec![24.0; nodes.len()], &pairs);
    let sizes: Vec<Size> =
        nodes.iter().zip(heights).map(|(n, h)| Size { w: width(n, CHAR) + 16.0, h }).collect();
    let lanes: Vec<Edge> = edges
        .iter()
        .zip(ends)
        .map(|((a, b, label), (from_y, to_y))| Edge {
            from: *a,
            to: *b,
            from_y,
            to_y,
            label_w: width(label, SMALL),
        })
        .collect();
    let p: Placed = layout::place(&sizes, &lanes);
    let mut s = String::new();
    let mut extra: f64 = 0.0;
    for (i, n) in nodes.iter().enumerate() {
        let (x, y) = p.boxes[i];
        rect(&mut s, "node", x, y, sizes[i].w, sizes[i].h, if round { 12.0 } else { 2.0 });
        if round && i == 0 {
            let _ = write!(
                s,
                "<rect class=\"p\" x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\" rx=\"9\"/>",
                x + 3.0,
                y + 3.0,
                sizes[i].w - 6.0,
                sizes[i].h - 6.0
            );
        }
        let _ = write!(
            s,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
            x + sizes[i].w / 2.0,
            y + sizes[i].h / 2.0 + 4.0,
            escape(n)
        );
    }
    for ((a, b, label), route) in edges.iter().zip(&p.routes) {
        if a == b {
            let (x, y) = p.boxes[*a];
            loop_edge(
                &mut s,
                x + sizes[*a].w,
                y + sizes[*a].h / 2.0 - 6.0,
                y + sizes[*a].h / 2.0 + 6.0,
                label,
            );
            extra = extra.max(x + sizes[*a].w + 36.0 + width(label, SMALL) - p.w);
        } else {
            curve(&mut s, route, label);
        }
    }
    (Size { w: p.w + extra, h: p.h }, s)
}

/// A smooth line through points; the label stands before the arrow's head.
fn curve(s: &mut String, route: &[(f64, f64)], label: &str) {
    let (Some(first), Some(last)) = (route.first(), route.last()) else { return };
    let mut d = format!("M{:.1} {:.1}", first.0, first.1);
    for w in route.windows(2) {
        let bend = (w[1].0 - w[0].0) / 2.0;
        let _ = write!(
            d,
            "C{:.1} {:.1} {:.1} {:.1} {:.1} {:.1}",
            w[0].0 + bend,
            w[0].1,
            w[1].0 - bend,
            w[1].1,
            w[1].0,
            w[1].1
        );
    }
    let _ = write!(s, "<path class=\"e\" d=\"{d}\"/>");
    if !label.is_empty() {
        let right = route.len() < 2 || route[route.len() - 2].0 <= last.0;
        let (x, anchor) = if right { (last.0 - 10.0, "end") } else { (last.0 + 10.0, "start") };
        let _ = write!(
            s,
            "<text class=\"l\" x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"{anchor}\">{}</text>",
            last.1 - 3.0,
            escape(label)
        );
    }
    s.push('\n');
}

/// A line that leaves a box on its right side and comes back to it.
fn loop_edge(s: &mut String, x: f64, from: f64, to: f64, label: &str) {
    let out = x + 26.0;
    let _ = write!(
        s,
        "<path class=\"e\" d=\"M{x:.1} {from:.1}C{out:.1} {from:.1} {out:.1} {to:.1} {x:.1} {to:.1}\"/>"
    );
    if !label.is_empty() {
        let _ = write!(
            s,
            "<text class=\"l\" x=\"{:.1}\" y=\"{:.1}\">{}</text>",
            x + 24.0,
            (from + to) / 2.0 + 4.0,
            escape(label)
        );
    }
}

fn rect(s: &mut String, class: &str, x: f64, y: f64, w: f64, h: f64, r: f64) {
    let _ = write!(
        s,
        "<rect class=\"{class}\" x=\"{x:.1}\" y=\"{y:.1}\" width=\"{w:.1}\" height=\"{h:.1}\" rx=\"{r:.1}\"/>"
    );
}

fn legend(s: &mut String, x: f64, y: f64) {
    let mut x = x;
    for name in ["sensor", "topic", "agent", "arbiter", "actuator", "goal"] {
        let _ = write!(
            s,
            "<rect class=\"{name}\" x=\"{x:.1}\" y=\"{:.1}\" width=\"14\" height=\"10\" rx=\"2\"/>",
            y - 9.0
        );
        let _ = writeln!(s, "<text class=\"l\" x=\"{:.1}\" y=\"{y:.1}\">{name}</text>", x + 18.0);
        x += 34.0 + width(name, SMALL);
    }
}

fn width(text: &str, char: f64) -> f64 {
    text.chars().count() as f64 * char
}

fn escape(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '&' => out.push_str("&amp;"),
            '"' => out.push_str("&quot;"),
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}
