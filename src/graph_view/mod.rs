//! Pictures of a behaviour graph: who reads, decides, tells and commands what.

mod agents;
mod dot;
mod layout;
mod mermaid;
mod model;
mod reach;
mod svg;

use soifra_graph::Graph;

/// What is shown of a graph.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
pub enum Show {
    /// Who reads, decides, tells and commands what
    #[default]
    Behaviour,
    /// The ontology: mission, goals, sub-goals, plans, agents, services, actions, and who is allocated
    Agents,
}

fn view(graph: &Graph, show: Show) -> model::View {
    match show {
        Show::Behaviour => model::View::of(graph),
        Show::Agents => agents::view(graph),
    }
}

/// The graph as a Mermaid flowchart.
pub fn mermaid(graph: &Graph, show: Show) -> String {
    mermaid::draw(&view(graph, show))
}

/// The graph in Graphviz's language.
pub fn dot(graph: &Graph, show: Show) -> String {
    dot::draw(&view(graph, show))
}

/// The graph as a picture, laid out.
pub fn svg(graph: &Graph, show: Show) -> String {
    svg::draw(&view(graph, show))
}
