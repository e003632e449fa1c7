//! The message sequence chart.

use super::{sample, well_formed};
use crate::support::folder;
use soifra::{
    plot::{Conversation, SelectError, Selection, Sequence},
    trace_file::{Reader, Trace},
};
use soifra_runtime::{Event, Record, Thread, Time};

/// Events with their times in milliseconds.
fn trace(events: Vec<(i64, Event)>) -> Trace {
    let record = |(n, (ms, event)): (usize, (i64, Event))| Record {
        n: n as u64,
        t: Time(ms * 1_000_000),
        causes: vec![],
        event,
    };
    let records = events.into_iter().enumerate().map(record).collect();
    Trace { header: sample::header(), records, complete: true }
}

fn acl(from: &str, performative: &str, content: Option<&str>, to: &str, conversation: Option<&str>) -> Event {
    Event::Acl {
        robot: 0,
        performative: performative.into(),
        sender: from.into(),
        receiver: to.into(),
        content: content.map(str::to_string),
        registers: vec![],
        reason: None,
        thread: Box::new(Thread { conversation_id: conversation.map(str::to_string), ..Thread::default() }),
    }
}

fn tell(from: &str, performative: &str, content: &str, to: &str) -> Event {
    acl(from, performative, Some(content), to, None)
}

fn delivery(message: u64, to: &str, dropped: Option<&str>) -> Event {
    Event::Delivery {
        robot: 0,
        agent: to.into(),
        topic: String::new(),
        message,
        dropped: dropped.map(str::to_string),
    }
}

fn service(agent: &str, service: &str, running: bool, subgoal: Option<&str>) -> Event {
    let subgoal = subgoal.map(str::to_string);
    Event::Service { robot: 0, agent: agent.into(), service: service.into(), running, subgoal }
}

fn life(agent: &str, status: &str, reason: &str) -> Event {
    Event::Life { robot: 0, agent: agent.into(), status: status.into(), reason: reason.into() }
}

fn param(agent: &str, registers: &[f64]) -> Event {
    Event::Param { agent: agent.into(), param: "speed".into(), registers: registers.to_vec() }
}

/// A contract for a parcel, with everything that can go wrong.
fn parcels() -> Trace {
    let (desk, one, two) = ("desk@r1", "courier@r2", "courier@r3");
    let refusal = Event::Acl {
        robot: 1,
        performative: "refuse".into(),
        sender: one.into(),
        receiver: desk.into(),
        content: None,
        registers: vec![],
        reason: Some("battery; 3 % \"left\" #1".into()),
        thread: Box::new(Thread { conversation_id: Some("desk.2".into()), ..Thread::default() }),
    };
    let over = |agent: &str, id: &str, state: &str| Event::Conversation {
        robot: 0,
        agent: agent.into(),
        conversation_id: id.into(),
        state: state.into(),
        over: true,
    };
    trace(vec![
        (0, life(one, "running", "")),
        (1, tell(one, "request", "Register", "df@r1")),
        (2, acl("df@r1", "agree", None, one, None)),
        (10, acl(desk, "cfp", Some("Parcel"), one, Some("desk.1"))),
        (10, acl(desk, "cfp", Some("Parcel"), two, Some("desk.1"))),
        (10, delivery(4, two, Some("lost on the way"))),
        (12, acl(one, "propose", Some("Offer"), desk, Some("desk.1"))),
        (13, acl(desk, "accept_proposal", Some("Offer"), one, Some("desk.1"))),
        (13, service(one, "drive", true, Some("carry"))),
        (20, tell(one, "inform", "Position", desk)),
        (30, tell(one, "inform", "Position", desk)),
        (40, tell(one, "inform", "Position", desk)),
        (40, delivery(9, desk, Some("the mailbox is full"))),
        (40, delivery(10, one, Some("not sent: it was to somebody else"))),
        (41, param(desk, &[0.25])),
        (41, param(desk, &[1.0, -2.0])),
        (50, tell(one, "inform", "Position", desk)),
        (60, service(one, "drive", false, Some("carry"))),
        (61, acl(one, "inform", Some("Done"), desk, Some("desk.1"))),
        (61, over(desk, "desk.1", "done")),
        (70, acl(desk, "request", Some("Parcel"), one, Some("desk.2"))),
        (71, refusal),
        (71, over(desk, "desk.2", "refused")),
        (80, life(two, "dead", "killed")),
        (90, life(two, "restarted", "")),
        (91, tell(two, "request", "Plan", "planner@r1")),
        (92, tell(two, "inform", "Note", two)),
    ])
}

fn all() -> Selection {
    Selection::default()
}

#[test]
fn messages_are_told_in_the_order_of_their_records() {
    let wanted = r##"---
title: "three discs among two movers: messages"
---
sequenceDiagram
  participant p0 as df@r1
  participant p1 as planner@r1
  participant p2 as courier@r2
  participant p3 as desk@r1
  participant p4 as courier@r3
  participant p5 as parameters
  Note over p2: running (0 ms)
  p2->>p0: request Register (1 ms)
  p0->>p2: agree (2 ms)
  p3->>p2: cfp Parcel (10 ms)
  p3--xp4: cfp Parcel (10 ms, dropped: lost on the way)
  p2->>p3: propose Offer (12 ms)
  p3->>p2: accept_proposal Offer (13 ms)
  Note over p2: ▸ drive for carry (13 ms)
  p2->>p3: inform Position ×3 (20 ms to 40 ms, 1 dropped: the mailbox is full)
  p3->>p5: speed = 0.2500 (41 ms)
  p3->>p5: speed = (1, -2) (41 ms)
  p2->>p3: inform Position (50 ms)
  Note over p2: ▪ drive for carry (60 ms)
  p2->>p3: inform Done (61 ms)
  p3->>p2: request Parcel (70 ms)
  p2->>p3: refuse: battery#59; 3 % #quot;left#quot; #35;1 (71 ms)
  Note over p4: dead: killed (80 ms)
  Note over p4: restarted (90 ms)
  p4->>p1: request Plan (91 ms)
  p4->>p4: inform Note (92 ms)
"##;
    assert_eq!(Sequence::of(&parcels(), &all(), 400).mermaid(), wanted);
}

#[test]
fn a_picture_tells_the_same() {
    let chart = Sequence::of(&parcels(), &all(), 400);
    let drawing = chart.drawing();
    let svg = drawing.to_svg();
    well_formed::check(&svg);
    for text in [
        "three discs among two movers: messages",
        "time (ms)",
        "planner",
        "@r1",
        "parameters",
        "cfp Parcel",
        "cfp Parcel (dropped: lost on the way)",
        "inform Position ×3, until 40 ms (1 dropped: the mailbox is full)",
        "speed = (1, -2)",
        "▸ drive for carry",
        "desk.1 over: done",
        "dead: killed",
        "refuse: battery; 3 % &quot;left&quot; #1",
        "91",
    ] {
        assert!(svg.contains(&format!("aria-label=\"{text}\"")), "{text}");
    }
    // The lost message and the dead agent, two strokes each.
    assert_eq!(svg.matches("#d61220").count(), 2 * 2);
    assert_eq!(svg, Sequence::of(&parcels(), &all(), 400).drawing().to_svg());
    drawing.to_png(drawing.png_width(400)).unwrap();
}

#[test]
fn a_streamed_trace_gives_the_chart_of_the_trace_in_memory() {
    let path = folder("trace_sequence").join("parcels.mcap");
    super::file::write(&path, &parcels().records);
    let chart = Sequence::read(Reader::open(&path).unwrap(), &all(), 400).unwrap();
    assert_eq!(chart.drawing(), Sequence::of(&parcels(), &all(), 400).drawing());
}

/// The messages of a chart, without its participants.
fn arrows(selection: &Selection, limit: usize) -> Vec<String> {
    let text = Sequence::of(&parcels(), selection, limit).mermaid();
    let lines = text.lines().skip(4).filter(|l| !l.trim_start().starts_with("participant"));
    lines.map(|l| l.trim().split(" (").next().unwrap_or_default().to_string()).collect()
}

#[test]
fn agents_conversations_and_times_are_selected() {
    let of = |agents: &[&str]| Selection { agents: agents.iter().map(|a| a.to_string()).collect(), ..all() };
    assert_eq!(arrows(&of(&["df"]), 400), ["p1->>p0: request Register", "p0->>p1: agree"]);
    let both = ["p1--xp2: cfp Parcel", "Note over p2: dead: killed", "Note over p2: restarted"];
    let both: Vec<_> = both.into_iter().chain(["p2->>p0: request Plan", "p2->>p2: inform Note"]).collect();
    assert_eq!(arrows(&of(&["courier@r3"]), 400), both);
    // Without the parameters nothing is between the positions.
    assert_eq!(arrows(&of(&["courier"]), 400).len(), 17);

    let of = |c: Conversation| Selection { conversations: vec![c], ..all() };
    let second = ["p0->>p1: request Parcel", "p1->>p0: refuse: battery#59; 3 % #quot;left#quot; #35;1"];
    assert_eq!(arrows(&of(Conversation::Of("desk.2".into())), 400), second);
    assert_eq!(arrows(&of(Conversation::Of("desk".into())), 400).len(), 0);
    assert_eq!(arrows(&of(Conversation::Beginning("desk".into())), 400).len(), 7);

    let window = Selection { from: Some(Time(2_000_000)), to: Some(Time(10_000_000)), ..all() };
    let wanted = ["p0->>p1: agree", "p2->>p1: cfp Parcel", "p2--xp3: cfp Parcel"];
    assert_eq!(arrows(&window, 400), wanted);
}

#[test]
fn what_is_cut_off_is_told() {
    let selection = Selection { from: Some(Time(20_000_000)), to: Some(Time(60_000_000)), ..all() };
    // The last row folds also when it is the last that is drawn.
    let cut = ["p0->>p1: inform Position ×3", "Note over p0,p1: 4 more rows are not drawn"];
    assert_eq!(arrows(&selection, 1), cut);
    let chart = Sequence::of(&parcels(), &selection, 4);
    assert_eq!(chart.rest().as_deref(), Some("1 more row is not drawn"));
    assert!(chart.drawing().to_svg().contains("aria-label=\"1 more row is not drawn\""));
    // What is cut is folded too.
    let same = || tell("a@r1", "inform", "Tick", "b@r1");
    let many = trace(vec![(0, same()), (1, life("a@r1", "dead", "")), (2, same()), (3, same()), (4, same())]);
    assert_eq!(Sequence::of(&many, &all(), 2).rest().as_deref(), Some("1 more row is not drawn"));
    assert_eq!(Sequence::of(&many, &all(), 3).rest(), None);
}

#[test]
fn names_are_looked_up() {
    let find = |agents: &[&str], conversations: &[&str]| {
        let [agents, conversations] =
            [agents, conversations].map(|n| n.iter().map(|s| s.to_string()).collect());
        let (agents, conversations): (Vec<String>, Vec<String>) = (agents, conversations);
        match Selection::find(parcels().records.into_iter().map(Ok), &agents, &conversations) {
            Ok(selection) => Ok(selection.conversations),
            Err(SelectError::Unknown { what, name, hint }) => Err(format!("{what} {name}: {hint}")),
            Err(SelectError::Trace(e)) => panic!("{e}"),
        }
    };
    assert_eq!(find(&["courier", "desk@r1"], &[]), Ok(vec![]));
    let wanted = vec![Conversation::Beginning("desk".into()), Conversation::Of("desk.1".into())];
    assert_eq!(find(&[], &["desk", "desk.1"]), Ok(wanted));
    assert_eq!(find(&["curier"], &[]), Err("agent curier: did you mean `courier`?".into()));
    assert_eq!(find(&["courier@r4"], &[]), Err("agent courier@r4: did you mean `courier@r2`?".into()));
    let listed = "conversation stock: there are desk.1, desk.2";
    assert_eq!(find(&["df"], &["stock"]), Err(listed.into()));
}

#[test]
fn odd_traces_are_drawn_without_complaint() {
    let strange = "a \"quoted\" text,\nµ and \u{1F916} <&;#> \u{1}";
    let mut traces = vec![trace(vec![]), trace(vec![(0, life(strange, strange, strange))])];
    traces.push(trace(sample::every_kind().into_iter().map(|e| (i64::MIN / 1_000_000, e)).collect()));
    traces.push(trace(sample::every_kind().into_iter().rev().map(|e| (5, e)).collect()));
    traces.push(trace(vec![
        (0, tell("", "", "", "")),
        (9_000_000_000_000, delivery(0, "", Some(strange))),
        (9_000_000_000_000, delivery(0, "", Some(strange))),
        (1, delivery(u64::MAX, "", Some("nobody"))),
        (2, life("x", "dead", "")),
        (1, life("x", "dead", "")),
        (1, life("x", "restarted", "")),
        (1, life("x", "restarted", &"long ".repeat(1000))),
        (1, param("parameters", &[])),
        (1, param("@", &[f64::NAN; 900])),
    ]));
    for mut t in traces {
        t.complete = false;
        for limit in [0, 1, 400] {
            let chart = Sequence::of(&t, &all(), limit);
            let svg = chart.drawing().to_svg();
            well_formed::check(&svg);
            assert!(!svg.contains("NaN") && !svg.contains("inf\""), "{svg}");
            let text = chart.mermaid();
            assert!(text.lines().all(|l| !l.contains(['"', '<']) || l.starts_with("title: ")), "{text}");
        }
    }
}

#[test]
fn a_cut_off_trace_says_so() {
    let mut trace = parcels();
    trace.records.truncate(13);
    trace.complete = false;
    assert!(Sequence::of(&trace, &all(), 400).drawing().to_svg().contains("the trace is cut off at 0.04 s"));
}

#[test]
fn a_chart_of_many_rows_fits_into_a_picture() {
    let told = |i: i64| (i, tell(&format!("a{}@r1", i % 40), "inform", &format!("Part{i}"), "hub@r2"));
    let chart = Sequence::of(&trace((0..1000).map(told).collect()), &all(), 400);
    assert_eq!(chart.rest().as_deref(), Some("600 more rows are not drawn"));
    let drawing = chart.drawing();
    let width = drawing.png_width(1600);
    assert!(width > 1600, "{width} pixels for {} points", drawing.width);
    drawing.to_png(width).unwrap();
}
