//! Writing and reading.

use super::sample::{self, Log};
use crate::support::folder;
use soifra::trace_file::{self, CHUNK_BYTES, Reader, Trace, TraceError, Writer};
use soifra_runtime::{Event, Record, Time, TraceSink};
use std::{fs, path::Path};

pub fn write(path: &Path, records: &[Record]) -> trace_file::Finished {
    let mut writer = Writer::create(path, &sample::header()).unwrap();
    for r in records {
        writer.record(r).unwrap();
    }
    writer.finish().unwrap()
}

/// Records as their JSON, where NaN equals itself.
fn texts(records: &[Record]) -> Vec<String> {
    records.iter().map(|r| serde_json::to_string(r).unwrap()).collect()
}

#[test]
fn every_kind_of_record_comes_back() {
    let dir = folder("trace_every_kind_of_record_comes_back");
    let path = dir.join("t.mcap");
    let mut log = Log { records: Vec::new(), now: Time::ZERO };
    for (i, event) in sample::every_kind().into_iter().enumerate() {
        log.now = Time(i as i64 * 300_000_001);
        log.push(&[0, i as u64 / 2][..i.min(2)], event);
    }
    write(&path, &log.records);
    let trace = trace_file::read(&path).unwrap();
    assert_eq!(trace.header, sample::header());
    assert_eq!(texts(&trace.records), texts(&log.records));
    assert!(trace.complete);
    // -0.0 and the last bit of 0.1 + 0.2 are not in the text comparison's power alone.
    let Event::Reading { registers, .. } = &trace.records[0].event else { panic!("the first is a reading") };
    assert_eq!(registers[0].to_bits(), (0.1f64 + 0.2).to_bits());
    assert_eq!(registers[1].to_bits(), (-0.0f64).to_bits());
    assert!(registers[4].is_nan() && registers[5] == f64::INFINITY && registers[6] == f64::NEG_INFINITY);
}

#[test]
fn the_same_run_gives_the_same_bytes_and_the_digest_of_the_file() {
    let dir = folder("trace_the_same_run_gives_the_same_bytes_and_the_digest_of_the_file");
    let (a, b) = (dir.join("a.mcap"), dir.join("b.mcap"));
    let records = sample::run(10, 20);
    let finished = write(&a, &records);
    write(&b, &records);
    let bytes = fs::read(&a).unwrap();
    assert_eq!(bytes, fs::read(&b).unwrap());
    assert_eq!(finished.bytes, bytes.len() as u64);
    assert_eq!(finished.digest, trace_file::digest(&a).unwrap());
    assert_eq!(finished.digest.len(), 64);
    assert_eq!(trace_file::read(&a).unwrap(), Trace { header: sample::header(), records, complete: true });
}

#[test]
fn chunks_end_by_size_and_by_time() {
    let dir = folder("trace_chunks_end_by_size_and_by_time");
    let path = dir.join("t.mcap");
    let mut records = sample::run(5, 30);
    for _ in 0..1000 {
        let event = Event::Note { robot: 0, agent: "a@r1".into(), text: "x".repeat(5000) };
        records.push(Record { n: records.len() as u64, t: Time(31_000_000_000), causes: vec![], event });
    }
    write(&path, &records);
    let bytes = fs::read(&path).unwrap();
    let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
    let chunks = &summary.chunk_indexes;
    assert!(chunks.len() > 30 + 4);
    for c in chunks {
        assert!(c.uncompressed_size <= CHUNK_BYTES as u64, "{} bytes", c.uncompressed_size);
        assert!(c.message_end_time - c.message_start_time < 1_000_000_000);
    }
    assert_eq!(summary.stats.unwrap().message_count, records.len() as u64 + 2);
    assert_eq!(trace_file::read(&path).unwrap().records, records);
}

#[test]
fn a_file_cut_anywhere_gives_all_whole_chunks() {
    let dir = folder("trace_a_file_cut_anywhere_gives_all_whole_chunks");
    let path = dir.join("t.mcap");
    let records = sample::run(5, 6);
    write(&path, &records);
    let bytes = fs::read(&path).unwrap();
    let chunk_ends: Vec<(u64, u64)> = {
        let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
        let mut chunks = summary.chunk_indexes;
        chunks.sort_by_key(|c| c.chunk_start_offset);
        let mut messages = 0;
        let mut ends = Vec::new();
        for c in &chunks {
            let content = &bytes[c.chunk_start_offset as usize..][..c.chunk_length as usize];
            let mcap::records::Record::Chunk { header, data } = mcap::parse_record(6, &content[9..]).unwrap()
            else {
                panic!("not a chunk")
            };
            let reader = mcap::read::ChunkReader::new(header, &data).unwrap();
            messages +=
                reader.filter(|r| matches!(r, Ok(mcap::records::Record::Message { .. }))).count() as u64;
            ends.push((c.chunk_start_offset + c.chunk_length, messages - 2));
        }
        ends
    };
    let around = chunk_ends.iter().flat_map(|(end, _)| *end as usize - 2..=*end as usize + 2);
    let mut last = 0;
    for cut in (0..bytes.len()).step_by(97).chain(around) {
        let whole = chunk_ends.iter().filter(|(end, _)| *end <= cut as u64).map(|(_, n)| *n).next_back();
        match Reader::new(&bytes[..cut]).and_then(Reader::into_trace) {
            Ok(trace) => {
                assert_eq!(Some(trace.records.len() as u64), whole, "cut at {cut}");
                assert_eq!(trace.records[..], records[..trace.records.len()]);
                assert!(!trace.complete);
                last = last.max(trace.records.len());
            }
            Err(TraceError::Empty) => assert_eq!(cut, 0),
            Err(TraceError::NoHeader) => assert!(whole.is_none(), "cut at {cut}"),
            Err(e) => panic!("cut at {cut}: {e}"),
        }
    }
    assert_eq!(last, records.len());
}

#[test]
fn every_damaged_byte_is_noticed_or_harmless() {
    let dir = folder("trace_every_damaged_byte_is_noticed_or_harmless");
    let path = dir.join("t.mcap");
    let records = sample::run(3, 3);
    write(&path, &records);
    let bytes = fs::read(&path).unwrap();
    for i in (0..bytes.len()).step_by(37) {
        let mut damaged = bytes.clone();
        damaged[i] ^= 1 << (i % 8);
        if let Ok(trace) = Reader::new(&damaged[..]).and_then(Reader::into_trace) {
            // What is believed is a beginning of what was written.
            assert_eq!(trace.records[..], records[..trace.records.len()], "bit in byte {i}");
            assert_eq!(trace.header, sample::header());
        }
    }
}

#[test]
fn bad_files_are_told_apart_in_sentences() {
    let dir = folder("trace_bad_files_are_told_apart_in_sentences");
    let path = dir.join("t.mcap");
    let of = |bytes: &[u8]| Reader::new(bytes).and_then(Reader::into_trace).unwrap_err().to_string();
    assert!(of(b"").contains("empty"));
    assert!(of(b"mission m {}").contains("does not begin like an MCAP file"));
    assert!(of(mcap::MAGIC).contains("before its header"));

    let mut other = mcap::WriteOptions::new().create(std::io::Cursor::new(Vec::new())).unwrap();
    let channel = other.add_channel(0, "/chat", "json", &Default::default()).unwrap();
    let head =
        mcap::records::MessageHeader { channel_id: channel, sequence: 0, log_time: 0, publish_time: 0 };
    other.write_to_known_channel(&head, b"{}").unwrap();
    other.finish().unwrap();
    assert!(of(&other.into_inner().into_inner()).contains("not a trace of soifra"));

    let mut newer = mcap::WriteOptions::new().create(std::io::Cursor::new(Vec::new())).unwrap();
    let channel = newer.add_channel(0, "/soifra/header", "json", &Default::default()).unwrap();
    let head =
        mcap::records::MessageHeader { channel_id: channel, sequence: 0, log_time: 0, publish_time: 0 };
    newer.write_to_known_channel(&head, br#"{"schema":2,"moon":true}"#).unwrap();
    newer.finish().unwrap();
    let newer = of(&newer.into_inner().into_inner());
    assert!(newer.contains("schema version 2") && newer.contains("reads version 1"), "{newer}");

    assert!(trace_file::read(&dir).unwrap_err().to_string().contains("directory"));
    assert!(matches!(trace_file::read(dir.join("absent.mcap")), Err(TraceError::Io(_))));

    // A record left out.
    let records = sample::run(5, 4);
    let mut writer = Writer::create(&path, &sample::header()).unwrap();
    for r in records.iter().filter(|r| r.n != 17) {
        writer.write(r).unwrap();
    }
    writer.finish().unwrap();
    let gap = trace_file::read(&path).unwrap_err().to_string();
    assert!(gap.contains("record 18 stands where record 17 belongs"), "{gap}");
}

#[test]
fn a_trace_that_another_tool_wrote_again_is_the_same_trace() {
    let dir = folder("trace_a_trace_that_another_tool_wrote_again_is_the_same_trace");
    let path = dir.join("t.mcap");
    let records = sample::run(10, 5);
    write(&path, &records);
    let bytes = fs::read(&path).unwrap();
    // Without chunks, and with large uncompressed ones.
    for use_chunks in [false, true] {
        let options = mcap::WriteOptions::new().use_chunks(use_chunks).compression(None);
        let mut again = options.create(std::io::Cursor::new(Vec::new())).unwrap();
        for message in mcap::MessageStream::new(&bytes).unwrap() {
            again.write(&message.unwrap()).unwrap();
        }
        again.finish().unwrap();
        let trace = Reader::new(&again.into_inner().into_inner()[..]).and_then(Reader::into_trace).unwrap();
        assert_eq!(trace, Trace { header: sample::header(), records: records.clone(), complete: true });
    }
}

#[test]
fn what_was_written_before_a_kill_can_be_read() {
    let dir = folder("trace_what_was_written_before_a_kill_can_be_read");
    let path = dir.join("t.mcap");
    let records = sample::run(10, 20);
    let mut writer = Writer::create(&path, &sample::header()).unwrap();
    for r in &records {
        writer.write(r).unwrap();
    }
    // What another process sees of the file while the writer still has its last chunk.
    let seen = trace_file::read(&path).unwrap();
    assert!(!seen.complete);
    assert!(seen.last_time() >= records[records.len() - 1].t - trace_file::CHUNK_TIME - Time(100_000_000));
    assert_eq!(seen.records[..], records[..seen.records.len()]);
    // Dropped without an end: the rest is there too.
    drop(writer);
    assert_eq!(trace_file::read(&path).unwrap().records, records);
}

#[test]
fn paths_that_cannot_be_written_are_errors() {
    let dir = folder("trace_paths_that_cannot_be_written_are_errors");
    let header = sample::header();
    assert!(Writer::create(&dir, &header).is_err());
    assert!(Writer::create(dir.join("no/such/folder/t.mcap"), &header).is_err());
    assert!(
        Writer::create(dir.join("t.mcap"), &trace_file::Header { graph_json: "{".into(), ..header.clone() })
            .is_err()
    );
    #[cfg(target_os = "linux")]
    {
        let full = Writer::create("/dev/full", &header).map(|_| ()).unwrap_err();
        assert_eq!(full.kind(), std::io::ErrorKind::StorageFull);
    }
}

#[test]
fn a_disk_that_fills_up_is_an_error_and_stays_one() {
    let dir = folder("trace_a_disk_that_fills_up_is_an_error_and_stays_one");
    let path = dir.join("t.mcap");
    // A pipe that nobody reads any more stands for the disk: writes begin to fail after some time.
    let made = std::process::Command::new("mkfifo").arg(&path).status();
    if !made.is_ok_and(|s| s.success()) {
        return;
    }
    let (reader_path, (go, wait)) = (path.clone(), std::sync::mpsc::channel::<()>());
    let reader = std::thread::spawn(move || {
        let file = fs::File::open(reader_path).unwrap();
        let _ = wait.recv();
        drop(file);
    });
    let mut writer = Writer::create(&path, &sample::header()).unwrap();
    go.send(()).unwrap();
    reader.join().unwrap();
    let errors: Vec<String> = sample::run(10, 20).iter().filter_map(|r| writer.record(r).err()).collect();
    assert!(errors[0].contains("cannot be written"), "{}", errors[0]);
    assert!(errors.len() > 100);
    assert!(writer.finish().is_err());
}
