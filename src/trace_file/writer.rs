//! Writes a trace while the run goes on.
//!
//! Chunks are handed to the operating system whole, one after the other, without seeking back: when the
//! process is killed the file holds every chunk but the last.

use super::{
    Header, SCHEMA,
    scene_update::SceneUpdate,
    schema,
    transform::{Transform, robot_frame},
};
use mcap::write::NoSeek;
use sha2::{Digest, Sha256};
use soifra_runtime::{Record, Snapshot, Time, TraceSink};
use std::{
    collections::BTreeMap,
    fs::File,
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
};

/// Greatest size of a chunk before compression. Only a message that is longer by itself makes a longer one.
pub const CHUNK_BYTES: usize = 1 << 20;
/// Greatest span of virtual time in a chunk.
pub const CHUNK_TIME: Time = Time(1_000_000_000);

/// Takes the records of a run into a file.
///
/// Dropping it without [`Writer::finish`] leaves a file that [`super::read`] opens all the same.
pub struct Writer {
    out: mcap::Writer<NoSeek<BufWriter<Hashing>>>,
    path: PathBuf,
    /// Channels by kind, opened when first needed.
    channels: [Option<u16>; schema::KINDS.len()],
    transforms: Option<u16>,
    /// Frames of the robots.
    frames: Vec<String>,
    chunk: Chunk,
    snapshots: Snapshots,
    /// The message being written; kept for its memory.
    message: Vec<u8>,
}

/// The chunk that is open.
#[derive(Default)]
struct Chunk {
    bytes: usize,
    start: Time,
}

/// Least span of virtual time between two snapshots.
pub const SNAPSHOT_TIME: Time = Time(10_000_000_000);

/// Snapshots are at most one part in so many of a trace, before compression, besides the first.
const SNAPSHOT_SHARE: usize = 5;

/// When the next snapshot is due.
#[derive(Default)]
struct Snapshots {
    channel: Option<u16>,
    last: Time,
    /// Bytes of records still to be written before the next.
    wait: usize,
}

/// What [`Writer::finish`] tells about the file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Finished {
    /// SHA-256 of the file, in hexadecimal.
    pub digest: String,
    /// Length of the file.
    pub bytes: u64,
}

impl Writer {
    /// Creates the file (or empties it), and writes header and scene. Fails when the path cannot be
    /// written, when the disk is full, or when `header.graph_json` is no JSON.
    pub fn create(path: impl AsRef<Path>, header: &Header) -> io::Result<Writer> {
        let path = path.as_ref();
        let file = Hashing { file: File::create(path)?, hash: Sha256::new(), bytes: 0 };
        let out = mcap::WriteOptions::new()
            // Nothing that differs between machines: not the library's own version either.
            .library(format!("soifra trace {SCHEMA}"))
            .compression(Some(mcap::Compression::Lz4))
            .chunk_size(None)
            .disable_seeking(true)
            .create(NoSeek::new(BufWriter::with_capacity(1 << 16, file)))
            .map_err(io_error)?;
        let mut writer = Writer {
            out,
            path: path.to_path_buf(),
            channels: [None; schema::KINDS.len()],
            transforms: None,
            frames: header.scene.robots.iter().map(|r| robot_frame(&r.name)).collect(),
            chunk: Chunk::default(),
            snapshots: Snapshots::default(),
            message: Vec::with_capacity(1024),
        };
        writer.once(schema::HEADER_TOPIC, schema::HEADER, header.to_message()?)?;
        let scene = serde_json::to_vec(&SceneUpdate::of(&header.scene))?;
        writer.once(schema::SCENE_TOPIC, schema::SCENE_UPDATE, scene)?;
        // So that a run that dies early leaves its header, and a full disk is known at the start.
        writer.close_chunk()?;
        Ok(writer)
    }

    /// Writes what is still in memory and the summary, and closes the file.
    pub fn finish(mut self) -> io::Result<Finished> {
        self.out.finish().map_err(io_error)?;
        let mut buffered = self.out.into_inner().into_inner();
        buffered.flush()?;
        let Hashing { hash, bytes, .. } = buffered.into_inner().map_err(|e| e.into_error())?;
        Ok(Finished { digest: super::hex(&hash.finalize()), bytes })
    }

    /// Writes one record.
    pub fn write(&mut self, record: &Record) -> io::Result<()> {
        if record.t < Time::ZERO {
            return Err(io::Error::new(
                io::ErrorKind::InvalidInput,
                "a record lies before the start of the run",
            ));
        }
        self.message.clear();
        let transform = Transform::of(record, &self.frames);
        let channel = match transform {
            Some(transform) => {
                serde_json::to_writer(&mut self.message, &transform)?;
                self.make_room(record.t)?;
                match self.transforms {
                    Some(channel) => channel,
                    None => {
                        let (name, text) = schema::FRAME_TRANSFORM;
                        let channel = self.open_channel(schema::TF_TOPIC, name, text)?;
                        *self.transforms.insert(channel)
                    }
                }
            }
            None => {
                serde_json::to_writer(&mut self.message, record)?;
                self.make_room(record.t)?;
                let kind = schema::kind(&record.event);
                match self.channels[kind] {
                    Some(channel) => channel,
                    None => {
                        let (name, members) = schema::KINDS[kind];
                        let text = schema::schema_text(name, members);
                        let topic = format!("{}{name}", schema::RECORD_PREFIX);
                        let channel = self.open_channel(&topic, &schema::schema_name(name), &text)?;
                        *self.channels[kind].insert(channel)
                    }
                }
            }
        };
        self.snapshots.wait = self.snapshots.wait.saturating_sub(self.message.len());
        self.put(channel, record.n, record.t)
    }

    fn write_snapshot(&mut self, snapshot: &Snapshot) -> io::Result<()> {
        self.message.clear();
        serde_json::to_writer(&mut self.message, snapshot)?;
        (self.snapshots.last, self.snapshots.wait) = (snapshot.t, (SNAPSHOT_SHARE - 1) * self.message.len());
        self.make_room(snapshot.t)?;
        let channel = match self.snapshots.channel {
            Some(channel) => channel,
            None => {
                let (name, text) = schema::SNAPSHOT;
                let channel = self.open_channel(schema::SNAPSHOT_TOPIC, name, text)?;
                *self.snapshots.channel.insert(channel)
            }
        };
        self.put(channel, snapshot.next, snapshot.t)
    }

    /// A message at the start that stands alone on its topic.
    fn once(&mut self, topic: &str, (name, text): (&str, &str), message: Vec<u8>) -> io::Result<()> {
        self.message = message;
        self.make_room(Time::ZERO)?;
        let channel = self.open_channel(topic, name, text)?;
        self.put(channel, 0, Time::ZERO)
    }

    fn open_channel(&mut self, topic: &str, name: &str, text: &str) -> io::Result<u16> {
        self.chunk.bytes += 60 + 2 * name.len() + text.len() + topic.len();
        let schema = self.out.add_schema(name, "jsonschema", text.trim_end().as_bytes()).map_err(io_error)?;
        self.out.add_channel(schema, topic, "json", &BTreeMap::new()).map_err(io_error)
    }

    /// Closes the chunk when the message does not belong in it any more.
    fn make_room(&mut self, t: Time) -> io::Result<()> {
        let full = self.chunk.bytes + self.message.len() + MESSAGE_OVERHEAD > CHUNK_BYTES;
        if self.chunk.bytes > 0 && (full || t - self.chunk.start >= CHUNK_TIME) {
            self.close_chunk()?;
        }
        if self.chunk.bytes == 0 {
            self.chunk.start = t;
        }
        Ok(())
    }

    fn put(&mut self, channel_id: u16, n: u64, t: Time) -> io::Result<()> {
        // The number in full is in the message; MCAP has 32 bits for it.
        let sequence = n as u32;
        let log_time = t.0.unsigned_abs();
        let header = mcap::records::MessageHeader { channel_id, sequence, log_time, publish_time: log_time };
        self.chunk.bytes += self.message.len() + MESSAGE_OVERHEAD;
        self.out.write_to_known_channel(&header, &self.message).map_err(io_error)
    }

    fn unwritable(&self, e: &io::Error) -> String {
        format!("the trace `{}` cannot be written: {e}", self.path.display())
    }

    fn close_chunk(&mut self) -> io::Result<()> {
        self.chunk.bytes = 0;
        self.out.flush().map_err(io_error)
    }
}

/// Bytes of a message record besides its data.
const MESSAGE_OVERHEAD: usize = 1 + 8 + 2 + 4 + 8 + 8;

impl TraceSink for Writer {
    fn record(&mut self, record: &Record) -> Result<(), String> {
        self.write(record).map_err(|e| self.unwritable(&e))
    }

    fn wants_snapshot(&mut self, now: Time) -> bool {
        self.snapshots.wait == 0 && now - self.snapshots.last >= SNAPSHOT_TIME
    }

    fn snapshot(&mut self, snapshot: &Snapshot) -> Result<(), String> {
        self.write_snapshot(snapshot).map_err(|e| self.unwritable(&e))
    }
}

/// A file that is hashed as it is written.
struct Hashing {
    file: File,
    hash: Sha256,
    bytes: u64,
}

impl Write for Hashing {
    fn write(&mut self, data: &[u8]) -> io::Result<usize> {
        let n = self.file.write(data)?;
        self.hash.update(&data[..n]);
        self.bytes += n as u64;
        Ok(n)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

fn io_error(e: mcap::McapError) -> io::Error {
    match e {
        mcap::McapError::Io(e) => e,
        mcap::McapError::AttemptedWriteAfterFailure => io::Error::other("an earlier write failed"),
        e => io::Error::other(e.to_string()),
    }
}
