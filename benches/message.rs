//! The cost of a message of a conversation, from what sends it to the unit that has handled it: against a
//! message through a bounded channel, and with a trace against writing as many bytes with the bare mcap crate.
//!
//! Two agents on two hosts answer each other without end, so that each message has an instant of its own and
//! bears all that an instant costs; the agents themselves count what they have handled. `rally`: all messages
//! belong to one conversation. `query`: every two messages are a conversation that is opened and ends.

mod support;

use mcap::{MessageStream, WriteOptions, records::MessageHeader, write::NoSeek};
use soifra::execute::Prepared;
use soifra_runtime::RunReport;
use std::{
    collections::BTreeMap,
    io,
    sync::{Arc, mpsc::sync_channel},
};
use support::{Compiled, seconds};

/// What the first agent waits for; it hears every other message.
const HEARD: u32 = 100_000;

/// The same where a trace is written.
const HEARD_TRACED: u32 = 10_000;

/// Missions in which two agents talk, and what the verdict calls them.
const EXCHANGES: [(&str, &str); 2] = [("rally", "of one conversation"), ("query", "conversations of two")];

/// Where traces go: what a disk does is not the question.
const NOWHERE: &str = "/dev/null";

/// As many messages wait in the channel as in the mailbox of a conversation.
const CAPACITY: usize = 64;

/// What goes through the channel: what a message of the engine says, `Event::Acl` with its thread, in a box.
///
/// What differs from one message to the next is made for each: the record's registers and the mark that an
/// answer refers to. What an answer refers to was the mark of the message that it answers and is moved. What
/// stays the same is shared and counted, as who wants his channel to be fast would have it.
#[expect(dead_code, reason = "a receiver has them; this one does not ask for all")]
struct Message {
    performative: &'static str,
    sender: Arc<str>,
    receiver: Arc<str>,
    content: Arc<str>,
    protocol: Arc<str>,
    ontology: Arc<str>,
    conversation_id: Arc<str>,
    reply_with: String,
    in_reply_to: Option<String>,
    reply_by: Option<i64>,
    registers: Vec<f64>,
}

/// Seconds for a message through the channel, sent and received on one thread: no thread is ever woken.
fn channel() -> f64 {
    let (sender, receiver) = sync_channel::<Box<Message>>(CAPACITY);
    let agents: [Arc<str>; 2] = ["starter@here", "partner@there"].map(Arc::from);
    let (content, protocol, ontology): (Arc<str>, Arc<str>, Arc<str>) =
        ("Ball".into(), "rally".into(), "rally".into());
    let conversation: Arc<str> = "play/starter@here/1".into();
    let (mut answered, mut number) = (None, 0.0);
    let said = 2 * HEARD;
    seconds(|| {
        for i in 0..said as usize {
            let (side, mark) = (i % 2, if i % 2 == 0 { "i" } else { "p" });
            let message = Message {
                performative: "inform",
                sender: agents[side].clone(),
                receiver: agents[1 - side].clone(),
                content: content.clone(),
                protocol: protocol.clone(),
                ontology: ontology.clone(),
                conversation_id: conversation.clone(),
                reply_with: format!("0/{mark}{i}"),
                in_reply_to: answered.take(),
                reply_by: Some(i as i64),
                registers: vec![number, 0.0, 0.0, 0.0, 1.0],
            };
            sender.send(Box::new(message)).expect("the other end is here");
            let heard = std::hint::black_box(receiver.recv().expect("a message"));
            number = heard.registers[0] + 1.0;
            answered = Some(heard.reply_with);
        }
        assert_eq!(number, f64::from(said));
    }) / f64::from(said)
}

/// An exchange, set up for so many messages.
struct Exchange {
    compiled: Compiled,
    most: u32,
}

impl Exchange {
    fn new(name: &str, most: u32) -> Exchange {
        let text = support::read(&format!("benches/{name}.soi.in"));
        let path = support::scratch(&format!("{name}.soi"), &text);
        Exchange { compiled: Compiled::new(&path, &[("messages", most.to_string())]), most }
    }

    /// Seconds for a message of a run that took so many.
    fn judged(&self, (report, seconds): (RunReport, f64)) -> f64 {
        assert_eq!(report.outcome.name(), "success", "{}", report.reason);
        let heard = report.metrics["heard"].expect("both agents count");
        assert!(heard >= f64::from(2 * self.most), "{heard} messages");
        seconds / heard
    }
}

/// A trace's messages, to be written once more by nothing but the mcap crate.
struct Copy {
    bytes: Vec<u8>,
    /// Topics, with the schemas' names and texts.
    channels: Vec<(String, String, Vec<u8>)>,
    headers: Vec<(MessageHeader, std::ops::Range<usize>)>,
}

impl Copy {
    /// Runs once and keeps what is in the trace.
    fn of(prepared: &Prepared<'_>, name: &str) -> Copy {
        support::run_traced(prepared, name);
        let path = support::scratch_path(name);
        let file = std::fs::read(&path).unwrap_or_else(|e| panic!("{path}: {e}"));
        let (mut bytes, mut headers, mut channels) = (Vec::new(), Vec::new(), Vec::new());
        let mut known = BTreeMap::new();
        for message in MessageStream::new(&file).expect("a trace") {
            let m = message.expect("a message");
            let next = known.len() as u16;
            let channel_id = *known.entry(m.channel.topic.clone()).or_insert_with(|| {
                let schema = m.channel.schema.as_ref().expect("every channel of a trace has a schema");
                channels.push((m.channel.topic.clone(), schema.name.clone(), schema.data.to_vec()));
                next
            });
            let from = bytes.len();
            bytes.extend_from_slice(&m.data);
            let (sequence, log_time, publish_time) = (m.sequence, m.log_time, m.publish_time);
            let header = MessageHeader { channel_id, sequence, log_time, publish_time };
            headers.push((header, from..bytes.len()));
        }
        Copy { bytes, channels, headers }
    }

    /// Seconds that writing takes, compressed and in chunks as large as those of a trace.
    fn write(&self) -> f64 {
        seconds(|| {
            let out = WriteOptions::new()
                .compression(Some(mcap::Compression::Lz4))
                .chunk_size(Some(soifra::trace_file::CHUNK_BYTES as u64))
                .disable_seeking(true)
                .create(NoSeek::new(io::sink()));
            let mut out = out.expect("a writer");
            let ids: Vec<u16> = self
                .channels
                .iter()
                .map(|(topic, name, text)| {
                    let schema = out.add_schema(name, "jsonschema", text).expect("a schema");
                    out.add_channel(schema, topic, "json", &BTreeMap::new()).expect("a channel")
                })
                .collect();
            for (header, range) in &self.headers {
                let header = MessageHeader { channel_id: ids[header.channel_id as usize], ..*header };
                out.write_to_known_channel(&header, &self.bytes[range.clone()]).expect("written");
            }
            out.finish().expect("finished");
        })
    }
}

fn main() {
    let mut criterion = support::criterion();
    for (name, what) in EXCHANGES {
        let plain = Exchange::new(name, HEARD);
        let traced = Exchange::new(name, HEARD_TRACED);
        let (prepared, prepared_traced) = (plain.compiled.prepared(), traced.compiled.prepared());
        let ours = || plain.judged(support::run(&prepared));
        let ours_traced = || traced.judged(support::run_traced(&prepared_traced, NOWHERE));
        let copy = Copy::of(&prepared_traced, &format!("{name}.mcap"));
        let bare = || copy.write() / f64::from(2 * HEARD_TRACED);

        let mut group = criterion.benchmark_group(format!("message, {what}, a message"));
        support::add(&mut group, "soifra", ours);
        support::add(&mut group, "soifra with trace", ours_traced);
        support::add(&mut group, "sync_channel", channel);
        support::add(&mut group, "mcap alone", bare);
        group.finish();
        if !support::trying() {
            let words = format!("time for a message, {what}, to that through a channel");
            support::verdict(
                &format!("message_{name}"),
                &words,
                support::ratio(25, ours, channel),
                Some(5.0),
            );
            let records = copy.headers.len() as f64 / f64::from(2 * HEARD_TRACED);
            let words = format!(
                "time for a message, {what}, trace on ({records:.1} records of it), to that without and to write \
                 its bytes alone"
            );
            let ratio = support::ratio(25, ours_traced, || ours() + bare());
            support::verdict(&format!("message_{name}_traced"), &words, ratio, Some(3.0));
        }
    }
    criterion.final_summary();
}
