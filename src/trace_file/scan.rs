//! The messages of an MCAP file in order, from a stream that may end anywhere.
//!
//! A chunk is used only when it is there completely and its checksum holds. Nothing is allocated on the
//! word of a length field: memory grows with the bytes that are really there.

use super::{TraceError, schema};
use mcap::records::{Record as McapRecord, op};
use std::{
    collections::BTreeMap,
    io::{self, Read},
    ops::Range,
};

/// Greatest length of a record of the file, and of a chunk once decompressed.
const MAX_BYTES: u64 = 1 << 30;
/// Opcode and length.
const RECORD_HEAD: usize = 9;

/// What the messages of a channel are to us.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Content {
    /// The header of the trace.
    Header,
    /// A record.
    Record,
    /// A record of a pose as a transform.
    Transform,
    /// A snapshot.
    Snapshot,
    /// Something that only others read.
    Other,
}

/// How the stream ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum End {
    /// With the footer: its writer closed it.
    Closed,
    /// Before.
    CutOff,
}

/// Reads messages.
pub(crate) struct Scanner<R> {
    input: R,
    /// Offset of what is read next.
    offset: u64,
    /// Body of the last record of the file.
    body: Vec<u8>,
    /// Content of the chunk being read, how far it has been read, and where it lies in the file.
    chunk: Vec<u8>,
    read: usize,
    chunk_offset: u64,
    channels: BTreeMap<u16, Content>,
    end: Option<End>,
}

/// A message.
pub(crate) struct Message<'a> {
    pub content: Content,
    pub data: &'a [u8],
    /// Offset in the file of the message, or of the chunk that holds it.
    pub at: u64,
}

impl<R: Read> Scanner<R> {
    /// Checks how the stream begins.
    pub(crate) fn new(input: R) -> Result<Self, TraceError> {
        let mut s = Scanner {
            input,
            offset: 0,
            body: Vec::new(),
            chunk: Vec::new(),
            read: 0,
            chunk_offset: 0,
            channels: BTreeMap::new(),
            end: None,
        };
        let whole = s.take(mcap::MAGIC.len() as u64)?;
        match () {
            () if s.body.is_empty() => Err(TraceError::Empty),
            () if !mcap::MAGIC.starts_with(&s.body) => Err(TraceError::NotMcap),
            () if !whole => Err(TraceError::NoHeader),
            () => Ok(s),
        }
    }

    /// How the stream ended, once it has.
    pub(crate) fn end(&self) -> Option<End> {
        self.end
    }

    /// The next message; `None` at the end.
    pub(crate) fn next(&mut self) -> Result<Option<Message<'_>>, TraceError> {
        while self.end.is_none() {
            if self.read < self.chunk.len() {
                let at = self.chunk_offset;
                let Some((op, body)) = split(&self.chunk, self.read) else {
                    return Err(damaged(at, "a record reaches beyond its chunk"));
                };
                self.read = body.end;
                if let Some((content, data)) =
                    interpret(&mut self.channels, op, &self.chunk[body.clone()], at)?
                {
                    return Ok(Some(Message { content, data: &self.chunk[body.end - data..body.end], at }));
                }
                continue;
            }
            let at = self.offset;
            let Some(op) = self.record()? else {
                self.end = Some(End::CutOff);
                break;
            };
            match op {
                op::CHUNK => {
                    decompress(&self.body, &mut self.chunk).map_err(|e| damaged(at, e))?;
                    (self.read, self.chunk_offset) = (0, at);
                }
                op::DATA_END => self.end = Some(self.summary()?),
                _ => {
                    if let Some((content, data)) = interpret(&mut self.channels, op, &self.body, at)? {
                        return Ok(Some(Message { content, data: &self.body[self.body.len() - data..], at }));
                    }
                }
            }
        }
        Ok(None)
    }

    /// Passes over the summary. What is wrong with it does not matter to us, who have read everything: the
    /// file counts as cut off there.
    fn summary(&mut self) -> Result<End, TraceError> {
        loop {
            match self.record() {
                Ok(Some(op::FOOTER)) => {
                    let closed = self.take(mcap::MAGIC.len() as u64)? && self.body == mcap::MAGIC;
                    return Ok(if closed { End::Closed } else { End::CutOff });
                }
                Ok(Some(_)) => {}
                Ok(None) | Err(TraceError::Damaged { .. }) => return Ok(End::CutOff),
                Err(e) => return Err(e),
            }
        }
    }

    /// Reads the next record of the file into `body` and returns its opcode; `None` when the stream ends
    /// before the record does.
    fn record(&mut self) -> Result<Option<u8>, TraceError> {
        let at = self.offset;
        if !self.take(RECORD_HEAD as u64)? {
            return Ok(None);
        }
        let op = self.body[0];
        let length = length(&self.body[1..]);
        if length > MAX_BYTES {
            return Err(damaged(at, format!("a record of {length} bytes")));
        }
        Ok(self.take(length)?.then_some(op))
    }

    /// Reads `n` bytes into `body`; false when the stream ends before.
    fn take(&mut self, n: u64) -> io::Result<bool> {
        self.body.clear();
        let read = (&mut self.input).take(n).read_to_end(&mut self.body)? as u64;
        self.offset += read;
        Ok(read == n)
    }
}

/// Learns from a channel record; for a message, tells what it is and how long its data are, which end
/// with the body.
fn interpret(
    channels: &mut BTreeMap<u16, Content>,
    op: u8,
    body: &[u8],
    at: u64,
) -> Result<Option<(Content, usize)>, TraceError> {
    if !matches!(op, op::CHANNEL | op::MESSAGE) {
        return Ok(None);
    }
    if !texts_fit(op, body) {
        return Err(damaged(at, "a channel whose texts are longer than its record"));
    }
    match mcap::parse_record(op, body).map_err(|e| damaged(at, e))? {
        McapRecord::Channel(c) => {
            let content = match &*c.topic {
                _ if c.message_encoding != "json" => Content::Other,
                schema::HEADER_TOPIC => Content::Header,
                schema::TF_TOPIC => Content::Transform,
                schema::SNAPSHOT_TOPIC => Content::Snapshot,
                t if t.starts_with(schema::RECORD_PREFIX) => Content::Record,
                _ => Content::Other,
            };
            channels.insert(c.id, content);
            Ok(None)
        }
        McapRecord::Message { header, data } => match channels.get(&header.channel_id) {
            Some(content) => Ok(Some((*content, data.len()))),
            None => Err(damaged(
                at,
                format!("a message on channel {}, which was not declared", header.channel_id),
            )),
        },
        _ => Ok(None),
    }
}

/// Whether the texts in the body of a channel or of a chunk end within it. The library makes room for as many
/// bytes as a text announces before it reads them.
fn texts_fit(op: u8, body: &[u8]) -> bool {
    // The end of the text, or of the map, that begins at `from`.
    let end = |from: usize| {
        let head = body.get(from..from.checked_add(4)?)?;
        let end = (from + 4).checked_add(usize::try_from(length(head)).ok()?)?;
        (end <= body.len()).then_some(end)
    };
    let channel = || {
        // Two numbers, topic, encoding, and a map of texts.
        let map = end(end(4)?)?;
        let (mut at, last) = (map + 4, end(map)?);
        while at < last {
            at = end(at)?;
        }
        (at == last).then_some(())
    };
    match op {
        op::CHANNEL => channel().is_some(),
        // Two times, the length and the checksum come first.
        op::CHUNK => end(28).is_some(),
        _ => true,
    }
}

/// Opcode and place of the body of the record at `from`; `None` when it reaches beyond the chunk.
fn split(chunk: &[u8], from: usize) -> Option<(u8, Range<usize>)> {
    let start = from.checked_add(RECORD_HEAD)?;
    let head = chunk.get(from..start)?;
    let end = start.checked_add(usize::try_from(length(&head[1..])).ok()?)?;
    (end <= chunk.len()).then_some((head[0], start..end))
}

/// A length field: eight bytes, little end first.
fn length(bytes: &[u8]) -> u64 {
    bytes.iter().take(8).rev().fold(0, |n, b| n << 8 | u64::from(*b))
}

/// The content of a chunk record, checked.
fn decompress(body: &[u8], out: &mut Vec<u8>) -> Result<(), String> {
    out.clear();
    let chunk = texts_fit(op::CHUNK, body).then(|| mcap::parse_record(op::CHUNK, body));
    let Some(Ok(McapRecord::Chunk { header, data })) = chunk else {
        return Err("a chunk without a proper head".into());
    };
    let size = header.uncompressed_size;
    if size > MAX_BYTES {
        return Err(format!("a chunk of {size} bytes"));
    }
    let unreadable = |e: &dyn std::fmt::Display| format!("a chunk that cannot be decompressed: {e}");
    // One byte more than announced, to see that there is none.
    let read = match &*header.compression {
        "" => (&*data).take(size + 1).read_to_end(out),
        "lz4" => lz4::Decoder::new(&*data).and_then(|d| d.take(size + 1).read_to_end(out)),
        "zstd" => match ruzstd::decoding::StreamingDecoder::new(&*data) {
            Ok(d) => d.take(size + 1).read_to_end(out),
            Err(e) => return Err(unreadable(&e)),
        },
        other => return Err(format!("a chunk compressed with `{other}`, which is not known here")),
    };
    match read {
        Err(e) => return Err(unreadable(&e)),
        Ok(n) if n as u64 != size => return Err("a chunk whose length is wrong".into()),
        Ok(_) => {}
    }
    // 0 stands for "no checksum".
    if header.uncompressed_crc != 0 && crc32fast::hash(out) != header.uncompressed_crc {
        return Err("a chunk whose checksum is wrong".into());
    }
    Ok(())
}

pub(crate) fn damaged(at: u64, what: impl ToString) -> TraceError {
    TraceError::Damaged { at, what: what.to_string() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_that_announce_more_than_there_is_are_not_read() {
        let mut chunk = vec![0; 28];
        chunk.extend(3u32.to_le_bytes());
        chunk.extend(b"lz4");
        assert!(texts_fit(op::CHUNK, &chunk));
        chunk[31] = 0xff;
        assert!(!texts_fit(op::CHUNK, &chunk) && !texts_fit(op::CHUNK, &chunk[..30]));

        let text = |t: &str| [&(t.len() as u32).to_le_bytes()[..], t.as_bytes()].concat();
        let map = [text("key"), text("value")].concat();
        let sized = [&(map.len() as u32).to_le_bytes()[..], &map].concat();
        let channel = [vec![0; 4], text("/tf"), text("json"), sized].concat();
        assert!(texts_fit(op::CHANNEL, &channel));
        for (i, byte) in channel.iter().enumerate() {
            let mut other = channel.clone();
            // The high byte of each length.
            if *byte == 0 && i > 4 {
                other[i] = 0xff;
                assert!(!texts_fit(op::CHANNEL, &other), "{i}");
            }
        }
    }
}
