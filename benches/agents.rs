//! How much faster than the wall clock 1,000 agents go, each with ten periodic services and a message an
//! activation, on one thread: seconds of the wall clock for a simulated second.
//!
//! Told messages are handled by a service of the agent that they are for, so there are twice as many activations
//! as messages. What is published is read by an agent that asks for the newest of each publisher.

mod support;

use support::Compiled;

/// Periods of an agent's services in ms: from 50 to 1,000, 200 in the mean.
const PERIODS: [u32; 10] = [50, 60, 80, 100, 100, 120, 150, 150, 190, 1_000];

/// Simulated, as the template says.
const SPAN: f64 = 10.0;

/// Ten times as fast as the wall clock.
const BAR: f64 = 0.1;

/// A fleet as it is measured.
struct Fleet {
    name: &'static str,
    what: &'static str,
    /// Whether its agents tell each other; else they publish.
    telling: bool,
    /// How much later each host begins than the one before it.
    apart: &'static str,
}

/// When all begin together, as they do unless their mission says otherwise, services of one period run at one
/// instant, and their messages arrive at one. When every host begins at an instant of its own, the two agents
/// on it have their instants for themselves, and bear all that an instant costs.
const FLEETS: [Fleet; 4] = [
    Fleet { name: "agents_told", what: "telling, all together", telling: true, apart: "0 s" },
    Fleet { name: "agents_told_apart", what: "telling, 100 us apart", telling: true, apart: "100 us" },
    Fleet { name: "agents_published", what: "publishing, all together", telling: false, apart: "0 s" },
    Fleet {
        name: "agents_published_apart",
        what: "publishing, 100 us apart",
        telling: false,
        apart: "100 us",
    },
];

/// The template's agents that tell another, or else publish.
fn agent(name: &str, told: Option<&str>) -> String {
    let (send, hear) = match told {
        Some(other) => (
            format!("tell {other} inform"),
            format!("  service hear on inform Reading(r) from {other} {{\n    set heard = heard + 1\n  }}\n"),
        ),
        None => ("publish report".into(), String::new()),
    };
    let service = |(i, period): (usize, &u32)| {
        format!(
            "  service beat{i} every {period} ms after phase {{\n    set sent = sent + 1\n    \
             {send} Reading(number: sent, place: (0 m, 0 m), speed: 1 m/s)\n  }}\n"
        )
    };
    let services: String = PERIODS.iter().enumerate().map(service).collect();
    format!(
        "agent {name}(phase: Duration) {{\n  state sent: Int = 0\n  state heard: Int = 0\n{services}{hear}}}\n"
    )
}

/// The mission's text.
fn text(telling: bool) -> String {
    let told = |name| telling.then_some(name);
    let agents = agent("red", told("blue")) + &agent("blue", told("red"));
    let (clerk, desk) = match telling {
        true => ("", ""),
        false => (
            "topic report: Reading = channel(capacity: 1_000)\n\
             agent clerk {\n  state senders: Int = 0\n  \
             service read every 200 ms {\n    set senders = length(heard(report))\n  }\n}\n",
            "  host desk runs clerk\n  metric senders = desk.clerk.senders\n",
        ),
    };
    support::read("benches/fleet.soi.in")
        .replace("// the agents\n", &(agents + clerk))
        .replace("  // the reader\n", desk)
}

fn main() {
    let mut criterion = support::criterion();
    let mut group = criterion.benchmark_group("agents, 10 s of 1,000");
    for fleet in &FLEETS {
        let path = support::scratch(&format!("{}.soi", fleet.name), &text(fleet.telling));
        let compiled = Compiled::new(&path, &[("apart", fleet.apart.into())]);
        let prepared = compiled.prepared();
        // Of the two agents that are asked: what each sends in the span, the first at its beginning.
        let sent: u32 = PERIODS.iter().map(|p| 2 * ((SPAN * 1e3) as u32 / p + 1)).sum();
        let ours = || {
            let (report, seconds) = support::run(&prepared);
            assert_eq!(report.sim_time_s, SPAN, "{}", report.reason);
            let count = |name| report.metrics.get(name).copied().flatten();
            assert_eq!(count("sent"), Some(f64::from(sent)));
            if fleet.telling {
                // What is sent at the last instant arrives after it.
                assert!(count("heard") >= Some(f64::from(sent - 2 * PERIODS.len() as u32)));
            } else {
                assert!(count("senders") >= Some(999.0));
            }
            seconds
        };
        support::add(&mut group, fleet.what, ours);
        if !support::trying() {
            let what = format!("wall clock to simulated time of 1,000 agents {}", fleet.what);
            support::verdict(fleet.name, &what, support::ratio(9, ours, || SPAN), Some(BAR));
        }
    }
    group.finish();
    criterion.final_summary();
}
