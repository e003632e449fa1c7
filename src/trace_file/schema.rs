//! Channels of a trace: what each carries, and the JSON schema that says so to other programs.
//!
//! Records of a kind travel on `/soifra/<kind>` with the schema `soifra.<Kind>`; poses and the scene
//! travel as Foxglove messages, so that viewers draw them.

use soifra_runtime::Event;
use std::fmt::Write;

/// Topic of the header, the first message of a trace.
pub(crate) const HEADER_TOPIC: &str = "/soifra/header";
/// Topic of the poses of robots and movers; the messages are records with more members than the schema asks.
pub(crate) const TF_TOPIC: &str = "/tf";
/// Topic of the scene, drawn once.
pub(crate) const SCENE_TOPIC: &str = "/scene";
/// Topic of the snapshots.
pub(crate) const SNAPSHOT_TOPIC: &str = "/soifra/snapshot";
/// What topics of records begin with.
pub(crate) const RECORD_PREFIX: &str = "/soifra/";

/// Schema of [`TF_TOPIC`].
pub(crate) const FRAME_TRANSFORM: (&str, &str) =
    ("foxglove.FrameTransform", include_str!("schemas/foxglove.FrameTransform.json"));
/// Schema of [`SCENE_TOPIC`].
pub(crate) const SCENE_UPDATE: (&str, &str) =
    ("foxglove.SceneUpdate", include_str!("schemas/foxglove.SceneUpdate.json"));
/// Schema of [`HEADER_TOPIC`].
pub(crate) const HEADER: (&str, &str) = (
    "soifra.Header",
    r#"{"title":"soifra.Header","type":"object","description":"What the run was a function of: graph, parameters, seed (in the scene), versions","properties":{"schema":{"type":"integer"},"mission":{"type":"string"},"title":{"type":"string"},"versions":{"type":"object"},"params":{"type":"object"},"scene":{"type":"object"},"graph":{"type":"object"}},"required":["schema","mission","title","versions","params","scene","graph"]}"#,
);

/// Schema of [`SNAPSHOT_TOPIC`].
pub(crate) const SNAPSHOT: (&str, &str) = (
    "soifra.Snapshot",
    r#"{"title":"soifra.Snapshot","type":"object","description":"All that a run remembers after an instant: t in nanoseconds, and next, the number of the next record; the rest is for replays by the same version","properties":{"t":{"type":"integer"},"next":{"type":"integer"}},"required":["t","next"]}"#,
);

/// A member of an event: its name, and its type in the little language of [`member_schema`].
type Member = (&'static str, &'static str);

/// Kinds of events as they are called in topics, and their members.
pub(crate) const KINDS: &[(&str, &[Member])] = &[
    ("reading", &[("robot", "index"), ("sensor", "index"), ("captured", "time"), ("registers", "numbers")]),
    (
        "activation",
        &[
            ("robot", "index"),
            ("agent", "text"),
            ("unit", "text"),
            ("release", "time"),
            ("start", "time"),
            ("finish", "time?"),
            ("skipped", "text?"),
        ],
    ),
    (
        "rule",
        &[("robot", "index"), ("agent", "text"), ("unit", "text"), ("rule", "index"), ("guard", "text")],
    ),
    (
        "transition",
        &[("robot", "index"), ("agent", "text"), ("unit", "text"), ("from", "text"), ("to", "text")],
    ),
    (
        "node",
        &[
            ("robot", "index"),
            ("agent", "text"),
            ("unit", "text"),
            ("node", "index"),
            ("label", "text"),
            ("result", "text"),
        ],
    ),
    ("state", &[("robot", "index"), ("agent", "text"), ("state", "text"), ("registers", "numbers")]),
    ("message", &[("robot", "index"), ("agent", "text"), ("topic", "text"), ("registers", "numbers")]),
    (
        "delivery",
        &[
            ("robot", "index"),
            ("agent", "text"),
            ("topic", "text"),
            ("message", "index"),
            ("dropped", "text?"),
        ],
    ),
    (
        "arbitration",
        &[("robot", "index"), ("actuator", "text"), ("winner", "text or null"), ("losers", "pairs")],
    ),
    ("command", &[("robot", "index"), ("actuator", "index"), ("registers", "numbers"), ("expires", "time")]),
    ("safe_action", &[("robot", "index"), ("action", "text"), ("reason", "text")]),
    ("param", &[("agent", "text"), ("param", "text"), ("registers", "numbers")]),
    ("note", &[("robot", "index"), ("agent", "text"), ("text", "text")]),
    ("pose", &[("robot", "index"), ("pose", "numbers"), ("path_m", "number")]),
    ("mover", &[("name", "text"), ("pose", "numbers")]),
    ("contact", &[("robot", "index"), ("other", "index?"), ("with", "text"), ("begin", "bool")]),
    ("goal", &[("goal", "text"), ("robot", "index?"), ("status", "text"), ("reason", "text?")]),
    ("expectation", &[("index", "index"), ("robot", "index?"), ("held", "bool"), ("margin", "number?")]),
    ("fault", &[("robot", "index?"), ("agent", "text"), ("text", "text")]),
    ("end", &[("outcome", "text"), ("reason", "text")]),
    ("deferral", &[("robot", "index"), ("agent", "text"), ("unit", "text"), ("until", "time")]),
    ("switch", &[("robot", "index"), ("core", "index"), ("agent", "text?"), ("unit", "text?")]),
    (
        "completion",
        &[
            ("robot", "index"),
            ("agent", "text"),
            ("unit", "text"),
            ("release", "time"),
            ("start", "time"),
            ("rounds", "index?"),
        ],
    ),
    (
        "miss",
        &[("robot", "index"), ("agent", "text"), ("unit", "text"), ("release", "time"), ("deadline", "time")],
    ),
    (
        "acl",
        &[
            ("robot", "index"),
            ("performative", "text"),
            ("sender", "text"),
            ("receiver", "text"),
            ("content", "text?"),
            ("registers", "numbers?"),
            ("reason", "text?"),
            ("thread", "thread?"),
        ],
    ),
    (
        "conversation",
        &[
            ("robot", "index"),
            ("agent", "text"),
            ("conversation_id", "text"),
            ("state", "text"),
            ("over", "bool"),
        ],
    ),
    (
        "service",
        &[
            ("robot", "index"),
            ("agent", "text"),
            ("service", "text"),
            ("running", "bool"),
            ("subgoal", "text?"),
        ],
    ),
    ("life", &[("robot", "index"), ("agent", "text"), ("status", "text"), ("reason", "text")]),
    (
        "device",
        &[("robot", "index"), ("agent", "text"), ("device", "text"), ("unit", "text?"), ("waiting", "index")],
    ),
    ("trouble", &[("target", "text"), ("text", "text")]),
    (
        "input",
        &[
            ("text", "text"),
            ("operation", "text"),
            ("agent", "text?"),
            ("param", "text?"),
            ("registers", "numbers?"),
        ],
    ),
    (
        "image",
        &[
            ("robot", "index"),
            ("sensor", "index"),
            ("captured", "time"),
            ("width", "index"),
            ("height", "index"),
            ("digest", "text"),
            ("view", "numbers"),
        ],
    ),
];

/// Place of an event's kind in [`KINDS`].
pub(crate) fn kind(event: &Event) -> usize {
    match event {
        Event::Reading { .. } => 0,
        Event::Activation { .. } => 1,
        Event::Rule { .. } => 2,
        Event::Transition { .. } => 3,
        Event::Node { .. } => 4,
        Event::State { .. } => 5,
        Event::Message { .. } => 6,
        Event::Delivery { .. } => 7,
        Event::Arbitration { .. } => 8,
        Event::Command { .. } => 9,
        Event::SafeAction { .. } => 10,
        Event::Param { .. } => 11,
        Event::Note { .. } => 12,
        Event::Pose { .. } => 13,
        Event::Mover { .. } => 14,
        Event::Contact { .. } => 15,
        Event::Goal { .. } => 16,
        Event::Expectation { .. } => 17,
        Event::Fault { .. } => 18,
        Event::End { .. } => 19,
        Event::Deferral { .. } => 20,
        Event::Switch { .. } => 21,
        Event::Completion { .. } => 22,
        Event::Miss { .. } => 23,
        Event::Acl { .. } => 24,
        Event::Conversation { .. } => 25,
        Event::Service { .. } => 26,
        Event::Life { .. } => 27,
        Event::Device { .. } => 28,
        Event::Trouble { .. } => 29,
        Event::Input { .. } => 30,
        Event::Image { .. } => 31,
    }
}

/// Name of the schema of a kind: `safe_action` has `soifra.SafeAction`.
pub(crate) fn schema_name(kind: &str) -> String {
    let mut name = String::from("soifra.");
    for word in kind.split('_') {
        let (first, rest) = word.split_at(word.len().min(1));
        name.push_str(&first.to_ascii_uppercase());
        name.push_str(rest);
    }
    name
}

/// JSON schema of a record of a kind.
pub(crate) fn schema_text(kind: &str, members: &[Member]) -> String {
    let mut s = format!(
        r#"{{"title":"{}","type":"object","properties":{{"n":{},"t":{},"causes":{{"type":"array","items":{{"type":"integer"}}}},"event":{{"type":"object","properties":{{"kind":{{"const":"{kind}"}}"#,
        schema_name(kind),
        member_schema("index"),
        member_schema("time"),
    );
    for (name, ty) in members {
        // Writing to a String cannot fail.
        let _ = write!(s, r#","{name}":{}"#, member_schema(ty.trim_end_matches('?')));
    }
    s.push_str(r#"},"required":["kind""#);
    for (name, _) in members.iter().filter(|(_, ty)| !ty.ends_with('?')) {
        let _ = write!(s, r#","{name}""#);
    }
    s.push_str(r#"]}},"required":["n","t","event"]}"#);
    s
}

fn member_schema(ty: &str) -> &'static str {
    match ty {
        "index" => r#"{"type":"integer","minimum":0}"#,
        "time" => r#"{"type":"integer","description":"nanoseconds of virtual time"}"#,
        "text" => r#"{"type":"string"}"#,
        "text or null" => r#"{"type":["string","null"]}"#,
        "bool" => r#"{"type":"boolean"}"#,
        "number" => r#"{"type":["number","string"]}"#,
        "numbers" => r#"{"type":"array","items":{"type":["number","string"]}}"#,
        "thread" => {
            r#"{"type":"object","properties":{"conversation_id":{"type":"string"},"protocol":{"type":"string"},"ontology":{"type":"string"},"reply_with":{"type":"string"},"in_reply_to":{"type":"string"},"reply_by":{"type":"integer","description":"nanoseconds of virtual time"}}}"#
        }
        "pairs" => r#"{"type":"array","items":{"type":"array","items":{"type":"string"}}}"#,
        _ => "{}",
    }
}
