//! `soifra plot`: pictures of a trace.

use super::replay::unreadable;
use crate::{
    exit::Exit,
    files, image_files, output,
    plot::{self, Drawing, Gantt, SelectError, Selection, Sequence, Sheet},
    report::Refusal,
    services::Overlay,
    trace_file::Reader,
};
use clap::{Args, ValueEnum, ValueHint};
use soifra_graph::{Dim, Type, TypeTable};
use soifra_runtime::Time;

/// Arguments.
#[derive(Debug, Args)]
pub struct Arguments {
    /// The trace
    #[arg(value_hint = ValueHint::FilePath)]
    trace: String,
    /// What to draw
    #[arg(long, value_enum, default_value_t)]
    kind: Kind,
    /// Draw only what has to do with this agent, as `courier` or `courier@r1`; may be repeated
    #[arg(long, value_name = "NAME")]
    agent: Vec<String>,
    /// Draw only messages of this conversation, or of those whose identifiers begin so; may be repeated
    #[arg(long, value_name = "ID")]
    conversation: Vec<String>,
    /// Begin at this instant of virtual time, as `2 s` or `350us` [default: the beginning]
    #[arg(long, value_name = "T", value_parser = instant)]
    from: Option<Time>,
    /// End at this instant [default: the end; of a schedule, 60 releases of its most frequent unit]
    #[arg(long, value_name = "T", value_parser = instant)]
    to: Option<Time>,
    /// Draw at most so many rows of messages, lanes of units [default: 400] or images [default: 24]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    limit: Option<u32>,
    /// Draw into images what is seen in them: upright edges, the pairs that are obstacles (left blue, right red, thick the
    /// first) and the optical centre; the flow on the first obstacle, eightfold, and its focus of expansion. It is looked for
    /// again in all images up to the last one shown, with `look`'s defaults and the readings of inertial unit and odometry
    #[arg(long, value_enum, value_delimiter = ',', value_name = "WHAT")]
    overlay: Vec<Layer>,
    /// The picture: .svg, .png, for messages also .mmd [default: two of them, beside the trace]
    #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    output: Vec<String>,
}

/// What a picture shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
enum Kind {
    /// The top view: the world, who went where, what touched
    #[default]
    Top,
    /// The message sequence chart: who told whom what
    Sequence,
    /// The schedule: which unit ran when on which core
    Gantt,
    /// The contact sheet: what cameras saw
    Frames,
}

/// What is drawn into images.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Layer {
    /// Upright edges, pairs, optical centre
    Edges,
    /// Flow and its focus
    Flow,
}

/// The form of a picture, by the ending of its file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Form {
    Svg,
    Png,
    Mermaid,
}

/// What was read from the trace.
enum Picture {
    Drawing(Drawing),
    Sequence(Sequence),
    Sheet(Sheet),
}

/// Width of a PNG in pixels.
const WIDTH: u32 = 1600;
/// Rows or lanes that are drawn when nobody says how many.
const LIMIT: u32 = 400;
/// Images that are shown when nobody says how many.
const FRAMES: u32 = 24;

/// Runs the command.
pub fn run(a: &Arguments) -> Result<Exit, Refusal> {
    a.fits()?;
    let outputs = a.outputs()?;
    let (picture, rest) = a.picture()?;
    for (path, form) in &outputs {
        let bytes = match (&picture, form) {
            (Picture::Sequence(chart), Form::Mermaid) => chart.mermaid().into_bytes(),
            (Picture::Sequence(chart), _) => painted(&chart.drawing(), path, *form)?,
            (Picture::Drawing(drawing), _) => painted(drawing, path, *form)?,
            (Picture::Sheet(sheet), _) => sheet.to_png().map_err(|e| {
                let hint = "choose fewer images: `--limit 8`";
                Refusal::about(path, "S9012", "the picture cannot be drawn", e.to_string(), hint)
            })?,
        };
        files::keep_apart(&a.trace, path)?;
        files::write(path, &bytes)?;
    }
    if let Some(rest) = rest {
        let more = if a.kind == Kind::Frames { "" } else { "; `--limit N` draws more" };
        output::note(&format!("{}: {rest}{more}", a.trace));
    }
    output::print(&outputs.iter().map(|(path, _)| format!("{path}\n")).collect::<String>())?;
    Ok(Exit::Success)
}

impl Arguments {
    /// Refuses options that say nothing to the kind of picture that is wanted.
    fn fits(&self) -> Result<(), Refusal> {
        let (top, frames) = (self.kind == Kind::Top, self.kind == Kind::Frames);
        let messages = self.kind == Kind::Sequence;
        let wrong = [
            ("--agent", !self.agent.is_empty() && (top || frames)),
            ("--conversation", !self.conversation.is_empty() && !messages),
            ("--from", self.from.is_some() && top),
            ("--to", self.to.is_some() && top),
            ("--limit", self.limit.is_some() && top),
            ("--overlay", !self.overlay.is_empty() && !frames),
        ];
        if let Some((option, _)) = wrong.into_iter().find(|(_, wrong)| *wrong) {
            let (seen, hint) = match self.kind {
                _ if option == "--overlay" => ("it is drawn into images", "choose `--kind frames`"),
                Kind::Top => {
                    ("the top view shows the whole run", "choose `--kind sequence` or `--kind gantt`")
                }
                Kind::Frames => ("images are of no agent", "choose `--kind sequence` or `--kind gantt`"),
                _ => ("a schedule has no messages", "choose `--kind sequence`"),
            };
            return Err(Refusal::about(option, "S9024", "the option does not go with this kind", seen, hint));
        }
        if !self.overlay.is_empty() && !cfg!(feature = "vision") {
            return Err(Refusal::about(
                "--overlay",
                "S9029",
                "nothing can be seen in images by this program",
                "what is drawn is found by vision; the program was built without it",
                "build it with the feature `vision`, which needs OpenCV: `cargo build --release`",
            ));
        }
        match (self.from, self.to) {
            (Some(from), Some(to)) if from >= to => Err(Refusal::about(
                "--to",
                "S9024",
                "there is nothing between these instants",
                "it has to be later than `--from`",
                "give instants of virtual time, from the start of the run",
            )),
            _ => Ok(()),
        }
    }

    /// The files to write.
    fn outputs(&self) -> Result<Vec<(String, Form)>, Refusal> {
        let stem = self.trace.strip_suffix(".mcap").unwrap_or(&self.trace);
        let sheet = [format!("{stem}-frames.png")];
        let beside = match self.kind {
            Kind::Top => [format!("{stem}.svg"), format!("{stem}.png")],
            Kind::Sequence => [format!("{stem}-sequence.svg"), format!("{stem}-sequence.mmd")],
            Kind::Gantt | Kind::Frames => [format!("{stem}-gantt.svg"), format!("{stem}-gantt.png")],
        };
        let frames = self.kind == Kind::Frames;
        let paths = match self.output.as_slice() {
            [] if frames => &sheet[..],
            [] => &beside[..],
            given => given,
        };
        let form = |path: &String| {
            let lower = path.to_ascii_lowercase();
            let mermaid = self.kind == Kind::Sequence;
            let form = match lower.rsplit_once('.').map_or("", |(_, ending)| ending) {
                "svg" if !frames => Form::Svg,
                "png" => Form::Png,
                "mmd" | "mermaid" if mermaid => Form::Mermaid,
                _ => {
                    let hint = match self.kind {
                        Kind::Sequence => "end its name in .svg, .png or .mmd",
                        Kind::Frames => "end its name in .png",
                        _ => "end its name in .svg or .png",
                    };
                    let seen = "this is no kind of picture";
                    return Err(Refusal::about(path, "S9012", "the file cannot be written", seen, hint));
                }
            };
            Ok((path.clone(), form))
        };
        paths.iter().map(form).collect()
    }

    /// The picture, and what is said of what was left out.
    fn picture(&self) -> Result<(Picture, Option<String>), Refusal> {
        let unreadable = |e| unreadable(&self.trace, &e);
        let selection = self.selection()?;
        let most = if self.kind == Kind::Frames { FRAMES } else { LIMIT };
        let limit = self.limit.unwrap_or(most) as usize;
        let reader = Reader::open(&self.trace).map_err(unreadable)?;
        Ok(match self.kind {
            Kind::Top => (Picture::Drawing(plot::top_view_of(reader).map_err(unreadable)?), None),
            Kind::Sequence => {
                let chart = Sequence::read(reader, &selection, limit).map_err(unreadable)?;
                let rest = chart.rest();
                (Picture::Sequence(chart), rest)
            }
            Kind::Frames => {
                // Images of a world that has changed since would be none of the run.
                image_files::again(&reader.header().scene.images)?;
                let sheet = Sheet::read(reader, &selection, limit, self.layers()).map_err(unreadable)?;
                let rest = sheet.rest();
                (Picture::Sheet(sheet), rest)
            }
            Kind::Gantt => {
                let gantt = Gantt::read(reader, &selection, limit).map_err(unreadable)?;
                (Picture::Drawing(gantt.drawing()), gantt.rest())
            }
        })
    }

    fn layers(&self) -> Overlay {
        let has = |layer| self.overlay.contains(&layer);
        Overlay { edges: has(Layer::Edges), flow: has(Layer::Flow) }
    }

    /// The part of the trace that is asked for. Names are looked up in the whole trace before it is drawn.
    fn selection(&self) -> Result<Selection, Refusal> {
        let times = Selection { from: self.from, to: self.to, ..Selection::default() };
        if self.agent.is_empty() && self.conversation.is_empty() {
            return Ok(times);
        }
        let reader = Reader::open(&self.trace).map_err(|e| unreadable(&self.trace, &e))?;
        match Selection::find(reader, &self.agent, &self.conversation) {
            Ok(found) => Ok(Selection { from: self.from, to: self.to, ..found }),
            Err(SelectError::Trace(e)) => Err(unreadable(&self.trace, &e)),
            Err(SelectError::Unknown { what, name, hint }) => {
                let argument = format!("--{what} {name}");
                let seen = format!("nothing in this trace tells of {what} `{name}`");
                Err(Refusal::about(&argument, "S9027", format!("unknown {what}"), seen, &hint))
            }
        }
    }
}

fn painted(drawing: &Drawing, path: &str, form: Form) -> Result<Vec<u8>, Refusal> {
    match form {
        Form::Png => drawing.to_png(drawing.png_width(WIDTH)).map_err(|e| {
            Refusal::about(path, "S9012", "the picture cannot be drawn", e.to_string(), "write it as .svg")
        }),
        Form::Svg | Form::Mermaid => Ok(drawing.to_svg().into_bytes()),
    }
}

/// An instant of a run, as `2 s`; a number alone is seconds.
fn instant(text: &str) -> Result<Time, String> {
    let seconds = match text.trim().parse::<f64>() {
        Ok(seconds) => Some(seconds),
        Err(_) => soifra_lang::parse_value(text, &Type::Quantity(Dim::TIME), &TypeTable::default())?.number(),
    };
    seconds
        .and_then(Time::from_seconds)
        .filter(|t| *t >= Time::ZERO)
        .ok_or_else(|| "give an instant of virtual time, from 0 s on".into())
}
