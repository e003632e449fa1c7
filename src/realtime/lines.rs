//! Lines of a text that nobody vouches for: of any length, of any bytes.

use std::io::{BufRead, ErrorKind};

/// Longest line that is taken, in bytes.
pub(super) const LONGEST: usize = 4096;

/// A line, without its end.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Line {
    /// Text.
    Text(String),
    /// The beginning of one that is longer than [`LONGEST`].
    TooLong(String),
    /// One that is not UTF-8, as far as it can be shown.
    NotText(String),
    /// No line: the text cannot be read any further.
    Broken(String),
}

impl Line {
    fn new(bytes: &[u8]) -> Line {
        let lossy = || String::from_utf8_lossy(bytes).into_owned();
        match std::str::from_utf8(bytes) {
            _ if bytes.len() > LONGEST => Line::TooLong(lossy()),
            Ok(text) => Line::Text(text.to_string()),
            Err(_) => Line::NotText(lossy()),
        }
    }
}

/// Hands over each line until the text ends or `take` wants no more. Never keeps more than one line.
pub(super) fn read(mut text: impl BufRead, mut take: impl FnMut(Line) -> bool) {
    let mut line = Vec::new();
    loop {
        let piece = match text.fill_buf() {
            Ok(piece) => piece,
            Err(e) if e.kind() == ErrorKind::Interrupted => continue,
            Err(e) => {
                take(Line::Broken(crate::files::reason(&e)));
                return;
            }
        };
        if piece.is_empty() {
            if !line.is_empty() {
                take(Line::new(&line));
            }
            return;
        }
        let end = piece.iter().position(|b| *b == b'\n');
        let part = &piece[..end.unwrap_or(piece.len())];
        // One byte too many tells that it is too long; the rest of it is passed over.
        let room = (LONGEST + 1).saturating_sub(line.len());
        line.extend_from_slice(&part[..part.len().min(room)]);
        let used = end.map_or(piece.len(), |end| end + 1);
        text.consume(used);
        if end.is_some() {
            if !take(Line::new(&line)) {
                return;
            }
            line.clear();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::{BufReader, Read};

    fn lines(bytes: &[u8]) -> Vec<Line> {
        let mut out = Vec::new();
        // A small buffer, so that lines come in pieces.
        read(BufReader::with_capacity(7, bytes), |line| {
            out.push(line);
            true
        });
        out
    }

    #[test]
    fn every_line_is_handed_over() {
        let text = |s: &str| Line::Text(s.into());
        assert_eq!(lines(b""), []);
        assert_eq!(lines(b"stop\n"), [text("stop")]);
        assert_eq!(lines(b"one line\r\n\nlast"), [text("one line\r"), text(""), text("last")]);
        assert_eq!(lines(b"caf\xe9\nx"), [Line::NotText("caf\u{fffd}".into()), text("x")]);
        let fits = "y".repeat(LONGEST);
        assert_eq!(lines(format!("{fits}\n").as_bytes()), [text(&fits)]);
    }

    #[test]
    fn a_line_without_end_takes_no_room() {
        let long = std::io::repeat(b'x').take(10_000_000).chain(&b"\nstop\n"[..]);
        let mut out = Vec::new();
        read(BufReader::new(long), |line| {
            out.push(line);
            true
        });
        assert_eq!(out, [Line::TooLong("x".repeat(LONGEST + 1)), Line::Text("stop".into())]);
    }

    #[test]
    fn nobody_listens_any_more() {
        let mut n = 0;
        read(BufReader::new(std::io::repeat(b'\n')), |_| {
            n += 1;
            n < 3
        });
        assert_eq!(n, 3);
    }
}
