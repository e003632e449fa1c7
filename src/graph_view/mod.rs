//! Pictures of a behaviour graph: who reads, decides, tells and commands what.

mod dot;
mod layout;
mod mermaid;
mod model;
mod reach;
mod svg;

use soifra_graph::Graph;

/// The graph as a Mermaid flowchart.
pub fn mermaid(graph: &Graph) -> String {
    mermaid::draw(&model::View::of(graph))
}

/// The graph in Graphviz's language.
pub fn dot(graph: &Graph) -> String {
    dot::draw(&model::View::of(graph))
}

/// The graph as a picture, laid out.
pub fn svg(graph: &Graph) -> String {
    svg::draw(&model::View::of(graph))
}
