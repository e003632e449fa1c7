//! What pictures of traces have in common: colours and letters, titles, and what they say of the end of a run.

use super::{
    drawing::{Align, Color, Drawing, Lettering},
    font,
};
use crate::trace_file::Header;
use soifra_runtime::{Event, Record, Time};

/// Colour of letters and axes.
pub(super) const DARK: Color = [38, 42, 50];
/// Colour of what matters less.
pub(super) const MILD: Color = [96, 104, 116];
/// Colour of grids.
pub(super) const GRID: Color = [120, 130, 145];
/// Colour of what went wrong.
pub(super) const RED: Color = [214, 18, 32];
pub(super) const WHITE: Color = [255, 255, 255];

pub(super) const SMALL: Lettering = Lettering { size: 9.2, color: DARK, bold: false };
/// For what matters less.
pub(super) const FINE: Lettering = Lettering { size: 8.4, color: MILD, bold: false };
/// For headings.
pub(super) const BOLD: Lettering = Lettering { size: 9.2, color: DARK, bold: true };

/// How far the records went, and how the run ended.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Ending {
    /// Outcome and reason.
    outcome: Option<(String, String)>,
    /// Time of the last record.
    pub last: Time,
}

impl Ending {
    /// Takes the next record.
    pub(super) fn take(&mut self, record: &Record) {
        self.last = record.t;
        if let Event::End { outcome, reason } = &record.event {
            self.outcome = Some((outcome.clone(), reason.clone()));
        }
    }
}

/// The title of the mission, or its name.
pub(super) fn title(header: &Header) -> &str {
    if header.title.is_empty() { &header.mission } else { &header.title }
}

/// The run, in a line: mission, seed, parameters, outcome.
pub(super) fn subtitle(header: &Header, ending: &Ending, complete: bool) -> String {
    let t = format!("{:.3}", ending.last.seconds());
    let t = t.trim_end_matches('0').trim_end_matches('.');
    let end = match &ending.outcome {
        // A success needs no reason.
        Some((outcome, reason)) if reason.is_empty() || outcome == "success" => format!("{outcome} at {t} s"),
        Some((outcome, reason)) => format!("{outcome} at {t} s: {reason}"),
        None if complete => format!("no outcome recorded, last record at {t} s"),
        None => format!("the trace is cut off at {t} s"),
    };
    let set: String = header.params_set().iter().map(|p| format!(", {p}")).collect();
    format!("{}, seed {}{set}: {end}", header.mission, header.seed())
}

/// Writes title and subtitle above a picture that begins `left` on the page.
pub(super) fn titles(drawing: &mut Drawing, left: f64, title: &str, subtitle: &str) {
    let room = drawing.width - left - 16.0;
    let large = Lettering { size: 13.5, color: DARK, bold: true };
    drawing.text([left, 34.0], Align::Start, large, false, &font::fit(title, large.size, room));
    let small = Lettering { color: MILD, size: 9.6, ..SMALL };
    drawing.text([left, 56.0], Align::Start, small, false, &font::fit(subtitle, small.size, room));
}
