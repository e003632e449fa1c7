//! The timing of a mission: what is asked of each core, and how late everything can be.

use super::table::table;
use serde::Serialize;
use soifra_graph::Misses;
use soifra_lang::schedule::{Chain, Core, Task, Timing};

/// Timing for people.
pub fn timing(mission: &str, t: &Timing) -> String {
    let mut out = String::new();
    if t.cores.is_empty() {
        out += &format!("{mission}: no unit is on a core\n");
    }
    for core in &t.cores {
        out += &self::core(mission, core);
    }
    if !t.chains.is_empty() {
        out += &format!("{mission}: from the capture of a reading to the command, at most\n");
        for c in &t.chains {
            out += &chain(c);
        }
    }
    out
}

fn core(mission: &str, c: &Core) -> String {
    let used = c.utilization.map_or("unknown".into(), |u| format!("{u:.4}"));
    let mut out = format!("{mission}, {} core {}: utilization {used}", c.robot, c.number);
    if c.tasks.iter().any(|t| t.budget > 0) {
        out += " without budgets";
    }
    out += "\n\n";
    let (unit, scale) = scale(c.tasks.iter().map(|t| t.worst.max(t.budget)));
    let time = |ns: i64| format!("{:.4}", ns as f64 / scale);
    let some = |ns: Option<i64>| ns.map_or("–".into(), time);
    let row = |t: &Task| {
        let period = some(t.period);
        vec![
            format!("{}.{}", t.agent, t.unit),
            t.priority.to_string(),
            if t.periodic { period } else { format!("≥ {period}") },
            time(t.worst),
            if t.budget > 0 { time(t.budget) } else { String::new() },
            if t.jitter > 0 { time(t.jitter) } else { String::new() },
            if t.blocking > 0 { time(t.blocking) } else { String::new() },
            some(t.response),
            if t.budget > 0 { some(t.full_response) } else { String::new() },
            some(t.deadline),
            verdict(t).into(),
        ]
    };
    let header = [
        unit,
        "priority",
        "period",
        "worst",
        "budget",
        "jitter",
        "blocked",
        "response",
        "with budget",
        "deadline",
        "",
    ];
    let keep: Vec<usize> = (0..header.len())
        .filter(|i| {
            let used = |t: &Task| [t.budget > 0, t.jitter > 0, t.blocking > 0, true, t.budget > 0][*i - 4];
            !(4..=8).contains(i) || c.tasks.iter().any(used)
        })
        .collect();
    let pick = |cells: &[String]| keep.iter().map(|i| cells[*i].clone()).collect::<Vec<_>>();
    let rows: Vec<Vec<String>> = c.tasks.iter().map(|t| pick(&row(t))).collect();
    let header: Vec<&str> = keep.iter().map(|i| header[*i]).collect();
    out += &table(&header, &rows);
    out += &format!("\n  {}\n\n", liu_layland(c));
    out
}

/// What Liu and Layland's bound says here.
fn liu_layland(c: &Core) -> String {
    let n = c.tasks.len();
    let bound = format!("Liu-Layland: {n} tasks may ask for {:.4}", c.bound);
    match c.utilization {
        _ if !c.rate_monotonic => {
            format!(
                "{bound}; it says nothing here: priorities are not rate-monotonic, or deadlines are not the periods"
            )
        }
        Some(u) if u <= c.bound => format!("{bound}; {u:.4} is within it"),
        Some(u) => format!("{bound}; {u:.4} is not within it, so the exact response times decide"),
        None => bound,
    }
}

fn verdict(t: &Task) -> &'static str {
    match (t.is_met(), t.misses, t.deadline) {
        (_, _, None) => "no deadline",
        (true, _, _) => "met",
        (false, Misses::Soft, _) => "may be late",
        (false, _, _) => "can be missed",
    }
}

fn chain(c: &Chain) -> String {
    let (unit, scale) = scale(c.latency.into_iter());
    let time = |ns: i64| format!("{:.4} {unit}", ns as f64 / scale);
    let links: Vec<String> = c.links.iter().map(|l| format!("{}.{}", l.agent, l.unit)).collect();
    let whole = c.latency.map_or("without bound".into(), time);
    format!("  {}: {} → {} → {}: {whole}\n", c.robot, c.sensor, links.join(" → "), c.actuator)
}

/// A unit for times of this size.
fn scale(times: impl Iterator<Item = i64>) -> (&'static str, f64) {
    match times.max().unwrap_or(0) {
        0..1_000_000 => ("us", 1e3),
        1_000_000..10_000_000_000 => ("ms", 1e6),
        _ => ("s", 1e9),
    }
}

/// The timing of a mission in JSON, in seconds.
#[derive(Debug, Serialize)]
pub struct JsonTiming {
    mission: String,
    cores: Vec<JsonCore>,
    chains: Vec<JsonChain>,
}

#[derive(Debug, Serialize)]
struct JsonCore {
    robot: String,
    core: i64,
    utilization: Option<f64>,
    liu_layland_bound: f64,
    rate_monotonic: bool,
    tasks: Vec<JsonTask>,
}

#[derive(Debug, Serialize)]
struct JsonTask {
    agent: String,
    unit: String,
    priority: i64,
    periodic: bool,
    period_s: Option<f64>,
    worst_s: f64,
    budget_s: f64,
    jitter_s: f64,
    blocking_s: f64,
    response_s: Option<f64>,
    response_with_budget_s: Option<f64>,
    deadline_s: Option<f64>,
    soft: bool,
    met: bool,
}

#[derive(Debug, Serialize)]
struct JsonChain {
    robot: String,
    sensor: String,
    units: Vec<String>,
    actuator: String,
    latency_s: Option<f64>,
}

impl JsonTiming {
    /// From what was found.
    pub fn new(mission: &str, t: &Timing) -> Self {
        let s = |ns: i64| ns as f64 / 1e9;
        let task = |t: &Task| JsonTask {
            agent: t.agent.to_string(),
            unit: t.unit.to_string(),
            priority: t.priority,
            periodic: t.periodic,
            period_s: t.period.map(s),
            worst_s: s(t.worst),
            budget_s: s(t.budget),
            jitter_s: s(t.jitter),
            blocking_s: s(t.blocking),
            response_s: t.response.map(s),
            response_with_budget_s: t.full_response.map(s),
            deadline_s: t.deadline.map(s),
            soft: t.misses == Misses::Soft,
            met: t.is_met(),
        };
        let core = |c: &Core| JsonCore {
            robot: c.robot.to_string(),
            core: c.number,
            utilization: c.utilization,
            liu_layland_bound: c.bound,
            rate_monotonic: c.rate_monotonic,
            tasks: c.tasks.iter().map(task).collect(),
        };
        let chain = |c: &Chain| JsonChain {
            robot: c.robot.to_string(),
            sensor: c.sensor.to_string(),
            units: c.links.iter().map(|l| format!("{}.{}", l.agent, l.unit)).collect(),
            actuator: c.actuator.to_string(),
            latency_s: c.latency.map(s),
        };
        JsonTiming {
            mission: mission.into(),
            cores: t.cores.iter().map(core).collect(),
            chains: t.chains.iter().map(chain).collect(),
        }
    }
}
