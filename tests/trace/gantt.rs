//! The schedule.

use super::{sample, well_formed};
use crate::support::folder;
use soifra::{
    plot::{Gantt, Selection},
    trace_file::{Reader, Trace},
};
use soifra_runtime::{Event, Record, Time};

const AGENT: &str = "pilot@r1";

/// Events with their times in microseconds.
fn trace(events: Vec<(i64, Event)>) -> Trace {
    let record = |(n, (us, event)): (usize, (i64, Event))| Record {
        n: n as u64,
        t: Time(us * 1000),
        causes: vec![],
        event,
    };
    let records = events.into_iter().enumerate().map(record).collect();
    Trace { header: sample::header(), records, complete: true }
}

fn switch(core: u32, unit: Option<&str>) -> Event {
    Event::Switch { robot: 0, core, agent: unit.map(|_| AGENT.into()), unit: unit.map(str::to_string) }
}

fn activation(unit: &str, release: i64, start: i64, finish: Option<i64>, skipped: bool) -> Event {
    Event::Activation {
        robot: 0,
        agent: AGENT.into(),
        unit: unit.into(),
        release: Time(release * 1000),
        start: Time(start * 1000),
        finish: finish.map(|f| Time(f * 1000)),
        skipped: skipped.then(|| "busy".into()),
    }
}

fn completion(unit: &str, release: i64) -> Event {
    Event::Completion {
        robot: 0,
        agent: AGENT.into(),
        unit: unit.into(),
        release: Time(release * 1000),
        start: Time(release * 1000),
        rounds: None,
    }
}

fn device(unit: Option<&str>, waiting: u32) -> Event {
    let unit = unit.map(str::to_string);
    Event::Device { robot: 0, agent: "other@r1".into(), device: "camera".into(), unit, waiting }
}

/// Two units on a core, one of which interrupts the other and makes it late; one beside it; a device.
fn schedule() -> Trace {
    trace(vec![
        (0, switch(0, Some("slow"))),
        (0, activation("slow", 0, 0, None, false)),
        (10, activation("beside", 10, 10, Some(40), false)),
        (20, switch(0, Some("fast"))),
        (20, activation("fast", 20, 20, None, false)),
        (25, device(Some("look"), 0)),
        (30, completion("fast", 20)),
        (30, switch(0, Some("slow"))),
        (35, device(Some("look"), 2)),
        (
            50,
            Event::Miss {
                robot: 0,
                agent: AGENT.into(),
                unit: "slow".into(),
                release: Time(0),
                deadline: Time(50_000),
            },
        ),
        (55, Event::Deferral { robot: 0, agent: AGENT.into(), unit: "fast".into(), until: Time(80_000) }),
        (60, completion("slow", 0)),
        (60, switch(0, None)),
        (65, device(None, 0)),
        (70, activation("slow", 70, 70, Some(70), true)),
        (80, switch(0, Some("fast"))),
        (80, activation("fast", 80, 80, None, false)),
        (100, completion("fast", 80)),
        (100, switch(0, None)),
    ])
}

fn all() -> Selection {
    Selection::default()
}

fn us(t: i64) -> Option<Time> {
    Some(Time(t * 1000))
}

/// Left and right ends of the rectangles of a fill, by their upper edge.
fn bars(svg: &str, fill: &str) -> Vec<(f64, f64, f64)> {
    let mut out = Vec::new();
    for line in svg.lines().filter(|l| l.starts_with("<path") && l.contains(&format!("\" {fill}"))) {
        let path = line.split('"').nth(1).unwrap_or_default();
        let points: Vec<f64> = path
            .split(|c: char| c.is_ascii_alphabetic() || c == ' ')
            .filter_map(|n| n.parse().ok())
            .collect();
        if let [x, y, right, _, _, _, _, _] = points[..] {
            out.push((y, x, right));
        }
    }
    out.sort_by(|a, b| a.partial_cmp(b).unwrap());
    out
}

const RUNNING: &str = "fill=\"#0072b2\"/";

#[test]
fn bars_stand_where_their_times_are() {
    let gantt = Gantt::of(&schedule(), &Selection { from: us(0), to: us(200), ..all() }, 400);
    let svg = gantt.drawing().to_svg();
    well_formed::check(&svg);
    let bars = bars(&svg, RUNNING);
    // Units of the core by first appearance, then what has none.
    let wanted = [(0.0, 20.0), (30.0, 60.0), (20.0, 30.0), (80.0, 100.0), (10.0, 40.0)];
    assert_eq!(bars.len(), wanted.len(), "{bars:?}");
    // From two bars follows the axis.
    let scale = (bars[1].2 - bars[0].1) / 60.0;
    for ((_, left, right), (from, to)) in bars.iter().zip(wanted) {
        assert!((left - bars[0].1 - from * scale).abs() < 0.02, "{left} is not {from} us");
        assert!((right - bars[0].1 - to * scale).abs() < 0.02, "{right} is not {to} us");
    }
    let lanes: Vec<f64> = bars.iter().map(|b| b.0).collect();
    assert!(lanes[0] == lanes[1] && lanes[1] < lanes[2] && lanes[2] == lanes[3] && lanes[3] < lanes[4]);
    // The stretch that is asked for fills the picture.
    assert!((1170.0 - bars[0].1 - 200.0 * scale).abs() < 0.1);
}

#[test]
fn a_picture_names_lanes_and_marks() {
    let svg = Gantt::of(&schedule(), &all(), 400).drawing().to_svg();
    for text in [
        "three discs among two movers: schedule",
        "r1, core 0",
        "pilot.slow",
        "pilot.fast",
        "r1, no core",
        "pilot.beside",
        "r1, devices",
        "other.camera",
        "look",
        "2",
        "time (us)",
        "100",
        "release",
        "deadline, missed",
        "too soon, deferred",
        "skipped",
        "device in use",
    ] {
        assert!(svg.contains(&format!("aria-label=\"{text}\"")), "{text}");
    }
    let of = Selection { agents: vec!["other".into()], ..all() };
    let svg = Gantt::of(&schedule(), &of, 400).drawing().to_svg();
    assert!(svg.contains("other.camera") && !svg.contains("pilot") && !svg.contains("release"));
}

#[test]
fn a_streamed_trace_gives_the_schedule_of_the_trace_in_memory() {
    let path = folder("trace_gantt").join("schedule.mcap");
    super::file::write(&path, &schedule().records);
    let gantt = Gantt::read(Reader::open(&path).unwrap(), &all(), 400).unwrap();
    assert_eq!(gantt.drawing(), Gantt::of(&schedule(), &all(), 400).drawing());
}

/// A unit that is released every 100 us.
fn periodic(times: i64) -> Trace {
    let job = |k: i64| {
        let t = 100 * k;
        [
            (t, switch(0, Some("tick"))),
            (t, activation("tick", t, t, None, false)),
            (t + 30, completion("tick", t)),
            (t + 30, switch(0, None)),
        ]
    };
    trace((0..times).flat_map(job).collect())
}

#[test]
fn a_picture_ends_after_sixty_releases() {
    let svg = Gantt::of(&periodic(100_000), &all(), 400).drawing().to_svg();
    assert_eq!(bars(&svg, RUNNING).len(), 60);
    assert!(svg.contains("aria-label=\"6.0\"") && svg.len() < 100_000);
    let later = Selection { from: us(50_000), ..all() };
    let svg = Gantt::of(&periodic(100_000), &later, 400).drawing().to_svg();
    assert_eq!(bars(&svg, RUNNING).len(), 60);
    assert!(svg.contains("aria-label=\"50.0\"") && svg.contains("aria-label=\"56.0\""));
}

#[test]
fn a_long_stretch_takes_no_more_than_its_picture() {
    let selection = Selection { from: us(0), to: us(10_000_000), ..all() };
    let svg = Gantt::of(&periodic(100_000), &selection, 400).drawing().to_svg();
    assert!(svg.len() < 3_000_000, "{} bytes", svg.len());
    well_formed::check(&svg);
}

#[test]
fn more_lanes_than_the_limit_are_told() {
    let gantt = Gantt::of(&schedule(), &all(), 2);
    assert_eq!(gantt.rest().as_deref(), Some("2 more lanes are not drawn"));
    let svg = gantt.drawing().to_svg();
    assert!(svg.contains("2 more lanes are not drawn") && !svg.contains("camera"));
}

#[test]
fn lanes_stand_by_robot_and_core() {
    let on = |robot, core, unit: &str| Event::Switch {
        robot,
        core,
        agent: Some("a@x".into()),
        unit: Some(unit.to_string()),
    };
    let beside = |robot| match activation("z", 0, 0, Some(9), false) {
        Event::Activation { agent, unit, release, start, finish, skipped, .. } => {
            Event::Activation { robot, agent, unit, release, start, finish, skipped }
        }
        other => other,
    };
    let events = [beside(1), on(1, 1, "a"), on(0, 0, "b"), on(1, 0, "c"), on(1, 0, "d"), on(7, 0, "e")];
    let t = trace(events.into_iter().enumerate().map(|(i, e)| (i as i64, e)).collect());
    let svg = Gantt::of(&t, &all(), 400).drawing().to_svg();
    let labels =
        ["r2, core 0", "a.c", "a.d", "r2, core 1", "a.a", "r2, no core", "pilot.z", "r1, core 0", "a.b"];
    let places =
        labels.iter().chain(&["robot number 7, core 0", "a.e"]).map(|l| svg.find(&format!("\"{l}\"")));
    let places: Vec<_> = places.collect();
    assert!(places.iter().all(Option::is_some) && places.is_sorted(), "{places:?}");
    let cut = Gantt::of(&t, &all(), 3);
    assert_eq!(cut.rest().as_deref(), Some("3 more lanes are not drawn"));
    assert!(cut.drawing().to_svg().contains("r2, core 1") && !cut.drawing().to_svg().contains("no core"));
}

#[test]
fn a_unit_that_never_ran_and_should_have_is_shown() {
    let miss = |t: i64| Event::Miss {
        robot: 0,
        agent: AGENT.into(),
        unit: "starved".into(),
        release: Time(0),
        deadline: Time(t * 1000),
    };
    let mut t = schedule();
    t.records.push(Record { n: 99, t: Time(90_000), causes: vec![], event: miss(90) });
    let svg = Gantt::of(&t, &all(), 400).drawing().to_svg();
    assert!(svg.contains("r1, never ran") && svg.contains("pilot.starved"));
}

#[test]
fn odd_traces_are_drawn_without_complaint() {
    let far = |event: Event| Record { n: 0, t: Time(i64::MAX), causes: vec![], event };
    let strange = || Event::Switch {
        robot: 4_000_000_000,
        core: u32::MAX,
        agent: Some("a \"quoted\"\n<&>".into()),
        unit: Some(String::new()),
    };
    let mut traces = vec![trace(vec![]), periodic(1), schedule()];
    traces[2].records.truncate(12);
    traces.push(trace(sample::every_kind().into_iter().map(|e| (3, e)).collect()));
    traces.push(trace(sample::every_kind().into_iter().rev().map(|e| (-3, e)).collect()));
    let mut reversed = schedule();
    reversed.records.reverse();
    traces.push(reversed);
    let mut wide = schedule();
    wide.records.insert(0, Record { t: Time(i64::MIN), ..far(strange()) });
    wide.records.push(far(strange()));
    wide.records.push(far(completion("fast", i64::MIN / 1000)));
    wide.records.push(far(Event::Deferral {
        robot: 9,
        agent: String::new(),
        unit: "u".into(),
        until: Time(i64::MIN),
    }));
    wide.records.push(far(activation(
        "fast",
        i64::MIN / 1000,
        i64::MIN / 1000,
        Some(i64::MAX / 1000),
        false,
    )));
    traces.push(wide);
    let windows = [(None, None), (us(10), None), (None, us(55)), (us(10), us(11)), (us(900_000), None)];
    for mut t in traces {
        t.complete = false;
        for (from, to) in windows.into_iter().chain([(Some(Time(0)), Some(Time::MAX))]) {
            for limit in [0, 1, 400] {
                let drawing = Gantt::of(&t, &Selection { from, to, ..all() }, limit).drawing();
                let svg = drawing.to_svg();
                well_formed::check(&svg);
                assert!(!svg.contains("NaN") && !svg.contains("inf\"") && svg.len() < 200_000, "{svg}");
            }
        }
        Gantt::of(&t, &all(), 400).drawing().to_png(300).unwrap();
    }
}
