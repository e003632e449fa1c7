//! The top view.

use super::sample;
use crate::support::folder;
use soifra::{plot, trace_file::Reader, trace_file::Trace};
use soifra_graph::Value;
use soifra_runtime::{Event, Record, Time};

#[test]
fn the_same_trace_gives_the_same_picture() {
    let trace = sample::trace();
    let (a, b) = (plot::top_view(&trace), plot::top_view(&trace));
    assert_eq!(a.to_svg(), b.to_svg());
    assert_eq!(a.to_png(700).unwrap(), b.to_png(700).unwrap());
}

#[test]
fn a_picture_names_mission_seed_outcome_robots_and_units() {
    let svg = plot::top_view(&sample::trace()).to_svg();
    for text in [
        "three discs among two movers",
        "sim, seed 7: success at 20 s",
        "r1",
        "r2",
        "r3",
        "x (cm)",
        "y (cm)",
        "25",
        "5 cm",
        "start",
        "target",
        "mover, at the end",
        "contact",
        "wall",
        "obstacle",
        "region",
    ] {
        assert!(svg.contains(&format!("aria-label=\"{text}\"")), "{text}");
    }
    // One contact (two lines and a ring, each twice), beside the one in the legend.
    assert_eq!(svg.matches("#d61220").count(), 2 * 3);
}

#[test]
fn a_streamed_trace_gives_the_picture_of_the_trace_in_memory() {
    let dir = folder("trace_a_streamed_trace_gives_the_picture_of_the_trace_in_memory");
    let path = dir.join("t.mcap");
    super::file::write(&path, &sample::run(10, 20));
    let streamed = plot::top_view_of(Reader::open(&path).unwrap()).unwrap();
    assert_eq!(streamed, plot::top_view(&sample::trace()));
}

#[test]
fn a_cut_off_trace_says_so() {
    let mut trace = sample::trace();
    trace.records.truncate(1500);
    trace.complete = false;
    assert!(plot::top_view(&trace).to_svg().contains("the trace is cut off at 10.6 s"));
}

#[test]
fn png_sizes_are_checked() {
    let drawing = plot::top_view(&sample::trace());
    let png = drawing.to_png(320).unwrap();
    assert_eq!(&png[..8], b"\x89PNG\r\n\x1a\n");
    assert_eq!(png[16..20], 320u32.to_be_bytes());
    for width in [0, 20_000, u32::MAX] {
        assert!(drawing.to_png(width).unwrap_err().to_string().contains("cannot be made"));
    }
}

#[test]
fn odd_worlds_are_drawn_without_complaint() {
    let pose = |x: f64, y: f64| Event::Pose { robot: 0, pose: [x, y, 0.0, 0.0, 0.0, 0.0, 1.0], path_m: 0.0 };
    let contact = || Event::Contact { robot: 7, other: None, with: "x".into(), begin: true };
    let far = [
        vec![],
        vec![pose(0.0, 0.0)],
        vec![pose(1e-12, 0.0), pose(0.0, 1e-12)],
        vec![pose(1e300, -1e300), pose(0.0, 0.0), contact()],
        vec![pose(f64::NAN, 0.0), pose(f64::INFINITY, 1.0)],
        vec![pose(9e8, 0.0), pose(-9e8, 1.0)],
    ];
    for (events, no_world) in far.into_iter().flat_map(|e| [(e.clone(), false), (e, true)]) {
        let mut trace = Trace { header: sample::header(), records: vec![], complete: true };
        if no_world {
            trace.header.scene.world.clear();
            trace.header.scene.robots.clear();
        } else {
            trace.header.scene.platforms[0].parts[0].args.insert("radius".into(), Value::Number(f64::NAN));
            trace.header.scene.robots[1].target = Some([f64::NAN, 1e308, 0.0]);
        }
        trace.header.title = "control \u{1}\u{7f} <&\"> \u{1F916}\u{ffff}".into();
        for (i, event) in events.into_iter().enumerate() {
            trace.records.push(Record { n: i as u64, t: Time(i as i64), causes: vec![], event });
        }
        let drawing = plot::top_view(&trace);
        let svg = drawing.to_svg();
        assert!(!svg.contains("NaN") && !svg.contains("inf\""), "{svg}");
        assert!(svg.len() < 100_000);
        drawing.to_png(200).unwrap();
    }
}
