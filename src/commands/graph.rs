//! `soifra graph`: the behaviour graph as a picture or as data.

use crate::{
    cli::Mission, exit::Exit, files, graph_file, graph_view, output, output::Format, report::Refusal,
};
use clap::{Args, ValueEnum, ValueHint};
use soifra_graph::Graph;
use std::path::Path;

/// Arguments.
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    mission: Mission,
    /// What is shown
    #[arg(long, value_enum, default_value_t)]
    kind: graph_view::Show,
    /// The form [default: by the ending of the file to write, else mermaid]
    #[arg(long, value_enum)]
    format: Option<Form>,
    /// Write to this file instead of standard output
    #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    output: Option<String>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Form {
    /// Flowchart for Markdown pages
    Mermaid,
    /// For Graphviz
    Dot,
    /// A picture, laid out
    Svg,
    /// Graph file that can be run in place of the source
    Yaml,
    /// Graph file that can be run in place of the source
    Json,
}

impl Arguments {
    /// Whether standard output carries a JSON document.
    pub fn document(&self) -> Format {
        if self.form() == Form::Json && self.output.is_none() { Format::Json } else { Format::Human }
    }

    /// Refuses a file whose ending promises something else than what would be in it.
    fn fits(&self) -> Result<(), Refusal> {
        if self.kind != graph_view::Show::Behaviour && matches!(self.form(), Form::Yaml | Form::Json) {
            return Err(Refusal::about(
                "--kind",
                "S9012",
                "the file cannot be written",
                "a graph file holds the whole graph",
                "ask for a picture: `--format svg`, `dot` or `mermaid`",
            ));
        }
        let Some(path) = self.output.as_deref().filter(|_| self.format.is_none()) else { return Ok(()) };
        match Path::new(path).extension().and_then(|e| e.to_str()) {
            None | Some("mmd" | "mermaid" | "md" | "dot" | "gv" | "svg" | "yaml" | "yml" | "json") => Ok(()),
            Some(ending) => Err(Refusal::about(
                path,
                "S9012",
                "the file cannot be written",
                format!("no form of a graph ends in .{ending}"),
                "end its name in .svg, .mmd, .dot, .yaml or .json, or name the form with `--format`",
            )),
        }
    }

    fn form(&self) -> Form {
        let ending = self.output.as_deref().and_then(|p| Path::new(p).extension()?.to_str());
        self.format.unwrap_or(match ending {
            Some("dot" | "gv") => Form::Dot,
            Some("svg") => Form::Svg,
            Some("yaml" | "yml") => Form::Yaml,
            Some("json") => Form::Json,
            _ => Form::Mermaid,
        })
    }
}

/// Runs the command.
pub fn run(a: &Arguments) -> Result<Exit, Refusal> {
    a.fits()?;
    let compiled = a.mission.compile()?;
    compiled.findings.print();
    let text = render(&compiled.graph, a.form(), a.kind).map_err(|e| {
        Refusal::about(&a.mission.file, "S9999", "the graph cannot be written", e, "please report this")
            .exit(Exit::Internal)
    })?;
    match &a.output {
        Some(path) => {
            files::keep_apart(&a.mission.file, path)?;
            files::write(path, text.as_bytes())?;
        }
        None => output::print(&text)?,
    }
    Ok(Exit::Success)
}

fn render(graph: &Graph, form: Form, show: graph_view::Show) -> Result<String, String> {
    Ok(match form {
        Form::Mermaid => graph_view::mermaid(graph, show),
        Form::Dot => graph_view::dot(graph, show),
        Form::Svg => graph_view::svg(graph, show),
        Form::Yaml => graph_file::to_yaml(graph)?,
        Form::Json => graph_file::to_json(graph)?,
    })
}
