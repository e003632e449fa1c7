//! Traces as files: MCAP, streamed, readable after a crash, with the same bytes for the same run.
//!
//! | topic | schema | carries |
//! |---|---|---|
//! | `/soifra/header` | `soifra.Header` | graph, parameters, scene, versions: the first message |
//! | `/scene` | `foxglove.SceneUpdate` | what viewers draw; derived from the header |
//! | `/tf` | `foxglove.FrameTransform` | records of poses: number, causes and robot are further members |
//! | `/soifra/snapshot` | `soifra.Snapshot` | all that a run remembers after an instant: where a replay may begin |
//! | `/soifra/<kind>` | `soifra.<Kind>` | all other records, as JSON |
//!
//! Log times are virtual times. Nothing in the file comes from a clock or a machine.

mod error;
mod header;
pub mod palette;
mod reader;
mod scan;
mod scene_update;
mod schema;
pub mod shape;
mod transform;
mod writer;

pub use error::TraceError;
pub use header::{Header, Robot};
pub use reader::{Reader, Trace, read};
pub use writer::{CHUNK_BYTES, CHUNK_TIME, Finished, SNAPSHOT_TIME, Writer};

use sha2::{Digest, Sha256};
use std::{fs::File, io, io::Read, path::Path};

/// Version of the form of a trace; a reader refuses others.
pub const SCHEMA: u32 = 1;

/// SHA-256 of a file, in hexadecimal.
pub fn digest(path: impl AsRef<Path>) -> io::Result<String> {
    let (mut file, mut hash, mut buffer) = (File::open(path)?, Sha256::new(), vec![0; 1 << 16]);
    loop {
        match file.read(&mut buffer)? {
            0 => return Ok(hex(&hash.finalize())),
            n => hash.update(&buffer[..n]),
        }
    }
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|b| format!("{b:02x}")).collect()
}
