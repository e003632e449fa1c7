//! `soifra plot`: the top view of a trace.

use super::replay::unreadable;
use crate::{exit::Exit, files, output, plot, report::Refusal, trace_file::Reader};
use clap::{Args, ValueHint};

/// Arguments.
#[derive(Debug, Args)]
pub struct Arguments {
    /// The trace
    #[arg(value_hint = ValueHint::FilePath)]
    trace: String,
    /// The picture, .svg or .png [default: both, beside the trace]
    #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    output: Vec<String>,
}

/// Runs the command.
pub fn run(a: &Arguments) -> Result<Exit, Refusal> {
    let reader = Reader::open(&a.trace).map_err(|e| unreadable(&a.trace, &e))?;
    let drawing = plot::top_view_of(reader).map_err(|e| unreadable(&a.trace, &e))?;
    let pictures = if a.output.is_empty() {
        let stem = a.trace.strip_suffix(".mcap").unwrap_or(&a.trace);
        vec![format!("{stem}.svg"), format!("{stem}.png")]
    } else {
        a.output.clone()
    };
    for path in &pictures {
        let lower = path.to_ascii_lowercase();
        let bytes = if lower.ends_with(".svg") {
            drawing.to_svg().into_bytes()
        } else if lower.ends_with(".png") {
            drawing.to_png(WIDTH).map_err(|e| {
                Refusal::about(
                    path,
                    "S9012",
                    "the picture cannot be drawn",
                    e.to_string(),
                    "write it as .svg",
                )
            })?
        } else {
            let hint = "end its name in .svg or .png";
            return Err(Refusal::about(
                path,
                "S9012",
                "the file cannot be written",
                "this is no kind of picture",
                hint,
            ));
        };
        files::write(path, &bytes)?;
    }
    output::print(&pictures.iter().map(|p| format!("{p}\n")).collect::<String>())?;
    Ok(Exit::Success)
}

/// Width of a PNG in pixels.
const WIDTH: u32 = 1600;
