//! The lines of a source that a report shows, and nothing more: long lines are cut around what is
//! pointed at, and control characters cannot reach the terminal.

use miette::{MietteError, MietteSpanContents, SourceCode, SourceSpan, SpanContents};
use soifra_graph::{Span, span::Source};

/// Longest line shown, in characters.
const LINE: usize = 100;
/// Lines shown before and after a labelled one.
const AROUND: usize = 1;
/// Lines a label may run over; of a longer one only the first line is underlined.
const LABEL_LINES: usize = 6;
/// Longest title, label or hint, in characters.
const TEXT: usize = 600;

/// Text of a title, label or hint: control characters replaced, overlong texts cut.
pub fn clean(text: &str) -> String {
    let mut out: String = text.chars().take(TEXT).map(|c| if c == '\n' { c } else { visible(c) }).collect();
    if text.chars().nth(TEXT).is_some() {
        out.push('…');
    }
    out
}

fn visible(c: char) -> char {
    // Bidirectional overrides could make a line read as something else than what it says.
    let harmful =
        (c.is_control() && c != '\t') || matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    if harmful { '\u{fffd}' } else { c }
}

#[derive(Debug)]
struct Line {
    /// Line number in the source, from 0.
    number: usize,
    /// Byte range in the excerpt's text, line end included.
    start: usize,
    end: usize,
}

/// Quoted lines of one source.
#[derive(Debug)]
pub struct Excerpt {
    path: String,
    text: String,
    lines: Vec<Line>,
    /// Where each span starts: offset in the excerpt, column in the source (from 0).
    columns: Vec<(usize, usize)>,
}

impl Excerpt {
    /// The excerpt that shows `spans` of `source`, and where they are in it.
    pub fn new(source: &Source, spans: &[Span]) -> (Excerpt, Vec<SourceSpan>) {
        let text = &source.text;
        let starts = line_starts(text, spans);
        let line_of = |offset: usize| starts.partition_point(|s| *s <= offset).saturating_sub(1);
        let mut marks: Vec<Mark> = spans.iter().map(|s| Mark::new(text, *s, &line_of, &starts)).collect();

        let mut wanted: Vec<usize> = Vec::new();
        for m in &marks {
            wanted.extend(
                m.first.saturating_sub(AROUND)..=(m.last + AROUND).min(starts.len().saturating_sub(1)),
            );
        }
        wanted.sort_unstable();
        wanted.dedup();

        let mut excerpt = Excerpt {
            path: source.path.clone(),
            text: String::new(),
            lines: Vec::new(),
            columns: Vec::new(),
        };
        for number in wanted {
            let from = starts[number];
            let to = starts.get(number + 1).copied().unwrap_or(text.len());
            let line = text[from..to].trim_end_matches(['\n', '\r']);
            excerpt.push_line(number, from, line, &mut marks);
        }
        let spans =
            marks.iter().map(|m| SourceSpan::new(m.to.0.into(), m.to.1.saturating_sub(m.to.0))).collect();
        excerpt.columns = marks.iter().map(|m| (m.to.0, m.column)).collect();
        (excerpt, spans)
    }

    /// Appends a line, cut to a window that holds the first mark on it, and moves marks along.
    fn push_line(&mut self, number: usize, from: usize, line: &str, marks: &mut [Mark]) {
        let chars: Vec<(usize, char)> = line.char_indices().collect();
        let index = |byte: usize| chars.partition_point(|(i, _)| *i < byte);
        let first = marks.iter().find(|m| m.first == number || m.last == number);
        let pointed = first.map_or(0, |m| {
            index(if m.first == number { m.start - from } else { m.end.saturating_sub(from) })
        });
        let (mut low, mut high) = (0, chars.len());
        if chars.len() > LINE {
            low = pointed.saturating_sub(LINE / 4).min(chars.len() - LINE);
            high = low + LINE;
        }
        let start = self.text.len();
        if low > 0 {
            self.text.push('…');
        }
        // Offset in the excerpt of each character of the window, and of its end.
        let mut offsets = Vec::with_capacity(high - low + 1);
        for (_, c) in &chars[low..high] {
            offsets.push(self.text.len());
            self.text.push(visible(*c));
        }
        offsets.push(self.text.len());
        if high < chars.len() {
            self.text.push('…');
        }
        self.text.push('\n');
        let place = |byte: usize| offsets[index(byte).clamp(low, high) - low];
        for m in marks.iter_mut() {
            if m.first == number {
                m.to.0 = place(m.start - from);
                m.column = index(m.start - from);
            }
            if m.last == number {
                m.to.1 = place(m.end.saturating_sub(from)).max(m.to.0);
            }
        }
        self.lines.push(Line { number, start, end: self.text.len() });
    }
}

/// Byte offsets at which lines start, as far as a line after the last span.
fn line_starts(text: &str, spans: &[Span]) -> Vec<usize> {
    let end = spans.iter().map(|s| s.end.max(s.start) as usize).max().unwrap_or(0);
    let mut starts = vec![0];
    let mut past = 0;
    for (i, b) in text.bytes().enumerate() {
        if b == b'\n' && i + 1 < text.len() {
            starts.push(i + 1);
            past += usize::from(i >= end);
            if past > AROUND + 1 {
                break;
            }
        }
    }
    starts
}

/// A span on its way into the excerpt.
struct Mark {
    start: usize,
    end: usize,
    first: usize,
    last: usize,
    column: usize,
    to: (usize, usize),
}

impl Mark {
    fn new(text: &str, span: Span, line_of: &dyn Fn(usize) -> usize, starts: &[usize]) -> Mark {
        let floor = |mut i: usize| {
            i = i.min(text.len());
            while !text.is_char_boundary(i) {
                i -= 1;
            }
            i
        };
        let start = floor(span.start as usize);
        let mut end = floor(span.end as usize).max(start);
        let first = line_of(start);
        // An end at the very start of a line belongs to the line before.
        let mut last = line_of(if end > start { end - 1 } else { end });
        if last - first >= LABEL_LINES {
            last = first;
            end = starts.get(first + 1).map_or(text.len(), |s| s - 1);
        }
        Mark { start, end, first, last, column: 0, to: (0, 0) }
    }
}

impl SourceCode for Excerpt {
    fn read_span<'a>(
        &'a self,
        span: &SourceSpan,
        before: usize,
        after: usize,
    ) -> Result<Box<dyn SpanContents<'a> + 'a>, MietteError> {
        let at = |offset: usize| {
            self.lines.partition_point(|l| l.end <= offset).min(self.lines.len().saturating_sub(1))
        };
        if self.lines.is_empty() {
            return Err(MietteError::OutOfBounds);
        }
        let exact = at(span.offset());
        let (mut low, mut high) = (exact, at(span.offset() + span.len().saturating_sub(1)));
        for _ in 0..before {
            if low > 0 && self.lines[low - 1].number + 1 == self.lines[low].number {
                low -= 1;
            }
        }
        for _ in 0..after {
            if high + 1 < self.lines.len() && self.lines[high + 1].number == self.lines[high].number + 1 {
                high += 1;
            }
        }
        let (start, column) = if before == 0 {
            let column = self.columns.iter().find(|(o, _)| *o == span.offset()).map_or(0, |(_, c)| *c);
            (span.offset().min(self.text.len()), column)
        } else {
            (self.lines[low].start, 0)
        };
        let end = self.lines[high].end.max(start);
        Ok(Box::new(MietteSpanContents::new_named(
            self.path.clone(),
            &self.text.as_bytes()[start..end],
            SourceSpan::new(start.into(), end - start),
            self.lines[if before == 0 { exact } else { low }].number,
            column,
            high - low + 1,
        )))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source(text: &str) -> Source {
        Source { path: "a.soi".into(), text: text.into() }
    }

    #[test]
    fn spans_outside_and_inside_characters_do_no_harm() {
        for text in ["", "ä", "a\nb", "\n\n\n", "x\r\ny"] {
            for start in 0..6 {
                for end in 0..6 {
                    let (e, s) = Excerpt::new(&source(text), &[Span::new(0, start, end)]);
                    assert!(e.read_span(&s[0], 1, 1).is_ok());
                    assert!(e.read_span(&s[0], 0, 0).is_ok());
                }
            }
        }
    }

    #[test]
    fn long_lines_are_cut_around_the_mark() {
        let text = format!("{}mark{}", "x".repeat(5000), "y".repeat(5000));
        let (e, s) = Excerpt::new(&source(&text), &[Span::new(0, 5000, 5004)]);
        assert!(e.text.chars().count() < LINE + 4);
        assert_eq!(&e.text[s[0].offset()..s[0].offset() + s[0].len()], "mark");
        assert_eq!(e.read_span(&s[0], 0, 0).unwrap().column(), 5000);
    }
}
